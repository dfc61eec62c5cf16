//! A link with what samples of its kernel tell.

use super::kernels::Kernel;
use crate::hierarchy::{Hierarchy, NodeId};
use crate::links::link_set::{Link, LinkSet, Pair};

/// A link for both directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SampledLink {
    pub first: NodeId,
    pub second: NodeId,
    pub kernel: Kernel,
}

/// Whether the error of both form factors is below the tolerance: `max G A < F_eps`. The paper's procedure Error.
pub(super) fn is_within(hierarchy: &Hierarchy, first: NodeId, second: NodeId, kernel: Kernel, tolerance: f64) -> bool {
    kernel.largest * hierarchy.area(first).max(hierarchy.area(second)) < tolerance
}

/// The links by receiver, both directions.
pub(super) fn link_set(hierarchy: &Hierarchy, linked: &[SampledLink], dormant: Vec<Pair>) -> LinkSet {
    let mut placed = Vec::with_capacity(2 * linked.len());
    for &SampledLink { first, second, kernel } in linked {
        let visibility = if kernel.unoccluded > 0.0 { (kernel.exchange / kernel.unoccluded).min(1.0) as f32 } else { 1.0 };
        for (receiver, source) in [(first, second), (second, first)] {
            // Samples that are close to each other may make more of it than a form factor can be.
            let form_factor = (kernel.unoccluded / hierarchy.area(receiver)).min(1.0);
            placed.push((receiver, Link { form_factor, source, transmittance: visibility, seen: visibility }));
        }
    }
    LinkSet::new(hierarchy.len(), &placed, dormant)
}
