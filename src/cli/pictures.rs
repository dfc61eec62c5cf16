//! Pictures: of the lit mesh of a solution, of a mesh that is made for the view, or of values that are gathered for the picture.

use std::borrow::Cow;
use std::time::Instant;

use patchlight::discontinuities::TOLERANCE_SHOWN;
use patchlight::mesh::LitMesh;
use patchlight::output::{Display, ImageFormat, Look, Provenance, Quantity, write_display, write_hdr};
use patchlight::picture::{Camera, Image, Marks};
use patchlight::pipeline::{Evaluator, ViewMesh};
use patchlight::progress::Observer;
use patchlight::solve::{RunOptions, StoppedBy};

use super::argument_groups::Whence;
use super::exit::{Exit, Failure};
use super::progress::{Timed, Voice, Watcher};
use super::request::{PictureRequest, RenderRequest, Show};
use super::results::no_mesh;
use super::{files, interrupt};

/// What a picture may take.
pub struct Limits {
    /// When it must be done.
    end: Option<Instant>,
    /// What is left of the memory when the picture itself is counted, and what answers visibility.
    run: RunOptions,
}

impl Limits {
    /// What is left of those of a run that began at some time.
    pub fn of(run: RunOptions, start: Instant) -> Self {
        Self { end: run.deadline_from(start), run }
    }

    /// The same with a part of the time that is left.
    fn part(&self, part: f64) -> RunOptions {
        let left = |end: Instant| part * end.saturating_duration_since(Instant::now()).as_secs_f64();
        RunOptions { time_s: self.end.map(left), ..self.run.clone() }
    }
}

/// `patchlight render`.
pub fn render(request: RenderRequest) -> Result<Exit, Failure> {
    let start = Instant::now();
    let evaluator = Evaluator::new(files::read_solution(&request.solution)?, &request.run)?;
    interrupt::listen(interrupt::OF_RUN);
    request.voice.figure("backend", format_args!("{}", evaluator.backend()));
    let of_picture = Image::bytes_of(request.picture.size.into(), evaluator.solution().scene().channels());
    let memory_bytes = request.run.memory_bytes.map(|bytes| bytes.saturating_sub(of_picture));
    let limits = Limits::of(RunOptions { memory_bytes, ..request.run }, start);
    let Some(picture) = take_picture(&evaluator, &request.picture, &limits, request.voice)? else { return Ok(Exit::Cancelled) };
    write_picture(&picture, &request.picture, &Provenance::new(evaluator.solution().options()), request.voice)?;
    Ok(picture.limit.unwrap_or(Exit::Done))
}

/// A picture, and the lines over it.
pub struct Picture {
    image: Image,
    marks: Option<Marks>,
    /// What is claimed of the error of the mesh that it shows, or what is missing of it.
    claim: Option<String>,
    /// The limit that ended it before it was as good as asked for.
    pub limit: Option<Exit>,
}

/// A mesh of the view has this part of the time. The rest is for reading it; or for gathering values, where it could not be judged by then.
const PART_OF_MESH: f64 = 0.75;

/// Takes a picture; `None` if interrupted.
pub fn take_picture(
    evaluator: &Evaluator,
    request: &PictureRequest,
    limits: &Limits,
    voice: Voice,
) -> Result<Option<Picture>, Failure> {
    let (width, height) = request.size;
    let camera = request.camera.apply_to(evaluator.default_camera(width, height)).map_err(Failure::usage)?;
    voice.figure("camera", format_args!("{camera}, {width}x{height}"));
    let Some(shown) = shown(evaluator, request, (&camera, limits), voice)? else { return Ok(None) };
    let Shown { mesh, mut claim, mut limit } = shown;
    let mesh = mesh.as_deref();
    let Some((image, taken)) = take_image(evaluator, (mesh, request.quantity), (&camera, limits), voice)? else { return Ok(None) };
    if taken < 1.0 {
        let percent = (100.0 * taken).floor();
        let missing = format!("the time was over when {percent}% of the pixels were gathered; others show one beside them");
        voice.warn(format_args!("{missing}"));
        (claim, limit) = (Some(missing), Some(Exit::Limit));
    }

    let timed = Timed { watcher: Watcher::new(voice), end: limits.end };
    let marks = match (request.show, mesh.or(evaluator.mesh())) {
        (None, _) => None,
        (Some(Show::Curves), _) => evaluator.mark_curves(TOLERANCE_SHOWN, &camera, &timed)?,
        (Some(Show::Mesh), Some(mesh)) => evaluator.mark_mesh(mesh, &camera, &timed)?,
        (Some(Show::Mesh), None) => return Err(no_mesh("--show mesh")),
    };
    if request.show.is_some() && marks.is_none() {
        if timed.watcher.cancelled() {
            return Ok(None);
        }
        voice.warn(format_args!("the time was over before the lines of --show were drawn"));
        limit = limit.or(Some(Exit::Limit));
    }
    Ok(Some(Picture { image, marks, claim, limit }))
}

/// What a picture shows: a mesh, or values that are gathered for it.
#[derive(Default)]
struct Shown<'a> {
    mesh: Option<Cow<'a, LitMesh>>,
    /// What is claimed of the error of the mesh.
    claim: Option<String>,
    /// The limit that ended the mesh before it was as good as asked for.
    limit: Option<Exit>,
}

