//! Arrays of a mesh, and values at points.

use std::iter::repeat_n;

use super::patchlight_mesh;
use crate::array::patchlight_array;
use crate::entry::enter;
use crate::handles;
use crate::memory::Out;
use crate::observer::Watcher;
use crate::solution::cancelled;
use crate::solution::values::points;
use crate::status::{Ending, patchlight_status};
use crate::target::{Components, Target, patchlight_buffer};

/// What an array of a mesh holds. Values may be added.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum patchlight_mesh_array {
    /// For each node its position, three coordinates in metres. Elements of one surface share nodes, but where light may have a step.
    PATCHLIGHT_MESH_POSITIONS = 1,
    /// For each node its radiosity in W/m^2, by channel.
    PATCHLIGHT_MESH_RADIOSITY = 2,
    /// For each element its six nodes, by their places in the arrays of nodes: three corners, counter-clockwise from the front, then the
    /// middles of the edges from the first to the second, from that to the third, and back.
    PATCHLIGHT_MESH_ELEMENT_NODES = 3,
    /// For each element the surface that it lies on.
    PATCHLIGHT_MESH_ELEMENT_SURFACE = 4,
    /// For each element the standard error of what is read there, in W/m^2, all channels together: the root of the sum of their squares, in the mean
    /// over the element. NaN where it is not known, as with other weights of light groups.
    PATCHLIGHT_MESH_ELEMENT_ERROR = 5,
}

use patchlight_mesh_array::*;

/// Writes an array of a mesh: `what` is a patchlight_mesh_array. Without a buffer only the count of items is told.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn patchlight_mesh_get_array(
    mesh: *mut patchlight_mesh,
    what: u32,
    buffer: *const patchlight_buffer,
    count: *mut usize,
) -> patchlight_status {
    enter(|| {
        let mesh = handles::get(mesh)?;
        let (lit, scene) = (mesh.lit()?, mesh.solution.evaluator.solution().scene());
        let (items, components) = match what {
            _ if what == PATCHLIGHT_MESH_POSITIONS as u32 => (lit.nodes(), Components::Reals(3)),
            _ if what == PATCHLIGHT_MESH_RADIOSITY as u32 => (lit.nodes(), Components::Reals(scene.channels())),
            _ if what == PATCHLIGHT_MESH_ELEMENT_NODES as u32 => (lit.elements(), Components::Wholes(6)),
            _ if what == PATCHLIGHT_MESH_ELEMENT_SURFACE as u32 => (lit.elements(), Components::Wholes(1)),
            _ if what == PATCHLIGHT_MESH_ELEMENT_ERROR as u32 => (lit.elements(), Components::Reals(1)),
            _ => return Err(Ending::argument(format_args!("what is {what}, which is no patchlight_mesh_array"))),
        };
        // SAFETY: The contract of the header.
        let Some(target) = (unsafe { Target::new(buffer, count, items, components)? }) else { return Ok(()) };
        let parts = lit.parts(scene);
        match what {
            _ if what == PATCHLIGHT_MESH_POSITIONS as u32 => target.write_reals(parts.flat_map(|part| part.nodes).flatten()),
            _ if what == PATCHLIGHT_MESH_RADIOSITY as u32 => {
                target.write_reals(parts.flat_map(|part| part.radiosity).map(f64::from));
            }
            _ if what == PATCHLIGHT_MESH_ELEMENT_NODES as u32 => target.write_wholes(lit.element_nodes().flatten()),
            _ if what == PATCHLIGHT_MESH_ELEMENT_ERROR as u32 => {
                target.write_reals(parts.flat_map(|part| part.standard_errors).map(f64::from));
            }
            _ => target.write_wholes(parts.flat_map(|part| repeat_n(part.surface, part.elements.len()))),
        }
        Ok(())
    })
}

/// Reads a mesh at points that lie on surfaces, with the normals of the sides that are looked at: radiosities in W/m^2 by channel, an item for
/// each point, NaN where it lies on no surface. `missed` says how many do; it may be NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn patchlight_mesh_get_values(
    mesh: *mut patchlight_mesh,
    positions: *const patchlight_array,
    normals: *const patchlight_array,
    radiosity: *const patchlight_buffer,
    missed: *mut usize,
) -> patchlight_status {
    enter(|| {
        let mesh = handles::get(mesh)?;
        let evaluator = &mesh.solution.evaluator;
        let channels = evaluator.solution().scene().channels();
        let mut count = 0;
        // SAFETY: The contract of the header; `count` lives on.
        let (points, target) = unsafe {
            let points = points(positions, normals)?;
            let target = Target::new(radiosity, &raw mut count, points.len(), Components::Reals(channels))?;
            (points, target.ok_or_else(|| Ending::argument("radiosity is NULL"))?)
        };
        let watcher = Watcher::new(mesh.solution.listener(), &mesh.solution.failed);
        let values = evaluator.values_of_mesh_observed(mesh.lit()?, &points, &watcher).ok_or_else(cancelled)?;
        let off = values.chunks_exact(channels).filter(|value| value[0].is_nan()).count();
        target.write_reals(values.into_iter().map(f64::from));
        if missed.is_null() {
            return Ok(());
        }
        // SAFETY: The contract of the header.
        unsafe { Out::new(missed, "missed")? }.set(off)
    })
}
