//! A sweep in place (Lischinski 1994, section 5.1.3): gather and push-pull in one descent. Each node gathers from radiosities that
//! the nodes before it have just changed (Gauss-Seidel). It takes fewer sweeps than Jacobi, but runs on one thread, because the
//! order counts.

use super::gather::{gather_cluster, gather_polygon};
use super::reflection::Reflection;
use super::{Change, Exposure, Radiosity};
use crate::geometry::Lobes;
use crate::hierarchy::{Hierarchy, NodeId};
use crate::links::LinkSet;
use crate::scene::SurfaceId;

/// One sweep.
pub(crate) fn sweep_in_place(
    reflection: Reflection<'_>,
    hierarchy: &Hierarchy,
    links: &LinkSet,
    exposure: &Exposure,
    radiosity: &mut Radiosity,
) -> Change {
    let channels = radiosity.channels();
    let mut sweep = InPlace { hierarchy, links, exposure, reflection, radiosity, change: Change::default() };
    sweep.descend_cluster(NodeId::ROOT, &vec![Lobes::default(); channels]);
    sweep.change
}

struct InPlace<'a> {
    hierarchy: &'a Hierarchy,
    links: &'a LinkSet,
    exposure: &'a Exposure,
    reflection: Reflection<'a>,
    radiosity: &'a mut Radiosity,
    change: Change,
}

impl InPlace<'_> {
    /// Gathers at a cluster, descends to its children, and pulls their radiosities. The tree is some dozens of levels deep.
    fn descend_cluster(&mut self, cluster: NodeId, from_above: &[Lobes]) {
        let mut lobes = from_above.to_vec();
        gather_cluster(self.hierarchy, cluster, self.links.of(cluster), self.radiosity, &mut lobes);
        for child in self.hierarchy.children(cluster) {
            if self.hierarchy.is_cluster(child) {
                self.descend_cluster(child, &lobes);
            } else {
                let normal = self.hierarchy.normal(child);
                let irradiance: Vec<f64> = lobes.iter().map(|lobes| lobes.at(normal)).collect();
                self.descend(child, &irradiance);
            }
        }
        self.radiosity.pull_level(self.hierarchy, self.exposure, cluster.index()..cluster.index() + 1);
    }

    /// The same at a surface or element. A leaf reflects.
    fn descend(&mut self, node: NodeId, from_above: &[f64]) {
        let mut irradiance = vec![0.0; from_above.len()];
        gather_polygon(self.hierarchy, node, self.links.of(node), self.exposure, self.radiosity, &mut irradiance);
        irradiance.iter_mut().zip(from_above).for_each(|(h, above)| *h += above);

        if self.hierarchy.is_leaf(node) {
            let surface = SurfaceId(self.hierarchy.node(node).surface);
            let change = self.reflection.reflect(node, surface, &mut irradiance, self.radiosity.of_mut(node));
            self.change = self.change.and(change);
        } else {
            self.hierarchy.children(node).for_each(|child| self.descend(child, &irradiance));
            self.radiosity.pull_level(self.hierarchy, self.exposure, node.index()..node.index() + 1);
        }
    }
}
