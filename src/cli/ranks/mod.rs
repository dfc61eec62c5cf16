//! The processes that `mpirun` starts together. The first of them speaks and writes; all of them work.
//!
//! Without the feature `mpi` there is only ever one.

mod commands;
mod deal;
#[cfg(feature = "mpi")]
mod world;

use std::sync::Arc;
#[cfg(feature = "mpi")]
use std::sync::OnceLock;

use patchlight::pipeline::Workers;
use patchlight::team::{Alone, Team};

use super::exit::Failure;
pub use commands::{check, is_done_alone};
pub use deal::Deal;

/// Variables by which launchers tell a process its number and how many there are: Open MPI, MPICH and those that follow it.
const TOLD: [[&str; 2]; 2] = [["OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE"], ["PMI_RANK", "PMI_SIZE"]];

/// Whoever sets this starts processes that do not know of each other, each for something of its own.
const ALONE: &str = "PATCHLIGHT_ALONE";

#[cfg(feature = "mpi")]
static WORLD: OnceLock<Arc<world::World>> = OnceLock::new();

/// What ends together with the program.
pub struct Joined {
    #[cfg(feature = "mpi")]
    _universe: Option<mpi::environment::Universe>,
}

/// Joins the other processes, where a launcher started several.
///
/// # Errors
/// There are several, and the program was built without MPI; unless each is to work `by_itself`.
pub fn join(by_itself: bool) -> Result<Joined, Failure> {
    let [_, size] = told();
    #[cfg(feature = "mpi")]
    {
        let universe = if size > 1 && !by_itself { Some(world::join(size)?) } else { None };
        if universe.is_some() {
            WORLD.get_or_init(Arc::default);
        }
        Ok(Joined { _universe: universe })
    }
    #[cfg(not(feature = "mpi"))]
    if size > 1 && !by_itself {
        Err(Failure::usage(format_args!(
            "{size} processes were started to work together, and this program was built without MPI, so each would do all of it: build it with \
             'cargo build --release --features mpi', or start it once; {ALONE}=1 if each does something of its own"
        )))
    } else {
        Ok(Joined {})
    }
}

/// The number of this process and how many there are, as the launcher tells.
fn told() -> [usize; 2] {
    if std::env::var_os(ALONE).is_some() {
        return [0, 1];
    }
    let number = |name: &str| std::env::var(name).ok()?.parse().ok();
    let all = TOLD.iter().filter_map(|[rank, size]| Some([number(rank)?, number(size)?]));
    all.max_by_key(|[_, size]| *size).unwrap_or([0, 1])
}

/// Whether the launcher, if there is one, calls this process the first.
pub fn is_told_first() -> bool {
    told()[0] == 0
}

/// Whether this process speaks and writes for all.
pub fn is_first() -> bool {
    team().rank() == 0
}

/// The processes that work together.
pub fn team() -> Arc<dyn Team> {
    #[cfg(feature = "mpi")]
    if let Some(world) = WORLD.get() {
        return world.clone();
    }
    Arc::new(Alone)
}

/// Bytes that other processes have given this one so far.
pub fn given_bytes() -> u64 {
    #[cfg(feature = "mpi")]
    if let Some(world) = WORLD.get() {
        return world.given.load(std::sync::atomic::Ordering::Relaxed);
    }
    0
}

/// How many there are.
pub fn size() -> usize {
    team().size()
}

/// Threads of this process, which work together with those of the others.
///
/// # Errors
/// As [`Workers::new`].
pub fn workers(threads: usize) -> Result<Workers, Failure> {
    Ok(Workers::new(threads)?.in_team(team()))
}

/// The sum of a number over all processes; all must ask.
pub fn sum(own: f64) -> f64 {
    let all = team().exchange(own.to_le_bytes().to_vec());
    all.iter().filter_map(|bytes| Some(f64::from_le_bytes(bytes.as_slice().try_into().ok()?))).sum()
}

/// Says how the process fails, and ends all others with it. The first one speaks at once; what only another one met, that one tells a little later.
pub fn fail(failure: &Failure) {
    let say = super::stderr::say;
    if size() == 1 {
        return say(format_args!("error: {}", failure.message));
    }
    if is_first() {
        say(format_args!("error: {}", failure.message));
    } else {
        std::thread::sleep(LATER);
        say(format_args!("error: process {}: {}", team().rank(), failure.message));
    }
    #[cfg(feature = "mpi")]
    world::end_all(failure.exit as i32);
}

/// By then the first process has ended all, if it met the same.
const LATER: std::time::Duration = std::time::Duration::from_secs(2);
