//! Pairs of surfaces: which of them are linked, and when.
//!
//! The original algorithm links all pairs before anything else (Hanrahan, Salzman, Aupperle 1991). Lazy linking (Holzschuch, Sillion,
//! Drettakis 1994, section 3.1) leaves a pair unclassified, without a ray, until BF exceeds eps_link. Link culling (Lischinski 1994,
//! section 4.1.1) links all pairs at first but for those between reflecting surfaces with little form factor, which it forgets.

use std::f64::consts::PI;
use std::time::Instant;

use rayon::prelude::*;

use super::pairs::Row;
use super::{MutualContext, MutualLink, MutualLinks, RAYS_PER_LINK};
use crate::geometry::sampling;
use crate::hierarchy::{Hierarchy, NodeId};
use crate::links::Pair;
use crate::links::exchange::behind;
use crate::links::limits::{RefineEnd, RefineLimits};
use crate::links::sample_pairs::{sampled_pairs, sampled_transmittance};
use crate::scene::SurfaceId;

/// Which pairs of surfaces are linked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum TopLevel {
    /// All, before the first iteration.
    All,
    /// In each iteration those that carry more than `tolerance` W/m^2 by now: eps_link.
    Lazy {
        /// eps_link, in W/m^2.
        tolerance: f64,
    },
    /// All but those between surfaces that do not emit with form factors below this, in both directions.
    Culled {
        /// The smallest form factor that is worth a link.
        form_factor: f64,
    },
}

/// Surfaces as the look at all pairs sees them, in one row of memory.
#[derive(Clone, Copy)]
struct Place {
    node: NodeId,
    /// The brightest channel in W/m^2.
    brightness: f64,
    area: f64,
    emits: bool,
}

/// What a row's pairs became.
#[derive(Default)]
struct Classified {
    /// Worth a link if anything gets through: second surface, exchange.
    promising: Vec<Promising>,
    behind: u64,
}

/// Two nodes that are worth a link if anything gets through.
#[derive(Clone, Copy)]
pub(super) struct Promising {
    pub first: NodeId,
    pub second: NodeId,
    pub exchange: f64,
}

/// Rows that are worked, and may be stopped after, together.
const ROWS: usize = 256;

/// Pairs that ask for visibility together: about a thousand segments.
const CHUNK: usize = 64;

impl MutualLinks {
    /// Looks at all pairs of surfaces that are not classified yet, and links those that are worth it by now.
    pub fn link_surfaces(&mut self, hierarchy: &Hierarchy, context: &MutualContext<'_>, limits: &RefineLimits<'_>) -> RefineEnd {
        let places: Vec<Place> = (0..context.scene.surfaces().len() as u32)
            .map(|surface| {
                let node = hierarchy.node_of(SurfaceId(surface));
                let emits = context.scene.material_of(SurfaceId(surface)).emits();
                Place { node, brightness: context.brightness(hierarchy, node), area: hierarchy.area(node), emits }
            })
            .collect();
        let mut first_row = 0;
        while first_row < places.len() {
            if limits.says_stop(hierarchy, 2 * self.links.len()) {
                return RefineEnd::Stopped;
            }
            let last_row = (first_row + ROWS).min(places.len());
            let strategy = self.strategy;
            let rows: Vec<Classified> = self.unclassified.rows_mut()[first_row..last_row]
                .par_iter_mut()
                .map(|row| context.classify(hierarchy, strategy, &places, row))
                .collect();
            let behind = rows.iter().map(|row| row.behind).sum::<u64>();
            self.counts.behind += behind;
            let promising: Vec<Promising> = rows.into_iter().flat_map(|row| row.promising).collect();
            let before = self.links.len();
            self.unclassified_count -= promising.len() + behind as usize;
            let (to_go, limit) = self.links_to_go(hierarchy, limits, promising.len());
            let (promising, too_many) = promising.split_at(to_go);
            let linked = self.ask(hierarchy, context, promising);
            self.links.extend(linked);
            self.counts.top_level += (self.links.len() - before) as u64;

            // Pairs for which there is no room are unclassified again.
            if let Some(limit) = limit {
                let surface = |node: NodeId| hierarchy.node(node).surface as usize;
                too_many.iter().for_each(|pair| self.unclassified.insert(surface(pair.first), surface(pair.second)));
                self.unclassified_count += too_many.len();
                return limit;
            }
            first_row = last_row;
        }
        RefineEnd::Content
    }

