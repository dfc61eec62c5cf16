//! The command line of batches as it is typed.

use std::path::PathBuf;

use clap::{Args, Subcommand};

use super::argument_groups::{RunArguments, TrustArguments};
use super::option_help::EXIT_CODES;

/// `patchlight batch`.
#[derive(Debug, Args)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub struct BatchArguments {
    #[command(subcommand)]
    pub command: Option<BatchCommand>,
    /// The file of jobs, TOML; docs/batch.md tells what stands in it
    #[arg(required = true)]
    pub file: Option<PathBuf>,
    #[command(flatten)]
    pub place: PlaceArguments,
    #[command(flatten)]
    pub work: WorkArguments,
}

/// What else can be done with a file of jobs.
#[derive(Debug, Subcommand)]
pub enum BatchCommand {
    /// Make the tables of what all shards have done, and check that nothing is missing
    #[command(after_help = EXIT_CODES)]
    Merge(MergeArguments),
}

/// `patchlight batch merge`.
#[derive(Debug, Args)]
pub struct MergeArguments {
    /// The file of jobs
    pub file: PathBuf,
    #[command(flatten)]
    pub place: PlaceArguments,
}

/// Where jobs read and write.
#[derive(Debug, Args)]
pub struct PlaceArguments {
    /// The folder of all results, tables and journals [default: that of the file of jobs]
    #[arg(short, long, value_name = "FOLDER")]
    pub output: Option<PathBuf>,
    #[command(flatten)]
    pub trust: TrustArguments,
    #[command(flatten)]
    pub run: RunArguments,
}

/// How jobs are done.
#[derive(Debug, Args)]
pub struct WorkArguments {
    /// So many jobs at a time, which share the threads; never changes a result [default: one for each thread]
    #[arg(long, value_name = "N")]
    pub jobs: Option<usize>,
    /// Go on: keep what is done, if inputs, options, version and files are what they were; do what is missing, or failed
    #[arg(long, conflicts_with = "anew")]
    pub resume: bool,
    /// Do all jobs again
    #[arg(long)]
    pub anew: bool,
    /// Do a part of the jobs, as in 0/3, 1/3 and 2/3, each by a process of its own; 'patchlight batch merge' makes the tables
    #[arg(long, value_name = "I/N")]
    pub shard: Option<String>,
    /// Try a job again so often if the machine fails in it (exit code 1)
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub retries: u32,
    /// List all jobs on stdout, as CSV, and do none
    #[arg(long)]
    pub plan: bool,
}
