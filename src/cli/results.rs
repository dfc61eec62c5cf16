//! What is made from a solution: values at points, exports.

use std::time::Instant;

use patchlight::bounds::PointBounds;
use patchlight::mesh::LitMesh;
use patchlight::output::{
    Destination, ExportFormat, Points, Provenance, export_elements, export_mesh, write_bounded_values, write_fluxes,
    write_quadratic_mesh_ply, write_solution, write_values,
};
use patchlight::pipeline::Evaluator;
use patchlight::solve::Solution;
use patchlight::values::Values;

use super::argument_groups::Whence;
use super::exit::{Exit, Failure};
use super::files::{self, Sink};
use super::interrupt;
use super::progress::{Voice, Watcher};
use super::request::{ExportRequest, Exported, SampleRequest, Sampled};
use super::sensors;

/// `patchlight sample`.
pub fn sample(request: SampleRequest) -> Result<Exit, Failure> {
    let start = Instant::now();
    let (path, from) = match &request.what {
        Sampled::Points(path, from) => (path, from),
        Sampled::Sensors(sensors) => {
            let evaluator = Evaluator::new(files::read_solution(&request.solution)?, &request.run)?;
            return sensors::measure(&evaluator, (sensors, start), &request.output, request.voice);
        }
    };
    let points = files::read_points(path)?;
    let evaluator = Evaluator::new(files::read_solution(&request.solution)?, &request.run)?;
    interrupt::listen(interrupt::OF_RUN);
    request.voice.figure("backend", format_args!("{}", evaluator.backend()));
    let values = match from {
        Whence::Gather => values_at(&evaluator, &points, request.voice),
        Whence::Mesh => Some(values_of_mesh(&evaluator, &points)?),
    };
    let Some(values) = values else { return Ok(Exit::Cancelled) };
    write_values_to(&request.output, &points, &values, request.voice)?;
    Ok(Exit::Done)
}

/// Values at points, with their bounds where there are any.
pub type BoundedValues = (Values, Option<PointBounds>);

/// Values at points, with their bounds; `None` if interrupted. After an interrupt that ended a solve they are coarser where good ones would take long.
pub fn values_at(evaluator: &Evaluator, points: &Points, voice: Voice) -> Option<BoundedValues> {
    let (points, watcher) = (points.surface_points(), Watcher::new(voice));
    if interrupt::count() > 0 {
        evaluator.hurried_values_at(&points, TIME_OF_HURRIED_S, &watcher)
    } else {
        evaluator.bounded_values_at(&points, &watcher)
    }
}

/// How long hurried values take, about: whoever interrupts is answered within half a second, in which the solve must end as well.
const TIME_OF_HURRIED_S: f64 = 0.2;

/// Values at points by the lit mesh, with their bounds.
pub fn values_of_mesh(evaluator: &Evaluator, points: &Points) -> Result<BoundedValues, Failure> {
    let points = points.surface_points();
    let values = evaluator.mesh_values_at(&points).ok_or_else(|| no_mesh("--from mesh"))?;
    Ok((values, evaluator.bounds_at(&points)))
}

/// There is no lit mesh for what a flag asks for.
pub fn no_mesh(flag: &str) -> Failure {
    Failure::usage(format_args!("{flag}: this solution has no lit mesh; solve the scene with --lit-mesh"))
}

/// Writes values, with their bounds where there are any, and tells how many points lie on no surface.
pub fn write_values_to(sink: &Sink, points: &Points, (values, bounds): &BoundedValues, voice: Voice) -> Result<(), Failure> {
    sink.write(|mut writer| match &bounds {
        Some(bounds) => write_bounded_values(&mut writer, points, values, bounds),
        None => write_values(&mut writer, points, values),
    })?;
    if values.missed > 0 {
        voice.warn(format_args!("{} of {} points lie on no surface; their values are empty", values.missed, points.len()));
    }
    if let Some(error) = values.error {
        let (energy, local) = (100.0 * error.energy, 100.0 * error.local);
        voice.figure("values", format_args!("{energy:.2}% off by energy, {local:.2}% locally, over these points: an estimate"));
    }
    voice.figure("wrote", format_args!("{} ({} points)", sink.name(), points.len()));
    Ok(())
}

/// Writes the lit mesh.
pub fn write_mesh_to(
    (destination, format): &(Destination, ExportFormat),
    evaluator: &Evaluator,
    mesh: &LitMesh,
    voice: Voice,
) -> Result<(), Failure> {
    let solution = evaluator.solution();
    let provenance = Provenance::new(solution.options());
    destination.write(|file| export_mesh(file, *format, solution, mesh, &provenance))?;
    voice.figure("wrote", format_args!("{} ({} elements of the lit mesh)", destination.path().display(), mesh.elements()));
    Ok(())
}

/// Writes a solution.
pub fn write_solution_to(destination: &Destination, evaluator: &Evaluator, voice: Voice) -> Result<(), Failure> {
    let solution = evaluator.solution();
    destination.write(|file| write_solution(file, solution, &Provenance::new(solution.options())))?;
    voice.figure("wrote", format_args!("{}", destination.path().display()));
    Ok(())
}

/// `patchlight export`.
pub fn export(request: ExportRequest) -> Result<Exit, Failure> {
    let solution = files::read_solution(&request.solution)?;
    if let Some((destination, format)) = &request.elements {
        export_as(destination, (request.what, *format), &solution)?;
    }
    if let Some(sink) = &request.flux {
        sink.write(|mut writer| write_fluxes(&mut writer, &solution))?;
    }
    Ok(Exit::Done)
}

/// Writes the lit mesh, or the elements of the solver.
fn export_as(destination: &Destination, (what, format): (Exported, ExportFormat), solution: &Solution) -> Result<(), Failure> {
    let (scene, provenance) = (solution.scene(), Provenance::new(solution.options()));
    match (what, solution.mesh()) {
        (Exported::Quadratic, None) => return Err(no_mesh("--quadratic")),
        (Exported::Quadratic, Some(mesh)) => {
            destination.write(|file| write_quadratic_mesh_ply(file, scene, mesh, &provenance))?;
        }
        (Exported::Best, Some(mesh)) => destination.write(|file| export_mesh(file, format, solution, mesh, &provenance))?,
        _ => destination.write(|file| export_elements(file, format, solution, &provenance))?,
    }
    Ok(())
}
