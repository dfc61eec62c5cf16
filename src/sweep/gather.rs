//! The gather: light travels over all links once.

use rayon::prelude::*;

use super::{Exposure, Radiosity};
use crate::geometry::Lobes;
use crate::hierarchy::{Hierarchy, NodeId};
use crate::links::{Link, LinkSet};

/// The irradiance of every node's exposed part by its own links, by channel.
#[derive(Default)]
pub(crate) struct Irradiance {
    /// H of each surface and element, in W/m^2; clusters have none.
    pub(super) values: Vec<f64>,
    /// Of each cluster: H of a face as a function of its normal.
    pub(super) lobes: Vec<Lobes>,
}

/// What every node gathers over its own links from the radiosities as they stand, in parallel over receivers:
/// `H_r = sum over links of F_rs B_s`.
///
/// A cluster keeps the directions that light comes from. The power of each link is shared out over the cluster's faces by the
/// cosine to the source, so that all of it arrives.
pub(crate) fn gather(hierarchy: &Hierarchy, links: &LinkSet, exposure: &Exposure, radiosity: &Radiosity) -> Irradiance {
    let mut irradiance = Irradiance::default();
    gather_into(&mut irradiance, hierarchy, links, exposure, radiosity);
    irradiance
}

/// The same into memory that is reused from sweep to sweep.
pub(crate) fn gather_into(
    irradiance: &mut Irradiance,
    hierarchy: &Hierarchy,
    links: &LinkSet,
    exposure: &Exposure,
    radiosity: &Radiosity,
) {
    let channels = radiosity.channels();
    let clusters = hierarchy.cluster_count();
    let Irradiance { values, lobes } = irradiance;
    values.resize(channels * hierarchy.len(), 0.0);
    values.par_chunks_mut(channels).with_min_len(256).enumerate().skip(clusters).for_each(|(node, irradiance)| {
        let node = NodeId(node as u32);
        irradiance.fill(0.0);
        gather_polygon(hierarchy, node, links.of(node), exposure, radiosity, irradiance);
    });
    lobes.resize(channels * clusters, Lobes::default());
    lobes.par_chunks_mut(channels).with_min_len(16).enumerate().for_each(|(node, lobes)| {
        let node = NodeId(node as u32);
        lobes.fill(Lobes::default());
        gather_cluster(hierarchy, node, links.of(node), radiosity, lobes);
    });
}

/// Adds what a surface or element gathers over `links`.
pub(super) fn gather_polygon(
    hierarchy: &Hierarchy,
    receiver: NodeId,
    links: &[Link],
    exposure: &Exposure,
    radiosity: &Radiosity,
    irradiance: &mut [f64],
) {
    for link in links {
        radiosity.add_shown(hierarchy, receiver, link.source, link.occluded_form_factor(), irradiance);
    }
    exposure.concentrate(receiver, irradiance);
}

