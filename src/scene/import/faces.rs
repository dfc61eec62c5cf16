//! What a reader of files hands on: faces as they were read, and where they are from.

use std::path::PathBuf;

use glam::DVec3;

use crate::scene::{FaceNames, FileUv, Light, Material};

/// A face as it was read: three or more corners.
pub(super) struct Face {
    /// The 0-based number of the face in the file.
    pub number: u32,
    /// Index into the materials.
    pub material: u32,
    /// Its corners are `corners[start..end]` of [`FaceFile`].
    pub start: usize,
    /// See `start`.
    pub end: usize,
}

/// A file as it was read.
#[derive(Default)]
pub(super) struct FaceFile {
    /// The line of each face in the file, from 1; 0 where the format has no lines.
    pub lines: Vec<u32>,
    /// How many vertices the file has.
    pub vertices: usize,
    /// The faces of three or more corners.
    pub faces: Vec<Face>,
    /// The corners of all faces.
    pub corners: Vec<DVec3>,
    /// The materials that faces index.
    pub materials: Vec<Material>,
    /// The other files that were read.
    pub libraries: Vec<PathBuf>,
    /// The objects and the groups that faces are in, where the format has names for them.
    pub objects: FaceNames,
    pub groups: FaceNames,
    /// Lights that are no surfaces, of three channels.
    pub lights: Vec<Light>,
    /// Coordinates for lightmaps, if they are kept.
    pub uv: FileUv,
}

impl FaceFile {
    /// The same in metres, of which a unit of the file has so many.
    pub fn scaled(mut self, metres: f64) -> Self {
        self.corners.iter_mut().for_each(|corner| *corner *= metres);
        let of_uv = self.uv.triangles.iter_mut().flat_map(|triangle| triangle.corners.as_flattened_mut());
        of_uv.for_each(|x| *x *= metres);
        self
    }

    /// Adds a face.
    pub fn push(&mut self, number: u32, material: u32, corners: impl IntoIterator<Item = DVec3>) {
        let start = self.corners.len();
        self.corners.extend(corners);
        self.faces.push(Face { number, material, start, end: self.corners.len() });
    }
}
