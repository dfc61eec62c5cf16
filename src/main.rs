//! The command line of Patchlight.

mod cli;

fn main() -> std::process::ExitCode {
    cli::run()
}
