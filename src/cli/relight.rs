//! `patchlight relight`: a solution with other weights for its light groups, or with other materials, as a solution and as all that is made from one.

use std::path::PathBuf;
use std::time::Instant;

use patchlight::output::{Destination, ExportFormat, Provenance, write_error, write_fluxes, write_light_groups};
use patchlight::pipeline::{Evaluator, Workers, with_materials_on};
use patchlight::scene::LightWeight;
use patchlight::solve::{ErrorReport, LightGroupsReport, RunOptions, Solution, SolveOptions};

use super::argument_groups::Whence;
use super::arguments::RelightArguments;
use super::changes::{Change, Property, changed};
use super::exit::{Exit, Failure};
use super::files::{self, Outputs, Sink};
use super::key_figures::claim_in_words;
use super::light_groups::{parse_weight, tell_groups};
use super::page_extras::FoundExtras;
use super::pictures::Limits;
use super::progress::{Voice, Watcher};
use super::report::{page_file, write_page_to};
use super::request::PictureRequest;
use super::settings::run_options;
use super::solve::Ending;
use super::{interrupt, pictures, results};

/// What is changed.
#[derive(Debug)]
enum Relit {
    /// The weights of light groups.
    Groups(Vec<LightWeight>),
    /// Materials, and the error that is asked for, if it is not that of the solution.
    Materials(Vec<Change>, Option<f64>),
}

/// What is known of what was relit.
enum Known {
    Groups(LightGroupsReport),
    Materials(ErrorReport),
}

/// What is asked for.
#[derive(Debug)]
pub struct RelightRequest {
    read: PathBuf,
    what: Relit,
    solution: Option<Destination>,
    picture: Option<PictureRequest>,
    points: Option<(PathBuf, Sink)>,
    /// Where values come from.
    from: Option<Whence>,
    mesh: Option<(Destination, ExportFormat)>,
    flux: Option<Sink>,
    page: Option<Destination>,
    report: Option<Sink>,
    run: RunOptions,
    voice: Voice,
}

impl RelightRequest {
    /// Validates what was typed.
    pub fn new(typed: RelightArguments) -> Result<Self, Failure> {
        let what = Relit::new(&typed)?;
        let mut outputs = Outputs::beside(&[&[typed.solution.as_path()], typed.points.as_deref().as_slice()].concat());
        let solution = typed.output.as_deref().map(|path| outputs.file(path)).transpose()?;
        let picture = if typed.image.is_empty() {
            let flags = &typed.picture;
            let of_pngs = [&flags.exposure, &flags.scale, &flags.show];
            if of_pngs.into_iter().chain([&flags.view.camera, &flags.view.size, &flags.quantity]).any(Option::is_some) {
                return Err(Failure::usage("--camera, --size, --exposure, --quantity, --scale and --show need --image FILE"));
            }
            None
        } else {
            Some(PictureRequest::new(&typed.image, &typed.picture, &mut outputs)?)
        };
        let mesh = match &typed.mesh {
            Some(path) => Some((outputs.file(path)?, ExportFormat::of_path(path).map_err(Failure::usage)?)),
            None => None,
        };
        let mut sink = |path: &Option<PathBuf>| path.as_deref().map(|path| outputs.sink(path)).transpose();
        let (values, flux, report) = (sink(&typed.values)?, sink(&typed.flux)?, sink(&typed.report)?);
        let page = typed.html.as_deref().map(|path| page_file(path, "--html", &mut outputs)).transpose()?;
        let points = typed.points.zip(values);
        let asks = solution.is_some() || picture.is_some() || points.is_some() || mesh.is_some() || page.is_some();
        if !asks && flux.is_none() && report.is_none() {
            return Err(Failure::usage(
                "say what to write: -o, --image, --points with --values, --mesh, --flux, --html or --report",
            ));
        }
        let (run, voice) = (run_options(&typed.run)?, Voice::new(typed.run.progress));
        let (read, from) = (typed.solution, typed.picture.from);
        Ok(Self { read, what, solution, picture, points, from, mesh, flux, page, report, run, voice })
    }
}

impl Relit {
    fn new(typed: &RelightArguments) -> Result<Self, Failure> {
        let changes = [
            (&typed.reflectance, "reflectance", Property::Reflectance),
            (&typed.exitance, "exitance", Property::Exitance),
            (&typed.exitance_factor, "exitance-factor", Property::ExitanceFactor),
        ];
        let changes = changes.iter().flat_map(|(all, flag, property)| all.iter().map(|one| Change::typed(flag, *property, one)));
        let changes = changes.collect::<Result<Vec<_>, _>>()?;
        let mut asked = SolveOptions::default();
        let error = typed.error.as_deref().map(|error| asked.set("error", error)).transpose().map_err(Failure::usage)?;
        if changes.is_empty() {
            if error.is_some() {
                return Err(Failure::usage("--error needs --reflectance, --exitance or --exitance-factor"));
            }
            return Ok(Self::Groups(typed.set.iter().map(|weight| parse_weight(weight)).collect::<Result<_, _>>()?));
        }
        Ok(Self::Materials(changes, error.map(|()| asked.error)))
    }

