//! Pictures: cameras, views that show a scene, and the values at what each pixel sees.

mod camera;
mod default_view;
mod image;
mod of_mesh;
mod render;
mod width;

pub use camera::{Camera, CameraError, CameraRays, CameraRequest};
pub use image::Image;
pub(crate) use of_mesh::render_mesh;
pub(crate) use render::render;
pub(crate) use width::render_width;
