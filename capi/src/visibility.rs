//! A visibility backend of the caller's own.

use std::ffi::c_void;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use patchlight::visibility::{Hit, Ray, Segment, Visibility};

use crate::float_state::FloatState;
use crate::memory::SizedStruct;

/// Stands for "no surface" and for "no plane".
pub const PATCHLIGHT_NO_SURFACE: u32 = u32::MAX;

/// The open segment between two points. Never grows.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct patchlight_segment {
    /// One end, in metres.
    pub from: [f64; 3],
    /// The other end, in metres.
    pub to: [f64; 3],
    /// Triangles of this plane do not count; PATCHLIGHT_NO_SURFACE for an end in no plane.
    pub from_plane: u32,
    /// Triangles of this plane do not count either.
    pub to_plane: u32,
}

/// A half-line. Never grows.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct patchlight_ray {
    /// Where it starts, in metres.
    pub origin: [f64; 3],
    /// Where it goes; need not have length 1.
    pub direction: [f64; 3],
    /// Triangles of this plane do not count; PATCHLIGHT_NO_SURFACE for an origin in no plane.
    pub origin_plane: u32,
    /// Zero.
    pub reserved: u32,
}

/// The first triangle that a ray meets. Never grows.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct patchlight_hit {
    /// In lengths of the ray's direction, above 0.
    pub distance: f64,
    /// The surface of the triangle, as patchlight_scene_triangle_planes tells; PATCHLIGHT_NO_SURFACE if nothing is met.
    pub surface: u32,
    /// Is left as it is.
    pub reserved: u32,
}

/// Says of each segment whether a triangle blocks it: 1 or 0. Returns 0, or anything else to say that it failed, which ends the work.
pub type patchlight_occluded_function =
    Option<unsafe extern "C" fn(user: *mut c_void, segments: *const patchlight_segment, count: usize, occluded: *mut u8) -> i32>;

/// Says of each ray what it meets first; `hits` are filled with "nothing" beforehand. Returns 0, or anything else to say that it failed.
pub type patchlight_first_hits_function =
    Option<unsafe extern "C" fn(user: *mut c_void, rays: *const patchlight_ray, count: usize, hits: *mut patchlight_hit) -> i32>;

/// Is told that its data are not needed any more.
pub type patchlight_release_function = Option<unsafe extern "C" fn(user: *mut c_void)>;

/// Who answers visibility, in batches of about a thousand: for the triangles of patchlight_scene_triangles, each of which blocks from either
/// side.
///
/// A triangle blocks a segment if the segment passes through it, it lies in neither plane that does not count, and the ends lie on different
/// sides of its plane, each farther from it than PATCHLIGHT_SCENE_CONTACT_TOLERANCE. A ray is a segment without a far end. The functions are
/// called on worker threads, by many at once, and must give the same answer to the same question. They are not asked about what is not
/// finite or has no length.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct patchlight_visibility {
    /// `sizeof(patchlight_visibility)`
    pub size: usize,
    /// Handed to the functions as it is.
    pub user: *mut c_void,
    /// Must be there.
    pub occluded: patchlight_occluded_function,
    /// Must be there.
    pub first_hits: patchlight_first_hits_function,
    /// Called once when nothing asks any more: the solve failed, or its solution was let go. May be NULL.
    pub release: patchlight_release_function,
}

// SAFETY: repr(C), its size first; numbers, pointers and functions that may be NULL may be zero.
unsafe impl SizedStruct for patchlight_visibility {
    const NAME: &'static str = "patchlight_visibility";
}

/// Asks functions of the caller's.
pub struct CallersVisibility {
    functions: patchlight_visibility,
    surfaces: u32,
    /// Set once a function fails, or answers what cannot be.
    failed: Arc<AtomicBool>,
}

// SAFETY: The data are handed to the caller's functions alone, which the header says are called on worker threads, by many at once.
unsafe impl Send for CallersVisibility {}
// SAFETY: As above.
unsafe impl Sync for CallersVisibility {}

