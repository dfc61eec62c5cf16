//! What of each texel faces cover, and where its value is taken.
//!
//! A face covers a texel by the area of its part within the texel's square, exactly. The value of a texel is taken at its site: the middle of the
//! square where a face covers that, for textures are interpolated between middles; else the centroid of the largest part, where a function that is
//! linear there has its mean over that part.

use glam::{DVec2, DVec3};

use super::charts::Chart;
use crate::scene::{Scene, SurfaceId};

/// A texel is covered if no less than this part of it is: below lies what rounding makes.
const LEAST_COVERED: f64 = 1e-6;

/// All of a texel is covered if no more than this is not.
const ROUNDING: f64 = 1e-4;

/// A middle so near to an edge, in texels, is on both of its sides. If nothing covers the other side, no value is taken there: whether a wall that
/// stands on the edge is before or behind it, is a matter of rounding.
const ON_EDGE: f64 = 1e-6;

/// Where the value of a texel is taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Site {
    /// The surface that it lies on; [`NO_SURFACE`] if nothing covers the texel.
    pub surface: u32,
    /// From the middle of the texel, in texels.
    at: [f32; 2],
    /// The part of the texel that is covered, and the largest that one face covers.
    pub covered: f32,
    part: f32,
}

/// Of a texel that nothing covers.
pub(super) const NO_SURFACE: u32 = u32::MAX;

impl Site {
    const NONE: Self = Self { surface: NO_SURFACE, at: [0.0; 2], covered: 0.0, part: 0.0 };

    /// Whether the texel has a value.
    pub fn is_covered(&self) -> bool {
        self.surface != NO_SURFACE
    }

    /// Where in the texel its value is taken, in texels from the middle.
    pub fn offset(&self) -> [f32; 2] {
        self.at
    }

    /// Takes the texel's value away; faces cover it as before.
    pub fn hide(&mut self) {
        self.surface = NO_SURFACE;
    }

    /// Moves the site, in texels from the middle.
    pub fn move_to(&mut self, at: DVec2) {
        self.at = at.as_vec2().to_array();
    }

    /// The site of the texel of a chart in this column and row, in its surface's plane.
    pub fn point(&self, scene: &Scene, chart: &Chart, [column, row]: [usize; 2]) -> DVec3 {
        let middle = DVec2::new(column as f64, row as f64) + 0.5;
        let point = chart.to_space(middle + DVec2::from(self.at.map(f64::from)));
        let facet = scene.surface(SurfaceId(self.surface)).polygon.facet();
        point - facet.height(point) * facet.normal
    }
}

/// The sites of a chart, row after row.
pub(super) fn sites(scene: &Scene, chart: &Chart) -> Vec<Site> {
    let [columns, rows] = chart.size();
    let mut sites = vec![Site::NONE; columns * rows];
    let mut middles = vec![Middle::Beside; columns * rows];
    for (surface, corners) in chart.polygons(scene) {
        let bound = |pick: fn(DVec2, DVec2) -> DVec2| corners.iter().copied().fold(corners[0], pick);
        let (from, to) = (bound(DVec2::min).floor().max(DVec2::ZERO), bound(DVec2::max).ceil());
        for row in from.y as usize..(to.y as usize).min(rows) {
            for column in from.x as usize..(to.x as usize).min(columns) {
                let middle = DVec2::new(column as f64, row as f64) + 0.5;
                let Some(part) = part_of(&corners, middle) else { continue };
                let (site, middle) = (&mut sites[row * columns + column], &mut middles[row * columns + column]);
                add(site, middle, surface, part);
            }
        }
    }
    for (site, middle) in sites.iter_mut().zip(middles) {
        let is_whole = f64::from(site.covered) >= 1.0 - ROUNDING;
        if f64::from(site.covered) < LEAST_COVERED {
            *site = Site::NONE;
        } else if middle == Middle::Within || (middle == Middle::OnEdge && is_whole) {
            site.at = [0.0; 2];
        }
    }
    sites
}

/// Where the middle of a texel lies as seen from a face.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
enum Middle {
    Beside,
    OnEdge,
    Within,
}

/// The part of a texel that a face covers.
struct Part {
    area: f64,
    /// From the middle of the texel, in texels.
    centroid: DVec2,
    middle: Middle,
}

/// Adds a part: the face that covers the middle comes before others, then the largest part.
fn add(site: &mut Site, middle: &mut Middle, surface: SurfaceId, part: Part) {
    site.covered += part.area as f32;
    let comes_first = (part.middle, part.area as f32) > (*middle, site.part);
    if comes_first && part.area > 0.0 {
        *middle = part.middle;
        (site.surface, site.part, site.at) = (surface.0, part.area as f32, part.centroid.as_vec2().to_array());
    }
}

/// The part of the texel around `middle` within a convex polygon, counter-clockwise; `None` if there is none.
fn part_of(corners: &[DVec2], middle: DVec2) -> Option<Part> {
    // Edges that the square is wholly inside or outside of tell for most texels.
    let (mut is_inside, mut nearest) = (true, f64::INFINITY);
    for (k, &from) in corners.iter().enumerate() {
        let edge = corners[(k + 1) % corners.len()] - from;
        let (distance, reach) = (edge.perp_dot(middle - from), 0.5 * (edge.x.abs() + edge.y.abs()));
        if distance <= -reach {
            return None;
        }
        is_inside &= distance >= reach;
        nearest = nearest.min(distance / edge.length());
    }
    if is_inside {
        return Some(Part { area: 1.0, centroid: DVec2::ZERO, middle: Middle::Within });
    }
    let lies = if nearest > ON_EDGE {
        Middle::Within
    } else if nearest >= -ON_EDGE {
        Middle::OnEdge
    } else {
        Middle::Beside
    };

    // Area and centroid of what is left within the four sides.
    let mut part: Vec<DVec2> = corners.iter().map(|&corner| corner - middle).collect();
    for side in [DVec2::X, DVec2::NEG_X, DVec2::Y, DVec2::NEG_Y] {
        part = cut(&part, |corner| 0.5 - side.dot(corner));
    }
    let (&first, rest) = part.split_first()?;
    let (mut area, mut moment) = (0.0, DVec2::ZERO);
    for pair in rest.windows(2) {
        let triangle = 0.5 * (pair[0] - first).perp_dot(pair[1] - first);
        area += triangle;
        moment += triangle * (first + pair[0] + pair[1]) / 3.0;
    }
    (area > 0.0).then(|| Part { area, centroid: moment / area, middle: lies })
}

