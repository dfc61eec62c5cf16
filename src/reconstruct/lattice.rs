//! A lattice of cells over every surface: the places where radiosities are resolved finer than elements.
//!
//! Each surface has a rectangle of cells around it, in its own plane, along its longest edge. A point finds its cell by one
//! division, so looking a radiosity up costs the same for every size of scene. All cells have about the same size, but no surface
//! has less than one.

use glam::DVec3;

use super::light_paths::NO_CELL;
use super::reflectors::Reflector;
use crate::geometry::{Facet, sampling};
use crate::scene::{Scene, SurfaceId};

/// Surfaces beyond this many, the smallest ones, have no cell.
const MAX_SURFACES: usize = 1 << 22;

/// Reflectors have so many times as many cells as other surfaces, unless that makes more than this part more of all.
const MORE_ON_REFLECTORS: f64 = 64.0;
const MORE_CELLS: f64 = 0.25;

/// Cells on one side of a surface, at most.
const MAX_SIDE: f64 = 4096.0;

/// The cells of one surface, row after row.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grid {
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
    fn around(facet: &Facet<'_>, side: f64, first: u32) -> Self {
        // The rectangle along the longest edge.
        let count = facet.vertices.len();
        let edge = |k: usize| facet.vertices[if k + 1 == count { 0 } else { k + 1 }] - facet.vertices[k];
        let longest = (0..count).map(edge).max_by(|a, b| a.length_squared().total_cmp(&b.length_squared())).unwrap_or(DVec3::X);
        let across = longest.normalize_or_zero();
        let along = facet.normal.cross(across);
        let extent = |axis: DVec3| {
            let heights = facet.vertices.iter().map(|vertex| (*vertex - facet.vertices[0]).dot(axis));
            heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), height| (low.min(height), high.max(height)))
        };
        let ((left, right), (bottom, top)) = (extent(across), extent(along));
        let cells = |length: f64| (length / side).round().clamp(1.0, MAX_SIDE);
        let (columns, rows) = (cells(right - left), cells(top - bottom));
        Self {
            first,
            columns: columns as u32,
            rows: rows as u32,
            origin: facet.vertices[0] + left * across + bottom * along,
            across,
            along,
            cell: [(right - left) / columns, (top - bottom) / rows],
        }
    }

    /// How many cells there are.
    pub fn len(&self) -> usize {
        self.columns as usize * self.rows as usize
    }

    /// The point at `(u, v)` in the unit square over the cell number `index` of this grid; it may lie beside the surface.
    pub fn point_in(&self, index: usize, u: f64, v: f64) -> DVec3 {
        let (column, row) = (index as u32 % self.columns, index as u32 / self.columns);
        let (x, y) = ((f64::from(column) + u) * self.cell[0], (f64::from(row) + v) * self.cell[1]);
        self.origin + x * self.across + y * self.along
    }

    /// The cell that `point` of the surface lies in, counted over the whole lattice.
    fn cell_at(&self, point: DVec3) -> u32 {
        // Float to integer conversion saturates, so points before the first cell fall into it.
        let from_origin = point - self.origin;
        let place = |axis: DVec3, size: f64, count: u32| ((from_origin.dot(axis) / size) as u32).min(count - 1);
        self.first + place(self.along, self.cell[1], self.rows) * self.columns + place(self.across, self.cell[0], self.columns)
    }
}

/// The cells of all surfaces.
pub(crate) struct Lattice {
    /// By surface; `None` where a surface is too small to have a cell.
    grids: Vec<Option<Grid>>,
    cells: usize,
}

