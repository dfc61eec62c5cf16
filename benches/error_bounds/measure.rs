//! Errors of the elements of the floor: measured against the reference, and as bounds and estimates tell.

use patchlight::bounds::RadiosityBounds;
use patchlight::hierarchy::{Hierarchy, NodeId};
use patchlight::pipeline::{self, Evaluator};
use patchlight::progress::Silent;
use patchlight::scene::SurfaceId;
use patchlight::solve::{LinkOptions, RunOptions, Solution, SolveOptions, SolveReport};

use super::configurations::Configuration;
use super::reference::PROBES;

/// Errors over the floor in two norms: the L1 norm as a part of the mean radiosity, the maximum as a part of the same.
#[derive(Clone, Copy, Debug, Default)]
pub struct Errors {
    pub l1: f64,
    pub l_infinity: f64,
}

/// Everything but refinement and element size: radiosities of elements by links alone, with so many rays that their noise does not count.
pub fn options() -> SolveOptions {
    SolveOptions {
        error: 0.9,
        point_rays: Some(1),
        links: LinkOptions {
            leaf_rays: Some(0),
            rays_per_link: 64,
            rays_per_light_link: 256,
            form_factor_accuracy: 1e-3,
            sweep_tolerance: 1e-6,
            ..LinkOptions::default()
        },
        ..SolveOptions::default()
    }
}

pub fn solve(configuration: Configuration, options: &SolveOptions) -> (Evaluator, SolveReport) {
    pipeline::solve(configuration.scene(), options, &RunOptions::default(), &Silent).expect("options that are legal")
}

/// The leaf of the floor under each probe.
pub fn leaves_under_probes(hierarchy: &Hierarchy) -> Vec<NodeId> {
    let floor = SurfaceId(0);
    let mut under = vec![NodeId::ROOT; PROBES * PROBES];
    for leaf in hierarchy.ids().filter(|&node| hierarchy.is_leaf(node) && hierarchy.surface_of(node) == Some(floor)) {
        let [columns, rows] = [0, 1].map(|axis| {
            let places = hierarchy.polygon(leaf).into_iter().map(|vertex| vertex[axis] * PROBES as f64 - 0.5);
            let (low, high) = places.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (x.min(low), x.max(high)));
            low.ceil().max(0.0) as usize..(high.ceil().max(0.0) as usize).min(PROBES)
        });
        for row in rows {
            columns.clone().for_each(|column| under[row * PROBES + column] = leaf);
        }
    }
    assert!(!under.contains(&NodeId::ROOT), "every probe lies on an element");
    under
}

/// What the elements are off by at the probes.
pub fn measured(solution: &Solution, reference: &[f64]) -> Errors {
    let under = leaves_under_probes(solution.hierarchy());
    let off = |(leaf, exact): (&NodeId, &f64)| (solution.radiosity().of(*leaf)[0] - exact).abs();
    relative(under.iter().zip(reference).map(off), reference)
}

/// What bounds, or estimates of ranges, say of the same: half the width at most (equation 5.4), a quarter of it on average (5.7).
pub fn claimed(solution: &Solution, ranges: &RadiosityBounds, reference: &[f64]) -> Errors {
    let under = leaves_under_probes(solution.hierarchy());
    let half_width = |leaf: &NodeId| 0.5 * (ranges.upper(*leaf)[0] - ranges.lower(*leaf)[0]);
    let errors = relative(under.iter().map(half_width), reference);
    Errors { l1: 0.5 * errors.l1, ..errors }
}

/// How many probes lie outside of the bounds of their element.
pub fn violations(solution: &Solution, ranges: &RadiosityBounds, reference: &[f64]) -> usize {
    let under = leaves_under_probes(solution.hierarchy());
    let outside = |&(&leaf, &exact): &(&NodeId, &f64)| exact < ranges.lower(leaf)[0] || exact > ranges.upper(leaf)[0];
    under.iter().zip(reference).filter(outside).count()
}

fn relative(errors: impl Iterator<Item = f64>, reference: &[f64]) -> Errors {
    let mean = reference.iter().sum::<f64>() / reference.len() as f64;
    let (sum, most) = errors.fold((0.0, 0.0), |(sum, most), error: f64| (sum + error, error.max(most)));
    Errors { l1: sum / reference.len() as f64 / mean, l_infinity: most / mean }
}
