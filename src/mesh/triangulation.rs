//! The first triangles of a surface: a constrained Delaunay triangulation of its polygon, along lines across which its light has a kink or a step
//! (the triangulation is spade's), bisected until none is large.

use glam::DVec2;
use spade::handles::FixedVertexHandle;
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation as _};

use super::bisection::{NONE, Triangles};

/// Points closer than this part of the polygon's size are one.
const WELDED: f64 = 1e-9;

/// The square of an edge is at most so many times the largest area: along a narrow strip light changes as it does on what is wider.
const MOST_STRETCHED: f64 = 4.0;

/// A line within a polygon.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Line {
    pub ends: [DVec2; 2],
    /// Whether light may have a step there: values are not shared across it.
    pub is_step: bool,
}

/// Triangulates a convex polygon, counter-clockwise, along some lines within it; no triangle is larger than `largest` m^2, or much longer than that. Lines that cross others
/// before them are left out.
pub(super) fn triangulate(polygon: &[DVec2], lines: &[Line], largest: f64) -> Triangles {
    let size = polygon.iter().map(|corner| corner.abs().max_element()).fold(0.0, f64::max);
    let mut cdt = ConstrainedDelaunayTriangulation::<Point2<f64>>::new();
    let insert = |cdt: &mut ConstrainedDelaunayTriangulation<Point2<f64>>, at: DVec2| -> Option<FixedVertexHandle> {
        let rounded = (at / (WELDED * size)).round() * (WELDED * size);
        cdt.insert(Point2::new(rounded.x, rounded.y)).ok()
    };

    // The corners, then the lines, the more important ones first.
    for &corner in polygon {
        insert(&mut cdt, corner);
    }
    for line in lines {
        let [from, to] = line.ends.map(|end| insert(&mut cdt, end));
        if let (Some(from), Some(to)) = (from, to)
            && from != to
            && cdt.can_add_constraint(from, to)
        {
            cdt.add_constraint(from, to);
        }
    }
    let mut triangles = Builder::new(&cdt, lines, WELDED * size).build();

    // None is large.
    let mut number = 0;
    while number < triangles.triangles.len() as u32 {
        if triangles.area(number) > largest || triangles.longest_sq(number) > MOST_STRETCHED * largest {
            triangles.bisect(number);
        } else {
            number += 1;
        }
    }
    triangles
}

/// Turns spade's triangulation into ours.
struct Builder<'a> {
    cdt: &'a ConstrainedDelaunayTriangulation<Point2<f64>>,
    lines: &'a [Line],
    /// What is nearer to a line lies on it, in metres.
    tolerance: f64,
    /// By face of spade: the number of the triangle.
    numbers: Vec<u32>,
}

impl<'a> Builder<'a> {
    fn new(cdt: &'a ConstrainedDelaunayTriangulation<Point2<f64>>, lines: &'a [Line], tolerance: f64) -> Self {
        let mut numbers = vec![NONE; cdt.num_all_faces()];
        let mut count = 0;
        for face in cdt.inner_faces() {
            let [a, b, c] = face.positions().map(|at| DVec2::new(at.x, at.y));
            let longest_sq = a.distance_squared(b).max(b.distance_squared(c)).max(c.distance_squared(a));
            if (b - a).perp_dot(c - a) > tolerance * longest_sq.sqrt() {
                numbers[face.fix().index()] = count;
                count += 1;
            }
        }
        Self { cdt, lines, tolerance, numbers }
    }

    fn build(&self) -> Triangles {
        // Corners by spade's vertices, and neighbours where no step is between.
        let mut corners = Vec::new();
        let mut triangles = Vec::new();
        for face in self.cdt.inner_faces().filter(|face| self.numbers[face.fix().index()] != NONE) {
            let edges = face.adjacent_edges();
            corners.push(edges.map(|edge| edge.from().fix().index() as u32));
            let neighbours = edges.map(|edge| {
                let other = edge.rev().face();
                let is_open = !other.is_outer() && !(edge.is_constraint_edge() && self.is_step(edge.positions()));
                if is_open { self.numbers[other.fix().index()] } else { NONE }
            });
            triangles.push(neighbours);
        }
        let at = |vertex: u32| {
            let at = self.cdt.vertex(FixedVertexHandle::from_index(vertex as usize)).position();
            DVec2::new(at.x, at.y)
        };
        Triangles::new(&corners, &triangles, at)
    }

    /// Whether light may have a step across an edge.
    fn is_step(&self, ends: [Point2<f64>; 2]) -> bool {
        let ends = ends.map(|at| DVec2::new(at.x, at.y));
        let is_on = |line: &Line, point: DVec2| {
            let [from, to] = line.ends;
            let along = to - from;
            let nearest = from + ((point - from).dot(along) / along.length_squared()).clamp(0.0, 1.0) * along;
            nearest.distance(point) <= 2.0 * self.tolerance
        };
        self.lines.iter().any(|line| line.is_step && ends.iter().all(|&end| is_on(line, end)))
    }
}
