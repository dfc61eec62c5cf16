//! Planar polygons, clipping, boxes, frames, sample and quadrature points in f64. Knows no scene.
//!
//! Points and directions cross the public API as `[f64; 3]`; inside the crate they are `glam::DVec3`.

mod aabb;
mod bisect;
mod clip;
mod cone;
mod convex_unions;
mod facet;
mod frame;
mod gauss;
mod lobes;
mod median;
mod part;
mod pieces;
mod polygon;
pub(crate) mod sampling;
mod separation;
pub(crate) mod streams;

pub use aabb::Aabb;
pub(crate) use bisect::{cut_along, halve};
pub(crate) use clip::{Clip, ClippedFacet, clip_to_front, halves, in_front, plane_noise};
pub(crate) use cone::Cone;
pub(crate) use convex_unions::convex_unions;
pub(crate) use facet::Facet;
pub(crate) use frame::Frame;
pub(crate) use gauss::{for_each_gauss_point, gauss_rule};
pub(crate) use lobes::Lobes;
pub(crate) use median::{median, median_point};
pub(crate) use part::Part;
pub(crate) use pieces::for_each_piece;
pub use polygon::{Polygon, PolygonError};
pub(crate) use separation::{edges, is_apart};
