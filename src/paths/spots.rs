//! Bright spots: parts of large surfaces that reflect so much light that next-event estimation samples them as it does bright reflectors. Where much of all
//! light comes off them they have smaller cells.
//!
//! Such are the pool of light below a spotlight and the wall behind a lamp: paths seldom meet them, and bring much when they do. Where light
//! lands, particles tell; they are few, so they are counted over blocks.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::grid::Grid;
use super::particles::Landing;
use crate::scene::{Scene, SurfaceId};

/// A block is bright if it reflects more than so many times the mean over the surfaces that light meets. Empirical, as for reflectors.
const BRIGHT: f64 = 8.0;

/// Spots are sampled if without them the variance of what paths find falls by more than this, in squares of the mean. Empirical, as for
/// reflectors.
const WORTH: f64 = 1.0;

/// A block holds so many landings if it is just bright; fewer would be chance.
const LEAST_LANDINGS: f64 = 8.0;

/// A bright block.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Spot {
    pub surface: SurfaceId,
    /// Where it begins and ends, as parts of the sides of the rectangle that grids of the surface fill.
    pub low: [f64; 2],
    pub high: [f64; 2],
    /// The reflected radiosity, in means over all that light meets.
    pub brightness: f64,
}

impl Spot {
    /// Whether it lies on a surface of a scene.
    pub fn is_valid(&self, scene: &Scene) -> bool {
        let is_part = |axis: usize| 0.0 <= self.low[axis] && self.low[axis] < self.high[axis] && self.high[axis] <= 1.0;
        self.surface.index() < scene.surfaces().len()
            && is_part(0)
            && is_part(1)
            && self.brightness > 0.0
            && self.brightness.is_finite()
    }
}

/// What landed on a block.
#[derive(Clone, Copy, Default)]
struct Landed {
    count: f64,
    power: f64,
    /// Of the powers of all particles.
    sum_sq: f64,
}

/// The bright spots; none if sampling them is not worth it. Surfaces of which `is_reflector` says so have none; what reflects nothing is no part of the area
/// over which means are taken.
pub(super) fn bright_spots(scene: &Scene, landings: &[Landing], is_reflector: impl Fn(SurfaceId) -> bool) -> Vec<Spot> {
    let landings = || landings.iter().filter(|landing| landing.power > 0.0 && !is_reflector(landing.surface));
    let area = area_of(scene, landings().map(|landing| landing.surface));
    let power: f64 = landings().map(|landing| landing.power).sum();
    if power <= 0.0 {
        return Vec::new();
    }

    // What lands on each block: a bright one has enough landings to be told from chance.
    let side = (LEAST_LANDINGS * area / (BRIGHT * landings().count() as f64)).sqrt();
    let mut blocks: BTreeMap<SurfaceId, (Grid, BTreeMap<u32, Landed>)> = BTreeMap::new();
    for landing in landings() {
        let facet = scene.surface(landing.surface).polygon.facet();
        let (grid, blocks) = blocks.entry(landing.surface).or_insert_with(|| (Grid::around(&facet, side, [0; 2]), BTreeMap::new()));
        let landed = blocks.entry(grid.cell_at(landing.point)).or_default();
        landed.count += 1.0;
        landed.power += landing.power;
        landed.sum_sq += landing.power * landing.power;
    }

    // Those far above the mean, and by how much the variance falls without them; squares are of pairs of particles, free of chance.
    let mean = power / area;
    let (mut spots, mut spot_power, mut gained) = (Vec::new(), 0.0, 0.0);
    for (&surface, (grid, blocks)) in &blocks {
        for (&block, landed) in blocks {
            let brightness = landed.power / (grid.cell_area() * mean);
            if brightness <= BRIGHT || landed.count < LEAST_LANDINGS {
                continue;
            }
            gained += (landed.power * landed.power - landed.sum_sq) / grid.cell_area();
            spot_power += landed.power;
            let at = [block % grid.columns, block / grid.columns];
            let part = |axis: usize, beyond: u32| f64::from(at[axis] + beyond) / f64::from([grid.columns, grid.rows][axis]);
            spots.push(Spot { surface, low: [part(0, 0), part(1, 0)], high: [part(0, 1), part(1, 1)], brightness });
        }
    }
    let mean_sq = |power: f64| (power / area).powi(2);
    let falls_by = gained / area - (mean_sq(power) - mean_sq(power - spot_power));
    if falls_by > WORTH * mean_sq(power) { spots } else { Vec::new() }
}

