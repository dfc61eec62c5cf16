//! Pictures of a mesh, and meshes as files.

use std::ffi::c_char;
use std::path::Path;

use patchlight::output::{Destination, ExportFormat, Provenance, export_mesh};

use super::patchlight_mesh;
use crate::entry::enter;
use crate::handles;
use crate::memory::{Buffer, text};
use crate::solution::picture::{View, patchlight_camera};
use crate::status::patchlight_status;

/// Takes a picture of a mesh: as patchlight_solution_get_picture, but at once and without grain, since it only reads the mesh. The progress
/// function of the solution hears of it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn patchlight_mesh_get_picture(
    mesh: *mut patchlight_mesh,
    camera: *const patchlight_camera,
    radiance: *mut f32,
    capacity: usize,
    count: *mut usize,
) -> patchlight_status {
    enter(|| {
        let mesh = handles::get(mesh)?;
        let view = View { solution: &mesh.solution, mesh: Some(mesh.lit()?) };
        // SAFETY: The contract of the header.
        unsafe { view.get(camera, Buffer::new(radiance, capacity, count)?, None) }
    })
}

/// Takes a picture of a mesh and writes it, as patchlight_solution_write_picture does.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn patchlight_mesh_write_picture(
    mesh: *mut patchlight_mesh,
    camera: *const patchlight_camera,
    path: *const c_char,
) -> patchlight_status {
    enter(|| {
        let mesh = handles::get(mesh)?;
        // SAFETY: The contract of the header.
        unsafe { View { solution: &mesh.solution, mesh: Some(mesh.lit()?) }.write(camera, path) }
    })
}

/// Writes a mesh, `.ply`, `.glb` for viewers or `.vtp` for ParaView: four triangles for each element, with radiosities at their corners.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn patchlight_mesh_export(mesh: *mut patchlight_mesh, path: *const c_char) -> patchlight_status {
    enter(|| {
        let mesh = handles::get(mesh)?;
        // SAFETY: The contract of the header.
        let path = Path::new(unsafe { text(path, "path")? });
        let format = ExportFormat::of_path(path)?;
        let (lit, solution) = (mesh.lit()?, mesh.solution.evaluator.solution());
        let provenance = Provenance::new(solution.options());
        Destination::new(path)?.write(|file| export_mesh(file, format, solution, lit, &provenance))?;
        Ok(())
    })
}
