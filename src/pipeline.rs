//! The only place that joins the stages.

mod baking;
mod error;
mod findings;
mod hurried;
mod of_mesh;
mod pictures;
mod relit;
mod sensors;
mod vertices;
mod workers;

pub use error::PipelineError;
pub use findings::picture_of_findings;
pub use of_mesh::ViewMesh;
pub use workers::Workers;

use std::sync::{Arc, OnceLock};
use std::time::Instant;

use crate::bounds::{self, BoundsInput, BoundsReport, FormFactorRule, ImportanceBounds, PointBounds, RadiosityBounds};
use crate::hierarchy::Hierarchy;
use crate::mesh::MeshIndex;
use crate::picture::{self, Camera, Image, Shown};
use crate::progress::{Observer, Progress, Stage};
use crate::scene::{Light, LightGroupError, Material, Scene, SurfacePoint};
use crate::solve::{
    self, Beginning, Bounds, ErrorReport, InitialImportance, Interest, OtherMaterialsError, RunOptions, Solution, SolveOptions,
    SolveReport, Strategy,
};
use crate::sweep::Importance;
use crate::team::Alone;
use crate::transmittance::Rays;
use crate::values::{self, Gather, ShadingMethod, Values};
use crate::visibility::{self, Backend, OccluderMesh, Visibility, VisibilityError};

/// A solution with what is needed to look at it: visibility and a pool of threads.
pub struct Evaluator {
    solution: Solution,
    visibility: Arc<dyn Visibility>,
    pool: Workers,
    /// Of the lit mesh, once it is asked for.
    mesh_index: OnceLock<MeshIndex>,
}

/// Solves `scene`. A run that a limit or the observer ends early is no error: the report says so, and the solution so far is
/// returned.
///
/// # Errors
/// See [`PipelineError`].
pub fn solve(
    scene: Scene,
    options: &SolveOptions,
    run: &RunOptions,
    observer: &dyn Observer,
) -> Result<(Evaluator, SolveReport), PipelineError> {
    solve_on(Workers::new(run.threads)?, scene, options, run, observer)
}

/// Like [`solve()`], on threads that others may use as well; `run.threads` is not looked at.
///
/// # Errors
/// See [`PipelineError`].
pub fn solve_on(
    pool: Workers,
    scene: Scene,
    options: &SolveOptions,
    run: &RunOptions,
    observer: &dyn Observer,
) -> Result<(Evaluator, SolveReport), PipelineError> {
    check(&scene, options, run)?;
    check_team(&pool, &scene, options, run)?;
    let start = Instant::now();
    // Visibility is built on one thread: meanwhile others build the hierarchy.
    let see = || -> Result<_, VisibilityError> {
        let mesh = OccluderMesh::of_scene(&scene);
        Ok((visibility::build(run.backend, &mesh)?, mesh.triangles.len() as u64))
    };
    let (seen, hierarchy) = pool.install(|| rayon::join(see, || clusters(&scene, run, observer)));
    let (visibility, triangles) = seen?;
    let build = start.elapsed().as_secs_f64();

    let run = &RunOptions { time_s: run.time_s.map(|seconds| (seconds - build).max(0.0)), ..run.clone() };
    let (evaluator, mut report) = solve_in(pool, (visibility, hierarchy), scene, options, run, observer)?;
    report.time_s.build += build;
    report.counts.triangles = triangles;
    Ok((evaluator, report))
}

/// Like [`solve()`], but asks `visibility`, whatever it is: a backend of one's own, or one that keeps a record of what it is asked.
/// It must answer for the triangles of [`OccluderMesh::of_scene`](visibility::OccluderMesh::of_scene); `run.backend` is not looked
/// at.
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
    solve_asking_on(Workers::new(run.threads)?, visibility, scene, options, run, observer)
}

/// Like [`solve_asking`], on threads that others may use as well; `run.threads` is not looked at.
///
/// # Errors
/// See [`PipelineError`].
pub fn solve_asking_on(
    pool: Workers,
    visibility: Box<dyn Visibility>,
    scene: Scene,
    options: &SolveOptions,
    run: &RunOptions,
    observer: &dyn Observer,
) -> Result<(Evaluator, SolveReport), PipelineError> {
    check(&scene, options, run)?;
    check_team(&pool, &scene, options, run)?;
    let start = Instant::now();
    let hierarchy = pool.install(|| clusters(&scene, run, observer));
    let build = start.elapsed().as_secs_f64();
    let run = &RunOptions { time_s: run.time_s.map(|seconds| (seconds - build).max(0.0)), ..run.clone() };
    let (evaluator, mut report) = solve_in(pool, (visibility, hierarchy), scene, options, run, observer)?;
    report.time_s.build += build;
    Ok((evaluator, report))
}

