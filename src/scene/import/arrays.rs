//! Faces from memory: repaired and cut as those of a file.

use glam::DVec3;
use thiserror::Error;

use super::assemble::{Faces, assemble};
use super::faces::Face;
use super::{Diagnostic, DiagnosticKind, Diagnostics};
use crate::geometry::Polygon;
use crate::scene::FaceNames;

/// A face; its corners follow those of the face before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ArrayFace {
    /// How many corners it has, counter-clockwise seen from the front.
    pub corners: usize,
    /// Index of its material.
    pub material: u32,
}

/// Why faces cannot be taken.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum ArraysError {
    /// A coordinate is NaN, infinite or beyond `1e30`.
    #[error("face {face}: corner {corner} has a coordinate that is not a number below 1e30")]
    NotFinite {
        /// The number of the face, from 1.
        face: u32,
        /// The number of the corner in the face, from 1.
        corner: usize,
    },
    /// The faces have more or fewer corners than there are.
    #[error("the faces have other than {corners} corners in all")]
    Corners {
        /// How many there are.
        corners: usize,
    },
    /// There are more than 2^32 - 2 faces.
    #[error("too many faces")]
    TooMany,
}

/// Coordinates may not be larger than this, as in files.
const LARGEST_COORDINATE: f64 = 1e30;

/// Convex planar polygons of faces: with, for each, the index of its material and the 0-based number of its face, as
/// [`Scene::new`](crate::scene::Scene::new) takes them. Faces of fewer than three corners, without area, or on the same vertices as
/// an earlier one are dropped; others are cut where they are not convex and planar. Each of these is noted in `diagnostics`.
///
/// # Errors
/// See [`ArraysError`].
pub fn polygons_of_arrays(
    corners: &[[f64; 3]],
    faces: &[ArrayFace],
    diagnostics: &mut Diagnostics,
) -> Result<Vec<(Polygon, u32, u32)>, ArraysError> {
    // Where each face has its corners.
    if faces.len() >= u32::MAX as usize {
        return Err(ArraysError::TooMany);
    }
    let mut end = 0_usize;
    let mut read = Vec::with_capacity(faces.len());
    for (number, face) in (0_u32..).zip(faces) {
        let start = end;
        end = end
            .checked_add(face.corners)
            .filter(|&end| end <= corners.len())
            .ok_or(ArraysError::Corners { corners: corners.len() })?;
        let is_bad = |corner: &[f64; 3]| !corner.iter().all(|x| x.abs() <= LARGEST_COORDINATE);
        if let Some(bad) = corners[start..end].iter().position(is_bad) {
            return Err(ArraysError::NotFinite { face: number + 1, corner: bad + 1 });
        }
        if face.corners < 3 {
            let text = format!("dropped: it has {} corners", face.corners);
            diagnostics.push(Diagnostic::new(DiagnosticKind::DegenerateFace, text).face(number + 1));
            continue;
        }
        read.push(Face { number, material: face.material, start, end });
    }
    if end != corners.len() {
        return Err(ArraysError::Corners { corners: corners.len() });
    }

    // Their polygons.
    let corners: Vec<DVec3> = corners.iter().map(|&corner| DVec3::from(corner)).collect();
    let faces = Faces { faces: &read, corners: &corners, source: None, objects: &FaceNames::default() };
    let assembled = assemble(&faces, diagnostics, &|| false);
    Ok(assembled.map_or_else(Vec::new, |assembled| assembled.polygons))
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: [[f64; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];

    fn face(corners: usize) -> ArrayFace {
        ArrayFace { corners, material: 0 }
    }

    #[test]
    fn faces_are_repaired_and_what_was_done_is_noted() {
        // A square, the same again, an edge, an L, a face without area.
        let l = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]].map(|[x, y]| [x, y, 5.0]);
        let line = [[0.0, 0.0, 0.0], [1.0, 1.0, 1.0], [2.0, 2.0, 2.0]];
        let corners = [&SQUARE[..], &SQUARE, &SQUARE[..2], &l, &line].concat();
        let mut diagnostics = Diagnostics::default();
        let polygons = polygons_of_arrays(&corners, &[face(4), face(4), face(2), face(6), face(3)], &mut diagnostics).unwrap();
        assert_eq!(polygons.iter().map(|polygon| polygon.2).collect::<Vec<_>>(), [0, 3, 3]);
        let area: f64 = polygons.iter().map(|polygon| polygon.0.area()).sum();
        assert!((area - 4.0).abs() < 1e-14);

        let notes: Vec<(DiagnosticKind, Option<u32>)> = diagnostics.items.iter().map(|note| (note.kind, note.face)).collect();
        let expected = [
            (DiagnosticKind::DegenerateFace, Some(3)),
            (DiagnosticKind::DuplicateFace, Some(2)),
            (DiagnosticKind::ConcaveFace, Some(4)),
            (DiagnosticKind::DegenerateFace, Some(5)),
        ];
        assert_eq!(notes, expected);
        assert_eq!(diagnostics.items[1].to_string(), "face 2: dropped: it repeats face 1");
    }

    #[test]
    fn bad_arrays_are_told() {
        let bad = |corners: &[[f64; 3]], faces: &[ArrayFace]| polygons_of_arrays(corners, faces, &mut Diagnostics::default());
        assert_eq!(bad(&SQUARE, &[face(5)]), Err(ArraysError::Corners { corners: 4 }));
        assert_eq!(bad(&SQUARE, &[face(3)]), Err(ArraysError::Corners { corners: 4 }));
        assert_eq!(bad(&SQUARE, &[face(4), face(usize::MAX)]), Err(ArraysError::Corners { corners: 4 }));
        for x in [f64::NAN, f64::INFINITY, -1e31] {
            let corners = [SQUARE[0], SQUARE[1], [1.0, x, 0.0], SQUARE[3]];
            assert_eq!(bad(&corners, &[face(4)]), Err(ArraysError::NotFinite { face: 1, corner: 3 }));
        }
    }
}
