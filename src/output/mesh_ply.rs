//! A lit mesh with float radiosities, as binary little-endian PLY.
//!
//! Vertices (`double x y z`, in metres) carry their radiosity per channel in W/m^2, named as in [`write_ply`](super::write_ply). Each quadratic element is
//! four triangles between its six nodes, with the number of their surface.

use std::collections::HashMap;
use std::io::{self, Write};

use super::values::radiosity_columns;
use super::{Provenance, Quantity};
use crate::mesh::LitMesh;
use crate::scene::Scene;

/// The triangles of an element, by its nodes: three corners, then the middles of the edges from each.
const PARTS: [[usize; 3]; 4] = [[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]];

/// Writes a lit mesh of a scene.
///
/// # Errors
/// What the writer says.
pub fn write_mesh_ply(writer: &mut impl Write, scene: &Scene, mesh: &LitMesh, provenance: &Provenance) -> io::Result<()> {
    // A vertex for each place with its light.
    let mut numbers: HashMap<Vec<u64>, u32> = HashMap::new();
    let (mut vertices, mut faces) = (Vec::new(), Vec::new());
    let channels = scene.channels();
    mesh.for_each_element(scene, |surface, nodes, radiosity| {
        let mut vertex = |node: usize| {
            let (at, light) = (nodes[node], &radiosity[node * channels..][..channels]);
            let key = at.iter().map(|x| x.to_bits()).chain(light.iter().map(|b| u64::from(b.to_bits()))).collect();
            *numbers.entry(key).or_insert_with(|| {
                vertices.extend(at.iter().flat_map(|x| x.to_le_bytes()));
                vertices.extend(light.iter().flat_map(|b| b.to_le_bytes()));
                (vertices.len() / (24 + 4 * channels)) as u32 - 1
            })
        };
        let own: [u32; 6] = std::array::from_fn(&mut vertex);
        for part in PARTS {
            faces.push(3);
            part.iter().for_each(|&node| faces.extend(own[node].to_le_bytes()));
            faces.extend(surface.to_le_bytes());
        }
    });

    writeln!(writer, "ply\nformat binary_little_endian 1.0")?;
    for (key, text) in provenance.statements(Quantity::Radiosity) {
        writeln!(writer, "comment {key}: {text}")?;
    }
    writeln!(writer, "element vertex {}", numbers.len())?;
    writeln!(writer, "property double x\nproperty double y\nproperty double z")?;
    for column in radiosity_columns(channels) {
        writeln!(writer, "property float {column}")?;
    }
    writeln!(writer, "element face {}", PARTS.len() * mesh.elements())?;
    writeln!(writer, "property list uchar uint vertex_indices\nproperty uint surface\nend_header")?;
    writer.write_all(&vertices)?;
    writer.write_all(&faces)
}
