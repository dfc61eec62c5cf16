//! Gathering: light travels over all links once.

use rayon::prelude::*;

use super::{Exposure, Radiosity};
use crate::geometry::Lobes;
use crate::hierarchy::{Hierarchy, NodeId};
use crate::links::{Link, LinkSet};

/// What arrives at every node over its own links, by channel, over the exposed part of the node.
pub(crate) struct Irradiance {
    /// H of each surface and element, in W/m^2; clusters have none.
    pub(super) values: Vec<f64>,
    /// Of each cluster: H of a face by its normal.
    pub(super) lobes: Vec<Lobes>,
}

/// What every node gathers over its own links from the radiosities as they stand, in parallel over receivers:
/// `H_r = sum over links of F_rs B_s`.
///
/// A cluster gathers light with the directions it comes from. Each link's power is spread over the faces of the cluster as they look to the
/// source, so that all of it arrives.
pub(crate) fn gather(hierarchy: &Hierarchy, links: &LinkSet, exposure: &Exposure, radiosity: &Radiosity) -> Irradiance {
    let channels = radiosity.channels();
    let clusters = hierarchy.cluster_count();
    let mut values = vec![0.0; channels * hierarchy.len()];
    values.par_chunks_mut(channels).with_min_len(256).enumerate().skip(clusters).for_each(|(node, irradiance)| {
        let node = NodeId(node as u32);
        gather_polygon(hierarchy, node, links.of(node), exposure, radiosity, irradiance);
    });
    let mut lobes = vec![Lobes::default(); channels * clusters];
    lobes.par_chunks_mut(channels).with_min_len(16).enumerate().for_each(|(node, lobes)| {
        let node = NodeId(node as u32);
        gather_cluster(hierarchy, node, links.of(node), radiosity, lobes);
    });
    Irradiance { values, lobes }
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
    let mut arriving = vec![0.0; lobes.len()];
    for link in links {
        let direction = hierarchy.direction(receiver, link.source);
        let Some(exposed) = radiosity.exposed_area(receiver, direction) else { return };
        let spread = hierarchy.area(receiver) / exposed;
        arriving.fill(0.0);
        radiosity.add_shown(hierarchy, receiver, link.source, link.occluded_form_factor() * spread, &mut arriving);
        lobes.iter_mut().zip(&arriving).for_each(|(lobes, &h)| lobes.add(h, direction));
    }
}
