//! Solutions that follow from one that is there: other weights of light groups, and other materials over stored transport.

use std::ffi::c_char;
use std::sync::Arc;

use patchlight::pipeline::Evaluator;
use patchlight::scene::{LightWeight, Material};
use patchlight::solve::{ErrorReport, SolveOptions};

use super::{Known, Solution, cancelled, patchlight_solution};
use crate::array::{patchlight_array, reals};
use crate::entry::enter;
use crate::handles;
use crate::memory::{Buffer, Out};
use crate::observer::Watcher;
use crate::solve::check_answers;
use crate::status::{Ending, Outcome, PATCHLIGHT_LIMIT, PATCHLIGHT_NOT_AVAILABLE, PATCHLIGHT_OUT_OF_RANGE, patchlight_status};

impl Solution {
    /// The names of its light groups.
    fn group_names(&self) -> Outcome<&[String]> {
        let message = "this solution has no light groups: see patchlight_scene_group_lights";
        let groups = self.evaluator.solution().scene().light_groups();
        groups.map(|groups| groups.names()).ok_or_else(|| Ending::new(PATCHLIGHT_NOT_AVAILABLE, message))
    }

    /// One that follows from it, of which so much is known.
    fn followed_by(&self, evaluator: Evaluator, known: Known) -> Arc<Self> {
        let next = Self::new(self.context.clone(), evaluator, known, self.failed.clone());
        next.set_listener(self.listener());
        Arc::new(next)
    }
}

/// How many light groups a solution has; 0 for one that was solved without.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn patchlight_solution_light_group_count(
    solution: *mut patchlight_solution,
    count: *mut usize,
) -> patchlight_status {
    enter(|| {
        let solution = handles::get(solution)?;
        // SAFETY: The contract of the header.
        let out = unsafe { Out::new(count, "count")? };
        out.set(solution.group_names().map_or(0, <[String]>::len))
    })
}

/// The name of a light group, counted from 0, and the zero behind it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn patchlight_solution_light_group_name(
    solution: *mut patchlight_solution,
    group: usize,
    buffer: *mut c_char,
    capacity: usize,
    count: *mut usize,
) -> patchlight_status {
    enter(|| {
        let solution = handles::get(solution)?;
        // SAFETY: The contract of the header.
        let buffer = unsafe { Buffer::new(buffer, capacity, count)? };
        let names = solution.group_names()?;
        let beyond = || Ending::argument(format_args!("group is {group}, there are {}", names.len()));
        buffer.write_text(names.get(group).ok_or_else(beyond)?)
    })
}

/// A solution with other weights for its light groups: a weighted sum of what is stored, exact and quick. An item of `weights` is a group, in
/// their order, with a weight from 0 on for each channel; as it was solved they are 1. What is known of its error is by energy:
/// PATCHLIGHT_ERROR_ESTIMATE and PATCHLIGHT_ERROR_ENERGY. Visibility and the progress function are those of `solution`, which stays as it is.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn patchlight_solution_relight(
    solution: *mut patchlight_solution,
    weights: *const patchlight_array,
    relit: *mut *mut patchlight_solution,
) -> patchlight_status {
    enter(|| {
        let solution = handles::get(solution)?;
        let (names, channels) = (solution.group_names()?, solution.evaluator.solution().scene().channels());
        // SAFETY: The contract of the header.
        let (out, weights) = unsafe { (Out::new(relit, "relit")?, reals(weights, channels, "weights")?) };
        if weights.len() != names.len() * channels {
            let message = format!("there are weights for {} groups, the solution has {}", weights.len() / channels, names.len());
            return Err(Ending::argument(message));
        }
        let by_group = names.iter().zip(weights.chunks_exact(channels));
        let weights: Vec<LightWeight> =
            by_group.map(|(group, by_band)| LightWeight { group: group.clone(), by_band: by_band.to_vec() }).collect();
        let evaluator = solution.evaluator.relit(&weights).map_err(|error| Ending::new(PATCHLIGHT_OUT_OF_RANGE, error))?;
        let error = evaluator.solution().light_groups_report().unwrap_or_default().error;
        out.set(handles::create(solution.followed_by(evaluator, Known::Weighted(error))))
    })
}

/// A solution of the same surfaces with other materials, over the transport that was stored with the option `keep_transport`: no ray is cast. Items are the
/// materials, in their order, with a number for each channel, as in patchlight_scene_add_materials; NULL leaves reflectances or exitances as they
/// are. PATCHLIGHT_LIMIT if more than `error` is claimed, or where that is 0 more than the solution was asked for: there is a solution. The progress
/// function of `solution`, which stays as it is, may cancel. PATCHLIGHT_NOT_AVAILABLE without stored transport.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn patchlight_solution_with_materials(
    solution: *mut patchlight_solution,
    reflectance: *const patchlight_array,
    exitance: *const patchlight_array,
    error: f64,
    changed: *mut *mut patchlight_solution,
) -> patchlight_status {
    enter(|| {
        let solution = handles::get(solution)?;
        let lit = solution.evaluator.solution();
        // SAFETY: The contract of the header.
        let (out, mut materials) = unsafe { (Out::new(changed, "changed")?, lit.scene().materials().to_vec()) };
        let requested = if error == 0.0 { lit.options().error } else { error };
        SolveOptions { error: requested, ..SolveOptions::default() }.validate()?;
        if lit.transport().is_none() {
            let message = "this solution has no stored transport: set the option keep_transport to true";
            return Err(Ending::new(PATCHLIGHT_NOT_AVAILABLE, message));
        }
        // SAFETY: The contract of the header.
        unsafe {
            replace(&mut materials, reflectance, "reflectance", |material, by_channel| material.reflectance = by_channel)?;
            replace(&mut materials, exitance, "exitance", |material, by_channel| material.exitance = by_channel)?;
        }

        let watcher = Watcher::new(solution.listener(), &solution.failed);
        let found = solution.evaluator.with_materials(materials, &watcher);
        check_answers(&solution.failed)?;
        let (evaluator, known) = found.map_err(|error| Ending::new(PATCHLIGHT_OUT_OF_RANGE, error))?.ok_or_else(cancelled)?;
        let (known, claimed) = (ErrorReport { requested, ..known }, known.estimate);
        out.set(handles::create(solution.followed_by(evaluator, Known::Estimated(known))))?;
        if claimed <= requested {
            return Ok(());
        }
        let message = format!("solve the scene anew: an error of {claimed} is claimed, {requested} was asked for");
        Err(Ending::new(PATCHLIGHT_LIMIT, message))
    })
}

/// Puts the numbers of an array, which may be NULL, in the place of those of all materials.
///
/// # Safety
/// As the text at the head of the header demands.
unsafe fn replace(
    materials: &mut [Material],
    array: *const patchlight_array,
    what: &str,
    set: impl Fn(&mut Material, Vec<f64>),
) -> Outcome {
    let Some(channels) = materials.first().map(|material| material.reflectance.len()).filter(|_| !array.is_null()) else {
        return Ok(());
    };
    // SAFETY: The caller's promise.
    let numbers = unsafe { reals(array, channels, what)? };
    if numbers.len() != materials.len() * channels {
        let message = format!("{what} has {} items, there are {} materials", numbers.len() / channels, materials.len());
        return Err(Ending::argument(message));
    }
    let rows = materials.iter_mut().zip(numbers.chunks_exact(channels));
    rows.for_each(|(material, by_channel)| set(material, by_channel.to_vec()));
    Ok(())
}
