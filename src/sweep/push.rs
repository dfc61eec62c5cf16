//! Push: irradiance goes down to the leaves.

use rayon::prelude::*;

use super::{Irradiance, PARALLEL};
use crate::hierarchy::{Hierarchy, NodeId};

/// The push: the irradiance of every surface and element with all that the nodes above it gather, by node and channel. Irradiance
/// of a cluster arrives at its children by their normals.
pub(crate) fn push(hierarchy: &Hierarchy, mut irradiance: Irradiance, channels: usize) -> Vec<f64> {
    push_in_place(hierarchy, &mut irradiance, channels);
    irradiance.values
}

/// The same into the values themselves.
pub(super) fn push_in_place(hierarchy: &Hierarchy, irradiance: &mut Irradiance, channels: usize) {
    let Irradiance { values, lobes } = irradiance;
    for level in hierarchy.levels().into_iter().skip(1) {
        let above = |index: usize| hierarchy.node(NodeId((level.start + index) as u32)).parent;
        if level.start < hierarchy.cluster_count() {
            // From clusters to clusters, with directions.
            let (from, to) = lobes.split_at_mut(level.start * channels);
            let to = &mut to[..level.len() * channels];
            to.par_chunks_mut(channels).with_min_len(PARALLEL).enumerate().for_each(|(index, own)| {
                let from = &from[above(index).index() * channels..];
                own.iter_mut().zip(from).for_each(|(own, from)| *own += *from);
            });
        } else {
            // To surfaces and elements.
            let (from, to) = values.split_at_mut(level.start * channels);
            let to = &mut to[..level.len() * channels];
            to.par_chunks_mut(channels).with_min_len(PARALLEL).enumerate().for_each(|(index, own)| {
                let parent = above(index);
                let place = parent.index() * channels;
                if hierarchy.is_cluster(parent) {
                    let normal = hierarchy.normal(NodeId((level.start + index) as u32));
                    own.iter_mut().zip(&lobes[place..]).for_each(|(own, from)| *own += from.at(normal));
                } else {
                    own.iter_mut().zip(&from[place..]).for_each(|(own, from)| *own += from);
                }
            });
        }
    }
}
