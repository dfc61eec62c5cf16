//! A path tracer for references: it takes scenes and backends from the library, and none of its estimators.
//!
//! ```text
//! B(x) = E(x) + rho(x) H(x),   H(x) = Int k(x, y) V(x, y) B(y) dy,   k = cos_x cos_y / (pi |x - y|^2)
//! ```
//!
//! From each vertex of a path one ray goes to an emitter, drawn by power, and one on its way, drawn by the cosine, and where there
//! is a portal one through it. All these are weighted by the balance heuristic (Veach, Guibas 1995, "Optimally Combining Sampling Techniques
//! for Monte Carlo Rendering", section 3). Each light that is no surface gets a ray as well, of which points send evenly into all directions and skies are
//! even above the horizon. A face that is met at its back is black. Paths end by roulette, and not before a tenth of what they bring
//! is left: in a white room that spares more noise than it costs rays.
//!
//! Random numbers are an Owen-scrambled Sobol sequence in each batch of paths, with another seed in the next, so that the means of batches are
//! independent and unbiased.
#![allow(dead_code, reason = "each test and bench uses a part")]

use std::f64::consts::{PI, TAU};

use patchlight::scene::{LightShape, Scene, SurfaceId};
use patchlight::visibility::{Backend, NO_PLANE, OccluderMesh, Ray, Segment, Visibility, build};

use crate::triangles::{Random, add, cross, dot, sub, times, unit};

/// So many vertices of a path have numbers of the sequence, those beyond have plain random ones.
const SOBOL_VERTICES: u32 = 8;

/// Roulette keeps this part of what a path brings.
const KEPT: f64 = 0.1;

/// What goes through the portal ends by roulette as if it brought this part of what goes on by the cosine: it is one ray more at every vertex.
const THROUGH_PORTAL: f64 = 0.1;

/// Farther than anything in a scene, in metres.
const FAR: f64 = 1e4;

/// The most paths of a batch: the length of a Sobol sequence.
pub const MOST_OF_A_BATCH: u32 = 1 << 16;

/// A rectangle through which, or from which, much light comes to the points in front of it, that is where `u x v` points to. It only says where to aim.
#[derive(Clone, Copy, Debug)]
pub struct Portal {
    /// One corner, in metres.
    pub corner: [f64; 3],
    /// Perpendicular sides, in metres.
    pub u: [f64; 3],
    pub v: [f64; 3],
}

impl Portal {
    /// Normal and area.
    fn normal(&self) -> ([f64; 3], f64) {
        let normal = cross(self.u, self.v);
        let area = dot(normal, normal).sqrt();
        (times(normal, 1.0 / area), area)
    }

    /// Whether any of it can be seen from a vertex.
    fn faces(&self, from: &Vertex) -> bool {
        let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]].map(|at| sub(self.at(at), from.position));
        dot(corners[0], self.normal().0) < 0.0 && corners.iter().any(|&corner| dot(corner, from.normal) > 0.0)
    }

    fn at(&self, [s, t]: [f64; 2]) -> [f64; 3] {
        add(self.corner, add(times(self.u, s), times(self.v, t)))
    }

    /// The density, by solid angle, of a unit direction from a place in front towards a uniform point of the portal.
    fn density(&self, from: [f64; 3], direction: [f64; 3]) -> f64 {
        let (normal, area) = self.normal();
        let cosine = -dot(direction, normal);
        if cosine <= 0.0 {
            return 0.0;
        }
        let distance = dot(sub(from, self.corner), normal) / cosine;
        let met = sub(add(from, times(direction, distance)), self.corner);
        let is_within = |side: [f64; 3]| (0.0..=dot(side, side)).contains(&dot(met, side));
        if is_within(self.u) && is_within(self.v) { distance * distance / (cosine * area) } else { 0.0 }
    }
}

/// A place that light arrives at.
#[derive(Clone, Copy)]
struct Vertex {
    position: [f64; 3],
    normal: [f64; 3],
    plane: u32,
}

/// A path under way.
struct Path {
    sample: u32,
    at: Vertex,
    /// What light that arrives at the last vertex adds at the first.
    weight: [f64; 3],
    /// The product of reflectances since the last roulette, each of the channel in which it is largest.
    left: f64,
    /// What its random numbers follow from.
    seed: u64,
}

/// What the random numbers of a vertex are for.
#[derive(Clone, Copy)]
enum Use {
    Direction,
    Emitter,
}

/// A batch of paths.
#[derive(Clone, Copy, Debug)]
pub struct Batch {
    /// Mean radiosity, by channel.
    pub radiosity: [f64; 3],
    /// Rays that it took.
    pub rays: u64,
}

