//! What pairs of surfaces without a link could transfer at most: their form factors as if nothing were in between.

use rayon::prelude::*;

use super::{MutualContext, MutualLinks};
use crate::hierarchy::Hierarchy;
use crate::links::exchange::behind;
use crate::scene::SurfaceId;

/// What could reach each surface over the pairs that have no link; an estimate, because form factors are.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct DormantTransfer {
    channels: usize,
    form_factors: Vec<f64>,
    irradiance: Vec<f64>,
}

impl DormantTransfer {
    /// The sum of a surface's form factors to all surfaces that it has no link with; above 1 where these hide one another.
    pub fn form_factor(&self, surface: SurfaceId) -> f64 {
        self.form_factors[surface.index()]
    }

    /// The irradiance from there by channel, in W/m^2, if nothing were in between.
    pub fn irradiance(&self, surface: SurfaceId) -> &[f64] {
        &self.irradiance[surface.index() * self.channels..][..self.channels]
    }
}

impl MutualLinks {
    /// Adds up what the pairs that are still unclassified could transfer. O(n^2) form factors.
    pub fn estimate_dormant_transfer(&self, hierarchy: &Hierarchy, context: &MutualContext<'_>) -> DormantTransfer {
        let channels = context.scene.channels();
        let count = context.scene.surfaces().len();
        let node = |surface: usize| hierarchy.node_of(SurfaceId(surface as u32));
        let radiosity = |surface: usize| &context.radiosity[node(surface).index() * channels..][..channels];

        // The form factors in parallel, row by row; the sums in order.
        let rows: Vec<Vec<(usize, f64)>> = (self.unclassified.rows().par_iter())
            .map(|row| {
                let first = hierarchy.facet(node(row.first()));
                let exchanged = |second: usize| {
                    let (other, in_plane) = (
                        hierarchy.facet(node(second)),
                        context.plane(hierarchy, node(row.first())) == context.plane(hierarchy, node(second)),
                    );
                    let is_facing = !in_plane && !behind(&first, &other) && !behind(&other, &first);
                    is_facing.then(|| (second, context.estimate_exchange(&first, &other)))
                };
                row.iter().filter_map(exchanged).collect()
            })
            .collect();
        let mut transfer = DormantTransfer { channels, form_factors: vec![0.0; count], irradiance: vec![0.0; count * channels] };
        for (first, row) in rows.into_iter().enumerate() {
            for (second, exchange) in row {
                for (receiver, source) in [(first, second), (second, first)] {
                    let form_factor = exchange / hierarchy.area(node(receiver));
                    transfer.form_factors[receiver] += form_factor;
                    let sums = &mut transfer.irradiance[receiver * channels..][..channels];
                    sums.iter_mut().zip(radiosity(source)).for_each(|(h, b)| *h += form_factor * b);
                }
            }
        }
        transfer
    }
}
