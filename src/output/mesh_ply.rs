//! A lit mesh with float radiosities, as binary little-endian PLY.
//!
//! Vertices (`double x y z`, in metres) are the nodes, surface after surface, with their radiosity per channel in W/m^2, named as in
//! [`write_ply`](super::write_ply). Faces, with the number of their surface and those of its origin as there, are the elements as they are, or four triangles
//! for each.

use std::io::{self, Write};

use super::values::radiosity_columns;
use super::{Provenance, Quantity, origin};
use crate::mesh::LitMesh;
use crate::scene::Scene;

/// Writes a lit mesh of a scene, each element as four triangles: for readers that know flat faces alone.
///
/// # Errors
/// What the writer says; or that there are more nodes than the format can number.
pub fn write_mesh_ply(writer: &mut impl Write, scene: &Scene, mesh: &LitMesh, provenance: &Provenance) -> io::Result<()> {
    write_faces(writer, scene, mesh, &[&[0, 3, 5], &[3, 1, 4], &[5, 4, 2], &[3, 4, 5]], provenance)
}

/// Writes a lit mesh of a scene, each element as one face of six vertices, counter-clockwise around it: every second one, from the first on, is a
/// corner, the next is the middle of the edge from there. In between the radiosity is the quadratic function through all six.
///
/// # Errors
/// As [`write_mesh_ply`].
pub fn write_quadratic_mesh_ply(writer: &mut impl Write, scene: &Scene, mesh: &LitMesh, provenance: &Provenance) -> io::Result<()> {
    write_faces(writer, scene, mesh, &[&[0, 3, 1, 4, 2, 5]], provenance)
}

/// Writes each element as some faces, given by its nodes: three corners, then the middles of the edges from each.
fn write_faces(
    writer: &mut impl Write,
    scene: &Scene,
    mesh: &LitMesh,
    of_element: &[&[usize]],
    provenance: &Provenance,
) -> io::Result<()> {
    if u32::try_from(mesh.nodes()).is_err() {
        return Err(io::Error::other("more than 2^32 vertices do not fit into a PLY file"));
    }
    writeln!(writer, "ply\nformat binary_little_endian 1.0")?;
    for (key, text) in provenance.statements(Quantity::Radiosity) {
        writeln!(writer, "comment {key}: {text}")?;
    }
    origin::write_ply_comments(writer, scene)?;
    writeln!(writer, "element vertex {}", mesh.nodes())?;
    writeln!(writer, "property double x\nproperty double y\nproperty double z")?;
    let channels = scene.channels();
    for column in radiosity_columns(channels) {
        writeln!(writer, "property float {column}")?;
    }
    writeln!(writer, "element face {}", of_element.len() * mesh.elements())?;
    writeln!(writer, "property list uchar uint vertex_indices\nproperty uint surface\n{}\nend_header", origin::PLY_PROPERTIES)?;

    for part in mesh.parts(scene) {
        for (node, radiosity) in part.nodes.iter().zip(part.radiosity.chunks(channels)) {
            node.iter().try_for_each(|x| writer.write_all(&x.to_le_bytes()))?;
            radiosity.iter().try_for_each(|b| writer.write_all(&b.to_le_bytes()))?;
        }
    }
    let mut first = 0;
    for part in mesh.parts(scene) {
        for (element, face) in part.elements.iter().flat_map(|element| of_element.iter().map(move |face| (element, face))) {
            writer.write_all(&[face.len() as u8])?;
            face.iter().try_for_each(|&node| writer.write_all(&(first + element[node]).to_le_bytes()))?;
            writer.write_all(&part.surface.to_le_bytes())?;
            origin::write_ply_numbers(writer, scene, part.surface)?;
        }
        first += part.nodes.len() as u32;
    }
    Ok(())
}
