//! What is made from a solution: values at points, pictures, exports.

use std::time::Instant;

use patchlight::bounds::PointBounds;
use patchlight::mesh::LitMesh;
use patchlight::output::{
    Destination, Display, ExportFormat, ImageFormat, Look, Page, Points, Provenance, Quantity, RunReport, export_elements,
    export_mesh, write_bounded_values, write_display, write_fluxes, write_hdr, write_page, write_quadratic_mesh_ply,
    write_solution, write_values,
};
use patchlight::picture::{Image, Marks};
use patchlight::pipeline::Evaluator;
use patchlight::solve::Solution;
use patchlight::values::Values;

use super::argument_groups::Whence;
use super::exit::{Exit, Failure};
use super::files::{self, Sink};
use super::interrupt;
use super::progress::{Voice, Watcher};
use super::request::{ExportRequest, Exported, PictureRequest, RenderRequest, ReportRequest, SampleRequest, Sampled, Show};
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

/// Values at points, with their bounds; `None` if interrupted.
pub fn values_at(evaluator: &Evaluator, points: &Points, voice: Voice) -> Option<BoundedValues> {
    evaluator.bounded_values_at(&points.surface_points(), &Watcher::new(voice))
}

/// Values at points by the lit mesh, with their bounds.
fn values_of_mesh(evaluator: &Evaluator, points: &Points) -> Result<BoundedValues, Failure> {
    let points = points.surface_points();
    let values = evaluator.mesh_values_at(&points).ok_or_else(|| no_mesh("--from mesh"))?;
    Ok((values, evaluator.bounds_at(&points)))
}

/// There is no mesh to read.
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

/// `patchlight render`.
pub fn render(request: RenderRequest) -> Result<Exit, Failure> {
    let evaluator = Evaluator::new(files::read_solution(&request.solution)?, &request.run)?;
    interrupt::listen(interrupt::OF_RUN);
    request.voice.figure("backend", format_args!("{}", evaluator.backend()));
    let Some(picture) = take_picture(&evaluator, &request.picture, request.voice)? else { return Ok(Exit::Cancelled) };
    write_picture(&picture, &request.picture, &Provenance::new(evaluator.solution().options()), request.voice)?;
    Ok(Exit::Done)
}

/// A picture, and the lines over it.
pub type Picture = (Image, Option<Marks>);

/// Curves that change irradiance by less than this part of the largest exitance are not shown.
const CURVES_FROM: f64 = 1e-3;

/// Takes a picture, of the lit mesh where there is one and nothing else was asked for; `None` if interrupted.
pub fn take_picture(evaluator: &Evaluator, request: &PictureRequest, voice: Voice) -> Result<Option<Picture>, Failure> {
    let mesh = match (request.from, evaluator.mesh()) {
        (Some(Whence::Gather), _) => None,
        (Some(Whence::Mesh), None) => return Err(no_mesh("--from mesh")),
        (_, mesh) => mesh,
    };
    let (width, height) = request.size;
    let camera = request.camera.apply_to(evaluator.default_camera(width, height)).map_err(Failure::usage)?;
    voice.figure("camera", format_args!("{camera}, {width}x{height}"));
    let watcher = Watcher::new(voice);
    let image = match request.quantity {
        Quantity::Width if evaluator.bounds().is_none() => {
            return Err(Failure::usage("--quantity width: this solution has no bounds; solve the scene with --bounds guaranteed"));
        }
        Quantity::Width => evaluator.render_width(&camera, &watcher)?,
        Quantity::Irradiance => evaluator.render_irradiance(mesh, &camera, &watcher)?,
        Quantity::Illuminance => match evaluator.render_irradiance(mesh, &camera, &watcher)?.map(|image| image.to_luminance()) {
            Some(Err(channels)) => {
                return Err(Failure::usage(format_args!(
                    "--quantity illuminance: not known for {channels} channels, only for one or three"
                )));
            }
            image => image.and_then(Result::ok),
        },
        Quantity::Radiance | Quantity::Radiosity => {
            let image = match mesh {
                Some(mesh) => evaluator.render_mesh(mesh, &camera, &watcher)?,
                None => evaluator.render(&camera, &watcher)?,
            };
            if image.as_ref().is_some_and(|image| image.radiance.iter().all(|&radiance| radiance == 0.0)) {
                voice.warn(format_args!(
                    "the picture is black: this camera sees no lit front of a face; from outside of a closed room there are only \
                     backs. Leave --camera out to be shown the scene, or solve it with --sides both"
                ));
            }
            image
        }
    };
    let marks = match (request.show, evaluator.mesh()) {
        (None, _) => return Ok(image.map(|image| (image, None))),
        (Some(Show::Curves), _) => evaluator.mark_curves(CURVES_FROM, &camera, &watcher)?,
        (Some(Show::Mesh), Some(mesh)) => evaluator.mark_mesh(mesh, &camera, &watcher)?,
        (Some(Show::Mesh), None) => return Err(no_mesh("--show mesh")),
    };
    Ok(image.zip(marks).map(|(image, marks)| (image, Some(marks))))
}

