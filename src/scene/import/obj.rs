//! Wavefront OBJ: vertices, faces and the names of their materials.
//!
//! Materials are those of tobj. What the crate does with faces will not do: in version 4.0 it cannot say where something is wrong, and goes wrong itself:
//! - it panics or fails on texture and normal indices that this reader has no use for;
//! - it reads polylines `l` of three or more points as faces;
//! - it lets NaN and infinity through, and divides the coordinates by a fourth number, the weight of a curve's control point;
//! - it fails on comments behind values, on `\`, on bytes that are not UTF-8, on a tab behind `usemtl`, on colours of some vertices;
//! - a vertex may be used before it is defined, but only inside of one group;
//! - a material that is defined after its first use, or nowhere, is the same as none; one library that cannot be read is silently
//!   missing among others.
//!
//! So `structure` reads statements, in one pass, with their lines.

use std::collections::{BTreeMap, HashSet};
use std::path::{Path, PathBuf};

use glam::DVec3;

use super::faces::{Face, FaceFile};
use super::mtl::{self, Libraries, Maps};
use super::structure::{IndexedFace, Structure, read_structure};
use super::text::{decode, lies_below, read_regular_file};
use super::texture_coordinates::TextureCoordinates;
use super::textured::colour_faces;
use super::{Diagnostic, DiagnosticKind, Diagnostics, ImportError, ImportOptions};
use crate::progress::Stop;
use crate::scene::FileUv;

/// Reads an OBJ file with its material libraries and their textures: those beside or below it, or any.
pub(super) fn read(
    file: &Path,
    options: &ImportOptions,
    diagnostics: &mut Diagnostics,
    stop: Stop<'_>,
) -> Result<FaceFile, ImportError> {
    let bytes = read_regular_file(file).map_err(|reason| ImportError::Unreadable { file: file.to_owned(), reason })?;
    if bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff") {
        let reason = "the file is UTF-16; save it as UTF-8".to_owned();
        return Err(ImportError::Syntax { file: file.to_owned(), line: 1, face: None, reason });
    }
    let (text, latin1) = decode(&bytes);
    if latin1 {
        diagnostics.push(Diagnostic::new(DiagnosticKind::NotUtf8, "the file is not UTF-8, read as Latin-1").at(file, 0));
    }

    // What the file says, then the libraries that it names.
    let mut structure = read_structure(&text, file, diagnostics, stop)?;
    let mut libraries = Libraries::default();
    let mut named = HashSet::new();
    for (line, argument) in &structure.libraries {
        for library in library_files(file, argument) {
            // Some exporters name the library again for every object.
            if named.insert(library.clone()) {
                let is_allowed = options.allow_any_path || lies_below(&library, file);
                libraries.read(&library, is_allowed, (file, *line), diagnostics)?;
            }
        }
    }
    let coordinates = TextureCoordinates {
        vertices: std::mem::take(&mut structure.texture_vertices),
        corners: std::mem::take(&mut structure.texture_corners),
    };
    if stop() {
        return Err(ImportError::Cancelled);
    }
    let (mut read, maps) = with_materials(structure, libraries, file, diagnostics)?;
    colour_faces(&mut read, &maps, &coordinates, (file, options), diagnostics, stop)?;
    if options.keep_uv {
        read.uv = coordinates.uv_of(&read);
    }
    Ok(read)
}

/// The files of one `mtllib`: one name that may hold spaces, else several names.
fn library_files(scene: &Path, argument: &str) -> Vec<PathBuf> {
    let beside = |name: &str| scene.parent().unwrap_or(Path::new("")).join(name);
    let found = |name: &str| {
        // Some exporters write the separator of another system.
        [beside(name), beside(&name.replace('\\', "/"))].into_iter().find(|path| path.is_file())
    };
    match found(argument) {
        Some(path) => vec![path],
        None => argument.split_whitespace().map(|name| found(name).unwrap_or_else(|| beside(name))).collect(),
    }
}

