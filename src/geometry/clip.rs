//! Cutting a convex polygon: to what is in front of a plane, or in halves.

use glam::DVec3;

use super::Facet;
use super::polygon::twice_vector_area;

/// How far from the plane through `b` a point `a` that lies on it may seem to be, in metres: what rounding of the coordinates and of
/// the dot product leaves.
#[inline(always)]
pub(crate) fn plane_noise(a: DVec3, b: DVec3) -> f64 {
    const ULPS: f64 = 8.0;
    ULPS * f64::EPSILON * (a.abs() + b.abs()).max_element()
}

/// A planar convex polygon that owns its vertices: a part of a [`Facet`].
#[derive(Clone, Debug)]
pub(crate) struct ClippedFacet {
    vertices: Vec<DVec3>,
    normal: DVec3,
    area: f64,
    centroid: DVec3,
    radius: f64,
}

impl ClippedFacet {
    /// All of a polygon.
    pub fn copy_of(facet: &Facet<'_>) -> Self {
        let Facet { vertices, normal, area, centroid, radius } = *facet;
        Self { vertices: vertices.to_vec(), normal, area, centroid, radius }
    }

    /// The polygon, borrowed.
    pub fn facet(&self) -> Facet<'_> {
        Facet { vertices: &self.vertices, normal: self.normal, area: self.area, centroid: self.centroid, radius: self.radius }
    }

    /// The polygon with these vertices and this normal, unless it has no area.
    fn measured(vertices: Vec<DVec3>, normal: DVec3) -> Option<Self> {
        let origin = *vertices.first()?;

        // Area and centroid by the fan around vertex 0, as for a polygon of the scene.
        let (mut twice_area, mut moment) = (0.0, DVec3::ZERO);
        for pair in vertices.get(1..)?.windows(2) {
            let twice = twice_vector_area(origin, pair[0], pair[1]).dot(normal);
            twice_area += twice;
            moment += twice * ((pair[0] - origin) + (pair[1] - origin));
        }
        if twice_area.is_nan() || twice_area <= 0.0 {
            return None;
        }
        let centroid = origin + moment / (3.0 * twice_area);
        let radius = vertices.iter().map(|v| v.distance_squared(centroid)).fold(0.0, f64::max).sqrt();
        Some(Self { vertices, normal, area: 0.5 * twice_area, centroid, radius })
    }
}

/// The part of a polygon that is in front of the plane of another; `None` if nothing is.
pub(crate) fn in_front(facet: &Facet<'_>, of: &Facet<'_>) -> Option<ClippedFacet> {
    match clip_to_front(facet, of.vertices[0], of.normal) {
        Clip::Whole => Some(ClippedFacet::copy_of(facet)),
        Clip::Part(part) => Some(part),
        Clip::Nothing => None,
    }
}

/// `facet` cut in two through its centroid, across the line to its farthest vertex; fewer where a half has no area.
pub(crate) fn halves(facet: &Facet<'_>) -> impl Iterator<Item = ClippedFacet> {
    let to_vertex = facet.vertices.iter().map(|&v| v - facet.centroid);
    let farthest = to_vertex.max_by(|a, b| a.length_squared().total_cmp(&b.length_squared())).unwrap_or(DVec3::X);
    let across = farthest.normalize_or_zero();
    [across, -across].into_iter().filter_map(|normal| match clip_to_front(facet, facet.centroid, normal) {
        Clip::Part(half) => Some(half),
        Clip::Whole | Clip::Nothing => None,
    })
}

/// What a plane leaves of a polygon.
#[derive(Clone, Debug)]
pub(crate) enum Clip {
    /// Everything is in front of the plane or on it.
    Whole,
    /// The part that is in front.
    Part(ClippedFacet),
    /// Nothing is in front, within rounding.
    Nothing,
}

