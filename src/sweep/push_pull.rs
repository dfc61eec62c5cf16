//! Push-pull: irradiance goes down to the leaves, radiosity comes up.

use rayon::prelude::*;

use super::{Change, Closure, Exposure, Irradiance, PARALLEL, Radiosity, Reflection};
use crate::hierarchy::{Hierarchy, NodeId};
use crate::scene::Scene;

/// Hands the gathered `irradiance` of every node down to the leaves, reflects it there, and takes means upward.
pub(crate) fn push_pull(
    scene: &Scene,
    hierarchy: &Hierarchy,
    exposure: &Exposure,
    closure: Option<&Closure>,
    irradiance: Irradiance,
    radiosity: &mut Radiosity,
) -> Change {
    let channels = radiosity.channels();
    let mut values = push(hierarchy, irradiance, channels);

    // Reflect at the leaves, and pull.
    let reflection = Reflection { scene, closure };
    let nodes = values.par_chunks_mut(channels).zip(radiosity.values_mut().par_chunks_mut(channels)).with_min_len(PARALLEL);
    let reflect = |(index, (irradiance, radiosity)): (usize, (&mut [f64], &mut [f64]))| {
        let node = NodeId(index as u32);
        match hierarchy.surface_of(node).filter(|_| hierarchy.is_leaf(node)) {
            Some(surface) => reflection.reflect(node, surface, irradiance, radiosity),
            None => Change::default(),
        }
    };
    let change = nodes.enumerate().map(reflect).reduce(Change::default, Change::and);
    radiosity.pull(hierarchy, exposure);
    change
}

/// The irradiance of every surface and element with all that arrives above it, by channel, node after node: what a node gathers arrives at
/// all its children, from a cluster by the way their faces look.
pub(crate) fn push(hierarchy: &Hierarchy, irradiance: Irradiance, channels: usize) -> Vec<f64> {
    let Irradiance { mut values, mut lobes } = irradiance;
    for level in hierarchy.levels().into_iter().skip(1) {
        let above = |index: usize| hierarchy.node(NodeId((level.start + index) as u32)).parent;
        if level.start < hierarchy.cluster_count() {
            let (from, to) = lobes.split_at_mut(level.start * channels);
            let to = &mut to[..level.len() * channels];
            to.par_chunks_mut(channels).with_min_len(PARALLEL).enumerate().for_each(|(index, own)| {
                let from = &from[above(index).index() * channels..];
                own.iter_mut().zip(from).for_each(|(own, from)| *own += *from);
            });
        } else {
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
    values
}
