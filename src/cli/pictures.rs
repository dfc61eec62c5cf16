//! Pictures: of the lit mesh of a solution, of a mesh that is made for the view, or of values that are gathered for the picture.

use std::borrow::Cow;

use patchlight::mesh::LitMesh;
use patchlight::output::{Display, ImageFormat, Look, Provenance, Quantity, write_display, write_hdr};
use patchlight::picture::{Camera, Image, Marks};
use patchlight::pipeline::Evaluator;

use super::argument_groups::Whence;
use super::exit::{Exit, Failure};
use super::progress::{Voice, Watcher};
use super::request::{PictureRequest, RenderRequest, Show};
use super::results::no_mesh;
use super::{files, interrupt};

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
pub struct Picture {
    image: Image,
    marks: Option<Marks>,
    /// What is claimed of the error of the mesh that it shows.
    claim: Option<String>,
}

/// Curves that change irradiance by less than this part of the largest exitance are not shown.
const CURVES_FROM: f64 = 1e-3;

/// Takes a picture; `None` if interrupted.
pub fn take_picture(evaluator: &Evaluator, request: &PictureRequest, voice: Voice) -> Result<Option<Picture>, Failure> {
    let (width, height) = request.size;
    let camera = request.camera.apply_to(evaluator.default_camera(width, height)).map_err(Failure::usage)?;
    voice.figure("camera", format_args!("{camera}, {width}x{height}"));
    let watcher = Watcher::new(voice);
    let Some(shown) = shown(evaluator, request, &camera, voice)? else { return Ok(None) };
    let mesh = shown.as_ref().map(|(mesh, _)| &**mesh);
    let Some(image) = take_image(evaluator, (mesh, request.quantity), &camera, voice)? else { return Ok(None) };
    let marks = match (request.show, mesh.or(evaluator.mesh())) {
        (None, _) => None,
        (Some(Show::Curves), _) => evaluator.mark_curves(CURVES_FROM, &camera, &watcher)?,
        (Some(Show::Mesh), Some(mesh)) => evaluator.mark_mesh(mesh, &camera, &watcher)?,
        (Some(Show::Mesh), None) => return Err(no_mesh("--show mesh")),
    };
    let is_whole = request.show.is_none() || marks.is_some();
    Ok(is_whole.then(|| Picture { image, marks, claim: shown.map(|(_, claim)| claim) }))
}

/// A mesh to show, and what is claimed of its error.
type Shown<'a> = (Cow<'a, LitMesh>, String);

/// What a picture shows: the lit mesh where there is one, else one that is made of the view where that takes less than to gather values for the picture;
/// or what is asked for. Nothing inside is gathered values, nothing at all an interrupt.
fn shown<'a>(
    evaluator: &'a Evaluator,
    request: &PictureRequest,
    camera: &Camera,
    voice: Voice,
) -> Result<Option<Option<Shown<'a>>>, Failure> {
    let options = evaluator.solution().options();
    let claim = |mesh: &LitMesh, over: &str| {
        let percent = 100.0 * mesh.claimed;
        format!("claimed to be {percent:.2}% off the values at points, in the {} norm over {over}", options.norm)
    };
    match (request.from, request.error, evaluator.mesh()) {
        _ if request.quantity == Quantity::Width => return Ok(Some(None)),
        (Some(Whence::Gather), ..) => return Ok(Some(None)),
        (Some(Whence::Mesh), _, None) => return Err(no_mesh("--from mesh")),
        (_, None, Some(mesh)) => return Ok(Some(Some((Cow::Borrowed(mesh), claim(mesh, "the surfaces"))))),
        (_, None, None) if !request.may_make_mesh => return Ok(Some(None)),
        (_, None, None) if request.show != Some(Show::Mesh) && !evaluator.is_view_mesh_cheaper(camera) => return Ok(Some(None)),
        _ => {}
    }
    let error = request.error.unwrap_or(options.error);
    let Some(mesh) = evaluator.view_mesh(camera, error, &Watcher::new(voice))? else { return Ok(None) };
    let claim = claim(&mesh, "the pixels");
    voice.figure("view", format_args!("{} elements, {claim}", mesh.elements()));
    if mesh.claimed > error {
        voice.warn(format_args!("the picture was asked for to {:.2}%, which was not reached", 100.0 * error));
    }
    Ok(Some(Some((Cow::Owned(mesh), claim))))
}

/// The pixels, of a mesh or gathered; `None` if interrupted.
fn take_image(
    evaluator: &Evaluator,
    (mesh, quantity): (Option<&LitMesh>, Quantity),
    camera: &Camera,
    voice: Voice,
) -> Result<Option<Image>, Failure> {
    let watcher = Watcher::new(voice);
    Ok(match quantity {
        Quantity::Width if evaluator.bounds().is_none() => {
            return Err(Failure::usage("--quantity width: this solution has no bounds; solve the scene with --bounds guaranteed"));
        }
        Quantity::Width => evaluator.render_width(camera, &watcher)?,
        Quantity::Irradiance => evaluator.render_irradiance(mesh, camera, &watcher)?,
        Quantity::Illuminance => match evaluator.render_irradiance(mesh, camera, &watcher)?.map(|image| image.to_luminance()) {
            Some(Err(channels)) => {
                return Err(Failure::usage(format_args!(
                    "--quantity illuminance: not known for {channels} channels, only for one or three"
                )));
            }
            image => image.and_then(Result::ok),
        },
        Quantity::Radiance | Quantity::Radiosity => {
            let image = match mesh {
                Some(mesh) => evaluator.render_mesh(mesh, camera, &watcher)?,
                None => evaluator.render(camera, &watcher)?,
            };
            if image.as_ref().is_some_and(|image| image.radiance.iter().all(|&radiance| radiance == 0.0)) {
                voice.warn(format_args!(
                    "the picture is black: this camera sees no lit front of a face; from outside of a closed room there are only \
                     backs. Leave --camera out to be shown the scene, or solve it with --sides both"
                ));
            }
            image
        }
    })
}

/// Writes a picture to all files that are asked for.
pub fn write_picture(
    Picture { image, marks, claim }: &Picture,
    request: &PictureRequest,
    provenance: &Provenance,
    voice: Voice,
) -> Result<(), Failure> {
    let (look, unit) = (request.look, request.quantity.unit());
    let provenance = &claim.as_ref().map_or_else(|| provenance.clone(), |claim| provenance.with_error(claim.as_str()));
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
