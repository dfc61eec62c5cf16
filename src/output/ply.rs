//! Polygons with float radiosities, as binary little-endian PLY.
//!
//! Vertices (`double x y z`, in metres) are shared where they are the same to the bit. Each leaf of the hierarchy is a face: its
//! vertex indices, the number of its surface, its radiosity per channel in W/m^2, named `B_r`, `B_g`, `B_b` for three channels,
//! else `B_0`, `B_1`, ..., and the numbers of its face in the input, material, object and group, from 0, -1 where there is none. Comment lines state
//! software, quantity, unit and options, and the names of materials, objects and groups.

use std::collections::HashMap;
use std::io::{self, Write};

use super::values::radiosity_columns;
use super::{Provenance, Quantity, origin};
use crate::solve::Solution;

/// Writes the leaves of `solution`.
///
/// # Errors
/// What the writer says.
pub fn write_ply(writer: &mut impl Write, solution: &Solution, provenance: &Provenance) -> io::Result<()> {
    // The header needs the counts: number the vertices first, in the order in which the leaves bring them.
    let mut numbers: HashMap<[u64; 3], u32> = HashMap::new();
    let mut vertices: Vec<[f64; 3]> = Vec::new();
    let (mut faces, mut most_corners) = (0_u64, 0);
    solution.for_each_leaf(|polygon, _, _| {
        faces += 1;
        most_corners = most_corners.max(polygon.len());
        for &vertex in polygon {
            numbers.entry(vertex.map(f64::to_bits)).or_insert_with(|| {
                vertices.push(vertex);
                vertices.len() as u32 - 1
            });
        }
    });
    if u32::try_from(vertices.len()).is_err() {
        return Err(io::Error::other("more than 2^32 vertices do not fit into a PLY file"));
    }

    // Most readers want one byte for the length of a list; polygons with more than 255 corners need more.
    let wide = most_corners > usize::from(u8::MAX);
    writeln!(writer, "ply\nformat binary_little_endian 1.0")?;
    for (key, text) in provenance.statements(Quantity::Radiosity) {
        writeln!(writer, "comment {key}: {text}")?;
    }
    origin::write_ply_comments(writer, solution.scene())?;
    writeln!(writer, "element vertex {}", vertices.len())?;
    writeln!(writer, "property double x\nproperty double y\nproperty double z")?;
    writeln!(writer, "element face {faces}")?;
    writeln!(writer, "property list {} uint vertex_indices", if wide { "uint" } else { "uchar" })?;
    writeln!(writer, "property uint surface")?;
    for column in radiosity_columns(solution.scene().channels()) {
        writeln!(writer, "property float {column}")?;
    }
    writeln!(writer, "{}\nend_header", origin::PLY_PROPERTIES)?;

    for coordinate in vertices.iter().flatten() {
        writer.write_all(&coordinate.to_le_bytes())?;
    }
    let mut result = Ok(());
    let mut face = Vec::new();
    solution.for_each_leaf(|polygon, surface, radiosity| {
        if result.is_err() {
            return;
        }
        face.clear();
        if wide {
            face.extend((polygon.len() as u32).to_le_bytes());
        } else {
            face.push(polygon.len() as u8);
        }
        for vertex in polygon {
            face.extend(numbers[&vertex.map(f64::to_bits)].to_le_bytes());
        }
        face.extend(surface.to_le_bytes());
        radiosity.iter().for_each(|b| face.extend(b.to_le_bytes()));
        result = writer.write_all(&face).and_then(|()| origin::write_ply_numbers(writer, solution.scene(), surface));
    });
    result
}
