//! What a run tells about itself, as JSON.
//!
//! The schema has a number, [`REPORT_SCHEMA`]: fields may be added under the same number, none is renamed or removed. Times are
//! wall-clock seconds, except `visibility`, its part `first_hits`, and `form_factor`, which are added over the threads and are
//! parts of the other stages. A number that is not known or not finite is `null`.

use std::io::{self, Write};
use std::path::PathBuf;

use serde::Serialize;

use crate::bounds::BoundsReport;
use crate::scene::Scene;
use crate::solve::{
    Counts, Energy, EnergyBalance, ErrorFigure, ErrorReport, IterationReport, Judgement, LightGroupsReport, LinkErrorReport,
    LitMeshReport, Norm, SkippedWork, SolveOptions, SolveReport, StageTimes, StoppedBy, TransportReport,
};
use crate::values::ValuesError;

/// The version of the schema.
pub const REPORT_SCHEMA: u32 = 2;

/// A report as it is written.
#[derive(Clone, Debug, Serialize)]
pub struct RunReport {
    /// [`REPORT_SCHEMA`].
    pub schema: u32,
    /// Name and version of the software.
    pub software: String,
    /// What was solved.
    pub scene: SceneReport,
    /// What was asked for, as far as it decides the answer.
    pub options: SolveOptions,
    /// Worker threads that were used, of each process.
    pub threads: usize,
    /// Processes that worked together.
    pub processes: usize,
    /// Bytes that the others gave the first one.
    pub given_bytes: u64,
    /// Name and version of the backend that answered.
    pub backend: String,
    /// Seconds by stage.
    pub time_s: Timing,
    /// CPU seconds.
    pub cpu_s: CpuReport,
    /// How much of everything there is.
    pub counts: Counts,
    /// Bytes.
    pub memory: MemoryReport,
    /// The claimed error.
    pub error: ErrorFigures,
    /// The error each time that it was estimated, first to last, in the norm of `error`; `rays_per_point` is `null` of the lit mesh.
    pub history: Vec<Judgement>,
    /// The lit mesh, where that was asked for and there is one.
    pub lit_mesh: Option<LitMeshReport>,
    /// What is known of light groups, where the scene has any.
    pub light_groups: Option<LightGroupsReport>,
    /// What is stored to solve again for other materials, where that was asked for.
    pub transport: Option<TransportReport>,
    /// What is proved about the answer, where that was asked for.
    pub bounds: Option<BoundsReport>,
    /// How wrong radiosities may be by the links, for error-driven refinement.
    pub link_error: Option<LinkErrorReport>,
    /// Where the power goes, in W, all channels added.
    pub energy: Energy,
    /// What there was after each iteration, for strategies that have a fixed number of them.
    pub bounces: Vec<IterationReport>,
    /// What pairs without a link hold back, for strategies that leave some.
    pub energy_balance: Option<EnergyBalance>,
    /// What was not done.
    pub skipped: Vec<SkippedWork>,
    /// Whether the requested error is reached; by the lit mesh, where one is wanted.
    pub converged: bool,
    /// Why refinement ended; of the lit mesh, where that did not reach it.
    pub stopped_by: StoppedBy,
    /// What was repaired or is suspicious in the scene.
    pub warnings: Vec<String>,
    /// The face that each of these is about, by its number in the input from 1; `null` where it is about none, or about one that was dropped.
    pub warned_faces: Vec<Option<u32>>,
}

/// What was solved.
#[derive(Clone, Debug, Default, Serialize)]
pub struct SceneReport {
    /// The file; what of its name is not UTF-8 is told as such.
    #[serde(serialize_with = "lossy")]
    pub file: PathBuf,
    /// Channels.
    pub channels: usize,
    /// Materials.
    pub materials: usize,
    /// Surfaces, each with one side.
    pub surfaces: usize,
    /// Area of all surfaces in m^2.
    pub area_m2: f64,
    /// Lower corner of the bounds in metres.
    pub min: [f64; 3],
    /// Upper corner of the bounds in metres.
    pub max: [f64; 3],
}

impl SceneReport {
    /// Of `scene`, which was read from `file`.
    pub fn of(scene: &Scene, file: PathBuf) -> Self {
        let bounds = scene.bounds();
        Self {
            file,
            channels: scene.channels(),
            materials: scene.materials().len(),
            surfaces: scene.surfaces().len(),
            area_m2: scene.surfaces().iter().map(|surface| surface.polygon.area()).sum(),
            min: bounds.min(),
            max: bounds.max(),
        }
    }
}

