//! Options of a solve, by name.

mod table;

use std::ffi::c_char;
use std::sync::{Arc, Mutex, PoisonError};

use table::patchlight_option_type::*;
use table::{Entry, entries};
pub use table::{Settings, patchlight_option_type};

use crate::entry::enter;
use crate::handles::{self, Handle};
use crate::memory::{Buffer, Out, text};
use crate::status::{Ending, Outcome, PATCHLIGHT_NOT_AVAILABLE, PATCHLIGHT_OUT_OF_RANGE, patchlight_status};

/// What is asked of a solve: options by their keys, those of `patchlight solve --set key=value`.
pub struct patchlight_options {
    _private: [u8; 0],
}

impl Handle for patchlight_options {
    type Target = Options;
    const NAME: &'static str = "options";
}

/// What there is to know of an option, as text. Values may be added.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum patchlight_option_text {
    /// Its key.
    PATCHLIGHT_OPTION_KEY = 1,
    /// What it does.
    PATCHLIGHT_OPTION_HELP = 2,
    /// What is legal, as in "it must be ...".
    PATCHLIGHT_OPTION_RANGE = 3,
    /// What a number of 1 stands for; empty where it needs no unit.
    PATCHLIGHT_OPTION_UNIT = 4,
    /// Its value if nobody sets it; empty where that follows from other options or the scene.
    PATCHLIGHT_OPTION_DEFAULT = 5,
}

use patchlight_option_text::*;

/// Behind a handle.
pub struct Options(Mutex<Settings>);

impl Options {
    /// What they are now.
    pub fn settings(&self) -> Settings {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    fn set(&self, key: &str, value: &str, given: patchlight_option_type) -> Outcome {
        let entry = Entry::of_key(key)?;
        let needed = entry.value_type();
        let whole_for_real = (needed, given) == (PATCHLIGHT_OPTION_DOUBLE, PATCHLIGHT_OPTION_UINT64);
        if given != needed && given != PATCHLIGHT_OPTION_TEXT && !whole_for_real {
            let message = format!("{key} is not of the type that this function sets, it must be {}", entry.range());
            return Err(Ending::new(PATCHLIGHT_OUT_OF_RANGE, message));
        }
        entry.set(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner), value)
    }
}

/// Makes options, all with their defaults.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn patchlight_options_create(options: *mut *mut patchlight_options) -> patchlight_status {
    enter(|| {
        // SAFETY: The contract of the header.
        let out = unsafe { Out::new(options, "options")? };
        out.set(handles::create(Arc::new(Options(Mutex::default()))))
    })
}

/// One more patchlight_options_release is needed.
#[unsafe(no_mangle)]
pub extern "C" fn patchlight_options_retain(options: *mut patchlight_options) -> patchlight_status {
    enter(|| handles::retain(options))
}

/// Lets options go. NULL is let go by.
#[unsafe(no_mangle)]
pub extern "C" fn patchlight_options_release(options: *mut patchlight_options) -> patchlight_status {
    enter(|| handles::release(options))
}

/// Sets an option that is a number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn patchlight_options_set_double(
    options: *mut patchlight_options,
    key: *const c_char,
    value: f64,
) -> patchlight_status {
    enter(|| {
        let options = handles::get(options)?;
        // SAFETY: The contract of the header.
        let key = unsafe { text(key, "key")? };
        options.set(key, &format!("{value:e}"), PATCHLIGHT_OPTION_DOUBLE)
    })
}

/// Sets an option that is a whole number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn patchlight_options_set_uint64(
    options: *mut patchlight_options,
    key: *const c_char,
    value: u64,
) -> patchlight_status {
    enter(|| {
        let options = handles::get(options)?;
        // SAFETY: The contract of the header.
        let key = unsafe { text(key, "key")? };
        options.set(key, &value.to_string(), PATCHLIGHT_OPTION_UINT64)
    })
}

