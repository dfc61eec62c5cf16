//! Coordinates that a file gives its triangles, for lightmaps.

/// Where the triangles of a file lie on a page that is the unit square.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FileUv {
    /// Those that have coordinates.
    pub triangles: Vec<UvTriangle>,
    /// The number of the first face that has none, from 0.
    pub without: Option<u32>,
    /// The number of the first face that is concave: it is no fan of triangles.
    pub concave: Option<u32>,
}

/// A triangle as the file has it, before faces are joined or cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UvTriangle {
    /// The number of the face that it became a part of: [`Surface::face`](super::Surface::face).
    pub face: u32,
    /// In metres, counter-clockwise from the front.
    pub corners: [[f64; 3]; 3],
    /// From the top left of the page, as parts of its width and height.
    pub uv: [[f64; 2]; 3],
}
