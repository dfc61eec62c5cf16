//! Where the faces are that warnings are about, so that a page can show them.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec3;
use serde_json::{Value, json};

use crate::scene::{Scene, Surface};

/// By the number of a face, from 1: its outline as pairs of points, its middle, its normal, and how far it reaches, in metres. Faces that the scene does
/// not have are left out.
pub(super) fn places(scene: &Scene, warned: &[Option<u32>]) -> Value {
    let wanted: BTreeSet<u32> = warned.iter().flatten().map(|face| face - 1).collect();
    let mut pieces: BTreeMap<u32, Vec<&Surface>> = BTreeMap::new();
    for (number, surface) in scene.surfaces().iter().enumerate().filter(|(_, surface)| wanted.contains(&surface.face)) {
        // One side of a face with two is enough.
        let is_back =
            surface.twin().is_some_and(|twin| (twin.0 as usize) < number && scene.surfaces()[twin.0 as usize].face == surface.face);
        if !is_back {
            pieces.entry(surface.face).or_default().push(surface);
        }
    }
    pieces.into_iter().map(|(face, pieces)| ((face + 1).to_string(), place(&pieces))).collect::<serde_json::Map<_, _>>().into()
}

fn place(pieces: &[&Surface]) -> Value {
    // Edges between two pieces run both ways, and are not part of the outline.
    type Edge = [[u64; 3]; 2];
    let mut edges: BTreeMap<Edge, [[f64; 3]; 2]> = BTreeMap::new();
    for piece in pieces {
        let vertices: Vec<[f64; 3]> = piece.polygon.vertices().collect();
        for (k, &from) in vertices.iter().enumerate() {
            let to = vertices[(k + 1) % vertices.len()];
            let key = [from, to].map(|vertex| vertex.map(f64::to_bits));
            if edges.remove(&[key[1], key[0]]).is_none() {
                edges.insert(key, [from, to]);
            }
        }
    }

    let area: f64 = pieces.iter().map(|piece| piece.polygon.area()).sum();
    let mean = |of: &dyn Fn(&Surface) -> [f64; 3]| {
        pieces.iter().map(|piece| piece.polygon.area() / area * DVec3::from(of(piece))).sum::<DVec3>()
    };
    let (centre, normal) = (mean(&|piece| piece.polygon.centroid()), mean(&|piece| piece.polygon.normal()));
    let vertices = pieces.iter().flat_map(|piece| piece.polygon.vertices());
    let radius = vertices.map(|vertex| centre.distance(vertex.into())).fold(0.0, f64::max);
    let outline: Vec<f64> = edges.into_values().flatten().flatten().collect();
    json!({ "outline": outline, "centre": centre.to_array(), "normal": normal.normalize_or_zero().to_array(), "radius": radius })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Polygon;
    use crate::scene::{Material, Sides};

    /// A face of two pieces, number 4, and one of one piece, number 7.
    fn scene(sides: Sides) -> Scene {
        let grey = Material { name: String::new(), reflectance: vec![0.5], exitance: vec![0.0] };
        let at = |x: f64| [[x, 0.0, 0.0], [x + 1.0, 0.0, 0.0], [x + 1.0, 1.0, 0.0], [x, 1.0, 0.0]];
        let polygons = [(0.0, 3), (1.0, 3), (5.0, 6)].map(|(x, face)| (Polygon::new(&at(x)).unwrap(), 0, face)).to_vec();
        Scene::new(1, vec![grey], polygons, sides).unwrap()
    }

    #[test]
    fn a_face_is_outlined_as_a_whole_on_one_side() {
        for sides in [Sides::Front, Sides::Both] {
            let found = places(&scene(sides), &[Some(4), None, Some(4), Some(90)]);
            assert_eq!(found.as_object().unwrap().len(), 1, "{found}");
            let face = &found["4"];
            // Six edges of the two squares side by side, of two points each.
            assert_eq!(face["outline"].as_array().unwrap().len(), 6 * 6);
            assert_eq!((&face["centre"], &face["normal"]), (&json!([1.0, 0.5, 0.0]), &json!([0.0, 0.0, 1.0])));
            assert!((face["radius"].as_f64().unwrap() - 1.25_f64.sqrt()).abs() < 1e-12);
        }
    }
}
