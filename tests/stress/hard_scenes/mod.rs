//! Scenes that are hard in one way each. Nearly all have a known solution, and one channel.
//!
//! Two tricks give solutions. In a closed room whose surfaces emit `(1 - rho) B0` all light is `B0`, whatever stands in it (Kirchhoff). And
//! where nothing reflects but one plane, with nothing in front of its lamps, `B = rho * sum of E F` with exact form factors.

mod furnaces;
mod lamps;
mod nothing;
mod overlaps;
mod scene;
mod shapes;

use patchlight::geometry::Polygon;
use patchlight::scene::Scene;

pub use furnaces::furnace_of_small_boxes;
pub use scene::HardScene;

use crate::triangles::{Random, add, times};

/// All of them.
pub fn all() -> Vec<HardScene> {
    let mut scenes = Vec::new();
    scenes.extend(furnaces::places());
    scenes.extend(shapes::shapes());
    scenes.extend(overlaps::overlaps());
    scenes.extend(lamps::lamps());
    scenes.extend(nothing::next_to_nothing());
    scenes
}

/// Every face of a scene in four, all in random order.
pub fn cut_and_shuffled(scene: &Scene, random: &mut Random) -> Scene {
    let mut pieces = Vec::new();
    for surface in scene.surfaces() {
        let corners: Vec<[f64; 3]> = surface.polygon.vertices().collect();
        let count = corners.len();
        let middle = |a: [f64; 3], b: [f64; 3]| times(add(a, b), 0.5);
        for (k, &corner) in corners.iter().enumerate() {
            let (before, after) = (corners[(k + count - 1) % count], corners[(k + 1) % count]);
            let piece = [corner, middle(corner, after), surface.polygon.centroid(), middle(before, corner)];
            pieces.insert(random.below(pieces.len() + 1), (Polygon::new(&piece).unwrap(), surface.material, surface.face));
        }
    }
    Scene::new(scene.channels(), scene.materials().to_vec(), pieces, scene.sides()).unwrap()
}
