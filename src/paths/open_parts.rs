//! Open parts of cells: where a cell has a value.
//!
//! A cell has one value, the mean over it. A wall that stands on the surface parts the cell, and what lies close over it keeps
//! light away: there a mean says nothing about either side. So a cell in which something stands, or over which something
//! lies, is cut into squares. Squares that are crossed or covered have no value; of the others those that hang together are a part, and
//! the largest part has the cell's value. A path that arrives anywhere else goes on.
//!
//! That no light leaks through a wall is exact: squares are marked if the least of a surface is over them.

use std::collections::HashMap;
use std::sync::OnceLock;

use glam::{DVec2, DVec3};

use super::grid::Grid;
use super::grids::Grids;
use crate::geometry::{Aabb, ClippedFacet, Facet, sampling, streams};
use crate::scene::{Scene, Surface, SurfaceId};
use crate::transmittance::Rays;
use crate::visibility::SurfaceBoxes;

/// Squares along each side of a cell: 8 by 8 fill a machine word.
const SQUARES: u32 = 8;

/// What lies over a cell within this part of its size covers it. At least the width of two squares, since shadows of what is farther show
/// over so many; at most the distance from which cells have a value.
const COVERS_WITHIN: f64 = 0.25;

/// What reaches over the surface's edges by no more than this part of its radius only adjoins it: files round to six digits or more.
const TOUCHES_WITHIN: f64 = 1e-6;

/// What is no higher than this part of the radius lies in the surface's plane: rounding of the coordinates.
const IN_PLANE_WITHIN: f64 = 1e-9;

/// Squares of a cell, one bit each, row after row.
type Squares = u64;

/// The open parts of the cells of a scene; each surface's are found when they are first asked for.
pub(crate) struct OpenParts<'a> {
    scene: &'a Scene,
    rays: &'a Rays<'a>,
    /// By grid: the cells that are not open everywhere, by their index in the grid.
    parted: Vec<OnceLock<HashMap<u32, Squares>>>,
}

impl<'a> OpenParts<'a> {
    /// Bytes that a grid takes, and a cell, if it is not open everywhere: an entry of a table that is half full.
    pub const BYTES_OF_GRID: usize = size_of::<OnceLock<HashMap<u32, Squares>>>();
    pub const BYTES_OF_CELL: usize = 2 * (size_of::<(u32, Squares)>() + 1);

    pub fn new(scene: &'a Scene, rays: &'a Rays<'a>, grids: &Grids) -> Self {
        Self { scene, rays, parted: grids.grids().map(|_| OnceLock::new()).collect() }
    }

    /// Whether the cell that `point` of a surface lies in has a value there.
    pub fn contains(&self, surface: SurfaceId, grid: &Grid, point: DVec3) -> bool {
        let parted = self.of(surface, grid);
        if parted.is_empty() {
            return true;
        }
        let at = grid.in_squares(point, SQUARES);
        let [column, row] = [at.x, at.y].map(|along| along.max(0.0) as u32);
        let (column, row) = (column.min(SQUARES * grid.columns - 1), row.min(SQUARES * grid.rows - 1));
        let cell = row / SQUARES * grid.columns + column / SQUARES;
        parted.get(&cell).is_none_or(|open| open & square(column % SQUARES, row % SQUARES) != 0)
    }

