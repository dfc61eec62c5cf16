//! Emitters as light sees them: what shines alike in one plane is one emitter, into however many surfaces it is cut.

use std::collections::HashMap;

use super::{Scene, SurfaceId};
use crate::geometry::{Facet, Polygon, convex_unions};

/// A convex polygon that emits: a surface, or the union of some that share plane, side and material.
#[derive(Clone, Debug)]
pub(crate) struct Emitter {
    /// The first of its surfaces.
    pub surface: SurfaceId,
    /// If there are several.
    union: Option<Polygon>,
}

impl Emitter {
    /// The emitters that `surfaces`, in the order of their numbers, make; in the order of their first ones.
    pub fn of_surfaces(scene: &Scene, surfaces: impl Iterator<Item = SurfaceId>) -> Vec<Self> {
        // What shares plane, side and material.
        let mut alike: HashMap<(u32, u32), Vec<Vec<SurfaceId>>> = HashMap::new();
        for id in surfaces {
            let surface = scene.surface(id);
            let normal = surface.polygon.facet().normal;
            let sides = alike.entry((surface.plane, surface.material)).or_default();
            let faces_alike = |side: &&mut Vec<SurfaceId>| scene.surface(side[0]).polygon.facet().normal.dot(normal) > 0.0;
            match sides.iter_mut().find(faces_alike) {
                Some(side) => side.push(id),
                None => sides.push(vec![id]),
            }
        }

        let of_side = |side: Vec<SurfaceId>| {
            let polygons: Vec<&Polygon> = side.iter().map(|&id| &scene.surface(id).polygon).collect();
            let emitter = |(first, union)| Self { surface: side[first], union };
            convex_unions(&polygons).into_iter().map(emitter).collect::<Vec<Self>>()
        };
        let mut emitters: Vec<Self> = alike.into_values().flatten().flat_map(of_side).collect();
        emitters.sort_unstable_by_key(|emitter| emitter.surface);
        emitters
    }

    /// All emitters of a scene.
    pub fn all(scene: &Scene) -> Vec<Self> {
        let surfaces = (0..scene.surfaces().len() as u32).map(SurfaceId);
        Self::of_surfaces(scene, surfaces.filter(|&surface| scene.material_of(surface).emits()))
    }

    /// Its polygon.
    pub fn facet<'s>(&'s self, scene: &'s Scene) -> Facet<'s> {
        self.union.as_ref().unwrap_or(&scene.surface(self.surface).polygon).facet()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Material, Sides};

    /// Two squares side by side and one above them, all as bright as `exitance` says.
    fn emitters(exitance: [f64; 3], sides: Sides) -> Vec<Emitter> {
        let square = |x: f64, z: f64| Polygon::new(&[[x, 0.0, z], [x + 1.0, 0.0, z], [x + 1.0, 1.0, z], [x, 1.0, z]]).unwrap();
        let material = |exitance: f64| Material { name: String::new(), reflectance: vec![0.5], exitance: vec![exitance] };
        let materials: Vec<Material> = [0.0, 1.0, 2.0].map(material).to_vec();
        let faces = [square(0.0, 0.0), square(1.0, 0.0), square(0.0, 1.0)].into_iter().zip(exitance).zip(0..);
        let faces = faces.map(|((polygon, exitance), face)| (polygon, exitance as u32, face)).collect();
        Emitter::all(&Scene::new(1, materials, faces, sides).unwrap())
    }

    #[test]
    fn what_shines_alike_in_a_plane_is_one_emitter() {
        let firsts = |emitters: &[Emitter]| emitters.iter().map(|emitter| emitter.surface.0).collect::<Vec<_>>();
        assert_eq!(firsts(&emitters([1.0, 1.0, 1.0], Sides::Front)), [0, 2]);
        assert_eq!(firsts(&emitters([1.0, 2.0, 1.0], Sides::Front)), [0, 1, 2]);
        assert_eq!(firsts(&emitters([0.0, 1.0, 0.0], Sides::Front)), [1]);
        // Front and back of a sheet each shine alike.
        assert_eq!(firsts(&emitters([1.0, 1.0, 0.0], Sides::Both)), [0, 1]);
    }
}
