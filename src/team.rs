//! Processes that do one work together, as on the machines of a cluster.
//!
//! Each process holds the whole scene and takes every step. Long loops, whose batches do not depend on each other, are dealt out: a process does
//! every n-th batch, then all give each other what they found. So all know the same after each loop, and what they decide and find has the bytes of
//! one process alone. Numbers travel as they lie in memory: all machines must be of one kind.

use bytemuck::Pod;
use serde::Serialize;
use serde::de::DeserializeOwned;

/// The processes that do one work together.
///
/// All must call the same functions in the same order with the same scene, options and points; so observers must not cancel, unless all do at the
/// same question.
pub trait Team: Send + Sync {
    /// How many processes there are, at least 1.
    fn size(&self) -> usize;

    /// The number of this process, from 0.
    fn rank(&self) -> usize;

    /// What all processes give, by rank. It returns once all have called it; where one of them is lost, it ends the program, for nothing can go on.
    fn exchange(&self, own: Vec<u8>) -> Vec<Vec<u8>>;
}

/// A process by itself.
#[derive(Clone, Copy, Debug, Default)]
pub struct Alone;

impl Team for Alone {
    fn size(&self) -> usize {
        1
    }

    fn rank(&self) -> usize {
        0
    }

    fn exchange(&self, own: Vec<u8>) -> Vec<Vec<u8>> {
        vec![own]
    }
}

/// Which batches of a loop this process does.
#[derive(Clone, Copy)]
pub(crate) struct Share<'a> {
    /// Nobody else's, if there is nobody else.
    team: Option<&'a dyn Team>,
}

impl<'a> Share<'a> {
    /// All batches.
    pub const WHOLE: Self = Self { team: None };

    /// Every n-th batch, in a team of n.
    pub fn of(team: &'a dyn Team) -> Self {
        Self { team: Some(team).filter(|team| team.size() > 1) }
    }

    /// Whether that is all of them.
    pub fn is_whole(self) -> bool {
        self.team.is_none()
    }

    /// Whether this process does batch number `batch`.
    pub fn has(self, batch: usize) -> bool {
        self.team.is_none_or(|team| batch % team.size() == team.rank())
    }

    /// Fills in the batches that other processes did, once this one has done its own.
    ///
    /// # Panics
    /// If processes do not do the same.
    pub fn exchange<T: Serialize + DeserializeOwned>(self, batches: &mut [T]) {
        let Some(team) = self.team else { return };
        let own: Vec<&T> = batches.iter().skip(team.rank()).step_by(team.size()).collect();
        for (rank, found) in of_others::<Vec<T>>(team, &own) {
            let theirs = batches.iter_mut().skip(rank).step_by(team.size());
            assert_eq!(theirs.len(), found.len(), "{DIVERGED}");
            theirs.zip(found).for_each(|(batch, found)| *batch = found);
        }
    }

    /// The same where a batch is a chunk of so many numbers.
    ///
    /// # Panics
    /// As [`Share::exchange`].
    pub fn exchange_chunks<T: Pod>(self, values: &mut [T], chunk: usize) {
        let Some(team) = self.team else { return };
        let of = |rank: usize, values: &mut [T], take: &mut dyn FnMut(&mut [u8])| {
            values.chunks_mut(chunk).skip(rank).step_by(team.size()).for_each(|chunk| take(bytemuck::cast_slice_mut(chunk)));
        };
        let mut own = Vec::with_capacity(size_of_val(values) / team.size());
        of(team.rank(), values, &mut |chunk| own.extend_from_slice(chunk));
        for (rank, bytes) in team.exchange(own).iter().enumerate().filter(|(rank, _)| *rank != team.rank()) {
            let mut left = bytes.as_slice();
            of(rank, values, &mut |chunk| {
                let (found, rest) = left.split_at_checked(chunk.len()).expect(DIVERGED);
                chunk.copy_from_slice(found);
                left = rest;
            });
            assert!(left.is_empty(), "{DIVERGED}");
        }
    }

