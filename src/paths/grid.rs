//! A grid of cells over a surface.
//!
//! It fills a rectangle around the surface, in its plane, along its longest edge. A point finds its cell by one division for each axis. Over cells on
//! bright spots lie other grids, of smaller cells, one over each.

use glam::{DVec2, DVec3};

use crate::geometry::{Clip, ClippedFacet, Facet, clip_to_front};

/// Cells on one side of a surface, at most.
const MAX_SIDE: f64 = 4096.0;

/// The number of no grid.
pub(super) const NO_GRID: u32 = u32::MAX;

/// The cells of one surface, row after row.
#[derive(Clone, Debug)]
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
    /// By cell, the number of the grid that lies over it, or [`NO_GRID`]; empty if none lies over any.
    over: Box<[u32]>,
}

impl Grid {
    /// With cells of about this side.
    pub(super) fn around(facet: &Facet<'_>, side: f64, [number, first]: [u32; 2]) -> Self {
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
            over: Box::default(),
        }
    }

    /// Lays a grid over cell number `index`, with so many cells along each side; returns that.
    pub(super) fn lay_over(&mut self, index: usize, cells: u32, [number, first]: [u32; 2]) -> Self {
        if self.over.is_empty() {
            self.over = vec![NO_GRID; self.len()].into();
        }
        self.over[index] = number;
        Self {
            number,
            first,
            columns: cells,
            rows: cells,
            origin: self.point_in(index, 0.0, 0.0),
            cell: self.cell.map(|side| side / f64::from(cells)),
            over: Box::default(),
            ..*self
        }
    }

    /// The corners of the rectangle that it fills.
    pub(super) fn corners(&self) -> [DVec3; 4] {
        [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|parts| self.point_at_parts(parts))
    }

    /// The cells in which some of a rectangle lies, given by parts of the sides of the grid.
    pub(super) fn cells_around(&self, low: [f64; 2], high: [f64; 2]) -> impl Iterator<Item = usize> + use<> {
        let along = |axis: usize, count: u32| {
            let [low, high] = [low[axis], high[axis]].map(|part| part * f64::from(count));
            let first = (low.floor() as u32).min(count - 1);
            first..(high.ceil() as u32).clamp(first + 1, count)
        };
        let (columns, of_row) = (self.columns, along(0, self.columns));
        along(1, self.rows).flat_map(move |row| of_row.clone().map(move |column| (row * columns + column) as usize))
    }

    /// The area of a rectangle, given by parts of the sides of the grid, in m^2.
    pub(super) fn area_between(&self, low: [f64; 2], high: [f64; 2]) -> f64 {
        (high[0] - low[0]) * (high[1] - low[1]) * self.cell_area() * self.len() as f64
    }

    /// The number of the grid that lies over cell number `index`, if one does.
    pub fn over(&self, index: usize) -> Option<u32> {
        self.over.get(index).copied().filter(|&number| number != NO_GRID)
    }

    /// The point at some parts of the sides of the grid.
    pub(super) fn point_at_parts(&self, parts: [f64; 2]) -> DVec3 {
        let [x, y] = [parts[0] * f64::from(self.columns) * self.cell[0], parts[1] * f64::from(self.rows) * self.cell[1]];
        self.origin + x * self.across + y * self.along
    }

    /// The cells whose middles lie in a rectangle, given by two corners.
    pub(super) fn cells_between(&self, low: DVec3, high: DVec3) -> impl Iterator<Item = usize> + use<> {
        let (columns, low_at, high_at) = (self.columns, self.in_squares(low, 1), self.in_squares(high, 1));
        let along = |axis: usize, count: u32| {
            let first_beyond = |at: f64| ((at - 0.5).ceil().max(0.0) as u32).min(count);
            first_beyond(low_at[axis])..first_beyond(high_at[axis])
        };
        let (of_row, rows) = (along(0, self.columns), along(1, self.rows));
        rows.flat_map(move |row| of_row.clone().map(move |column| (row * columns + column) as usize))
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
        self.first + self.index_at(point) as u32
    }

    /// The same, counted over this grid.
    pub fn index_at(&self, point: DVec3) -> usize {
        let [column, row] = self.place_of(point);
        (row * self.columns + column) as usize
    }

    /// The column and the row of the cell that `point` of the surface lies in.
    pub fn place_of(&self, point: DVec3) -> [u32; 2] {
        // Float to integer conversion saturates, so points before the first cell fall into it.
        let from_origin = point - self.origin;
        let place = |axis: DVec3, size: f64, count: u32| ((from_origin.dot(axis) / size) as u32).min(count - 1);
        [place(self.across, self.cell[0], self.columns), place(self.along, self.cell[1], self.rows)]
    }

    /// The coordinates of a point within its cell, each in [0, 1].
    pub fn within_cell(&self, point: DVec3) -> [f64; 2] {
        let from_corner = point - self.point_in(self.index_at(point), 0.0, 0.0);
        let along = |axis: DVec3, size: f64| (from_corner.dot(axis) / size).clamp(0.0, 1.0);
        [along(self.across, self.cell[0]), along(self.along, self.cell[1])]
    }
}
