//! What is in a committed scene.

use patchlight::visibility::OccluderMesh;

use super::object::patchlight_scene;
use crate::entry::enter;
use crate::handles;
use crate::memory::{Buffer, Out};
use crate::status::{Ending, patchlight_status};

/// A number that tells about a scene. Values may be added.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum patchlight_scene_figure {
    /// Channels.
    PATCHLIGHT_SCENE_CHANNELS = 1,
    /// Materials.
    PATCHLIGHT_SCENE_MATERIALS = 2,
    /// Surfaces: convex planar polygons with one side each.
    PATCHLIGHT_SCENE_SURFACES = 3,
    /// The area of all surfaces in m^2.
    PATCHLIGHT_SCENE_AREA = 4,
    /// Occluding triangles.
    PATCHLIGHT_SCENE_TRIANGLES = 5,
    /// Up to this distance from a triangle's plane an end of a segment counts as lying in it, in metres.
    PATCHLIGHT_SCENE_CONTACT_TOLERANCE = 6,
}

use patchlight_scene_figure::*;

/// A number that tells about a committed scene: `what` is a patchlight_scene_figure.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn patchlight_scene_get_figure(
    scene: *mut patchlight_scene,
    what: u32,
    figure: *mut f64,
) -> patchlight_status {
    enter(|| {
        let committed = handles::get(scene)?.committed()?;
        // SAFETY: The contract of the header.
        let out = unsafe { Out::new(figure, "figure")? };
        let scene = &committed.scene;
        out.set(match what {
            _ if what == PATCHLIGHT_SCENE_CHANNELS as u32 => scene.channels() as f64,
            _ if what == PATCHLIGHT_SCENE_MATERIALS as u32 => scene.materials().len() as f64,
            _ if what == PATCHLIGHT_SCENE_SURFACES as u32 => scene.surfaces().len() as f64,
            _ if what == PATCHLIGHT_SCENE_AREA as u32 => scene.surfaces().iter().map(|surface| surface.polygon.area()).sum(),
            _ if what == PATCHLIGHT_SCENE_TRIANGLES as u32 => OccluderMesh::of_scene(scene).triangles.len() as f64,
            _ if what == PATCHLIGHT_SCENE_CONTACT_TOLERANCE as u32 => OccluderMesh::of_scene(scene).contact_tolerance(),
            _ => return Err(Ending::argument(format_args!("what is {what}, which is no patchlight_scene_figure"))),
        })
    })
}

/// The occluding triangles of a committed scene, for a visibility backend of the caller's own: the positions of their corners in metres, nine
/// numbers each.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn patchlight_scene_triangles(
    scene: *mut patchlight_scene,
    positions: *mut f64,
    capacity: usize,
    count: *mut usize,
) -> patchlight_status {
    enter(|| {
        let committed = handles::get(scene)?.committed()?;
        // SAFETY: The contract of the header.
        let buffer = unsafe { Buffer::new(positions, capacity, count)? };
        let mesh = OccluderMesh::of_scene(&committed.scene);
        let corners = mesh.triangles.iter().flatten();
        buffer.fill(9 * mesh.triangles.len(), corners.flat_map(|&corner| mesh.vertices[corner as usize]))
    })
}

/// Surface and plane of each occluding triangle of a committed scene, two numbers each. Triangles in one plane have the same number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn patchlight_scene_triangle_planes(
    scene: *mut patchlight_scene,
    surfaces_and_planes: *mut u32,
    capacity: usize,
    count: *mut usize,
) -> patchlight_status {
    enter(|| {
        let committed = handles::get(scene)?.committed()?;
        // SAFETY: The contract of the header.
        let buffer = unsafe { Buffer::new(surfaces_and_planes, capacity, count)? };
        let mesh = OccluderMesh::of_scene(&committed.scene);
        let pairs = mesh.surfaces.iter().zip(&mesh.planes).flat_map(|(&surface, &plane)| [surface, plane]);
        buffer.fill(2 * mesh.triangles.len(), pairs)
    })
}
