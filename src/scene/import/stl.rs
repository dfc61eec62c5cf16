//! STL, binary or text: triangles and nothing else. All have one grey material; those that lie in one plane are joined.

use std::path::Path;

use glam::DVec3;

use super::faces::FaceFile;
use super::join::joined;
use super::mtl::{LARGEST_VALUE, grey};
use super::text::read_regular_file;
use super::{Diagnostic, DiagnosticKind, Diagnostics, ImportError};
use crate::progress::Stop;

/// Bytes before the number of triangles of a binary file, and those of a triangle: its normal, three corners, and two bytes for whatever.
const HEADER: usize = 80;
const TRIANGLE: usize = 50;

/// Reads an STL file.
pub(super) fn read(file: &Path, diagnostics: &mut Diagnostics, stop: Stop<'_>) -> Result<FaceFile, ImportError> {
    let bytes = read_regular_file(file).map_err(|reason| ImportError::Unreadable { file: file.to_owned(), reason })?;
    let (vertices, lines) = match binary(&bytes) {
        Some(vertices) => {
            let lines = vec![0; vertices.len() / 3];
            (vertices, lines)
        }
        None => text(&bytes).map_err(|(line, reason)| ImportError::Syntax { file: file.to_owned(), line, face: None, reason })?,
    };
    let read = of_triangles(file, &vertices, lines, stop)?;
    diagnostics.push(Diagnostic::new(DiagnosticKind::NoMaterial, "STL has no materials: grey 0.5").at(file, 0));
    Ok(read)
}

/// A file of triangles, given by their corners, with the line of each.
fn of_triangles(file: &Path, vertices: &[DVec3], lines: Vec<u32>, stop: Stop<'_>) -> Result<FaceFile, ImportError> {
    let is_bad = |vertex: &DVec3| !vertex.to_array().iter().all(|x| x.abs() <= LARGEST_VALUE);
    if let Some(bad) = vertices.iter().position(is_bad) {
        let (line, what) = (lines[bad / 3], format!("a coordinate of face {}", bad / 3 + 1));
        return Err(ImportError::NotFinite { file: file.to_owned(), line, what, value: vertices[bad].to_string() });
    }
    let corners: Vec<[u32; 3]> = (0..vertices.len() as u32 / 3).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
    let mut read = FaceFile { vertices: vertices.len(), lines, materials: vec![grey()], ..FaceFile::default() };
    for face in joined(vertices, &corners, stop) {
        read.push(face.triangles[0] as u32, 0, face.corners);
    }
    Ok(read)
}

/// The corners of a binary file: one that is as long as its number of triangles says, or starts otherwise than a text and is longer.
fn binary(bytes: &[u8]) -> Option<Vec<DVec3>> {
    let count = bytes.get(HEADER..HEADER + 4)?;
    let count = u32::from_le_bytes([count[0], count[1], count[2], count[3]]) as usize;
    let body = &bytes[HEADER + 4..];
    let is_text = bytes.trim_ascii_start().starts_with(b"solid");
    if body.len() != count.checked_mul(TRIANGLE)? && (is_text || body.len() < count.checked_mul(TRIANGLE)?) {
        return None;
    }
    let float = |four: &[u8]| f64::from(f32::from_le_bytes([four[0], four[1], four[2], four[3]]));
    let corner = |twelve: &[u8]| DVec3::new(float(&twelve[..4]), float(&twelve[4..8]), float(&twelve[8..]));
    Some(body.chunks_exact(TRIANGLE).take(count).flat_map(|triangle| triangle[12..48].chunks_exact(12).map(corner)).collect())
}

/// The corners of a text, and the line of the first corner of each triangle. The error has a line and a reason.
fn text(bytes: &[u8]) -> Result<(Vec<DVec3>, Vec<u32>), (u32, String)> {
    let text = String::from_utf8_lossy(bytes);
    if !text.trim_start().starts_with("solid") {
        return Err((0, "it is no STL file, or one that is cut off; export it again".to_owned()));
    }
    let (mut vertices, mut lines) = (Vec::new(), Vec::new());
    for (number, line) in (1_u32..).zip(text.lines()) {
        let mut words = line.split_whitespace();
        if words.next() != Some("vertex") {
            continue;
        }
        let numbers: Vec<f64> = words.map_while(|word| word.parse().ok()).collect();
        let [x, y, z] = numbers[..] else { return Err((number, "a vertex should have three numbers".to_owned())) };
        if vertices.len() % 3 == 0 {
            lines.push(number);
        }
        vertices.push(DVec3::new(x, y, z));
    }
    if vertices.len() % 3 != 0 || !text.contains("endsolid") {
        return Err((0, "the file is cut off: it does not end in 'endsolid' behind whole triangles; export it again".to_owned()));
    }
    Ok((vertices, lines))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn binary_files_are_told_from_text_by_their_length() {
        let mut file = [b"solid but binary".as_slice(), &[0; 64], &1_u32.to_le_bytes()].concat();
        for x in [0.0_f32, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0] {
            file.extend(x.to_le_bytes());
        }
        file.extend([0, 0]);
        assert_eq!(binary(&file).unwrap(), [DVec3::ZERO, DVec3::X, DVec3::Y]);
        assert!(binary(&file[..file.len() - 1]).is_none());
        file[84 - 4..84].copy_from_slice(&u32::MAX.to_le_bytes());
        assert!(binary(&file).is_none());
    }

    #[test]
    fn texts_have_lines() {
        let file = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid";
        let (vertices, lines) = text(file.as_bytes()).unwrap();
        assert_eq!((vertices.len(), lines), (3, vec![4]));
        assert_eq!(text(file.replace("1 0 0", "1 x 0").as_bytes()).unwrap_err().0, 5);
        assert!(text(file.replace("endsolid", "").as_bytes()).unwrap_err().1.contains("cut off"));
        assert!(text(b"\x00\x01").unwrap_err().1.contains("no STL file"));
    }
}
