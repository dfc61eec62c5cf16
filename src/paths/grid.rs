//! Grids of cells over the surfaces: the second solver knows one radiosity for each cell.
//!
//! The grid of a surface fills a rectangle around it, in its plane, along its longest edge. A point finds its cell by one division
//! for each axis, whatever the size of the scene. All cells have about the same size; each surface has at least one.

use glam::{DVec2, DVec3};
use serde::{Deserialize, Serialize};

use super::reflectors::Brightness;
use crate::geometry::{Clip, ClippedFacet, Facet, clip_to_front, sampling};
use crate::scene::{Scene, SurfaceId, largest};

/// The cell of a path that ends on none.
pub(crate) const NO_CELL: u32 = u32::MAX;

/// Only so many surfaces have cells, the largest ones: cells are numbered in 32 bits.
const MAX_SURFACES: usize = 1 << 22;

/// Cells on bright reflectors are so many times smaller in area, unless that makes more than this part more cells in all.
/// Empirical.
const MORE_ON_REFLECTORS: f64 = 64.0;
const MORE_CELLS: f64 = 0.25;

/// Cells on one side of a surface, at most.
const MAX_SIDE: f64 = 4096.0;

/// The cells of one surface, row after row.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Grid {
    /// The how many-th grid it is.
    pub number: u32,
    pub first: u32,
    pub columns: u32,
    pub rows: u32,
    origin: DVec3,
    /// Unit vectors along rows and columns.
    across: DVec3,
    along: DVec3,
    /// Width and height of a cell, in metres.
    cell: [f64; 2],
}

impl Grid {
    /// With cells of about this side.
    fn around(facet: &Facet<'_>, side: f64, [number, first]: [u32; 2]) -> Self {
        // Axes along and across the longest edge.
        let count = facet.vertices.len();
        let edge = |k: usize| facet.vertices[if k + 1 == count { 0 } else { k + 1 }] - facet.vertices[k];
        let longest = (0..count).map(edge).max_by(|a, b| a.length_squared().total_cmp(&b.length_squared())).unwrap_or(DVec3::X);
        let across = longest.normalize_or_zero();
        let along = facet.normal.cross(across);

        // The rectangle around the polygon in these axes, cut into cells.
        let extent = |axis: DVec3| {
            let heights = facet.vertices.iter().map(|vertex| (*vertex - facet.vertices[0]).dot(axis));
            heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), height| (low.min(height), high.max(height)))
        };
        let ((left, right), (bottom, top)) = (extent(across), extent(along));
        let cells = |length: f64| (length / side).round().clamp(1.0, MAX_SIDE);
        let (columns, rows) = (cells(right - left), cells(top - bottom));
        Self {
            number,
            first,
            columns: columns as u32,
            rows: rows as u32,
            origin: facet.vertices[0] + left * across + bottom * along,
            across,
            along,
            cell: [(right - left) / columns, (top - bottom) / rows],
        }
    }

    /// How many cells the grid has.
    pub fn len(&self) -> usize {
        self.columns as usize * self.rows as usize
    }

    /// The point at `(u, v)`, each in [0, 1], of cell number `index` of this grid; it may lie beside the surface.
    pub fn point_in(&self, index: usize, u: f64, v: f64) -> DVec3 {
        let (column, row) = (index as u32 % self.columns, index as u32 / self.columns);
        let (x, y) = ((f64::from(column) + u) * self.cell[0], (f64::from(row) + v) * self.cell[1]);
        self.origin + x * self.across + y * self.along
    }

    /// The area of a cell, in m^2.
    pub fn cell_area(&self) -> f64 {
        self.cell[0] * self.cell[1]
    }

    /// The longer side of a cell, in metres.
    pub fn size(&self) -> f64 {
        self.cell[0].max(self.cell[1])
    }

    /// Coordinates of a point over the grid, whose cells have so many squares along each side, in squares.
    pub fn in_squares(&self, point: DVec3, squares: u32) -> DVec2 {
        let from_origin = point - self.origin;
        DVec2::new(from_origin.dot(self.across), from_origin.dot(self.along)) / self.square(squares)
    }

    /// The sides of a square, in metres.
    pub fn square(&self, squares: u32) -> DVec2 {
        DVec2::from(self.cell) / f64::from(squares)
    }

    /// The edges of a cell from the corner where it begins, in metres.
    pub fn edges(&self) -> [DVec3; 2] {
        [self.cell[0] * self.across, self.cell[1] * self.along]
    }

    /// The part of the grid's surface that lies in cell number `index`; `None` if nothing does.
    pub fn part_of(&self, facet: &Facet<'_>, index: usize) -> Option<ClippedFacet> {
        let (low, high) = (self.point_in(index, 0.0, 0.0), self.point_in(index, 1.0, 1.0));
        let sides = [(low, self.across), (low, self.along), (high, -self.across), (high, -self.along)];
        sides.into_iter().try_fold(ClippedFacet::copy_of(facet), |part, (origin, normal)| {
            match clip_to_front(&part.facet(), origin, normal) {
                Clip::Whole => Some(part),
                Clip::Part(part) => Some(part),
                Clip::Nothing => None,
            }
        })
    }

    /// The cell that `point` of the surface lies in, counted over all grids.
    pub fn cell_at(&self, point: DVec3) -> u32 {
        // Float to integer conversion saturates, so points before the first cell fall into it.
        let from_origin = point - self.origin;
        let place = |axis: DVec3, size: f64, count: u32| ((from_origin.dot(axis) / size) as u32).min(count - 1);
        self.first + place(self.along, self.cell[1], self.rows) * self.columns + place(self.across, self.cell[0], self.columns)
    }
}

