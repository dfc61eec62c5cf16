//! Next-event estimation from bright reflectors and bright spots: rays to their cells.
//!
//! Cells are drawn from a light tree. Only cells that are small as seen from the place count; light from others is left to paths. What both find, rays
//! and paths, is weighted by the balance heuristic (Veach, Guibas 1995): from near by, or where most of the cells are hidden, paths find them better.
//!
//! While radiosities are solved for they are not known yet, so the result is a list of cells with weights.

use std::f64::consts::PI;

use glam::DVec3;
use rayon::prelude::*;

use super::grid::Grid;
use super::grids::Grids;
use super::light_tree::{Draws, LightTree};
use super::place::Receives;
use super::reflectors::{Brightness, Reflector};
use super::source_group::Source;
use crate::direct::Receiver;
use crate::form_factor::kernel;
use crate::geometry::{Aabb, sampling, streams};
use crate::progress::Stop;
use crate::scene::{Scene, SurfaceId};
use crate::transmittance::Rays;
use crate::visibility::Segment;

/// Rays for each path, as weights reckon. Any number above 0 leaves no bias.
pub(super) const RAYS_OF_PATH: f64 = 0.5;

/// The number of no target.
const NO_TARGET: u32 = u32::MAX;

/// Fewer targets are looked at on one thread.
const PARALLEL: usize = 4096;

/// A cell of a reflector that a ray from a place sees, and where.
pub(crate) struct SeenCell {
    /// The number of the place.
    pub by: usize,
    /// The number of the ray among those of the place.
    pub ray: u32,
    pub cell: u32,
    pub surface: SurfaceId,
    pub point: DVec3,
    /// Times the radiosity of the cell it is a sample of the irradiance at the place.
    pub weight: f64,
}

/// A cell that rays go to.
struct Target {
    cell: u32,
    surface: SurfaceId,
    corner: DVec3,
    edges: [DVec3; 2],
    brightness: f64,
}

/// The cells of all bright reflectors and spots, and the tree from which they are drawn.
pub(super) struct Reflectors<'a> {
    scene: &'a Scene,
    rays: &'a Rays<'a>,
    targets: Vec<Target>,
    /// By cell, its number among them, or [`NO_TARGET`]; those behind the last one are left out.
    number_of: Vec<u32>,
    /// A cell is small from so many times its size.
    small_from: f64,
    /// Over the targets; `None` if there are none.
    tree: Option<LightTree>,
}

/// The rays from some places; memory that is reused.
#[derive(Default)]
pub(super) struct ReflectorRays {
    draws: Draws,
    segments: Vec<Segment>,
    occluded: Vec<bool>,
}

impl<'a> Reflectors<'a> {
    /// None if stopped.
    pub fn new(
        scene: &'a Scene,
        rays: &'a Rays<'a>,
        brightness: &Brightness,
        grids: &Grids,
        small_from: f64,
        stop: Stop<'_>,
    ) -> Self {
        let mut all = Self { scene, rays, targets: Vec::new(), number_of: Vec::new(), small_from, tree: None };
        for &Reflector { surface, brightness } in brightness.reflectors.iter().take_while(|_| !stop()) {
            let grid = grids.of(surface).into_iter();
            grid.for_each(|grid| (0..grid.len()).for_each(|index| all.add(surface, grid, index, brightness)));
        }
        for spot in brightness.spots.iter().take_while(|_| !stop()) {
            grids.cells_of(spot).into_iter().for_each(|(grid, index)| all.add(spot.surface, grid, index, spot.brightness));
        }
        let source = |(number, target): (usize, &Target)| {
            let normal = scene.surface(target.surface).polygon.facet().normal;
            Source {
                number: number as u32,
                bounds: Aabb::around(target.corners()),
                normal,
                power: target.area() * target.brightness,
            }
        };
        let sources: Vec<Source> = all.targets.par_iter().enumerate().with_min_len(PARALLEL).map(source).collect();
        all.tree = if sources.is_empty() { None } else { LightTree::new(sources, stop) };
        if all.tree.is_none() {
            all.targets.clear();
            all.number_of.clear();
        }
        all
    }

    /// Adds cell number `index` of a surface's grid to the targets, if it is not one yet.
    fn add(&mut self, surface: SurfaceId, grid: &Grid, index: usize, brightness: f64) {
        let (corner, edges) = (grid.point_in(index, 0.0, 0.0), grid.edges());
        let target = Target { cell: grid.first + index as u32, surface, corner, edges, brightness };
        if target.area() * brightness > 0.0 && !self.is_target(target.cell) {
            let beyond = target.cell as usize + 1;
            self.number_of.resize(self.number_of.len().max(beyond), NO_TARGET);
            self.number_of[target.cell as usize] = self.targets.len() as u32;
            self.targets.push(target);
        }
    }