/// Faces with their corners and materials; and the textures of each material.
fn with_materials(
    structure: Structure<'_>,
    mut libraries: Libraries,
    file: &Path,
    diagnostics: &mut Diagnostics,
) -> Result<(FaceFile, Vec<Maps>), ImportError> {
    let material_of = materials_of_names(&structure, &mut libraries, file, diagnostics)?;
    let (read_materials, _) = tobj::load_mtl_buf(&mut libraries.prepared().as_bytes()).map_err(|error| {
        let reason = format!("the reader of materials failed: {error}");
        ImportError::Syntax { file: file.to_owned(), line: 0, face: None, reason }
    })?;

    let corners: Vec<DVec3> = structure.corners.iter().map(|&number| structure.vertices[number as usize - 1]).collect();
    let (mut faces, mut start) = (Vec::with_capacity(structure.faces.len()), 0);
    for &IndexedFace { number, name, end } in &structure.faces {
        faces.push(Face { number, material: name.map_or(u32::MAX, |name| material_of[name]), start, end });
        start = end;
    }

    let mut used = vec![false; read_materials.len()];
    for face in &faces {
        if face.material != u32::MAX {
            used[face.material as usize] = true;
        }
    }
    let (files, maps) = (libraries.take_files(), libraries.maps());
    let mut materials = libraries.into_materials(&read_materials, &used, diagnostics)?;
    let mut obj = FaceFile {
        lines: structure.face_lines,
        vertices: structure.vertices.len(),
        faces,
        corners,
        materials: vec![],
        libraries: files,
        objects: structure.objects.finish(),
        groups: structure.groups.finish(),
        lights: Vec::new(),
        uv: FileUv::default(),
    };

    // Faces without a material share a grey one.
    if structure.nameless.0 > 0 {
        let grey = materials.len() as u32;
        materials.push(mtl::grey());
        obj.faces.iter_mut().filter(|face| face.material == u32::MAX).for_each(|face| face.material = grey);
        let (count, line, face) = structure.nameless;
        let text = format!("{count} faces from here on have no material: grey {}", mtl::DEFAULT_REFLECTANCE);
        diagnostics.push(Diagnostic::new(DiagnosticKind::NoMaterial, text).at(file, line).face(face));
    }
    obj.materials = materials;

    note_left_out(&structure.ignored, &structure.unknown, structure.weights, file, diagnostics);
    Ok((obj, maps))
}

/// Which material each name means; what no face uses is not looked up.
fn materials_of_names(
    structure: &Structure<'_>,
    libraries: &mut Libraries,
    file: &Path,
    diagnostics: &mut Diagnostics,
) -> Result<Vec<u32>, ImportError> {
    let mut used = vec![false; structure.names.len()];
    for name in structure.faces.iter().filter_map(|face| face.name) {
        used[name] = true;
    }
    let names = structure.names.iter().zip(&used);
    names
        .map(|((name, line), used)| if *used { libraries.find_or_default(name, file, *line, diagnostics) } else { Ok(u32::MAX) })
        .collect()
}

fn note_left_out(
    ignored: &BTreeMap<String, (usize, PathBuf, u32)>,
    unknown: &BTreeMap<String, (usize, PathBuf, u32)>,
    weights: (usize, u32),
    file: &Path,
    diagnostics: &mut Diagnostics,
) {
    for (kind, left_out, why) in [
        (DiagnosticKind::IgnoredElement, ignored, "left out: points, lines, curves and curved surfaces do not reflect light"),
        (DiagnosticKind::UnknownKeyword, unknown, "unknown and left out"),
    ] {
        for (key, (count, _, line)) in left_out {
            // A keyword of a binary file may be anything.
            let shown: String = key.chars().take(32).flat_map(char::escape_default).collect();
            let times = if *count == 1 { String::new() } else { format!(" ({count} times)") };
            diagnostics.push(Diagnostic::new(kind, format!("'{shown}'{times} is {why}")).at(file, *line));
        }
    }
    if weights.0 > 0 {
        let text = format!("the weights of {} vertices are left out: they have a meaning for curves only", weights.0);
        diagnostics.push(Diagnostic::new(DiagnosticKind::IgnoredProperty, text).at(file, weights.1));
    }
}