    /// Where cell number `index` of the grid has a value; `None` if nowhere.
    pub fn part_of<'b>(&'b self, surface: SurfaceId, grid: &'b Grid, index: usize) -> Option<OpenPart<'b>> {
        if grid.over(index).is_some() {
            return None;
        }
        let facet = self.scene.surface(surface).polygon.facet();
        let shape = match self.of(surface, grid).get(&(index as u32)) {
            Some(0) => return None,
            Some(&open) => Shape::Squares(open),
            None => {
                let is_inside = |(u, v)| facet.contains(grid.point_in(index, u, v));
                let is_whole = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].into_iter().all(is_inside);
                if is_whole { Shape::Whole } else { Shape::Clipped(grid.part_of(&facet, index)?) }
            }
        };
        Some(OpenPart { facet, grid, index, shape })
    }

    /// The cells of a surface that are not open everywhere.
    fn of(&self, surface: SurfaceId, grid: &Grid) -> &HashMap<u32, Squares> {
        self.parted[grid.number as usize].get_or_init(|| {
            let marked = marked_squares(self.scene, self.rays.sheets(self.scene), surface, grid);
            let facet = self.scene.surface(surface).polygon.facet();
            let open_part = |(cell, marked): (u32, Squares)| {
                let centre = |number: u32| {
                    let [u, v] = [number % SQUARES, number / SQUARES].map(|k| (f64::from(k) + 0.5) / f64::from(SQUARES));
                    grid.point_in(cell as usize, u, v)
                };
                let on_surface = (0..64).filter(|&number| facet.contains(centre(number))).fold(0, |on, number| on | 1 << number);
                (cell, largest_part(on_surface & !marked))
            };
            marked.into_iter().map(open_part).collect()
        })
    }
}

/// Where a cell has a value.
pub(crate) struct OpenPart<'a> {
    facet: Facet<'a>,
    grid: &'a Grid,
    index: usize,
    shape: Shape,
}

enum Shape {
    /// All of the cell.
    Whole,
    /// What of it lies on the surface.
    Clipped(ClippedFacet),
    /// Some squares.
    Squares(Squares),
}

impl OpenPart<'_> {
    /// A random point of it.
    pub fn sampled_point(&self, seed: u64) -> DVec3 {
        let [u, v] = [seed, sampling::hash(seed, streams::SECOND)].map(sampling::unit);
        match &self.shape {
            Shape::Whole => self.grid.point_in(self.index, u, v),
            Shape::Clipped(part) => part.facet().point_at(u, v),
            &Shape::Squares(open) => {
                // A square by the first number, a point in it by what is left of that, and the second one.
                let count = open.count_ones();
                let chosen = ((u * f64::from(count)) as u32).min(count - 1);
                let number = (0..64).filter(|bit| open >> bit & 1 == 1).nth(chosen as usize).unwrap_or_default();
                let corner = [number % SQUARES, number / SQUARES].map(f64::from);
                let within = |at: [f64; 2]| {
                    let [u, v] = [0, 1].map(|k| (corner[k] + at[k]) / f64::from(SQUARES));
                    self.grid.point_in(self.index, u, v)
                };
                let point = within([u * f64::from(count) - f64::from(chosen), v]);
                if self.facet.contains(point) { point } else { within([0.5, 0.5]) }
            }
        }
    }
}

/// The bit of a square.
fn square(column: u32, row: u32) -> Squares {
    1 << (row * SQUARES + column)
}

/// By cell of a surface, the squares that something stands on or lies close over; cells without any are left out.
fn marked_squares(scene: &Scene, boxes: &SurfaceBoxes, id: SurfaceId, grid: &Grid) -> HashMap<u32, Squares> {
    let surface = scene.surface(id);
    let facet = surface.polygon.facet();
    let (lowest, highest) = (IN_PLANE_WITHIN * facet.radius, COVERS_WITHIN * grid.size());
    let above = grid.corners().into_iter().flat_map(|corner| [corner, corner + highest * facet.normal]);

    let mut marked = HashMap::new();
    let mut part = Vec::new();
    boxes.for_each_near(&Aabb::around(above), |other| {
        let other = scene.surface(other);
        if other.plane != surface.plane {
            part_over(surface, other, grid, lowest..highest, &mut part);
            mark(&part, grid, &mut marked);
        }
    });
    marked
}

/// The part of another surface over this one, at such heights: its corners in squares of the grid, and heights.
fn part_over(surface: &Surface, other: &Surface, grid: &Grid, heights: std::ops::Range<f64>, part: &mut Vec<DVec3>) {
    let facet = surface.polygon.facet();
    part.clear();
    part.extend(other.polygon.facet().vertices.iter().map(|&vertex| grid.in_squares(vertex, SQUARES).extend(facet.height(vertex))));
    keep(part, |corner| corner.z - heights.start);
    keep(part, |corner| heights.end - corner.z);

    // Over the surface itself, but for what adjoins it.
    let count = facet.vertices.len();
    for k in 0..count {
        let (a, b) = (facet.vertices[k], facet.vertices[(k + 1) % count]);
        let [from, to] = [a, b].map(|vertex| grid.in_squares(vertex, SQUARES));
        let inward = (to - from).perp();
        let adjoins = TOUCHES_WITHIN * facet.radius / grid.square(SQUARES).min_element() * inward.length();
        keep(part, |corner| inward.dot(corner.truncate() - from) - adjoins);
    }
}

