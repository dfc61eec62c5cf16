//! The local pass: first meshes of indirect light, then of all light, along lines where light jumps or nearly so (Lischinski 1994, chapter 4).

use std::time::Instant;

use glam::DVec2;
use rayon::prelude::*;

use super::effort::{FOLLOWED, PILOT_POINTS, PILOT_RAYS, RAYS, rays_of_direct, rays_of_nodes};
use super::expected::mean_errors_sq;
use super::grow::{Grower, MOST_GATHERS};
use super::growing::Growing;
use super::judged::{Judged, Norm};
use super::light::{All, Direct, Indirect, Light};
use super::limits::{MOST_ELEMENTS, MeshLimits};
use super::line::Line;
use super::lit_mesh::{LitMesh, MeshReader};
use super::plane::Plane;
use super::seen::{SeenSurfaces, SeenTriangles};
use super::surface_mesh::SurfaceMesh;
use super::triangulation::triangulate;
use crate::direct::DirectLight;
use crate::discontinuities::{Degree, Discontinuities, Segment};
use crate::error::ErrorNorm;
use crate::progress::Stop;
use crate::scene::{Scene, SurfaceId};
use crate::values::{IndirectGather, RayBudget};

/// Triangles are at first no larger than this part of all area that is meshed, or of all pixels.
const FIRST_PART: f64 = 1.0 / 500.0;

/// Light is taken so many times farther from a border than what a point touches may be: a point at the foot of a wall sees through it from nearer.
const CLEARANCE: f64 = 2.0;

/// The part of the squared error that the function of indirect light may have; the rest is left to that of all light. A point of indirect light costs
/// more than ten of direct light. Of 0.5, 0.7 and 0.8 none is best in all of Cornell box, office and room.
const INDIRECT_PART: f64 = 0.7;

/// Points at which the function of indirect light is judged, and that of all light at least: so many of them fall on an area that makes up all of the
/// squared error that is allowed, if the function is off there by as much as the light.
const JUDGED: usize = 2000;
const TESTS: f64 = 4.0;

/// Such points at most, as many as there may be elements: with fewer than a small error wants, the claim is larger, and still true.
const MOST_TESTS: f64 = (1 << 20) as f64;

/// No mesh takes fewer gathers than these, by which its noise is foretold and its error is judged, two each.
pub(crate) const LEAST_GATHERS: usize = 2 * (PILOT_POINTS + JUDGED);

/// What a mesh is made from.
pub(crate) struct MeshBuilder<'a> {
    pub scene: &'a Scene,
    pub indirect: &'a IndirectGather<'a>,
    pub direct: &'a DirectLight<'a>,
    pub budget: RayBudget,
    /// What elements of indirect light follow, and those of all light.
    pub lines: [&'a Discontinuities; 2],
    /// What a view sees, if the mesh is made for a picture: its error is then one over the pixels, else over all area.
    pub seen: Option<&'a SeenSurfaces>,
    /// What values are off by beside their noise, as a part of the light at each place, or of typical light where it is darker; if it is known.
    pub values_off: Option<f64>,
    /// The largest error that may be claimed, and in which norm.
    pub error: f64,
    pub norm: ErrorNorm,
    pub limits: &'a MeshLimits<'a>,
    /// Told how many elements there are.
    pub tell: &'a (dyn Fn(u64) + Sync),
    pub stop: Stop<'a>,
}

