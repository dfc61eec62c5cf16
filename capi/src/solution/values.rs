//! Values at points.

use patchlight::scene::SurfacePoint;

use super::{cancelled, patchlight_solution};
use crate::array::{patchlight_array, vectors};
use crate::entry::enter;
use crate::handles;
use crate::memory::{Buffer, Out, SizedStruct, read_sized};
use crate::observer::Watcher;
use crate::solve::check_answers;
use crate::status::{Ending, Outcome, PATCHLIGHT_NOT_AVAILABLE, patchlight_status};

/// Where values at points are written, point after point, with a number for each channel. What is NULL is left out.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct patchlight_values {
    /// `sizeof(patchlight_values)`
    pub size: usize,
    /// How many numbers each buffer has room for: at least points times channels.
    pub capacity: usize,
    /// Radiosities in W/m^2; NaN at points that lie on no surface.
    pub radiosity: *mut f32,
    /// Their standard errors in W/m^2; NaN where they are not known.
    pub standard_error: *mut f32,
    /// No less, proved; where bounds were asked for.
    pub lower: *mut f32,
    /// No more, proved.
    pub upper: *mut f32,
}

// SAFETY: repr(C), its size first, and numbers and pointers may be zero.
unsafe impl SizedStruct for patchlight_values {
    const NAME: &'static str = "patchlight_values";
}

/// Points on surfaces.
///
/// # Safety
/// As the text at the head of the header demands.
pub unsafe fn points(positions: *const patchlight_array, normals: *const patchlight_array) -> Outcome<Vec<SurfacePoint>> {
    // SAFETY: The caller's promise.
    let (positions, normals) = unsafe { (vectors(positions, "positions")?, vectors(normals, "normals")?) };
    if positions.len() != normals.len() {
        let message = format!("there are {} positions, but {} normals", positions.len(), normals.len());
        return Err(Ending::argument(message));
    }
    let points = positions.into_iter().zip(normals).enumerate();
    points
        .map(|(number, (position, normal))| {
            SurfacePoint::checked(position, normal).map_err(|error| Ending::argument(format_args!("point {number}: {error}")))
        })
        .collect()
}

/// Values at points that lie on surfaces, with the normals of the sides that are looked at. `missed` says how many lie on no surface; it may be
/// NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn patchlight_solution_get_values(
    solution: *mut patchlight_solution,
    positions: *const patchlight_array,
    normals: *const patchlight_array,
    values: *const patchlight_values,
    missed: *mut usize,
) -> patchlight_status {
    enter(|| {
        let solution = handles::get(solution)?;
        // SAFETY: The contract of the header.
        let (points, into) = unsafe { (points(positions, normals)?, read_sized(values)?) };
        let needed = points.len() * solution.evaluator.solution().scene().channels();
        let buffer = |data: *mut f32| {
            let capacity = if data.is_null() { 0 } else { into.capacity };
            let mut count = 0;
            // SAFETY: The contract of the header; `count` lives longer than the buffer that looks at it, which goes with this call.
            let is_there = unsafe { Buffer::new(data, capacity, &raw mut count)? }.begin(needed)?;
            Ok::<_, Ending>(is_there.then_some(data))
        };
        let (radiosity, standard_error) = (buffer(into.radiosity)?, buffer(into.standard_error)?);
        let (lower, upper) = (buffer(into.lower)?, buffer(into.upper)?);
        if (lower.is_some() || upper.is_some()) && solution.evaluator.bounds().is_none() {
            let message = "this solution has no bounds: set the option bounds to guaranteed";
            return Err(Ending::new(PATCHLIGHT_NOT_AVAILABLE, message));
        }

        let watcher = Watcher::new(solution.listener(), &solution.failed);
        let values = solution.evaluator.values_at(&points, &watcher);
        check_answers(&solution.failed)?;
        let values = values.ok_or_else(cancelled)?;

        let write = |data: Option<*mut f32>, numbers: &[f32]| {
            // SAFETY: The contract of the header; `buffer` found it to be aligned and large enough.
            data.map_or(Ok(()), |data| unsafe { Buffer::new(data, needed, std::ptr::null_mut())? }.copy(numbers))
        };
        write(radiosity, &values.radiosity)?;
        write(standard_error, &values.standard_error)?;
        if lower.is_some() || upper.is_some() {
            let bounds = solution.evaluator.bounds_at(&points);
            let bounds = bounds.ok_or_else(|| Ending::new(PATCHLIGHT_NOT_AVAILABLE, "this solution has no bounds"))?;
            write(lower, &bounds.lower)?;
            write(upper, &bounds.upper)?;
        }
        if missed.is_null() {
            return Ok(());
        }
        // SAFETY: The contract of the header.
        unsafe { Out::new(missed, "missed")? }.set(values.missed)
    })
}
