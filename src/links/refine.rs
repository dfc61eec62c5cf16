//! The refinement loop: pairs are worked in waves until every one is linked, dormant or proved invisible.
//!
//! A wave's pairs are decided in parallel, chunk by chunk (`decide.rs`); what is split makes the next wave. Order and random numbers come
//! from ids, so threads cannot change a bit.

use std::collections::HashMap;

use rayon::prelude::*;

use super::context::RefineContext;
use super::decide::Outcome;
use super::limits::{Holding, RefineEnd, RefineLimits};
use super::link_set::{Link, LinkSet, Pair};
use super::oracle::Decision;
use super::skips::Spared;
use crate::hierarchy::{Hierarchy, NodeId};

/// Links and dormant pairs while they are refined, taken apart from a [`LinkSet`].
pub(crate) struct Refinement<'a> {
    linked: Vec<(NodeId, Link)>,
    dormant: Vec<Pair>,
    dropped: &'a mut Dropped,
    /// The most links and other pairs that there were at a time.
    most: usize,
}

/// Pairs that were dropped, by reason.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Dropped {
    pub behind: Spared,
    pub black: Spared,
}

/// Pairs of clusters that must be split, whatever may be linked, are followed while no more pairs than this wait: they may prove dark.
const FEW_WAITING: usize = 1 << 16;

/// Pairs of a wave that are decided, and ask for visibility, together: about a thousand segments.
const CHUNK: usize = 256;

/// Pairs of a wave of which it is known at a time what becomes of them: two megabytes.
const SETTLED_AT_ONCE: usize = 1 << 16;

/// Where there is no more room for links, they get room for so many times as many; the most that counts of memory do not know of.
const ROOM_FOR_MORE: f64 = 1.125;

impl<'a> Refinement<'a> {
    /// Takes links apart; what is dropped is added to `dropped`.
    pub fn of(links: LinkSet, dropped: &'a mut Dropped) -> Self {
        let (linked, dormant) = links.into_parts();
        let most = linked.len() + dormant.len();
        Self { linked, dormant, dropped, most }
    }

    /// The most links, dormant pairs and pairs that waited to be decided that there were at a time.
    pub fn most_pairs(&self) -> usize {
        self.most
    }

    /// The links by receiver.
    pub fn into_links(self, hierarchy: &Hierarchy) -> LinkSet {
        LinkSet::new(hierarchy.len(), &self.linked, self.dormant)
    }

    /// Splits the links that `splits` names, decides every other pair anew, and refines those with which the oracle is not content.
    pub fn refine(
        &mut self,
        hierarchy: &mut Hierarchy,
        splits: &HashMap<Pair, Decision>,
        context: &RefineContext<'_>,
        limits: &RefineLimits<'_>,
    ) -> RefineEnd {
        let share = context.rays.share();
        let (mut wave, mut end) = self.reopen(hierarchy, splits, context, limits);
        while !wave.is_empty() {
            self.most = self.most.max(self.linked.len() + self.dormant.len() + wave.len());
            if end == RefineEnd::Content {
                end = limits.says_end(hierarchy, self.linked.len() + wave.len(), self.dormant.len()).unwrap_or(end);
            }

            // What becomes of each pair; what is settled is put away.
            let may_split = end == RefineEnd::Content;
            let decide = |pairs: &[Pair]| match (limits.halt)() {
                true => pairs.iter().map(|_| Outcome::Dormant).collect(),
                false => context.decide_chunk(hierarchy, pairs, may_split),
            };
            let mut to_split = Vec::new();
            for some in wave.chunks(SETTLED_AT_ONCE) {
                let decide = |(number, pairs)| if share.has(number) { decide(pairs) } else { Vec::new() };
                let mut outcomes: Vec<Vec<Outcome>> = some.par_chunks(CHUNK).enumerate().map(decide).collect();
                share.exchange(&mut outcomes);
                if (limits.halt)() {
                    end = RefineEnd::Stopped;
                }
                self.make_room(outcomes.iter().flatten().filter(|outcome| matches!(outcome, Outcome::Linked(_))).count());
                for (pair, outcome) in some.iter().zip(outcomes.into_iter().flatten()) {
                    match outcome {
                        Outcome::Behind => self.dropped.behind.add(2 * context.rays_for(hierarchy, *pair)),
                        Outcome::Black => self.dropped.black.add(2 * context.rays_for(hierarchy, *pair)),
                        Outcome::Dormant => self.dormant.push(*pair),
                        Outcome::Linked(link) => end = self.link(hierarchy, pair.receiver, link, limits).unwrap_or(end),
                        Outcome::Split(decision) => to_split.push((*pair, decision)),
                    }
                }
            }

            let limit;
            (wave, limit) = self.split(hierarchy, &to_split, may_split, context, limits);
            end = limit.unwrap_or(end);
        }
        end
    }

