//! Solutions as files.

use std::ffi::c_char;
use std::path::Path;
use std::sync::Arc;

use patchlight::output::{Destination, ExportFormat, Provenance, export_elements, read_solution, write_solution};
use patchlight::pipeline::Evaluator;

use super::{Known, Solution, patchlight_solution};
use crate::context::patchlight_context;
use crate::entry::enter;
use crate::handles;
use crate::memory::{Out, text};
use crate::solve::{Request, check_answers, patchlight_solve_info};
use crate::status::patchlight_status;

/// Writes a solution, to be read by patchlight_solution_load and by the program. A file that is there is replaced by a complete one.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn patchlight_solution_save(solution: *mut patchlight_solution, path: *const c_char) -> patchlight_status {
    enter(|| {
        let solution = handles::get(solution)?;
        // SAFETY: The contract of the header.
        let destination = Destination::new(Path::new(unsafe { text(path, "path")? }))?;
        let lit = solution.evaluator.solution();
        destination.write(|file| write_solution(file, lit, &Provenance::new(lit.options())))?;
        Ok(())
    })
}

/// Writes the elements of a solution with their radiosities: `.ply`, `.glb` for viewers or `.vtp` for ParaView.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn patchlight_solution_export(solution: *mut patchlight_solution, path: *const c_char) -> patchlight_status {
    enter(|| {
        let solution = handles::get(solution)?;
        // SAFETY: The contract of the header.
        let path = Path::new(unsafe { text(path, "path")? });
        let format = ExportFormat::of_path(path)?;
        let lit = solution.evaluator.solution();
        let provenance = Provenance::new(lit.options());
        Destination::new(path)?.write(|file| export_elements(file, format, lit, &provenance))?;
        Ok(())
    })
}

/// Reads a solution that this version wrote. Of `info`, which may be NULL, the backend counts, or the visibility. Nothing in the file is
/// trusted before it is checked.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn patchlight_solution_load(
    context: *mut patchlight_context,
    path: *const c_char,
    info: *const patchlight_solve_info,
    solution: *mut *mut patchlight_solution,
) -> patchlight_status {
    enter(|| {
        let context = handles::get(context)?;
        // SAFETY: The contract of the header.
        let (out, path) = unsafe { (Out::new(solution, "solution")?, Path::new(text(path, "path")?)) };
        let lit = context.workers.install(|| read_solution(path))?;
        // SAFETY: The contract of the header.
        let Request { settings, visibility, failed, .. } = unsafe { Request::read(info, lit.scene().surfaces().len())? };
        let workers = context.workers.clone();
        let evaluator = match visibility {
            None => Evaluator::new_on(workers, lit, settings.run.backend)?,
            Some(visibility) => Evaluator::asking_on(workers, Box::new(visibility), lit),
        };
        check_answers(&failed)?;
        out.set(handles::create(Arc::new(Solution::new(context, evaluator, Known::Nothing, failed))))
    })
}
