//! Help on exit codes, and on the options of a solve from the table of the library.

use patchlight::solve::{OptionEntry, SolveOptions};

/// The exit codes, at the end of every help.
pub const EXIT_CODES: &str = "\
Exit codes:
    0  done
    1  the machine failed (disk full, no threads)
    2  the command line asks for something impossible; nothing was done
    3  an input file is bad
    4  a limit ended the solve before the requested error was reached, or the bake before all was gathered; results are
       written
    5  out of memory: the budget of --memory ended the solve, and results are written; or the budget is too small to
       begin, or the machine has no more, and nothing is written
    6  jobs of a batch failed; the others are done, and the table tells of each
  130  interrupted; what there is, is written

Messages go to stderr, only asked-for data to stdout.";

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
