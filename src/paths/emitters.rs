//! The emitters whose light next-event estimation brings; that of others is left to paths.

use super::light_tree::LightTree;
use super::source_group::Source;
use crate::geometry::{Aabb, Frame, sampling};
use crate::scene::{Emitter, Scene, SurfaceId};
use crate::transmittance::Rays;
use crate::visibility::Ray;

/// Where paths meet emitters often, only the brightest are sampled, up to this part of all area. Empirical.
const MOSTLY_EMITTING: f64 = 0.2;

/// Paths meet emitters often only if less than this part of random rays leaves the scene. Empirical.
const OFTEN_LOST: f64 = 0.5;

/// Random rays by which that part is sampled.
const PROBES: u32 = 256;

/// The emitters of a scene that next-event estimation sends rays to.
pub(super) struct Emitters<'a> {
    pub scene: &'a Scene,
    pub rays: &'a Rays<'a>,
    pub emitters: Vec<Emitter>,
    /// The exitance of the dimmest of them, in its brightest channel.
    dimmest: f64,
    /// Over these emitters, by their indices; `None` if there are none.
    pub tree: Option<LightTree>,
}

impl<'a> Emitters<'a> {
    pub fn new(scene: &'a Scene, rays: &'a Rays<'a>) -> Self {
        let area = |id: SurfaceId| scene.surface(id).polygon.area();
        let all = || (0..scene.surfaces().len() as u32).map(SurfaceId);
        let mut surfaces: Vec<SurfaceId> = all().filter(|&id| brightest_as_solved(scene, id) > 0.0).collect();

        // Random rays meet emitters by their part of all area (reciprocity), unless many rays leave the scene. Where occluders keep
        // them from emitters, next-event rays are blocked as often.
        let total: f64 = all().map(area).sum();
        let emitting: f64 = surfaces.iter().map(|&id| area(id)).sum();
        let mut dimmest = 0.0;
        if emitting > MOSTLY_EMITTING * total && sampled_share_lost(scene, rays, total) < OFTEN_LOST {
            // Noise goes with the square of the exitance: sample the brightest, one level of exitance after the other.
            let mut levels: Vec<(f64, f64)> = surfaces.iter().map(|&id| (brightest_as_solved(scene, id), area(id))).collect();
            levels.sort_by(|a, b| b.0.total_cmp(&a.0));
            let mut taken = 0.0;
            dimmest = f64::INFINITY;
            for level in levels.chunk_by(|a, b| a.0 == b.0) {
                taken += level.iter().map(|(_, area)| area).sum::<f64>();
                if taken > MOSTLY_EMITTING * total {
                    break;
                }
                dimmest = level[0].0;
            }
            surfaces.retain(|&id| brightest_as_solved(scene, id) >= dimmest);
        }

        // Light groups may be off.
        surfaces.retain(|&id| scene.material_of(id).emits());
        let emitters = Emitter::of_surfaces(scene, surfaces.into_iter());
        let sources: Vec<Source> = (0..).zip(&emitters).map(|(number, emitter)| source(scene, number, emitter)).collect();
        let tree = if sources.is_empty() { None } else { LightTree::new(sources, &|| false) };
        Self { scene, rays, emitters, dimmest, tree }
    }

    /// Whether next-event estimation brings the emission of a surface, so that paths must leave it out.
    pub fn contains(&self, surface: SurfaceId) -> bool {
        let brightest = brightest_as_solved(self.scene, surface);
        brightest > 0.0 && brightest >= self.dimmest
    }
}

/// An emitter as a leaf of the light tree.
fn source(scene: &Scene, number: u32, emitter: &Emitter) -> Source {
    let facet = emitter.facet(scene);
    let power = facet.area * brightest(scene, emitter.surface);
    Source { number, bounds: Aabb::around(facet.vertices.iter().copied()), normal: facet.normal, power }
}

/// The exitance of a surface in its brightest channel, in W/m^2.
pub(super) fn brightest(scene: &Scene, surface: SurfaceId) -> f64 {
    scene.material_of(surface).exitance.iter().copied().fold(0.0, f64::max)
}

/// The same where light groups have the weights with which cells were found: these leave out what rays bring.
fn brightest_as_solved(scene: &Scene, surface: SurfaceId) -> f64 {
    scene.exitance_as_solved(surface).iter().copied().fold(0.0, f64::max)
}

