//! Light at the vertices of faces, as binary little-endian PLY.
//!
//! Vertices (`double x y z`, in metres), each of one face, with their radiosity per channel in W/m^2, named as in [`write_ply`](super::write_ply). Faces are
//! polygons, with the number of their surface, and those of its origin as there.

use std::io::{self, Write};

use super::patches::Patches;
use super::values::radiosity_columns;
use super::{Provenance, Quantity, origin};

/// Writes patches.
pub(super) fn write(writer: &mut impl Write, patches: &Patches<'_>, provenance: &Provenance) -> io::Result<()> {
    if u32::try_from(patches.vertices.len()).is_err() {
        return Err(io::Error::other("more than 2^32 vertices do not fit into a PLY file"));
    }
    // Most readers want one byte for the length of a list; polygons with more than 255 corners need more.
    let is_wide = patches.iter().any(|(_, corners)| corners.len() > usize::from(u8::MAX));
    writeln!(writer, "ply\nformat binary_little_endian 1.0")?;
    for (key, text) in provenance.statements(Quantity::Radiosity) {
        writeln!(writer, "comment {key}: {text}")?;
    }
    origin::write_ply_comments(writer, patches.scene)?;
    writeln!(writer, "element vertex {}", patches.vertices.len())?;
    writeln!(writer, "property double x\nproperty double y\nproperty double z")?;
    for column in radiosity_columns(patches.scene.channels()) {
        writeln!(writer, "property float {column}")?;
    }
    writeln!(writer, "element face {}", patches.ends.len())?;
    writeln!(writer, "property list {} uint vertex_indices", if is_wide { "uint" } else { "uchar" })?;
    writeln!(writer, "property uint surface\n{}\nend_header", origin::PLY_PROPERTIES)?;

    for (number, vertex) in (0..).zip(&patches.vertices) {
        vertex.iter().try_for_each(|x| writer.write_all(&x.to_le_bytes()))?;
        patches.radiosity_at(number).iter().try_for_each(|b| writer.write_all(&b.to_le_bytes()))?;
    }
    for (surface, corners) in patches.iter() {
        let length = (corners.len() as u32).to_le_bytes();
        writer.write_all(if is_wide { &length } else { &length[..1] })?;
        corners.iter().try_for_each(|corner| writer.write_all(&corner.to_le_bytes()))?;
        writer.write_all(&surface.to_le_bytes())?;
        origin::write_ply_numbers(writer, patches.scene, surface)?;
    }
    Ok(())
}
