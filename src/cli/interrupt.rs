//! Ctrl-C: the first ends the stage that is at work, what there is is written; the second ends that as well; the third leaves at once.

use std::sync::atomic::{AtomicUsize, Ordering};

use super::exit::Exit;
use super::stderr::say;

static INTERRUPTS: AtomicUsize = AtomicUsize::new(0);

/// How many interrupts there were so far.
pub fn count() -> usize {
    INTERRUPTS.load(Ordering::Relaxed)
}

/// Listens from now on to SIGINT, SIGTERM and SIGHUP (Ctrl-C and Ctrl-Break where there are no signals).
pub fn listen() {
    let listening = ctrlc::set_handler(|| match INTERRUPTS.fetch_add(1, Ordering::Relaxed) {
        0 => say(format_args!("interrupted: writing what there is (interrupt again to leave that out too)")),
        1 => say(format_args!("interrupted again: leaving out what takes long")),
        _ => std::process::exit(Exit::Cancelled as i32),
    });
    if let Err(error) = listening {
        say(format_args!("warning: cannot listen to interrupts ({error}): Ctrl-C will lose the results"));
    }
}
