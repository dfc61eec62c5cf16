//! What is asked for, validated: names known, numbers in range, outputs writable.

use std::path::PathBuf;

use patchlight::output::{Destination, ExportFormat, Exposure, ImageFormat, Quantity};
use patchlight::reconstruct::{Camera, CameraRequest};
use patchlight::scene::Sides;
use patchlight::solve::{Bounds, Interest, RunOptions, SolveOptions};

use super::arguments::{ExportArguments, PictureArguments, RenderArguments, RunArguments, SampleArguments, SolveArguments};
use super::exit::Failure;
use super::files::{Outputs, Sink};
use super::process;
use super::progress::Voice;

/// Width and height of a picture that nobody gave a size.
const DEFAULT_SIZE: (u32, u32) = (960, 720);

/// Of the memory that is available, the solution gets so much if nobody says: while it refines, the process takes up to five times what
/// nodes and links do (measured at 3 million links), and is to stay below three quarters.
const DEFAULT_MEMORY: f64 = 0.75 / 5.0;

fn default_memory_bytes() -> Option<u64> {
    process::available_memory_bytes().map(|available| (DEFAULT_MEMORY * available as f64) as u64)
}

/// A picture to take.
#[derive(Debug)]
pub struct PictureRequest {
    pub files: Vec<(Destination, ImageFormat)>,
    pub camera: CameraRequest,
    pub size: (u32, u32),
    pub exposure: Exposure,
    pub quantity: Quantity,
}

impl PictureRequest {
    fn new(paths: &[PathBuf], typed: &PictureArguments, outputs: &mut Outputs) -> Result<Self, Failure> {
        let camera = typed.camera.as_deref().unwrap_or("").parse().map_err(Failure::usage)?;
        let size = typed.size.as_deref().map_or(Ok(DEFAULT_SIZE), parse_size)?;
        let exposure = typed.exposure.as_deref().map_or(Ok(Exposure::Auto), parse_exposure)?;
        let quantity = typed.quantity.as_deref().map_or(Ok(Quantity::Radiance), parse_quantity)?;
        let formats: Vec<ImageFormat> =
            paths.iter().map(|path| ImageFormat::of_path(path)).collect::<Result<_, _>>().map_err(Failure::usage)?;
        if typed.exposure.is_some() && !formats.contains(&ImageFormat::Png) {
            return Err(Failure::usage("--exposure is for .png; .exr keeps the radiances as they are"));
        }
        if typed.quantity.is_some() && !formats.contains(&ImageFormat::Exr) {
            return Err(Failure::usage("--quantity is for .exr; .png is a picture to look at"));
        }
        if quantity == Quantity::Width && formats.contains(&ImageFormat::Png) {
            return Err(Failure::usage("--quantity width is for .exr alone; take the .png in a run of its own"));
        }
        // A view that is given in full can be judged before the scene is known.
        if let CameraRequest { eye: Some(eye), target: Some(target), up, field_of_view_degrees } = camera {
            let up = up.unwrap_or(if eye[0] == target[0] && eye[2] == target[2] { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] });
            let field_of_view_degrees = field_of_view_degrees.unwrap_or(45.0);
            let camera = Camera { eye, target, up, field_of_view_degrees, width: size.0, height: size.1 };
            camera.validate().map_err(Failure::usage)?;
        }
        let destinations: Vec<Destination> = paths.iter().map(|path| outputs.file(path)).collect::<Result<_, _>>()?;
        Ok(Self { files: destinations.into_iter().zip(formats).collect(), camera, size, exposure, quantity })
    }
}

/// `patchlight solve`.
#[derive(Debug)]
pub struct SolveRequest {
    pub scene: PathBuf,
    pub sides: Sides,
    pub options: SolveOptions,
    pub run: RunOptions,
    pub voice: Voice,
    pub solution: Option<Destination>,
    pub picture: Option<PictureRequest>,
    pub points: Option<(PathBuf, Sink)>,
    pub report: Option<Sink>,
}