/// Writes a picture to all files that are asked for.
pub fn write_picture(
    (image, marks): &Picture,
    request: &PictureRequest,
    provenance: &Provenance,
    voice: Voice,
) -> Result<(), Failure> {
    let (look, unit) = (request.look, request.quantity.unit());
    for (destination, format) in &request.files {
        let path = destination.path().display();
        match format {
            ImageFormat::Exr => {
                #[cfg(not(feature = "openexr"))]
                use patchlight::output::write_exr;
                #[cfg(feature = "openexr")]
                use patchlight::output::write_openexr as write_exr;
                destination.write(|file| write_exr(file, image, request.quantity, provenance))?;
                voice.figure("wrote", format_args!("{path} ({} in {})", request.quantity.name(), unit));
            }
            ImageFormat::Hdr => {
                destination.write(|file| write_hdr(file, image, request.quantity, provenance))?;
                voice.figure("wrote", format_args!("{path} ({} in {})", request.quantity.name(), unit));
            }
            ImageFormat::Png => {
                let quantity = if let Look::Scale(_) = look { request.quantity } else { Quantity::Radiance };
                let display = Display { image, quantity, look, marks: marks.as_ref() };
                let mut exposure = None;
                destination.write(|file| {
                    exposure = write_display(file, &display, provenance)?;
                    Ok(())
                })?;
                match (look, exposure) {
                    (Look::Scale(scale), _) => {
                        let (name, low, high) = (quantity.name(), scale.low(), scale.high());
                        voice.figure("wrote", format_args!("{path} ({name} from {low} to {high} {unit})"));
                    }
                    (_, ev) => voice.figure("wrote", format_args!("{path} (exposure EV {:.2})", ev.unwrap_or(0.0))),
                }
            }
        }
    }
    Ok(())
}

/// `patchlight report`.
pub fn report(request: ReportRequest) -> Result<Exit, Failure> {
    let evaluator = Evaluator::new(files::read_solution(&request.solution)?, &request.run)?;
    let name = request.solution.file_name().unwrap_or_default().to_string_lossy();
    write_page_to(&request.page, &evaluator, (&name, None), request.voice)?;
    Ok(Exit::Done)
}

/// Writes a page under a title, with the report of the run if there is one.
pub fn write_page_to(
    destination: &Destination,
    evaluator: &Evaluator,
    (title, report): (&str, Option<&RunReport>),
    voice: Voice,
) -> Result<(), Failure> {
    let (solution, camera) = (evaluator.solution(), evaluator.default_camera(PAGE_VIEW[0], PAGE_VIEW[1]));
    let page = Page { title, solution, camera: &camera, report };
    destination.write(|mut file| write_page(&mut file, &page, &Provenance::new(solution.options())))?;
    voice.figure("wrote", format_args!("{}", destination.path().display()));
    Ok(())
}

/// The first view of a page shows the scene in a picture of these sides.
const PAGE_VIEW: [u32; 2] = [960, 720];

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
