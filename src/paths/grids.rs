//! Grids of cells over the surfaces: the second solver knows one radiosity for each cell.
//!
//! All cells have about the same size; each surface has at least one. Those on bright reflectors are smaller, and those on bright spots if much of all light
//! comes off these: light from there varies within centimetres where a lamp is near, and what is seen of a cell is then not what it sends in the mean.

use std::collections::BTreeSet;

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::grid::{Grid, NO_GRID};
use super::reflectors::Brightness;
use super::spots::{Spot, part_of_light};
use crate::geometry::sampling;
use crate::scene::{Scene, SurfaceId, largest};

/// The cell of a path that ends on none.
pub(crate) const NO_CELL: u32 = u32::MAX;

/// Only so many surfaces have cells, the largest ones: cells are numbered in 32 bits.
const MAX_SURFACES: usize = 1 << 22;

/// Cells on bright reflectors, and on bright spots, are so many times smaller in area, unless that makes more than this part more cells in all.
/// Empirical.
const MORE_ON_REFLECTORS: f64 = 64.0;
const MORE_CELLS: f64 = 0.25;

/// Cells on bright spots are smaller if so much of all light comes off these, more than off other bright places of their size. Where less does, what is off in
/// their cells matters less than what more cells cost. Empirical: over random rooms smaller cells pay from a quarter to a third on.
const FROM_SPOTS: f64 = 0.25;

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

/// The cells of all surfaces.
pub(crate) struct Grids {
    grids: Vec<(SurfaceId, Grid)>,
    /// By surface, the number of its grid, or [`NO_GRID`] where a surface has no cells: it reflects nothing, or is too small.
    numbers: Vec<u32>,
    cells: usize,
    /// The first cell that lies over others.
    first_over: u32,
    past_unresolved: bool,
}

impl Grids {
    /// Cells of about this size, smaller ones on reflectors and bright spots, larger ones where it is dim.
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
        let more = more_cells(all, reflecting);
        reflectors.iter().for_each(|of| sides[of.surface.index()] = side / more.sqrt());

