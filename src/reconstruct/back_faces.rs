//! Whether faces are seen from behind: the sign of a wall that is wound the wrong way.
//!
//! Faces emit and receive on their front. In a scene that is wound consistently, a ray that leaves the front of a face meets the front
//! of another, or nothing. A back that is met stands where light is lost.

use std::collections::BTreeMap;

use glam::DVec3;

use crate::geometry::Frame;
use crate::scene::{Scene, SurfaceId};
use crate::visibility::{Ray, Visibility};

/// What rays from front faces found.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct BackFaces {
    /// Rays that were traced.
    pub rays: u32,
    /// Rays that met a back face first.
    pub met: u32,
    /// Numbers of the input faces (0-based) that were met from behind, and how often; most often first.
    pub faces: Vec<(u32, u32)>,
}

impl BackFaces {
    /// The share of the rays that met a back face.
    pub fn share(&self) -> f64 {
        f64::from(self.met) / f64::from(self.rays.max(1))
    }
}

/// Looks around from `rays` points spread over all front faces by area, one cosine-distributed ray each; `visibility` must be of `scene`.
/// Surfaces with a twin on their back have no back faces.
pub fn sampled_back_faces(scene: &Scene, visibility: &dyn Visibility, rays: u32) -> BackFaces {
    // Points by area: walk the surfaces along evenly spaced marks of their summed area.
    let total: f64 = scene.surfaces().iter().map(|surface| surface.polygon.area()).sum();
    let spacing = total / f64::from(rays.max(1));
    let mut asked = Vec::with_capacity(rays as usize);
    let (mut passed, mut next) = (0.0, 0.5 * spacing);
    for surface in scene.surfaces() {
        let (facet, area) = (surface.polygon.facet(), surface.polygon.area());
        while next < passed + area && asked.len() < rays as usize {
            let k = asked.len() as f64;
            let point = facet.point_at(fraction(0.5 + k * R4[0]), fraction(0.5 + k * R4[1]));
            let (r, turn) = (fraction(0.5 + k * R4[2]), std::f64::consts::TAU * fraction(0.5 + k * R4[3]));
            let local = DVec3::new(r.sqrt() * turn.cos(), r.sqrt() * turn.sin(), (1.0 - r).sqrt());
            let direction = Frame::around(facet.normal).to_world(local);
            asked.push(Ray { origin: point.to_array(), direction: direction.to_array(), origin_plane: surface.plane });
            next += spacing;
        }
        passed += area;
    }

    let mut hits = vec![None; asked.len()];
    visibility.first_hits(&asked, &mut hits);
    let mut faces: BTreeMap<u32, u32> = BTreeMap::new();
    for (ray, hit) in asked.iter().zip(hits) {
        let Some(surface) = hit.map(|hit| scene.surface(SurfaceId(hit.surface))) else { continue };
        let from_behind = DVec3::from(ray.direction).dot(DVec3::from(surface.polygon.normal())) > 0.0;
        if from_behind && surface.twin.is_none() {
            *faces.entry(surface.face).or_default() += 1;
        }
    }
    let mut faces: Vec<(u32, u32)> = faces.into_iter().collect();
    faces.sort_by_key(|&(face, count)| (std::cmp::Reverse(count), face));
    BackFaces { rays: asked.len() as u32, met: faces.iter().map(|(_, count)| count).sum(), faces }
}

/// Powers of 1/g, where g^5 = g + 1: steps of a sequence that fills the unit cube in four dimensions evenly (Roberts 2018).
const R4: [f64; 4] = [0.856_674_883_854_502_9, 0.733_891_856_627_126, 0.628_706_721_037_808_6, 0.538_597_257_223_61];

fn fraction(x: f64) -> f64 {
    x - x.floor()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Polygon;
    use crate::scene::{Material, Sides};
    use crate::visibility::{Backend, OccluderMesh, build};

    /// The unit cube seen from inside, with face `turned` wound the other way.
    fn cube(turned: Option<usize>) -> BackFaces {
        let inward = [
            [[0., 0., 0.], [0., 1., 0.], [0., 1., 1.], [0., 0., 1.]],
            [[1., 0., 0.], [1., 0., 1.], [1., 1., 1.], [1., 1., 0.]],
            [[0., 0., 0.], [0., 0., 1.], [1., 0., 1.], [1., 0., 0.]],
            [[0., 1., 0.], [1., 1., 0.], [1., 1., 1.], [0., 1., 1.]],
            [[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]],
            [[0., 0., 1.], [0., 1., 1.], [1., 1., 1.], [1., 0., 1.]],
        ];
        let faces = (0..6).map(|k| {
            let polygon = Polygon::new(&inward[k]).unwrap();
            (if turned == Some(k) { polygon.reversed() } else { polygon }, 0, k as u32)
        });
        let grey = Material { name: "grey".to_owned(), reflectance: vec![0.5], exitance: vec![0.0] };
        let scene = Scene::new(1, vec![grey], faces.collect(), Sides::Front).unwrap();
        let visibility = build(Backend::BruteForce, &OccluderMesh::of_scene(&scene)).unwrap();
        sampled_back_faces(&scene, visibility.as_ref(), 6000)
    }

    #[test]
    fn a_room_wound_inwards_shows_no_back_face() {
        assert_eq!(cube(None), BackFaces { rays: 6000, met: 0, faces: vec![] });
    }

    #[test]
    fn a_wall_wound_outwards_is_found() {
        // Each other wall sees it under the form factor of two sides of a cube, 0.2; a sixth of the rays leave the wall itself outwards.
        let seen = cube(Some(3));
        assert_eq!(seen.faces.len(), 1);
        assert_eq!(seen.faces[0].0, 3);
        assert!((seen.share() - 5.0 / 6.0 * 0.2).abs() < 0.01, "{}", seen.share());
    }
}
