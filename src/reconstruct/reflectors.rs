//! Reflectors: surfaces that send so much reflected light for their size that rays are aimed at them as at lamps.
//!
//! The trough around a tube, the ceiling above a lamp: rays over the hemisphere seldom meet them, and bring much when they do. What
//! such rays find at a place scatters as the spread of radiosities over the scene does, so that tells whether aiming is worth it.
//!
//! Rays are aimed at the cells of reflectors, drawn from a tree. What these send is not known yet where it is solved for, so what is
//! seen is told by cell and weight.

use std::f64::consts::PI;

use glam::DVec3;

use super::aim_tree::{AimTree, Drawn, Source, Start};
use super::lattice::Lattice;
use super::light_paths::Place;
use crate::form_factor::kernel;
use crate::geometry::{Aabb, sampling};
use crate::hierarchy::Hierarchy;
use crate::scene::{Scene, SurfaceId};
use crate::sweep::Radiosity;
use crate::transmittance::Rays;
use crate::visibility::Segment;

/// A surface that sends so many times as much as surfaces do on average, in its brightest channel, is bright.
const BRIGHT: f64 = 8.0;

/// Rays are aimed at bright surfaces if these take away so much of the scatter, in squares of what is sent on average, and are no more
/// than this part of all area and of all surfaces.
///
/// Empirical: an office with tubes in troughs took a tenth of the time with rays aimed at these, for the same error. Rooms where the
/// scatter falls by 0.1 to 0.7 took up to twice the time; game levels and a spaceship, where bright surfaces are close to others and
/// many, took more too, and scattered more beside them.
const WORTH: f64 = 1.0;
const MOST_AREA: f64 = 0.01;
const MOST_SURFACES: f64 = 0.125;

/// A bright surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Reflector {
    pub surface: SurfaceId,
    /// The reflected radiosity in its brightest channel, in W/m^2, as the links know it.
    pub brightness: f64,
}

/// Sums over surfaces by area.
#[derive(Clone, Copy, Default)]
struct Moments {
    area: f64,
    sum: f64,
    sum_sq: f64,
}

impl Moments {
    fn add(mut self, area: f64, brightness: f64) -> Self {
        self.area += area;
        self.sum += area * brightness;
        self.sum_sq += area * brightness * brightness;
        self
    }
}

/// The reflectors of a scene, from radiosities over its links; none if they would not be worth it.
pub(crate) fn reflectors(scene: &Scene, hierarchy: &Hierarchy, radiosity: &Radiosity) -> Vec<Reflector> {
    let brightness = |surface: SurfaceId| {
        let exitance = &scene.material_of(surface).exitance;
        let sent = radiosity.of(hierarchy.node_of(surface));
        sent.iter().zip(exitance).map(|(sent, emitted)| sent - emitted).fold(0.0, f64::max)
    };
    let area = |surface: SurfaceId| scene.surface(surface).polygon.area();
    let all: Vec<Reflector> = (0..scene.surfaces().len() as u32)
        .map(SurfaceId)
        .map(|surface| Reflector { surface, brightness: brightness(surface) })
        .collect();
    let moments = |of: &mut dyn Iterator<Item = &Reflector>| {
        of.fold(Moments::default(), |moments, of| moments.add(area(of.surface), of.brightness))
    };
    let whole = moments(&mut all.iter());
    let limit = BRIGHT * whole.sum / whole.area;
    let is_bright = |of: &&Reflector| of.brightness > limit;
    let left = moments(&mut all.iter().filter(|of| !is_bright(of)));

    // The variance of what a ray finds that ends anywhere on all surfaces, and on those that are left.
    let variance = |of: Moments| of.sum_sq / whole.area - (of.sum / whole.area).powi(2);
    let mean_sq = (whole.sum / whole.area).powi(2);
    let bright: Vec<Reflector> = all.iter().filter(is_bright).copied().collect();
    let are_few = bright.len() as f64 <= MOST_SURFACES * all.len() as f64 && whole.area - left.area <= MOST_AREA * whole.area;
    if are_few && variance(whole) - variance(left) > WORTH * mean_sq { bright } else { Vec::new() }
}

