//! What an OBJ file says: vertices, faces by their indices, and names, with their lines; see `obj`.

use std::borrow::Cow;
use std::collections::{BTreeMap, HashMap};
use std::path::{Path, PathBuf};

use glam::DVec3;

use super::mtl;
use super::names::NamesReader;
use super::statements::{Statement, statements};
use super::{Diagnostic, DiagnosticKind, Diagnostics, ImportError};
use crate::progress::Stop;

/// What a file says.
#[derive(Default)]
pub(super) struct Structure<'a> {
    pub vertices: Vec<DVec3>,
    /// The vertices of faces, from 1, each in range once all is read; faces of fewer than three corners are not among them.
    pub corners: Vec<u64>,
    /// Where each of these corners lies in its texture: an index into `texture_vertices`, or one that is none.
    pub texture_corners: Vec<u32>,
    /// Texture coordinates; not finite where they cannot be read.
    pub texture_vertices: Vec<[f64; 2]>,
    pub faces: Vec<IndexedFace>,
    pub face_lines: Vec<u32>,
    pub objects: NamesReader,
    pub groups: NamesReader,
    pub libraries: Vec<(u32, String)>,
    /// Names in the order of their first use, each with the line of that.
    pub names: Vec<(Cow<'a, str>, u32)>,
    pub by_name: HashMap<String, usize>,
    pub nameless: (usize, u32, u32),
    pub weights: (usize, u32),
    pub ignored: BTreeMap<String, (usize, PathBuf, u32)>,
    pub unknown: BTreeMap<String, (usize, PathBuf, u32)>,
}

/// A face by the indices of its corners.
pub(super) struct IndexedFace {
    pub number: u32,
    /// The number of the name of its material.
    pub name: Option<usize>,
    /// Its corners end there, and begin where those of the face before end.
    pub end: usize,
}

/// Lines that are read between two questions whether to stop.
const LINES_AT_ONCE: u32 = 1 << 12;

/// Reads the statements of a file.
pub(super) fn read_structure<'a>(
    text: &'a str,
    file: &Path,
    diagnostics: &mut Diagnostics,
    stop: Stop<'_>,
) -> Result<Structure<'a>, ImportError> {
    let mut structure = Structure::default();
    let mut name = None;
    let mut highest = (0, 0, 0);
    for statement in statements(text) {
        let line = statement.line;
        if line % LINES_AT_ONCE == 0 && stop() {
            return Err(ImportError::Cancelled);
        }
        match &*statement.keyword {
            "v" => structure.vertex(&statement, file)?,
            "f" | "fo" => structure.face(&statement, name, &mut highest, file, diagnostics)?,
            "usemtl" => name = structure.name(statement),
            "mtllib" => structure.libraries.push((line, statement.arguments.into_owned())),
            "o" => structure.objects.start(&statement.arguments),
            "g" => structure.groups.start(&statement.arguments),
            "vt" => structure.texture_vertices.push(texture_vertex(&statement.arguments)),
            // Smoothing and normals: a planar polygon does not need them.
            "vn" | "vp" | "s" | "mg" | "lod" | "usemap" | "maplib" | "bevel" | "c_interp" | "d_interp" | "shadow_obj"
            | "trace_obj" => {}
            key @ ("p" | "l" | "curv" | "curv2" | "surf") => mtl::count(&mut structure.ignored, key, file, line),
            // What belongs to curves and curved surfaces is mentioned with them.
            "parm" | "trim" | "hole" | "scrv" | "sp" | "end" | "con" | "cstype" | "deg" | "bmat" | "step" | "ctech" | "stech" => {}
            key => mtl::count(&mut structure.unknown, key, file, line),
        }
    }

    // A positive index may name a vertex further down, but not beyond the last one.
    let (index, line, face) = highest;
    if index > structure.vertices.len() as u64 {
        let vertices = structure.vertices.len();
        return Err(ImportError::IndexOutOfRange { file: file.to_owned(), line, face, index: index.to_string(), vertices });
    }
    Ok(structure)
}

