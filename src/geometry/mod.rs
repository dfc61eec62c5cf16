//! Planar polygons, boxes, frames and sample points in f64. Knows no scene.
//!
//! Points and directions cross the public API as `[f64; 3]`; inside the crate they are `glam::DVec3`.

mod aabb;
mod facet;
mod frame;
mod polygon;

pub use aabb::Aabb;
pub(crate) use facet::Facet;
pub(crate) use frame::Frame;
pub use polygon::{Polygon, PolygonError};
