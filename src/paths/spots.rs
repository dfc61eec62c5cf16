//! Bright spots: cells of large surfaces that reflect so much light that next-event estimation samples them as it does bright reflectors.
//!
//! Such are the pool of light below a spotlight and the wall behind a lamp: paths seldom meet them, and bring much when they do. Where light
//! lands, particles tell; they are few, so they are counted over blocks of cells.

use std::collections::BTreeMap;

use super::grid::Grids;
use super::particles::Landing;
use crate::scene::{Scene, SurfaceId};

/// A block is bright if it reflects more than so many times the mean over the surfaces that light meets. Empirical, as for reflectors.
const BRIGHT: f64 = 8.0;

/// Spots are sampled if without them the variance of what paths find falls by more than this, in squares of the mean. Empirical, as for
/// reflectors.
const WORTH: f64 = 1.0;

/// A block holds so many landings if it is just bright; fewer would be chance.
const LEAST_LANDINGS: f64 = 8.0;

/// A cell of a bright spot.
#[derive(Clone, Copy, Debug)]
pub(super) struct SpotCell {
    pub surface: SurfaceId,
    /// The number of the cell in the surface's grid.
    pub index: u32,
    /// The reflected radiosity, up to a factor that is common to all spots.
    pub brightness: f64,
}

/// What landed on a block.
#[derive(Clone, Copy, Default)]
struct Landed {
    count: f64,
    power: f64,
    /// Of the powers of all particles.
    sum_sq: f64,
}

/// The cells of bright spots; none if sampling them is not worth it. Surfaces of which `is_reflector` says so have none; what reflects nothing is no
/// part of the area over which means are taken.
pub(super) fn spot_cells(
    scene: &Scene,
    grids: &Grids,
    landings: &[Landing],
    is_reflector: impl Fn(SurfaceId) -> bool,
) -> Vec<SpotCell> {
    let landings = || landings.iter().filter(|landing| landing.power > 0.0 && !is_reflector(landing.surface));
    let area = area_of(scene, landings().map(|landing| landing.surface));
    let power: f64 = landings().map(|landing| landing.power).sum();
    if power <= 0.0 {
        return Vec::new();
    }

    // What lands on each block: a square of cells in which a bright spot leaves enough landings to be told from chance.
    let side = (LEAST_LANDINGS * area / (BRIGHT * landings().count() as f64)).sqrt();
    let mut blocks: BTreeMap<(SurfaceId, [u32; 2]), Landed> = BTreeMap::new();
    for landing in landings() {
        let Some(grid) = grids.of(landing.surface) else { continue };
        let index = grid.cell_at(landing.point) - grid.first;
        let cells = (side / grid.size()).ceil().max(1.0) as u32;
        let block = [index % grid.columns / cells, index / grid.columns / cells];
        let landed = blocks.entry((landing.surface, block)).or_default();
        landed.count += 1.0;
        landed.power += landing.power;
        landed.sum_sq += landing.power * landing.power;
    }

    // Those far above the mean, and by how much the variance falls without them; squares are of pairs of particles, free of chance.
    let mean = power / area;
    let (mut spots, mut spot_power, mut gained) = (Vec::new(), 0.0, 0.0);
    for (&(surface, block), landed) in &blocks {
        let Some(grid) = grids.of(surface) else { continue };
        let cells = (side / grid.size()).ceil().max(1.0) as u32;
        let [columns, rows] = [(0, grid.columns), (1, grid.rows)].map(|(axis, count): (usize, u32)| {
            let first = block[axis] * cells;
            first..(first + cells).min(count)
        });
        let own_area = f64::from(columns.len() as u32 * rows.len() as u32) * grid.cell_area();
        let brightness = landed.power / own_area;
        if brightness <= BRIGHT * mean || landed.count < LEAST_LANDINGS {
            continue;
        }
        gained += (landed.power * landed.power - landed.sum_sq) / own_area;
        spot_power += landed.power;
        for row in rows {
            spots.extend(columns.clone().map(|column| SpotCell { surface, index: row * grid.columns + column, brightness }));
        }
    }
    let mean_sq = |power: f64| (power / area).powi(2);
    let falls_by = gained / area - (mean_sq(power) - mean_sq(power - spot_power));
    if falls_by > WORTH * mean_sq(power) { spots } else { Vec::new() }
}

