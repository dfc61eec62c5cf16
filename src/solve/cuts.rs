//! Discontinuities of direct light as lines along which elements are cut.

use super::job::Job;
use super::scale::Scale;
use crate::discontinuities::{self, Degree, Source};
use crate::hierarchy::{Cut, Hierarchy};
use crate::paths::Illumination;
use crate::scene::SurfaceId;

/// Cuts elements along the discontinuities of what emitters send: contacts first, then jumps of the first derivative, then of the second (Lischinski 1994,
/// section 4.2).
///
/// Left out are those that change what a surface reflects by less, together, than the tolerance; see the table of options.
pub(super) fn cut_along_discontinuities(job: &Job<'_>, illumination: &Illumination, hierarchy: &mut Hierarchy) {
    let scene = job.scene;
    let brightest = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
    let material = |surface: SurfaceId| scene.material_of(surface);
    let ids = (0..scene.surfaces().len() as u32).map(SurfaceId);
    let sources: Vec<Source> = ids.map(|surface| Source { surface, radiosity: brightest(&material(surface).exitance) }).collect();

    // In irradiance; what reflects nothing tolerates all.
    let tolerated = job.options.links.discontinuity_tolerance.unwrap_or(job.options.error);
    let reflected = tolerated * Scale::of_illumination(illumination).radiosity;
    let tolerance = |surface: SurfaceId| {
        let reflectance = brightest(&material(surface).reflectance);
        if reflectance > 0.0 { reflected / reflectance } else { f64::INFINITY }
    };
    let found = discontinuities::find(scene, &sources, &tolerance, &job.stop());
    let cuts = |surface: SurfaceId| {
        let normal = scene.surface(surface).polygon.facet().normal;
        let rank = |degree: Degree| match degree {
            Degree::D0 => 0,
            Degree::D1 => 1,
            Degree::D2 => 2,
        };
        found.of(surface).iter().filter_map(|segment| Cut::new(segment.ends, normal, rank(segment.degree))).collect()
    };
    hierarchy.cut_along(cuts, scene.contact_tolerance());
}