/// How large cells are, and which surfaces have some.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct CellSize {
    /// The size of a cell, in metres.
    pub side: f64,
    /// Whether paths of values go on from where their first ray arrives on an unresolved surface.
    pub past_unresolved: bool,
    /// Only so many surfaces have cells, the largest ones; paths that arrive on others go on.
    pub most_surfaces: usize,
}

/// How fine the cells are, and how many paths leave each.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Resolution {
    pub size: CellSize,
    /// Paths from each cell, and as many next-event rays.
    pub rays: u32,
}

/// Cells are no smaller than what rounding leaves of coordinates: so many of them would make up the diagonal of the scene.
const MOST_ALONG: f64 = 1e15;

/// No more paths leave a position.
const MOST_RAYS: u32 = 1 << 20;

impl Resolution {
    /// Whether the numbers are in range for a scene.
    pub fn is_valid(&self, scene: &Scene) -> bool {
        let side = self.size.side;
        let is_size = side.is_finite() && side > 0.0 && side * MOST_ALONG >= scene.bounds().diagonal();
        is_size && (1..=MOST_RAYS).contains(&self.rays)
    }
}

/// How many cells of this size a scene has, if they can be counted in 32 bits.
pub(crate) fn cell_count(scene: &Scene, brightness: &Brightness, size: CellSize) -> Option<usize> {
    let cells = Grids::new(scene, brightness, size).cells;
    (cells < NO_CELL as usize).then_some(cells)
}

/// The number of no grid.
const NO_GRID: u32 = u32::MAX;

/// The cells of all surfaces.
pub(crate) struct Grids {
    grids: Vec<(SurfaceId, Grid)>,
    /// By surface, the number of its grid, or [`NO_GRID`] where a surface has no cells: it reflects nothing, or is too small.
    numbers: Vec<u32>,
    cells: usize,
    past_unresolved: bool,
}

impl Grids {
    /// Cells of about this size, smaller ones on reflectors, larger ones where it is dim.
    pub fn new(scene: &Scene, brightness: &Brightness, size: CellSize) -> Self {
        let CellSize { side, past_unresolved, most_surfaces } = size;
        let surfaces = scene.surfaces();
        let area = |index: &usize| surfaces[*index].polygon.area();

        // The surfaces that have cells, in the order of their numbers.
        let mut is_reflector = vec![false; surfaces.len()];
        brightness.reflectors.iter().for_each(|of| is_reflector[of.surface.index()] = true);
        let (mut order, others): (Vec<usize>, Vec<usize>) =
            (0..surfaces.len()).filter(|&index| brightness.coarser[index].is_finite()).partition(|&index| is_reflector[index]);
        order.extend(largest(scene, others, most_surfaces.min(MAX_SURFACES)));
        order.sort_unstable();

        // Larger cells where it is dim, smaller ones on reflectors.
        let reflectors = &brightness.reflectors;
        let mut sides: Vec<f64> = brightness.coarser.iter().map(|coarser| side * coarser.sqrt()).collect();
        let reflecting: f64 = reflectors.iter().map(|of| area(&of.surface.index())).sum();
        let reflects = |index: &usize| brightness.coarser[*index].is_finite();
        let all: f64 = (0..surfaces.len()).filter(reflects).map(|index| area(&index)).sum();
        let more = (1.0 + MORE_CELLS * all / reflecting).min(MORE_ON_REFLECTORS);
        reflectors.iter().for_each(|of| sides[of.surface.index()] = side / more.sqrt());

        // A grid for each, its cells numbered after those before it.
        let (mut grids, mut numbers, mut cells) = (Vec::with_capacity(order.len()), vec![NO_GRID; surfaces.len()], 0);
        for index in order {
            numbers[index] = grids.len() as u32;
            let grid = Grid::around(&surfaces[index].polygon.facet(), sides[index], [numbers[index], cells as u32]);
            cells += grid.len();
            grids.push((SurfaceId(index as u32), grid));
        }
        Self { grids, numbers, cells, past_unresolved }
    }