/// Adds what a cluster gathers over `links`.
pub(super) fn gather_cluster(hierarchy: &Hierarchy, receiver: NodeId, links: &[Link], radiosity: &Radiosity, lobes: &mut [Lobes]) {
    if links.is_empty() {
        return;
    }
    let mut arriving = vec![0.0; lobes.len()];
    for link in links {
        let direction = hierarchy.direction(receiver, link.source);
        let Some(exposed) = radiosity.exposed_area(receiver, direction) else { return };
        let concentration = hierarchy.area(receiver) / exposed;
        arriving.fill(0.0);
        radiosity.add_shown(hierarchy, receiver, link.source, link.occluded_form_factor() * concentration, &mut arriving);
        lobes.iter_mut().zip(&arriving).for_each(|(lobes, &h)| lobes.add(h, direction));
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::geometry::Polygon;
    use crate::scene::{Material, Scene, Sides, SurfaceId};
    use crate::sweep::push;
    use crate::transmittance::Rays;
    use crate::visibility::{Backend, OccluderMesh, build};

    /// Two boxes that stand on a floor, seen from outside: unequal ones, so that their clusters are lopsided.
    fn boxes() -> Scene {
        let mut quads = vec![[[-5.0, -5.0, 0.0], [5.0, -5.0, 0.0], [5.0, 5.0, 0.0], [-5.0, 5.0, 0.0]]];
        for ([x, y], [a, b, c]) in [([-2.0, 0.5], [1.0, 0.5, 2.0]), ([1.0, -1.0], [0.3, 1.4, 0.6])] {
            let corner = |k: usize| [x + a * (k & 1) as f64, y + b * (k >> 1 & 1) as f64, c * (k >> 2) as f64];
            for face in [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]] {
                quads.push(face.map(corner));
            }
        }
        let grey = Material { name: "grey".to_owned(), reflectance: vec![0.5], exitance: vec![1.0] };
        let faces = quads.iter().zip(0..).map(|(corners, face)| (Polygon::new(corners).unwrap(), 0, face)).collect();
        Scene::new(1, vec![grey], faces, Sides::Front).unwrap()
    }

    /// A scene's hierarchy, what of it is exposed, and what it emits.
    fn shining(scene: &Scene) -> (Hierarchy, Exposure, Radiosity) {
        let hierarchy = Hierarchy::new(scene);
        let visibility = build(Backend::BruteForce, &OccluderMesh::of_scene(scene)).unwrap();
        let mut exposure = Exposure::default();
        exposure.grow(scene, &hierarchy, &Rays::new(&*visibility, scene), 0, &|| false);
        let radiosity = Radiosity::emitted(scene, &hierarchy, &exposure);
        (hierarchy, exposure, radiosity)
    }

    fn is_below(hierarchy: &Hierarchy, mut node: NodeId, cluster: NodeId) -> bool {
        while node != cluster {
            let Some(parent) = hierarchy.parent(node) else { return false };
            node = parent;
        }
        true
    }

    #[test]
    fn what_clusters_show_and_gather_does_not_hang_on_what_was_there_before() {
        let (hierarchy, exposure, radiosity) = shining(&boxes());
        let mut again = radiosity.clone();
        assert_eq!(again.without_lobes(&hierarchy, &exposure, || 7), 7);
        assert_eq!(again, radiosity);

        let links = LinkSet::unrefined(hierarchy.len());
        let mut used = Irradiance { values: vec![3.0; hierarchy.len()], lobes: vec![Lobes::default(); 1] };
        used.lobes[0].add(1.0, DVec3::Z);
        gather_into(&mut used, &hierarchy, &links, &exposure, &radiosity);
        let clusters = hierarchy.cluster_count();
        assert!(used.values[clusters..].iter().all(|&h| h == 0.0) && used.lobes.iter().all(|lobes| *lobes == Lobes::default()));
        assert_eq!((used.values.len(), used.lobes.len()), (hierarchy.len(), clusters));
    }

    #[test]
    fn all_power_of_a_link_to_a_cluster_arrives_at_its_exposed_faces() {
        let scene = boxes();
        let (hierarchy, exposure, radiosity) = shining(&scene);

        let (mut checked, mut clear) = (0, 0);
        for receiver in hierarchy.ids().filter(|&node| hierarchy.is_cluster(node)) {
            for source in (0..scene.surfaces().len() as u32).map(|surface| hierarchy.node_of(SurfaceId(surface))) {
                let link = Link { form_factor: 0.25, source, transmittance: 0.5, seen: 0.5 };
                let links = LinkSet::new(hierarchy.len(), &[(receiver, link)], Vec::new());
                let arrived = push(&hierarchy, gather(&hierarchy, &links, &exposure, &radiosity), 1);
                let exposed = |leaf: NodeId| hierarchy.area(leaf) * exposure.of(leaf);
                let leaves = hierarchy.ids().filter(|&node| hierarchy.is_leaf(node));
                let power: f64 = leaves.map(|leaf| exposed(leaf) * arrived[leaf.index()]).sum();

                // A cluster that shows a source little of itself takes less.
                let mut lobe = Lobes::default();
                lobe.add(1.0, hierarchy.direction(receiver, source));
                let below = hierarchy.ids().filter(|&node| hierarchy.is_leaf(node) && is_below(&hierarchy, node, receiver));
                let (shown, all) = below.fold((0.0, 0.0), |(shown, all), leaf| {
                    (shown + exposed(leaf) * lobe.at(hierarchy.normal(leaf)), all + exposed(leaf))
                });
                let expected = hierarchy.area(receiver) * 0.125 * radiosity.of(source)[0] * (shown / (0.1 * all)).min(1.0);
                assert!(
                    (power - expected).abs() <= 1e-12 * expected.abs(),
                    "{receiver:?} from {source:?}: {power}, not {expected}"
                );
                clear += usize::from(shown > 0.1 * all);
                checked += 1;
            }
        }
        assert!(checked > 100 && clear > checked / 2, "{clear} of {checked}");
    }
}
