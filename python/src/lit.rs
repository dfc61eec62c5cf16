//! What stands behind a solution and its parts.

use patchlight::pipeline::Evaluator;
use patchlight::solve::SolveReport;

use crate::errors::Failure;
use crate::workers::Home;

/// A solution with what is needed to look at it.
pub struct Lit {
    /// Always there, but while it is dropped.
    evaluator: Option<Evaluator>,
    pub report: Option<Report>,
    home: Home,
}

/// What the solve told.
pub struct Report {
    pub json: String,
    pub solve: SolveReport,
}

impl Lit {
    pub fn new(evaluator: Evaluator, report: Option<Report>) -> Self {
        Self { evaluator: Some(evaluator), report, home: Home::here() }
    }

    /// The evaluator, where its threads are.
    pub fn evaluator(&self) -> Result<&Evaluator, Failure> {
        match &self.evaluator {
            Some(evaluator) if !self.home.is_elsewhere() => Ok(evaluator),
            _ => Err(Failure::resource(
                "this solution belongs to the process that this one was forked from: save it there and load it here, or start processes \
                 with the method 'spawn'",
            )),
        }
    }
}

/// Threads that are not there cannot be waited for.
impl Drop for Lit {
    fn drop(&mut self) {
        if self.home.is_elsewhere() {
            std::mem::forget(self.evaluator.take());
        }
    }
}