    /// The grid of a surface, if it has cells.
    #[inline]
    pub fn of(&self, surface: SurfaceId) -> Option<&Grid> {
        self.grids.get(self.numbers[surface.index()] as usize).map(|(_, grid)| grid)
    }

    /// The point at `(u, v)`, each in [0, 1], of the cell that `point` of the surface lies in; it may lie beside the surface.
    /// `None` if the surface has no cells.
    pub fn point_beside(&self, surface: SurfaceId, point: DVec3, u: f64, v: f64) -> Option<DVec3> {
        let grid = self.of(surface)?;
        Some(grid.point_in((grid.cell_at(point) - grid.first) as usize, u, v))
    }

    /// Whether the cells of a surface are as wide as it is, as on a slat or the jamb of a slit.
    pub fn is_unresolved(&self, surface: SurfaceId) -> bool {
        self.of(surface).is_some_and(|grid| grid.columns.min(grid.rows) == 1)
    }

    /// Whether paths of values go on from where their first ray arrives on such a surface.
    pub fn past_unresolved(&self) -> bool {
        self.past_unresolved
    }

    /// The place of a point's cell on the Morton curve through the cells of its surface; 0 if that has no cells.
    pub fn along_curve(&self, surface: SurfaceId, point: DVec3) -> u32 {
        let Some(grid) = self.of(surface) else { return 0 };
        let index = grid.cell_at(point) - grid.first;
        sampling::along_curve(index % grid.columns, index / grid.columns)
    }

    /// The mean area in m^2 of a surface's cells. `None` if it has none.
    pub fn cell_area(&self, surface: SurfaceId) -> Option<f64> {
        self.of(surface).map(Grid::cell_area)
    }

    /// The coordinates of a point within its cell, each in [0, 1]. `None` if the surface has no cells.
    pub fn within_cell(&self, surface: SurfaceId, point: DVec3) -> Option<[f64; 2]> {
        let grid = self.of(surface)?;
        let from_corner = point - grid.point_in((grid.cell_at(point) - grid.first) as usize, 0.0, 0.0);
        let along = |axis: DVec3, size: f64| (from_corner.dot(axis) / size).clamp(0.0, 1.0);
        Some([along(grid.across, grid.cell[0]), along(grid.along, grid.cell[1])])
    }

    /// How many cells all grids have.
    pub fn cells(&self) -> usize {
        self.cells
    }

    /// The surfaces that have cells, with their grids, in the order of their numbers.
    pub fn grids(&self) -> impl ExactSizeIterator<Item = (SurfaceId, &Grid)> {
        self.grids.iter().map(|(surface, grid)| (*surface, grid))
    }

    /// Bytes that a surface takes, and its grid, if it has one.
    pub const BYTES_OF_SURFACE: usize = size_of::<u32>();
    pub const BYTES_OF_GRID: usize = size_of::<(SurfaceId, Grid)>();
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Polygon;
    use crate::scene::{Material, Sides};

    #[test]
    fn surfaces_no_wider_than_a_cell_are_unresolved() {
        let rectangle = |width: f64| Polygon::new(&[[0.0; 3], [1.0, 0.0, 0.0], [1.0, width, 0.0], [0.0, width, 0.0]]).unwrap();
        let material = Material { name: String::new(), reflectance: vec![0.5], exitance: vec![0.0] };
        let surfaces = [0.08, 0.3, 1.0].map(|width| (rectangle(width), 0, 0)).to_vec();
        let scene = Scene::new(1, vec![material], surfaces, Sides::Front).unwrap();
        let size = CellSize { side: 0.1, past_unresolved: false, most_surfaces: usize::MAX };
        let grids = Grids::new(&scene, &Brightness::even(&scene), size);
        let of = |surface: u32| {
            let grid = grids.of(SurfaceId(surface)).unwrap();
            (grid.columns, grid.rows, grids.is_unresolved(SurfaceId(surface)))
        };
        assert_eq!([0, 1, 2].map(of), [(10, 1, true), (10, 3, false), (10, 10, false)]);
    }
}
