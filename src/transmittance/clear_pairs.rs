//! Pairs of planes with nothing between their surfaces, by proof: rays between these are never blocked, and are not cast.

use crate::geometry::{Aabb, Facet, in_front, is_apart};
use crate::scene::{Scene, Surface, SurfaceId};
use crate::visibility::{NO_PLANE, Segment};

/// With more surfaces nothing is proved: the cost grows with the cube of their number, and would exceed that of the rays.
const MOST_SURFACES: usize = 32;

/// An overlap up to this part of the scene's diagonal counts as contact.
const CONTACT_OF_SIZE: f64 = 1e-12;

/// For every pair of planes, whether it is proved that nothing stands between any of their surfaces.
pub(super) struct ClearPairs {
    planes: usize,
    clear: Vec<bool>,
}

impl ClearPairs {
    /// `None` if no pair is clear, or if there are more than [`MOST_SURFACES`].
    pub fn of(scene: &Scene) -> Option<Self> {
        let surfaces = scene.surfaces();
        if surfaces.len() > MOST_SURFACES {
            return None;
        }
        let planes = surfaces.iter().map(|surface| surface.plane() as usize + 1).max()?;
        let tolerance = CONTACT_OF_SIZE * scene.bounds().diagonal();
        let mut clear = vec![false; planes * planes];
        for first in 0..planes {
            for second in first + 1..planes {
                let is_clear = is_clear(scene, [first as u32, second as u32], tolerance);
                clear[first * planes + second] = is_clear;
                clear[second * planes + first] = is_clear;
            }
        }
        clear.contains(&true).then_some(Self { planes, clear })
    }

    /// Whether a segment lies between surfaces of a clear pair of planes.
    pub fn is_clear(&self, segment: &Segment) -> bool {
        self.is_clear_between([segment.from_plane, segment.to_plane])
    }

    /// Whether a pair of planes is clear.
    pub fn is_clear_between(&self, [from, to]: [u32; 2]) -> bool {
        from != NO_PLANE && to != NO_PLANE && self.clear[from as usize * self.planes + to as usize]
    }
}

/// Whether no surface reaches into the convex hull of any two surfaces of these planes, cut to their parts in front of each other.
fn is_clear(scene: &Scene, planes: [u32; 2], tolerance: f64) -> bool {
    let surfaces = scene.surfaces();
    let [first, second] = planes.map(|plane| surfaces.iter().filter(move |surface| surface.plane() == plane));
    first.into_iter().all(|receiver| {
        second.clone().all(|source| {
            let (receiver, source) = (receiver.polygon.facet(), source.polygon.facet());
            let parts = in_front(&receiver, &source).zip(in_front(&source, &receiver));
            parts.is_none_or(|(receiver, source)| {
                let is_beside = |(index, surface): (usize, &Surface)| {
                    let is_second_side = surface.twin().is_some_and(|SurfaceId(twin)| (twin as usize) < index);
                    planes.contains(&surface.plane())
                        || is_second_side
                        || !is_between(&receiver.facet(), &source.facet(), surface, tolerance)
                };
                surfaces.iter().enumerate().all(is_beside)
            })
        })
    })
}

/// Whether a surface may reach into the convex hull of two others that are in front of each other.
fn is_between(receiver: &Facet<'_>, source: &Facet<'_>, surface: &Surface, tolerance: f64) -> bool {
    let blocker = surface.polygon.facet();
    let around = Aabb::around(receiver.vertices.iter().chain(source.vertices).copied());
    let bounds = surface.polygon.bounds();
    let is_behind = |front: &Facet<'_>| blocker.vertices.iter().all(|&vertex| front.height(vertex) <= tolerance);
    let is_beside = bounds.min.cmpge(around.max).any() || bounds.max.cmple(around.min).any();
    !(is_beside || is_behind(receiver) || is_behind(source) || is_apart(receiver.vertices, source.vertices, &blocker, tolerance))
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::geometry::sampling;
    use crate::scene::import::{ImportOptions, read_scene};
    use crate::visibility::{Backend, OccluderMesh, build};

    #[test]
    fn no_segment_between_clear_planes_is_occluded() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/cornell.obj");
        let scene = read_scene(path.as_ref(), &ImportOptions::default()).unwrap().scene;
        let visibility = build(Backend::BruteForce, &OccluderMesh::of_scene(&scene)).unwrap();
        let pairs = ClearPairs::of(&scene).unwrap();

        let (mut clear, mut open, mut occluded) = (Vec::new(), 0, Vec::new());
        for (index, (receiver, source)) in
            scene.surfaces().iter().flat_map(|a| scene.surfaces().iter().map(move |b| (a, b))).enumerate()
        {
            let (receiver_facet, source_facet) = (receiver.polygon.facet(), source.polygon.facet());
            for sample in 0..64 {
                let [u, v, s, t] = sampling::sobol_4d(sample, index as u64);
                let (x, y): (DVec3, DVec3) = (receiver_facet.point_at(u, v), source_facet.point_at(s, t));
                let (from, to) = (x.to_array(), y.to_array());
                let segment = Segment { from, to, from_plane: receiver.plane(), to_plane: source.plane() };
                if receiver_facet.height(y) <= 0.0 || source_facet.height(x) <= 0.0 {
                    continue;
                }
                if pairs.is_clear(&segment) { clear.push(segment) } else { open += 1 }
            }
        }
        occluded.resize(clear.len(), true);
        visibility.occluded(&clear, &mut occluded);
        assert!(!occluded.contains(&true));
        assert!(clear.len() > 2000 && open > 2000, "{} clear, {open} not", clear.len());
    }
}
