//! The only place that joins the stages.

use thiserror::Error;

use std::time::Instant;

use crate::progress::Observer;
use crate::reconstruct::{self, Camera, CameraError, Image, SurfacePoint, Values};
use crate::scene::Scene;
use crate::solve::{self, OptionsError, RunOptions, Solution, SolveOptions, SolveReport};
use crate::transmittance::Rays;
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
    /// The camera cannot take a picture.
    #[error(transparent)]
    Camera(#[from] CameraError),
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
    observer: &dyn Observer,
) -> Result<(Evaluator, SolveReport), PipelineError> {
    options.validate()?;
    run.validate()?;
    let start = Instant::now();
    let pool = thread_pool(run)?;
    let mesh = visibility::OccluderMesh::of_scene(&scene);
    let visibility = pool.install(|| visibility::build(run.backend, &mesh))?;
    let build = start.elapsed().as_secs_f64();

    let (evaluator, mut report) = solve_in(pool, visibility, scene, options, run, observer);
    report.time_s.build += build;
    report.counts.triangles = mesh.triangles.len() as u64;
    Ok((evaluator, report))
}

/// Like [`solve`], but asks `visibility`, whatever it is: a backend of one's own, or one that keeps a record of what it is asked. It
/// must answer for the triangles of [`OccluderMesh::of_scene`](visibility::OccluderMesh::of_scene); `run.backend` is not looked at.
///
/// # Errors
/// See [`PipelineError`].
pub fn solve_asking(
    visibility: Box<dyn Visibility>,
    scene: Scene,
    options: &SolveOptions,
    run: &RunOptions,
    observer: &dyn Observer,
) -> Result<(Evaluator, SolveReport), PipelineError> {
    options.validate()?;
    run.validate()?;
    Ok(solve_in(thread_pool(run)?, visibility, scene, options, run, observer))
}

fn solve_in(
    pool: rayon::ThreadPool,
    visibility: Box<dyn Visibility>,
    scene: Scene,
    options: &SolveOptions,
    run: &RunOptions,
    observer: &dyn Observer,
) -> (Evaluator, SolveReport) {
    let rays = Rays::new(&*visibility, &scene);
    let (solution, report) = pool.install(|| solve::solve(scene, options, run, &rays, observer));
    (Evaluator { solution, visibility, pool }, report)
}

fn thread_pool(run: &RunOptions) -> Result<rayon::ThreadPool, PipelineError> {
    let failed = |error: rayon::ThreadPoolBuildError| PipelineError::Threads { threads: run.threads, message: error.to_string() };
    rayon::ThreadPoolBuilder::new().num_threads(run.threads).build().map_err(failed)
}

impl Evaluator {
    /// Makes a stored solution ready to be looked at.
    ///
    /// # Errors
    /// See [`PipelineError`].
    pub fn new(solution: Solution, run: &RunOptions) -> Result<Self, PipelineError> {
        let pool = thread_pool(run)?;
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
        let rays = Rays::new(&*self.visibility, self.solution.scene());
        let paths = self.solution.light_paths(&rays);
        self.pool.install(|| reconstruct::values_at(&self.solution.reconstruction(&rays, &paths), points, observer))
    }

    /// A picture of linear radiance. Cancelled by the observer, it returns `None`.
    ///
    /// # Errors
    /// [`PipelineError::Camera`] if the camera sees nothing, see [`Camera::validate`].
    pub fn render(&self, camera: &Camera, observer: &dyn Observer) -> Result<Option<Image>, PipelineError> {
        let through = camera.rays()?;
        let rays = Rays::new(&*self.visibility, self.solution.scene());
        let paths = self.solution.light_paths(&rays);
        let reconstruction = self.solution.reconstruction(&rays, &paths);
        let render = || reconstruct::render(&reconstruction, &rays, &through, camera.width, camera.height, observer);
        Ok(self.pool.install(render))
    }
}
