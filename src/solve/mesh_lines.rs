//! The lines that elements of a lit mesh follow.

use super::solution::Solution;
use crate::discontinuities::{self, Discontinuities};
use crate::error::ErrorNorm;
use crate::hierarchy::NodeId;
use crate::progress::Stop;
use crate::scene::SurfaceId;

/// The lines that elements of indirect light follow: where surfaces touch, and outlines of what stands close. And those that elements of all light follow,
/// if there are lights that are no surfaces: the borders of their shadows as well, but for those that change what is reflected by less than `error` of
/// its size in the norm of the options.
pub(super) fn find(solution: &Solution, error: f64, stop: Stop<'_>) -> (Discontinuities, Option<Discontinuities>) {
    let scene = &solution.scene;
    if scene.lights().is_empty() {
        return (discontinuities::of_shape(scene, stop), None);
    }
    let tolerated = error * size_of_light(solution, solution.options.norm.into());
    let tolerance = |surface: SurfaceId| {
        let reflectance = scene.material_of(surface).reflectance.iter().copied().fold(0.0, f64::max);
        if reflectance > 0.0 { tolerated / reflectance } else { f64::INFINITY }
    };
    let [shape, with_lights] = discontinuities::of_shape_and_lights(scene, &tolerance, stop);
    (shape, Some(with_lights))
}

/// The reflected radiosity, in its brightest channel in W/m^2, by which a norm tells errors: by energy the root mean square over all area, else the
/// median over what is lit; by the solver's elements.
fn size_of_light(solution: &Solution, norm: ErrorNorm) -> f64 {
    let Solution { scene, hierarchy, radiosity, .. } = solution;
    let of_leaf = |leaf: NodeId| {
        let exitance = &scene.material_of(hierarchy.surface_of(leaf)?).exitance;
        let reflected = radiosity.of(leaf).iter().zip(exitance).map(|(b, e)| b - e).fold(0.0, f64::max);
        Some([reflected, hierarchy.area(leaf)])
    };
    let mut leaves: Vec<[f64; 2]> = hierarchy.leaves_in_order().into_iter().filter_map(of_leaf).collect();
    if norm == ErrorNorm::Energy {
        let sum = |of: &dyn Fn(&[f64; 2]) -> f64| leaves.iter().map(of).sum::<f64>();
        return (sum(&|[b, area]| b * b * area) / sum(&|[_, area]| *area)).sqrt();
    }
    leaves.retain(|[b, _]| *b > 0.0);
    leaves.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let half = 0.5 * leaves.iter().map(|[_, area]| area).sum::<f64>();
    let mut below = 0.0;
    let is_median = |[_, area]: &&[f64; 2]| {
        below += area;
        below >= half
    };
    leaves.iter().find(is_median).map_or(0.0, |[b, _]| *b)
}