/// The hierarchy that a solve begins with; where its time is over, of clusters as they come.
fn clusters(scene: &Scene, run: &RunOptions, observer: &dyn Observer) -> Hierarchy {
    let (start, elements) = (Instant::now(), scene.surfaces().len() as u64);
    observer.progress(&Progress { stage: Stage::Build, round: 0, fraction: None, links: 0, elements, error: None });
    let is_late = || run.time_s.is_some_and(|seconds| start.elapsed().as_secs_f64() >= seconds);
    Hierarchy::new_unless(scene, &|| observer.cancelled() || is_late())
}

/// [`Solution::with_materials`] on these threads.
///
/// # Errors
/// See [`OtherMaterialsError`].
pub fn with_materials_on(
    pool: &Workers,
    solution: &Solution,
    materials: Vec<Material>,
    observer: &dyn Observer,
) -> Result<Option<(Solution, ErrorReport)>, OtherMaterialsError> {
    pool.install(|| solution.with_materials(materials, observer))
}

fn solve_in(
    pool: Workers,
    (visibility, hierarchy): (Box<dyn Visibility>, Hierarchy),
    scene: Scene,
    options: &SolveOptions,
    run: &RunOptions,
    observer: &dyn Observer,
) -> Result<(Evaluator, SolveReport), PipelineError> {
    let start = Instant::now();
    let importance = InitialImportance::of(&options.importance, &scene, &*visibility)?;
    let team = pool.clone();
    let rays = Rays::new(&*visibility, &scene).shared(team.share());
    let rays = if options.links.skips.rays { rays } else { rays.asking_in_clear_scenes() };
    let rays = if options.links.skips.clear { rays } else { rays.asking_between_clear_planes() };
    let beginning = Beginning { hierarchy, importance };
    let (solution, mut report) = pool.install(|| solve::solve(scene, options, run, beginning, &rays, observer));
    let mut evaluator = Evaluator::asking_on(pool, visibility, solution);
    if options.bounds == Bounds::Guaranteed {
        let solved = Instant::now();
        let late = || run.time_s.is_some_and(|seconds| start.elapsed().as_secs_f64() >= seconds);
        let stop = || observer.cancelled() || late();
        let input = evaluator.bounds_input(FormFactorRule::QuasiConcave, &stop);
        let (bounds, bounds_report) = evaluator.pool.install(|| bounds::bound_radiosities(&input));
        (evaluator.solution.bounds, report.bounds) = (Some(bounds), Some(bounds_report));
        report.time_s.bounds += solved.elapsed().as_secs_f64();
    }
    Ok((evaluator, report))
}

/// Whether options are in range and know the light groups of the scene, and the budget of memory is enough to begin.
fn check(scene: &Scene, options: &SolveOptions, run: &RunOptions) -> Result<(), PipelineError> {
    options.validate()?;
    run.validate()?;
    let knows_groups = options.strategy == Strategy::Default && options.bounds != Bounds::Guaranteed && !options.keep_transport;
    if scene.light_groups().is_some() && !knows_groups {
        return Err(LightGroupError::Options.into());
    }
    if options.bounds == Bounds::Guaranteed && scene.lights().iter().any(Light::is_on) {
        return Err(PipelineError::Lights);
    }
    let Some(given) = run.memory_bytes else { return Ok(()) };
    let needed = solve::least_bytes(scene, run.backend);
    if needed > given { Err(PipelineError::Memory { needed, given }) } else { Ok(()) }
}

/// Whether all processes of a team solve the same, and no clock can part them.
fn check_team(pool: &Workers, scene: &Scene, options: &SolveOptions, run: &RunOptions) -> Result<(), PipelineError> {
    let share = pool.share();
    if share.is_whole() {
        return Ok(());
    }
    if run.time_s.is_some() {
        return Err(PipelineError::TeamTime);
    }
    let is_same = share.is_same(fingerprint(&(scene, options, run.memory_bytes)));
    if is_same { Ok(()) } else { Err(PipelineError::TeamDiffers) }
}

