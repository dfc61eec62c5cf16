//! `--plane` of pages: measuring planes that a page shows.

use patchlight::output::MeasuredPlane;
use patchlight::picture::PlaneRequest;
use patchlight::pipeline::Evaluator;
use patchlight::scene::Scene;

use super::argument_groups::PlaneArguments;
use super::exit::{Exit, Failure};
use super::interrupt;
use super::progress::{Voice, Watcher};
use super::sensors::measured_on;

/// A plane as it was typed, and what that means.
#[derive(Clone, Debug)]
pub struct NamedPlane {
    name: String,
    request: PlaneRequest,
}

/// What was typed of planes.
pub fn parse(typed: &PlaneArguments) -> Result<Vec<NamedPlane>, Failure> {
    let named = |name: &String| Ok(NamedPlane { request: name.parse().map_err(Failure::usage)?, name: name.clone() });
    typed.plane.iter().map(named).collect()
}

/// Finds out before the long work whether there are such planes in a scene.
pub fn check(planes: &[NamedPlane], scene: &Scene) -> Result<(), Failure> {
    planes.iter().try_for_each(|plane| plane.request.in_scene(scene).map(|_| ()).map_err(Failure::usage))
}

/// What they measure, and how it ends if an interrupt left sensors out, which is told. Whoever interrupted the solve does not wait for planes.
pub fn measure(evaluator: &Evaluator, planes: &[NamedPlane], voice: Voice) -> Result<(Vec<MeasuredPlane>, Option<Exit>), Failure> {
    if planes.is_empty() {
        return Ok((Vec::new(), None));
    }
    if interrupt::count() > 0 {
        voice.warn(format_args!("measuring planes are left out: interrupted"));
        return Ok((Vec::new(), Some(Exit::Cancelled)));
    }
    // An interrupt ends all of them.
    let (watcher, mut measured, mut left_out) = (Watcher::new(voice), Vec::new(), 0);
    for NamedPlane { name, request } in planes {
        let (plane, missing) = measured_on(evaluator, (request, name.clone()), &watcher)?;
        left_out += missing;
        measured.push(plane);
    }
    drop(watcher);
    if left_out > 0 {
        voice.warn(format_args!("{left_out} sensors of measuring planes were not measured: interrupted"));
    }
    Ok((measured, (left_out > 0).then_some(Exit::Cancelled)))
}