/// The part of a convex polygon where `height` is not negative (Sutherland, Hodgman 1974).
pub(super) fn cut(polygon: &[DVec2], height: impl Fn(DVec2) -> f64) -> Vec<DVec2> {
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (k, &corner) in polygon.iter().enumerate() {
        let next = polygon[(k + 1) % polygon.len()];
        let (here, there) = (height(corner), height(next));
        if here >= 0.0 {
            kept.push(corner);
        }
        if (here < 0.0) != (there < 0.0) {
            kept.push(corner.lerp(next, here / (here - there)));
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bake::charts::charts;
    use crate::geometry::Polygon;
    use crate::scene::{Material, Sides};

    fn chart_of(polygons: &[&[[f64; 3]]], texel: f64) -> (Scene, Chart) {
        let material = Material { name: String::new(), reflectance: vec![0.5], exitance: vec![0.0] };
        let faces = polygons.iter().zip(0..).map(|(corners, face)| (Polygon::new(corners).unwrap(), 0, face)).collect();
        let scene = Scene::new(1, vec![material], faces, Sides::Front).unwrap();
        let chosen = vec![true; polygons.len()];
        let mut charts = charts(&scene, &chosen, texel);
        assert_eq!(charts.len(), 1);
        (scene, charts.remove(0))
    }

    #[test]
    fn what_texels_cover_adds_up_to_the_area_and_sites_are_middles_where_these_are_covered() {
        let triangle = [[0.0, 0.0, 1.0], [2.03, 0.1, 1.0], [0.4, 1.7, 1.0]];
        let (scene, chart) = chart_of(&[&triangle], 0.1);
        let facet = scene.surface(SurfaceId(0)).polygon.facet();
        let (mut area, mut beside) = (0.0, 0);
        for (number, site) in sites(&scene, &chart).iter().enumerate().filter(|(_, site)| site.is_covered()) {
            let [column, row] = [number % chart.size()[0], number / chart.size()[0]];
            let point = site.point(&scene, &chart, [column, row]);
            assert!(facet.distance_to(point) < 1e-7, "a site is off the face");
            let middle = chart.to_space(DVec2::new(column as f64, row as f64) + 0.5);
            let is_middle = point.distance(middle) < 1e-9;
            assert_eq!(is_middle, facet.contains(middle), "texel {column}, {row}");
            beside += usize::from(!is_middle);
            area += f64::from(site.covered) * 0.01;
        }
        assert!((area / facet.area - 1.0).abs() < 1e-5, "{area}, want {}", facet.area);
        assert!(beside > 20, "{beside} sites beside middles");
    }

    #[test]
    fn parts_have_the_area_and_the_moment_of_their_face() {
        let corners = [DVec2::new(0.3, 0.2), DVec2::new(7.1, 1.4), DVec2::new(5.6, 4.9), DVec2::new(1.2, 3.7)];
        let (mut area, mut moment) = (0.0, DVec2::ZERO);
        for (column, row) in (0..8).flat_map(|column| (0..5).map(move |row| (column, row))) {
            let middle = DVec2::new(f64::from(column), f64::from(row)) + 0.5;
            if let Some(part) = part_of(&corners, middle) {
                area += part.area;
                moment += part.area * (middle + part.centroid);
            }
        }
        // By the two triangles on both sides of a diagonal.
        let [a, b, c, d] = corners;
        let [first, second] = [(b - a).perp_dot(c - a), (c - a).perp_dot(d - a)].map(|doubled| 0.5 * doubled);
        assert!((area - first - second).abs() < 1e-12, "{area}");
        assert!(moment.distance((first * (a + b + c) + second * (a + c + d)) / 3.0) < 1e-12, "{moment}");
    }

    #[test]
    fn texels_that_faces_share_are_whole_and_slivers_have_texels_of_their_own() {
        let left = [[0.0, 0.0, 0.0], [1.05, 0.0, 0.0], [0.95, 1.0, 0.0], [0.0, 1.0, 0.0]];
        let right = [[1.05, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 1.0, 0.0], [0.95, 1.0, 0.0]];
        let (scene, chart) = chart_of(&[&left, &right], 0.1);
        let sites_of_both = sites(&scene, &chart);
        assert!(sites_of_both.iter().all(|site| site.at == [0.0; 2] && site.covered > 0.999));
        assert!((0..2).all(|surface| sites_of_both.iter().any(|site| site.surface == surface)));

        let (scene, chart) = chart_of(&[&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 0.003, 0.0], [0.0, 0.003, 0.0]]], 0.1);
        let sites = sites(&scene, &chart);
        assert_eq!((chart.size(), sites.len()), ([10, 1], 10));
        assert!(sites.iter().all(|site| (site.covered - 0.03).abs() < 1e-6));
    }
}
