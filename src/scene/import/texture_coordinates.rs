//! Where the corners of faces of OBJ files lie in textures.

use glam::DVec3;

use super::faces::{Face, FaceFile};
use crate::scene::{FileUv, UvTriangle};

/// Where the corners of faces lie in textures.
pub(super) struct TextureCoordinates {
    /// As they were read; not finite where they could not be.
    pub vertices: Vec<[f64; 2]>,
    /// For each corner of [`FaceFile::corners`] an index into `vertices`, or one that is none.
    pub corners: Vec<u32>,
}

impl TextureCoordinates {
    /// The coordinates of a corner, if it has some.
    pub fn of(&self, corner: usize) -> Option<[f64; 2]> {
        let at = self.vertices.get(*self.corners.get(corner)? as usize)?;
        at.iter().all(|x| x.is_finite()).then_some(*at)
    }

    /// All as coordinates for lightmaps: convex faces as fans of triangles. OBJ files count from the bottom left.
    pub fn uv_of(&self, read: &FaceFile) -> FileUv {
        let mut uv = FileUv::default();
        for face in &read.faces {
            let from_top = |corner: usize| self.of(corner).map(|[u, v]| [u, 1.0 - v]);
            match (face.start..face.end).map(from_top).collect::<Option<Vec<[f64; 2]>>>() {
                Some(places) if is_fan(&read.corners[face.start..face.end]) => add_fan(&mut uv, face, &read.corners, &places),
                Some(_) => _ = uv.concave.get_or_insert(face.number),
                None => _ = uv.without.get_or_insert(face.number),
            }
        }
        uv
    }
}

/// The triangles from the first corner, and their areas as vectors.
fn fan(corners: &[DVec3]) -> impl Iterator<Item = ([usize; 3], DVec3)> {
    (1..corners.len() - 1).map(|k| ([0, k, k + 1], (corners[k] - corners[0]).cross(corners[k + 1] - corners[0])))
}

/// Whether all triangles of the fan face the same way, but those without an area.
fn is_fan(corners: &[DVec3]) -> bool {
    let whole: DVec3 = fan(corners).map(|(_, area)| area).sum();
    fan(corners).all(|(_, area)| area.dot(whole) >= 0.0)
}

fn add_fan(uv: &mut FileUv, face: &Face, corners: &[DVec3], places: &[[f64; 2]]) {
    let corners = &corners[face.start..face.end];
    uv.triangles.extend(fan(corners).map(|(triangle, _)| UvTriangle {
        face: face.number,
        corners: triangle.map(|k| corners[k].to_array()),
        uv: triangle.map(|k| places[k]),
    }));
}