impl CallersVisibility {
    /// `None` if a function is missing.
    pub fn new(functions: patchlight_visibility, surfaces: usize, failed: Arc<AtomicBool>) -> Option<Self> {
        let is_there = functions.occluded.is_some() && functions.first_hits.is_some();
        is_there.then_some(Self { functions, surfaces: surfaces as u32, failed })
    }

    fn fail(&self) {
        self.failed.store(true, Ordering::Relaxed);
    }
}

/// Whether a vector is finite and of some length.
fn is_direction(vector: [f64; 3]) -> bool {
    vector.iter().all(|x| x.is_finite()) && vector != [0.0; 3]
}

impl Drop for CallersVisibility {
    fn drop(&mut self) {
        let Some(release) = self.functions.release else { return };
        let _state = FloatState::kept();
        // SAFETY: The caller's function with its own data; this is dropped once, and nothing asks any more.
        unsafe { release(self.functions.user) };
    }
}

impl Visibility for CallersVisibility {
    fn description(&self) -> String {
        "functions of the caller's".to_owned()
    }

    fn occluded(&self, segments: &[Segment], occluded: &mut [bool]) {
        // What is not finite, or has no length, is occluded; the rest is asked for.
        let mut asked = Vec::with_capacity(segments.len());
        let mut places = Vec::with_capacity(segments.len());
        for (place, (segment, occluded)) in segments.iter().zip(&mut *occluded).enumerate() {
            *occluded = true;
            let Segment { from, to, from_plane, to_plane } = *segment;
            if is_direction(std::array::from_fn(|axis| to[axis] - from[axis])) {
                asked.push(patchlight_segment { from, to, from_plane, to_plane });
                places.push(place);
            }
        }
        let Some(function) = self.functions.occluded.filter(|_| !asked.is_empty()) else { return };

        let mut answers = vec![0_u8; asked.len()];
        let state = FloatState::kept();
        // SAFETY: The caller's function with its own data, as many segments as it is told, and room for as many answers.
        let status = unsafe { function(self.functions.user, asked.as_ptr(), asked.len(), answers.as_mut_ptr()) };
        drop(state);
        if status != 0 || answers.iter().any(|&answer| answer > 1) {
            return self.fail();
        }
        places.into_iter().zip(answers).for_each(|(place, answer)| occluded[place] = answer != 0);
    }

    fn first_hits(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        // What is not finite, or has no direction, meets nothing; the rest is asked for.
        let mut asked = Vec::with_capacity(rays.len());
        let mut places = Vec::with_capacity(rays.len());
        for (place, (ray, hit)) in rays.iter().zip(&mut *hits).enumerate() {
            *hit = None;
            let Ray { origin, direction, origin_plane } = *ray;
            if origin.iter().all(|x| x.is_finite()) && is_direction(direction) {
                asked.push(patchlight_ray { origin, direction, origin_plane, reserved: 0 });
                places.push(place);
            }
        }
        let Some(function) = self.functions.first_hits.filter(|_| !asked.is_empty()) else { return };

        let nothing = patchlight_hit { distance: 0.0, surface: PATCHLIGHT_NO_SURFACE, reserved: 0 };
        let mut answers = vec![nothing; asked.len()];
        let state = FloatState::kept();
        // SAFETY: As in `occluded`.
        let status = unsafe { function(self.functions.user, asked.as_ptr(), asked.len(), answers.as_mut_ptr()) };
        drop(state);
        let is_legal = |hit: &patchlight_hit| {
            hit.surface == PATCHLIGHT_NO_SURFACE || hit.surface < self.surfaces && hit.distance > 0.0 && hit.distance.is_finite()
        };
        if status != 0 || !answers.iter().all(is_legal) {
            return self.fail();
        }
        for (place, patchlight_hit { distance, surface, .. }) in places.into_iter().zip(answers) {
            hits[place] = (surface != PATCHLIGHT_NO_SURFACE).then_some(Hit { surface, distance });
        }
    }
}
