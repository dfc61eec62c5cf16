//! Which version this is, and the last message.

use std::ffi::c_char;

use crate::entry::enter;
use crate::float_state::FloatState;
use crate::memory::Out;
use crate::status::{last_message, patchlight_status};

/// The major version of the header; the library tells its own.
pub const PATCHLIGHT_VERSION_MAJOR: u32 = 0;
/// The minor version of the header.
pub const PATCHLIGHT_VERSION_MINOR: u32 = 1;
/// The patch version of the header.
pub const PATCHLIGHT_VERSION_PATCH: u32 = 0;

/// The version of the library.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn patchlight_get_version(major: *mut u32, minor: *mut u32, patch: *mut u32) -> patchlight_status {
    enter(|| {
        // SAFETY: The contract of the header.
        let outs = unsafe { [Out::new(major, "major")?, Out::new(minor, "minor")?, Out::new(patch, "patch")?] };
        let version = [PATCHLIGHT_VERSION_MAJOR, PATCHLIGHT_VERSION_MINOR, PATCHLIGHT_VERSION_PATCH];
        outs.into_iter().zip(version).try_for_each(|(out, number)| out.set(number))
    })
}

/// What the last other call on this thread has to tell, in English; empty after PATCHLIGHT_OK. It stays where it is until the next call on
/// this thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn patchlight_get_message(message: *mut *const c_char) -> patchlight_status {
    let _state = FloatState::standard();
    // SAFETY: The contract of the header.
    match unsafe { Out::new(message, "message") }.and_then(|out| out.set(last_message())) {
        Ok(()) => patchlight_status::PATCHLIGHT_OK,
        // The message that nobody fetched stays.
        Err(ending) => ending.status,
    }
}
