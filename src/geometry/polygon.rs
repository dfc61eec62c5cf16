//! Planar convex polygons with area, normal and centroid.

use glam::DVec3;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::{Aabb, Facet};

/// Why some vertices make no polygon.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum PolygonError {
    /// Fewer than three vertices.
    #[error("a polygon needs at least three vertices, this one has {0}")]
    TooFewVertices(usize),
    /// A coordinate is NaN or infinite.
    #[error("vertex {0} has a coordinate that is not finite")]
    NotFinite(usize),
    /// The area is below `1e-14` times the square of the longest edge.
    #[error("the polygon has no area")]
    NoArea,
    /// A vertex lies off the plane by more than `1e-6` of the diameter.
    #[error("the vertices do not lie in one plane")]
    NotPlanar,
    /// A corner turns the wrong way.
    #[error("the polygon is not convex")]
    NotConvex,
}

/// A planar convex polygon, one-sided: its front is where the vertices run counter-clockwise. Lengths in metres.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Polygon {
    vertices: Vec<DVec3>,
    normal: DVec3,
    area: f64,
    centroid: DVec3,
    radius: f64,
}

impl Polygon {
    /// Below this fraction of the longest edge squared an area counts as none: it is what rounding leaves of a line.
    const AREA_TOLERANCE: f64 = 1e-14;

    /// A vertex may lie this fraction of the diameter off the plane; file formats round to six or seven digits.
    pub const PLANARITY_TOLERANCE: f64 = 1e-6;

    /// A polygon through `vertices`, counter-clockwise seen from the front.
    ///
    /// # Errors
    /// See [`PolygonError`]: each variant says which range is legal.
    pub fn new(vertices: &[[f64; 3]]) -> Result<Self, PolygonError> {
        Self::from_vertices(vertices.iter().map(|&v| DVec3::from(v)).collect())
    }

    pub(crate) fn from_vertices(vertices: Vec<DVec3>) -> Result<Self, PolygonError> {
        if vertices.len() < 3 {
            return Err(PolygonError::TooFewVertices(vertices.len()));
        }
        if let Some(bad) = vertices.iter().position(|v| !v.is_finite()) {
            return Err(PolygonError::NotFinite(bad));
        }

        // Area and normal by Newell's sum around vertex 0, which keeps large offsets out of the products.
        let origin = vertices[0];
        let edge = |k: usize| vertices[k] - origin;
        let twice_area: DVec3 = (1..vertices.len() - 1).map(|k| edge(k).cross(edge(k + 1))).sum();
        let area = 0.5 * twice_area.length();
        let longest_sq =
            (0..vertices.len()).map(|k| vertices[k].distance_squared(vertices[(k + 1) % vertices.len()])).fold(0.0, f64::max);
        if area.is_nan() || area <= Self::AREA_TOLERANCE * longest_sq {
            return Err(PolygonError::NoArea);
        }
        let normal = twice_area.normalize();

        // The centroid weighs each triangle of the fan by its signed area.
        let moment: DVec3 = (1..vertices.len() - 1).map(|k| edge(k).cross(edge(k + 1)).dot(normal) * (edge(k) + edge(k + 1))).sum();
        let centroid = origin + moment / (6.0 * area);
        let radius = vertices.iter().map(|v| v.distance(centroid)).fold(0.0, f64::max);

        // Planar and convex, both relative to the size of the polygon.
        let off_plane = vertices.iter().map(|v| (*v - centroid).dot(normal).abs()).fold(0.0, f64::max);
        if off_plane > Self::PLANARITY_TOLERANCE * 2.0 * radius {
            return Err(PolygonError::NotPlanar);
        }
        let count = vertices.len();
        let turns_right = |k: usize| {
            let (a, b, c) = (vertices[k], vertices[(k + 1) % count], vertices[(k + 2) % count]);
            (b - a).cross(c - b).dot(normal) < -1e-9 * radius * radius
        };
        if (0..count).any(turns_right) {
            return Err(PolygonError::NotConvex);
        }
        Ok(Self { vertices, normal, area, centroid, radius })
    }

    /// The vertices, counter-clockwise seen from the front.
    pub fn vertices(&self) -> impl ExactSizeIterator<Item = [f64; 3]> + '_ {
        self.vertices.iter().map(|v| v.to_array())
    }

    /// Unit normal of the front.
    pub fn normal(&self) -> [f64; 3] {
        self.normal.to_array()
    }

    /// Area in m^2, positive.
    pub fn area(&self) -> f64 {
        self.area
    }

    /// Centroid of the area.
    pub fn centroid(&self) -> [f64; 3] {
        self.centroid.to_array()
    }

    /// The same polygon seen from behind.
    #[must_use]
    pub fn reversed(&self) -> Self {
        let mut reversed = self.clone();
        reversed.vertices.reverse();
        reversed.normal = -reversed.normal;
        reversed
    }

    pub(crate) fn facet(&self) -> Facet<'_> {
        Facet { vertices: &self.vertices, normal: self.normal, area: self.area, centroid: self.centroid, radius: self.radius }
    }

    pub(crate) fn bounds(&self) -> Aabb {
        Aabb::around(self.vertices.iter().copied())
    }
}