/// A cell of a reflector that a place sees, and where.
pub(super) struct Seen {
    /// The number of the place.
    pub by: usize,
    pub cell: u32,
    pub surface: SurfaceId,
    pub point: DVec3,
    /// Times what is sent it is a sample of the irradiance at the place.
    pub weight: f64,
}

/// A cell that rays are aimed at.
struct Target {
    cell: u32,
    surface: SurfaceId,
    corner: DVec3,
    edges: [DVec3; 2],
    brightness: f64,
}

/// Aims rays at the cells of reflectors, as far as these look small.
pub(super) struct Reflectors<'a> {
    scene: &'a Scene,
    targets: Vec<Target>,
    /// By surface.
    is_reflector: Vec<bool>,
    /// A cell looks small from so many times its size.
    small_from: f64,
    /// Over the targets, if there are any.
    tree: Option<AimTree>,
}

/// The rays from some places; memory that is reused.
#[derive(Default)]
pub(super) struct ReflectorRays {
    starts: Vec<Start>,
    drawn: Vec<Drawn>,
    segments: Vec<Segment>,
    occluded: Vec<bool>,
}

impl<'a> Reflectors<'a> {
    pub fn new(scene: &'a Scene, reflectors: &[Reflector], lattice: &Lattice, small_from: f64) -> Self {
        let mut is_reflector = vec![false; scene.surfaces().len()];
        let (mut targets, mut sources) = (Vec::new(), Vec::new());
        for &Reflector { surface, brightness } in reflectors {
            is_reflector[surface.index()] = true;
            let normal = scene.surface(surface).polygon.facet().normal;
            for (cell, corner, edges) in lattice.cells_of(surface) {
                let target = Target { cell, surface, corner, edges, brightness };
                let power = target.area() * brightness;
                if power <= 0.0 {
                    continue;
                }
                sources.push(Source { number: targets.len() as u32, bounds: Aabb::around(target.corners()), normal, power });
                targets.push(target);
            }
        }
        let tree = (!sources.is_empty()).then(|| AimTree::new(sources));
        Self { scene, targets, is_reflector, small_from, tree }
    }

    /// Whether rays from one surface are aimed at what another reflects. Not from reflectors: these are close to one another.
    pub fn are_aimed_at(&self, from: SurfaceId, surface: SurfaceId) -> bool {
        self.is_reflector[surface.index()] && !self.is_reflector[from.index()]
    }

    /// What each place that is not on a reflector sees of these, by `count` rays: the sum of weights times what is sent is the irradiance from all of their
    /// cells that look small, without bias for any number of rays.
    pub fn see(&self, places: &[Place], rays: &Rays<'_>, count: u32, memory: &mut ReflectorRays, seen: &mut Vec<Seen>) {
        seen.clear();
        let Some(tree) = &self.tree else { return };
        memory.segments.clear();
        for (by, place) in places.iter().enumerate().filter(|(_, place)| !self.is_reflector[place.surface.index()]) {
            self.aim(tree, place, by, count, memory, seen);
        }
        rays.occluded(&memory.segments, &mut memory.occluded);
        let mut occluded = memory.occluded.iter();
        seen.retain(|_| occluded.next() == Some(&false));
    }

