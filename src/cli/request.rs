//! What is asked for, validated: names known, numbers in range, outputs writable.

use std::path::{Path, PathBuf};

use patchlight::output::{Destination, ExportFormat, ImageFormat, LEAST_SIZE_WITH_LEGEND, Look, PngExposure, Quantity, Scale};
use patchlight::picture::{Camera, CameraRequest};
use patchlight::scene::import::ImportOptions;
use patchlight::solve::{Bounds, Interest, RunOptions, SolveOptions};

use super::argument_groups::{PictureArguments, ViewArguments, Whence};
use super::arguments::{ExportArguments, RenderArguments, SampleArguments, SolveArguments};
use super::exit::Failure;
use super::files::{Outputs, Sink};
use super::light_groups::Grouping;
use super::page_extras::PageExtras;
use super::plots::PlotFiles;
use super::progress::Voice;
use super::report::page_file;
use super::sensors::SensorRequest;
use super::settings::{Settings, limit, run_options};

/// Width and height of a picture that nobody gave a size.
const DEFAULT_SIZE: (u32, u32) = (960, 720);

/// A picture to take.
#[derive(Debug)]
pub struct PictureRequest {
    pub files: Vec<(Destination, ImageFormat)>,
    pub camera: CameraRequest,
    pub size: (u32, u32),
    pub look: Look,
    pub quantity: Quantity,
    /// What is shown, if that was said.
    pub from: Option<Whence>,
    pub show: Option<Show>,
    /// The error of a mesh that is made for the picture, if that was said.
    pub error: Option<f64>,
}

/// Lines over a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Show {
    Mesh,
    Curves,
}

impl PictureRequest {
    /// Validates what was typed of a picture in these files.
    pub fn new(paths: &[PathBuf], typed: &PictureArguments, outputs: &mut Outputs) -> Result<Self, Failure> {
        let (camera, size) = view(&typed.view)?;
        let quantity = typed.quantity.as_deref().map_or(Ok(Quantity::Radiance), parse_quantity)?;
        let formats: Vec<ImageFormat> =
            paths.iter().map(|path| ImageFormat::of_path(path)).collect::<Result<_, _>>().map_err(Failure::usage)?;
        if quantity == Quantity::Width && typed.from.is_some() {
            return Err(Failure::usage("--quantity width shows bounds: leave --from out"));
        }
        let look = look(typed, quantity, &formats, size)?;
        let show = typed.show.as_deref().map(parse_show).transpose()?;
        let destinations: Vec<Destination> = paths.iter().map(|path| outputs.file(path)).collect::<Result<_, _>>()?;
        let files = destinations.into_iter().zip(formats).collect();
        Ok(Self { files, camera, size, look, quantity, from: typed.from, show, error: None })
    }
}

/// `patchlight solve`.
#[derive(Debug)]
pub struct SolveRequest {
    pub scene: PathBuf,
    pub import: ImportOptions,
    pub options: SolveOptions,
    pub light_groups: Option<Grouping>,
    pub run: RunOptions,
    pub voice: Voice,
    pub solution: Option<Destination>,
    pub picture: Option<PictureRequest>,
    pub mesh: Option<(Destination, ExportFormat)>,
    pub points: Option<(PathBuf, Sink)>,
    pub report: Option<Sink>,
    pub html: Option<Destination>,
    /// What the page shows beside the light.
    pub extras: PageExtras,
    pub plots: Option<PlotFiles>,
    /// All of these, to be held against what the scene turns out to read.
    pub outputs: Outputs,
}

