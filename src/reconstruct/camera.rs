//! Where a picture is taken from.

/// A pinhole camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// The eye, in metres.
    pub eye: [f64; 3],
    /// What is at the centre of the picture.
    pub target: [f64; 3],
    /// What points up in the picture; not parallel to the view.
    pub up: [f64; 3],
    /// Vertical field of view in degrees, above 0 and below 180.
    pub field_of_view_degrees: f64,
    /// Width of the picture in pixels.
    pub width: u32,
    /// Height of the picture in pixels.
    pub height: u32,
}
