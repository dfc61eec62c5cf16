//! Pairs of surfaces: which of them are linked, and when.
//!
//! The original algorithm links all pairs before anything else (Hanrahan, Salzman, Aupperle 1991). Lazy linking (Holzschuch, Sillion,
//! Drettakis 1994, section 3.1) leaves a pair unclassified, without a ray, until BF exceeds eps_link. Link culling (Lischinski 1994,
//! section 4.1.1) links all pairs at first but for those between reflecting surfaces with little form factor, which it forgets.

use std::f64::consts::PI;
use std::time::Instant;

use rayon::prelude::*;

use super::ask::Promising;
use super::context::MutualContext;
use super::mutual_links::{MutualLinks, TopLevel};
use super::pairs::Row;
use crate::hierarchy::{Hierarchy, NodeId};
use crate::links::exchange::behind;
use crate::links::limits::{RefineEnd, RefineLimits};
use crate::scene::SurfaceId;

/// A surface with what classifying its pairs needs, in one row of memory.
#[derive(Clone, Copy)]
struct SurfaceEntry {
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

/// Rows that are worked, and may be stopped after, together; of fewer pairs than these in all, some tenths of a second.
const ROWS: usize = 256;
const PAIRS: usize = 1 << 20;

impl MutualLinks {
    /// Goes through all pairs of surfaces that are not classified yet, and links those that are worth it by now.
    pub fn link_surfaces(&mut self, hierarchy: &Hierarchy, context: &MutualContext<'_>, limits: &RefineLimits<'_>) -> RefineEnd {
        let surfaces: Vec<SurfaceEntry> = (0..context.scene.surfaces().len() as u32)
            .map(|surface| {
                let node = hierarchy.node_of(SurfaceId(surface));
                let emits = context.scene.material_of(SurfaceId(surface)).emits();
                SurfaceEntry { node, brightness: context.brightness(hierarchy, node), area: hierarchy.area(node), emits }
            })
            .collect();
        let rows_at_once = (PAIRS / surfaces.len().max(1)).clamp(1, ROWS);
        let mut first_row = 0;
        while first_row < surfaces.len() {
            if let Some(end) = limits.says_end(hierarchy, 2 * self.links.len(), 0) {
                return end;
            }
            let last_row = (first_row + rows_at_once).min(surfaces.len());
            let strategy = self.strategy;
            let rows: Vec<Classified> = self.unclassified.rows_mut()[first_row..last_row]
                .par_iter_mut()
                .map(|row| context.classify(hierarchy, strategy, &surfaces, row))
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
}

impl MutualContext<'_> {
    /// Goes through the unclassified pairs of a row; those that are classified leave it.
    fn classify(&self, hierarchy: &Hierarchy, strategy: TopLevel, surfaces: &[SurfaceEntry], row: &mut Row) -> Classified {
        let start = Instant::now();
        let first = surfaces[row.first()];
        let mut found = Classified::default();
        row.retain(|second| {
            let second = surfaces[second];

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
}

/// `A F` in m^2 is at most this: areas over pi times the square of the least distance; infinite where they may touch.
fn bound_form_factor(hierarchy: &Hierarchy, first: NodeId, second: NodeId) -> f64 {
    let (a, b) = (hierarchy.node(first), hierarchy.node(second));
    let gap = a.centroid.distance(b.centroid) - a.radius - b.radius;
    if gap > 0.0 { a.area * b.area / (PI * gap * gap) } else { f64::INFINITY }
}