/// Whatever differs has another one, but for once in four billion times.
fn fingerprint(of: &impl serde::Serialize) -> u64 {
    crc32fast::hash(&postcard::to_stdvec(of).unwrap_or_default()).into()
}

impl Evaluator {
    /// Makes a stored solution ready to be evaluated.
    ///
    /// # Errors
    /// See [`PipelineError`].
    pub fn new(solution: Solution, run: &RunOptions) -> Result<Self, PipelineError> {
        Self::new_on(Workers::new(run.threads)?, solution, run.backend)
    }

    /// Like [`Evaluator::new`], on threads that others may use as well. In a team all processes bring the same solution.
    ///
    /// # Errors
    /// See [`PipelineError`].
    pub fn new_on(pool: Workers, solution: Solution, backend: Backend) -> Result<Self, PipelineError> {
        if !pool.share().is_whole() && !pool.share().is_same(fingerprint(&solution)) {
            return Err(PipelineError::TeamDiffers);
        }
        let mesh = OccluderMesh::of_scene(&solution.scene);
        let visibility = pool.install(|| visibility::build(backend, &mesh))?;
        Ok(Self::asking_on(pool, visibility, solution))
    }

    /// Like [`Evaluator::new_on`], but asks `visibility`, whatever it is; see [`solve_asking`].
    pub fn asking_on(pool: Workers, visibility: Box<dyn Visibility>, solution: Solution) -> Self {
        Self { solution, visibility: Arc::from(visibility), pool, mesh_index: OnceLock::new() }
    }

    /// The solution.
    pub fn solution(&self) -> &Solution {
        &self.solution
    }

    /// Lower and upper radiosities of every node, if it was solved with [`Bounds::Guaranteed`].
    pub fn bounds(&self) -> Option<&RadiosityBounds> {
        self.solution.bounds.as_ref()
    }

    /// Bounds the radiosities of every node over the links of the solution, whatever it was solved with. Of clusters less is known
    /// than of surfaces, so bounds are wide where these are linked. The links of the strategies of 1994 do not account for all
    /// pairs, so theirs prove nothing.
    pub fn bound(&self, rule: FormFactorRule) -> (RadiosityBounds, BoundsReport) {
        self.pool.install(|| bounds::bound_over_links(&self.bounds_input(rule, &|| false)))
    }

    /// Ends work in a team: from here on this process does all that is asked of it by itself.
    pub fn leave_team(&mut self) {
        self.pool = self.pool.clone().in_team(Arc::new(Alone));
    }

