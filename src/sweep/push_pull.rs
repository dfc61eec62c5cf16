//! Push-pull: irradiance goes down to the leaves, is reflected there, and radiosity comes up.

use rayon::prelude::*;

use super::push::push_in_place;
use super::reflection::Reflection;
use super::{Change, Exposure, Irradiance, PARALLEL, Radiosity};
use crate::hierarchy::{Hierarchy, NodeId};

/// Pushes the gathered `irradiance` of every node, which is spent, down to the leaves, reflects it there, and pulls radiosities up as means.
pub(crate) fn push_pull(
    reflection: &Reflection<'_>,
    hierarchy: &Hierarchy,
    exposure: &Exposure,
    irradiance: &mut Irradiance,
    radiosity: &mut Radiosity,
) -> Change {
    let channels = radiosity.channels();
    push_in_place(hierarchy, irradiance, channels);

    // Reflect at the leaves, and pull.
    let nodes =
        irradiance.values.par_chunks_mut(channels).zip(radiosity.values_mut().par_chunks_mut(channels)).with_min_len(PARALLEL);
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
