//! What the user is told.

use std::fmt;
use std::io::Write;

/// One line on stderr. That nobody listens is no error.
pub fn say(line: fmt::Arguments<'_>) {
    let _ = writeln!(std::io::stderr().lock(), "{line}");
}
