//! The answer as a function on the surfaces.

use std::time::Instant;

use super::history::{JudgedPart, Judgement};
use super::job::Job;
use super::judge::add_time;
use super::memory::{Holdings, MemoryLedger};
use super::mesh_lines;
use super::options::RunOptions;
use super::report::{ErrorFigure, LitMeshReport, SolveReport, StoppedBy};
use super::shares::Shares;
use super::solution::Solution;
use crate::cells::CellRadiosities;
use crate::direct::{Blockers, DirectLight};
use crate::mesh::{LitMesh, MeshBuilder, MeshLimit, MeshLimits, SeenSurfaces};
use crate::paths::LightPaths;
use crate::progress::{Observer, Progress, Stage, Stop};
use crate::scene::{Emitter, SurfaceId};
use crate::transmittance::Rays;
use crate::values::{FinalGather, IndirectGather, LinkGather, RayBudget};

/// Makes the lit mesh of what was solved, within the limits of a job and for an error of both together; tells of it, and whether that is reached.
pub(super) fn add(job: &Job<'_>, solution: &mut Solution, report: &mut SolveReport) {
    let start = Instant::now();
    solution.options = job.options.clone();
    report.error.requested = job.options.error;
    let requested = Shares::of(job.scene, job.options.error).error_of_mesh(report.error.estimate);

    // The mesh, with the time and memory that are left.
    let besides = solution.kept_bytes(&job.memory, job.kept_channels);
    let bytes = |elements: usize| besides + LitMesh::bytes_to_make(elements, job.kept_channels);
    let allows = |elements: usize| job.memory.allows(bytes(elements)) && job.observer.allows_memory(bytes(elements));
    let limits = MeshLimits::new(&allows, job.deadline());
    let mesh = solution.lit_mesh_within((job.rays, None), requested, &limits, &job.stop(), job.observer);

    // What is told of it.
    report.lit_mesh = mesh.as_ref().map(|mesh| told(mesh, requested, report));
    report.converged = report.lit_mesh.is_some_and(|mesh| mesh.whole.estimate <= job.options.error);
    report.stopped_by = match (report.stopped_by, limits.reached()) {
        _ if job.is_cancelled() => StoppedBy::Cancelled,
        _ if report.converged => StoppedBy::Error,
        (StoppedBy::Error, Some(MeshLimit::Memory)) => StoppedBy::Memory,
        (StoppedBy::Error, Some(MeshLimit::Time)) => StoppedBy::Time,
        (StoppedBy::Error, None) if job.is_over_time() => StoppedBy::Time,
        (StoppedBy::Error, None) => StoppedBy::Exhausted,
        (of_values, _) => of_values,
    };
    report.accounted_bytes = report.accounted_bytes.max(bytes(mesh.as_ref().map_or(0, LitMesh::elements)));
    solution.mesh = mesh;
    report.memory_bytes = solution.memory_bytes();
    report.count_rays(job.rays);
    let judgement = |whole: ErrorFigure| Judgement {
        time_s: job.seconds(),
        of: JudgedPart::LitMesh,
        claimed: whole.estimate,
        measured: whole.measured,
        rays_per_point: None,
        rays: report.counts.rays,
    };
    report.history.extend(report.lit_mesh.map(|mesh| judgement(mesh.whole)));
    add_time(&mut report.time_s.mesh, start);
}

/// What is told of a mesh that was allowed to be `requested` off the values of a report.
fn told(mesh: &LitMesh, requested: f64, of_values: &SolveReport) -> LitMeshReport {
    let (off_values, values) = (ErrorFigure { estimate: mesh.claimed, measured: mesh.measured }, of_values.error);
    let whole =
        ErrorFigure { estimate: off_values.estimate.hypot(values.estimate), measured: off_values.measured.hypot(values.measured) };
    LitMeshReport { elements: mesh.elements() as u64, nodes: mesh.nodes() as u64, requested, off_values, whole }
}

impl Solution {
    /// What there is in memory while a mesh is made, beside it, by the ledger of a solve that keeps so many channels.
    fn kept_bytes(&self, memory: &MemoryLedger, channels: usize) -> u64 {
        let Self { scene, hierarchy, links, cell_radiosities, .. } = self;
        let of_cells =
            |radiosities: &CellRadiosities| radiosities.memory_bytes() + LightPaths::bytes_of(scene, radiosities.cells());
        memory.kept(Holdings { hierarchy, links, channels }) + cell_radiosities.as_ref().map_or(0, of_cells)
    }

    /// Radiosity as a function on all surfaces that reflect, off the values at points by `error` in the norm of the options; `None` if the observer
    /// cancels.
    ///
    /// Elements follow the lines where surfaces touch, the outlines of what stands close over them, and borders of the shadows of lights that are no
    /// surfaces. Other discontinuities are met by refinement.
    pub(crate) fn lit_mesh(&self, rays: &Rays<'_>, error: f64, observer: &dyn Observer) -> Option<LitMesh> {
        self.lit_mesh_within((rays, None), error, &MeshLimits::none(), &|| observer.cancelled(), observer)
    }

