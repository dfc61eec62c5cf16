//! Interrupts. The first Ctrl-C ends the stage that is at work, what there is is written; the second leaves out what takes long; the third
//! leaves at once. Of a batch, the first lets jobs that are at work end, the second gives them up. SIGTERM counts for two: whoever sends it waits for an end, not for a picture. Until anybody listens, as while files are
//! read, any of them ends the program: there is nothing to lose yet.

use std::sync::atomic::{AtomicUsize, Ordering};

use super::exit::Exit;
use super::ranks;
use super::stderr::say;

static INTERRUPTS: AtomicUsize = AtomicUsize::new(0);

/// How many of them have ended a stage.
static SETTLED: AtomicUsize = AtomicUsize::new(0);

/// After so many, what takes long is left out.
const LEAVE_OUT: usize = 2;

/// How many interrupts there were so far.
pub fn count() -> usize {
    INTERRUPTS.load(Ordering::Relaxed)
}

/// Whether one has come that has not ended any stage yet.
pub fn is_pending() -> bool {
    count() > SETTLED.load(Ordering::Relaxed)
}

/// All that have come have ended a stage.
pub fn settle() {
    SETTLED.store(count(), Ordering::Relaxed);
}

/// Whether what takes long is to be left out.
pub fn leaves_out() -> bool {
    count() >= LEAVE_OUT
}

/// What the first and the second interrupt say.
pub type Messages = [&'static str; 2];

/// While a command works on its one result.
pub const OF_RUN: Messages = [
    "interrupted: writing what there is (interrupt again to leave out what takes long)",
    "interrupted: leaving out what takes long",
];

/// While jobs are done.
pub const OF_BATCH: Messages = [
    "interrupted: ending the jobs that are at work (interrupt again to give them up)",
    "interrupted: giving up the jobs that are at work; --resume goes on",
];

/// Adds so many interrupts.
fn interrupt(by: usize, messages: Messages) {
    let before = INTERRUPTS.fetch_add(by, Ordering::Relaxed);
    match before + by {
        _ if before >= LEAVE_OUT => std::process::exit(Exit::Cancelled as i32),
        1 => say(format_args!("{}", messages[0])),
        _ => say(format_args!("{}", messages[1])),
    }
}

/// Listens from now on, unless processes work together: they could not agree on when an interrupt came, so it ends them.
pub fn listen_alone(messages: Messages) {
    if ranks::size() == 1 {
        listen(messages);
    }
}

/// Listens from now on to SIGINT, SIGHUP and SIGTERM (Ctrl-C and Ctrl-Break where there are no signals).
pub fn listen(messages: Messages) {
    #[cfg(unix)]
    let listening = {
        use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
        signal_hook::iterator::Signals::new([SIGHUP, SIGINT, SIGTERM]).and_then(|mut signals| {
            let handle =
                move || signals.forever().for_each(|signal| interrupt(if signal == SIGTERM { LEAVE_OUT } else { 1 }, messages));
            std::thread::Builder::new().name("interrupts".to_owned()).spawn(handle)
        })
    };
    #[cfg(not(unix))]
    let listening = ctrlc::set_handler(move || interrupt(1, messages));
    if let Err(error) = listening {
        say(format_args!("warning: cannot listen to interrupts ({error}): Ctrl-C will lose the results"));
    }
}
