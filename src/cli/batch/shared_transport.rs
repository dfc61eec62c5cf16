//! Jobs that change materials alone, with `keep_transport`: a scene is solved once for all jobs with the same options, and each job over what that has
//! stored. Whether it is enough for a job, its own claim tells.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

use patchlight::pipeline::{Evaluator, Workers, with_materials_on};
use patchlight::scene::Scene;
use patchlight::solve::{ErrorReport, OtherMaterialsError, RunOptions, Solution, SolveOptions};

use super::super::exit::Failure;
use super::super::progress::{Voice, Watcher};

/// A scene that was solved as its file says; `None` where that was interrupted, or kept nothing.
type Solved = Arc<Mutex<Option<Option<Arc<Evaluator>>>>>;

/// What is known of a job over stored transport.
pub enum Shared {
    /// A solution that claims what was asked for.
    Good(Box<Solution>, ErrorReport),
    /// It must be solved from scratch: the claim, if there is one, is not enough.
    FromScratch,
    /// It was interrupted.
    Cancelled,
}

/// The solves of one scene by their options.
#[derive(Default)]
pub struct Transports(Mutex<HashMap<String, Solved>>);

impl Transports {
    /// What tells solves apart: options and limits.
    pub fn key(options: &SolveOptions, run: &RunOptions) -> String {
        let values = SolveOptions::entries().map(|entry| format!("{}={}\n", entry.key, entry.value(options).unwrap_or_default()));
        values.chain([format!("{:?} {:?}", run.memory_bytes, run.time_s)]).collect()
    }

    /// A job over the transport of the scene as its file says, which `solve` finds when the first job comes. Others wait meanwhile.
    pub fn with_materials(
        &self,
        changed: &Scene,
        (options, run): (&SolveOptions, &RunOptions),
        workers: &Workers,
        solve: impl FnOnce() -> Result<Evaluator, Failure>,
    ) -> Result<Shared, Failure> {
        let slot = self.0.lock().unwrap_or_else(PoisonError::into_inner).entry(Self::key(options, run)).or_default().clone();
        let solved = {
            let mut slot = slot.lock().unwrap_or_else(PoisonError::into_inner);
            if slot.is_none() {
                *slot = Some(Some(Arc::new(solve()?)).filter(|evaluator| evaluator.solution().transport().is_some()));
            }
            slot.clone().flatten()
        };
        let Some(evaluator) = solved else { return Ok(Shared::FromScratch) };
        let (materials, watcher) = (changed.materials().to_vec(), Watcher::new(Voice::Job));
        Ok(match with_materials_on(workers, evaluator.solution(), materials, &watcher) {
            Ok(Some((solution, error))) if error.estimate <= options.error => Shared::Good(Box::new(solution), error),
            Ok(Some(_)) | Err(OtherMaterialsError::NotFollowed(_) | OtherMaterialsError::WasDark) => Shared::FromScratch,
            Ok(None) => Shared::Cancelled,
            Err(error) => return Err(Failure::bad_input(error)),
        })
    }
}