/// Cuts a convex polygon to where `height` is not negative (Sutherland, Hodgman 1974, one plane); one without area stays.
fn keep(polygon: &mut Vec<DVec3>, height: impl Fn(DVec3) -> f64) {
    let corners = std::mem::take(polygon);
    for (k, &corner) in corners.iter().enumerate() {
        let next = corners[(k + 1) % corners.len()];
        let (here, there) = (height(corner), height(next));
        if here >= 0.0 {
            polygon.push(corner);
        }
        if (here < 0.0) != (there < 0.0) {
            polygon.push(corner.lerp(next, here / (here - there)));
        }
    }
}

/// Marks all squares that a convex polygon touches.
fn mark(polygon: &[DVec3], grid: &Grid, marked: &mut HashMap<u32, Squares>) {
    /// In squares: what rounding may do to a line between two squares.
    const ROUNDING: f64 = 1e-6;
    if polygon.is_empty() {
        return;
    }
    let last = |cells: u32| f64::from(SQUARES * cells - 1);
    let squares = |range: [f64; 2], cells: u32| {
        let [from, to] = [range[0] - ROUNDING, range[1] + ROUNDING];
        let is_beside = to < 0.0 || from > last(cells) + 1.0;
        let [first, end] = [from, to].map(|along| along.floor().clamp(0.0, last(cells)) as u32);
        if is_beside { 0..0 } else { first..end + 1 }
    };
    let extent = |of: &mut dyn Iterator<Item = f64>| {
        of.fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], x| [least.min(x), most.max(x)])
    };

    // Row by row, from where to where the polygon reaches in it.
    let edges = || (0..polygon.len()).map(|k| (polygon[k].truncate(), polygon[(k + 1) % polygon.len()].truncate()));
    for row in squares(extent(&mut polygon.iter().map(|corner| corner.y)), grid.rows) {
        let (bottom, top) = (f64::from(row) - ROUNDING, f64::from(row) + 1.0 + ROUNDING);
        let reach = extent(&mut edges().flat_map(|(a, b)| within_row(a, b, bottom, top)).flatten());
        if reach[0] > reach[1] {
            continue;
        }
        for column in squares(reach, grid.columns) {
            let cell = row / SQUARES * grid.columns + column / SQUARES;
            *marked.entry(cell).or_default() |= square(column % SQUARES, row % SQUARES);
        }
    }
}

/// From where to where an edge reaches within a row; `None` if it does not.
fn within_row(a: DVec2, b: DVec2, bottom: f64, top: f64) -> Option<[f64; 2]> {
    if a.y.max(b.y) < bottom || a.y.min(b.y) > top {
        return None;
    }
    let at = |y: f64| if a.y == b.y { 0.0 } else { ((y - a.y) / (b.y - a.y)).clamp(0.0, 1.0) };
    if a.y == b.y {
        return Some([a.x.min(b.x), a.x.max(b.x)]);
    }
    let [one, other] = [bottom, top].map(|y| a.x + at(y) * (b.x - a.x));
    Some([one.min(other), one.max(other)])
}