/// The part of all light that spots of these areas send beyond what they would if they were just bright, in a scene in which so much area reflects.
pub(super) fn part_of_light(spots: &[Spot], areas: &[f64], reflecting_area: f64) -> f64 {
    spots.iter().zip(areas).map(|(spot, area)| area * (spot.brightness - BRIGHT)).sum::<f64>() / reflecting_area
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
    use crate::scene::{Material, Sides};

    /// The spots on a floor of 4 m on which a part of the particles lands in a square of so many metres at the origin, and the rest anywhere.
    fn found(side: f64, part: f64) -> Vec<Spot> {
        found_beside(side, part, &[])
    }

    /// The same where others land on a black ground of 20 km as well.
    fn found_beside(side: f64, part: f64, others: &[Landing]) -> Vec<Spot> {
        let square = |side: f64, z: f64| {
            let corners = [[0.0, 0.0, z], [side, 0.0, z], [side, side, z], [0.0, side, z]];
            Polygon::new(&corners).unwrap()
        };
        let material = |reflectance| Material { name: String::new(), reflectance: vec![reflectance], exitance: vec![0.0] };
        let faces = vec![(square(4.0, 0.0), 0, 0), (square(2e4, -1.0), 1, 1)];
        let scene = Scene::new(1, vec![material(0.5), material(0.0)], faces, Sides::Front).unwrap();
        let landing = |number: u64| {
            let random = |draw| sampling::unit(sampling::hash(number, draw));
            let side = if random(3) < part { side } else { 4.0 };
            Landing { surface: SurfaceId(0), point: DVec3::new(side * random(1), side * random(2), 0.0), power: 1.0 }
        };
        let landings: Vec<Landing> = (0..4000).map(landing).chain(others.iter().copied()).collect();
        let spots = bright_spots(&scene, &landings, |_| false);
        assert!(spots.iter().all(|spot| spot.is_valid(&scene)));
        spots
    }

    #[test]
    fn spots_are_small_and_much_brighter_than_the_rest() {
        // Half of the light within 40 cm: a hundred times as bright as the floor.
        let spots = found(0.4, 0.5);
        let area: f64 = spots.iter().map(|spot| 16.0 * (spot.high[0] - spot.low[0]) * (spot.high[1] - spot.low[1])).sum();
        // Blocks of 6 cm reach over its edge by less than their size.
        let reach = [0, 1].map(|axis| {
            let most = spots.iter().map(|spot| spot.high[axis]).fold(0.0, f64::max);
            4.0 * (most - spots.iter().map(|spot| spot.low[axis]).fold(1.0, f64::min))
        });
        assert!(
            (0.16..0.2).contains(&area) && reach.iter().all(|reach| (0.4..0.47).contains(reach)),
            "{area} m^2, {reach:?} m: {spots:?}"
        );
        // What lands on black things changes nothing.
        let on_black = Landing { surface: SurfaceId(1), point: -DVec3::Z, power: 0.0 };
        assert_eq!(found_beside(0.4, 0.5, &[on_black; 100]), spots);
        assert!(found_beside(0.4, 0.0, &[on_black; 100]).is_empty());

        assert!(found(0.4, 0.0).is_empty(), "no light is anywhere more than elsewhere");
        assert!(found(2.0, 0.5).is_empty(), "a quarter of the floor is no spot");
        assert!(found(0.2, 0.01).is_empty(), "a hundredth of the light is not worth it");
    }
}