    /// A solution with what is changed, and what is known of it; `None` if interrupted.
    fn apply(&self, solution: &Solution, run: &RunOptions, voice: Voice) -> Result<Option<(Solution, Known)>, Failure> {
        let (changes, error) = match self {
            Self::Groups(weights) => {
                let relit = solution.relit(weights).map_err(Failure::usage)?;
                let known = relit.light_groups_report().unwrap_or_default();
                tell_groups(voice, &known);
                return Ok(Some((relit, Known::Groups(known))));
            }
            Self::Materials(changes, error) => (changes, error),
        };
        let as_usage = |failure: Failure| Failure::usage(failure.message);
        let materials = changed(solution.scene(), changes).map_err(as_usage)?.materials().to_vec();
        let (workers, watcher) = (Workers::new(run.threads)?, Watcher::new(voice));
        let found = with_materials_on(&workers, solution, materials, &watcher).map_err(Failure::usage)?;
        Ok(found.map(|(relit, known)| {
            let known = ErrorReport { requested: error.unwrap_or(known.requested), ..known };
            let reached = if known.estimate <= known.requested { "reached" } else { "not reached: solve the scene anew" };
            let asked = 100.0 * known.requested;
            let claim = claim_in_words(&known, relit.options().norm);
            voice.figure("error", format_args!("{claim}; {asked:.2}% asked for: {reached}"));
            (relit, Known::Materials(known))
        }))
    }
}

impl Known {
    /// How it ends: materials may be claimed less well than was asked for.
    fn exit(&self) -> Exit {
        match self {
            Self::Materials(error) if error.estimate > error.requested => Exit::Limit,
            Self::Groups(_) | Self::Materials(_) => Exit::Done,
        }
    }
}

/// Relights, and writes what is asked for.
pub fn relight(request: &RelightRequest) -> Result<Exit, Failure> {
    let voice = request.voice;
    let points = request.points.as_ref().map(|(path, _)| files::read_points(path)).transpose()?;
    let solution = files::read_solution(&request.read)?;
    interrupt::listen(interrupt::OF_RUN);
    let Some((relit, known)) = request.what.apply(&solution, &request.run, voice)? else { return Ok(Exit::Cancelled) };
    drop(solution);

    let (evaluator, provenance) =
        (Evaluator::new(relit, &request.run)?, |evaluator: &Evaluator| Provenance::new(evaluator.solution().options()));
    let mut ending = Ending::new(known.exit());
    if let Some(destination) = &request.solution {
        ending.write(|| results::write_solution_to(destination, &evaluator, voice));
    }
    if let (Some((_, sink)), Some(points)) = (&request.points, &points) {
        let values = match request.from {
            Some(Whence::Mesh) => Some(results::values_of_mesh(&evaluator, points)?),
            _ => results::values_at(&evaluator, points, voice),
        };
        match values {
            Some(values) => ending.write(|| results::write_values_to(sink, points, &values, voice)),
            None => ending.cancel(voice, &sink.name()),
        }
    }
    if let Some(mesh) = &request.mesh {
        let lit = evaluator.mesh().ok_or_else(|| results::no_mesh("--mesh"))?;
        ending.write(|| results::write_mesh_to(mesh, &evaluator, lit, voice));
    }
    if let Some(picture) = &request.picture {
        let limits = Limits::of(RunOptions::default(), Instant::now());
        match pictures::take_picture(&evaluator, picture, &limits, voice)? {
            Some(image) => ending.write(|| pictures::write_picture(&image, picture, &provenance(&evaluator), voice)),
            None => ending.cancel(voice, "the picture"),
        }
    }
    if let Some(sink) = &request.flux {
        ending.write(|| sink.write(|mut writer| write_fluxes(&mut writer, evaluator.solution())));
    }
    if let Some(page) = &request.page {
        let name = request.read.file_name().unwrap_or_default().to_string_lossy();
        ending.write(|| write_page_to(page, (&evaluator, &name), (None, &FoundExtras::default()), voice));
    }
    if let Some(sink) = &request.report {
        ending.write(|| {
            sink.write(|mut writer| match &known {
                Known::Groups(known) => write_light_groups(&mut writer, known),
                Known::Materials(error) => write_error(&mut writer, error),
            })
        });
    }
    // The program ends: the system takes all memory back at once.
    std::mem::forget(evaluator);
    ending.finish()
}