impl SolveRequest {
    /// Validates what was typed.
    pub fn new(typed: SolveArguments) -> Result<Self, Failure> {
        // Options: flags first, then `--set` in the order in which it was typed.
        let mut settings = Settings::default();
        settings.set_run(&typed.run)?;
        let options = &mut settings.options;
        options.error = typed.error.unwrap_or(options.error);
        options.seed = typed.seed.unwrap_or(options.seed);
        options.max_links = typed.max_links.or(options.max_links);
        if let Some(name) = &typed.strategy {
            options.strategy = name.parse().map_err(Failure::usage)?;
        }
        for (key, value) in [("sides", &typed.sides), ("bounds", &typed.bounds)] {
            if let Some(value) = value {
                settings.set(key, value)?;
            }
        }
        if let Some(text) = &typed.importance {
            let camera = typed.picture.camera.as_deref().filter(|_| text.trim() == "view");
            settings.set("importance", &camera.map_or_else(|| text.clone(), |camera| format!("view {camera}")))?;
        }
        for (key, value) in [("memory", typed.memory), ("time", typed.time)] {
            if let Some(value) = value {
                settings.set(key, &value.to_string())?;
            }
        }
        for setting in &typed.set {
            let (key, value) = setting
                .split_once('=')
                .ok_or_else(|| Failure::usage(format_args!("--set {setting}: write --set key=value, as in --set error=0.01")))?;
            settings.set(key.trim(), value.trim())?;
        }
        settings.options.validate().map_err(Failure::usage)?;
        settings.run.memory_bytes = settings.run.memory_bytes.or_else(default_memory_bytes);

        // Outputs, before anything is computed.
        let points = typed.points.as_deref();
        let mut outputs = Outputs::beside(&[&[typed.scene.as_path()], points.as_slice()].concat());
        let solution = typed.output.as_deref().map(|path| outputs.file(path)).transpose()?;
        let picture = &typed.picture;
        let camera_for_picture = picture.camera.as_ref().filter(|_| !matches!(settings.options.importance, Interest::View(_)));
        let picture_flags = [camera_for_picture, picture.size.as_ref(), picture.exposure.as_ref(), picture.quantity.as_ref()];
        if typed.image.is_empty() && picture_flags.iter().any(|flag| flag.is_some()) {
            return Err(Failure::usage("--camera, --size, --exposure and --quantity need --image FILE"));
        }
        let asked = !typed.image.is_empty();
        let picture = asked.then(|| PictureRequest::new(&typed.image, picture, &mut outputs)).transpose()?;
        let shows_width = picture.as_ref().is_some_and(|picture| picture.quantity == Quantity::Width);
        if shows_width && settings.options.bounds != Bounds::Guaranteed {
            return Err(Failure::usage("--quantity width needs --bounds guaranteed"));
        }
        let values = typed.values.as_deref().map(|path| outputs.sink(path)).transpose()?;
        let report = typed.report.as_deref().map(|path| outputs.sink(path)).transpose()?;
        Ok(Self {
            scene: typed.scene,
            sides: settings.sides,
            options: settings.options,
            run: settings.run,
            voice: Voice::new(typed.run.progress),
            solution,
            picture,
            points: typed.points.zip(values),
            report,
        })
    }
}

/// All that `--set` reaches.
#[derive(Default)]
struct Settings {
    options: SolveOptions,
    run: RunOptions,
    sides: Sides,
}

impl Settings {
    fn set_run(&mut self, typed: &RunArguments) -> Result<(), Failure> {
        self.run.threads = typed.threads.unwrap_or(0);
        if let Some(name) = &typed.backend {
            self.run.backend = name.parse().map_err(Failure::usage)?;
        }
        check_threads(self.run.threads)
    }

    /// Sets one option from text: those of the run here, all others by [`SolveOptions::set`].
    fn set(&mut self, key: &str, value: &str) -> Result<(), Failure> {
        let positive = |unit: &str| {
            let number = value.parse::<f64>().ok().filter(|x| x.is_finite() && *x > 0.0);
            number.ok_or_else(|| Failure::usage(format_args!("{key} is '{value}', it must be a number of {unit} above 0")))
        };
        match key {
            "sides" => self.sides = parse_sides(value)?,
            "backend" => self.run.backend = value.parse().map_err(Failure::usage)?,
            "threads" => {
                let threads = value.parse();
                self.run.threads = threads.map_err(|_| {
                    Failure::usage(format_args!("threads is '{value}', it must be a whole number, 0 for one per core"))
                })?;
                check_threads(self.run.threads)?;
            }
            "time" => self.run.time_s = Some(positive("seconds")?),
            "memory" => self.run.memory_bytes = Some((positive("GB")? * 1e9) as u64),
            _ => self.options.set(key, value).map_err(Failure::usage)?,
        }
        Ok(())
    }
}

