//! From a scene to a solution.

use std::ffi::c_void;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use patchlight::output::{Provenance, RunReport, SceneReport, write_report};
use patchlight::pipeline;
use patchlight::solve::{SolveOptions, SolveReport, StoppedBy};

use crate::context::{PATCHLIGHT_LOG_INFO, patchlight_context};
use crate::entry::enter;
use crate::handles;
use crate::memory::{Out, SizedStruct, read_sized};
use crate::observer::{Listener, MemoryMonitor, Watcher, patchlight_memory_function, patchlight_progress_function};
use crate::options::{Settings, patchlight_options};
use crate::scene::{Committed, patchlight_scene};
use crate::solution::{Known, Report, Solution, patchlight_solution};
use crate::status::{
    Ending, Outcome, PATCHLIGHT_CALLBACK_ERROR, PATCHLIGHT_CANCELLED, PATCHLIGHT_LIMIT, PATCHLIGHT_MEMORY_LIMIT, PATCHLIGHT_OK,
    patchlight_status,
};
use crate::visibility::{CallersVisibility, patchlight_visibility};

/// How a scene is solved. What is zero is left to the library.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct patchlight_solve_info {
    /// `sizeof(patchlight_solve_info)`
    pub size: usize,
    /// What is asked for; NULL for all defaults. Later changes of them change nothing here.
    pub options: *mut patchlight_options,
    /// Hears how far it is, and may cancel; may be NULL.
    pub progress: patchlight_progress_function,
    /// Handed to `progress` as it is.
    pub progress_user: *mut c_void,
    /// Who answers visibility; NULL for the backend that the options name. The struct is copied.
    pub visibility: *const patchlight_visibility,
    /// Hears how much memory is taken, and may refuse more; may be NULL.
    pub memory: patchlight_memory_function,
    /// Handed to `memory` as it is.
    pub memory_user: *mut c_void,
}

// SAFETY: repr(C), its size first; pointers and functions that may be NULL may be zero.
unsafe impl SizedStruct for patchlight_solve_info {
    const NAME: &'static str = "patchlight_solve_info";
}

/// What was asked for, read.
pub struct Request {
    pub settings: Settings,
    pub listener: Listener,
    pub memory: MemoryMonitor,
    pub visibility: Option<CallersVisibility>,
    /// Set by `visibility`.
    pub failed: Arc<AtomicBool>,
}

impl Request {
    /// # Safety
    /// As the text at the head of the header demands.
    pub unsafe fn read(info: *const patchlight_solve_info, surfaces: usize) -> Outcome<Self> {
        let failed = Arc::new(AtomicBool::new(false));
        if info.is_null() {
            let memory = MemoryMonitor { function: None, user: std::ptr::null_mut() };
            return Ok(Self { settings: Settings::default(), listener: Listener::NONE, memory, visibility: None, failed });
        }
        // SAFETY: The caller's promise.
        let info = unsafe { read_sized(info)? };
        let settings = if info.options.is_null() { Settings::default() } else { handles::get(info.options)?.settings() };
        settings.solve.validate()?;
        settings.run.validate()?;
        let listener = Listener { function: info.progress, user: info.progress_user };
        let memory = MemoryMonitor { function: info.memory, user: info.memory_user };
        // Last: once it is made, its data are released whatever happens.
        let visibility = if info.visibility.is_null() {
            None
        } else {
            // SAFETY: The caller's promise.
            let functions = unsafe { read_sized(info.visibility)? };
            let visibility = CallersVisibility::new(functions, surfaces, failed.clone());
            Some(visibility.ok_or_else(|| Ending::argument("a function of patchlight_visibility is NULL"))?)
        };
        Ok(Self { settings, listener, memory, visibility, failed })
    }
}

