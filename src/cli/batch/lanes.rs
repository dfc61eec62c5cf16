//! Jobs side by side: each lane does one after the other, on threads of its own, so that all lanes together have no more than were asked for.

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use patchlight::pipeline::Workers;

use super::super::exit::{Exit, Failure};
use super::super::interrupt;
use super::super::process;
use super::super::ranks::{self, Deal};
use super::journal::{Cost, Figures, Journal, Record};
use super::stock::Stock;
use super::tasks::Task;
use super::teller::Teller;
use super::work::Ready;

/// All that lanes share.
pub struct Lanes<'a> {
    /// The jobs, in their order.
    pub tasks: &'a [Task],
    /// Their scenes.
    pub stock: &'a Stock,
    /// The folder of results.
    pub results: &'a Path,
    /// What was done before, by names of jobs.
    pub known: &'a BTreeMap<String, Record>,
    /// What is to become of jobs that are not done.
    pub mode: Mode<'a>,
    /// Who tells of them.
    pub teller: &'a Teller,
    /// Who deals them out.
    pub deal: &'a Deal,
}

/// What is to become of jobs that are not done.
pub enum Mode<'a> {
    /// They are done, tried again so often if the machine fails, and noted.
    Work { journal: &'a Journal, retries: u32 },
    /// Nothing.
    Look,
}

/// What lanes have come to.
#[derive(Default)]
struct State {
    /// By number of the job.
    records: BTreeMap<usize, Record>,
    failure: Option<Failure>,
    /// So many jobs, in the order in which they are dealt, are dealt to this process or to others.
    dealt: usize,
}

impl Lanes<'_> {
    /// Runs as many lanes as there are numbers of threads, until all jobs have ended or an interrupt comes. Gives the records of all processes by number
    /// of the job; whatever has none was interrupted, or is not done.
    ///
    /// # Errors
    /// Without threads, or where the journal cannot be written.
    pub fn run(&self, threads: &[usize]) -> Result<BTreeMap<usize, Record>, Failure> {
        let pools = threads.iter().map(|&count| Workers::new(count)).collect::<Result<Vec<_>, _>>()?;
        let state = Mutex::new(State::default());
        let elsewhere = ranks::sum(pools.len() as f64) as usize - pools.len();
        std::thread::scope(|scope| {
            for (number, pool) in pools.iter().enumerate() {
                let state = &state;
                scope.spawn(move || self.lane(number, pool, state));
            }
            self.deal.serve(elsewhere, || locked(&state).failure.is_some());
        });
        let State { records, failure, .. } = state.into_inner().unwrap_or_else(PoisonError::into_inner);
        failure.map_or_else(|| of_all(records), Err)
    }

    fn lane(&self, lane: usize, workers: &Workers, state: &Mutex<State>) {
        let state = || locked(state);
        loop {
            // The next job, unless there is a reason to end.
            if state().failure.is_some() || interrupt::count() > 0 {
                return self.deal.leave(lane);
            }
            let Some(number) = self.next(lane, state()) else { return };

            // The job, alone with whatever fails in it.
            let task = &self.tasks[number];
            let ended = self.end(task, workers);
            self.stock.release(task.scene);
            match ended {
                Ok(Some(record)) => drop(state().records.insert(number, record)),
                Ok(None) => {}
                Err(failure) => drop(state().failure.get_or_insert(failure)),
            }
        }
    }

    /// The number of the next job. Those before it that went to other processes want no scene of this one any more.
    fn next(&self, lane: usize, mut state: MutexGuard<'_, State>) -> Option<usize> {
        // One lane after the other, so that places come in their order.
        let place = self.deal.next(lane)?;
        let elsewhere = state.dealt..place;
        state.dealt = place + 1;
        drop(state);
        self.deal.order[elsewhere].iter().for_each(|&number| self.stock.release(self.tasks[number].scene));
        Some(self.deal.order[place])
    }

    /// Does a job, unless it is done; `None` if interrupted, or only looked for.
    fn end(&self, task: &Task, workers: &Workers) -> Result<Option<Record>, Failure> {
        let (start, cpu_before) = (Instant::now(), cpu_seconds(workers));
        let retries = if let Mode::Work { retries, .. } = self.mode { retries } else { 0 };
        for attempts in 1..=retries.saturating_add(1) {
            let mut record = match alone(|| self.attempt(task, workers)) {
                Ok(Attempt::Known(record)) => {
                    self.teller.kept(&record);
                    return Ok(Some(record));
                }
                Ok(Attempt::Done(record)) => record,
                Ok(Attempt::Nothing) => return Ok(None),
                Err(failure) if failure.exit == Exit::Failed && attempts <= retries && interrupt::count() == 0 => continue,
                Err(failure) => failed(task, failure),
            };
            let Mode::Work { journal, .. } = self.mode else { return Ok(Some(record)) };
            let cpu_s = cpu_seconds(workers).zip(cpu_before).map(|(now, before)| now - before);
            record.cost = Cost { cpu_s, wall_s: start.elapsed().as_secs_f64(), attempts };
            journal.add(&record)?;
            self.teller.ended(&record);
            return Ok(Some(record));
        }
        Ok(None)
    }

    fn attempt(&self, task: &Task, workers: &Workers) -> Result<Attempt, Failure> {
        let known = self.known.get(&task.job.name);
        match (&self.mode, known) {
            (Mode::Look, None) => return Ok(Attempt::Nothing),
            // What failed stays so, until it is tried again.
            (Mode::Look, Some(record)) if !record.has_results() => return Ok(Attempt::Known(record.clone())),
            _ => {}
        }
        let ready = Ready::new(task, self.stock, workers)?;
        if let Some(record) = known.filter(|record| ready.is_done(record, self.results)) {
            return Ok(Attempt::Known(record.clone()));
        }
        match self.mode {
            Mode::Look => Ok(Attempt::Nothing),
            Mode::Work { .. } => Ok(ready.work(workers, self.results)?.map_or(Attempt::Nothing, Attempt::Done)),
        }
    }
}