/// More threads than any machine has are a slip, and the system would fail on them in the middle of the work.
fn check_threads(threads: usize) -> Result<(), Failure> {
    const MOST: usize = 4096;
    if threads > MOST {
        return Err(Failure::usage(format_args!("threads is {threads}, it must be at most {MOST}; 0 takes one per core")));
    }
    Ok(())
}

/// Sides by name.
pub fn parse_sides(text: &str) -> Result<Sides, Failure> {
    match text {
        "front" => Ok(Sides::Front),
        "both" => Ok(Sides::Both),
        _ => Err(Failure::usage(format_args!("sides is '{text}', it must be front or both"))),
    }
}

fn parse_size(text: &str) -> Result<(u32, u32), Failure> {
    let bad = || Failure::usage(format_args!("size is '{text}', write width and height in pixels, as in 960x720"));
    let (width, height) = text.split_once(['x', 'X']).ok_or_else(bad)?;
    let (width, height) = (width.parse().map_err(|_| bad())?, height.parse().map_err(|_| bad())?);
    let camera = Camera { eye: [0.0; 3], target: [0.0, 0.0, 1.0], up: [0.0, 1.0, 0.0], field_of_view_degrees: 45.0, width, height };
    camera.validate().map_err(Failure::usage)?;
    Ok((width, height))
}

fn parse_exposure(text: &str) -> Result<Exposure, Failure> {
    if text == "auto" {
        return Ok(Exposure::Auto);
    }
    // Beyond this floats end.
    let ev = text.parse().ok().filter(|ev: &f64| ev.abs() <= 100.0);
    ev.map(Exposure::Ev)
        .ok_or_else(|| Failure::usage(format_args!("exposure is '{text}', it must be auto or an EV from -100 to 100")))
}

fn parse_quantity(text: &str) -> Result<Quantity, Failure> {
    match text {
        "radiance" => Ok(Quantity::Radiance),
        "radiosity" => Ok(Quantity::Radiosity),
        "width" => Ok(Quantity::Width),
        _ => Err(Failure::usage(format_args!("quantity is '{text}', it must be one of {}", Quantity::NAMES.join(", ")))),
    }
}

fn run_options(typed: &RunArguments) -> Result<RunOptions, Failure> {
    let mut settings = Settings::default();
    settings.set_run(typed)?;
    Ok(settings.run)
}

/// `patchlight sample`.
#[derive(Debug)]
pub struct SampleRequest {
    pub solution: PathBuf,
    pub points: PathBuf,
    pub output: Sink,
    pub run: RunOptions,
    pub voice: Voice,
}

impl SampleRequest {
    /// Validates what was typed.
    pub fn new(typed: SampleArguments) -> Result<Self, Failure> {
        let output = Outputs::beside(&[&typed.solution, &typed.points]).sink(&typed.output)?;
        let (run, voice) = (run_options(&typed.run)?, Voice::new(typed.run.progress));
        Ok(Self { solution: typed.solution, points: typed.points, output, run, voice })
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
        let picture = PictureRequest::new(&typed.output, &typed.picture, &mut Outputs::beside(&[&typed.solution]))?;
        let (run, voice) = (run_options(&typed.run)?, Voice::new(typed.run.progress));
        Ok(Self { solution: typed.solution, picture, run, voice })
    }
}

/// `patchlight export`.
#[derive(Debug)]
pub struct ExportRequest {
    pub solution: PathBuf,
    pub destination: Destination,
    pub format: ExportFormat,
}

impl ExportRequest {
    /// Validates what was typed.
    pub fn new(typed: ExportArguments) -> Result<Self, Failure> {
        let format = ExportFormat::of_path(&typed.output).map_err(Failure::usage)?;
        let destination = Outputs::beside(&[&typed.solution]).file(&typed.output)?;
        Ok(Self { solution: typed.solution, destination, format })
    }
}
