//! What a view sees of surfaces: the points that the rays through its pixels meet, and how much of a pixel each makes up.
//!
//! The error of a picture is one over its pixels. So is that of a function which is made for the picture: an element weighs as much as the pixels
//! that it covers, and is held against the light at points that were drawn from what these show.

use std::ops::Range;

use glam::{DVec2, DVec3};

use super::bisection::{Halving, Triangles};
use super::element;
use super::locate::Locator;
use super::plane::Plane;
use super::surface_mesh::SurfaceMesh;
use crate::geometry::sampling;
use crate::scene::{Scene, SurfaceId};

/// A point of a surface that a ray through a pixel meets.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SeenPoint {
    surface: SurfaceId,
    /// In the plane of the surface, in metres.
    at: [f32; 2],
    /// The part of a pixel that it makes up.
    share: f32,
}

/// All that is seen of the surfaces of a scene.
pub(crate) struct SeenSurfaces {
    planes: Vec<Plane>,
    points: Vec<Vec<SeenPoint>>,
}

impl SeenSurfaces {
    /// Nothing yet.
    pub fn new(scene: &Scene) -> Self {
        let planes: Vec<Plane> = (0..scene.surfaces().len() as u32).map(|number| Plane::of(scene, SurfaceId(number))).collect();
        Self { points: vec![Vec::new(); planes.len()], planes }
    }

    /// A point, in metres, that makes up some part of a pixel.
    pub fn point(&self, surface: SurfaceId, point: DVec3, share: f64) -> SeenPoint {
        SeenPoint { surface, at: self.planes[surface.index()].to_plane(point).as_vec2().to_array(), share: share as f32 }
    }

    /// Adds points.
    pub fn extend(&mut self, points: impl IntoIterator<Item = SeenPoint>) {
        points.into_iter().for_each(|point| self.points[point.surface.index()].push(point));
    }

    /// Bytes that these take, and while a mesh is made of them: elements have copies, twice while they are sorted.
    pub fn bytes_at_work(&self) -> u64 {
        Self::bytes_of(self.points.iter().map(Vec::len).sum())
    }

    /// The same of so many points.
    pub fn bytes_of(points: usize) -> u64 {
        (3 * points * size_of::<SeenPoint>()) as u64
    }

    /// How many pixels a surface covers.
    pub fn weight(&self, surface: SurfaceId) -> f64 {
        weight_of(&self.points[surface.index()])
    }

    /// What is seen of a surface.
    pub(super) fn of(&self, surface: SurfaceId) -> &[SeenPoint] {
        &self.points[surface.index()]
    }
}

/// What is seen of a surface, by the triangle that it lies in.
pub(super) struct SeenTriangles {
    /// In the order of the triangles, and the range of each.
    points: Vec<SeenPoint>,
    ranges: Vec<Range<u32>>,
    /// By triangle, how many pixels it covers.
    weights: Vec<f64>,
}

impl SeenPoint {
    fn at(&self) -> DVec2 {
        DVec2::from(self.at.map(f64::from))
    }
}

impl SeenTriangles {
    pub fn new(points: &[SeenPoint], triangles: &Triangles) -> Self {
        // What has no triangles is too small to be seen.
        let count = triangles.triangles.len();
        let points = if count == 0 { &[] } else { points };
        let (mesh, mut last) = (SurfaceMesh::new(triangles, Vec::new()), 0);
        let locator = Locator::new(&mesh);

        // Neighbours are mostly in the same triangle.
        let mut by_triangle = vec![Vec::new(); count];
        for point in points {
            let is_outside = |triangle: usize| element::barycentric(mesh.corners(triangle), point.at()).iter().any(|&l| l < 0.0);
            if is_outside(last)
                && let Some((triangle, _)) = locator.find(&mesh, point.at())
            {
                last = triangle;
            }
            by_triangle[last].push(*point);
        }

        let mut all = Self { points: Vec::with_capacity(points.len()), ranges: Vec::with_capacity(count), weights: Vec::new() };
        for points in by_triangle {
            let start = all.points.len() as u32;
            all.weights.push(weight_of(&points));
            all.points.extend(points);
            all.ranges.push(start..all.points.len() as u32);
        }
        all
    }

