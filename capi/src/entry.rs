//! What every function of the interface does around its body.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};

use crate::float_state::FloatState;
use crate::status::{Ending, Outcome, PATCHLIGHT_INTERNAL_ERROR, PATCHLIGHT_OK, patchlight_status, set_message};

/// Runs the body of a function: with the floating-point state that Rust relies on, and no panic leaves it. Its message is kept for the
/// thread, an empty one after success.
pub fn enter(body: impl FnOnce() -> Outcome) -> patchlight_status {
    let _state = FloatState::standard();
    // What a panic leaves half done is behind locks, which are taken over as they are: nothing there is unsafe to look at.
    let ending = match catch_unwind(AssertUnwindSafe(body)) {
        Ok(Ok(())) => Ending::new(PATCHLIGHT_OK, ""),
        Ok(Err(ending)) => ending,
        Err(panic) => {
            Ending::new(PATCHLIGHT_INTERNAL_ERROR, format_args!("a mistake in the library, please report it: {}", told(panic)))
        }
    };
    set_message(&ending.message);
    ending.status
}

/// What a panic says.
fn told(panic: Box<dyn Any + Send>) -> String {
    match panic.downcast::<String>() {
        Ok(text) => *text,
        Err(panic) => panic.downcast::<&str>().map_or_else(|_| "no message".to_owned(), |text| (*text).to_owned()),
    }
}
