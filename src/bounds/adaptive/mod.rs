//! Bounds of scenes with few surfaces: over elements of their own, which are split where that narrows the bounds most for its cost.
//!
//! Every element that reflects has a list of sources, which together are all surfaces: at first these, later elements of them. Of each it
//! is known between which numbers the visible form factor lies (`form_factors::pair`). From these follow the bounds of all elements
//! (`system`), and from these what each entry of each list adds to the mean relative width (`attribution`): because the form factor varies
//! over the receiver, which then is split, or because the radiosity varies over the source, which then is replaced by its children.
//!
//! So the loop is driven by what is left of the width, and knows nothing of the links of the solve. It ends when the bounds have come as
//! close as the error that was asked for, when the work is done, or when it is told to; bounds hold whenever it ends.

mod choice;
mod refinement;

use super::assembly::assemble;
use super::element_bounds::ElementBounds;
use super::form_factors::BoundedPair;
use super::input::BoundsInput;
use super::iteration::{MOST_SWEEPS, SWEEP_TOLERANCE};
use super::system::{Iterate, System};
use crate::scene::{DistinctChannels, Scene};
use refinement::{Refinement, WORK_OF_POLYGONS};

/// The work if none is asked for: some tenths of a second where little is in the way.
const DEFAULT_WORK: u64 = 1 << 17;

/// All pairs of surfaces, with which the loop starts, may take this part of the default work at most: else little would be left to split.
const MOST_AT_FIRST: f64 = 0.25;

/// While elements are split, sweeps end when they change bounds by less than this part of the widest gap.
const ROUGH_TOLERANCE: f64 = 0.02;

/// What was found.
pub(super) struct Adapted {
    pub bounds: ElementBounds,
    pub pairs: Vec<BoundedPair>,
    pub sweeps: u32,
}

/// The work that is done in a scene.
fn work_of(input: &BoundsInput<'_>) -> u64 {
    input.work.unwrap_or(DEFAULT_WORK)
}

/// Whether a scene has so few surfaces that all pairs of them can be bounded, with work left to split them.
pub(super) fn is_small(input: &BoundsInput<'_>) -> bool {
    let pairs = (input.scene.surfaces().len() as u64).saturating_pow(2);
    (pairs.saturating_mul(WORK_OF_POLYGONS) as f64) <= MOST_AT_FIRST * DEFAULT_WORK as f64
}

/// Bounds the elements of a small scene.
pub(super) fn bound_adaptively(input: &BoundsInput<'_>) -> Adapted {
    let distinct = DistinctChannels::of(input.scene);
    let scene: &Scene = distinct.as_ref().map_or(input.scene, |distinct| &distinct.scene);
    let mut refinement = Refinement::new(scene, input);
    let mut iterate: Option<Iterate> = None;
    loop {
        // Bounds over the elements so far; those of before hold for their parts.
        let pairs = refinement.pairs();
        let system = System { plans: Some(refinement.plans()), ..assemble(scene, refinement.hierarchy(), &pairs) };
        let begin = match iterate.take() {
            Some(before) => refinement.inherited(before, system.channels),
            None => system.trivial(),
        };
        let is_last = refinement.work() >= work_of(input) || (input.stop)();
        let tolerance = if is_last { SWEEP_TOLERANCE } else { ROUGH_TOLERANCE };
        let (found, sweeps) = system.solve_from(begin, tolerance, MOST_SWEEPS, input.stop);

        // Split what leaves most open, unless it is enough.
        let choice = choice::choose(&system, &found, &refinement, input.error, work_of(input));
        if is_last || choice.is_empty() {
            let (found, more) = system.solve_from(found, SWEEP_TOLERANCE, MOST_SWEEPS, input.stop);
            let expand = |values: Vec<f64>| match &distinct {
                Some(distinct) => distinct.expand(&values),
                None => values,
            };
            let (lower, upper) = (expand(found.lower), expand(found.upper));
            let bounds = ElementBounds::new(refinement.into_hierarchy(), input.scene.channels(), lower, upper);
            return Adapted { bounds, pairs, sweeps: sweeps + more };
        }
        drop(system);
        refinement.split(&choice, input.stop);
        iterate = Some(found);
    }
}
