//! The part of a source that a point sees: exactly, as convex pieces.
//!
//! From the source, cut to what is above the horizon, the outlines of all blockers are taken one after the other, the largest first. The work may
//! be limited; then the pieces are what the blockers so far leave, and the rest is undecided.
//!
//! Where many blockers may stand between, few hide most of the source as a rule, and all others behind them. So there, rays through the middles of what is left
//! find some first; what stands between is then looked for in the cone around what these leave.

use glam::DVec3;

use super::blockers::Blockers;
use super::candidates::Candidates;
use super::outline::Outline;
use super::pieces::Pieces;
use super::view::View;
use crate::transmittance::STEPS_PER_RAY;

/// Rays that look for blockers, at most.
const MOST_RAYS: u32 = 4;

/// Steps that take as long as such a ray: it is cast alone, and for its first hit.
const STEPS_OF_RAY: u64 = 2 * STEPS_PER_RAY;

/// To look for what stands between without rays may take so many steps first.
const STEPS_BEFORE_RAYS: u64 = 4 * STEPS_OF_RAY;

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
        candidates.find(view, cone, blockers, outline, most_steps.min(STEPS_BEFORE_RAYS));
        pieces.steps += candidates.steps;
        let mut are_all_found = candidates.steps <= most_steps.min(STEPS_BEFORE_RAYS);

        // Where that is not enough: what rays meet is taken out, and the rest is looked for in front of what this leaves.
        if !are_all_found && most_steps > STEPS_BEFORE_RAYS {
            take_out_first_hits(view, blockers, pieces, outline);
            let Some(cone) = pieces.cone(view.source.normal) else { return Visible { form_factor: 0.0, is_decided: true } };
            let left = most_steps.saturating_sub(pieces.steps);
            candidates.find(view, &cone, blockers, outline, left);
            pieces.steps += candidates.steps;
            are_all_found = candidates.steps <= left;
        }

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

    /// Work that it took to find them, in corners that were held against planes.
    pub fn steps(&self) -> u64 {
        self.pieces.steps
    }

    /// The pieces that were found last, by unit directions to their corners.
    pub fn pieces(&self) -> impl ExactSizeIterator<Item = &[DVec3]> + Clone {
        self.pieces.iter()
    }
}

/// Takes out blockers that rays meet through the middle of the largest piece, until one meets none.
fn take_out_first_hits(view: &View<'_>, blockers: &Blockers<'_>, pieces: &mut Pieces, outline: &mut Outline) {
    for _ in 0..MOST_RAYS {
        let Some(middle) = pieces.middle_of_largest() else { return };
        pieces.steps += STEPS_OF_RAY;
        let Some(blocker) = blockers.first_met(view, middle) else { return };
        if !outline.trace(view, blocker, blockers.contact) {
            return;
        }
        pieces.subtract(outline);
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

    /// Deep between two of many plates: they alone hide what is hidden, and rays find them first.
    #[test]
    fn of_many_plates_the_nearest_decide() {
        let source = ceiling();
        let plate = |k: u32| {
            let x = 0.01 * f64::from(k);
            Polygon::new(&[[x, -1.0, -0.5], [x, 2.0, -0.5], [x, 2.0, 0.0], [x, -1.0, 0.0]]).unwrap()
        };
        let found = |seed: u64, plates: &mut dyn Iterator<Item = u32>| {
            let number = (99.0 * random(seed, 0)) as u32;
            let point = DVec3::new(0.01 * (f64::from(number) + 0.5), random(seed, 1), -0.4 - 0.1 * random(seed, 2));
            let plates = plates.map(|k| if k < 2 { plate(number + k) } else { plate(k - 2) });
            let scene = scene(&source, plates);
            let visibility = build(Backend::BruteForce, &OccluderMesh::of_scene(&scene)).unwrap();
            let rays = Rays::new(&*visibility, &scene);
            let visible = VisiblePart::default().find(&view(point, &source), &Blockers::of(&scene, &rays), u64::MAX);
            assert!(visible.is_decided);
            (visible.form_factor, rays.first_hit_rays().count())
        };
        for seed in 0..50 {
            let ((all, rays), (nearest, none)) = (found(seed, &mut (2..103)), found(seed, &mut (0..2)));
            assert!(all > 0.0 && (all - nearest).abs() < 1e-11, "seed {seed}: {all}, {nearest}");
            assert!(rays > 0 && none == 0, "seed {seed}: {rays} rays, and {none}");
        }
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
