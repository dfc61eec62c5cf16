//! BF refinement of mutual links (Hanrahan, Salzman, Aupperle 1991), with link reduction.
//!
//! A link that carries more than eps_refine has the larger of its ends split, in waves: a wave is decided and asked in parallel, elements are
//! made in order.

use std::sync::atomic::Ordering;
use std::time::Instant;

use rayon::prelude::*;

use super::reduction::{Piece, is_worth_refining};
use super::top_level::Promising;
use super::{MutualContext, MutualLink, MutualLinks};
use crate::form_factor::{estimate_exchange, exact_exchange};
use crate::geometry::Facet;
use crate::hierarchy::{Hierarchy, NodeId, for_each_piece};
use crate::links::exchange::behind;
use crate::links::limits::{RefineEnd, RefineLimits};

/// What becomes of a link that carries too much.
enum Outcome {
    /// Refining it tells nothing.
    Reduced,
    /// Its pieces take its place, those of the larger end with the other.
    Split(Vec<Piece>),
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

        // Wave after wave: would splitting tell anything, and do the pieces fit? Split, ask, and look at what the pieces carry.
        let mut end = RefineEnd::Content;
        while !wave.is_empty() {
            if limits.says_stop(hierarchy, 2 * (self.links.len() + wave.len())) {
                end = RefineEnd::Stopped;
            }
            if end != RefineEnd::Content {
                self.links.append(&mut wave);
                break;
            }
            let outcomes: Vec<Outcome> = wave.par_iter().map(|link| context.decide(hierarchy, link)).collect();
            let mut promising = Vec::new();
            let mut left = wave.len();
            for (link, outcome) in wave.iter().zip(outcomes) {
                left -= 1;
                match outcome {
                    Outcome::Reduced => {
                        self.links.push(MutualLink { is_reduced: true, ..*link });
                        self.counts.reduced += 1;
                    }
                    Outcome::Split(pieces) => {
                        let (split, other) = larger_first(hierarchy, link);
                        let (children, bytes) = limits.cost_of_split(hierarchy, split);
                        let holding = self.holding(left + promising.len() + children, 0);
                        if let Some(limit) = limits.exceeded(hierarchy, holding, bytes) {
                            end = limit;
                            self.links.push(*link);
                            continue;
                        }
                        hierarchy.split(split);
                        for (child, piece) in hierarchy.children(split).zip(pieces) {
                            if let Some(exchange) = piece.exchange {
                                promising.push(Promising { first: child, second: other, exchange });
                            }
                        }
                    }
                }
            }
            let linked = self.ask(hierarchy, context, &promising);
            let too_much: Vec<bool> = linked.par_iter().map(|link| context.carries_too_much(hierarchy, link)).collect();
            wave.clear();
            for (link, too_much) in linked.into_iter().zip(too_much) {
                if too_much { wave.push(link) } else { self.links.push(link) }
            }
        }
        end
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

    /// Takes the form factors of the pieces that a split would make, and whether they tell anything.
    fn decide(&self, hierarchy: &Hierarchy, link: &MutualLink) -> Outcome {
        let start = Instant::now();
        let (split, other) = larger_first(hierarchy, link);
        let (whole, other) = (hierarchy.facet(split), hierarchy.facet(other));
        let mut pieces = Vec::with_capacity(4);
        let mut add = |piece: &Facet<'_>| {
            let is_facing = !behind(piece, &other) && !behind(&other, piece);
            pieces.push(Piece { area: piece.area, exchange: is_facing.then(|| self.estimate_exchange(piece, &other)) });
        };
        if hierarchy.is_leaf(split) {
            for_each_piece(&whole, |corners| add(&Facet::of_part(corners, whole.normal)));
        } else {
            hierarchy.children(split).for_each(|child| add(&hierarchy.facet(child)));
        }
        self.note_form_factors(start);
        match self.reduce_tolerance {
            Some(tolerance) if link.is_fully_visible && !is_worth_refining(link.exchange, &pieces, tolerance) => Outcome::Reduced,
            _ => Outcome::Split(pieces),
        }
    }

    /// `A F` between two polygons in m^2, as if nothing were in between.
    pub(super) fn estimate_exchange(&self, first: &Facet<'_>, second: &Facet<'_>) -> f64 {
        if self.form_factor_accuracy > 0.0 {
            estimate_exchange(first, second, self.form_factor_accuracy).value
        } else {
            exact_exchange(first, second)
        }
    }

    /// Notes the time since `start` as spent on form factors.
    pub(super) fn note_form_factors(&self, start: Instant) {
        self.form_factor_nanoseconds.fetch_add(start.elapsed().as_nanos() as u64, Ordering::Relaxed);
    }
}
