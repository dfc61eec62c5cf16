//! A backend that keeps a record of what it is asked.

use std::sync::{Arc, Mutex};

use patchlight::visibility::{Hit, Ray, Segment, Visibility};

/// One call of a backend.
pub enum Call {
    Occluded(Vec<Segment>),
    FirstHits(Vec<Ray>),
}

/// What was kept.
#[derive(Default)]
pub struct Record {
    pub calls: Vec<Call>,
    seen: usize,
}

/// Answers by another backend, and keeps some of the calls: a run of [`Recorder::RUN`] in a row out of every `every` runs, so that all
/// stages of a solve are represented and neighbours stay neighbours.
pub struct Recorder {
    pub backend: Box<dyn Visibility>,
    pub every: usize,
    pub record: Arc<Mutex<Record>>,
}

impl Recorder {
    const RUN: usize = 32;

    fn keep(&self, call: impl FnOnce() -> Call) {
        let mut record = self.record.lock().expect("no thread that recorded has panicked");
        if (record.seen / Self::RUN).is_multiple_of(self.every) {
            record.calls.push(call());
        }
        record.seen += 1;
    }
}

impl Visibility for Recorder {
    fn description(&self) -> String {
        self.backend.description()
    }

    fn occluded(&self, segments: &[Segment], occluded: &mut [bool]) {
        self.keep(|| Call::Occluded(segments.to_vec()));
        self.backend.occluded(segments, occluded);
    }

    fn first_hits(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        self.keep(|| Call::FirstHits(rays.to_vec()));
        self.backend.first_hits(rays, hits);
    }
}
