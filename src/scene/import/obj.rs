//! Wavefront OBJ: vertices, faces and the names of their materials.
//!
//! tobj reads numbers, faces and materials. It cannot say where something is wrong, and in version 4.0 it goes wrong itself:
//! - it panics or fails on texture and normal indices that this reader has no use for;
//! - it reads polylines `l` of three or more points as faces;
//! - it lets NaN and infinity through, and divides the coordinates by a fourth number, the weight of a curve's control point;
//! - it fails on comments behind values, on `\`, on bytes that are not UTF-8, on a tab behind `usemtl`, on colours of some vertices;
//! - a vertex may be used before it is defined, but only inside of one group;
//! - a material that is defined after its first use, or nowhere, is the same as none; one library that cannot be read is silently
//!   missing among others.
//!
//! So this pass first reads the structure (statements, vertex counts, indices, names, with their lines), and gives tobj a text of
//! `v`, `f` and `usemtl` alone, in which nothing can be misunderstood. Cost: one pass over the file and a copy of its vertices and faces.

use std::collections::{BTreeMap, HashSet};
use std::fmt::Write as _;
use std::io::{self, BufRead, Read};
use std::path::{Path, PathBuf};

use glam::DVec3;

use super::faces::{Face, FaceFile};
use super::mtl::{self, Libraries, Maps};
use super::structure::{Structure, bad_vertex, read_structure};
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

    // Structure first, then the libraries that it names, then the values.
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
    let (mut read, maps) = read_values(structure, libraries, file, diagnostics, stop)?;
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

/// A text that cannot be read any more once it is to stop.
struct Stoppable<'a> {
    text: &'a [u8],
    stop: Stop<'a>,
}

/// Bytes that are read between two questions whether to stop.
const READ_AT_ONCE: usize = 1 << 16;

impl Read for Stoppable<'_> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        self.text.read(into)
    }
}

impl BufRead for Stoppable<'_> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        if (self.stop)() {
            return Err(io::ErrorKind::TimedOut.into());
        }
        Ok(&self.text[..self.text.len().min(READ_AT_ONCE)])
    }

    fn consume(&mut self, bytes: usize) {
        self.text.consume(bytes);
    }
}

/// The second pass: tobj reads numbers, faces and materials from the prepared text. With the textures of each material.
fn read_values(
    mut structure: Structure<'_>,
    mut libraries: Libraries,
    file: &Path,
    diagnostics: &mut Diagnostics,
    stop: Stop<'_>,
) -> Result<(FaceFile, Vec<Maps>), ImportError> {
    let material_of = materials_of_names(&structure, &mut libraries, file, diagnostics)?;
    let (text, order) = prepared_text(&mut structure, &material_of);
    let prepared = libraries.prepared();
    let (models, read_materials) =
        tobj::load_obj_buf(&mut Stoppable { text: text.as_bytes(), stop }, &tobj::LoadOptions::default(), |_| {
            tobj::load_mtl_buf(&mut prepared.as_bytes())
        })
        .and_then(|(models, materials)| Ok((models, materials?)))
        .map_err(|error| if stop() { ImportError::Cancelled } else { locate(&text, &structure.vertex_lines, error, file) })?;

    // Put the faces back into the order of the file.
    let (faces, corners) = collect_faces(&models, &structure, &order, file)?;

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
        vertices: structure.vertex_lines.len(),
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

/// The text for tobj, and the order of the faces in it: one without a name stands before all others, where no material is set.
fn prepared_text(structure: &mut Structure<'_>, material_of: &[u32]) -> (String, Vec<usize>) {
    let mut text = std::mem::take(&mut structure.vertices);
    text.push_str("mtllib prepared\n");
    let mut order: Vec<usize> = Vec::with_capacity(structure.faces.len());
    order.extend((0..structure.faces.len()).filter(|&k| structure.faces[k].name.is_none()));
    order.extend((0..structure.faces.len()).filter(|&k| structure.faces[k].name.is_some()));
    let start_of = |k: usize| if k == 0 { 0 } else { structure.faces[k - 1].end };
    let mut current = None;
    for &k in &order {
        let face = &structure.faces[k];
        if face.name != current {
            current = face.name;
            let _ = writeln!(text, "usemtl m{}", face.name.map_or(0, |name| material_of[name]));
        }
        text.push('f');
        for corner in &structure.corners[start_of(k)..face.end] {
            let _ = write!(text, " {corner}");
        }
        text.push('\n');
    }
    (text, order)
}

/// The faces that tobj returned, in the order of the file, and their corners.
fn collect_faces(
    models: &[tobj::Model],
    structure: &Structure<'_>,
    order: &[usize],
    file: &Path,
) -> Result<(Vec<Face>, Vec<DVec3>), ImportError> {
    let unreadable = || ImportError::Syntax {
        file: file.to_owned(),
        line: 0,
        face: None,
        reason: "the reader lost faces; please report this with the file".to_owned(),
    };

    // Where each face of the file lies in the models.
    let mut places = vec![(0_u32, 0_usize, 0_usize); structure.faces.len()];
    let mut next = order.iter();
    for (index, model) in models.iter().enumerate() {
        let mesh = &model.mesh;
        // tobj leaves the arities out where all are triangles.
        let count = if mesh.face_arities.is_empty() { mesh.indices.len() / 3 } else { mesh.face_arities.len() };
        let mut start = 0;
        for k in 0..count {
            let end = start + mesh.face_arities.get(k).map_or(3, |&arity| arity as usize);
            places[*next.next().ok_or_else(unreadable)?] = (index as u32, start, end);
            start = end;
        }
    }
    if next.next().is_some() {
        return Err(unreadable());
    }

    let mut corners = Vec::with_capacity(structure.corners.len());
    let mut faces = Vec::with_capacity(structure.faces.len());
    for (source, &(model, start, end)) in structure.faces.iter().zip(&places) {
        let mesh = &models[model as usize].mesh;
        let first = corners.len();
        for &index in &mesh.indices[start..end] {
            let at = 3 * index as usize;
            corners.push(DVec3::from_slice(mesh.positions.get(at..at + 3).ok_or_else(unreadable)?));
        }
        let material = match source.name {
            Some(_) => mesh.material_id.ok_or_else(unreadable)? as u32,
            None => u32::MAX,
        };
        faces.push(Face { number: source.number, material, start: first, end: corners.len() });
    }
    Ok((faces, corners))
}

/// Finds the vertex that tobj could not read, which is the only thing that can be wrong with the prepared text.
fn locate(text: &str, vertex_lines: &[u32], error: tobj::LoadError, file: &Path) -> ImportError {
    for (index, (vertex, &line)) in text.lines().zip(vertex_lines).enumerate() {
        let numbers = vertex.trim_start_matches('v');
        if numbers.split_whitespace().any(|word| word.parse::<f64>().is_err()) {
            return bad_vertex(file, line, index + 1, numbers.trim());
        }
    }
    ImportError::Syntax { file: file.to_owned(), line: 0, face: None, reason: format!("the reader failed: {error}") }
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
