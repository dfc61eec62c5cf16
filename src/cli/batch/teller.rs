//! What is told while jobs are done.

use std::fmt::Write as _;
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use indicatif::{ProgressBar, ProgressStyle};
use serde_json::json;

use super::super::process;
use super::super::progress::Voice;
use super::super::stderr::say;
use super::journal::Record;

/// Tells of each job that ends, and how long the others will take.
pub struct Teller {
    voice: Voice,
    jobs: usize,
    lanes: usize,
    start: Instant,
    counts: Mutex<Counts>,
    bar: Option<ProgressBar>,
}

/// Jobs so far.
#[derive(Clone, Copy, Default)]
struct Counts {
    /// Done before.
    kept: usize,
    /// Done now, those that failed as well.
    ended: usize,
}

impl Teller {
    /// Of so many jobs, so many at once.
    pub fn new(voice: Voice, jobs: usize, lanes: usize) -> Self {
        let bar = (voice == Voice::Bar).then(|| {
            let style = ProgressStyle::with_template("{spinner} {elapsed} {bar:24} {pos} of {len} jobs {msg}");
            ProgressBar::new(jobs as u64).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
        });
        Self { voice, jobs, lanes, start: Instant::now(), counts: Mutex::default(), bar }
    }

    /// A job was done before.
    pub fn kept(&self, record: &Record) {
        let counts = self.count(|counts| counts.kept += 1);
        self.tell(record, counts, "done before");
    }

    /// A job has ended.
    pub fn ended(&self, record: &Record) {
        let counts = self.count(|counts| counts.ended += 1);
        let mut text = match (record.has_results(), record.figures.claimed.parse::<f64>()) {
            (true, Ok(claimed)) => format!("{:.2}% claimed", 100.0 * claimed),
            (true, Err(_)) => "nothing can be said about its error".to_owned(),
            (false, _) => format!("failed: {}", record.figures.message),
        };
        if let Some(cpu_s) = record.cost.cpu_s {
            let _ = write!(text, ", {cpu_s:.2} CPU-s");
        }
        if !record.has_results() {
            let (name, exit, message) = (&record.name, record.exit, &record.figures.message);
            self.above_the_bar(|| self.voice.warn(format_args!("job '{name}' failed with exit code {exit}: {message}")));
        }
        self.tell(record, counts, &text);
        if counts.ended == self.lanes && counts.ended + counts.kept < self.jobs {
            self.foresee(counts);
        }
    }

    /// What all jobs will take, measured by the first ones.
    fn foresee(&self, counts: Counts) {
        let memory =
            process::peak_resident_bytes().map_or(String::new(), |bytes| format!(", {:.2} GB so far", bytes as f64 * 1e-9));
        let left = in_words(self.left_s(counts).unwrap_or(0.0));
        let by = if counts.ended == 1 { "job".to_owned() } else { format!("{} jobs", counts.ended) };
        self.above_the_bar(|| self.voice.figure("foreseen", format_args!("{left} more, by the first {by}{memory}")));
    }

    /// The rest takes as long, job by job, as those took that were done here.
    fn left_s(&self, counts: Counts) -> Option<f64> {
        let left = self.jobs - counts.kept - counts.ended;
        (counts.ended > 0).then(|| self.start.elapsed().as_secs_f64() / counts.ended as f64 * left as f64)
    }

    fn count(&self, add: impl FnOnce(&mut Counts)) -> Counts {
        let mut counts = self.counts.lock().unwrap_or_else(PoisonError::into_inner);
        add(&mut counts);
        *counts
    }

    fn tell(&self, record: &Record, counts: Counts, text: &str) {
        let (done, jobs, time_s, left_s) =
            (counts.kept + counts.ended, self.jobs, self.start.elapsed().as_secs_f64(), self.left_s(counts));
        match (self.voice, &self.bar) {
            (Voice::Bar, Some(bar)) => {
                bar.set_position(done as u64);
                bar.set_message(left_s.map_or(String::new(), |left_s| format!("{} left", in_words(left_s))));
            }
            (Voice::Plain, _) => {
                let left = left_s.map_or(String::new(), |left_s| format!("; {} left", in_words(left_s)));
                say(format_args!("{time_s:>8.1} s  job {done} of {jobs}, '{}': {text}{left}", record.name));
            }
            (Voice::Json, _) => say(format_args!(
                "{}",
                json!({
                    "event": "job", "name": record.name, "exit": record.exit, "text": text,
                    "done": done, "jobs": jobs, "time_s": time_s, "left_s": left_s,
                })
            )),
            _ => {}
        }
    }

    fn above_the_bar(&self, tell: impl FnOnce()) {
        match &self.bar {
            Some(bar) => bar.suspend(tell),
            None => tell(),
        }
    }
}

impl Drop for Teller {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

/// A time in the largest unit of which it has two.
fn in_words(seconds: f64) -> String {
    match seconds {
        seconds if seconds < 120.0 => format!("{seconds:.0} s"),
        seconds if seconds < 7200.0 => format!("{:.0} min", seconds / 60.0),
        seconds => format!("{:.1} h", seconds / 3600.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_have_fitting_units() {
        assert_eq!([1.6, 119.0, 300.0, 9000.0].map(in_words), ["2 s", "119 s", "5 min", "2.5 h"]);
    }

    #[test]
    fn what_is_left_follows_from_what_was_done_here() {
        let teller = Teller::new(Voice::None, 10, 2);
        teller.kept(&Record::default());
        assert_eq!(teller.left_s(teller.count(|_| {})), None);
        let left_s = teller.left_s(teller.count(|counts| counts.ended += 3)).unwrap();
        // Six are left, so it is twice of what the three took, which goes on.
        assert!(left_s > 0.0 && left_s <= 2.0 * teller.start.elapsed().as_secs_f64());
    }
}
