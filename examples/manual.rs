//! Writes the man pages of the program and completions for shells into a folder: `cargo run --example manual -- FOLDER`.

#[path = "../src/cli/argument_groups.rs"]
#[allow(dead_code, reason = "as below")]
mod argument_groups;
#[path = "../src/cli/arguments.rs"]
#[allow(dead_code, reason = "the program looks at the arguments, this only at their names and help")]
mod arguments;
#[path = "../src/cli/batch_arguments.rs"]
#[allow(dead_code, reason = "the same")]
mod batch_arguments;
#[path = "../src/cli/option_help.rs"]
mod option_help;

use std::error::Error;
use std::path::Path;

use clap::CommandFactory;
use clap_complete::{Shell, generate_to};

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args_os().nth(1).ok_or("name the folder to write to")?;
    let folder = Path::new(&folder);
    std::fs::create_dir_all(folder)?;

    let mut command = arguments::Arguments::command().disable_help_subcommand(true);
    for shell in [Shell::Bash, Shell::Zsh, Shell::Fish] {
        generate_to(shell, &mut command, "patchlight", folder)?;
    }
    clap_mangen::generate_to(command, folder)?;
    Ok(())
}