    /// How many pixels a triangle covers.
    pub fn weight(&self, triangle: u32) -> f64 {
        self.weights[triangle as usize]
    }

    /// A point of a triangle that is seen, in the surface's plane, each by what it makes up of a pixel.
    pub fn sampled(&self, triangle: u32, draw: u64) -> Option<DVec2> {
        let points = &self.points[range(&self.ranges[triangle as usize])];
        let wanted = sampling::unit(draw) * self.weight(triangle);
        let mut below = 0.0;
        let found = points.iter().find(|point| {
            below += f64::from(point.share);
            below > wanted
        });
        found.or(points.last()).map(SeenPoint::at)
    }

    /// Follows a triangle that was halved.
    pub fn halve(&mut self, Halving { halves: [first, second], cut: [from, to] }: Halving) {
        let all = self.ranges[first as usize].clone();
        let points = &mut self.points[range(&all)];
        let is_first = |point: &SeenPoint| (to - from).perp_dot(point.at() - from) >= 0.0;

        // Those of the first half come first.
        let mut count = 0;
        for number in 0..points.len() {
            if is_first(&points[number]) {
                points.swap(count, number);
                count += 1;
            }
        }
        let (of_first, of_second) = points.split_at(count);
        let (first_weight, second_weight) = (weight_of(of_first), weight_of(of_second));
        let middle = all.start + count as u32;
        self.ranges.resize(self.ranges.len().max(second as usize + 1), 0..0);
        self.weights.resize(self.ranges.len(), 0.0);
        (self.ranges[first as usize], self.ranges[second as usize]) = (all.start..middle, middle..all.end);
        (self.weights[first as usize], self.weights[second as usize]) = (first_weight, second_weight);
    }
}

fn range(range: &Range<u32>) -> Range<usize> {
    range.start as usize..range.end as usize
}

fn weight_of(points: &[SeenPoint]) -> f64 {
    points.iter().fold(0.0, |sum, point| sum + f64::from(point.share))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::bends::Bends;
    use crate::mesh::triangulation::triangulate;

    const SQUARE: [DVec2; 4] = [DVec2::new(-1.0, -1.0), DVec2::new(1.0, -1.0), DVec2::ONE, DVec2::new(-1.0, 1.0)];

    /// Points of one corner of a square, as far as it is seen.
    fn in_a_corner(count: u64) -> Vec<SeenPoint> {
        let random = |number: u64, which: u64| (sampling::unit(sampling::hash(number, which)) - 1.0) as f32;
        let point = |number| SeenPoint { surface: SurfaceId(0), at: [random(number, 0), random(number, 1)], share: 0.25 };
        (0..count).map(point).collect()
    }

    #[test]
    fn points_follow_the_triangles_that_are_halved() {
        let points = in_a_corner(2000);
        let mut triangles = triangulate(&SQUARE, &[], f64::INFINITY, 0.0);
        let mut seen = SeenTriangles::new(&points, &triangles);
        for step in 0..300 {
            triangles.bisect((step * 7) % triangles.triangles.len() as u32, &mut Bends::unknown());
            std::mem::take(&mut triangles.halvings).into_iter().for_each(|halving| seen.halve(halving));
        }
        let mut found = 0;
        for number in 0..triangles.triangles.len() as u32 {
            let points = &seen.points[range(&seen.ranges[number as usize])];
            found += points.len();
            assert_eq!(seen.weight(number), 0.25 * points.len() as f64);
            for point in points {
                let least = element::barycentric(triangles.corners(number), point.at()).into_iter().fold(1.0, f64::min);
                assert!(least > -1e-9, "{:?} lies outside of its triangle by {least}", point.at());
            }
        }
        assert_eq!(found, points.len());
    }
}
