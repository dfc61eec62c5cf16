//! The first triangles of a surface: a constrained Delaunay triangulation of its polygon, along lines across which its light has a kink or a step
//! (the triangulation is spade's), bisected until none is large.

use std::collections::HashMap;

use glam::DVec2;
use spade::handles::FixedVertexHandle;
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation as _};

use super::bends::Bends;
use super::bisection::{NONE, Triangles};
use super::crossings::split;
use super::line::Line;

/// Points closer than this part of the polygon's size are one.
const WELDED: f64 = 1e-9;

/// Triangulates a convex polygon, counter-clockwise, along some lines within it; no triangle is larger than `largest` m^2, or much longer than that. Lines that cross are
/// split there; what still crosses others before it, by rounding, is left out. A polygon too small for spade, below 1e-33 m, has no triangles.
/// Light at borders and steps is taken `clearance` metres inside, if there is room.
pub(super) fn triangulate(polygon: &[DVec2], lines: &[Line], largest: f64, clearance: f64) -> Triangles {
    let size = polygon.iter().map(|corner| corner.abs().max_element()).fold(0.0, f64::max);
    let lines = &split(lines, WELDED * size);
    let mut vertices = Vertices { cell: WELDED * size, numbers: HashMap::new(), places: Vec::new() };
    for &corner in polygon {
        vertices.number(corner);
    }
    let ends: Vec<[usize; 2]> = lines.iter().map(|line| line.ends.map(|end| vertices.number(end))).collect();

    // All vertices at once: spade may not find where to put one that comes after lines. Then the lines, the more important ones first.
    let Ok(mut cdt) = ConstrainedDelaunayTriangulation::<Point2<f64>>::bulk_load_cdt(vertices.places, Vec::new()) else {
        return Triangles::default();
    };
    for [from, to] in ends.into_iter().map(|ends| ends.map(FixedVertexHandle::from_index)) {
        if from != to && cdt.can_add_constraint(from, to) {
            cdt.add_constraint(from, to);
        }
    }
    let mut triangles = Builder::new(&cdt, lines, WELDED * size).build(clearance);

    // None is large.
    let mut number = 0;
    while number < triangles.triangles.len() as u32 {
        if triangles.is_large(number, largest) {
            triangles.bisect(number, &mut Bends::unknown());
        } else {
            number += 1;
        }
    }
    triangles
}

/// Places that are told apart.
struct Vertices {
    /// Places are rounded to multiples of it, in metres.
    cell: f64,
    numbers: HashMap<[i64; 2], usize>,
    places: Vec<Point2<f64>>,
}

impl Vertices {
    /// The number of the vertex at a place, a new one if none is there.
    fn number(&mut self, at: DVec2) -> usize {
        let rounded = (at / self.cell).round();
        *self.numbers.entry(rounded.as_i64vec2().to_array()).or_insert_with(|| {
            let place = rounded * self.cell;
            self.places.push(Point2::new(place.x, place.y));
            self.places.len() - 1
        })
    }
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

    fn build(&self, clearance: f64) -> Triangles {
        // Corners by spade's vertices, and neighbours where no step is between.
        let mut corners = Vec::new();
        let mut triangles = Vec::new();
        for face in self.cdt.inner_faces().filter(|face| self.numbers[face.fix().index()] != NONE) {
            let edges = face.adjacent_edges();
            corners.push(edges.map(|edge| edge.from().fix().index() as u32));
            let neighbours = edges.map(|edge| {
                let other = edge.rev().face();
                let is_cut = other.is_outer() || edge.is_constraint_edge() && self.is_step(edge.positions());
                if is_cut { NONE } else { self.numbers[other.fix().index()] }
            });
            triangles.push(neighbours);
        }
        let at = |vertex: u32| {
            let at = self.cdt.vertex(FixedVertexHandle::from_index(vertex as usize)).position();
            DVec2::new(at.x, at.y)
        };
        Triangles::new(&corners, &triangles, at, clearance)
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::sampling;

    /// Regular polygons, thin ones as well.
    fn polygon(corners: u32, height: f64) -> Vec<DVec2> {
        let corner =
            |k: u32| DVec2::from_angle(std::f64::consts::TAU * f64::from(k) / f64::from(corners)) * DVec2::new(1.0, height);
        (0..corners).map(corner).collect()
    }

    #[test]
    fn any_lines_give_triangles_that_fill_the_polygon() {
        for seed in 0..300_u64 {
            let random = |k: u64| sampling::unit(sampling::hash(seed, k));
            let polygon = polygon(3 + (seed % 6) as u32, if seed % 5 == 0 { 1e-3 } else { 0.7 });
            let count = polygon.len();

            // Lines between points inside, on a coarse grid, so that they touch, cross, repeat and lie in a row; some end at corners or edges.
            let inside = |k: u64| {
                let grid = |k: u64| if random(k + 7) < 0.7 { (random(k) * 4.0).floor() / 4.0 } else { random(k) };
                let (a, b) = (polygon[(random(k) * count as f64) as usize], polygon[(random(k + 1) * count as f64) as usize]);
                a.lerp(b, grid(k + 2)).lerp(polygon[0], if random(k + 3) < 0.3 { 0.0 } else { grid(k + 4) })
            };
            let line = |k: u64| Line { ends: [inside(20 * k), inside(20 * k + 10)], is_step: random(20 * k + 19) < 0.5 };
            let lines: Vec<Line> = (0..seed % 30).map(line).collect();
            let area = 0.5 * (0..count).map(|k| polygon[k].perp_dot(polygon[(k + 1) % count])).sum::<f64>();
            let triangles = triangulate(&polygon, &lines, 0.1 * area, 0.0);
            let all: Vec<f64> = (0..triangles.triangles.len() as u32).map(|triangle| triangles.area(triangle)).collect();
            assert!(all.iter().all(|&part| part > 0.0 && part <= 0.1 * area), "seed {seed}");
            assert!((all.iter().sum::<f64>() / area - 1.0).abs() < 1e-6, "seed {seed}: {} of {area}", all.iter().sum::<f64>());
        }
    }

    #[test]
    fn values_are_not_shared_across_a_step() {
        let square = [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y];
        let across = |is_step| [Line { ends: [DVec2::new(0.5, 0.0), DVec2::new(0.5, 1.0)], is_step }];
        let on_line = |of: &Triangles| of.nodes.iter().filter(|node| node.at.x == 0.5).count();
        let (open, cut) = (triangulate(&square, &across(false), 1.0, 0.0), triangulate(&square, &across(true), 1.0, 0.0));
        assert_eq!(on_line(&cut), 2 * on_line(&open));
        assert!(cut.nodes.iter().filter(|node| node.at.x == 0.5).all(|node| node.sampled_at.x != 0.5));
    }
}