/// The area of some surfaces, each counted once, in m^2.
fn area_of(scene: &Scene, surfaces: impl Iterator<Item = SurfaceId>) -> f64 {
    let mut all: Vec<SurfaceId> = surfaces.collect();
    all.sort_unstable();
    all.dedup();
    all.into_iter().map(|surface| scene.surface(surface).polygon.area()).sum()
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::geometry::{Polygon, sampling};
    use crate::paths::{Brightness, CellSize};
    use crate::scene::{Material, Sides};

    /// The centres of the spots' cells on a floor of 4 m on which a part of the particles lands in a square of so many metres at the
    /// origin, and the rest anywhere.
    fn found(side: f64, part: f64) -> Vec<DVec3> {
        found_beside(side, part, &[])
    }

    /// The same where others land on a black ground of 20 km as well.
    fn found_beside(side: f64, part: f64, others: &[Landing]) -> Vec<DVec3> {
        let square = |side: f64, z: f64| {
            let corners = [[0.0, 0.0, z], [side, 0.0, z], [side, side, z], [0.0, side, z]];
            Polygon::new(&corners).unwrap()
        };
        let material = |reflectance| Material { name: String::new(), reflectance: vec![reflectance], exitance: vec![0.0] };
        let faces = vec![(square(4.0, 0.0), 0, 0), (square(2e4, -1.0), 1, 1)];
        let scene = Scene::new(1, vec![material(0.5), material(0.0)], faces, Sides::Front).unwrap();
        let grids = Grids::new(
            &scene,
            &Brightness::even(&scene),
            CellSize { side: 0.1, past_unresolved: false, most_surfaces: usize::MAX },
        );
        let landing = |number: u64| {
            let random = |draw| sampling::unit(sampling::hash(number, draw));
            let side = if random(3) < part { side } else { 4.0 };
            Landing { surface: SurfaceId(0), point: DVec3::new(side * random(1), side * random(2), 0.0), power: 1.0 }
        };
        let landings: Vec<Landing> = (0..4000).map(landing).chain(others.iter().copied()).collect();
        let spots = spot_cells(&scene, &grids, &landings, |_| false);
        let grid = grids.of(SurfaceId(0)).unwrap();
        spots.iter().map(|spot| grid.point_in(spot.index as usize, 0.5, 0.5)).collect()
    }

    #[test]
    fn spots_are_small_and_much_brighter_than_the_rest() {
        // Half of the light within 40 cm: a hundred times as bright as the floor.
        let spots = found(0.4, 0.5);
        let within = |reach: f64| spots.iter().filter(|at| at.x < reach && at.y < reach).count();
        assert_eq!(within(0.4), 16, "cells of 10 cm: {spots:?}");
        // Blocks reach over its edge by less than their size, of two cells.
        assert_eq!(within(0.6), spots.len(), "{spots:?}");

        // What lands on black things changes nothing.
        let on_black = Landing { surface: SurfaceId(1), point: -DVec3::Z, power: 0.0 };
        assert_eq!(found_beside(0.4, 0.5, &[on_black; 100]), spots);
        assert!(found_beside(0.4, 0.0, &[on_black; 100]).is_empty());

        assert!(found(0.4, 0.0).is_empty(), "no light is anywhere more than elsewhere");
        assert!(found(2.0, 0.5).is_empty(), "a quarter of the floor is no spot");
        assert!(found(0.2, 0.01).is_empty(), "a hundredth of the light is not worth it");
    }
}
