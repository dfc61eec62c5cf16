//! PLY, as text or binary: vertices with `x`, `y`, `z`, and faces, lists of them (G. Turk, The PLY Polygon File Format, 1994). All faces have one
//! grey material; where all are triangles, those that lie in one plane are joined.

use std::path::Path;

use glam::DVec3;

use super::faces::FaceFile;
use super::join::joined;
use super::mtl::{LARGEST_VALUE, grey};
use super::text::read_regular_file;
use super::{Diagnostic, DiagnosticKind, Diagnostics, ImportError};
use crate::progress::Stop;
use header::{Element, Format, Header, Kind, Property};

mod header;

/// Reads a PLY file.
pub(super) fn read(file: &Path, diagnostics: &mut Diagnostics, stop: Stop<'_>) -> Result<FaceFile, ImportError> {
    let bytes = read_regular_file(file).map_err(|reason| ImportError::Unreadable { file: file.to_owned(), reason })?;
    let wrong = |reason: String| ImportError::Syntax { file: file.to_owned(), line: 0, face: None, reason };
    let (header, body) = Header::read(&bytes).map_err(wrong)?;
    let mut source = Source { format: header.format, rest: body };
    let (mut vertices, mut faces): (Vec<DVec3>, Vec<Vec<u32>>) = (Vec::new(), Vec::new());
    for element in &header.elements {
        match element.name.as_str() {
            "vertex" => vertices = read_vertices(&mut source, element).map_err(wrong)?,
            "face" => faces = read_faces(&mut source, element).map_err(wrong)?,
            _ => (0..element.count).try_for_each(|_| source.item(element, |_, _| {})).map_err(wrong)?,
        }
    }
    check(file, &vertices, &faces)?;

    // Polygons stay as they are.
    let mut read =
        FaceFile { vertices: vertices.len(), lines: vec![0; faces.len()], materials: vec![grey()], ..FaceFile::default() };
    let triangles: Vec<[u32; 3]> = faces.iter().filter_map(|face| face.as_slice().try_into().ok()).collect();
    if triangles.len() == faces.len() {
        for face in joined(&vertices, &triangles, stop) {
            read.push(face.triangles[0] as u32, 0, face.corners);
        }
    } else {
        for (number, face) in (0_u32..).zip(&faces).filter(|(_, face)| face.len() >= 3) {
            read.push(number, 0, face.iter().map(|&vertex| vertices[vertex as usize]));
        }
    }
    diagnostics.push(Diagnostic::new(DiagnosticKind::NoMaterial, "materials are not read from PLY: grey 0.5").at(file, 0));
    Ok(read)
}

/// Coordinates and indices.
fn check(file: &Path, vertices: &[DVec3], faces: &[Vec<u32>]) -> Result<(), ImportError> {
    let is_bad = |vertex: &DVec3| !vertex.to_array().iter().all(|x| x.abs() <= LARGEST_VALUE);
    if let Some(bad) = vertices.iter().position(is_bad) {
        let what = format!("a coordinate of vertex {bad}, counted from 0,");
        return Err(ImportError::NotFinite { file: file.to_owned(), line: 0, what, value: vertices[bad].to_string() });
    }
    for (face, corners) in (1..).zip(faces) {
        if let Some(bad) = corners.iter().find(|&&corner| corner as usize >= vertices.len()) {
            let reason = format!("vertex {bad} does not exist: there are {}, numbered from 0", vertices.len());
            return Err(ImportError::Syntax { file: file.to_owned(), line: 0, face: Some(face), reason });
        }
    }
    Ok(())
}

/// Values one after the other.
struct Source<'a> {
    format: Format,
    rest: &'a [u8],
}

impl Source<'_> {
    /// Reads an item of an element: `take` gets the number of each property, and its value, or the values of its list.
    fn item(&mut self, element: &Element, mut take: impl FnMut(usize, f64)) -> Result<(), String> {
        for (number, property) in element.properties.iter().enumerate() {
            let (length, kind) = match *property {
                Property { list: Some(length), kind, .. } => (self.value(length)?, kind),
                Property { kind, .. } => (1.0, kind),
            };
            for _ in 0..length as u64 {
                let value = self.value(kind)?;
                take(number, value);
            }
        }
        Ok(())
    }

    fn value(&mut self, kind: Kind) -> Result<f64, String> {
        const CUT_OFF: &str = "the file is cut off: it has fewer values than it says; export it again";
        if self.format == Format::Text {
            self.rest = self.rest.trim_ascii_start();
            let end = self.rest.iter().position(u8::is_ascii_whitespace).unwrap_or(self.rest.len());
            let (word, rest) = self.rest.split_at(end);
            self.rest = rest;
            let word = std::str::from_utf8(word).unwrap_or("?");
            return if word.is_empty() {
                Err(CUT_OFF.to_owned())
            } else {
                word.parse().map_err(|_| format!("'{word}' is no number"))
            };
        }
        let (bytes, rest) = self.rest.split_at_checked(kind.bytes()).ok_or(CUT_OFF)?;
        self.rest = rest;
        Ok(kind.number(bytes, self.format == Format::BigEndian))
    }
}

fn read_vertices(source: &mut Source<'_>, element: &Element) -> Result<Vec<DVec3>, String> {
    let place = |name: &str| element.properties.iter().position(|property| property.name == name && property.list.is_none());
    let (Some(x), Some(y), Some(z)) = (place("x"), place("y"), place("z")) else {
        return Err("its vertices have no x, y and z".to_owned());
    };
    let mut vertices = Vec::new();
    for _ in 0..element.count {
        let mut vertex = DVec3::ZERO;
        source.item(element, |number, value| match number {
            _ if number == x => vertex.x = value,
            _ if number == y => vertex.y = value,
            _ if number == z => vertex.z = value,
            _ => {}
        })?;
        vertices.push(vertex);
    }
    Ok(vertices)
}

fn read_faces(source: &mut Source<'_>, element: &Element) -> Result<Vec<Vec<u32>>, String> {
    let is_corners =
        |property: &Property| property.list.is_some() && ["vertex_indices", "vertex_index"].contains(&property.name.as_str());
    let corners = element.properties.iter().position(is_corners).ok_or("its faces have no list vertex_indices")?;
    let mut faces = Vec::new();
    for _ in 0..element.count {
        let mut face = Vec::new();
        // What is no index becomes one that does not exist.
        source.item(element, |number, value| {
            if number == corners {
                face.push(if value >= 0.0 && value.fract() == 0.0 { value as u32 } else { u32::MAX });
            }
        })?;
        faces.push(face);
    }
    Ok(faces)
}
