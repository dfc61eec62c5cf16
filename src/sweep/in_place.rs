//! A sweep in place (Lischinski 1994, section 5.1.3): gathering and push-pull in one descent, so that each node already gathers from
//! what the nodes before it have just reflected (Gauss-Seidel). Needs fewer sweeps than Jacobi; runs on one thread, because order counts.

use super::{Change, Emission, Exposure, Radiosity, Reflection};
use crate::hierarchy::{Hierarchy, NodeId};
use crate::links::LinkSet;
use crate::scene::Scene;

/// One sweep.
pub(crate) fn sweep_in_place(
    scene: &Scene,
    hierarchy: &Hierarchy,
    links: &LinkSet,
    exposure: &Exposure,
    radiosity: &mut Radiosity,
) -> Change {
    let channels = radiosity.channels();
    let mut sweep = InPlace {
        hierarchy,
        links,
        exposure,
        reflection: Reflection { scene, emission: Emission::Materials },
        radiosity,
        change: Change::default(),
    };
    sweep.descend(NodeId::ROOT, &vec![0.0; channels]);
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
    /// Gathers at `node`, hands everything down, and sets the radiosity from what comes back. The tree is a few dozen levels deep.
    fn descend(&mut self, node: NodeId, from_above: &[f64]) {
        let mut irradiance = vec![0.0; from_above.len()];
        for link in self.links.of(node) {
            let form_factor = link.occluded_form_factor();
            for (h, b) in irradiance.iter_mut().zip(self.radiosity.of(link.source)) {
                *h += form_factor * b;
            }
        }

        self.exposure.concentrate(node, &mut irradiance);
        irradiance.iter_mut().zip(from_above).for_each(|(h, above)| *h += above);

        if self.hierarchy.is_leaf(node) {
            let surface = self.hierarchy.node(node).surface;
            self.reflection.reflect(node, surface, &irradiance, self.radiosity.of_mut(node), &mut self.change);
        } else {
            let mut new = vec![0.0; irradiance.len()];
            let mut area = 0.0;
            for child in self.hierarchy.children(node) {
                self.descend(child, &irradiance);
                let weight = self.hierarchy.area(child) * self.exposure.of(child);
                area += weight;
                for (new, b) in new.iter_mut().zip(self.radiosity.of(child)) {
                    *new += weight * b;
                }
            }
            new.iter_mut().for_each(|new| *new = if area > 0.0 { *new / area } else { 0.0 });
            self.radiosity.of_mut(node).copy_from_slice(&new);
        }
    }
}