/// Seconds by stage.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct Timing {
    /// Reading the scene.
    pub load: f64,
    /// The stages of the solve.
    #[serde(flatten)]
    pub solve: StageTimes,
    /// Values at points and pictures.
    pub sample: f64,
    /// Writing files, without this report.
    pub output: f64,
    /// From the start of the program to this report.
    pub total: f64,
}

/// CPU seconds of the process, all threads added.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct CpuReport {
    /// From the start of the program to this report.
    pub total: Option<f64>,
    /// The solve alone.
    pub solve: Option<f64>,
    /// Values at points and pictures alone.
    pub sample: Option<f64>,
}

/// Bytes.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct MemoryReport {
    /// The solution: hierarchy, links, radiosities, the lit mesh.
    pub solution_bytes: u64,
    /// The most that the solve takes at one time by its own count, which is what a budget limits.
    pub accounted_bytes: u64,
    /// The most that the process held in memory at one time.
    pub peak_resident_bytes: Option<u64>,
}

/// The claimed error in the norm of [`SolveOptions::error`].
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct ErrorFigures {
    /// What was asked for.
    pub requested: f64,
    /// The claim for values at points: an upper confidence limit of the measured error.
    pub estimate: f64,
    /// The probability with which the claim holds.
    pub confidence: f64,
    /// The measured error itself.
    pub measured: f64,
    /// The norm that both are in.
    pub norm: Norm,
    /// The same in the norm by energy.
    pub energy: ErrorFigure,
    /// The same in the local norm.
    pub local: ErrorFigure,
    /// A proven bound of the error of values at points, where one was asked for.
    pub bound: Option<f64>,
    /// The part of the area of reflecting surfaces, 0 to 1, where light was found.
    pub lit: f64,
    /// Estimate and measured error where light was found, if it comes to more area by paths too rare to tell how much.
    pub where_found: Option<ErrorFigure>,
    /// What pairs without a link hold back at most, as a part of the power that the elements reflect.
    pub skipped: f64,
    /// An estimate of the error over the points that were asked for, if any.
    pub points: Option<ValuesError>,
}

impl RunReport {
    /// The part of the report that the solve itself knows; the caller fills in the rest.
    pub fn of_solve(software: &str, scene: SceneReport, options: &SolveOptions, report: &SolveReport) -> Self {
        let error = &report.error;
        Self {
            schema: REPORT_SCHEMA,
            software: software.to_owned(),
            scene,
            options: options.clone(),
            threads: 0,
            processes: 1,
            given_bytes: 0,
            backend: report.backend.clone(),
            time_s: Timing { solve: report.time_s, ..Timing::default() },
            cpu_s: CpuReport::default(),
            counts: report.counts,
            memory: MemoryReport {
                solution_bytes: report.memory_bytes,
                accounted_bytes: report.accounted_bytes,
                peak_resident_bytes: None,
            },
            error: ErrorFigures {
                requested: error.requested,
                estimate: error.estimate,
                confidence: error.confidence,
                measured: error.measured,
                norm: options.norm,
                energy: error.energy,
                local: error.local,
                lit: error.lit,
                where_found: error.where_found,
                bound: report.bounds.as_ref().map(|bounds| bounds.relative_error),
                skipped: error.skipped,
                points: None,
            },
            history: report.history.clone(),
            lit_mesh: report.lit_mesh,
            light_groups: report.light_groups.clone(),
            transport: report.transport,
            bounds: report.bounds.clone(),
            link_error: report.link_error,
            energy: report.energy,
            bounces: report.bounces.clone(),
            energy_balance: report.energy_balance,
            skipped: report.skipped.clone(),
            converged: report.converged,
            stopped_by: report.stopped_by,
            warnings: Vec::new(),
            warned_faces: Vec::new(),
        }
    }
}

/// Writes the report as indented JSON.
///
/// # Errors
/// What the writer says.
pub fn write_report(writer: &mut impl Write, report: &RunReport) -> io::Result<()> {
    serde_json::to_writer_pretty(&mut *writer, report)?;
    writeln!(writer)
}

/// Writes what is known of light groups as indented JSON.
///
/// # Errors
/// What the writer says.
pub fn write_light_groups(writer: &mut impl Write, known: &LightGroupsReport) -> io::Result<()> {
    serde_json::to_writer_pretty(&mut *writer, known)?;
    writeln!(writer)
}

/// Writes a claimed error as indented JSON.
///
/// # Errors
/// What the writer says.
pub fn write_error(writer: &mut impl Write, error: &ErrorReport) -> io::Result<()> {
    serde_json::to_writer_pretty(&mut *writer, error)?;
    writeln!(writer)
}

fn lossy<S: serde::Serializer>(path: &std::path::Path, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(&path.to_string_lossy())
}