    /// The links of the pairs of which a ray arrives; the others are noted as unseen.
    pub(super) fn ask(&mut self, hierarchy: &Hierarchy, context: &MutualContext<'_>, promising: &[Promising]) -> Vec<MutualLink> {
        let asked: Vec<Vec<Option<MutualLink>>> =
            promising.par_chunks(CHUNK).map(|pairs| context.ask_chunk(hierarchy, pairs)).collect();
        self.counts.rays += promising.len() as u64 * u64::from(RAYS_PER_LINK);
        let mut links = Vec::with_capacity(promising.len());
        for (pair, link) in promising.iter().zip(asked.into_iter().flatten()) {
            match link {
                Some(link) => links.push(link),
                None => self.unseen.push(Pair { receiver: pair.first, source: pair.second }),
            }
        }
        links
    }
}

impl MutualContext<'_> {
    /// Goes through the unclassified pairs of a row; those that are classified leave it.
    fn classify(&self, hierarchy: &Hierarchy, strategy: TopLevel, places: &[Place], row: &mut Row) -> Classified {
        let start = Instant::now();
        let first = places[row.first()];
        let mut found = Classified::default();
        row.retain(|second| {
            let second = places[second];

            // Not bright enough, or too far away for what they are? Then the pair stays unclassified.
            if let TopLevel::Lazy { tolerance } = strategy {
                let largest = bound_form_factor(hierarchy, first.node, second.node);
                let reaching =
                    (second.brightness * (largest / first.area).min(1.0)).max(first.brightness * (largest / second.area).min(1.0));
                if reaching <= tolerance {
                    return true;
                }
            }

            // Do they face each other?
            let (a, b) = (hierarchy.facet(first.node), hierarchy.facet(second.node));
            if self.plane(hierarchy, first.node) == self.plane(hierarchy, second.node) || behind(&a, &b) || behind(&b, &a) {
                found.behind += 1;
                return false;
            }

            // Is there enough of a form factor between them?
            let exchange = self.estimate_exchange(&a, &b);
            let is_worth_it = match strategy {
                TopLevel::All => true,
                TopLevel::Lazy { tolerance } => {
                    exchange * (second.brightness / first.area).max(first.brightness / second.area) > tolerance
                }
                TopLevel::Culled { form_factor } => {
                    first.emits || second.emits || exchange >= form_factor * first.area.min(second.area)
                }
            };
            if is_worth_it {
                found.promising.push(Promising { first: first.node, second: second.node, exchange });
            }
            !is_worth_it
        });
        self.note_form_factors(start);
        found
    }

    /// Casts the rays of some pairs; `None` for those of which none arrives.
    fn ask_chunk(&self, hierarchy: &Hierarchy, pairs: &[Promising]) -> Vec<Option<MutualLink>> {
        let (mut segments, mut kernels) = (Vec::new(), Vec::new());
        for pair in pairs {
            let seed = sampling::hash(self.seed, u64::from(pair.first.0) << 32 | u64::from(pair.second.0));
            let ends = Pair { receiver: pair.first, source: pair.second };
            sampled_pairs(self.scene, hierarchy, ends, RAYS_PER_LINK, seed, &mut segments, &mut kernels);
        }
        let mut occluded = Vec::new();
        self.rays.occluded(&segments, &mut occluded);
        let rays = RAYS_PER_LINK as usize;
        let link = |((pair, kernels), occluded): ((&Promising, &[f64]), &[bool])| {
            let is_fully_visible = occluded.iter().all(|occluded| !occluded);
            let visibility = if is_fully_visible { 1.0 } else { sampled_transmittance(kernels, occluded) };
            let Promising { first, second, exchange } = *pair;
            (visibility > 0.0).then_some(MutualLink {
                exchange,
                first,
                second,
                visibility: visibility as f32,
                is_fully_visible,
                is_reduced: false,
            })
        };
        pairs.iter().zip(kernels.chunks(rays)).zip(occluded.chunks(rays)).map(link).collect()
    }

    pub(super) fn plane(&self, hierarchy: &Hierarchy, node: NodeId) -> u32 {
        self.scene.surface(SurfaceId(hierarchy.node(node).surface)).plane
    }
}

/// `A F` in m^2 is at most this: areas over pi times the square of the least distance; infinite where they may touch.
fn bound_form_factor(hierarchy: &Hierarchy, first: NodeId, second: NodeId) -> f64 {
    let (a, b) = (hierarchy.node(first), hierarchy.node(second));
    let gap = a.centroid.distance(b.centroid) - a.radius - b.radius;
    if gap > 0.0 { a.area * b.area / (PI * gap * gap) } else { f64::INFINITY }
}
