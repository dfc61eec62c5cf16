//! Defect correction: how a change of radiosities is reflected over links.
//!
//! Sweeps over links solve `B = E + rho K B`, K being the links. A gather at points is a more exact operator G: with it leaves
//! change by the defect `d = E + rho G B - B`. The correction `B + (I - rho K)^-1 d` reflects that over the links, and is close to
//! the solution of `B' = E + rho G B'`: it differs by the difference of G and K, applied to a correction that is small already.

use super::{Closure, Exposure, Radiosity, gather, push};
use crate::hierarchy::{Hierarchy, NodeId};
use crate::links::LinkSet;
use crate::scene::{Scene, SurfaceId};

/// Reflections are followed down to this part of the change.
const TOLERANCE: f64 = 0.01;

/// Reflections at most; a reflectance of 0.95 needs fewer to reach [`TOLERANCE`].
const MOST_REFLECTIONS: u32 = 100;

/// The links over which a change is reflected.
pub(crate) struct Reflections<'a> {
    pub scene: &'a Scene,
    pub hierarchy: &'a Hierarchy,
    pub links: &'a LinkSet,
    pub exposure: &'a Exposure,
    pub closure: Option<&'a Closure>,
}

impl Reflections<'_> {
    /// Adds the reflections of a change, `(rho K + (rho K)^2 + ...) change`, to the radiosities of all leaves; of `change` only
    /// that of leaves counts. Inner nodes are left to be pulled. Ends early if `stop` says so.
    pub fn add(&self, mut change: Radiosity, radiosity: &mut Radiosity, stop: &dyn Fn() -> bool) {
        let Self { scene, hierarchy, links, exposure, closure } = *self;
        let leaves: Vec<NodeId> = hierarchy.ids().filter(|&node| hierarchy.is_leaf(node)).collect();
        let size = |change: &Radiosity| {
            let of_leaf = |leaf| change.of(leaf)[..scene.deciding()].iter().map(|b| b.abs()).sum::<f64>();
            leaves.iter().map(|&leaf| hierarchy.area(leaf) * of_leaf(leaf)).sum::<f64>()
        };
        let enough = TOLERANCE * size(&change);
        for _ in 0..MOST_REFLECTIONS {
            // One bounce of what is left.
            change.pull(hierarchy, exposure);
            let irradiance = push(hierarchy, gather(hierarchy, links, exposure, &change), change.channels());
            for &leaf in &leaves {
                let reflectance = &scene.material_of(SurfaceId(hierarchy.node(leaf).surface)).reflectance;
                let factor = closure.map_or(1.0, |closure| closure.factor(leaf));
                let arriving = &irradiance[leaf.index() * change.channels()..];
                for (channel, (rho, h)) in reflectance.iter().zip(arriving).enumerate() {
                    let reflected = rho * factor * h;
                    change.of_mut(leaf)[channel] = reflected;
                    radiosity.of_mut(leaf)[channel] += reflected;
                }
                scene.clear_dark(radiosity.of_mut(leaf));
            }
            if size(&change) <= enough || stop() {
                return;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Polygon;
    use crate::links::Link;
    use crate::scene::{Material, Sides};
    use crate::transmittance::Rays;
    use crate::visibility::{Backend, OccluderMesh, build};

    /// Six plates, each linked with all others alike: a change of 1 at the first gives `b_0 = 1 + rho b`,
    /// `b = rho (b_0 + 4 b) / 5`.
    #[test]
    fn a_change_of_one_plate_of_six_is_reflected() {
        let square = |at: f64| [[at, 0.0, 0.0], [at + 1.0, 0.0, 0.0], [at + 1.0, 1.0, 0.0], [at, 1.0, 0.0]];
        let grey = Material { name: "grey".to_owned(), reflectance: vec![0.5], exitance: vec![1.0] };
        let faces = (0..6).map(|k| (Polygon::new(&square(2.0 * f64::from(k))).unwrap(), 0, k)).collect();
        let scene = Scene::new(1, vec![grey], faces, Sides::Front).unwrap();
        let hierarchy = Hierarchy::new(&scene);
        let plates: Vec<NodeId> = (0..6).map(|k| hierarchy.node_of(SurfaceId(k))).collect();
        let link = |source| Link { form_factor: 0.2, source, transmittance: 1.0, seen: 1.0 };
        let others =
            |&receiver: &NodeId| plates.iter().filter(move |&&source| source != receiver).map(move |&s| (receiver, link(s)));
        let links = LinkSet::new(hierarchy.len(), &plates.iter().flat_map(others).collect::<Vec<_>>(), Vec::new());
        let visibility = build(Backend::BruteForce, &OccluderMesh::of_scene(&scene)).unwrap();
        let mut exposure = Exposure::default();
        exposure.grow(&scene, &hierarchy, &Rays::new(&*visibility, &scene), 0, &|| false);

        let before = Radiosity::emitted(&scene, &hierarchy, &exposure);
        let mut change = before.clone();
        plates.iter().enumerate().for_each(|(k, &plate)| change.of_mut(plate)[0] = if k == 0 { 1.0 } else { 0.0 });
        let mut after = before.clone();
        let (scene, hierarchy, links, exposure) = (&scene, &hierarchy, &links, &exposure);
        Reflections { scene, hierarchy, links, exposure, closure: None }.add(change, &mut after, &|| false);
        for (k, &plate) in plates.iter().enumerate() {
            let (found, exact) = (after.of(plate)[0] - before.of(plate)[0], if k == 0 { 1.0 / 11.0 } else { 2.0 / 11.0 });
            assert!((found - exact).abs() < TOLERANCE, "plate {k}: {found}, not {exact}");
        }
    }
}