        // A grid for each, its cells numbered after those before it.
        let (mut grids, mut numbers, mut cells) = (Vec::with_capacity(order.len()), vec![NO_GRID; surfaces.len()], 0);
        for index in order {
            numbers[index] = grids.len() as u32;
            let grid = Grid::around(&surfaces[index].polygon.facet(), sides[index], [numbers[index], cells as u32]);
            cells += grid.len();
            grids.push((SurfaceId(index as u32), grid));
        }
        let mut all_grids = Self { grids, numbers, cells, first_over: cells as u32, past_unresolved };
        all_grids.lay_over_spots(&brightness.spots, all);
        all_grids
    }

    /// Lays grids over the cells in which bright spots lie, if these send much of the light, in a scene in which so much area reflects.
    fn lay_over_spots(&mut self, spots: &[Spot], reflecting_area: f64) {
        let (mut bright, mut areas) = (BTreeSet::new(), Vec::with_capacity(spots.len()));
        for spot in spots {
            let grid = self.of(spot.surface);
            areas.push(grid.map_or(0.0, |grid| grid.area_between(spot.low, spot.high)));
            let Some(grid) = grid else { continue };
            bright.extend(grid.cells_around(spot.low, spot.high).map(|index| (grid.number, index)));
        }
        if part_of_light(spots, &areas, reflecting_area) < FROM_SPOTS {
            return;
        }
        let bright_area = bright.iter().map(|&(number, _)| self.grids[number as usize].1.cell_area()).sum();
        let along = more_cells(reflecting_area, bright_area).sqrt().round() as u32;
        if along <= 1 {
            return;
        }
        for (number, index) in bright {
            let numbers = [self.grids.len() as u32, self.cells as u32];
            let (surface, grid) = &mut self.grids[number as usize];
            let (surface, over) = (*surface, grid.lay_over(index, along, numbers));
            self.cells += over.len();
            self.grids.push((surface, over));
        }
    }

    /// The grid over all of a surface, if it has cells.
    #[inline]
    pub fn of(&self, surface: SurfaceId) -> Option<&Grid> {
        self.grids.get(self.numbers[surface.index()] as usize).map(|(_, grid)| grid)
    }

    /// The grid whose cell a point of a surface lies in, if that has cells.
    #[inline]
    pub fn at(&self, surface: SurfaceId, point: DVec3) -> Option<&Grid> {
        self.of(surface).map(|grid| self.over(grid, grid.index_at(point)))
    }

    /// The grid that lies over cell number `index` of one, or that itself.
    #[inline]
    fn over<'a>(&'a self, grid: &'a Grid, index: usize) -> &'a Grid {
        grid.over(index).map_or(grid, |over| &self.grids[over as usize].1)
    }

    /// The cells of a bright spot, each with its grid and its number in that: those whose middles lie in it, or the one around its own middle.
    pub fn cells_of<'a>(&'a self, spot: &Spot) -> Vec<(&'a Grid, usize)> {
        let Some(outer) = self.of(spot.surface) else { return Vec::new() };
        let [low, high] = [spot.low, spot.high].map(|parts| outer.point_at_parts(parts));
        let mut grids: Vec<&Grid> = outer.cells_around(spot.low, spot.high).map(|index| self.over(outer, index)).collect();
        grids.dedup_by_key(|grid| grid.number);
        let mut cells: Vec<_> =
            grids.into_iter().flat_map(|grid| grid.cells_between(low, high).map(move |index| (grid, index))).collect();
        if cells.is_empty() {
            let middle = 0.5 * (low + high);
            cells.extend(self.at(spot.surface, middle).map(|grid| (grid, grid.index_at(middle))));
        }
        cells
    }

    /// The point at `(u, v)`, each in [0, 1], of the cell that `point` of the surface lies in; it may lie beside the surface.
    /// `None` if the surface has no cells.
    pub fn point_beside(&self, surface: SurfaceId, point: DVec3, u: f64, v: f64) -> Option<DVec3> {
        let grid = self.at(surface, point)?;
        Some(grid.point_in(grid.index_at(point), u, v))
    }

    /// Whether the cells of a surface, but for those on bright spots, are as wide as it is, as on a slat or the jamb of a slit.
    pub fn is_unresolved(&self, surface: SurfaceId) -> bool {
        self.of(surface).is_some_and(|grid| grid.columns.min(grid.rows) == 1)
    }

    /// Whether paths of values go on from where their first ray arrives on such a surface.
    pub fn past_unresolved(&self) -> bool {
        self.past_unresolved
    }

    /// The place of a point's cell on the Morton curve through the cells of its surface, those over others behind these; 0 if there are none.
    pub fn along_curve(&self, surface: SurfaceId, point: DVec3) -> u32 {
        let (Some(outer), Some(grid)) = (self.of(surface), self.at(surface, point)) else { return 0 };
        if grid.number != outer.number {
            return outer.columns.max(outer.rows).next_power_of_two().pow(2) + grid.cell_at(point) - self.first_over;
        }
        let [column, row] = grid.place_of(point);
        sampling::along_curve(column, row)
    }

    /// The area in m^2 of the cells around a point of a surface. `None` if there are none.
    pub fn cell_area(&self, surface: SurfaceId, point: DVec3) -> Option<f64> {
        self.at(surface, point).map(Grid::cell_area)
    }

    /// The coordinates of a point within its cell, each in [0, 1]. `None` if the surface has no cells.
    pub fn within_cell(&self, surface: SurfaceId, point: DVec3) -> Option<[f64; 2]> {
        self.at(surface, point).map(|grid| grid.within_cell(point))
    }

    /// How many cells all grids have.
    pub fn cells(&self) -> usize {
        self.cells
    }

    /// The grids with their surfaces, in the order of their numbers.
    pub fn grids(&self) -> impl ExactSizeIterator<Item = (SurfaceId, &Grid)> {
        self.grids.iter().map(|(surface, grid)| (*surface, grid))
    }

    /// Bytes that a surface takes, and its grid, if it has one.
    pub const BYTES_OF_SURFACE: usize = size_of::<u32>();
    pub const BYTES_OF_GRID: usize = size_of::<(SurfaceId, Grid)>();
}