impl SolveRequest {
    /// Validates what was typed.
    pub fn new(typed: SolveArguments) -> Result<Self, Failure> {
        let mut settings = Settings::new(&typed.settings, &typed.run, typed.picture.view.camera.as_deref())?;
        if typed.mesh.is_some() {
            settings.want_mesh(&typed.settings)?;
        }

        // Outputs, before anything is computed.
        let points = typed.points.as_deref();
        let light_groups = typed.light_groups.as_deref().map(Grouping::new).transpose()?;
        let groups = light_groups.as_ref().and_then(Grouping::file);
        let read = [&[typed.scene.as_path()], points.as_slice(), groups.as_slice(), typed.lights.as_deref().as_slice()].concat();
        let mut outputs = Outputs::beside(&read);
        let solution = typed.output.as_deref().map(|path| outputs.file(path)).transpose()?;
        let picture = Self::picture(&typed, &settings.options, &mut outputs)?;
        let mesh = Self::mesh(&typed, &mut outputs)?;
        let values = typed.values.as_deref().map(|path| outputs.sink(path)).transpose()?;
        let report = typed.report.as_deref().map(|path| outputs.sink(path)).transpose()?;
        let html = typed.html.as_deref().map(|path| page_file(path, "--html", &mut outputs)).transpose()?;
        let plots = typed.plots.as_deref().map(|folder| PlotFiles::new(folder, &mut outputs)).transpose()?;
        let request = Self {
            scene: typed.scene,
            import: typed.trust.import(settings.sides, typed.lights),
            options: settings.options,
            light_groups,
            run: settings.run,
            voice: Voice::new(typed.run.progress),
            solution,
            picture,
            mesh,
            points: typed.points.zip(values),
            report,
            html,
            extras: PageExtras::new(&typed.page)?,
            plots,
            outputs,
        };
        if !request.extras.is_empty() && request.html.is_none() && !request.asks_for_nothing() {
            return Err(Failure::usage("--plane and --curves show something in the page: name one by --html FILE.html"));
        }
        Ok(request)
    }

    /// Whether no output is asked for.
    fn asks_for_nothing(&self) -> bool {
        let Self { solution, picture, mesh, points, html, report, plots, .. } = self;
        let of_light = [solution.is_none(), picture.is_none(), mesh.is_none(), points.is_none(), html.is_none()];
        of_light == [true; 5] && report.is_none() && plots.is_none()
    }

    /// Who asks for nothing gets something to look at: the page `out/NAME.html`.
    pub fn or_leave_a_page(mut self) -> Result<Self, Failure> {
        if !self.asks_for_nothing() {
            return Ok(self);
        }
        let folder = Path::new("out");
        std::fs::create_dir_all(folder).map_err(|error| {
            Failure::usage(format_args!("cannot make the folder out ({error}); name an output, as --html FILE.html"))
        })?;
        let page = folder.join(self.scene.file_name().unwrap_or_default()).with_extension("html");
        self.html = Some(self.outputs.file(&page)?);
        Ok(self)
    }

    /// The file for the lit mesh, if one is asked for.
    fn mesh(typed: &SolveArguments, outputs: &mut Outputs) -> Result<Option<(Destination, ExportFormat)>, Failure> {
        let Some(path) = typed.mesh.as_deref() else { return Ok(None) };
        let format = ExportFormat::of_path(path).map_err(Failure::usage)?;
        outputs.file(path).map(|destination| Some((destination, format)))
    }

    /// The picture, if one is asked for. Its camera may be typed without one, where it says what the answer is wanted for.
    fn picture(typed: &SolveArguments, options: &SolveOptions, outputs: &mut Outputs) -> Result<Option<PictureRequest>, Failure> {
        let flags = &typed.picture;
        if typed.image.is_empty() {
            let camera = flags.view.camera.as_ref().filter(|_| !matches!(options.importance, Interest::View(_)));
            let of_pngs = [flags.exposure.as_ref(), flags.scale.as_ref(), flags.show.as_ref()];
            let typed = [camera, flags.view.size.as_ref(), flags.quantity.as_ref()];
            if flags.from.is_some() || typed.iter().chain(&of_pngs).any(|flag| flag.is_some()) {
                return Err(Failure::usage(
                    "--camera, --size, --exposure, --quantity, --scale, --from and --show need --image FILE",
                ));
            }
            return Ok(None);
        }
        let picture = PictureRequest::new(&typed.image, flags, outputs)?;
        if picture.quantity == Quantity::Width && options.bounds != Bounds::Guaranteed {
            return Err(Failure::usage("--quantity width needs --bounds guaranteed"));
        }
        if picture.show == Some(Show::Mesh) && picture.from == Some(Whence::Gather) && !options.lit_mesh {
            return Err(Failure::usage("--show mesh needs --lit-mesh where values are gathered"));
        }
        if picture.from == Some(Whence::Mesh) && !options.lit_mesh {
            return Err(Failure::usage("--from mesh needs --lit-mesh"));
        }
        Ok(Some(picture))
    }
}

