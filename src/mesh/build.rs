//! The local pass: first meshes of indirect light, then of all light, along lines where light jumps or nearly so (Lischinski 1994, chapter 4).

use rayon::prelude::*;

use super::effort::{FOLLOWED, PILOT_POINTS, PILOT_RAYS, rays_of_nodes};
use super::grow::{Grower, MOST_GATHERS};
use super::growing::Growing;
use super::judged::Judged;
use super::light::{All, Direct, Indirect, Light};
use super::limits::MeshLimits;
use super::lit_mesh::{LitMesh, MeshReader};
use super::plane::Plane;
use super::surface_mesh::SurfaceMesh;
use super::triangulation::{Line, triangulate};
use crate::direct::DirectLight;
use crate::discontinuities::{Degree, Discontinuities, Segment};
use crate::error::ErrorNorm;
use crate::progress::Stop;
use crate::scene::{Scene, SurfaceId};
use crate::values::{IndirectGather, RayBudget};

/// Triangles are at first no larger than this part of all area that is meshed.
const FIRST_PART: f64 = 1.0 / 500.0;

/// The part of the squared error that the function of indirect light may have; the rest is left to that of all light. A point of indirect light costs
/// more than ten of direct light. Of 0.5, 0.7 and 0.8 none is best in all of Cornell box, office and room.
const INDIRECT_PART: f64 = 0.7;

/// Points at which a function is judged; of all light, at more where the error is to be small.
const JUDGED: usize = 2000;

/// So many tests fall on an area that makes up all of the squared error that is allowed, if the function is off there by as much as the light.
const TESTS: f64 = 4.0;

/// Tests at most, as many as there may be elements: with fewer than a small error wants, the claim is larger, and still true.
const MOST_TESTS: f64 = (1 << 20) as f64;

/// What a mesh is made from.
pub(crate) struct MeshBuilder<'a> {
    pub scene: &'a Scene,
    pub indirect: &'a IndirectGather<'a>,
    pub direct: &'a DirectLight<'a>,
    pub budget: RayBudget,
    /// What elements follow.
    pub lines: &'a Discontinuities,
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
        let area: f64 = surfaces.iter().map(|&surface| self.scene.surface(surface).polygon.area()).sum();
        let direct = Direct { scene: self.scene, light: self.direct };

        // Indirect light.
        let mut growing = self.begin(surfaces, area)?;
        let roots: f64 = growing.iter().map(|of| of.triangles.nodes.len() as f64 * of.size().sqrt()).sum();
        let (budget, size) = (self.budget, (area / roots).powi(2));
        let mut light = Indirect { direct: &direct, gather: self.indirect, budget, rays: PILOT_RAYS, size, noise_scale: 1.0 };
        if let Some([noise_sq, told]) = self.grower(&light, INDIRECT_PART, area).sampled_noise_sq(&growing, PILOT_POINTS) {
            light.rays = rays_of_nodes(self.error * INDIRECT_PART.sqrt(), noise_sq);
            light.noise_scale = if told > 0.0 { noise_sq / told } else { 1.0 };
        }
        let of_indirect = self.grower(&light, INDIRECT_PART, area).grow(&mut growing)?;
        let indirect = self.finish(growing);

        // All light.
        let mut growing = self.begin(surfaces, area)?;
        let light = All { direct: &direct, indirect: MeshReader::of(self.scene, &indirect) };
        let part = 1.0 - INDIRECT_PART;
        let tests = (TESTS / (part * self.error.powi(2))).ceil().min(MOST_TESTS);
        let grower = Grower {
            judged_at: JUDGED.max(tests as usize),
            most_gathers: 1,
            followed: 1.0,
            ..self.grower(&light, part, area / tests)
        };
        let of_all = grower.grow(&mut growing)?;
        let Judged { measured, claimed, by_group, .. } = of_indirect.with(of_all);
        Some(LitMesh { surfaces: self.finish(growing), measured, claimed, by_group })
    }

    fn grower<'b>(&'b self, light: &'b dyn Light, part: f64, test_area: f64) -> Grower<'b> {
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
            followed: FOLLOWED,
            test_area,
            judged_at: JUDGED,
            most_gathers: MOST_GATHERS,
            limits,
            tell,
            stop,
        }
    }

    /// The first elements; `None` if the limits do not allow so many.
    fn begin(&self, surfaces: &[SurfaceId], area: f64) -> Option<Vec<Growing>> {
        let begin = |&surface: &SurfaceId| {
            let plane = Plane::of(self.scene, surface);
            let facet = self.scene.surface(surface).polygon.facet();
            let corners: Vec<_> = facet.vertices.iter().map(|&corner| plane.to_plane(corner)).collect();
            let line = |segment: &Segment| Line {
                ends: segment.ends.map(|end| plane.to_plane(end)),
                is_step: segment.degree == Degree::D0,
            };
            let lines: Vec<Line> = self.lines.of(surface).iter().map(line).collect();
            Growing::new(surface, plane, triangulate(&corners, &lines, FIRST_PART * area), self.scene.deciding())
        };
        let growing: Vec<Growing> = surfaces.par_iter().map(begin).collect();
        let elements = growing.iter().map(|of| of.triangles.triangles.len()).sum();
        self.limits.allow(elements).then_some(growing)
    }

    /// The functions, by surface.
    fn finish(&self, growing: Vec<Growing>) -> Vec<Option<SurfaceMesh>> {
        let mut meshes: Vec<Option<SurfaceMesh>> = self.scene.surfaces().iter().map(|_| None).collect();
        for of in growing {
            let index = of.surface.index();
            meshes[index] = Some(of.into_mesh());
        }
        meshes
    }
}
