//! `patchlight sample --sensors` and `--plane`: irradiance in space.

use std::time::Instant;

use patchlight::output::{
    Destination, Display, Look, MeasuredPlane, Points, Provenance, Scale, ShownPlane, write_display, write_irradiances,
};
use patchlight::picture::{MeasuringPlane, PlaneRequest};
use patchlight::pipeline::Evaluator;
use patchlight::progress::Observer;
use patchlight::scene::SurfacePoint;
use patchlight::solve::RunOptions;
use patchlight::values::{Irradiances, Summary};

use super::arguments::SampleArguments;
use super::exit::{Exit, Failure};
use super::files::{self, Outputs, Sink};
use super::interrupt;
use super::progress::{Timed, Voice, Watcher};
use super::settings::limit;

/// Where sensors are.
#[derive(Debug)]
pub enum Sensors {
    /// In a file.
    File(std::path::PathBuf),
    /// On a measuring plane, with a picture of it if wanted.
    Plane(PlaneRequest, Option<PlanePicture>),
}

/// A picture of a measuring plane.
#[derive(Debug)]
pub struct PlanePicture {
    destination: Destination,
    /// If not given, up to the largest value.
    scale: Option<Scale>,
}

/// What is measured, and where it goes.
#[derive(Debug)]
pub struct SensorRequest {
    pub sensors: Sensors,
    /// Its time is from the start.
    pub run: RunOptions,
}

impl SensorRequest {
    /// What was typed, if it is about sensors.
    pub fn new(typed: &SampleArguments, outputs: &mut Outputs) -> Result<Option<Self>, Failure> {
        if typed.image.is_some() && typed.plane.is_none() {
            return Err(Failure::usage("--image shows a plane: say which by --plane"));
        }
        let sensors = match (&typed.sensors, &typed.plane) {
            (Some(path), _) => Sensors::File(path.clone()),
            (None, Some(text)) => Sensors::Plane(text.parse().map_err(Failure::usage)?, picture(typed, outputs)?),
            (None, None) => return Ok(None),
        };
        let mut run = RunOptions::default();
        limit(&mut run, typed.time.as_deref(), None)?;
        Ok(Some(Self { sensors, run }))
    }
}

/// The picture of a plane, if one is asked for.
fn picture(typed: &SampleArguments, outputs: &mut Outputs) -> Result<Option<PlanePicture>, Failure> {
    let Some(path) = &typed.image else { return Ok(None) };
    if !path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png")) {
        return Err(Failure::usage(format_args!("--image writes PNG: name the file {}", path.with_extension("png").display())));
    }
    let scale = typed.scale.as_deref().map(str::parse).transpose().map_err(Failure::usage)?;
    Ok(Some(PlanePicture { destination: outputs.file(path)?, scale }))
}

/// Measures, and writes what there is, whether all of it could be measured or not.
pub fn measure(
    evaluator: &Evaluator,
    (request, start): (&SensorRequest, Instant),
    sink: &Sink,
    voice: Voice,
) -> Result<Exit, Failure> {
    let points = match &request.sensors {
        Sensors::File(path) => files::read_points(path)?,
        Sensors::Plane(..) => Points::default(),
    };
    interrupt::listen(interrupt::OF_RUN);
    voice.figure("backend", format_args!("{}", evaluator.backend()));
    let timed = Timed { watcher: Watcher::new(voice), end: request.run.deadline_from(start) };
    match &request.sensors {
        Sensors::File(_) => {
            let irradiances = evaluator.irradiances_at(&points.surface_points(), &timed);
            write_to(sink, &points, &irradiances, voice)?;
            Ok(ending(&timed, irradiances.missing(), voice))
        }
        Sensors::Plane(request, picture) => {
            let (measured, missing) = measured_on(evaluator, (request, String::new()), &timed)?;
            let MeasuredPlane { plane, irradiances, .. } = &measured;
            write_to(sink, &Points::from(plane.sensors().as_slice()), irradiances, voice)?;
            let shown = measured.shown(evaluator.solution().scene());
            tell(plane, &shown, voice);
            if let Some(picture) = picture {
                picture.write(plane, &shown, &Provenance::new(evaluator.solution().options()), voice)?;
            }
            Ok(ending(&timed, missing, voice))
        }
    }
}