/// Sets an option that is yes (not 0) or no (0).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn patchlight_options_set_bool(
    options: *mut patchlight_options,
    key: *const c_char,
    value: i32,
) -> patchlight_status {
    enter(|| {
        let options = handles::get(options)?;
        // SAFETY: The contract of the header.
        let key = unsafe { text(key, "key")? };
        options.set(key, if value == 0 { "false" } else { "true" }, PATCHLIGHT_OPTION_BOOL)
    })
}

/// Sets any option from text, as `--set key=value` does.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn patchlight_options_set_text(
    options: *mut patchlight_options,
    key: *const c_char,
    value: *const c_char,
) -> patchlight_status {
    enter(|| {
        let options = handles::get(options)?;
        // SAFETY: The contract of the header.
        let (key, value) = unsafe { (text(key, "key")?, text(value, "value")?) };
        options.set(key, value, PATCHLIGHT_OPTION_TEXT)
    })
}

/// Sets an option back to its default.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn patchlight_options_reset(options: *mut patchlight_options, key: *const c_char) -> patchlight_status {
    enter(|| {
        let options = handles::get(options)?;
        // SAFETY: The contract of the header.
        let entry = Entry::of_key(unsafe { text(key, "key")? })?;
        entry.reset(&mut options.0.lock().unwrap_or_else(PoisonError::into_inner))
    })
}

/// The value of an option as text.
///
/// PATCHLIGHT_NOT_AVAILABLE if nobody has set it and it follows from other options or the scene.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn patchlight_options_get_text(
    options: *mut patchlight_options,
    key: *const c_char,
    buffer: *mut c_char,
    capacity: usize,
    count: *mut usize,
) -> patchlight_status {
    enter(|| {
        let options = handles::get(options)?;
        // SAFETY: The contract of the header.
        let (key, buffer) = unsafe { (text(key, "key")?, Buffer::new(buffer, capacity, count)?) };
        match Entry::of_key(key)?.value(&options.settings()) {
            Some(value) => buffer.write_text(&value),
            None => Err(Ending::new(PATCHLIGHT_NOT_AVAILABLE, format_args!("{key} is not set"))),
        }
    })
}

/// How many options there are. A later version may have more, in another order.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn patchlight_option_count(count: *mut usize) -> patchlight_status {
    enter(|| {
        // SAFETY: The contract of the header.
        unsafe { Out::new(count, "count")? }.set(entries().count())
    })
}

/// What the value of an option is: a patchlight_option_type. Options are numbered from 0.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn patchlight_option_get_type(option: usize, value_type: *mut u32) -> patchlight_status {
    enter(|| {
        // SAFETY: The contract of the header.
        let out = unsafe { Out::new(value_type, "value_type")? };
        out.set(Entry::numbered(option)?.value_type() as u32)
    })
}

/// What there is to know of an option: `what` is a patchlight_option_text. Options are numbered from 0.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn patchlight_option_get_text(
    option: usize,
    what: u32,
    buffer: *mut c_char,
    capacity: usize,
    count: *mut usize,
) -> patchlight_status {
    enter(|| {
        // SAFETY: The contract of the header.
        let buffer = unsafe { Buffer::new(buffer, capacity, count)? };
        let entry = Entry::numbered(option)?;
        let text = match what {
            _ if what == PATCHLIGHT_OPTION_KEY as u32 => entry.key().to_owned(),
            _ if what == PATCHLIGHT_OPTION_HELP as u32 => entry.help().to_owned(),
            _ if what == PATCHLIGHT_OPTION_RANGE as u32 => entry.range(),
            _ if what == PATCHLIGHT_OPTION_UNIT as u32 => entry.unit().to_owned(),
            _ if what == PATCHLIGHT_OPTION_DEFAULT as u32 => entry.value(&Settings::default()).unwrap_or_default(),
            _ => return Err(Ending::argument(format_args!("what is {what}, which is no patchlight_option_text"))),
        };
        buffer.write_text(&text)
    })
}