/// What a picture shows: the lit mesh where there is one, else one that is made of the view where that takes less than to gather values for the picture;
/// or what is asked for. `None` if interrupted.
fn shown<'a>(
    evaluator: &'a Evaluator,
    request: &PictureRequest,
    (camera, limits): (&Camera, &Limits),
    voice: Voice,
) -> Result<Option<Shown<'a>>, Failure> {
    let options = evaluator.solution().options();
    let claim = |mesh: &LitMesh, over: &str| {
        let percent = 100.0 * mesh.claimed;
        format!("claimed to be {percent:.2}% off the values at points, in the {} norm over {over}", options.norm)
    };
    match (request.from, request.error, evaluator.mesh()) {
        _ if request.quantity == Quantity::Width => return Ok(Some(Shown::default())),
        (Some(Whence::Gather), ..) => return Ok(Some(Shown::default())),
        (Some(Whence::Mesh), _, None) => return Err(no_mesh("--from mesh")),
        (_, None, Some(mesh)) => {
            let claim = claim(mesh, "the surfaces");
            return Ok(Some(Shown { mesh: Some(Cow::Borrowed(mesh)), claim: Some(claim), limit: None }));
        }
        (_, None, None) if request.show != Some(Show::Mesh) && !evaluator.is_view_mesh_cheaper(camera) => {
            return Ok(Some(Shown::default()));
        }
        _ => {}
    }
    let error = request.error.unwrap_or(options.error);
    let ViewMesh { mesh, stopped_by } =
        evaluator.view_mesh_within(camera, error, &limits.part(PART_OF_MESH), &Watcher::new(voice))?;
    let limit = match stopped_by {
        StoppedBy::Cancelled => return Ok(None),
        StoppedBy::Time => Some(Exit::Limit),
        StoppedBy::Memory => Some(Exit::Memory),
        _ => None,
    };
    let Some(mesh) = mesh else {
        let lacks = if stopped_by == StoppedBy::Memory { "room" } else { "time" };
        voice.warn(format_args!("there was not enough {lacks} for a mesh of the view: values are gathered for the picture"));
        // These are no worse, unless an error was asked for: none is claimed of them.
        return Ok(Some(Shown { limit: limit.filter(|_| request.error.is_some()), ..Shown::default() }));
    };
    let claim = claim(&mesh, "the pixels");
    voice.figure("view", format_args!("{} elements, {claim}", mesh.elements()));
    if mesh.claimed > error {
        let why = match stopped_by {
            StoppedBy::Time => ": the time was over",
            StoppedBy::Memory => ": there is not enough memory",
            _ => "",
        };
        voice.warn(format_args!("the picture was asked for to {:.2}%, which was not reached{why}", 100.0 * error));
    }
    Ok(Some(Shown { mesh: Some(Cow::Owned(mesh)), claim: Some(claim), limit }))
}

/// The pixels, of a mesh or gathered, and the part of them that was taken; `None` if interrupted.
fn take_image(
    evaluator: &Evaluator,
    (mesh, quantity): (Option<&LitMesh>, Quantity),
    (camera, limits): (&Camera, &Limits),
    voice: Voice,
) -> Result<Option<(Image, f64)>, Failure> {
    let (watcher, left) = (Watcher::new(voice), limits.part(1.0));
    let irradiance = || match mesh {
        Some(_) => evaluator.render_irradiance(mesh, camera, &watcher).map(whole),
        None => evaluator.render_irradiance_within(camera, &left, &watcher),
    };
    Ok(match quantity {
        Quantity::Width if evaluator.bounds().is_none() => {
            return Err(Failure::usage("--quantity width: this solution has no bounds; solve the scene with --bounds guaranteed"));
        }
        Quantity::Width => whole(evaluator.render_width(camera, &watcher)?),
        Quantity::Irradiance => irradiance()?,
        Quantity::Illuminance => match irradiance()? {
            Some((image, taken)) => {
                let of = |channels| format!("--quantity illuminance: not known for {channels} channels, only for one or three");
                Some((image.to_luminance().map_err(|channels| Failure::usage(of(channels)))?, taken))
            }
            None => None,
        },
        Quantity::Radiance | Quantity::Radiosity => {
            let image = match mesh {
                Some(mesh) => whole(evaluator.render_mesh(mesh, camera, &watcher)?),
                None => evaluator.render_within(camera, &left, &watcher)?,
            };
            if image.as_ref().is_some_and(|(image, _)| image.radiance.iter().all(|&radiance| radiance == 0.0)) {
                voice.warn(format_args!(
                    "the picture is black: this camera sees no lit front of a face; from outside of a closed room there are only \
                     backs. Leave --camera out to be shown the scene, or solve it with --sides both"
                ));
            }
            image
        }
    })
}

/// A picture of which no pixel is missing.
fn whole(image: Option<Image>) -> Option<(Image, f64)> {
    image.map(|image| (image, 1.0))
}

/// Writes a picture to all files that are asked for.
pub fn write_picture(
    Picture { image, marks, claim, .. }: &Picture,
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