/// A view as typed.
pub fn view(typed: &ViewArguments) -> Result<(CameraRequest, (u32, u32)), Failure> {
    let camera = typed.camera.as_deref().unwrap_or("").parse().map_err(Failure::usage)?;
    let size = typed.size.as_deref().map_or(Ok(DEFAULT_SIZE), parse_size)?;
    // One that is given in full can be judged before the scene is known.
    if let CameraRequest { eye: Some(eye), target: Some(target), up, field_of_view_degrees } = camera {
        let up = up.unwrap_or(if eye[0] == target[0] && eye[2] == target[2] { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] });
        let field_of_view_degrees = field_of_view_degrees.unwrap_or(45.0);
        let camera = Camera { eye, target, up, field_of_view_degrees, width: size.0, height: size.1 };
        camera.validate().map_err(Failure::usage)?;
    }
    Ok((camera, size))
}

fn parse_size(text: &str) -> Result<(u32, u32), Failure> {
    let bad = || Failure::usage(format_args!("size is '{text}', write width and height in pixels, as in 960x720"));
    let (width, height) = text.split_once(['x', 'X']).ok_or_else(bad)?;
    let (width, height) = (width.parse().map_err(|_| bad())?, height.parse().map_err(|_| bad())?);
    let camera = Camera { eye: [0.0; 3], target: [0.0, 0.0, 1.0], up: [0.0, 1.0, 0.0], field_of_view_degrees: 45.0, width, height };
    camera.validate().map_err(Failure::usage)?;
    Ok((width, height))
}

/// How a PNG shows its numbers; flags that no file has room for are refused.
fn look(typed: &PictureArguments, quantity: Quantity, formats: &[ImageFormat], size: (u32, u32)) -> Result<Look, Failure> {
    let has_png = formats.contains(&ImageFormat::Png);
    let keeps_numbers = formats.iter().any(|format| *format != ImageFormat::Png);
    for (flag, is_typed) in [("--exposure", &typed.exposure), ("--scale", &typed.scale), ("--show", &typed.show)] {
        if is_typed.is_some() && !has_png {
            return Err(Failure::usage(format_args!("{flag} is for .png; .exr and .hdr keep the numbers as they are")));
        }
    }
    if quantity == Quantity::Width && has_png {
        return Err(Failure::usage("--quantity width is for .exr alone; take the .png in a run of its own"));
    }
    if let Some(scale) = &typed.scale {
        let scale: Scale = scale.parse().map_err(Failure::usage)?;
        let [width, height] = LEAST_SIZE_WITH_LEGEND;
        if typed.exposure.is_some() {
            return Err(Failure::usage("--scale gives numbers their colours and --exposure light: take one of them away"));
        }
        if size.0 < width || size.1 < height {
            return Err(Failure::usage(format_args!(
                "--scale draws a legend, for which the picture must be {width}x{height} or larger"
            )));
        }
        return Ok(Look::Scale(scale));
    }
    if matches!(quantity, Quantity::Irradiance | Quantity::Illuminance) && has_png {
        let name = quantity.name();
        return Err(Failure::usage(format_args!(
            "--quantity {name} is shown by .png in false colours: say from where to where, as in --scale 0..500"
        )));
    }
    if typed.quantity.is_some() && !keeps_numbers {
        return Err(Failure::usage(
            "--quantity is for .exr and .hdr, or .png with --scale; without, a .png is a picture to look at",
        ));
    }
    Ok(Look::Light(typed.exposure.as_deref().map_or(Ok(PngExposure::Auto), parse_exposure)?))
}

fn parse_error(text: &str) -> Result<f64, Failure> {
    let mut options = SolveOptions::default();
    options.set("error", text).map_err(Failure::usage)?;
    Ok(options.error)
}

fn parse_show(text: &str) -> Result<Show, Failure> {
    match text {
        "mesh" => Ok(Show::Mesh),
        "curves" => Ok(Show::Curves),
        _ => Err(Failure::usage(format_args!("show is '{text}', it must be mesh or curves"))),
    }
}

/// An exposure as typed.
pub fn parse_exposure(text: &str) -> Result<PngExposure, Failure> {
    if text == "auto" {
        return Ok(PngExposure::Auto);
    }
    // Beyond this floats end.
    let ev = text.parse().ok().filter(|ev: &f64| ev.abs() <= 100.0);
    ev.map(PngExposure::Ev)
        .ok_or_else(|| Failure::usage(format_args!("exposure is '{text}', it must be auto or an EV from -100 to 100")))
}

