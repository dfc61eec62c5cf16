//! Rays that light would be lost on, as a page has them.

use serde_json::{Value, json};

use crate::inspect::{LostRay, SurfaceRays};

/// No more rays of a kind than this are drawn: more hide the scene.
const MOST_DRAWN: usize = 500;

/// The colours of rays that leave the scene, and of those that meet backs: that of backs on the page.
const COLOURS: [[u8; 3]; 2] = [[255, 80, 40], [200, 0, 200]];

/// The parts of all rays that leave the scene and that meet backs, and of these in turn how many are drawn, and in which colour; and the ends of those, in
/// metres.
pub(super) fn told(met: &SurfaceRays) -> (Value, Vec<f32>) {
    let (leaving, backs): (Vec<&LostRay>, Vec<&LostRay>) = met.lost.iter().partition(|ray| ray.back_of.is_none());
    // At even steps through all: they are in the order of the surfaces.
    let drawn = |of: &[&LostRay]| -> Vec<[[f64; 3]; 2]> {
        let count = of.len().min(MOST_DRAWN);
        (0..count).map(|number| of[number * of.len() / count].ends).collect()
    };
    let [leaves, meets] = [&leaving, &backs].map(|of| met.share(of.len() as u32));
    let [leaving, backs] = [&leaving, &backs].map(|of| drawn(of));
    let kinds = [(leaving.len(), COLOURS[0]), (backs.len(), COLOURS[1])];
    let ends = [leaving, backs].into_iter().flatten().flatten().flatten().map(|x| x as f32).collect();
    (json!({ "leave": leaves, "meet_backs": meets, "kinds": kinds }), ends)
}