/// Solves a committed scene on the threads of a context. `info` may be NULL.
///
/// A solve that a limit ends, or that is cancelled, leaves a solution as well, and a status below PATCHLIGHT_INVALID_ARGUMENT says so.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn patchlight_solve(
    context: *mut patchlight_context,
    scene: *mut patchlight_scene,
    info: *const patchlight_solve_info,
    solution: *mut *mut patchlight_solution,
) -> patchlight_status {
    enter(|| {
        let context = handles::get(context)?;
        let scene = handles::get(scene)?.committed()?;
        // SAFETY: The contract of the header.
        let (out, request) = unsafe { (Out::new(solution, "solution")?, Request::read(info, scene.scene.surfaces().len())?) };
        let Request { settings: Settings { solve: options, run }, listener, memory, visibility, failed } = request;

        let watcher = Watcher::new(listener, &failed).asking(memory);
        let (workers, copy) = (context.workers.clone(), scene.scene.clone());
        let (evaluator, report) = match visibility {
            None => pipeline::solve_on(workers, copy, &options, &run, &watcher)?,
            Some(visibility) => pipeline::solve_asking_on(workers, Box::new(visibility), copy, &options, &run, &watcher)?,
        };
        check_answers(&failed)?;

        context.log(PATCHLIGHT_LOG_INFO, &told(&report));
        let (status, message) = ending(&report);
        let report = Report { json: json(&scene, &options, &report, context.workers.count()), solve: report, status };
        out.set(handles::create(Arc::new(Solution::new(context, evaluator, Known::Solved(Box::new(report)), failed))))?;
        if status == PATCHLIGHT_OK { Ok(()) } else { Err(Ending::new(status, message)) }
    })
}

/// Fails if a function of the caller's did.
pub fn check_answers(failed: &AtomicBool) -> Outcome {
    if !failed.load(Ordering::Relaxed) {
        return Ok(());
    }
    Err(Ending::new(PATCHLIGHT_CALLBACK_ERROR, "a visibility function failed, or gave an answer that cannot be"))
}

/// How a solve ended, and what to tell about it.
fn ending(report: &SolveReport) -> (patchlight_status, String) {
    let claim = format!("an error of {} is claimed, {} was asked for", report.claimed(), report.error.requested);
    match report.stopped_by {
        StoppedBy::Error => (PATCHLIGHT_OK, String::new()),
        StoppedBy::Exhausted if report.converged => (PATCHLIGHT_OK, String::new()),
        StoppedBy::MaxLinks => (PATCHLIGHT_LIMIT, format!("the limit on links ended the solve: {claim}")),
        StoppedBy::Time => (PATCHLIGHT_LIMIT, format!("the time limit ended the solve: {claim}")),
        StoppedBy::Exhausted => (PATCHLIGHT_LIMIT, format!("nothing more can be gained: {claim}")),
        StoppedBy::Memory => {
            (PATCHLIGHT_MEMORY_LIMIT, format!("the memory budget, or who was asked for more, ended the solve: {claim}"))
        }
        StoppedBy::Cancelled => (PATCHLIGHT_CANCELLED, "the progress function cancelled".to_owned()),
    }
}

/// What matters most.
fn told(report: &SolveReport) -> String {
    let (counts, error) = (&report.counts, &report.error);
    format!(
        "{}: {} elements, {} links, {} rays; error {} claimed, {} asked for",
        report.backend,
        counts.elements,
        counts.links,
        counts.rays,
        report.claimed(),
        error.requested
    )
}

/// The report as the program writes it; what only a program knows is missing.
fn json(scene: &Committed, options: &SolveOptions, report: &SolveReport, threads: usize) -> String {
    let provenance = Provenance::new(options);
    let mut run =
        RunReport::of_solve(provenance.software(), SceneReport::of(&scene.scene, scene.files.clone().into()), options, report);
    run.threads = threads;
    run.warnings.clone_from(&scene.warnings);
    run.warned_faces.clone_from(&scene.warned_faces);
    let mut text = Vec::new();
    // Writing to memory does not fail.
    let _ = write_report(&mut text, &run);
    String::from_utf8_lossy(&text).into_owned()
}
