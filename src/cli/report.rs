//! `patchlight report`, and pages of other commands.

use std::path::{Path, PathBuf};

use patchlight::inspect::DEFAULT_POINTS;
use patchlight::output::{Destination, Page, Provenance, RunReport, write_page};
use patchlight::pipeline::Evaluator;
use patchlight::solve::RunOptions;

use super::arguments::ReportArguments;
use super::exit::{Exit, Failure};
use super::files::{self, Outputs};
use super::interrupt;
use super::page_extras::{FoundExtras, PageExtras};
use super::progress::Voice;
use super::settings::run_options;

/// The first view of a page shows the scene in a picture of these sides.
const PAGE_VIEW: [u32; 2] = [960, 720];

/// `patchlight report`.
#[derive(Debug)]
pub struct ReportRequest {
    solution: PathBuf,
    page: Destination,
    extras: PageExtras,
    run: RunOptions,
    voice: Voice,
}

impl ReportRequest {
    /// Validates what was typed.
    pub fn new(typed: ReportArguments) -> Result<Self, Failure> {
        let page = page_file(&typed.output, "report", &mut Outputs::beside(&[&typed.solution]))?;
        let (run, voice) = (run_options(&typed.run)?, Voice::new(typed.run.progress));
        Ok(Self { solution: typed.solution, page, extras: PageExtras::new(&typed.page)?, run, voice })
    }
}

/// `patchlight report`.
pub fn report(request: ReportRequest) -> Result<Exit, Failure> {
    let evaluator = Evaluator::new(files::read_solution(&request.solution)?, &request.run)?;
    let name = request.solution.file_name().unwrap_or_default().to_string_lossy();
    if !request.extras.is_empty() {
        interrupt::listen(interrupt::OF_RUN);
    }
    let (extras, ending) = request.extras.find(&evaluator, request.voice)?;
    write_page_to(&request.page, (&evaluator, &name), (None, &extras), request.voice)?;
    Ok(ending.unwrap_or(Exit::Done))
}

/// The file of a page, by its extension.
pub fn page_file(path: &Path, flag: &str, outputs: &mut Outputs) -> Result<Destination, Failure> {
    if !path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("html")) {
        return Err(Failure::usage(format_args!("{flag} writes HTML: name the file {}", path.with_extension("html").display())));
    }
    outputs.file(path)
}

/// Writes a page under a title, with the report of the run if there is one, and what it shows beside the light.
pub fn write_page_to(
    destination: &Destination,
    (evaluator, title): (&Evaluator, &str),
    (report, extras): (Option<&RunReport>, &FoundExtras),
    voice: Voice,
) -> Result<(), Failure> {
    let (solution, camera) = (evaluator.solution(), evaluator.default_camera(PAGE_VIEW[0], PAGE_VIEW[1]));
    let met = evaluator.surface_rays(DEFAULT_POINTS);
    let page = Page { title, solution, camera: &camera, report, planes: &extras.planes, curves: &extras.curves, met: &met };
    destination.write(|mut file| write_page(&mut file, &page, &Provenance::new(solution.options())))?;
    voice.figure("wrote", format_args!("{}", destination.path().display()));
    Ok(())
}
