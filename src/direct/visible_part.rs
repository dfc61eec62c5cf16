//! The part of a source that a point sees: exactly, as convex pieces.
//!
//! From the source, cut to what is above the horizon, the outlines of all blockers are taken one after the other, the largest first. The work may
//! be limited; then the pieces are what the blockers so far leave, and the rest is undecided.

use glam::DVec3;

use super::blockers::Blockers;
use super::candidates::Candidates;
use super::outline::Outline;
use super::pieces::Pieces;
use super::view::View;

/// What a point sees of a source; memory that is reused.
#[derive(Default)]
pub(super) struct VisiblePart {
    pieces: Pieces,
    outline: Outline,
    candidates: Candidates,
}

/// What is known of the visible part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Visible {
    /// The form factor of what is not known to be hidden: of the visible part, where that is decided.
    pub form_factor: f64,
    /// Whether all blockers were taken out.
    pub is_decided: bool,
}

impl VisiblePart {
    /// Finds the part of the source that the point sees, in no more than about so many [`steps`](Pieces::steps).
    pub fn find(&mut self, view: &View<'_>, blockers: &Blockers<'_>, most_steps: u64) -> Visible {
        let Self { pieces, outline, candidates } = self;
        pieces.restart(view.source.vertices.iter().map(|&v| v - view.point));
        pieces.keep_inside(view.normal);
        let Some(cone) = pieces.iter().next() else { return Visible { form_factor: 0.0, is_decided: true } };
        candidates.find(view, cone, blockers, outline, most_steps);
        pieces.steps = candidates.steps;
        let are_all_found = candidates.steps <= most_steps;

        // Take out one blocker after the other.
        let (count, mut taken) = (candidates.len(), 0);
        for surface in candidates.by_size() {
            if pieces.is_empty() || pieces.steps > most_steps {
                break;
            }
            if outline.trace(view, blockers.get(surface), blockers.contact) {
                pieces.subtract(outline);
            }
            taken += 1;
        }
        let is_decided = pieces.is_empty() || are_all_found && taken == count;
        Visible { form_factor: pieces.form_factor(view.normal), is_decided }
    }

    /// The pieces that were found last, by unit directions to their corners.
    pub fn pieces(&self) -> impl ExactSizeIterator<Item = &[DVec3]> + Clone {
        self.pieces.iter()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::form_factor::point_to_polygon;
    use crate::geometry::{Clip, ClippedFacet, Polygon, clip_to_front, sampling};
    use crate::scene::{Material, Scene, Sides};
    use crate::transmittance::Rays;
    use crate::visibility::{Backend, OccluderMesh, build};

    fn random(seed: u64, k: u64) -> f64 {
        sampling::unit(sampling::hash(seed, k))
    }

    /// A random triangle in the unit cube.
    fn triangle(seed: u64) -> Option<Polygon> {
        let corner = |k: u64| DVec3::new(random(seed, 3 * k), random(seed, 3 * k + 1), random(seed, 3 * k + 2));
        Polygon::from_vertices((0..3).map(corner).collect()).ok()
    }

    /// A source over a point in the plane z = 0, and blockers.
    fn scene(source: &Polygon, blockers: impl Iterator<Item = Polygon>) -> Scene {
        let black = Material { name: String::new(), reflectance: vec![0.0], exitance: vec![0.0] };
        let faces = [source.clone()].into_iter().chain(blockers).map(|polygon| (polygon, 0, 0)).collect();
        Scene::new(1, vec![black], faces, Sides::Front).unwrap()
    }

    fn ceiling() -> Polygon {
        Polygon::new(&[[0.0, 0.0, 0.8], [0.0, 1.0, 0.8], [1.0, 1.0, 0.8], [1.0, 0.0, 0.8]]).unwrap()
    }

    const PLANES: [u32; 2] = [u32::MAX, 0];

    fn view(point: DVec3, source: &Polygon) -> View<'_> {
        View { point, normal: DVec3::Z, plane: PLANES[0], source: source.facet(), source_plane: PLANES[1] }
    }

    /// What a blocker hides is the source cut to the planes through its edges, where all of the blocker is between.
    #[test]
    fn what_is_seen_and_what_is_hidden_are_the_whole() {
        let source = ceiling();
        let (mut hidden_somewhat, mut part) = (0, VisiblePart::default());
        for seed in 0..2000 {
            let Some(blocker) = triangle(seed) else { continue };
            let point = DVec3::new(random(seed, 20), random(seed, 21), 0.0);
            if blocker.vertices().any(|v| v[2] > 0.8) {
                continue;
            }
            let scene = scene(&source, [blocker.clone()].into_iter());
            let visibility = build(Backend::BruteForce, &OccluderMesh::of_scene(&scene)).unwrap();
            let rays = Rays::new(&*visibility, &scene);
            let found = part.find(&view(point, &source), &Blockers::of(&scene, &rays), u64::MAX);

            let mut hidden = Some(ClippedFacet::copy_of(&source.facet()));
            let corners: Vec<DVec3> = blocker.facet().vertices.to_vec();
            for k in 0..3 {
                let normal = (corners[k] - point).cross(corners[(k + 1) % 3] - point).normalize();
                let inward = normal * normal.dot(corners[(k + 2) % 3] - point).signum();
                hidden = hidden.and_then(|facet| match clip_to_front(&facet.facet(), point, inward) {
                    Clip::Whole => Some(facet),
                    Clip::Part(part) => Some(part),
                    Clip::Nothing => None,
                });
            }
            let hidden = hidden.map_or(0.0, |facet| point_to_polygon(point, DVec3::Z, &facet.facet()));
            let whole = point_to_polygon(point, DVec3::Z, &source.facet());
            assert!(found.is_decided && (found.form_factor + hidden - whole).abs() < 1e-11, "seed {seed}");
            hidden_somewhat += u32::from(hidden > 1e-3);
        }
        assert!(hidden_somewhat > 300, "{hidden_somewhat}");
    }

    #[test]
    fn little_work_leaves_more_open() {
        let source = ceiling();
        let scene = scene(&source, (0..60).filter_map(triangle));
        let visibility = build(Backend::BruteForce, &OccluderMesh::of_scene(&scene)).unwrap();
        let rays = Rays::new(&*visibility, &scene);
        let blockers = Blockers::of(&scene, &rays);
        let point = DVec3::new(0.4, 0.3, 0.0);
        let mut part = VisiblePart::default();
        let exact = part.find(&view(point, &source), &blockers, u64::MAX);
        assert!(exact.is_decided && exact.form_factor > 0.0);
        let mut above = Visible { form_factor: 1.0, is_decided: false };
        for steps in (0..16).map(|k| 1 << k) {
            let found = part.find(&view(point, &source), &blockers, steps);
            assert!(found.form_factor <= above.form_factor + 1e-12 && found.form_factor >= exact.form_factor - 1e-12);
            assert!(found.is_decided || !above.is_decided);
            above = found;
        }
        assert_eq!(above, exact);
    }
}
