//! `patchlight`: typed text becomes [arguments], arguments become a validated [request], a request becomes calls of the library.
//!
//! Messages go to stderr, nothing but asked-for data to stdout. All that can be known to be wrong is found before the long work starts.

mod argument_groups;
mod arguments;
mod bake;
mod bake_again;
mod batch;
mod batch_arguments;
mod changes;
mod exit;
mod files;
mod info;
mod interrupt;
mod key_figures;
mod light_groups;
mod lightmap_files;
mod memory_guard;
mod option_help;
mod page_extras;
mod per_vertex;
mod pictures;
mod plots;
mod process;
mod progress;
mod ranks;
mod reader;
mod relight;
mod report;
mod request;
mod results;
mod sensors;
mod settings;
mod solve;
mod stderr;

use std::process::ExitCode;

use clap::Parser;

use arguments::{Arguments, Command};
use exit::{Exit, Failure};

/// Runs the command line and says how it went.
pub fn run() -> ExitCode {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(message) => {
            // Help and version are asked for and no error; whether they can be written changes nothing.
            if ranks::is_told_first() {
                let _ = message.print();
            }
            return if message.use_stderr() { Exit::Usage } else { Exit::Done }.into();
        }
    };
    memory_guard::watch();
    // Joined until the end: others are told of a failure while they are.
    let _joined = match ranks::join(ranks::is_done_alone(&arguments.command)) {
        Ok(joined) => joined,
        Err(failure) => return failed(&failure),
    };
    let ended = ranks::check(&arguments.command, ranks::size()).and_then(|()| execute(arguments.command));
    ended.map_or_else(|failure| failed(&failure), ExitCode::from)
}

/// Tells what failed.
fn failed(failure: &Failure) -> ExitCode {
    ranks::fail(failure);
    failure.exit.into()
}

fn execute(command: Command) -> Result<Exit, Failure> {
    match command {
        Command::Solve(arguments) => solve::solve(request::SolveRequest::new(*arguments)?),
        Command::Sample(arguments) => results::sample(request::SampleRequest::new(arguments)?),
        Command::Render(arguments) => pictures::render(request::RenderRequest::new(arguments)?),
        Command::Relight(arguments) => relight::relight(&relight::RelightRequest::new(*arguments)?),
        Command::Export(arguments) => results::export(request::ExportRequest::new(arguments)?),
        Command::Report(arguments) => report::report(report::ReportRequest::new(arguments)?),
        Command::Bake(arguments) => bake::bake(bake::BakeRequest::new(*arguments)?),
        Command::Batch(arguments) => batch::batch(*arguments),
        Command::Info(arguments) => info::info(&arguments),
    }
}
