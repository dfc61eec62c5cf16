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

use std::borrow::Cow;
use std::collections::{BTreeMap, HashMap, HashSet};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use glam::DVec3;

use super::mtl::{self, Libraries};
use super::statements::{Statement, decode, statements};
use super::{Diagnostic, DiagnosticKind, Diagnostics, ImportError};
use crate::scene::Material;

/// A face as it was read: three or more corners.
pub(super) struct Face {
    /// The 0-based number of the face in the file.
    pub number: u32,
    /// Index into the materials.
    pub material: u32,
    /// Its corners are `corners[start..end]` of [`ObjFile`].
    pub start: usize,
    /// See `start`.
    pub end: usize,
}

/// An OBJ file as it was read.
pub(super) struct ObjFile {
    /// The line of each face in the file, from 1.
    pub lines: Vec<u32>,
    /// How many vertices the file has.
    pub vertices: usize,
    /// The faces of three or more corners.
    pub faces: Vec<Face>,
    /// The corners of all faces.
    pub corners: Vec<DVec3>,
    /// The materials that faces index.
    pub materials: Vec<Material>,
}

/// What the first pass finds.
#[derive(Default)]
struct Structure<'a> {
    /// The vertices for tobj, one statement a line.
    vertices: String,
    vertex_lines: Vec<u32>,
    /// The faces for tobj, as resolved indices; faces of fewer than three corners are not among them.
    corners: Vec<u64>,
    faces: Vec<PreparedFace>,
    face_lines: Vec<u32>,
    libraries: Vec<(u32, String)>,
    /// Names in the order of their first use, each with the line of that.
    names: Vec<(Cow<'a, str>, u32)>,
    by_name: HashMap<String, usize>,
    nameless: (usize, u32, u32),
    weights: (usize, u32),
    ignored: BTreeMap<String, (usize, PathBuf, u32)>,
    unknown: BTreeMap<String, (usize, PathBuf, u32)>,
}

struct PreparedFace {
    number: u32,
    name: Option<usize>,
    end: usize,
}

/// Reads an OBJ file and its material libraries.
pub(super) fn read(file: &Path, diagnostics: &mut Diagnostics) -> Result<ObjFile, ImportError> {
    let bytes = super::read_regular_file(file).map_err(|reason| ImportError::Unreadable { file: file.to_owned(), reason })?;
    if bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff") {
        let reason = "the file is UTF-16; save it as UTF-8".to_owned();
        return Err(ImportError::Syntax { file: file.to_owned(), line: 1, face: None, reason });
    }
    let (text, latin1) = decode(&bytes);
    if latin1 {
        diagnostics.push(Diagnostic::new(DiagnosticKind::NotUtf8, "the file is not UTF-8, read as Latin-1").at(file, 0));
    }

    // Structure first, then the libraries that it names, then the values.
    let structure = read_structure(&text, file, diagnostics)?;
    let mut libraries = Libraries::default();
    let mut named = HashSet::new();
    for (line, argument) in &structure.libraries {
        for library in library_files(file, argument) {
            // Some exporters name the library again for every object.
            if named.insert(library.clone()) {
                libraries.read(&library, (file, *line), diagnostics)?;
            }
        }
    }
    read_values(structure, libraries, file, diagnostics)
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

/// The first pass: everything but the values of numbers.
fn read_structure<'a>(text: &'a str, file: &Path, diagnostics: &mut Diagnostics) -> Result<Structure<'a>, ImportError> {
    let mut structure = Structure::default();
    let mut name = None;
    let mut highest = (0, 0, 0);
    for statement in statements(text) {
        let line = statement.line;
        match &*statement.keyword {
            "v" => structure.vertex(&statement, file)?,
            "f" | "fo" => structure.face(&statement, name, &mut highest, file, diagnostics)?,
            "usemtl" => name = structure.name(statement),
            "mtllib" => structure.libraries.push((line, statement.arguments.into_owned())),
            // Names, smoothing, texture coordinates and normals: a planar polygon does not need them.
            "vn" | "vt" | "vp" | "g" | "o" | "s" | "mg" | "lod" | "usemap" | "maplib" | "bevel" | "c_interp" | "d_interp"
            | "shadow_obj" | "trace_obj" => {}
            key @ ("p" | "l" | "curv" | "curv2" | "surf") => mtl::count(&mut structure.ignored, key, file, line),
            // What belongs to curves and curved surfaces is mentioned with them.
            "parm" | "trim" | "hole" | "scrv" | "sp" | "end" | "con" | "cstype" | "deg" | "bmat" | "step" | "ctech" | "stech" => {}
            key => mtl::count(&mut structure.unknown, key, file, line),
        }
    }

    // A positive index may name a vertex further down, but not beyond the last one.
    let (index, line, face) = highest;
    if index > structure.vertex_lines.len() as u64 {
        let vertices = structure.vertex_lines.len();
        return Err(ImportError::IndexOutOfRange { file: file.to_owned(), line, face, index: index.to_string(), vertices });
    }
    Ok(structure)
}