/// What the sensors of a plane measure, under a name, and how many were not reached before `observer` cancelled.
pub fn measured_on(
    evaluator: &Evaluator,
    (request, name): (&PlaneRequest, String),
    observer: &dyn Observer,
) -> Result<(MeasuredPlane, usize), Failure> {
    let (plane, is_inside) = evaluator.measuring_plane(request).map_err(Failure::usage)?;
    let inside: Vec<SurfacePoint> =
        plane.sensors().into_iter().zip(&is_inside).filter(|(_, inside)| **inside).map(|(sensor, _)| sensor).collect();
    let measured = evaluator.irradiances_at(&inside, observer);
    let irradiances = spread(&measured, &is_inside);
    Ok((MeasuredPlane { name, plane, irradiances }, measured.missing()))
}

fn write_to(sink: &Sink, points: &Points, irradiances: &Irradiances, voice: Voice) -> Result<(), Failure> {
    sink.write(|mut writer| write_irradiances(&mut writer, points, irradiances))?;
    voice.figure("wrote", format_args!("{} ({} sensors)", sink.name(), points.len()));
    Ok(())
}

/// How it ended, and what is missing.
fn ending(timed: &Timed, missing: usize, voice: Voice) -> Exit {
    if missing == 0 {
        return Exit::Done;
    }
    let (exit, why) = if timed.watcher.cancelled() { (Exit::Cancelled, "interrupted") } else { (Exit::Limit, "the time was over") };
    voice.warn(format_args!("{missing} sensors were not measured, their values are empty: {why}"));
    exit
}

/// The irradiances of all sensors of a plane from those of the ones that were measured.
fn spread(measured: &Irradiances, is_measured: &[bool]) -> Irradiances {
    let channels = measured.channels;
    let spread = |numbers: &[f32]| {
        let mut all = vec![f32::NAN; is_measured.len() * channels];
        let places = all.chunks_mut(channels).zip(is_measured).filter(|(_, is_measured)| **is_measured);
        places.zip(numbers.chunks(channels)).for_each(|((place, _), found)| place.copy_from_slice(found));
        all
    };
    Irradiances { channels, irradiance: spread(&measured.irradiance), standard_error: spread(&measured.standard_error) }
}

/// Tells mean, extremes and uniformity.
fn tell(plane: &MeasuringPlane, shown: &ShownPlane, voice: Voice) {
    let ([columns, rows], quantity) = (plane.counts, shown.quantity);
    let unit = quantity.unit();
    let Some(summary) = shown.summary else {
        voice.warn(format_args!("none of the {columns}x{rows} sensors of the plane hangs in a room"));
        return;
    };
    let Summary { count, mean, standard_error, minimum, maximum } = summary;
    let error = if standard_error.is_finite() { format!(" (standard error {standard_error:.3})") } else { String::new() };
    voice.figure("plane", format_args!("{columns}x{rows} sensors, {count} of them measured: {} in {unit}", quantity.name()));
    voice.figure("mean", format_args!("{mean:.3}{error}"));
    voice.figure("minimum", format_args!("{minimum:.3}"));
    voice.figure("maximum", format_args!("{maximum:.3}"));
    voice.figure("uniform", format_args!("{:.3} (minimum over mean)", summary.uniformity()));
}

impl PlanePicture {
    fn write(&self, plane: &MeasuringPlane, shown: &ShownPlane, provenance: &Provenance, voice: Voice) -> Result<(), Failure> {
        let ShownPlane { quantity, values, .. } = shown;
        let scale = self.scale.unwrap_or_else(|| {
            let largest = values.lux.iter().copied().filter(|value| !value.is_nan()).fold(0.0, f32::max);
            Scale::up_to(f64::from(largest))
        });
        let (image, marks) = plane.picture(&values.lux, quantity.per_radiance());
        let display = Display { image: &image, quantity: *quantity, look: Look::Scale(scale), marks: Some(&marks) };
        self.destination.write(|file| write_display(file, &display, provenance).map(|_| ()))?;
        let (name, low, high, unit) = (quantity.name(), scale.low(), scale.high(), quantity.unit());
        voice.figure("wrote", format_args!("{} ({name} from {low} to {high} {unit})", self.destination.path().display()));
        Ok(())
    }
}
