//! Which commands several processes do together.

use std::path::Path;

use super::super::arguments::Command;
use super::super::exit::Failure;

/// Whether a process does this by itself, however many a launcher starts.
pub fn is_done_alone(command: &Command) -> bool {
    matches!(command, Command::Batch(batch) if batch.work.shard.is_some())
}

/// Whether so many processes can do this together.
///
/// # Errors
/// They cannot.
pub fn check(command: &Command, processes: usize) -> Result<(), Failure> {
    let why_not = match command {
        _ if processes == 1 => None,
        Command::Solve(solve) if solve.points.as_deref() == Some(Path::new("-")) => Some("points come from a file, not from stdin"),
        Command::Solve(_) | Command::Bake(_) => None,
        Command::Batch(batch) if batch.command.is_none() && !batch.work.plan => None,
        _ => Some("this is done by one, without mpirun; 'solve', 'bake' and 'batch' are done by many"),
    };
    why_not.map_or(Ok(()), |why| Err(Failure::usage(format_args!("several processes work together here: {why}"))))
}
