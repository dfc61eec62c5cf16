//! A picture.

/// Linear radiance per pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// In pixels.
    pub width: u32,
    /// In pixels.
    pub height: u32,
    /// Channels per pixel: as many as the solution has.
    pub channels: usize,
    /// Radiance L = B / pi in W/m^2/sr, row after row from the top left; 0 where nothing is hit.
    pub radiance: Vec<f32>,
}
