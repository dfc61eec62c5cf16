//! What linking decides by.

use crate::scene::Scene;
use crate::transmittance::Rays;

/// From which end of the trees pairs of nodes are judged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum RefineDirection {
    /// Samples on the smallest elements, combined for what is above them.
    BottomUp,
    /// Samples on every node that is judged, for itself.
    TopDown,
}

/// What linking decides by: everything but the hierarchy, which grows.
pub(crate) struct SampledContext<'a> {
    pub scene: &'a Scene,
    pub rays: &'a Rays<'a>,
    pub direction: RefineDirection,
    /// F_eps: a link's form factors may be wrong by less than this.
    pub form_factor_tolerance: f64,
    /// A_eps in m^2: no element is smaller.
    pub min_area: f64,
    /// Points on each node that is sampled; the kernel is taken between all points of two nodes.
    pub samples: u32,
    pub seed: u64,
}