/// Traces paths in one scene of three channels.
pub struct PathTracer<'a> {
    scene: &'a Scene,
    visibility: Box<dyn Visibility>,
    emitters: Emitters,
    portal: Option<Portal>,
}

impl<'a> PathTracer<'a> {
    /// Planes are not those of the scene, which joins what lies within a millionth of its size: each sheet has its own.
    pub fn new(scene: &'a Scene, portal: Option<Portal>, backend: Backend) -> Self {
        let mut mesh = OccluderMesh::of_scene(scene);
        mesh.planes.clone_from(&mesh.surfaces);
        let visibility = build(backend, &mesh).expect("a backend of this build");
        Self { scene, visibility, emitters: Emitters::of(scene), portal }
    }

    /// The radiosity at a point of a surface, as `count` paths find it, at most [`MOST_OF_A_BATCH`].
    pub fn batch(&self, surface: SurfaceId, position: [f64; 3], count: u32, seed: u64) -> Batch {
        assert!(count <= MOST_OF_A_BATCH, "a Sobol sequence is not longer");
        let start = |sample| Path {
            sample,
            at: self.vertex(surface, position),
            weight: [1.0; 3],
            left: 1.0,
            seed: Random(seed ^ Random(u64::from(sample)).bits()).bits(),
        };
        let mut paths: Vec<Path> = (0..count).map(start).collect();
        let (mut irradiance, mut rays, mut depth) = ([0.0; 3], 0, 0);
        while !paths.is_empty() {
            rays += paths.len() as u64;
            self.next_event(&paths, &mut irradiance, (depth, seed));
            self.see_lights(&paths, &mut irradiance);
            rays += self.go_on(&mut paths, &mut irradiance, (depth, seed));
            depth += 1;
        }
        let (exitance, reflectance) = self.material(surface);
        let radiosity = std::array::from_fn(|k| exitance[k] + reflectance[k] * irradiance[k] / f64::from(count));
        Batch { radiosity, rays }
    }

    fn vertex(&self, surface: SurfaceId, position: [f64; 3]) -> Vertex {
        let Some(twin) = self.scene.surface(surface).twin() else {
            return Vertex { position, normal: self.scene.surface(surface).polygon.normal(), plane: surface.0 };
        };
        Vertex { position, normal: self.scene.surface(surface).polygon.normal(), plane: surface.0.min(twin.0) }
    }

    /// Exitance and reflectance.
    fn material(&self, surface: SurfaceId) -> ([f64; 3], [f64; 3]) {
        let material = self.scene.material_of(surface);
        (std::array::from_fn(|k| material.exitance[k]), std::array::from_fn(|k| material.reflectance[k]))
    }

    /// Next-event estimation: adds what a ray from each vertex to an emitter brings.
    fn next_event(&self, paths: &[Path], irradiance: &mut [f64; 3], at: (u32, u64)) {
        let (mut segments, mut brought) = (Vec::with_capacity(paths.len()), Vec::with_capacity(paths.len()));
        for path in paths {
            let numbers = path.numbers(at, Use::Emitter);
            let Some((surface, position, by_area)) = self.emitters.draw(numbers) else { return };
            let emitter = self.vertex(surface, position);
            let way = sub(position, path.at.position);
            let distance_sq = dot(way, way);
            let direction = times(way, 1.0 / distance_sq.sqrt());
            let (cos_here, cos_there) = (dot(path.at.normal, direction), -dot(emitter.normal, direction));
            if cos_here > 0.0 && cos_there > 0.0 {
                let by_direction = self.density(&path.at, direction) * cos_there / distance_sq;
                let kernel = cos_here * cos_there / (PI * distance_sq);
                let exitance = self.material(surface).0;
                brought.push([0, 1, 2].map(|k| path.weight[k] * exitance[k] * kernel / (by_area + by_direction)));
                let (from, to) = (path.at.position, position);
                segments.push(Segment { from, to, from_plane: path.at.plane, to_plane: emitter.plane });
            }
        }
        let mut occluded = vec![false; segments.len()];
        self.visibility.occluded(&segments, &mut occluded);
        for (brought, _) in brought.iter().zip(&occluded).filter(|(_, occluded)| !**occluded) {
            *irradiance = add(*irradiance, *brought);
        }
    }

