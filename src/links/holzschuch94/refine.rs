//! BF refinement of mutual links (Hanrahan, Salzman, Aupperle 1991), with link reduction.
//!
//! A link that carries more than eps_refine has the larger of its ends split, in waves: a wave is decided and asked in parallel, elements are
//! made in order.

use std::time::Instant;

use rayon::prelude::*;

use super::ask::Promising;
use super::context::MutualContext;
use super::mutual_links::{MutualLink, MutualLinks};
use super::reduction::{Child, is_worth_refining};
use crate::geometry::Facet;
use crate::hierarchy::{Hierarchy, NodeId};
use crate::links::exchange::behind;
use crate::links::limits::{RefineEnd, RefineLimits};

/// What becomes of a link that carries too much.
enum Outcome {
    /// Refining it tells nothing.
    Reduced,
    /// The children of the larger end take its place.
    Split(Vec<Child>),
}

impl MutualLinks {
    /// Refines all links that carry more than the tolerance, until none does that can be split.
    pub fn refine(&mut self, hierarchy: &mut Hierarchy, context: &MutualContext<'_>, limits: &RefineLimits<'_>) -> RefineEnd {
        let first_element = hierarchy.cluster_count() + context.scene.surfaces().len();
        let is_top_level = |link: &MutualLink| link.first.index() < first_element && link.second.index() < first_element;

        // Links that carry too much by now.
        let carries_too_much: Vec<bool> = self.links.par_iter().map(|link| context.carries_too_much(hierarchy, link)).collect();
        let mut wave = Vec::new();
        let mut kept = Vec::with_capacity(self.links.len());
        for (link, too_much) in std::mem::take(&mut self.links).into_iter().zip(carries_too_much) {
            if too_much { wave.push(link) } else { kept.push(link) }
        }
        self.links = kept;
        self.counts.top_level_exceeding += wave.iter().filter(|link| is_top_level(link)).count() as u64;

        // Wave after wave: would splitting tell anything, and do the children fit? Split, ask, and see what the children carry.
        let mut end = RefineEnd::Content;
        while !wave.is_empty() {
            end = limits.says_end(hierarchy, 2 * (self.links.len() + wave.len()), 0).unwrap_or(end);
            if end != RefineEnd::Content {
                self.links.append(&mut wave);
                break;
            }
            let (promising, limit) = self.split(hierarchy, context, limits, &wave);
            end = limit.unwrap_or(end);
            let linked = self.ask(hierarchy, context, &promising);
            let too_much: Vec<bool> = linked.par_iter().map(|link| context.carries_too_much(hierarchy, link)).collect();
            wave.clear();
            for (link, too_much) in linked.into_iter().zip(too_much) {
                if too_much { wave.push(link) } else { self.links.push(link) }
            }
        }
        end
    }

    /// Splits the links of a wave as far as that tells anything and fits; the others stay. Returns the pairs that take the place of those
    /// that were split, and the limit that kept some from it.
    fn split(
        &mut self,
        hierarchy: &mut Hierarchy,
        context: &MutualContext<'_>,
        limits: &RefineLimits<'_>,
        wave: &[MutualLink],
    ) -> (Vec<Promising>, Option<RefineEnd>) {
        let outcomes: Vec<Outcome> = wave.par_iter().map(|link| context.decide(hierarchy, link)).collect();
        let (mut promising, mut left, mut end) = (Vec::new(), wave.len(), None);
        for (link, outcome) in wave.iter().zip(outcomes) {
            left -= 1;
            let Outcome::Split(children) = outcome else {
                self.links.push(MutualLink { is_reduced: true, ..*link });
                self.counts.reduced += 1;
                continue;
            };
            let (split, other) = larger_first(hierarchy, link);
            let (count, bytes) = limits.cost_of_split(hierarchy, split);
            let holding = self.holding(left + promising.len() + count, 0);
            if let Some(limit) = limits.exceeded(hierarchy, holding, bytes) {
                end = Some(limit);
                self.links.push(*link);
                continue;
            }
            hierarchy.split(split);
            for (first, child) in hierarchy.children(split).zip(children) {
                promising.extend(child.exchange.map(|exchange| Promising { first, second: other, exchange }));
            }
        }
        (promising, end)
    }
}

/// The end of a link that is split if it is refined, and the other.
fn larger_first(hierarchy: &Hierarchy, link: &MutualLink) -> (NodeId, NodeId) {
    if hierarchy.area(link.first) >= hierarchy.area(link.second) { (link.first, link.second) } else { (link.second, link.first) }
}

impl MutualContext<'_> {
    /// Whether BF exceeds the tolerance on a link that may be split.
    fn carries_too_much(&self, hierarchy: &Hierarchy, link: &MutualLink) -> bool {
        let larger = hierarchy.area(link.first).max(hierarchy.area(link.second));
        let irradiance = || self.largest_irradiance(hierarchy, link.first, link.second, link.exchange);
        !link.is_reduced && larger > self.min_area && irradiance() > self.refine_tolerance
    }

    /// Takes the form factors of the children that a split would make, and whether they tell anything.
    fn decide(&self, hierarchy: &Hierarchy, link: &MutualLink) -> Outcome {
        let start = Instant::now();
        let (split, other) = larger_first(hierarchy, link);
        let (normal, other) = (hierarchy.normal(split), hierarchy.facet(other));
        let mut children = Vec::with_capacity(4);
        let mut add = |child: &Facet<'_>| {
            let is_facing = !behind(child, &other) && !behind(&other, child);
            children.push(Child { area: child.area, exchange: is_facing.then(|| self.estimate_exchange(child, &other)) });
        };
        if hierarchy.is_leaf(split) {
            hierarchy.pieces(split).iter().for_each(|corners| add(&Facet::of_part(corners, normal)));
        } else {
            hierarchy.children(split).for_each(|child| add(&hierarchy.facet(child)));
        }
        self.note_form_factors(start);
        match self.reduce_tolerance {
            Some(tolerance) if link.is_fully_visible && !is_worth_refining(link.exchange, &children, tolerance) => Outcome::Reduced,
            _ => Outcome::Split(children),
        }
    }
}
