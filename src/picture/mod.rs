//! Pictures: cameras, views that show a scene, and the values at what each pixel sees; measuring planes.

mod antialiased;
mod camera;
mod coarse_to_fine;
mod default_view;
mod image;
mod lines;
mod measuring_plane;
mod of_mesh;
mod plain;
mod plane_picture;
mod render;
mod shown;
mod width;

pub use camera::{Camera, CameraError, CameraRays, CameraRequest};
pub use image::Image;
pub(crate) use image::luminance;
pub use lines::Marks;
pub(crate) use lines::{Line, draw_lines};
pub use measuring_plane::{MeasuringPlane, PlaneError, PlaneRequest};
pub(crate) use of_mesh::{render_mesh, seen_surfaces};
pub use plain::{BACK_COLOUR, PlainMark, PlainPicture, PlainView};
pub(crate) use render::render;
pub(crate) use shown::Shown;
pub(crate) use width::render_width;