    /// Adds what a ray from each vertex to each point light and sun brings.
    fn see_lights(&self, paths: &[Path], irradiance: &mut [f64; 3]) {
        let (mut segments, mut brought) = (Vec::new(), Vec::new());
        for (path, (number, light)) in
            paths.iter().flat_map(|path| self.scene.lights().iter().enumerate().map(move |light| (path, light)))
        {
            let (to, facing) = match &light.shape {
                LightShape::Point(point) => {
                    let way = sub(point.position(), path.at.position);
                    (point.position(), 1.0 / dot(way, way))
                }
                LightShape::Sun(sun) => {
                    // A random point of the disc as seen in its middle's direction: by its cosine each brings as much.
                    let mut random = Random(path.seed.rotate_left(9) ^ number as u64);
                    let (radius, turn) = ((0.5 * sun.diameter()).sin() * random.unit().sqrt(), TAU * random.unit());
                    let middle = sun.towards();
                    let tangent = unit(cross(middle, if middle[0].abs() < 0.7 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] }));
                    let aside = add(times(tangent, radius * turn.cos()), times(cross(middle, tangent), radius * turn.sin()));
                    let cosine = (1.0 - radius * radius).sqrt();
                    (add(path.at.position, times(add(aside, times(middle, cosine)), FAR)), 1.0 / cosine)
                }
                LightShape::Sky(_) => continue,
            };
            let cos = dot(path.at.normal, unit(sub(to, path.at.position)));
            if cos > 0.0 {
                brought.push([0, 1, 2].map(|k| path.weight[k] * light.strength[k] * facing * cos));
                segments.push(Segment { from: path.at.position, to, from_plane: path.at.plane, to_plane: NO_PLANE });
            }
        }
        let mut occluded = vec![false; segments.len()];
        self.visibility.occluded(&segments, &mut occluded);
        for (brought, _) in brought.iter().zip(&occluded).filter(|(_, occluded)| !**occluded) {
            *irradiance = add(*irradiance, *brought);
        }
    }

    /// The radiance of the sky in a direction times pi, by channel.
    fn sky(&self, direction: [f64; 3]) -> [f64; 3] {
        let above = self.scene.lights().iter().filter(|light| match &light.shape {
            LightShape::Sky(sky) => dot(sky.up(), direction) > 0.0,
            LightShape::Point(_) | LightShape::Sun(_) => false,
        });
        above.fold([0.0; 3], |sum, light| [0, 1, 2].map(|k| sum[k] + light.strength[k]))
    }

    /// Takes all paths to their next vertices, by the cosine and through the portal, and adds what these emit.
    fn go_on(&self, paths: &mut Vec<Path>, irradiance: &mut [f64; 3], at: (u32, u64)) -> u64 {
        let (mut rays, mut from) = (Vec::with_capacity(paths.len()), Vec::with_capacity(paths.len()));
        for path in std::mem::take(paths) {
            for (direction, left) in self.directions(&path, at) {
                rays.push(Ray { origin: path.at.position, direction, origin_plane: path.at.plane });
                from.push(path.branch(left, rays.len() as u64));
            }
        }
        let mut hits = vec![None; rays.len()];
        self.visibility.first_hits(&rays, &mut hits);

        for ((mut path, ray), hit) in from.into_iter().zip(&rays).zip(hits) {
            let (cos_here, density) = (dot(path.at.normal, ray.direction), self.density(&path.at, ray.direction));
            if cos_here <= 0.0 || density <= 0.0 {
                continue;
            }
            if hit.is_none() {
                let (sky, share) = (self.sky(ray.direction), cos_here / (PI * density));
                *irradiance = [0, 1, 2].map(|k| irradiance[k] + share * path.weight[k] * sky[k]);
            }
            let Some((hit, front)) = hit.and_then(|hit| Some((hit, self.front(hit.surface, ray.direction)?))) else { continue };
            let next = self.vertex(front, add(ray.origin, times(ray.direction, hit.distance)));
            let (exitance, reflectance) = self.material(front);
            let by_direction = density * -dot(next.normal, ray.direction) / (hit.distance * hit.distance);
            let share = by_direction / (by_direction + self.emitters.density(front));
            path.weight = times(path.weight, cos_here / (PI * density));
            *irradiance = [0, 1, 2].map(|k| irradiance[k] + path.weight[k] * exitance[k] * share);
            path.reflect(reflectance);
            path.at = next;
            if path.left > 0.0 {
                paths.push(path);
            }
        }
        rays.len() as u64
    }

    /// The side of a sheet that a ray meets.
    pub fn front(&self, surface: u32, direction: [f64; 3]) -> Option<SurfaceId> {
        let met = self.scene.surface(SurfaceId(surface));
        if dot(met.polygon.normal(), direction) < 0.0 { Some(SurfaceId(surface)) } else { met.twin() }
    }

    /// Unit directions on which a path goes on, each with what is left there.
    fn directions(&self, path: &Path, at: (u32, u64)) -> Vec<([f64; 3], f64)> {
        let [s, t, u, v] = path.numbers(at, Use::Direction);
        let [x, y] = [(TAU * t).cos(), (TAU * t).sin()].map(|side| s.sqrt() * side);
        let normal = path.at.normal;
        let axis = if normal[0].abs() < 0.7 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
        let tangent = unit(cross(normal, axis));
        let by_cosine = add(add(times(tangent, x), times(cross(normal, tangent), y)), times(normal, (1.0 - s).max(0.0).sqrt()));
        let through =
            self.faced(&path.at).map(|portal| (unit(sub(portal.at([u, v]), path.at.position)), THROUGH_PORTAL * path.left));
        std::iter::once((unit(by_cosine), path.left)).chain(through).collect()
    }

    /// The densities, by solid angle, with which each of [`Self::directions`] may be a unit direction, added.
    fn density(&self, from: &Vertex, direction: [f64; 3]) -> f64 {
        let through = self.faced(from).map_or(0.0, |portal| portal.density(from.position, direction));
        dot(from.normal, direction).max(0.0) / PI + through
    }

    /// The portal, if it can be seen from a vertex.
    fn faced(&self, from: &Vertex) -> Option<&Portal> {
        self.portal.as_ref().filter(|portal| portal.faces(from))
    }
}

