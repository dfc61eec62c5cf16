//! Bounds on radiosities: of few surfaces over elements of their own, else over the links of a solve.

use serde::{Deserialize, Serialize};

use super::adaptive::{Adapted, bound_adaptively, is_small};
use super::assembly::assemble;
use super::element_bounds::{ElementBounds, are_bounds};
use super::form_factors::FormFactorRule;
use super::input::BoundsInput;
use super::iteration::{MOST_SWEEPS, SWEEP_TOLERANCE};
use super::pairs::bounded_pairs;
use super::report::{BoundsReport, report};
use super::system::Iterate;
use crate::hierarchy::{Hierarchy, NodeId};
use crate::scene::Scene;

/// Lower and upper radiosities of every node: they hold at every point of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RadiosityBounds {
    pub(super) channels: usize,
    pub(super) lower: Vec<f64>,
    pub(super) upper: Vec<f64>,
    /// Where bounds have elements of their own: what bounds at points are gathered from.
    pub(super) elements: Option<ElementBounds>,
}

impl RadiosityBounds {
    /// No point of a node has less than this, in W/m^2 by channel.
    pub fn lower(&self, node: NodeId) -> &[f64] {
        &self.lower[node.index() * self.channels..][..self.channels]
    }

    /// No point of a node has more than this, in W/m^2 by channel.
    pub fn upper(&self, node: NodeId) -> &[f64] {
        &self.upper[node.index() * self.channels..][..self.channels]
    }

    /// How many channels each node has.
    pub fn channels(&self) -> usize {
        self.channels
    }

    /// Makes anew what is not stored, and checks what was read from a file: that there are bounds of every node, and that they can be such.
    /// Whether they are proved is not seen.
    ///
    /// # Errors
    /// Says what is wrong.
    pub(crate) fn restore(&mut self, scene: &Scene, hierarchy: &Hierarchy) -> Result<(), String> {
        let fits = |values: &[f64]| values.len() == hierarchy.len() * scene.channels();
        if self.channels != scene.channels() || !fits(&self.lower) || !fits(&self.upper) {
            return Err("the bounds do not fit the hierarchy".to_owned());
        }
        are_bounds(&self.lower, &self.upper)?;
        self.elements.as_mut().map_or(Ok(()), |elements| elements.restore(scene))
    }
}

/// Bounds every node: the proof that is the best for the scene. In the current rayon pool; the same for any number of threads.
pub(crate) fn bound_radiosities(input: &BoundsInput<'_>) -> (RadiosityBounds, BoundsReport) {
    if input.rule == FormFactorRule::CentreAndVertices || !is_small(input) {
        return bound_over_links(input);
    }
    let Adapted { bounds, pairs, sweeps } = bound_adaptively(input);
    let system = assemble(input.scene, bounds.hierarchy(), &pairs);
    let report = report((input.scene, bounds.hierarchy()), &system, &pairs, &bounds.iterate(), (sweeps, false));
    let [lower, upper] = bounds.of_nodes(input.hierarchy);
    (RadiosityBounds { channels: input.scene.channels(), lower, upper, elements: Some(bounds) }, report)
}

/// Bounds every node over the links of the solve, whatever the scene.
pub(crate) fn bound_over_links(input: &BoundsInput<'_>) -> (RadiosityBounds, BoundsReport) {
    let pairs = bounded_pairs(input);
    let system = assemble(input.scene, input.hierarchy, &pairs);
    let (iterate, sweeps) = system.solve(SWEEP_TOLERANCE, MOST_SWEEPS, input.stop);
    let report = report((input.scene, input.hierarchy), &system, &pairs, &iterate, (sweeps, true));
    let Iterate { lower, upper } = iterate;
    (RadiosityBounds { channels: input.scene.channels(), lower, upper, elements: None }, report)
}