    /// Draws a cell from the tree for each ray of a place, systematically from a random start, and a point of it.
    fn aim(&self, tree: &AimTree, place: &Place, by: usize, count: u32, memory: &mut ReflectorRays, seen: &mut Vec<Seen>) {
        let receiver = self.scene.surface(place.surface);
        let normal = receiver.polygon.facet().normal;
        let seed = sampling::hash(place.seed, 6);
        let start = sampling::unit(seed);
        let numbers = (0..count).map(|ray| (f64::from(ray) + start) / f64::from(count));
        let unoccluded = |number: u32| self.bound_brought(&self.targets[number as usize], place.point, normal);
        memory.drawn.clear();
        tree.draw(std::iter::once(place.point), normal, unoccluded, numbers, &mut memory.starts, &mut memory.drawn);

        let spread = sampling::shifted_sobol_2d(seed);
        for (ray, drawn) in (0..).zip(&memory.drawn) {
            // Points beside the surface, behind the place or so near that the cell looks large bring nothing.
            let target = &self.targets[drawn.number as usize];
            let [u, v] = spread(ray);
            let point = target.corner + u * target.edges[0] + v * target.edges[1];
            let source = self.scene.surface(target.surface);
            let facet = source.polygon.facet();
            let kernel = kernel(place.point, normal, point, facet.normal);
            let looks_small = point.distance(place.point) >= self.small_from * target.size();
            if kernel <= 0.0 || !looks_small || !facet.contains(point) {
                continue;
            }
            let (from, to) = (place.point.to_array(), point.to_array());
            memory.segments.push(Segment { from, to, from_plane: receiver.plane, to_plane: source.plane });
            let weight = target.area() * kernel / (f64::from(count) * drawn.probability);
            seen.push(Seen { by, cell: target.cell, surface: target.surface, point, weight });
        }
    }

    /// No less than the irradiance in W/m^2 that the part of a cell which looks small brings where nothing is in between.
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
    use crate::scene::{Material, Sides};
    use crate::sweep::Exposure;
    use crate::visibility::{Backend, OccluderMesh, build};

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

    #[test]
    fn what_is_seen_adds_up_to_the_form_factor() {
        for (occluded, visible) in [(false, 1.0), (true, 0.5)] {
            let scene = plate_above_tiles(occluded);
            let visibility = build(Backend::default(), &OccluderMesh::of_scene(&scene)).unwrap();
            let rays = Rays::new(&*visibility, &scene);
            let plate = Reflector { surface: SurfaceId(16), brightness: 1.0 };
            let reflectors = Reflectors::new(&scene, &[plate], &Lattice::new(&scene, &[plate], 0.1), 1.5);
            let point = DVec3::new(2.0, 2.0, 0.0);
            let expected = visible * point_to_polygon(point, DVec3::Z, &scene.surface(SurfaceId(16)).polygon.facet());
            let (mut memory, mut seen) = (ReflectorRays::default(), Vec::new());
            let places: Vec<Place> =
                (0..4000).map(|k| Place { point, surface: SurfaceId(0), seed: sampling::hash(9, k) }).collect();
            for count in [1, 16] {
                reflectors.see(&places, &rays, count, &mut memory, &mut seen);
                let found = seen.iter().map(|seen| seen.weight).sum::<f64>() / places.len() as f64;
                assert!((found / expected - 1.0).abs() < 0.05, "{found} for {expected} by {count}, occluded: {occluded}");
            }
        }
    }

    #[test]
    fn reflectors_are_bright_small_and_few() {
        let scene = plate_above_tiles(false);
        let hierarchy = Hierarchy::new(&scene);
        let visibility = build(Backend::default(), &OccluderMesh::of_scene(&scene)).unwrap();
        let mut exposure = Exposure::default();
        exposure.grow(&scene, &hierarchy, &Rays::new(&*visibility, &scene), 0);
        let mut radiosity = Radiosity::emitted(&scene, &hierarchy, &exposure);
        let mut chosen = |of: &[(u32, f64)]| -> Vec<u32> {
            (0..17).for_each(|surface| radiosity.of_mut(hierarchy.node_of(SurfaceId(surface)))[0] = 1.0);
            of.iter().for_each(|&(surface, sent)| radiosity.of_mut(hierarchy.node_of(SurfaceId(surface)))[0] = sent);
            reflectors(&scene, &hierarchy, &radiosity).iter().map(|of| of.surface.0).collect()
        };
        assert_eq!(chosen(&[(16, 50.0)]), [16]);
        assert!(chosen(&[]).is_empty());
        assert!(chosen(&[(16, 5.0)]).is_empty(), "not bright enough");
        assert!(chosen(&[(3, 50.0)]).is_empty(), "too large");
    }
}
