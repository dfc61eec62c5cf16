//! MPI: how processes give each other bytes, and how the first one deals out jobs.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use mpi::Threading;
use mpi::collective::CommunicatorCollectives;
use mpi::datatype::PartitionMut;
use mpi::environment::Universe;
use mpi::point_to_point::{Destination, Source};
use mpi::topology::{Communicator, SimpleCommunicator};
use patchlight::team::Team;

use super::super::exit::Failure;

/// Bytes that all processes together give at once, at most: MPI counts them in 31 bits.
const AT_ONCE: usize = 1 << 30;

/// Whoever waits for others looks without rest for so long, then once in a while: it may share its core with one of them.
const WITHOUT_REST: Duration = Duration::from_millis(2);
const REST: Duration = Duration::from_micros(200);

/// All processes.
#[derive(Default)]
pub struct World {
    /// Bytes that others have given this one.
    pub given: AtomicU64,
}

/// Joins them; the launcher told of so many.
pub fn join(told: usize) -> Result<Universe, Failure> {
    let initialised = mpi::initialize_with_threading(Threading::Multiple);
    let Some((universe, _)) = initialised.filter(|(_, threading)| *threading >= Threading::Multiple) else {
        return Err(Failure::failed("MPI cannot be initialised for calls from several threads"));
    };
    let found = universe.world().size() as usize;
    if found != told {
        return Err(Failure::usage(format_args!(
            "the launcher started {told} processes, and MPI knows of {found}, so each would do all of it: start them by the mpirun of the MPI that this \
             program was built with, or by srun with the --mpi that it needs"
        )));
    }
    Ok(universe)
}

/// Ends all of them with this exit code.
pub fn end_all(exit: i32) {
    SimpleCommunicator::world().abort(exit)
}

impl Team for World {
    fn size(&self) -> usize {
        SimpleCommunicator::world().size() as usize
    }

    fn rank(&self) -> usize {
        SimpleCommunicator::world().rank() as usize
    }

    fn exchange(&self, own: Vec<u8>) -> Vec<Vec<u8>> {
        let world = SimpleCommunicator::world();
        wait_for_all(&world);
        let mut lengths = vec![0_u64; self.size()];
        world.all_gather_into(&(own.len() as u64), &mut lengths);
        self.given.fetch_add(lengths.iter().sum::<u64>() - own.len() as u64, Ordering::Relaxed);

        // Part by part, as much as may be given at once.
        let part = AT_ONCE / self.size();
        let mut all: Vec<Vec<u8>> = lengths.iter().map(|&length| Vec::with_capacity(length as usize)).collect();
        for begin in (0..lengths.iter().copied().max().unwrap_or(0) as usize).step_by(part) {
            let counts: Vec<i32> = lengths.iter().map(|&length| (length as usize).saturating_sub(begin).min(part) as i32).collect();
            let starts: Vec<i32> = counts.iter().scan(0, |sum, count| Some(std::mem::replace(sum, *sum + count))).collect();
            let mut given = vec![0_u8; counts.iter().sum::<i32>() as usize];
            let own = &own[begin.min(own.len())..][..counts[self.rank()] as usize];
            world.all_gather_varcount_into(own, &mut PartitionMut::new(&mut given[..], &counts[..], &starts[..]));
            for (rank, bytes) in all.iter_mut().enumerate() {
                bytes.extend_from_slice(&given[starts[rank] as usize..][..counts[rank] as usize]);
            }
        }
        all
    }
}

/// Returns when all processes have come here.
fn wait_for_all(world: &SimpleCommunicator) {
    let (mut barrier, begun) = (world.immediate_barrier(), Instant::now());
    loop {
        match barrier.test() {
            Ok(_) => return,
            Err(open) => barrier = open,
        }
        if begun.elapsed() < WITHOUT_REST { std::thread::yield_now() } else { std::thread::sleep(REST) }
    }
}

/// Tags of messages: what lanes ask, and from here on the answers, by lane.
const ASKED: i32 = 0;
const ANSWERS: i32 = 1;

/// What a lane asks with its number: for a job, or to be left out from now on.
const WANTS: u64 = 0;
const LEAVES: u64 = 1;

/// The answer that there is none.
const NONE: u64 = u64::MAX;

/// How often the first process looks for questions.
const LOOK: Duration = Duration::from_millis(1);

/// The place that the first process deals to a lane of this one; `None` if there is none left.
pub fn dealt(lane: usize) -> Option<usize> {
    let world = SimpleCommunicator::world();
    let first = world.process_at_rank(0);
    first.send_with_tag(&[lane as u64, WANTS][..], ASKED);
    let (place, _) = first.receive_with_tag::<u64>(ANSWERS + lane as i32);
    (place != NONE).then_some(place as usize)
}

/// A lane of this process asks no more, though there may be more.
pub fn leave(lane: usize) {
    SimpleCommunicator::world().process_at_rank(0).send_with_tag(&[lane as u64, LEAVES][..], ASKED);
}

/// Deals places to the lanes of other processes, until so many have left or got none, or all is over.
pub fn deal(mut lanes: usize, next: impl Fn() -> Option<usize>, is_over: impl Fn() -> bool) {
    let world = SimpleCommunicator::world();
    while lanes > 0 && !is_over() {
        let Some((message, _)) = world.any_process().immediate_matched_probe_with_tag(ASKED) else {
            std::thread::sleep(LOOK);
            continue;
        };
        let mut asked = [0_u64; 2];
        let from = message.matched_receive_into(&mut asked[..]).source_rank();
        let [lane, what] = asked;
        let answer = if what == WANTS { next() } else { None };
        lanes -= usize::from(answer.is_none());
        if what == WANTS {
            let place = answer.map_or(NONE, |place| place as u64);
            world.process_at_rank(from).send_with_tag(&place, ANSWERS + lane as i32);
        }
    }
}
