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
    /// The area is below `1e-14` times the square of the longest edge, or that edge is shorter than `1e-75` m.
    #[error("the polygon has no area")]
    NoArea,
    /// An edge is longer than `1e75` m: its square, the area, must have a square in f64.
    #[error("the polygon is too large")]
    TooLarge,
    /// A vertex lies off the plane by more than `1e-6` of the diameter.
    #[error("the vertices do not lie in one plane")]
    NotPlanar,
    /// A vertex lies to the right of an edge: a corner turns the wrong way, or the contour crosses itself.
    #[error("the polygon is not convex")]
    NotConvex,
}

/// Twice the area of a triangle along its normal, from the corner between its two shorter edges: a long edge would leave rounding
/// of its own length in the height of a thin triangle.
pub(crate) fn twice_vector_area(a: DVec3, b: DVec3, c: DVec3) -> DVec3 {
    let (ab, bc, ca) = (b - a, c - b, a - c);
    let (ab_sq, bc_sq, ca_sq) = (ab.length_squared(), bc.length_squared(), ca.length_squared());
    if ab_sq >= bc_sq && ab_sq >= ca_sq {
        bc.cross(ca)
    } else if bc_sq >= ca_sq {
        ca.cross(ab)
    } else {
        ab.cross(bc)
    }
}

/// A planar convex polygon, one-sided: its front is where the vertices run counter-clockwise. Lengths in metres.
///
/// Stored are the vertices as they were measured, and whether it is seen from behind: all else is measured anew, to the same bits. A polygon
/// that is not quite flat, or very thin, has other measures from every corner, so its vertices alone would not do.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Stored", into = "Stored")]
pub struct Polygon {
    vertices: Vec<DVec3>,
    /// Whether it was measured with the vertices in the opposite order.
    is_reversed: bool,
    normal: DVec3,
    area: f64,
    centroid: DVec3,
    radius: f64,
}

/// A polygon as it is stored: vertices in the order in which it was measured, counter-clockwise from there.
#[derive(Serialize, Deserialize)]
struct Stored {
    vertices: Vec<DVec3>,
    is_reversed: bool,
}

impl From<Polygon> for Stored {
    fn from(mut polygon: Polygon) -> Self {
        if polygon.is_reversed {
            polygon.vertices.reverse();
        }
        Self { vertices: polygon.vertices, is_reversed: polygon.is_reversed }
    }
}

impl TryFrom<Stored> for Polygon {
    type Error = PolygonError;

    fn try_from(stored: Stored) -> Result<Self, PolygonError> {
        let measured = Self::from_vertices(stored.vertices)?;
        Ok(if stored.is_reversed { measured.reversed() } else { measured })
    }
}

impl Polygon {
    /// Below this fraction of the longest edge squared an area counts as none: it is what rounding leaves of a line.
    const AREA_TOLERANCE: f64 = 1e-14;

    /// In metres; the shortest is as much below one metre.
    const LARGEST_EDGE: f64 = 1e75;

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

        // Area and normal by the fan of triangles around vertex 0.
        let origin = vertices[0];
        let triangle = |k: usize| twice_vector_area(origin, vertices[k], vertices[k + 1]);
        let twice_area: DVec3 = (1..vertices.len() - 1).map(triangle).sum();
        let area = 0.5 * twice_area.length();
        let longest_sq =
            (0..vertices.len()).map(|k| vertices[k].distance_squared(vertices[(k + 1) % vertices.len()])).fold(0.0, f64::max);
        if longest_sq > Self::LARGEST_EDGE.powi(2) {
            return Err(PolygonError::TooLarge);
        }
        if longest_sq < Self::LARGEST_EDGE.powi(-2) || area <= Self::AREA_TOLERANCE * longest_sq {
            return Err(PolygonError::NoArea);
        }
        let normal = twice_area.normalize();

        // The centroid weighs each triangle of the fan by its signed area.
        let arms = |k: usize| (vertices[k] - origin) + (vertices[k + 1] - origin);
        let moment: DVec3 = (1..vertices.len() - 1).map(|k| triangle(k).dot(normal) * arms(k)).sum();
        let centroid = origin + moment / (6.0 * area);
        let radius = vertices.iter().map(|v| v.distance(centroid)).fold(0.0, f64::max);

