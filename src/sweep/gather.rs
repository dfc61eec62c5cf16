//! Gathering: light travels over all links once.

use rayon::prelude::*;

use super::{Exposure, Radiosity};
use crate::hierarchy::NodeId;
use crate::links::LinkSet;

/// The irradiance that every node gathers over its own links from the radiosities as they stand, in parallel over receivers:
/// `H_r = sum over links of F_rs B_s`, by channel, over the exposed part of the node.
pub(crate) fn gather(links: &LinkSet, exposure: &Exposure, radiosity: &Radiosity) -> Vec<f64> {
    let channels = radiosity.channels();
    let mut irradiance = vec![0.0; radiosity.values().len()];
    irradiance.par_chunks_mut(channels).with_min_len(256).enumerate().for_each(|(node, irradiance)| {
        let node = NodeId(node as u32);
        for link in links.of(node) {
            let form_factor = link.occluded_form_factor();
            for (h, b) in irradiance.iter_mut().zip(radiosity.of(link.source)) {
                *h += form_factor * b;
            }
        }
        exposure.concentrate(node, irradiance);
    });
    irradiance
}
