//! The form factors of the pairs of surfaces that have no link, as if nothing were in between: what the ambient term may stand for.
//! What such pairs hold back at most is bounded elsewhere (`bounds::held_back`).

use rayon::prelude::*;

use super::context::MutualContext;
use super::mutual_links::MutualLinks;
use crate::hierarchy::Hierarchy;
use crate::links::exchange::behind;
use crate::progress::Stop;
use crate::scene::SurfaceId;

impl MutualLinks {
    /// The sum of each surface's form factors to all surfaces with which it is still unclassified; above 1 where these hide one another. An
    /// estimate, because form factors are. O(n^2). `None` if stopped.
    pub fn estimate_dormant_form_factors(
        &self,
        hierarchy: &Hierarchy,
        context: &MutualContext<'_>,
        stop: Stop<'_>,
    ) -> Option<Vec<f64>> {
        let count = context.scene.surfaces().len();
        let node = |surface: usize| hierarchy.node_of(SurfaceId(surface as u32));

        // The form factors in parallel, row by row; the sums in order.
        let rows: Option<Vec<Vec<(usize, f64)>>> = (self.unclassified.rows().par_iter())
            .map(|row| {
                if stop() {
                    return None;
                }
                let first = hierarchy.facet(node(row.first()));
                let exchanged = |second: usize| {
                    let (other, in_plane) = (
                        hierarchy.facet(node(second)),
                        context.plane(hierarchy, node(row.first())) == context.plane(hierarchy, node(second)),
                    );
                    let is_facing = !in_plane && !behind(&first, &other) && !behind(&other, &first);
                    is_facing.then(|| (second, context.estimate_exchange(&first, &other)))
                };
                Some(row.iter().filter_map(exchanged).collect())
            })
            .collect();
        let mut sums = vec![0.0; count];
        for (first, row) in rows?.into_iter().enumerate() {
            for (second, exchange) in row {
                sums[first] += exchange / hierarchy.area(node(first));
                sums[second] += exchange / hierarchy.area(node(second));
            }
        }
        Some(sums)
    }
}