        // Planar, relative to the size of the polygon.
        let off_plane = vertices.iter().map(|v| (*v - centroid).dot(normal).abs()).fold(0.0, f64::max);
        if off_plane > Self::PLANARITY_TOLERANCE * 2.0 * radius {
            return Err(PolygonError::NotPlanar);
        }
        // Convex is: every vertex to the left of every edge. Left turns alone would let a pentagram pass.
        let count = vertices.len();
        let has_vertex_to_the_right = |k: usize| {
            let (a, edge) = (vertices[k], vertices[(k + 1) % count] - vertices[k]);
            vertices.iter().any(|&v| edge.cross(v - a).dot(normal) < -1e-9 * radius * radius)
        };
        if (0..count).any(has_vertex_to_the_right) {
            return Err(PolygonError::NotConvex);
        }
        Ok(Self { vertices, is_reversed: false, normal, area, centroid, radius })
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
        reversed.is_reversed = !reversed.is_reversed;
        reversed
    }

    pub(crate) fn facet(&self) -> Facet<'_> {
        Facet { vertices: &self.vertices, normal: self.normal, area: self.area, centroid: self.centroid, radius: self.radius }
    }

    pub(crate) fn bounds(&self) -> Aabb {
        Aabb::around(self.vertices.iter().copied())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: [[f64; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];

    #[test]
    fn a_square_has_its_measures() {
        let square = Polygon::new(&SQUARE).unwrap();
        assert_eq!((square.area(), square.normal(), square.centroid()), (1.0, [0.0, 0.0, 1.0], [0.5, 0.5, 0.0]));
        let reversed = square.reversed();
        assert_eq!((reversed.area(), reversed.normal()), (1.0, [0.0, 0.0, -1.0]));
        assert_eq!(reversed.vertices().next(), Some([0.0, 1.0, 0.0]));
    }

    #[test]
    fn measures_scale_and_translate() {
        let map = |f: &dyn Fn(f64) -> f64| Polygon::new(&SQUARE.map(|v| v.map(f))).unwrap();
        assert!((map(&|x| 1e-6 * x).area() / 1e-12 - 1.0).abs() < 1e-14);
        assert!((map(&|x| 1e6 * x).area() / 1e12 - 1.0).abs() < 1e-14);
        assert!((map(&|x| 1e6 + x).area() - 1.0).abs() < 1e-9);
    }

    #[test]
    fn a_sliver_is_a_polygon_and_a_line_is_none() {
        let sliver = Polygon::new(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, 1e-6, 0.0]]).unwrap();
        assert!((sliver.area() / 5e-7 - 1.0).abs() < 1e-12);
        assert_eq!(Polygon::new(&[[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]]), Err(PolygonError::NoArea));
        assert_eq!(Polygon::new(&[[0.1, 0.2, 0.3]; 3]), Err(PolygonError::NoArea));
    }

    /// The back of a polygon keeps the measures of its front, and what is stored gives both again, to the bit.
    #[test]
    fn what_is_stored_is_measured_to_the_same_bits() {
        // Not quite flat, and very thin.
        let bent = [
            [2.410219, 0.8480368, 3.025302],
            [2.404174, 0.8480368, 3.008694],
            [2.404174, 0.2177581, 3.008694],
            [2.409257, 0.2177581, 3.022659],
            [2.409326, 0.2177581, 3.022848],
        ];
        let sliver = [[0.1, 0.7, 0.3], [1.0, 0.2, 0.9], [0.55000001, 0.45, 0.6]];
        for polygon in [Polygon::new(&bent).unwrap(), Polygon::new(&sliver).unwrap(), Polygon::new(&SQUARE).unwrap()] {
            for polygon in [polygon.reversed(), polygon.reversed().reversed(), polygon] {
                let stored = postcard::to_stdvec(&polygon).unwrap();
                assert_eq!(postcard::from_bytes::<Polygon>(&stored).unwrap(), polygon);
            }
        }
        let turned: Vec<[f64; 3]> = bent.iter().rev().copied().collect();
        let measures = |polygon: &Polygon| (polygon.area(), polygon.normal(), polygon.centroid());
        let (turned, reversed) = (Polygon::new(&turned).unwrap(), Polygon::new(&bent).unwrap().reversed());
        assert!(measures(&turned) != measures(&reversed), "measured from another corner it has other measures");
    }

    #[test]
    fn what_is_stored_is_no_polygon_unless_it_is_one() {
        let stored = |vertices: &[[f64; 3]]| {
            let vertices = vertices.iter().map(|&vertex| DVec3::from(vertex)).collect();
            let bytes = postcard::to_stdvec(&Stored { vertices, is_reversed: true }).unwrap();
            postcard::from_bytes::<Polygon>(&bytes)
        };
        assert!(stored(&SQUARE).is_ok() && stored(&SQUARE[..2]).is_err());
        assert!(stored(&[[0.0; 3], [1.0, 0.0, 0.0], [f64::NAN, 1.0, 0.0]]).is_err());
    }

    #[test]
    fn the_normal_of_a_needle_is_exact() {
        let corners = [[-0.69, 0.5, -1.0], [0.0, 1.0, 0.5], [0.0, 1.000000001, 0.5]];
        let want = DVec3::new(-1.5, 0.0, 0.69).normalize();
        for turn in 0..3 {
            let needle = Polygon::new(&[corners[turn], corners[(turn + 1) % 3], corners[(turn + 2) % 3]]).unwrap();
            assert!(DVec3::from(needle.normal()).distance(want) < 1e-15, "{:?}", needle.normal());
        }
    }

    #[test]
    fn what_is_no_polygon_is_refused() {
        assert_eq!(Polygon::new(&SQUARE[..2]), Err(PolygonError::TooFewVertices(2)));
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let mut vertices = SQUARE;
            vertices[2][1] = bad;
            assert_eq!(Polygon::new(&vertices), Err(PolygonError::NotFinite(2)));
        }
        let mut vertices = SQUARE;
        vertices[2][2] = 0.1;
        assert_eq!(Polygon::new(&vertices), Err(PolygonError::NotPlanar));
        let mut vertices = SQUARE;
        vertices[2] = [0.2, 0.2, 0.0];
        assert_eq!(Polygon::new(&vertices), Err(PolygonError::NotConvex));
    }

    #[test]
    fn huge_coordinates_are_refused_not_turned_into_infinite_areas() {
        let polygon = Polygon::new(&SQUARE.map(|v| v.map(|x| 1e200 * x)));
        assert!(polygon.is_err(), "{polygon:?}");
    }

    #[test]
    fn a_pentagram_turns_the_right_way_everywhere_and_is_still_refused() {
        let corner = |k: i32| {
            let (sin, cos) = (f64::from(k) * 2.0 * std::f64::consts::TAU / 5.0).sin_cos();
            [cos, sin, 0.0]
        };
        assert_eq!(Polygon::new(&[0, 1, 2, 3, 4].map(corner)), Err(PolygonError::NotConvex));
    }
}
