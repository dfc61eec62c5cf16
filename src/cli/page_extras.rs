//! `--plane` and `--curves`: what a page shows beside the light.

use patchlight::discontinuities::{CurveSegment, TOLERANCE_SHOWN};
use patchlight::output::MeasuredPlane;
use patchlight::picture::PlaneRequest;
use patchlight::pipeline::Evaluator;
use patchlight::scene::Scene;

use super::argument_groups::PageArguments;
use super::exit::{Exit, Failure};
use super::interrupt;
use super::progress::{Voice, Watcher};
use super::sensors::measured_on;

/// What was asked for, valid but for the scene.
#[derive(Clone, Debug, Default)]
pub struct PageExtras {
    planes: Vec<NamedPlane>,
    curves: bool,
}

/// A plane as it was typed, and what that means.
#[derive(Clone, Debug)]
struct NamedPlane {
    name: String,
    request: PlaneRequest,
}

/// What was found.
#[derive(Clone, Debug, Default)]
pub struct FoundExtras {
    /// What planes measure.
    pub planes: Vec<MeasuredPlane>,
    /// Where light is not smooth.
    pub curves: Vec<CurveSegment>,
}

impl PageExtras {
    /// What was typed.
    pub fn new(typed: &PageArguments) -> Result<Self, Failure> {
        let mut planes = Vec::new();
        for name in &typed.plane {
            planes.push(NamedPlane { request: name.parse().map_err(Failure::usage)?, name: name.clone() });
        }
        Ok(Self { planes, curves: typed.curves })
    }

    /// Whether nothing was asked for.
    pub fn is_empty(&self) -> bool {
        self.planes.is_empty() && !self.curves
    }

    fn in_words(&self) -> &'static str {
        match (self.planes.is_empty(), self.curves) {
            (true, _) => "curves",
            (false, true) => "measuring planes and curves",
            (false, false) => "measuring planes",
        }
    }

    /// Finds out before the long work whether there are such planes in a scene.
    pub fn check(&self, scene: &Scene) -> Result<(), Failure> {
        self.planes.iter().try_for_each(|plane| plane.request.in_scene(scene).map(|_| ()).map_err(Failure::usage))
    }

    /// Finds them; how it ends if an interrupt left some out, which is told. Whoever interrupted the solve does not wait.
    pub fn find(&self, evaluator: &Evaluator, voice: Voice) -> Result<(FoundExtras, Option<Exit>), Failure> {
        let mut found = FoundExtras::default();
        if self.is_empty() {
            return Ok((found, None));
        }
        if interrupt::count() > 0 {
            voice.warn(format_args!("{} are left out: interrupted", self.in_words()));
            return Ok((found, Some(Exit::Cancelled)));
        }
        // An interrupt ends all of them.
        let (watcher, mut left_out) = (Watcher::new(voice), 0);
        for NamedPlane { name, request } in &self.planes {
            let (plane, missing) = measured_on(evaluator, (request, name.clone()), &watcher)?;
            left_out += missing;
            found.planes.push(plane);
        }
        let curves = if self.curves { evaluator.curves(TOLERANCE_SHOWN, &watcher) } else { Some(Vec::new()) };
        drop(watcher);
        if left_out > 0 {
            voice.warn(format_args!("{left_out} sensors of measuring planes were not measured: interrupted"));
        }
        if curves.is_none() {
            voice.warn(format_args!("curves are left out: interrupted"));
        }
        let is_cut_short = left_out > 0 || curves.is_none();
        found.curves = curves.unwrap_or_default();
        Ok((found, is_cut_short.then_some(Exit::Cancelled)))
    }
}