/// The part of `facet` in front of the plane through `origin` with unit normal `normal` (Sutherland, Hodgman 1974, one plane).
///
/// Vertices within rounding of the plane count as lying on it.
pub(crate) fn clip_to_front(facet: &Facet<'_>, origin: DVec3, normal: DVec3) -> Clip {
    let height = |v: DVec3| {
        let height = normal.dot(v - origin);
        if height.abs() <= plane_noise(v, origin) { 0.0 } else { height }
    };

    // Most polygons are on one side, and most of those by far.
    let centre = normal.dot(facet.centroid - origin);
    let reach = facet.radius + plane_noise(facet.centroid, origin);
    if centre >= reach {
        return Clip::Whole;
    }
    if centre <= -reach {
        return Clip::Nothing;
    }
    let (mut lowest, mut highest) = (f64::INFINITY, f64::NEG_INFINITY);
    for &v in facet.vertices {
        let height = height(v);
        (lowest, highest) = (lowest.min(height), highest.max(height));
    }
    if highest <= 0.0 {
        return Clip::Nothing;
    }
    if lowest >= 0.0 {
        return Clip::Whole;
    }

    // Keep what is above, and the two crossings.
    let mut kept = Vec::with_capacity(facet.vertices.len() + 1);
    let mut a = facet.vertices[facet.vertices.len() - 1];
    let mut height_a = height(a);
    for &b in facet.vertices {
        let height_b = height(b);
        if (height_a > 0.0 && height_b < 0.0) || (height_a < 0.0 && height_b > 0.0) {
            kept.push(a + (b - a) * (height_a / (height_a - height_b)));
        }
        if height_b >= 0.0 {
            kept.push(b);
        }
        (a, height_a) = (b, height_b);
    }
    ClippedFacet::measured(kept, facet.normal).map_or(Clip::Nothing, Clip::Part)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Polygon;

    fn square() -> Polygon {
        Polygon::new(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]).unwrap()
    }

    #[test]
    fn a_plane_through_the_middle_leaves_half() {
        let square = square();
        let Clip::Part(half) = clip_to_front(&square.facet(), DVec3::new(0.5, 0.0, 7.0), DVec3::X) else { panic!("not cut") };
        let half = half.facet();
        assert!((half.area - 0.5).abs() < 1e-15);
        assert!(half.centroid.distance(DVec3::new(0.75, 0.5, 0.0)) < 1e-15);
        assert_eq!(half.vertices.len(), 4);
    }

    #[test]
    fn a_plane_across_a_corner_leaves_a_pentagon() {
        let square = square();
        let normal = DVec3::new(1.0, 1.0, 0.0).normalize();
        let Clip::Part(rest) = clip_to_front(&square.facet(), DVec3::new(0.5, 0.0, 0.0), normal) else { panic!("not cut") };
        assert!((rest.facet().area - 0.875).abs() < 1e-15);
        assert_eq!(rest.facet().vertices.len(), 5);
    }

    #[test]
    fn a_plane_beside_the_polygon_leaves_all_or_nothing() {
        let square = square();
        assert!(matches!(clip_to_front(&square.facet(), DVec3::ZERO, DVec3::X), Clip::Whole));
        assert!(matches!(clip_to_front(&square.facet(), DVec3::X, DVec3::X), Clip::Nothing));
        assert!(matches!(clip_to_front(&square.facet(), DVec3::ZERO, DVec3::Z), Clip::Nothing));
    }

    #[test]
    fn halves_share_the_area_and_are_shorter() {
        let sliver = Polygon::new(&[[0.0, 0.0, 0.0], [8.0, 0.0, 0.0], [8.0, 0.1, 0.0], [0.0, 0.1, 0.0]]).unwrap();
        let sliver = sliver.facet();
        let halves: Vec<_> = halves(&sliver).collect();
        assert_eq!(halves.len(), 2);
        assert!((halves.iter().map(|half| half.facet().area).sum::<f64>() - sliver.area).abs() < 1e-15);
        assert!(halves.iter().all(|half| half.facet().radius < 0.51 * sliver.radius));
    }

    #[test]
    fn a_vertex_that_rounding_moved_off_the_plane_is_on_it() {
        let square = Polygon::new(&[[0.0, 0.0, -1e-17], [1.0, 0.0, 1e-17], [1.0, 1.0, 1.0], [0.0, 1.0, 1.0]]).unwrap();
        assert!(matches!(clip_to_front(&square.facet(), DVec3::new(5.0, 5.0, 0.0), DVec3::Z), Clip::Whole));
    }
}
