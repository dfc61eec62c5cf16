//! Grids of cells over the surfaces: the second solver knows one radiosity for each cell.
//!
//! All cells have about the same size; each surface has at least one. Those on bright reflectors and bright spots are smaller: light from there varies
//! within centimetres where a lamp is near, and what is seen of a cell is then not what it sends in the mean.

use std::collections::BTreeMap;
use std::ops::Range;

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::grid::Grid;
use super::reflectors::Brightness;
use super::spots::Spot;
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
        let mut all_grids = Self { grids, numbers, cells, past_unresolved };
        all_grids.lay_over_spots(&brightness.spots, all);
        all_grids
    }

    /// Lays grids over the bright spots, one over those of each surface, in a scene in which so much area reflects.
    fn lay_over_spots(&mut self, spots: &[Spot], reflecting_area: f64) {
        let mut covered: BTreeMap<u32, [Range<u32>; 2]> = BTreeMap::new();
        for spot in spots {
            let number = self.numbers[spot.surface.index()];
            let Some((_, grid)) = self.grids.get(number as usize) else { continue };
            let own = grid.around_parts(spot.low, spot.high);
            let all = covered.entry(number).or_insert_with(|| own.clone());
            all.iter_mut().zip(own).for_each(|(all, own)| *all = all.start.min(own.start)..all.end.max(own.end));
        }
        let area_of = |(&number, covered): (&u32, &[Range<u32>; 2])| {
            self.grids[number as usize].1.cell_area() * covered.iter().map(|of| of.len() as f64).product::<f64>()
        };
        let cuts = more_cells(reflecting_area, covered.iter().map(area_of).sum()).sqrt().round() as u32;
        if cuts <= 1 {
            return;
        }
        for (number, covered) in covered {
            let numbers = [self.grids.len() as u32, self.cells as u32];
            let (surface, grid) = &mut self.grids[number as usize];
            let (surface, inset) = (*surface, grid.lay_over(&covered, cuts, numbers));
            self.cells += inset.len();
            self.grids.push((surface, inset));
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
        let grid = self.of(surface)?;
        Some(grid.inset_at(point).map_or(grid, |inset| &self.grids[inset as usize].1))
    }

    /// The cells of a bright spot, each with its grid and its number in that.
    pub fn cells_of(&self, spot: &Spot) -> impl Iterator<Item = (&Grid, usize)> {
        let outer = self.of(spot.surface);
        outer.into_iter().flat_map(|outer| {
            let corners = [spot.low, spot.high].map(|parts| outer.point_at_parts(parts));
            let grid = self.at(spot.surface, 0.5 * (corners[0] + corners[1])).unwrap_or(outer);
            grid.cells_between(corners[0], corners[1]).map(move |index| (grid, index))
        })
    }

    /// The point at `(u, v)`, each in [0, 1], of the cell that `point` of the surface lies in; it may lie beside the surface.
    /// `None` if the surface has no cells.
    pub fn point_beside(&self, surface: SurfaceId, point: DVec3, u: f64, v: f64) -> Option<DVec3> {
        let grid = self.at(surface, point)?;
        Some(grid.point_in((grid.cell_at(point) - grid.first) as usize, u, v))
    }

    /// Whether the cells of a surface, but for those on bright spots, are as wide as it is, as on a slat or the jamb of a slit.
    pub fn is_unresolved(&self, surface: SurfaceId) -> bool {
        self.of(surface).is_some_and(|grid| grid.columns.min(grid.rows) == 1)
    }

    /// Whether paths of values go on from where their first ray arrives on such a surface.
    pub fn past_unresolved(&self) -> bool {
        self.past_unresolved
    }

    /// The place of a point's cell on the Morton curve through the cells of its surface, those of a grid over another after those of that; 0 if there are
    /// none.
    pub fn along_curve(&self, surface: SurfaceId, point: DVec3) -> u32 {
        let (Some(outer), Some(grid)) = (self.of(surface), self.at(surface, point)) else { return 0 };
        let before = if grid.number == outer.number { 0 } else { outer.columns.max(outer.rows).next_power_of_two().pow(2) };
        let [column, row] = grid.place_of(point);
        before + sampling::along_curve(column, row)
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

    /// Where there is a bright spot smaller cells lie over others: every point has one cell, and no number is taken twice.
    #[test]
    fn bright_spots_have_smaller_cells_of_their_own() {
        let floor = Polygon::new(&[[0.0; 3], [4.0, 0.0, 0.0], [4.0, 4.0, 0.0], [0.0, 4.0, 0.0]]).unwrap();
        let material = Material { name: String::new(), reflectance: vec![0.5], exitance: vec![0.0] };
        let scene = Scene::new(1, vec![material], vec![(floor, 0, 0)], Sides::Front).unwrap();
        let spot = Spot { surface: SurfaceId(0), low: [0.55, 0.3], high: [0.6, 0.35], brightness: 1.0 };
        let brightness = Brightness { spots: vec![spot], ..Brightness::even(&scene) };
        let size = CellSize { side: 0.5, past_unresolved: false, most_surfaces: usize::MAX };
        let grids = Grids::new(&scene, &brightness, size);

        // One of 64 cells, of 50 cm, is cut into 17, about.
        let outer = grids.of(SurfaceId(0)).unwrap();
        assert_eq!((outer.len(), grids.cells()), (64, 64 + 16));
        assert_eq!((0..outer.len()).filter(|&index| outer.is_covered(index)).count(), 1);

        // Points of each cell lie in it, on the grid and on the curve through its cells.
        let (mut seen, mut along) = (vec![false; grids.cells()], Vec::new());
        for (surface, grid) in grids.grids() {
            for index in (0..grid.len()).filter(|&index| !grid.is_covered(index)) {
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
        assert_eq!((count, along.len()), (79, 79));

        // Cells of 12.5 cm whose middles lie in the spot, of 20 cm.
        let middle = 0.5 * (outer.point_at_parts(spot.low) + outer.point_at_parts(spot.high));
        let off: Vec<f64> = grids
            .cells_of(&spot)
            .map(|(grid, index)| grid.point_in(index, 0.5, 0.5))
            .map(|at| (at - middle).abs().max_element())
            .collect();
        assert!(!off.is_empty() && off.iter().all(|off| *off <= 0.1), "{off:?}");
    }
}