impl Path {
    /// The same path with random numbers of its own.
    fn branch(&self, left: f64, number: u64) -> Self {
        Self { left, seed: Random(self.seed ^ number).bits(), ..*self }
    }

    /// Reflects what is to come off a surface, or ends the path by roulette.
    fn reflect(&mut self, reflectance: [f64; 3]) {
        self.weight = [0, 1, 2].map(|k| self.weight[k] * reflectance[k]);
        self.left *= reflectance.into_iter().fold(0.0, f64::max);
        if self.left < KEPT {
            let stays = Random(!self.seed).unit() * KEPT < self.left;
            self.weight = times(self.weight, KEPT / self.left);
            self.left = if stays { KEPT } else { 0.0 };
        }
    }

    /// Four numbers in [0, 1) for the vertex at this depth of a batch with this seed. The sequence has 24 bits; what is below is random.
    fn numbers(&self, (depth, seed): (u32, u64), to: Use) -> [f64; 4] {
        let mut random = Random(self.seed.rotate_left(to as u32 + 1));
        if depth >= SOBOL_VERTICES {
            return [(); 4].map(|()| random.unit());
        }
        let sobol = sobol_burley::sample_4d(self.sample, 2 * depth + to as u32, (seed ^ (seed >> 32)) as u32);
        sobol.map(|number| f64::from(number) + random.unit() / f64::from(1 << 24))
    }
}

/// All that emits, cut into triangles.
struct Emitters {
    triangles: Vec<(SurfaceId, [[f64; 3]; 3])>,
    /// The power of the triangles up to and with each, channels added.
    up_to: Vec<f64>,
    /// By surface: the density, by area, with which its points are drawn.
    densities: Vec<f64>,
}

impl Emitters {
    fn of(scene: &Scene) -> Self {
        let exitance = |surface: SurfaceId| -> f64 { scene.material_of(surface).exitance.iter().sum() };
        let (mut triangles, mut up_to, mut total) = (Vec::new(), Vec::new(), 0.0);
        let ids = || (0..scene.surfaces().len() as u32).map(SurfaceId);
        for id in ids().filter(|&id| exitance(id) > 0.0) {
            let corners: Vec<[f64; 3]> = scene.surface(id).polygon.vertices().collect();
            for k in 1..corners.len() - 1 {
                let triangle = [corners[0], corners[k], corners[k + 1]];
                let normal = cross(sub(triangle[1], triangle[0]), sub(triangle[2], triangle[0]));
                total += exitance(id) * 0.5 * dot(normal, normal).sqrt();
                triangles.push((id, triangle));
                up_to.push(total);
            }
        }
        let densities = ids().map(|id| if total > 0.0 { exitance(id) / total } else { 0.0 }).collect();
        Self { triangles, up_to, densities }
    }

    fn density(&self, surface: SurfaceId) -> f64 {
        self.densities[surface.index()]
    }

    /// An emitter, a point of it, and the density of the point; `None` where nothing emits.
    fn draw(&self, [which, s, t, _]: [f64; 4]) -> Option<(SurfaceId, [f64; 3], f64)> {
        let drawn = which * self.up_to.last()?;
        let index = self.up_to.partition_point(|&up_to| up_to <= drawn).min(self.triangles.len() - 1);
        let (surface, [a, b, c]) = self.triangles[index];
        let root = s.sqrt();
        let point = add(times(a, 1.0 - root), add(times(b, root * (1.0 - t)), times(c, root * t)));
        Some((surface, point, self.density(surface)))
    }
}
