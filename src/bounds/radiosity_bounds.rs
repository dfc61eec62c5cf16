//! Bounds on radiosities over the links of a solve: form factors, the system, its iteration, the report.

use super::assembly::assemble;
use super::input::BoundsInput;
use super::iteration::{MOST_SWEEPS, SWEEP_TOLERANCE};
use super::pairs::bounded_pairs;
use super::report::{BoundsReport, report};
use super::system::Iterate;
use crate::hierarchy::NodeId;

/// Lower and upper radiosities of every node: they hold at every point of it.
#[derive(Clone, Debug, PartialEq)]
pub struct RadiosityBounds {
    pub(super) channels: usize,
    pub(super) lower: Vec<f64>,
    pub(super) upper: Vec<f64>,
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
}

/// Bounds every node. In the current rayon pool; the same for any number of threads.
pub(crate) fn bound_radiosities(input: &BoundsInput<'_>) -> (RadiosityBounds, BoundsReport) {
    let pairs = bounded_pairs(input);
    let system = assemble(input, &pairs);
    let (iterate, sweeps) = system.solve(SWEEP_TOLERANCE, MOST_SWEEPS, input.stop);
    let report = report(input, &system, &pairs, &iterate, sweeps);
    let Iterate { lower, upper } = iterate;
    (RadiosityBounds { channels: input.scene.channels(), lower, upper }, report)
}