    /// Rays through the scene, of which this process casts its share.
    fn rays(&self) -> Rays<'_> {
        Rays::new(&*self.visibility, self.solution.scene()).shared(self.pool.share())
    }

    fn bounds_input<'a>(&'a self, rule: FormFactorRule, stop: &'a (dyn Fn() -> bool + Sync)) -> BoundsInput<'a> {
        let Solution { scene, hierarchy, links, radiosity, .. } = &self.solution;
        let SolveOptions { bounds_work: work, error, .. } = *self.solution.options();
        BoundsInput { scene, hierarchy, links, radiosity: radiosity.values(), rule, work, error, stop }
    }

    /// The range of the radiosities of every node over its centre and vertices, by light that travels once from the radiosities as they
    /// are found: an estimate of how wrong they are, narrower than bounds, and none (Lischinski 1994, section 5.2.1).
    pub fn estimate_ranges(&self) -> RadiosityBounds {
        let Solution { scene, hierarchy, links, radiosity, .. } = &self.solution;
        self.pool.install(|| bounds::estimate_ranges(scene, hierarchy, links, radiosity.values()))
    }

    /// How much a unit of exitance anywhere adds to what `interest` asks for, by the links of the solution: `<R, B> = <Z, E>`, see
    /// [`Importance`]. Where the solver scales reflected light, because form factors do not add up to what they must, emitted light is
    /// left alone, and the product lacks what that brings.
    ///
    /// # Errors
    /// [`PipelineError::Interest`] if the scene has nothing of that.
    pub fn importance(&self, interest: &Interest) -> Result<Importance, PipelineError> {
        let initial = InitialImportance::of(interest, &self.solution.scene, &*self.visibility)?;
        Ok(self.pool.install(|| self.solution.importance(&initial)))
    }

    /// Bounds the importance of every node for what `interest` asks for, over the links of the solution; with what is said at
    /// [`Evaluator::bound`]. R is what [`Evaluator::importance`] begins with, spread evenly over each leaf.
    ///
    /// # Errors
    /// [`PipelineError::Interest`] if the scene has nothing of that.
    pub fn bound_importance(&self, interest: &Interest, rule: FormFactorRule) -> Result<ImportanceBounds, PipelineError> {
        let Solution { scene, hierarchy, exposure, .. } = &self.solution;
        let initial = InitialImportance::of(interest, scene, &*self.visibility)?.of_leaves(hierarchy, exposure, scene.channels());
        Ok(self.pool.install(|| bounds::bound_importance(&self.bounds_input(rule, &|| false), &initial)))
    }

    /// Lower and upper radiosities at points, in their order, if it was solved with [`Bounds::Guaranteed`].
    pub fn bounds_at(&self, points: &[SurfacePoint]) -> Option<PointBounds> {
        let Solution { scene, hierarchy, bounds, .. } = &self.solution;
        self.pool.install(|| bounds.as_ref().map(|bounds| bounds.at(scene, hierarchy, points)))
    }

    /// Name and version of the visibility backend.
    pub fn backend(&self) -> String {
        self.visibility.description()
    }

    /// A camera that shows the scene, see [`Camera::default_view`].
    pub fn default_camera(&self, width: u32, height: u32) -> Camera {
        Camera::default_view(self.solution.scene(), self.visibility.as_ref(), width, height)
    }

    /// Radiosities at points, in their order, kept within the bounds where there are any. Where points crowd, as in a bake, they may
    /// share their indirect light, so that a value depends on which others are asked, by less than its noise in the mean square.
    /// Cancelled by the observer, it returns `None`.
    pub fn values_at(&self, points: &[SurfacePoint], observer: &dyn Observer) -> Option<Values> {
        Some(self.bounded_values_at(points, observer)?.0)
    }

    /// The same, with [`Evaluator::bounds_at`] the points.
    pub fn bounded_values_at(&self, points: &[SurfacePoint], observer: &dyn Observer) -> Option<(Values, Option<PointBounds>)> {
        self.gathered_values_at(points, observer, |_| {})
    }

    /// The same, gathered as `prepare` says.
    fn gathered_values_at(
        &self,
        points: &[SurfacePoint],
        observer: &dyn Observer,
        prepare: impl FnOnce(&mut Gather<'_>) + Send,
    ) -> Option<(Values, Option<PointBounds>)> {
        let rays = self.rays();
        let values = self.pool.install(|| {
            let paths = self.solution.light_paths(&rays, &|| observer.cancelled());
            let mut gather = self.solution.gather_at_points(&rays, paths.as_ref());
            prepare(&mut gather);
            values::values_at(&gather, self.solution.error_bars, points, observer)
        });
        let (mut values, bounds) = (values?, self.bounds_at(points));
        if let Some(bounds) = &bounds {
            bounds.confine(&mut values.radiosity);
        }
        Some((values, bounds))
    }

    /// Radiosities at points by methods A to D of Lischinski 1994 over the links, by point and channel, in W/m^2; NaN where a point lies on no surface.
    pub fn shade(&self, points: &[SurfacePoint], method: ShadingMethod) -> Vec<f32> {
        let rays = self.rays();
        self.pool.install(|| self.solution.shade(&rays, points, method))
    }

    /// A picture of linear radiance. Cancelled by the observer, it returns `None`.
    ///
    /// # Errors
    /// [`PipelineError::Camera`] if the camera sees nothing, see [`Camera::validate`].
    pub fn render(&self, camera: &Camera, observer: &dyn Observer) -> Result<Option<Image>, PipelineError> {
        Ok(self.render_shown(Shown::Radiance, camera, None, observer)?.map(|(image, _)| image))
    }

    /// A picture of the width of the bounds, `(upper - lower) / pi`, black where a back or nothing is met. `None` if there are no
    /// bounds, or if the observer cancels.
    ///
    /// # Errors
    /// As [`Evaluator::render`].
    pub fn render_width(&self, camera: &Camera, observer: &dyn Observer) -> Result<Option<Image>, PipelineError> {
        camera.validate()?;
        let Some(bounds) = &self.solution.bounds else { return Ok(None) };
        let Solution { scene, hierarchy, .. } = &self.solution;
        let rays = self.rays();
        Ok(self.pool.install(|| picture::render_width(bounds, scene, hierarchy, &rays, camera, observer))?)
    }
}
