//! Values at points, from a solution: the gather at the point, over links or over the hemisphere.

mod aim_tree;
mod camera;
mod default_view;
mod equations;
mod excess;
mod hemisphere;
mod image;
mod irradiance_record;
mod lamps;
mod lattice;
mod light_paths;
mod over_links;
mod plane_cells;
mod reconstruction;
mod reflectors;
mod render;
mod resolved;
mod sample;
mod shared_irradiance;
mod spots;
mod variation;

pub use camera::{Camera, CameraError, CameraRays, CameraRequest};
pub(crate) use excess::ExcessGather;
pub(crate) use hemisphere::HemisphereGather;
pub use image::Image;
pub(crate) use lattice::Lattice;
pub(crate) use light_paths::{LightPaths, PathScratch, Place};
pub(crate) use over_links::LinkGather;
pub(crate) use reconstruction::{Effort, Reconstruction, Scratch, Way};
pub(crate) use reflectors::{Reflector, reflectors};
pub(crate) use render::render;
pub(crate) use resolved::{Resolution, Resolved};
pub(crate) use sample::values_at;

/// A point that lies on a surface, with the normal of the side that is looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// In metres.
    pub position: [f64; 3],
    /// Unit normal of the side that is looked at.
    pub normal: [f64; 3],
}

/// Radiosities at points.
#[derive(Clone, Debug, PartialEq)]
pub struct Values {
    /// Channels per value.
    pub channels: usize,
    /// `channels` radiosities per point in W/m^2, point after point; NaN at points that lie on no surface.
    pub radiosity: Vec<f32>,
    /// How many points lie on no surface.
    pub missed: usize,
}
