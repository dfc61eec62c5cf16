//! What was noted about a scene, one by one.

use std::ffi::c_char;

use super::note::Note;
pub use super::note::{patchlight_diagnostic_code, patchlight_severity};
use super::object::patchlight_scene;
use crate::entry::enter;
use crate::handles;
use crate::memory::{Buffer, Out, SizedStruct, write_sized};
use crate::status::{Ending, Outcome, patchlight_status};

/// Stands for "none" where a number is told.
pub const PATCHLIGHT_NONE: u64 = u64::MAX;

/// What was noted about a scene.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct patchlight_diagnostic {
    /// `sizeof(patchlight_diagnostic)`
    pub size: usize,
    /// What it is about: a patchlight_diagnostic_code.
    pub code: u32,
    /// How serious it is: a patchlight_severity.
    pub severity: u32,
    /// The number of the face in the arrays or in the file, from 0, or PATCHLIGHT_NONE. Texts count faces from 1.
    pub face: u64,
    /// The line in the file, from 1, or PATCHLIGHT_NONE.
    pub line: u64,
}

// SAFETY: repr(C), its size first, and numbers may be zero.
unsafe impl SizedStruct for patchlight_diagnostic {
    const NAME: &'static str = "patchlight_diagnostic";
}

fn note(scene: *mut patchlight_scene, number: usize) -> Outcome<Note> {
    let scene = handles::get(scene)?;
    let state = scene.state();
    let message = || format!("there is no diagnostic {number}, there are {}", state.notes.len());
    state.notes.get(number).cloned().ok_or_else(|| Ending::argument(message()))
}

/// How many diagnostics the last commit of a scene left.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn patchlight_scene_diagnostic_count(scene: *mut patchlight_scene, count: *mut usize) -> patchlight_status {
    enter(|| {
        let scene = handles::get(scene)?;
        // SAFETY: The contract of the header.
        unsafe { Out::new(count, "count")? }.set(scene.state().notes.len())
    })
}

/// A diagnostic of a scene, numbered from 0. `diagnostic` is filled in as far as its size says that the caller knows it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn patchlight_scene_diagnostic(
    scene: *mut patchlight_scene,
    number: usize,
    diagnostic: *mut patchlight_diagnostic,
) -> patchlight_status {
    enter(|| {
        let Note { code, severity, face, line, .. } = note(scene, number)?;
        let known = |number: Option<u64>| number.unwrap_or(PATCHLIGHT_NONE);
        let (code, severity, face, line) = (code as u32, severity as u32, known(face), known(line));
        // SAFETY: The contract of the header.
        unsafe { write_sized(diagnostic, &patchlight_diagnostic { size: 0, code, severity, face, line }) }
    })
}

/// The text of a diagnostic of a scene.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn patchlight_scene_diagnostic_text(
    scene: *mut patchlight_scene,
    number: usize,
    buffer: *mut c_char,
    capacity: usize,
    count: *mut usize,
) -> patchlight_status {
    enter(|| {
        let note = note(scene, number)?;
        // SAFETY: The contract of the header.
        unsafe { Buffer::new(buffer, capacity, count)? }.write_text(&note.text)
    })
}
