//! Help on the options of a solve, from the table of the library.

use patchlight::solve::{OptionEntry, SolveOptions};

/// Columns of the list of options.
const COLUMNS: usize = 100;

/// Help for the flag that sets the option with this key.
pub fn of_flag(key: &str) -> String {
    SolveOptions::entry(key).map(describe).expect("a flag is named after its option")
}

/// All keys of `--set`, with range and default.
pub fn of_set() -> String {
    let mut text = "Options of --set KEY=VALUE; sides, backend, threads, time and memory are keys as well:\n".to_owned();
    for group in SolveOptions::GROUPS {
        text += &format!("\n  {}\n", group.about);
        for entry in group.options {
            text += &format!("    {}\n{}", entry.key, wrapped(&describe(entry), "          "));
        }
    }
    text
}

/// What an option does, its unit, range and default.
fn describe(entry: &OptionEntry) -> String {
    let mut text = format!("{} [{}]", entry.help, entry.range());
    if !entry.unit.is_empty() {
        text += &format!(" [unit: {}]", entry.unit);
    }
    if let Some(default) = entry.value(&SolveOptions::default()) {
        text += &format!(" [default: {default}]");
    }
    text
}

/// Lines of at most [`COLUMNS`], broken between words.
fn wrapped(text: &str, indent: &str) -> String {
    let mut lines = String::new();
    let mut line = String::new();
    for word in text.split(' ') {
        if !line.is_empty() && indent.len() + line.len() + 1 + word.len() > COLUMNS {
            lines += &format!("{indent}{line}\n");
            line.clear();
        }
        if !line.is_empty() {
            line.push(' ');
        }
        line += word;
    }
    lines + &format!("{indent}{line}\n")
}