    /// The sum of a number over all processes.
    ///
    /// # Panics
    /// As [`Share::exchange`].
    pub fn sum(self, own: u64) -> u64 {
        self.team.map_or(own, |team| own + of_others::<u64>(team, &own).iter().map(|(_, found)| found).sum::<u64>())
    }

    /// Whether all processes give the same.
    ///
    /// # Panics
    /// As [`Share::exchange`].
    pub fn is_same(self, own: u64) -> bool {
        self.team.is_none_or(|team| of_others::<u64>(team, &own).iter().all(|(_, found)| *found == own))
    }
}

/// What ends processes that do not do the same.
const DIVERGED: &str = "the processes of a team do not do the same";

/// What the other processes give for this one's, with their ranks.
fn of_others<T: DeserializeOwned>(team: &dyn Team, own: &impl Serialize) -> Vec<(usize, T)> {
    let bytes = postcard::to_stdvec(own).expect("numbers can be encoded");
    let others = team.exchange(bytes).into_iter().enumerate().filter(|(rank, _)| *rank != team.rank());
    others.map(|(rank, bytes)| (rank, postcard::from_bytes(&bytes).expect(DIVERGED))).collect()
}

#[cfg(test)]
mod tests {
    use std::sync::{Barrier, Mutex};

    use super::*;

    /// Threads that play processes.
    struct Threads {
        brought: Mutex<Vec<Vec<u8>>>,
        barrier: Barrier,
    }

    struct Member<'a>(&'a Threads, usize);

    impl Team for Member<'_> {
        fn size(&self) -> usize {
            self.0.brought.lock().unwrap().len()
        }

        fn rank(&self) -> usize {
            self.1
        }

        fn exchange(&self, own: Vec<u8>) -> Vec<Vec<u8>> {
            self.0.brought.lock().unwrap()[self.1] = own;
            self.0.barrier.wait();
            let all = self.0.brought.lock().unwrap().clone();
            self.0.barrier.wait();
            all
        }
    }

    /// What each of so many members finds.
    fn found_by<R: Send>(size: usize, work: impl Fn(Share<'_>) -> R + Sync) -> Vec<R> {
        let threads = Threads { brought: Mutex::new(vec![Vec::new(); size]), barrier: Barrier::new(size) };
        std::thread::scope(|scope| {
            let member = |rank| {
                let (threads, work) = (&threads, &work);
                scope.spawn(move || work(Share::of(&Member(threads, rank))))
            };
            Vec::from_iter((0..size).map(member)).into_iter().map(|thread| thread.join().unwrap()).collect()
        })
    }

    #[test]
    fn every_batch_is_done_once_and_known_to_all() {
        for (size, count) in [(1, 7), (2, 7), (3, 7), (5, 3), (4, 0)] {
            let done = Mutex::new(vec![0; count]);
            let of_each = found_by(size, |share| {
                let mut batches = vec![String::new(); count];
                for (number, batch) in batches.iter_mut().enumerate().filter(|(number, _)| share.has(*number)) {
                    done.lock().unwrap()[number] += 1;
                    *batch = format!("batch {number}");
                }
                share.exchange(&mut batches);
                let mut values = vec![f64::NAN; 2 * count];
                let own = values.chunks_mut(3).enumerate().filter(|(number, _)| share.has(*number));
                own.for_each(|(number, chunk)| chunk.fill(number as f64 + 0.1));
                share.exchange_chunks(&mut values, 3);
                (batches, values, share.sum(number_of(share)), share.is_same(7), share.is_same(number_of(share)))
            });
            assert!(done.into_inner().unwrap().iter().all(|&times| times == 1), "{size} {count}");
            for (batches, values, sum, same, different) in of_each {
                assert_eq!(batches, Vec::from_iter((0..count).map(|number| format!("batch {number}"))));
                assert_eq!(values, Vec::from_iter((0..2 * count).map(|index| (index / 3) as f64 + 0.1)));
                assert_eq!((sum, same, different), ((0..size as u64).sum(), true, size == 1));
            }
        }
    }

    fn number_of(share: Share<'_>) -> u64 {
        share.team.map_or(0, |team| team.rank() as u64)
    }
}