impl MeshBuilder<'_> {
    /// Makes the elements of these surfaces; `None` if stopped, or if the limits do not allow the first of them.
    pub fn build(&self, surfaces: &[SurfaceId]) -> Option<LitMesh> {
        let whole = self.whole(surfaces);
        let direct = Direct { scene: self.scene, light: self.direct };

        // Indirect light.
        let [of_indirect, of_all] = self.lines;
        let mut growing = self.begin(surfaces, whole, of_indirect)?;
        let roots: f64 = growing.iter().flat_map(|of| of.node_sizes()).map(f64::sqrt).sum();
        let (budget, size) = (self.budget, (whole / roots).powi(2));
        let mut light = Indirect { direct: &direct, gather: self.indirect, budget, rays: PILOT_RAYS, noise_scale: 1.0 };
        let begun = Instant::now();
        if let Some([noise_sq, told]) = self.grower(&light, (INDIRECT_PART, Some(size))).sampled_noise_sq(&growing, PILOT_POINTS) {
            let wanted = rays_of_nodes(self.error * INDIRECT_PART.sqrt(), noise_sq, self.seen.is_some());
            // What takes as many rays each: nodes and their tests, and judging, twice at each point.
            let gathers = 2 * (nodes(&growing) + JUDGED);
            let work = seconds_of_gathers(begun, gathers) * (wanted / PILOT_RAYS);
            light.rays = (wanted * self.limits.affordable_part(work)).max(RAYS.0);
            light.noise_scale = if told > 0.0 { noise_sq / told } else { 1.0 };
        }
        let of_indirect = self.grower(&light, (INDIRECT_PART, Some(size))).grow(&mut growing)?;
        let off_indirect = self.mean_errors_sq(&growing);
        let indirect = self.finish(growing, Vec::new(), true);

        // All light.
        let mut growing = self.begin(surfaces, whole, of_all)?;
        let mut light = All { direct: &direct, indirect: MeshReader::of(self.scene, &indirect), rays: PILOT_RAYS };
        let part = 1.0 - INDIRECT_PART;
        if let Some([noise_sq, _]) = self.grower(&light, (part, None)).sampled_noise_sq(&growing, PILOT_POINTS) {
            light.rays = rays_of_direct(self.error, part, noise_sq);
        }
        let wanted = (TESTS / (part * self.error.powi(2))).ceil().min(MOST_TESTS);
        let tests = wanted * self.affordable_tests(&growing, &light, wanted);
        let grower = Grower {
            judged_at: JUDGED.max(tests as usize),
            most_gathers: 1,
            takes_all: false,
            fits: false,
            followed: 1.0,
            ..self.grower(&light, (part, None))
        };
        let of_all = grower.grow(&mut growing)?;
        let Judged { measured, claimed, by_group, .. } = of_indirect.with(of_all);
        let errors = self.standard_errors(&growing, &light.indirect, &off_indirect);
        Some(LitMesh { surfaces: self.finish(growing, errors, false), measured, claimed, by_group })
    }

    /// What the function is off in the mean over each triangle, squared, in W^2/m^4.
    fn mean_errors_sq(&self, growing: &[Growing]) -> Vec<Vec<f64>> {
        let dark = || growing.iter().map(|of| vec![0.0; of.triangles.triangles.len()]).collect();
        Norm::of(self.norm, growing).map_or_else(dark, |norm| mean_errors_sq(growing, &norm))
    }

    /// By surface and triangle: the standard error of what is read there in W/m^2, channels together, of the function of all light, of that of
    /// indirect light in it, whose squared errors are given, and of the values that both are made from. Empty where these are not known.
    fn standard_errors(&self, growing: &[Growing], indirect: &MeshReader<'_>, off_indirect: &[Vec<f64>]) -> Vec<Vec<f32>> {
        let Some(values_off) = self.values_off else { return Vec::new() };
        let (typical_sq, off_all) = (Norm::typical_light_sq(growing), self.mean_errors_sq(growing));
        let of_surface = |((of, off_all), off_indirect): ((&Growing, &Vec<f64>), &Vec<f64>)| {
            let of_triangle = |(triangle, off_sq): (usize, &f64)| {
                let middle = of.triangles.corners(triangle as u32).iter().sum::<DVec2>() / 3.0;
                let below = indirect.find(of.plane.to_space(middle), of.surface);
                let below_sq = below.map_or(0.0, |(_, _, triangle, _)| off_indirect[triangle]);
                let values_sq = values_off.powi(2) * of.light_sq(triangle as u32).max(typical_sq);
                (off_sq + below_sq + values_sq).sqrt() as f32
            };
            off_all.iter().enumerate().map(of_triangle).collect()
        };
        growing.par_iter().zip(&off_all).zip(off_indirect).map(of_surface).collect()
    }

    /// The part of so many tests of all light for which there is time.
    fn affordable_tests(&self, growing: &[Growing], light: &All<'_>, tests: f64) -> f64 {
        if !self.limits.has_deadline() {
            return 1.0;
        }
        let begun = Instant::now();
        self.grower(light, (1.0, None)).sampled_noise_sq(growing, PILOT_POINTS);
        self.limits.affordable_part(seconds_of_gathers(begun, nodes(growing) + tests as usize))
    }

    /// What all surfaces weigh.
    fn whole(&self, surfaces: &[SurfaceId]) -> f64 {
        surfaces.iter().map(|&surface| self.weight(surface)).sum()
    }

    /// What a surface weighs: its area in m^2, or how many pixels it covers.
    fn weight(&self, surface: SurfaceId) -> f64 {
        self.seen.map_or_else(|| self.scene.surface(surface).polygon.area(), |seen| seen.weight(surface))
    }

    /// What grows a function that may have a part of the squared error, and whose nodes take the rays of `light` where they weigh `size`, or all.
    fn grower<'b>(&'b self, light: &'b dyn Light, (part, size): (f64, Option<f64>)) -> Grower<'b> {
        let Self { budget, error, norm, limits, tell, stop, .. } = *self;
        let (channels, deciding) = (self.scene.channels(), self.scene.deciding());
        let (seed, error) = (budget.seed, error * part.sqrt());
        Grower {
            light,
            channels,
            deciding,
            seed,
            error,
            norm,
            size,
            followed: FOLLOWED,
            judged_at: JUDGED,
            most_gathers: MOST_GATHERS,
            takes_all: true,
            fits: true,
            limits,
            tell,
            stop,
        }
    }

    /// The first elements, along some lines; `None` if stopped, or if the limits do not allow so many.
    ///
    /// A surface follows no more lines than its part of the most elements, by its weight: else many small surfaces that cross each other would take
    /// them all.
    fn begin(&self, surfaces: &[SurfaceId], whole: f64, lines: &Discontinuities) -> Option<Vec<Growing>> {
        let (largest, clearance) = (FIRST_PART * whole, CLEARANCE * self.direct.blockers.contact);
        let begin = |&surface: &SurfaceId| {
            if (self.stop)() {
                return None;
            }
            let plane = Plane::of(self.scene, surface);
            let facet = self.scene.surface(surface).polygon.facet();
            let corners: Vec<_> = facet.vertices.iter().map(|&corner| plane.to_plane(corner)).collect();
            let line = |segment: &Segment| Line {
                ends: segment.ends.map(|end| plane.to_plane(end)),
                is_step: segment.degree == Degree::D0,
            };
            let followed = lines.of(surface);
            let is_worth_it = followed.len() as f64 * whole <= self.weight(surface) * MOST_ELEMENTS as f64;
            let lines: Vec<Line> = followed.iter().filter(|_| is_worth_it).map(line).collect();
            let deciding = self.scene.deciding();
            let Some(seen) = self.seen else {
                return Some(Growing::new(surface, plane, triangulate(&corners, &lines, largest, clearance), None, deciding));
            };
            let triangles = triangulate(&corners, &lines, f64::INFINITY, clearance);
            let seen = SeenTriangles::new(seen.of(surface), &triangles);
            let mut growing = Growing::new(surface, plane, triangles, Some(seen), deciding);
            growing.bisect_to(largest);
            Some(growing)
        };
        let growing: Vec<Growing> = surfaces.par_iter().map(begin).collect::<Option<_>>()?;
        let elements = growing.iter().map(|of| of.triangles.triangles.len()).sum();
        self.limits.allow(elements).then_some(growing)
    }

    /// The functions, by surface, with the standard errors of their triangles where these are known; with what is not seen as well, or without.
    fn finish(&self, growing: Vec<Growing>, mut errors: Vec<Vec<f32>>, takes_all: bool) -> Vec<Option<SurfaceMesh>> {
        let mut meshes: Vec<Option<SurfaceMesh>> = self.scene.surfaces().iter().map(|_| None).collect();
        errors.resize(growing.len(), Vec::new());
        for (of, errors) in growing.into_iter().zip(errors) {
            let index = of.surface.index();
            meshes[index] = Some(of.into_mesh(errors, takes_all));
        }
        meshes
    }
}

/// Nodes of all that grow.
fn nodes(growing: &[Growing]) -> usize {
    growing.iter().map(|of| of.triangles.nodes.len()).sum()
}

/// What so many gathers take in seconds, as long as each of a pilot that began at some time.
fn seconds_of_gathers(begun: Instant, count: usize) -> f64 {
    begun.elapsed().as_secs_f64() * count as f64 / (2 * PILOT_POINTS) as f64
}