impl<'a> Structure<'a> {
    /// `v x y z`, perhaps with a weight or a colour behind.
    fn vertex(&mut self, statement: &Statement<'_>, file: &Path) -> Result<(), ImportError> {
        let number = self.vertex_lines.len() + 1;
        let line = statement.line;
        let mut words = 0;
        self.vertices.push('v');
        for word in statement.arguments.split_whitespace() {
            // Only the letters are looked at here, tobj reads the number.
            let plain = word.bytes().all(|byte| matches!(byte, b'0'..=b'9' | b'+' | b'-' | b'.' | b'e' | b'E'));
            if !plain && mtl::is_not_a_number_word(word) {
                return Err(not_finite(file, line, number, word));
            }
            if !plain {
                return Err(bad_vertex(file, line, number, &statement.arguments));
            }
            // Without an exponent it takes more than thirty characters to be too large.
            let may_be_large = word.len() > 30 || word.contains(['e', 'E']);
            if may_be_large && word.parse::<f64>().is_ok() && !mtl::is_representable(word) {
                return Err(not_finite(file, line, number, word));
            }
            if words < 3 {
                self.vertices.push(' ');
                self.vertices.push_str(word);
            }
            if words == 3 && statement.arguments.split_whitespace().count() == 4 && word.parse::<f64>() != Ok(1.0) {
                self.weights = (self.weights.0 + 1, if self.weights.0 == 0 { line } else { self.weights.1 });
            }
            words += 1;
        }
        if words < 3 {
            return Err(bad_vertex(file, line, number, &statement.arguments));
        }
        self.vertices.push('\n');
        self.vertex_lines.push(line);
        Ok(())
    }

    /// `f v/vt/vn ...`: resolves the vertex index of each corner; `highest` keeps the highest index of all.
    fn face(
        &mut self,
        statement: &Statement<'_>,
        name: Option<usize>,
        highest: &mut (u64, u32, u32),
        file: &Path,
        diagnostics: &mut Diagnostics,
    ) -> Result<(), ImportError> {
        let line = statement.line;
        let number = self.face_lines.len() as u32;
        let defined = self.vertex_lines.len();
        let start = self.corners.len();
        self.face_lines.push(line);

        for word in statement.arguments.split_whitespace() {
            let mut parts = word.split('/');
            let index = parts.next().unwrap_or_default();
            if !is_integer(index) || word.split('/').count() > 3 || !parts.all(|part| part.is_empty() || is_integer(part)) {
                let reason = format!("'{word}' should be a vertex index, as in 7, -1, 7/1 or 7//1");
                return Err(ImportError::Syntax { file: file.to_owned(), line, face: Some(number + 1), reason });
            }
            // What is too long for a number is out of range all the more.
            let value = index.parse::<i64>().unwrap_or(0);
            let distance = value.unsigned_abs();
            if value > 0 {
                if distance > highest.0 {
                    *highest = (distance, line, number + 1);
                }
                self.corners.push(distance);
            } else if value < 0 && distance <= defined as u64 {
                self.corners.push(defined as u64 + 1 - distance);
            } else {
                let (file, index) = (file.to_owned(), index.to_owned());
                return Err(ImportError::IndexOutOfRange { file, line, face: number + 1, index, vertices: defined });
            }
        }

        // A point or a line has no area and goes no further.
        let corners = self.corners.len() - start;
        if corners < 3 {
            self.corners.truncate(start);
            let text = format!("dropped: it has {corners} corners");
            diagnostics.push(Diagnostic::new(DiagnosticKind::DegenerateFace, text).at(file, line).face(number + 1));
            return Ok(());
        }
        if name.is_none() {
            let (count, first_line, first_face) = self.nameless;
            self.nameless = if count == 0 { (1, line, number + 1) } else { (count + 1, first_line, first_face) };
        }
        self.faces.push(PreparedFace { number, name, end: self.corners.len() });
        Ok(())
    }