impl Lattice {
    /// Cells of about `side` metres, smaller ones on reflectors. Depends on the scene, these and `side` alone.
    pub fn new(scene: &Scene, reflectors: &[Reflector], side: f64) -> Self {
        let surfaces = scene.surfaces();
        let area = |index: &usize| surfaces[*index].polygon.area();
        let mut order: Vec<usize> = (0..surfaces.len()).collect();
        if order.len() > MAX_SURFACES {
            order.sort_by(|a, b| area(b).total_cmp(&area(a)).then(a.cmp(b)));
            order.truncate(MAX_SURFACES);
            order.sort_unstable();
        }
        let mut sides = vec![side; surfaces.len()];
        let reflecting: f64 = reflectors.iter().map(|of| area(&of.surface.index())).sum();
        let all: f64 = (0..surfaces.len()).map(|index| area(&index)).sum();
        let more = (1.0 + MORE_CELLS * all / reflecting).min(MORE_ON_REFLECTORS);
        reflectors.iter().for_each(|of| sides[of.surface.index()] = side / more.sqrt());

        let (mut grids, mut cells) = (vec![None; surfaces.len()], 0);
        for index in order {
            let grid = Grid::around(&surfaces[index].polygon.facet(), sides[index], cells as u32);
            cells += grid.len();
            grids[index] = Some(grid);
        }
        Self { grids, cells }
    }

    /// The cells of every surface, if they can be counted in 32 bits.
    pub fn count(&self) -> Option<usize> {
        (self.cells < NO_CELL as usize).then_some(self.cells)
    }

    /// The cell that a point of a surface lies in, and the distance in metres from which the cell looks small; `None` if the
    /// surface has no cells.
    pub fn cell_at(&self, surface: SurfaceId, point: DVec3) -> Option<(u32, f64)> {
        let grid = self.grids[surface.index()].as_ref()?;
        Some((grid.cell_at(point), grid.cell[0].max(grid.cell[1])))
    }

    /// The point of the surface at `(u, v)` in the unit square over the cell that `point` lies in; it may lie beside the surface. `None` if
    /// the surface has no cells.
    pub(super) fn point_beside(&self, surface: SurfaceId, point: DVec3, u: f64, v: f64) -> Option<DVec3> {
        let grid = self.grids[surface.index()].as_ref()?;
        Some(grid.point_in((grid.cell_at(point) - grid.first) as usize, u, v))
    }

    /// How far along a curve through neighbours the cell of a point lies, among those of its surface; 0 if that has no cells.
    pub(super) fn along_curve(&self, surface: SurfaceId, point: DVec3) -> u32 {
        let Some(grid) = &self.grids[surface.index()] else { return 0 };
        let index = grid.cell_at(point) - grid.first;
        sampling::along_curve(index % grid.columns, index / grid.columns)
    }

    /// The mean area in m^2 of a surface's cells. `None` if it has none.
    pub(super) fn cell_area(&self, surface: SurfaceId) -> Option<f64> {
        self.grids[surface.index()].as_ref().map(|grid| grid.cell[0] * grid.cell[1])
    }

    /// Where a point of the surface lies in the unit square over its cell. `None` if the surface has no cells.
    pub(super) fn within_cell(&self, surface: SurfaceId, point: DVec3) -> Option<[f64; 2]> {
        let grid = self.grids[surface.index()].as_ref()?;
        let from_corner = point - grid.point_in((grid.cell_at(point) - grid.first) as usize, 0.0, 0.0);
        let along = |axis: DVec3, size: f64| (from_corner.dot(axis) / size).clamp(0.0, 1.0);
        Some([along(grid.across, grid.cell[0]), along(grid.along, grid.cell[1])])
    }

    /// The cells of a surface: the number of each, its corner and its two edges from there, in metres.
    pub(super) fn cells_of(&self, surface: SurfaceId) -> impl Iterator<Item = (u32, DVec3, [DVec3; 2])> {
        self.grids[surface.index()].iter().flat_map(|grid| {
            let edges = [grid.cell[0] * grid.across, grid.cell[1] * grid.along];
            (0..grid.len()).map(move |index| (grid.first + index as u32, grid.point_in(index, 0.0, 0.0), edges))
        })
    }

    /// The surfaces that have cells.
    pub(super) fn grids(&self) -> impl Iterator<Item = (SurfaceId, &Grid)> {
        self.grids.iter().enumerate().filter_map(|(index, grid)| Some((SurfaceId(index as u32), grid.as_ref()?)))
    }
}