    /// The same of what a view sees, for its picture, within the memory of a run and a time: the error is one over the pixels. `None` if the observer cancels,
    /// if the time is over before the mesh is judged, or where there is no room for one; with the limit that was reached, if one was.
    pub(crate) fn lit_mesh_of_view(
        &self,
        (rays, seen): (&Rays<'_>, &SeenSurfaces),
        error: f64,
        (run, deadline): (&RunOptions, Option<Instant>),
        observer: &dyn Observer,
    ) -> (Option<LitMesh>, Option<MeshLimit>) {
        let (memory, channels) = (MemoryLedger::new(&self.scene, run.backend, run.memory_bytes), self.scene.channels_with_groups());
        let besides = self.kept_bytes(&memory, channels) + seen.bytes_at_work();
        let allows = |elements: usize| {
            let bytes = besides + LitMesh::bytes_to_make(elements, channels);
            memory.allows(bytes) && observer.allows_memory(bytes)
        };
        let limits = MeshLimits::new(&allows, deadline);
        let is_late = || deadline.is_some_and(|deadline| Instant::now() >= deadline);
        let stop = || observer.cancelled() || is_late();
        let mesh = self.lit_mesh_within((rays, Some(seen)), error, &limits, &stop, observer);
        let reached = limits.reached().or_else(|| is_late().then_some(MeshLimit::Time));
        (mesh, reached)
    }

    /// Whether the memory of a run has room to look for what so many pixels see.
    pub(crate) fn has_room_for_view(&self, pixels: usize, run: &RunOptions) -> bool {
        /// Rays through most pixels.
        const POINTS_OF_PIXEL: usize = 4;
        let memory = MemoryLedger::new(&self.scene, run.backend, run.memory_bytes);
        memory
            .allows(self.kept_bytes(&memory, self.scene.channels_with_groups()) + SeenSurfaces::bytes_of(POINTS_OF_PIXEL * pixels))
    }

    /// The same within limits: what ends with them is judged as it is. `None` if stopped, or if they allow none.
    fn lit_mesh_within(
        &self,
        (rays, seen): (&Rays<'_>, Option<&SeenSurfaces>),
        error: f64,
        limits: &MeshLimits<'_>,
        stop: Stop<'_>,
        observer: &dyn Observer,
    ) -> Option<LitMesh> {
        let Self { scene, hierarchy, links, exposure, radiosity, .. } = self;
        let tell = |elements: u64| {
            observer.progress(&Progress { stage: Stage::Mesh, round: 0, fraction: None, links: 0, elements, error: None });
        };
        tell(0);
        if stop() {
            return None;
        }

        // Indirect light, as values at points gather it.
        let paths = self.light_paths(rays, stop);
        let whole = LinkGather::new(scene, hierarchy, links, radiosity, exposure, rays);
        let indirect = match (&self.cell_radiosities, &paths) {
            (Some(radiosities), Some(paths)) => {
                IndirectGather::Cells(FinalGather { paths, radiosities, bounces: 0, vertex_rays: self.vertex_rays })
            }
            _ => IndirectGather::Links(LinkGather::of_reflected(whole)),
        };

        // Direct light, but of emitters whose light is left to paths.
        let all = || (0..scene.surfaces().len() as u32).map(SurfaceId);
        let is_direct = |surface: &SurfaceId| match &indirect {
            IndirectGather::Cells(gather) => gather.paths.unsampled_exitance(*surface).is_none(),
            IndirectGather::Links(_) => true,
        };
        let emitting = all().filter(|&surface| scene.material_of(surface).emits());
        let emitters = Emitter::of_surfaces(scene, emitting.filter(is_direct));
        if stop() {
            return None;
        }
        let (blockers, (shape, with_lights)) = rayon::join(|| Blockers::of(scene, rays), || mesh_lines::find(self, error, stop));
        let direct = &DirectLight { scene, rays, blockers, emitters: &emitters };
        let lines = [&shape, with_lights.as_ref().unwrap_or(&shape)];
        let is_wanted = |surface: &SurfaceId| seen.is_none_or(|seen| seen.weight(*surface) > 0.0);
        let reflects = |surface: &SurfaceId| scene.material_of(*surface).reflects();
        let surfaces: Vec<SurfaceId> = all().filter(reflects).filter(is_wanted).collect();
        let (budget, norm) = (RayBudget::of_values(self.point_rays, self.options.seed), self.options.norm.into());
        let (indirect, tell, values_off) = (&indirect, &tell, self.error_bars.map(|bars| bars.of_light));
        let builder = MeshBuilder { scene, indirect, direct, budget, lines, seen, values_off, error, norm, limits, tell, stop };
        builder.build(&surfaces)
    }
}
