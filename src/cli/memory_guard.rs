//! Ends the program before the machine is out of memory.
//!
//! What the process takes is looked up many times a second, whatever it is doing, from the first file that is read to the last picture. The guard
//! changes no result: a run gets through as it is, or ends with a clear error. Only Linux tells what is taken; elsewhere there is no guard.

use std::time::Duration;

use super::process::{self, Share};

/// How often is looked: a process fills some 50 MB in this time.
#[cfg(unix)]
const INTERVAL: Duration = Duration::from_millis(20);

/// The process may take this part of what it could have. What is left is for what is taken between two looks, and for the rest of the machine.
const MOST: f64 = 0.875;

/// Watches from now on.
#[cfg(unix)]
pub fn watch() {
    if process::memory_shares().is_empty() {
        return;
    }
    let look = || {
        loop {
            if let Some(message) = process::memory_shares().iter().find_map(too_much) {
                super::stderr::say(format_args!("error: {message}"));
                // At once: other threads are at work, and must not meet what ends in an orderly way.
                signal_hook::low_level::exit(super::exit::Exit::Memory as i32);
            }
            std::thread::sleep(INTERVAL);
        }
    };
    if let Err(error) = std::thread::Builder::new().name("memory guard".to_owned()).spawn(look) {
        super::stderr::say(format_args!("warning: cannot watch the memory ({error})"));
    }
}

/// There is nothing to look at.
#[cfg(not(unix))]
pub fn watch() {}

/// What to tell if this is too much.
fn too_much(share: &Share) -> Option<String> {
    let Share { of, taken, most } = *share;
    let gigabytes = |bytes: u64| format!("{:.2} GB", bytes as f64 * 1e-9);
    (taken as f64 > MOST * most as f64).then(|| {
        format!(
            "out of memory: the program takes {} of {of}, and could have {}; it ends here, and writes nothing more. A larger --error or fewer \
             surfaces take less; 'solve --memory GB' keeps to so many GB and writes what there is",
            gigabytes(taken),
            gigabytes(most),
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_eighth_is_left_and_the_message_says_what_to_do() {
        let share = |taken, most| Share { of: "the memory", taken, most };
        assert_eq!(too_much(&share(7_000_000_000, 8_000_000_000)), None);
        let message = too_much(&share(7_100_000_000, 8_000_000_000)).unwrap();
        assert!(message.contains("takes 7.10 GB of the memory") && message.contains("8.00 GB") && message.contains("--memory"));
    }
}
