//! The lit scene in the format that a path asks for.

use std::io::{self, Write};

use super::patches::Patches;
use super::{ExportFormat, Provenance, glb, vertex_ply, vtp, write_mesh_ply, write_ply};
use crate::bake::VertexLight;
use crate::mesh::LitMesh;
use crate::solve::Solution;

/// Writes the elements of the solver.
///
/// # Errors
/// What the writer says; or that there is more than the format can number.
pub fn export_elements(
    writer: &mut impl Write,
    format: ExportFormat,
    solution: &Solution,
    provenance: &Provenance,
) -> io::Result<()> {
    match format {
        ExportFormat::Ply => write_ply(writer, solution, provenance),
        ExportFormat::Glb => glb::write(writer, &Patches::of_elements(solution), provenance),
        ExportFormat::Vtp => vtp::write(writer, &Patches::of_elements(solution), solution.leaf_bounds(), provenance),
    }
}

/// Writes light at vertices: faces with vertices of their own.
///
/// # Errors
/// As [`export_elements`].
pub fn export_vertex_light(
    writer: &mut impl Write,
    format: ExportFormat,
    solution: &Solution,
    light: &VertexLight,
    provenance: &Provenance,
) -> io::Result<()> {
    let patches = Patches::of_vertices(solution.scene(), light);
    match format {
        ExportFormat::Ply => vertex_ply::write(writer, &patches, provenance),
        ExportFormat::Glb => glb::write(writer, &patches, provenance),
        ExportFormat::Vtp => vtp::write(writer, &patches, None, provenance),
    }
}

/// Writes a lit mesh of a scene, each element as four triangles.
///
/// # Errors
/// As [`export_elements`].
pub fn export_mesh(
    writer: &mut impl Write,
    format: ExportFormat,
    solution: &Solution,
    mesh: &LitMesh,
    provenance: &Provenance,
) -> io::Result<()> {
    let scene = solution.scene();
    match format {
        ExportFormat::Ply => write_mesh_ply(writer, scene, mesh, provenance),
        ExportFormat::Glb => glb::write(writer, &Patches::of_mesh(scene, mesh), provenance),
        ExportFormat::Vtp => vtp::write(writer, &Patches::of_mesh(scene, mesh), None, provenance),
    }
}