impl<'a> Structure<'a> {
    /// `v x y z`, perhaps with a weight or a colour behind.
    fn vertex(&mut self, statement: &Statement<'_>, file: &Path) -> Result<(), ImportError> {
        let (number, line) = (self.vertices.len() + 1, statement.line);
        let mut coordinates = [0.0; 3];
        let mut words = 0;
        for word in statement.arguments.split_whitespace() {
            match word.parse::<f64>() {
                Ok(value) if value.abs() < mtl::LARGEST_VALUE => {
                    if let Some(coordinate) = coordinates.get_mut(words) {
                        *coordinate = value;
                    }
                }
                Err(_) if !mtl::is_not_a_number_word(word) => {
                    // What stands behind has no meaning for a vertex.
                    let has_digits_alone = word.bytes().all(|byte| matches!(byte, b'0'..=b'9' | b'+' | b'-' | b'.' | b'e' | b'E'));
                    if words < 3 || !has_digits_alone {
                        return Err(bad_vertex(file, line, number, &statement.arguments));
                    }
                }
                _ => return Err(not_finite(file, line, number, word)),
            }
            if words == 3 && statement.arguments.split_whitespace().count() == 4 && word.parse::<f64>() != Ok(1.0) {
                self.weights = (self.weights.0 + 1, if self.weights.0 == 0 { line } else { self.weights.1 });
            }
            words += 1;
        }
        if words < 3 {
            return Err(bad_vertex(file, line, number, &statement.arguments));
        }
        self.vertices.push(DVec3::from(coordinates));
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
        let defined = self.vertices.len();
        let start = self.corners.len();
        self.face_lines.push(line);
        self.objects.face();
        self.groups.face();

        for word in statement.arguments.split_whitespace() {
            let Some([index, of_texture]) = indices(word) else {
                let reason = format!("'{word}' should be a vertex index, as in 7, -1, 7/1 or 7//1");
                return Err(ImportError::Syntax { file: file.to_owned(), line, face: Some(number + 1), reason });
            };
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
            self.texture_corners.push(texture_corner(of_texture, self.texture_vertices.len()));
        }

        // A point or a line has no area and goes no further.
        let corners = self.corners.len() - start;
        if corners < 3 {
            self.corners.truncate(start);
            self.texture_corners.truncate(start);
            let text = format!("dropped: it has {corners} corners");
            diagnostics.push(Diagnostic::new(DiagnosticKind::DegenerateFace, text).at(file, line).face(number + 1));
            return Ok(());
        }
        if name.is_none() {
            let (count, first_line, first_face) = self.nameless;
            self.nameless = if count == 0 { (1, line, number + 1) } else { (count + 1, first_line, first_face) };
        }
        self.faces.push(IndexedFace { number, name, end: self.corners.len() });
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

/// `vt u v`: v is 0 where it is left out.
fn texture_vertex(arguments: &str) -> [f64; 2] {
    let mut words = arguments.split_whitespace().map(|word| word.parse().unwrap_or(f64::NAN));
    [words.next().unwrap_or(f64::NAN), words.next().unwrap_or(0.0)]
}

/// The index of texture coordinates, from 0; `u32::MAX` where there are none. Negative ones count back from the last of those `defined`.
fn texture_corner(word: &str, defined: usize) -> u32 {
    let value = word.parse::<i64>().unwrap_or(0);
    let index = if value > 0 { value - 1 } else { defined as i64 + value };
    if value == 0 { u32::MAX } else { u32::try_from(index).unwrap_or(u32::MAX) }
}

/// The indices of vertex and texture coordinates as they are written, of a corner `v`, `v/vt`, `v//vn` or `v/vt/vn`; `None` for anything else.
fn indices(corner: &str) -> Option<[&str; 2]> {
    let mut parts = corner.split('/');
    let [vertex, texture, normal] = [0; 3].map(|_| parts.next().unwrap_or_default());
    let is_index = |part: &str| part.is_empty() || is_integer(part);
    (is_integer(vertex) && is_index(texture) && is_index(normal) && parts.next().is_none()).then_some([vertex, texture])
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