fn locked(state: &Mutex<State>) -> MutexGuard<'_, State> {
    state.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The records of all processes, from those of this one.
fn of_all(own: BTreeMap<usize, Record>) -> Result<BTreeMap<usize, Record>, Failure> {
    let failed = |error: serde_json::Error| Failure::failed(format_args!("records cannot be exchanged: {error}"));
    let all = ranks::team().exchange(serde_json::to_vec(&own).map_err(failed)?);
    let of_each = all.iter().map(|bytes| serde_json::from_slice::<BTreeMap<usize, Record>>(bytes));
    Ok(of_each.collect::<Result<Vec<_>, _>>().map_err(failed)?.into_iter().flatten().collect())
}

/// What came of an attempt.
enum Attempt {
    /// It was done before.
    Known(Record),
    /// It is done now.
    Done(Record),
    /// It was interrupted, or only looked for.
    Nothing,
}

/// CPU seconds of the calling thread, and of its workers.
fn cpu_seconds(workers: &Workers) -> Option<f64> {
    Some(process::thread_cpu_seconds()? + workers.cpu_seconds()?)
}

/// Does some work. A panic in it, which is a defect of the program, ends this job alone; the panic itself tells of it on stderr.
fn alone<R>(work: impl FnOnce() -> Result<R, Failure>) -> Result<R, Failure> {
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|panic| {
        let text = panic.downcast_ref::<String>().map(String::as_str).or(panic.downcast_ref::<&str>().copied());
        Err(Failure::failed(format_args!("the program has a defect: {}", text.unwrap_or("it panicked"))))
    })
}

/// The record of a job without results.
fn failed(task: &Task, failure: Failure) -> Record {
    let figures = Figures { message: failure.message, ..Figures::default() };
    Record { name: task.job.name.clone(), exit: failure.exit as u8, figures, ..Record::default() }
}

/// The threads of each lane: `threads` dealt out to `lanes`, at least one to each.
pub fn deal(threads: usize, lanes: usize) -> Vec<usize> {
    (0..lanes).map(|lane| (threads / lanes + usize::from(lane < threads % lanes)).max(1)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn threads_are_dealt_out() {
        assert_eq!(deal(8, 3), [3, 3, 2]);
        assert_eq!(deal(2, 2), [1, 1]);
        assert_eq!(deal(2, 3), [1, 1, 1]);
        assert_eq!(deal(4, 1), [4]);
    }

    #[test]
    fn a_panic_is_a_failure_of_one_job() {
        let failure = alone(|| -> Result<(), Failure> { panic!("at {}", 7) }).unwrap_err();
        assert_eq!((failure.exit, failure.message.as_str()), (Exit::Failed, "the program has a defect: at 7"));
        assert_eq!(alone(|| Ok(7)).unwrap(), 7);
    }
}