    /// `usemtl name`: the number of the name, `None` for no name.
    fn name(&mut self, statement: Statement<'a>) -> Option<usize> {
        if statement.arguments.is_empty() {
            return None;
        }
        if let Some(&index) = self.by_name.get(&*statement.arguments) {
            return Some(index);
        }
        let index = self.names.len();
        self.by_name.insert(statement.arguments.clone().into_owned(), index);
        self.names.push((statement.arguments, statement.line));
        Some(index)
    }
}

/// The second pass: tobj reads numbers, faces and materials from the prepared text.
fn read_values(
    mut structure: Structure<'_>,
    mut libraries: Libraries,
    file: &Path,
    diagnostics: &mut Diagnostics,
) -> Result<ObjFile, ImportError> {
    // Which material each name means; what no face uses is not looked up.
    let mut used = vec![false; structure.names.len()];
    for face in &structure.faces {
        if let Some(name) = face.name {
            used[name] = true;
        }
    }
    let mut material_of: Vec<u32> = Vec::with_capacity(used.len());
    for ((name, line), used) in structure.names.iter().zip(&used) {
        material_of.push(if *used { libraries.find_or_default(name, file, *line, diagnostics) } else { u32::MAX });
    }

    // The text for tobj. A face without a name stands before all others, where no material is set.
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

    let prepared = libraries.prepared();
    let (models, read_materials) =
        tobj::load_obj_buf(&mut text.as_bytes(), &tobj::LoadOptions::default(), |_| tobj::load_mtl_buf(&mut prepared.as_bytes()))
            .and_then(|(models, materials)| Ok((models, materials?)))
            .map_err(|error| locate(&text, &structure.vertex_lines, error, file))?;

    // Put the faces back into the order of the file.
    let (faces, corners) = collect_faces(&models, &structure, &order, file)?;

    let mut used = vec![false; read_materials.len()];
    for face in &faces {
        if face.material != u32::MAX {
            used[face.material as usize] = true;
        }
    }
    let mut materials = libraries.into_materials(&read_materials, &used, diagnostics)?;
    let mut obj =
        ObjFile { lines: structure.face_lines, vertices: structure.vertex_lines.len(), faces, corners, materials: vec![] };

    // Faces without a material share a grey one.
    if structure.nameless.0 > 0 {
        let grey = materials.len() as u32;
        materials.push(Material { name: String::new(), reflectance: vec![mtl::DEFAULT_REFLECTANCE; 3], exitance: vec![0.0; 3] });
        obj.faces.iter_mut().filter(|face| face.material == u32::MAX).for_each(|face| face.material = grey);
        let (count, line, face) = structure.nameless;
        let text = format!("{count} faces from here on have no material: grey {}", mtl::DEFAULT_REFLECTANCE);
        diagnostics.push(Diagnostic::new(DiagnosticKind::NoMaterial, text).at(file, line).face(face));
    }
    obj.materials = materials;

    note_left_out(&structure.ignored, &structure.unknown, structure.weights, file, diagnostics);
    Ok(obj)
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

fn is_integer(word: &str) -> bool {
    let digits = word.strip_prefix(['-', '+']).unwrap_or(word);
    !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_digit())
}

fn bad_vertex(file: &Path, line: u32, number: usize, arguments: &str) -> ImportError {
    let shown: String = arguments.chars().take(80).collect();
    let reason = format!("vertex {number} is '{shown}', but should be three numbers");
    ImportError::Syntax { file: file.to_owned(), line, face: None, reason }
}

fn not_finite(file: &Path, line: u32, number: usize, value: &str) -> ImportError {
    let what = format!("a coordinate of vertex {number}");
    ImportError::NotFinite { file: file.to_owned(), line, what, value: value.to_owned() }
}