    /// Takes back the links with which the oracle is not content any more, or that `splits` names, as far as the limits let them be split.
    /// Returns the first wave: the children of these, and the dormant pairs, which are asked again.
    fn reopen(
        &mut self,
        hierarchy: &mut Hierarchy,
        splits: &HashMap<Pair, Decision>,
        context: &RefineContext<'_>,
        limits: &RefineLimits<'_>,
    ) -> (Vec<Pair>, RefineEnd) {
        let decide = |(receiver, link): &(NodeId, Link)| {
            let pair = Pair { receiver: *receiver, source: link.source };
            splits.get(&pair).copied().unwrap_or_else(|| {
                context.oracle.decide(&context.candidate(hierarchy, pair, link.form_factor, Some(f64::from(link.seen))))
            })
        };
        let decisions: Vec<Decision> = self.linked.par_iter().map(decide).collect();
        let mut wave = std::mem::take(&mut self.dormant);
        let mut end = RefineEnd::Content;
        let mut linked = std::mem::take(&mut self.linked);
        let (mut links, mut decisions) = (linked.len(), decisions.into_iter());
        linked.retain(|&(receiver, link)| {
            let pair = Pair { receiver, source: link.source };
            let Some(split) = decisions.next().filter(|decision| *decision != Decision::Link) else { return true };
            let (children, bytes) = limits.cost_of_split(hierarchy, split_end(pair, split));
            let holding = Holding { links: links - 1 + wave.len() + children, unlinked: 0 };
            if let Some(limit) = limits.exceeded(hierarchy, holding, bytes) {
                end = limit;
                return true;
            }
            links -= 1;
            push_children(hierarchy, pair, split, &mut wave);
            false
        });
        self.linked = linked;
        (wave, end)
    }

    /// Splits pairs of a wave as decided; returns the next wave, and the limit at which refinement must end.
    ///
    /// What does not fit waits, if anything may be split at all: pairs that prove dark make room. If none does, this is the end, and who
    /// cannot be linked sleeps.
    fn split(
        &mut self,
        hierarchy: &mut Hierarchy,
        pairs: &[(Pair, Decision)],
        may_split: bool,
        context: &RefineContext<'_>,
        limits: &RefineLimits<'_>,
    ) -> (Vec<Pair>, Option<RefineEnd>) {
        let (mut next, mut left, mut refused) = (Vec::new(), pairs.len(), None);
        for &(pair, decision) in pairs {
            left -= 1;
            let is_structural = !context.clusters && (hierarchy.is_cluster(pair.receiver) || hierarchy.is_cluster(pair.source));
            match self.exceeded_by_split(hierarchy, pair, decision, left + next.len(), limits) {
                Some(limit) if !(is_structural && limit == RefineEnd::MaxLinks && left + next.len() <= FEW_WAITING) => {
                    refused = Some(limit);
                    if may_split { next.push(pair) } else { self.dormant.push(pair) }
                }
                _ => push_children(hierarchy, pair, decision, &mut next),
            }
        }
        let all_wait = may_split && next.len() == pairs.len();
        (next, refused.filter(|_| all_wait))
    }

    /// Makes room for so many more links. A list that doubles where it is full would take three times as much as it holds while it is copied.
    fn make_room(&mut self, more: usize) {
        let needed = self.linked.len() + more;
        if needed > self.linked.capacity() {
            let room = (ROOM_FOR_MORE * needed as f64) as usize;
            self.linked.reserve_exact(room - self.linked.len());
        }
    }

    /// Adds a link, or leaves the pair dormant if a limit says so, which is returned.
    fn link(&mut self, hierarchy: &Hierarchy, receiver: NodeId, link: Link, limits: &RefineLimits<'_>) -> Option<RefineEnd> {
        let exceeded = limits.exceeded(hierarchy, self.holding(1), 0);
        match exceeded {
            Some(_) => self.dormant.push(Pair { receiver, source: link.source }),
            None => self.linked.push((receiver, link)),
        }
        exceeded
    }

    /// The limit that would be exceeded if a pair were split, and all that came of it and `waiting` others were linked.
    fn exceeded_by_split(
        &self,
        hierarchy: &Hierarchy,
        pair: Pair,
        decision: Decision,
        waiting: usize,
        limits: &RefineLimits<'_>,
    ) -> Option<RefineEnd> {
        let (children, bytes) = limits.cost_of_split(hierarchy, split_end(pair, decision));
        limits.exceeded(hierarchy, self.holding(waiting + children), bytes)
    }

    /// What there is if all `waiting` pairs are linked.
    fn holding(&self, waiting: usize) -> Holding {
        Holding { links: self.linked.len() + waiting, unlinked: self.dormant.len() }
    }
}

/// The node of a pair that a decision splits.
fn split_end(pair: Pair, decision: Decision) -> NodeId {
    if decision == Decision::SplitReceiver { pair.receiver } else { pair.source }
}

/// Appends the pairs that take the place of `pair`, making elements where there are none yet.
fn push_children(hierarchy: &mut Hierarchy, pair: Pair, decision: Decision, pairs: &mut Vec<Pair>) {
    let split = split_end(pair, decision);
    if hierarchy.is_leaf(split) {
        hierarchy.split(split);
    }
    pairs.extend(hierarchy.children(split).map(|child| match decision {
        Decision::SplitReceiver => Pair { receiver: child, ..pair },
        _ => Pair { source: child, ..pair },
    }));
}
