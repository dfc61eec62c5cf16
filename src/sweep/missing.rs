//! Which part of a surface's surroundings its links represent, and how much energy is incorrect because it is not all of them.
//!
//! In a closed scene the form factors of all links of a surface add up to 1. They miss the pairs without a link, and may be off
//! either way by estimated form factors and visibilities (Holzschuch, Sillion, Drettakis 1994, section 3.2).

use super::{Exposure, Radiosity, gather, push};
use crate::hierarchy::{Hierarchy, NodeId};
use crate::links::LinkSet;
use crate::scene::{Scene, SurfaceId};

/// The sum F_p of the form factors of all links leaving each surface, by surface: the mean over its exposed part.
pub(crate) fn row_sums(scene: &Scene, hierarchy: &Hierarchy, links: &LinkSet, exposure: &Exposure) -> Vec<f64> {
    let by_node = push(hierarchy, gather(hierarchy, links, exposure, &Radiosity::ones(hierarchy, exposure)), 1);
    let mut sums = vec![0.0; scene.surfaces().len()];
    for leaf in hierarchy.ids().filter(|&node| hierarchy.is_leaf(node)) {
        let surface = SurfaceId(hierarchy.node(leaf).surface);
        let whole = exposed_area(hierarchy, exposure, hierarchy.node_of(surface));
        if whole > 0.0 {
            sums[surface.index()] += by_node[leaf.index()] * exposed_area(hierarchy, exposure, leaf) / whole;
        }
    }
    sums
}

/// Equations 1 and 2 of the paper: the incorrect energy, `sum of |1 - F_p| B_p A_p`, and all energy, `sum of B_p A_p`, in W, all
/// channels added.
pub(crate) fn incorrect_energy(
    scene: &Scene,
    hierarchy: &Hierarchy,
    exposure: &Exposure,
    radiosity: &Radiosity,
    row_sums: &[f64],
) -> (f64, f64) {
    let (mut incorrect, mut total) = (0.0, 0.0);
    for (surface, sum) in surfaces(scene).zip(row_sums) {
        let node = hierarchy.node_of(surface);
        let power = exposed_area(hierarchy, exposure, node) * radiosity.of(node).iter().sum::<f64>();
        incorrect += (1.0 - sum).abs() * power;
        total += power;
    }
    (incorrect, total)
}

/// The ambient term: the irradiance of each surface, by channel, over the links that it misses.
///
/// Surface p misses the part `m_p = 1 - F_p` of its surroundings, but at most `dormant_form_factor`: light that leaves through
/// openings does not come back. Over that part it receives the same ambient radiosity a as all others: the mean over the surfaces,
/// weighted by w_p, the area times m_p, so that the power that leaves over missing links arrives over missing links. Ambient light
/// is reflected, too: `a = sum of w_p (B_p + rho_p m_p a)`, with weights that add up to 1, is solved for a.
pub(crate) fn estimate_ambient(
    scene: &Scene,
    hierarchy: &Hierarchy,
    exposure: &Exposure,
    radiosity: &Radiosity,
    row_sums: &[f64],
    dormant_form_factor: &dyn Fn(SurfaceId) -> f64,
) -> Vec<f64> {
    let channels = radiosity.channels();
    let missing: Vec<f64> =
        surfaces(scene).zip(row_sums).map(|(surface, sum)| (1.0 - sum).clamp(0.0, dormant_form_factor(surface))).collect();

    // Weights.
    let weight = |surface: SurfaceId| missing[surface.index()] * exposed_area(hierarchy, exposure, hierarchy.node_of(surface));
    let whole: f64 = surfaces(scene).map(weight).sum();
    if whole <= 0.0 {
        return vec![0.0; channels * missing.len()];
    }

    // The ambient radiosity by channel.
    let ambient: Vec<f64> = (0..channels)
        .map(|channel| {
            let seen: f64 =
                surfaces(scene).map(|surface| weight(surface) * radiosity.of(hierarchy.node_of(surface))[channel]).sum();
            let returned: f64 = surfaces(scene)
                .map(|surface| weight(surface) * missing[surface.index()] * scene.material_of(surface).reflectance[channel])
                .sum();
            seen / (whole - returned)
        })
        .collect();
    missing.iter().flat_map(|missing| ambient.iter().map(move |ambient| missing * ambient)).collect()
}

/// Adds to the radiosity of every leaf what its surface reflects of `irradiance`, given by surface and channel.
pub(crate) fn reflect_ambient(
    scene: &Scene,
    hierarchy: &Hierarchy,
    exposure: &Exposure,
    irradiance: &[f64],
    radiosity: &mut Radiosity,
) {
    let channels = radiosity.channels();
    for leaf in hierarchy.ids().filter(|&node| hierarchy.is_leaf(node)) {
        let Some(surface) = hierarchy.surface_of(leaf) else { continue };
        let reflectance = &scene.material_of(surface).reflectance;
        let arriving = &irradiance[surface.index() * channels..][..channels];
        for ((b, rho), h) in radiosity.of_mut(leaf).iter_mut().zip(reflectance).zip(arriving) {
            *b += rho * h;
        }
    }
    radiosity.pull(hierarchy, exposure);
}

fn surfaces(scene: &Scene) -> impl Iterator<Item = SurfaceId> {
    (0..scene.surfaces().len() as u32).map(SurfaceId)
}

fn exposed_area(hierarchy: &Hierarchy, exposure: &Exposure, node: NodeId) -> f64 {
    hierarchy.area(node) * exposure.of(node)
}
