//! One cluster for ever larger errors.

use patchlight::flatland::{Approximation, Hierarchy, Segment, Sightlines, bound_visibility_error, exact_form_factor, form_factor};

use super::clusters::{Shape, ends};
use super::cpu::cpu_seconds;

/// Directions that clusters store functions at.
const DIRECTIONS: usize = 128;

/// Errors from 0 to the one from which on the root is taken as a whole.
const STEPS: usize = 20;

/// Calls are repeated for so many CPU seconds.
const ENOUGH_S: f64 = 0.05;

/// A cluster and what was found for each error.
pub struct Ladder {
    pub shape: Shape,
    pub segments: Vec<Segment>,
    pub unoccluded: f64,
    pub exact: f64,
    /// The part of the form factor that goes through the root's box, and BVE of the root.
    pub through_box: f64,
    pub root_error: f64,
    pub clusters: usize,
    /// CPU seconds of the hierarchy and of the exact form factor.
    pub hierarchy_s: f64,
    pub exact_s: f64,
    pub rungs: Vec<Rung>,
}

/// What was found for an error.
pub struct Rung {
    pub tolerance: f64,
    pub found: Approximation,
    pub cpu_s: f64,
}

impl Ladder {
    pub fn of(shape: Shape) -> Self {
        let ([receiver, source], segments) = (ends(), shape.segments());
        let (hierarchy, hierarchy_s) = timed(|| Hierarchy::of(&segments, DIRECTIONS));
        let (exact, exact_s) = timed(|| exact_form_factor(&receiver, &source, &segments));
        let sightlines = Sightlines::between(&receiver, &source).expect("the ends face each other");
        let root = hierarchy.root().expect("there are segments");
        let seen = bound_visibility_error(&sightlines, &hierarchy, root).expect("light meets the cluster");
        let root_error = seen.as_whole.expect("the cluster is in between").error;

        let rung = |step: usize| {
            let tolerance = root_error * step as f64 / STEPS as f64;
            let (found, cpu_s) = timed(|| form_factor(&receiver, &source, &hierarchy, tolerance));
            let off = (found.form_factor - exact).abs();
            assert!(off <= found.error + 1e-12 && found.error <= tolerance, "{off} off, {} claimed", found.error);
            Rung { tolerance, found, cpu_s }
        };
        Self {
            shape,
            unoccluded: sightlines.unoccluded(),
            exact,
            through_box: seen.through_box,
            root_error,
            clusters: hierarchy.clusters(),
            hierarchy_s,
            exact_s,
            rungs: (0..=STEPS).map(rung).collect(),
            segments,
        }
    }
}

/// A result and the CPU seconds that it takes.
fn timed<T>(work: impl Fn() -> T) -> (T, f64) {
    let start = cpu_seconds();
    let mut calls = 0;
    loop {
        let result = work();
        calls += 1;
        let spent = cpu_seconds() - start;
        if spent >= ENOUGH_S {
            return (result, spent / f64::from(calls));
        }
    }
}