/// The part of cosine-distributed rays from random points of all surfaces that leaves the scene.
fn sampled_share_lost(scene: &Scene, rays: &Rays<'_>, total_area: f64) -> f64 {
    // Points at even steps through the surfaces' areas, one ray from each.
    let mut probes = Vec::new();
    let mut below = 0.0;
    for surface in scene.surfaces() {
        let facet = surface.polygon.facet();
        let frame = Frame::around(facet.normal);
        below += facet.area;
        while f64::from(probes.len() as u32) + 0.5 < below / total_area * f64::from(PROBES) {
            let [u, v, s, t] = sampling::sobol_4d(probes.len() as u32, 0);
            let direction = frame.sampled_by_cosine(s, t).to_array();
            probes.push(Ray { origin: facet.point_at(u, v).to_array(), direction, origin_plane: surface.plane });
        }
    }

    let mut hits = Vec::new();
    rays.first_hits(&probes, &mut hits);
    hits.iter().filter(|hit| hit.is_none()).count() as f64 / probes.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::geometry::Polygon;
    use crate::scene::{Material, Sides};
    use crate::visibility::{Backend, OccluderMesh, build};

    #[test]
    fn large_dim_emitters_beside_bright_ones_are_left_to_paths() {
        // A room under a wide sky, and an emitter in it.
        let quad = |corners: [[f64; 3]; 4]| Polygon::from_vertices(corners.map(DVec3::from).to_vec()).unwrap();
        let side = |a: [f64; 2], b: [f64; 2]| quad([[a[0], a[1], 0.0], [b[0], b[1], 0.0], [b[0], b[1], 1.0], [a[0], a[1], 1.0]]);
        let floor = quad([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]);
        let sky = quad([[0.0, 0.0, 1.0], [0.0, 1.0, 1.0], [1.0, 1.0, 1.0], [1.0, 0.0, 1.0]]);
        let emitter = quad([[0.4, 0.4, 0.9], [0.4, 0.5, 0.9], [0.5, 0.5, 0.9], [0.5, 0.4, 0.9]]);
        let walls = [([1.0, 0.0], [0.0, 0.0]), ([1.0, 1.0], [1.0, 0.0]), ([0.0, 1.0], [1.0, 1.0]), ([0.0, 0.0], [0.0, 1.0])];
        let material = |exitance: f64| Material { name: String::new(), reflectance: vec![0.5], exitance: vec![exitance] };
        let mut faces = vec![(floor, 0, 0), (sky, 1, 1), (emitter, 2, 2)];
        faces.extend(walls.map(|(a, b)| (side(a, b), 1, 3)));
        let scene = Scene::new(1, vec![material(0.0), material(1.0), material(20.0)], faces, Sides::Front).unwrap();
        let visibility = build(Backend::default(), &OccluderMesh::of_scene(&scene)).unwrap();
        let rays = Rays::new(&*visibility, &scene);
        let emitters = Emitters::new(&scene, &rays);
        assert_eq!(
            (emitters.contains(SurfaceId(0)), emitters.contains(SurfaceId(1)), emitters.contains(SurfaceId(2))),
            (false, false, true)
        );
    }

    #[test]
    fn rays_that_do_not_meet_the_other_square_are_lost() {
        let quad = |corners: [[f64; 3]; 4]| Polygon::from_vertices(corners.map(DVec3::from).to_vec()).unwrap();
        let floor = quad([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]);
        let ceiling = quad([[0.0, 0.0, 1.0], [0.0, 1.0, 1.0], [1.0, 1.0, 1.0], [1.0, 0.0, 1.0]]);
        let material = Material { name: String::new(), reflectance: vec![0.5], exitance: vec![1.0] };
        let scene = Scene::new(1, vec![material], vec![(floor, 0, 0), (ceiling, 0, 1)], Sides::Front).unwrap();
        let visibility = build(Backend::default(), &OccluderMesh::of_scene(&scene)).unwrap();
        let rays = Rays::new(&*visibility, &scene);

        // One of two facing squares sees the other by 0.19982 (Howell C-11).
        let (lost, expected) = (sampled_share_lost(&scene, &rays, 2.0), 1.0 - 0.19982);
        let sigma = (expected * (1.0 - expected) / f64::from(PROBES)).sqrt();
        assert!((lost - expected).abs() <= 3.0 * sigma, "{lost} instead of {expected} +- {sigma}");
        assert!(Emitters::new(&scene, &rays).contains(SurfaceId(0)));
    }
}
