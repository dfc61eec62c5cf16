//! Lit meshes: the answer as a function on the surfaces.

pub mod files;
pub mod read;

use std::sync::Arc;

use patchlight::mesh::LitMesh;
use patchlight::solve::SolveOptions;

use crate::entry::enter;
use crate::handles::{self, Handle};
use crate::memory::Out;
use crate::observer::Watcher;
use crate::solution::{Solution, cancelled, patchlight_solution};
use crate::solve::check_answers;
use crate::status::{Ending, Outcome, PATCHLIGHT_LIMIT, PATCHLIGHT_NOT_AVAILABLE, patchlight_status};

/// Radiosity as a function on the surfaces: elements with six nodes each, between which it is quadratic. Unchangeable; may be read by many
/// threads. Keeps the solution that it is of.
pub struct patchlight_mesh {
    _private: [u8; 0],
}

impl Handle for patchlight_mesh {
    type Target = Mesh;
    const NAME: &'static str = "mesh";
}

/// Behind a handle.
pub struct Mesh {
    solution: Arc<Solution>,
    /// Unless it is the solution's own.
    made: Option<LitMesh>,
}

impl Mesh {
    fn lit(&self) -> Outcome<&LitMesh> {
        let message = "this solution has no mesh: set the option lit_mesh to true, or make one";
        let missing = || Ending::new(PATCHLIGHT_NOT_AVAILABLE, message);
        self.made.as_ref().or_else(|| self.solution.evaluator.mesh()).ok_or_else(missing)
    }
}

/// A number that tells about a mesh. Values may be added.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum patchlight_mesh_figure {
    /// Channels.
    PATCHLIGHT_MESH_CHANNELS = 1,
    /// Nodes.
    PATCHLIGHT_MESH_NODE_COUNT = 2,
    /// Elements.
    PATCHLIGHT_MESH_ELEMENT_COUNT = 3,
    /// How far the mesh is off the values at points, relative to these: measured at points that had no part in making it.
    PATCHLIGHT_MESH_MEASURED = 4,
    /// An upper confidence limit of that. What the values are off the truth comes on top: the whole is the root of both squares.
    PATCHLIGHT_MESH_CLAIMED = 5,
}

use patchlight_mesh_figure::*;

/// The mesh of a solution, as it was solved or loaded. PATCHLIGHT_NOT_AVAILABLE if it has none: they come with the option `lit_mesh`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn patchlight_solution_get_mesh(
    solution: *mut patchlight_solution,
    mesh: *mut *mut patchlight_mesh,
) -> patchlight_status {
    enter(|| {
        let solution = handles::get(solution)?;
        // SAFETY: The contract of the header.
        let out = unsafe { Out::new(mesh, "mesh")? };
        let mesh = Mesh { solution, made: None };
        mesh.lit()?;
        out.set(handles::create(Arc::new(mesh)))
    })
}

/// Makes a mesh, whether the solution has one or not, that is off the values at points by no more than `error`, above 0 and below 1. The progress function of the solution hears how
/// far it is, and may cancel. PATCHLIGHT_LIMIT if less cannot be claimed than what PATCHLIGHT_MESH_CLAIMED tells: there is a mesh.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn patchlight_solution_make_mesh(
    solution: *mut patchlight_solution,
    error: f64,
    mesh: *mut *mut patchlight_mesh,
) -> patchlight_status {
    enter(|| {
        let solution = handles::get(solution)?;
        // SAFETY: The contract of the header.
        let out = unsafe { Out::new(mesh, "mesh")? };
        SolveOptions { error, ..SolveOptions::default() }.validate()?;
        let watcher = Watcher::new(solution.listener(), &solution.failed);
        let made = solution.evaluator.lit_mesh(error, &watcher);
        check_answers(&solution.failed)?;
        let made = made.ok_or_else(cancelled)?;

        let claimed = made.claimed;
        out.set(handles::create(Arc::new(Mesh { solution, made: Some(made) })))?;
        if claimed <= error {
            return Ok(());
        }
        let message = format!("nothing more can be gained: an error of {claimed} is claimed, {error} was asked for");
        Err(Ending::new(PATCHLIGHT_LIMIT, message))
    })
}

/// One more patchlight_mesh_release is needed.
#[unsafe(no_mangle)]
pub extern "C" fn patchlight_mesh_retain(mesh: *mut patchlight_mesh) -> patchlight_status {
    enter(|| handles::retain(mesh))
}

/// Lets a mesh go. NULL is let go by.
#[unsafe(no_mangle)]
pub extern "C" fn patchlight_mesh_release(mesh: *mut patchlight_mesh) -> patchlight_status {
    enter(|| handles::release(mesh))
}

/// A number that tells about a mesh: `what` is a patchlight_mesh_figure.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn patchlight_mesh_get_figure(mesh: *mut patchlight_mesh, what: u32, figure: *mut f64) -> patchlight_status {
    enter(|| {
        let mesh = handles::get(mesh)?;
        // SAFETY: The contract of the header.
        let out = unsafe { Out::new(figure, "figure")? };
        let lit = mesh.lit()?;
        out.set(match what {
            _ if what == PATCHLIGHT_MESH_CHANNELS as u32 => mesh.solution.evaluator.solution().scene().channels() as f64,
            _ if what == PATCHLIGHT_MESH_NODE_COUNT as u32 => lit.nodes() as f64,
            _ if what == PATCHLIGHT_MESH_ELEMENT_COUNT as u32 => lit.elements() as f64,
            _ if what == PATCHLIGHT_MESH_MEASURED as u32 => lit.measured,
            _ if what == PATCHLIGHT_MESH_CLAIMED as u32 => lit.claimed,
            _ => return Outcome::Err(Ending::argument(format_args!("what is {what}, which is no patchlight_mesh_figure"))),
        })
    })
}