/// A quantity by name.
pub fn parse_quantity(text: &str) -> Result<Quantity, Failure> {
    match text {
        "radiance" => Ok(Quantity::Radiance),
        "radiosity" => Ok(Quantity::Radiosity),
        "width" => Ok(Quantity::Width),
        "irradiance" => Ok(Quantity::Irradiance),
        "illuminance" => Ok(Quantity::Illuminance),
        _ => Err(Failure::usage(format_args!("quantity is '{text}', it must be one of {}", Quantity::NAMES.join(", ")))),
    }
}

/// `patchlight sample`.
#[derive(Debug)]
pub struct SampleRequest {
    pub solution: PathBuf,
    pub what: Sampled,
    pub output: Sink,
    pub run: RunOptions,
    pub voice: Voice,
}

/// What is evaluated.
#[derive(Debug)]
pub enum Sampled {
    /// Radiosities at the points of a file.
    Points(PathBuf, Whence),
    /// Irradiances in space.
    Sensors(SensorRequest),
}

impl SampleRequest {
    /// Validates what was typed.
    pub fn new(typed: SampleArguments) -> Result<Self, Failure> {
        let read = [Some(&typed.solution), typed.points.as_ref(), typed.sensors.as_ref()];
        let read: Vec<&Path> = read.into_iter().flatten().map(PathBuf::as_path).collect();
        let mut outputs = Outputs::beside(&read);
        let output = outputs.sink(&typed.output)?;
        let what = match (SensorRequest::new(&typed, &mut outputs)?, typed.points) {
            (Some(sensors), _) => Sampled::Sensors(sensors),
            (None, Some(points)) => Sampled::Points(points, typed.from),
            (None, None) => return Err(Failure::usage("say where: POINTS, --sensors or --plane")),
        };
        let (run, voice) = (run_options(&typed.run)?, Voice::new(typed.run.progress));
        Ok(Self { solution: typed.solution, what, output, run, voice })
    }
}

/// `patchlight render`.
#[derive(Debug)]
pub struct RenderRequest {
    pub solution: PathBuf,
    pub picture: PictureRequest,
    pub run: RunOptions,
    pub voice: Voice,
}

impl RenderRequest {
    /// Validates what was typed.
    pub fn new(typed: RenderArguments) -> Result<Self, Failure> {
        let mut picture = PictureRequest::new(&typed.output, &typed.picture, &mut Outputs::beside(&[&typed.solution]))?;
        picture.error = typed.error.as_deref().map(parse_error).transpose()?;
        if picture.error.is_some() && (picture.from.is_some() || picture.quantity == Quantity::Width) {
            return Err(Failure::usage(
                "--error asks for a mesh that is made for the picture: leave --from and --quantity width out",
            ));
        }
        let mut run = run_options(&typed.run)?;
        limit(&mut run, typed.time.as_deref(), typed.memory.as_deref())?;
        Ok(Self { solution: typed.solution, picture, run, voice: Voice::new(typed.run.progress) })
    }
}

/// `patchlight export`.
#[derive(Debug)]
pub struct ExportRequest {
    pub solution: PathBuf,
    pub elements: Option<(Destination, ExportFormat)>,
    pub what: Exported,
    pub flux: Option<Sink>,
}

/// What is exported.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exported {
    /// The lit mesh, or the elements of the solver where there is none.
    Best,
    /// The elements of the solver.
    Elements,
    /// The lit mesh, by faces of six vertices.
    Quadratic,
}

impl ExportRequest {
    /// Validates what was typed.
    pub fn new(typed: ExportArguments) -> Result<Self, Failure> {
        let mut outputs = Outputs::beside(&[&typed.solution]);
        let elements = |path: &PathBuf| {
            let format = ExportFormat::of_path(path).map_err(Failure::usage)?;
            if typed.quadratic && format != ExportFormat::Ply {
                return Err(Failure::usage("--quadratic is for .ply; other formats have flat triangles"));
            }
            Ok((outputs.file(path)?, format))
        };
        let elements = typed.output.as_ref().map(elements).transpose()?;
        let flux = typed.flux.as_deref().map(|path| outputs.sink(path)).transpose()?;
        let what = match (typed.elements, typed.quadratic) {
            (true, _) => Exported::Elements,
            (_, true) => Exported::Quadratic,
            _ => Exported::Best,
        };
        Ok(Self { solution: typed.solution, elements, what, flux })
    }
}