/// The largest part of some squares that hangs together, side by side.
fn largest_part(squares: Squares) -> Squares {
    const FIRST_COLUMN: Squares = 0x0101_0101_0101_0101;
    let (mut left, mut largest) = (squares, 0_u64);
    while left != 0 {
        // All that is reached from the first square.
        let mut part = left & left.wrapping_neg();
        loop {
            let beside = (part & !(FIRST_COLUMN << 7)) << 1 | (part & !FIRST_COLUMN) >> 1;
            let grown = (part | part << SQUARES | part >> SQUARES | beside) & left;
            if grown == part {
                break;
            }
            part = grown;
        }
        left &= !part;
        if part.count_ones() > largest.count_ones() {
            largest = part;
        }
    }
    largest
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Polygon;
    use crate::paths::{Brightness, CellSize};
    use crate::scene::{Material, Sides};
    use crate::visibility::{Backend, OccluderMesh, build};

    /// Whether the one cell of a unit square has a value at points of its middle line, `y = 0.6`, under another polygon.
    fn open_along(other: [[f64; 3]; 4], xs: &[f64]) -> Vec<bool> {
        let square = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        let faces = [square, other].map(|corners| Polygon::new(&corners).unwrap());
        let material = Material { name: String::new(), reflectance: vec![0.5], exitance: vec![0.0] };
        let faces = faces.into_iter().zip(0..).map(|(polygon, face)| (polygon, 0, face)).collect();
        let scene = Scene::new(1, vec![material], faces, Sides::Front).unwrap();
        let grids = Grids::new(
            &scene,
            &Brightness::even(&scene),
            CellSize { side: 1.0, past_unresolved: false, most_surfaces: usize::MAX },
        );
        let visibility = build(Backend::BruteForce, &OccluderMesh::of_scene(&scene)).unwrap();
        let rays = Rays::new(&*visibility, &scene);
        let (parts, grid) = (OpenParts::new(&scene, &rays, &grids), grids.of(SurfaceId(0)).unwrap());
        for seed in 0..32 {
            let point = parts.part_of(SurfaceId(0), grid, 0).unwrap().sampled_point(sampling::hash(seed, 0));
            assert!(parts.contains(SurfaceId(0), grid, point), "{point}");
        }
        xs.iter().map(|&x| parts.contains(SurfaceId(0), grid, DVec3::new(x, 0.6, 0.0))).collect()
    }

    /// A wall from edge to edge at `x = at`, from `low` to `high`.
    fn wall(at: f64, low: f64, high: f64) -> [[f64; 3]; 4] {
        [[at, 0.0, low], [at, 1.0, low], [at, 1.0, high], [at, 0.0, high]]
    }

    #[test]
    fn a_wall_parts_a_cell_and_the_larger_part_has_its_value() {
        assert_eq!(open_along(wall(0.3, 0.0, 1.0), &[0.1, 0.29, 0.31, 0.5, 0.9]), [false, false, false, true, true]);
        // On the line between two squares, to both sides of it.
        assert_eq!(open_along(wall(0.25, 0.0, 1.0), &[0.1, 0.26, 0.5]), [false, false, true]);
    }

    #[test]
    fn what_adjoins_a_surface_or_is_far_leaves_it_open() {
        for other in [wall(1.0, 0.0, 1.0), wall(0.3, 0.3, 1.0), wall(0.3, -1.0, 0.0), wall(1.5, 0.0, 1.0)] {
            assert_eq!(open_along(other, &[0.01, 0.29, 0.31, 0.99]), [true; 4], "{other:?}");
        }
    }

    #[test]
    fn what_lies_close_over_a_surface_covers_it() {
        let plate = |height: f64| [[0.0, 0.0, height], [0.6, 0.0, height], [0.6, 1.0, height], [0.0, 1.0, height]];
        for (height, is_covered) in [(1e-5, true), (0.2, true), (0.3, false)] {
            assert_eq!(open_along(plate(height), &[0.1, 0.55, 0.8]), [!is_covered, !is_covered, true], "{height}");
        }
    }

    #[test]
    fn parts_hang_together_side_by_side_within_the_cell() {
        // Two squares that meet at a corner are two parts; the end of a row and the start of the next are not beside each other.
        assert_eq!(largest_part(square(0, 0) | square(1, 1) | square(2, 1)), square(1, 1) | square(2, 1));
        assert_eq!(largest_part(square(7, 0) | square(0, 1) | square(1, 1)), square(0, 1) | square(1, 1));
        assert_eq!(largest_part(u64::MAX), u64::MAX);
        assert_eq!(largest_part(0), 0);
    }
}
