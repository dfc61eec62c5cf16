//! What of each texel faces cover, and where its value is taken.
//!
//! A face covers a texel by the area of its part within the texel's square, exactly. The value of a texel is taken at its site: the middle of the
//! square if all of it is covered, else the centroid of the largest part. A function that is linear there has its mean over that part at the site.

use glam::{DVec2, DVec3};

use super::charts::Chart;
use crate::scene::{Scene, SurfaceId};

/// A texel is covered if no less than this part of it is: below lies what rounding makes.
const LEAST_COVERED: f64 = 1e-6;

/// All of a texel is covered if no more than this is not.
const ROUNDING: f64 = 1e-4;

/// A middle so near to an edge, in texels, is on both of its sides.
const ON_EDGE: f64 = 1e-9;

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
    let mut has_middle = vec![false; columns * rows];
    for (surface, corners) in chart.polygons(scene) {
        let bound = |pick: fn(DVec2, DVec2) -> DVec2| corners.iter().copied().fold(corners[0], pick);
        let (from, to) = (bound(DVec2::min).floor().max(DVec2::ZERO), bound(DVec2::max).ceil());
        for row in from.y as usize..(to.y as usize).min(rows) {
            for column in from.x as usize..(to.x as usize).min(columns) {
                let middle = DVec2::new(column as f64, row as f64) + 0.5;
                let Some(part) = part_of(&corners, middle) else { continue };
                let (site, has_middle) = (&mut sites[row * columns + column], &mut has_middle[row * columns + column]);
                add(site, has_middle, surface, part);
            }
        }
    }
    for (site, has_middle) in sites.iter_mut().zip(has_middle) {
        if f64::from(site.covered) < LEAST_COVERED {
            *site = Site::NONE;
        } else if has_middle && f64::from(site.covered) >= 1.0 - ROUNDING {
            site.at = [0.0; 2];
        }
    }
    sites
}

/// The part of a texel that a face covers.
struct Part {
    area: f64,
    /// From the middle of the texel, in texels.
    centroid: DVec2,
    has_middle: bool,
}

/// Adds a part: the face that covers the middle comes before others, then the largest part.
fn add(site: &mut Site, has_middle: &mut bool, surface: SurfaceId, part: Part) {
    site.covered += part.area as f32;
    let comes_first = (part.has_middle, part.area as f32) > (*has_middle, site.part);
    if comes_first && part.area > 0.0 {
        *has_middle = part.has_middle;
        (site.surface, site.part, site.at) = (surface.0, part.area as f32, part.centroid.as_vec2().to_array());
    }
}

/// The part of the texel around `middle` within a convex polygon, counter-clockwise; `None` if there is none.
fn part_of(corners: &[DVec2], middle: DVec2) -> Option<Part> {
    // Edges that the square is wholly inside or outside of tell for most texels.
    let (mut is_inside, mut has_middle) = (true, true);
    for (k, &from) in corners.iter().enumerate() {
        let edge = corners[(k + 1) % corners.len()] - from;
        let (distance, reach) = (edge.perp_dot(middle - from), 0.5 * (edge.x.abs() + edge.y.abs()));
        if distance <= -reach {
            return None;
        }
        is_inside &= distance >= reach;
        has_middle &= distance >= -ON_EDGE * edge.length();
    }
    if is_inside {
        return Some(Part { area: 1.0, centroid: DVec2::ZERO, has_middle: true });
    }

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
    (area > 0.0).then(|| Part { area, centroid: moment / area, has_middle })
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
    fn what_texels_cover_adds_up_to_the_area_and_its_moments() {
        let triangle = [[0.0, 0.0, 1.0], [2.03, 0.1, 1.0], [0.4, 1.7, 1.0]];
        let (scene, chart) = chart_of(&[&triangle], 0.1);
        let facet = scene.surface(SurfaceId(0)).polygon.facet();
        let (mut area, mut moment) = (0.0, DVec3::ZERO);
        for (number, site) in sites(&scene, &chart).iter().enumerate().filter(|(_, site)| site.is_covered()) {
            let point = site.point(&scene, &chart, [number % chart.size()[0], number / chart.size()[0]]);
            assert!(facet.distance_to(point) < 1e-7, "a site is off the face");
            area += f64::from(site.covered) * 0.01;
            moment += f64::from(site.covered) * 0.01 * point;
        }
        assert!((area / facet.area - 1.0).abs() < 1e-5, "{area}, want {}", facet.area);
        assert!((moment / area).distance(facet.centroid) < 1e-6);
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