/// By how many times smaller in area cells are on so much area, of so much that reflects.
fn more_cells(all: f64, bright: f64) -> f64 {
    (1.0 + MORE_CELLS * all / bright).min(MORE_ON_REFLECTORS)
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

    /// The grids of a floor of 4 m with bright spots of 20 cm, and its spots.
    fn with_spots(brightness: &[f64]) -> (Grids, Vec<Spot>) {
        let floor = Polygon::new(&[[0.0; 3], [4.0, 0.0, 0.0], [4.0, 4.0, 0.0], [0.0, 4.0, 0.0]]).unwrap();
        let material = Material { name: String::new(), reflectance: vec![0.5], exitance: vec![0.0] };
        let scene = Scene::new(1, vec![material], vec![(floor, 0, 0)], Sides::Front).unwrap();
        let spot = |(number, &brightness): (usize, &f64)| {
            let corner = [0.55, 0.3].map(|along| along - 0.25 * number as f64);
            Spot { surface: SurfaceId(0), low: corner, high: corner.map(|along| along + 0.05), brightness }
        };
        let spots: Vec<Spot> = brightness.iter().enumerate().map(spot).collect();
        let brightness = Brightness { spots: spots.clone(), ..Brightness::even(&scene) };
        let size = CellSize { side: 0.5, past_unresolved: false, most_surfaces: usize::MAX };
        (Grids::new(&scene, &brightness, size), spots)
    }

    /// Where there are bright spots smaller cells lie over others: every point has one cell, and no number is taken twice.
    #[test]
    fn bright_spots_have_smaller_cells_of_their_own() {
        // One of 64 cells, of 50 cm, is cut into 17, about; of two that are far from each other each is cut into 9.
        for (brightness, more) in [(&[200.0][..], 16), (&[100.0, 200.0], 2 * 9)] {
            let (grids, spots) = with_spots(brightness);
            let outer = grids.of(SurfaceId(0)).unwrap();
            assert_eq!((outer.len(), grids.cells()), (64, 64 + more));
            assert_eq!((0..outer.len()).filter(|&index| outer.over(index).is_some()).count(), spots.len());
            assert_cells_are_right(&grids);

            // Cells whose middles lie in the spot, of 20 cm.
            for spot in &spots {
                let middle = 0.5 * (outer.point_at_parts(spot.low) + outer.point_at_parts(spot.high));
                let middles = grids.cells_of(spot).into_iter().map(|(grid, index)| grid.point_in(index, 0.5, 0.5));
                let off: Vec<f64> = middles.map(|at| (at - middle).abs().max_element()).collect();
                assert!(!off.is_empty() && off.iter().all(|off| *off <= 0.1), "{off:?}");
            }
        }

        // A tenth of the light: 42 means more than what is just bright, on a 400th of the area.
        assert_eq!(with_spots(&[50.0]).0.cells(), 64);
    }

    /// Points of each cell lie in it, on the grid and on the curve through its cells.
    fn assert_cells_are_right(grids: &Grids) {
        let (mut seen, mut along) = (vec![false; grids.cells()], Vec::new());
        for (surface, grid) in grids.grids() {
            for index in (0..grid.len()).filter(|&index| grid.over(index).is_none()) {
                let point = grid.point_in(index, 0.3, 0.8);
                let found = grids.at(surface, point).unwrap();
                let cell = found.cell_at(point);
                assert_eq!((found.number, cell), (grid.number, grid.first + index as u32));
                let within = grids.within_cell(surface, point).unwrap();
                assert!((within[0] - 0.3).abs() < 1e-9 && (within[1] - 0.8).abs() < 1e-9, "{within:?}");
                assert!(!std::mem::replace(&mut seen[cell as usize], true));
                along.push(grids.along_curve(surface, point));
            }
        }
        let count = along.len();
        along.sort_unstable();
        along.dedup();
        assert_eq!(along.len(), count);
        assert_eq!(seen.iter().filter(|seen| **seen).count(), count);
    }
}