    /// Whether next-event rays go to this cell.
    pub fn is_target(&self, cell: u32) -> bool {
        self.number_of.get(cell as usize).is_some_and(|&number| number != NO_TARGET)
    }

    /// The weight by the balance heuristic of what a path from a place brings that arrives at a point of such a cell, which is small from there.
    pub fn weight_of_path(&self, receiver: &Receiver, cell: u32, point: DVec3) -> f64 {
        let (number, Some(tree)) = (self.number_of[cell as usize], &self.tree) else { return 1.0 };
        let target = &self.targets[number as usize];
        let &Receiver { point: from, normal, .. } = receiver;
        let kernel = kernel(from, normal, point, self.scene.surface(target.surface).polygon.facet().normal);
        let unoccluded = |number: u32| self.bound_brought(&self.targets[number as usize], from, normal);
        let by_rays = RAYS_OF_PATH * tree.probability(number, from, normal, unoccluded) / target.area();
        if by_rays > 0.0 { kernel / (kernel + by_rays) } else { 1.0 }
    }

    /// Samples the reflectors by `count` rays from each place for which `is_on` does not say that it is on one. The sum of weight times radiosity over what a
    /// place has seen estimates the irradiance from all cells that are small as seen from there without bias, with what paths bring
    /// ([`Self::weight_of_path`]).
    pub fn see<P: Receives>(
        &self,
        places: &[P],
        is_on: impl Fn(&P) -> bool,
        count: u32,
        memory: &mut ReflectorRays,
        seen: &mut Vec<SeenCell>,
    ) {
        seen.clear();
        if self.tree.is_none() {
            return;
        }
        memory.segments.clear();
        for (by, place) in places.iter().enumerate().filter(|(_, place)| !is_on(place)) {
            self.cast(&place.receiver(self.scene), by, count, memory, seen);
        }
        self.rays.occluded(&memory.segments, &mut memory.occluded);
        let mut occluded = memory.occluded.iter();
        seen.retain(|_| occluded.next() == Some(&false));
    }

    /// Draws a cell for each ray of a place by systematic sampling, and a point of the cell.
    fn cast(&self, receiver: &Receiver, by: usize, count: u32, memory: &mut ReflectorRays, seen: &mut Vec<SeenCell>) {
        let Some(tree) = &self.tree else { return };
        let &Receiver { point: from, normal, plane: from_plane, seed } = receiver;

        // The cells.
        let seed = sampling::hash(seed, streams::REFLECTORS);
        let start = sampling::unit(seed);
        let numbers = (0..count).map(|ray| (f64::from(ray) + start) / f64::from(count));
        let unoccluded = |number: u32| self.bound_brought(&self.targets[number as usize], from, normal);
        tree.draw(std::iter::once(from), normal, unoccluded, numbers, &mut memory.draws);

        // A point in each.
        let sobol = sampling::shifted_sobol_2d(seed);
        for (sample, drawn) in (0..).zip(&memory.draws.drawn) {
            let target = &self.targets[drawn.number as usize];
            let [u, v] = sobol(sample);
            let point = target.corner + u * target.edges[0] + v * target.edges[1];

            // Beside the surface, behind the place, or so near that the cell is not small it brings nothing.
            let source = self.scene.surface(target.surface);
            let facet = source.polygon.facet();
            let kernel = kernel(from, normal, point, facet.normal);
            let is_small = point.distance(from) >= self.small_from * target.size();
            if kernel <= 0.0 || !is_small || !facet.contains(point) {
                continue;
            }
            let (from, to) = (from.to_array(), point.to_array());
            memory.segments.push(Segment { from, to, from_plane, to_plane: source.plane });
            let by_rays = RAYS_OF_PATH * drawn.probability / target.area();
            let weight = RAYS_OF_PATH * kernel / (f64::from(count) * (by_rays + kernel));
            seen.push(SeenCell { by, ray: drawn.ray, cell: target.cell, surface: target.surface, point, weight });
        }
    }

    /// An upper bound of the unoccluded irradiance from the points of a cell from which it is small; where means of radiosity are 1.
    fn bound_brought(&self, target: &Target, point: DVec3, normal: DVec3) -> f64 {
        let [across, along] = target.edges;
        let to_centre = target.corner + 0.5 * (across + along) - point;
        let (radius, nearest) = (0.5 * (across + along).length(), self.small_from * target.size());
        let distance = to_centre.length();
        let in_front = -to_centre.dot(self.scene.surface(target.surface).polygon.facet().normal);
        let above = to_centre.dot(normal) + radius;
        if in_front <= 0.0 || above <= 0.0 || distance + radius < nearest {
            return 0.0;
        }
        let distance = (distance - radius).max(nearest);
        target.brightness * target.area() * (in_front / distance).min(1.0) * (above / distance).min(1.0)
            / (PI * distance * distance)
    }
}

impl Target {
    fn area(&self) -> f64 {
        self.edges[0].cross(self.edges[1]).length()
    }

    /// The longer side.
    fn size(&self) -> f64 {
        self.edges[0].length().max(self.edges[1].length())
    }

    /// Counter-clockwise.
    fn corners(&self) -> [DVec3; 4] {
        let [across, along] = self.edges;
        [self.corner, self.corner + across, self.corner + across + along, self.corner + along]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::form_factor::point_to_polygon;
    use crate::geometry::Polygon;
    use crate::paths::place::cosine_rays;
    use crate::paths::{Brightness, CellSize, Place};
    use crate::scene::{Material, Sides};
    use crate::visibility::{Backend, OccluderMesh, Ray, build};

    /// Sixteen tiles of a floor, a plate above it, and something in between that hides half of the plate from the middle.
    fn plate_above_tiles(occluded: bool) -> Scene {
        let quad = |corner: DVec3, u: DVec3, v: DVec3| {
            Polygon::from_vertices(vec![corner, corner + u, corner + u + v, corner + v]).unwrap()
        };
        let tile = |k: u32| {
            let corner = DVec3::new(f64::from(k / 4), f64::from(k % 4), 0.0);
            (quad(corner, DVec3::X, DVec3::Y), 0, 0)
        };
        let mut faces: Vec<_> = (0..16).map(tile).collect();
        faces.push((quad(DVec3::new(1.9, 1.9, 2.0), 0.2 * DVec3::Y, 0.2 * DVec3::X), 0, 1));
        if occluded {
            faces.push((quad(DVec3::new(2.0, 1.0, 1.0), 0.2 * DVec3::X, 2.0 * DVec3::Y), 0, 2));
        }
        let material = Material { name: String::new(), reflectance: vec![0.5], exitance: vec![0.0] };
        Scene::new(1, vec![material], faces, Sides::Front).unwrap()
    }

    /// Next-event rays and paths together, from a place far from the plate and from one close below it, where paths find most.
    #[test]
    fn what_is_seen_and_what_paths_find_add_up_to_the_form_factor() {
        for (occluded, visible, height) in [(false, 1.0, 0.0), (true, 0.5, 0.0), (false, 1.0, 1.97)] {
            let scene = plate_above_tiles(occluded);
            let visibility = build(Backend::default(), &OccluderMesh::of_scene(&scene)).unwrap();
            let rays = Rays::new(&*visibility, &scene);
            let plate = Reflector { surface: SurfaceId(16), brightness: 1.0 };
            let brightness = Brightness { reflectors: vec![plate], ..Brightness::even(&scene) };
            let size = CellSize { side: 0.1, past_unresolved: false, most_surfaces: usize::MAX };
            let grids = Grids::new(&scene, &brightness, size);
            let reflectors = Reflectors::new(&scene, &rays, &brightness, &grids, 1.5, &|| false);
            let point = DVec3::new(2.0, 2.0, height);
            let expected = visible * point_to_polygon(point, DVec3::Z, &scene.surface(SurfaceId(16)).polygon.facet());
            let (mut memory, mut seen) = (ReflectorRays::default(), Vec::new());
            let places: Vec<Place> =
                (0..4000).map(|k| Place { point, surface: SurfaceId(0), seed: sampling::hash(9, k) }).collect();

            let (mut by_paths, mut hits) = (0.0, Vec::new());
            for place in &places {
                let receiver = place.receiver(&scene);
                let cast: Vec<Ray> = cosine_rays(&receiver, 0..64).collect();
                rays.first_hits(&cast, &mut hits);
                for (ray, hit) in cast.iter().zip(&hits).filter_map(|(ray, hit)| Some((ray, hit.as_ref()?))) {
                    let at = point + hit.distance * DVec3::from(ray.direction);
                    let cell = grids.at(SurfaceId(16), at).filter(|_| hit.surface == 16).map(|grid| grid.cell_at(at));
                    by_paths += cell.map_or(0.0, |cell| reflectors.weight_of_path(&receiver, cell, at)) / 64.0;
                }
            }
            for count in [1, 16] {
                reflectors.see(&places, |_| false, count, &mut memory, &mut seen);
                let by_rays = seen.iter().map(|seen| seen.weight).sum::<f64>();
                let found = (by_rays + by_paths) / places.len() as f64;
                assert!((found / expected - 1.0).abs() < 0.05, "{found} for {expected} by {count}, occluded: {occluded}");
                assert_eq!(by_paths > by_rays, height > 0.0, "{by_paths} by paths, {by_rays} by rays");
            }
        }
    }
}
