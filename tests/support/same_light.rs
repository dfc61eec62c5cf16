//! Two scenes that should be the same: areas by material, and light at points.

use patchlight::pipeline;
use patchlight::progress::Silent;
use patchlight::scene::{Scene, Surface, SurfacePoint};
use patchlight::solve::{RunOptions, SolveOptions};

/// Coordinates up to 8 m are rounded to floats of 24 bits, so no vertex is farther off than this, in metres.
const OFF: f64 = 1.8 / (1 << 22) as f64;

/// Area in m^2 by material, and the length of all edges, in metres.
fn areas(scene: &Scene) -> Vec<(String, f64, f64)> {
    let mut areas: Vec<(String, f64, f64)> = scene.materials().iter().map(|material| (material.name.clone(), 0.0, 0.0)).collect();
    for surface in scene.surfaces() {
        let corners: Vec<[f64; 3]> = surface.polygon.vertices().collect();
        let length = |a: [f64; 3], b: [f64; 3]| (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt();
        let of_material = &mut areas[surface.material as usize];
        of_material.1 += surface.polygon.area();
        of_material.2 += (0..corners.len()).map(|k| length(corners[k], corners[(k + 1) % corners.len()])).sum::<f64>();
    }
    areas.retain(|(_, area, _)| *area > 0.0);
    areas.sort_by(|a, b| a.0.cmp(&b.0));
    areas
}

/// Every material has the same area in both, to what rounding of coordinates makes.
pub fn assert_same_areas(what: &str, scene: &Scene, expected: &Scene) {
    let (found, expected) = (areas(scene), areas(expected));
    assert_eq!(found.len(), expected.len(), "{what}");
    for ((name, area, _), (expected, of_expected, edges)) in found.into_iter().zip(expected) {
        assert!(name == expected && (area - of_expected).abs() <= edges * OFF, "{what}: {name} {area}, {expected} {of_expected}");
    }
}

/// The same radiosities in the middles of surfaces, by as much as both claim to be off.
pub fn assert_same_light(scene: &Scene, expected: &Scene) {
    let point = |surface: &Surface| SurfacePoint { position: surface.polygon.centroid(), normal: surface.polygon.normal() };
    let points: Vec<SurfacePoint> = expected.surfaces().iter().map(point).collect();
    let options = SolveOptions { error: 0.05, ..SolveOptions::default() };
    let values = |scene: &Scene| {
        let (lit, report) = pipeline::solve(scene.clone(), &options, &RunOptions::default(), &Silent).unwrap();
        (lit.values_at(&points, &Silent).unwrap(), report.error.estimate)
    };
    let ((one, claim_of_one), (other, claim_of_other)) = (values(expected), values(scene));
    assert_eq!(one.missed, other.missed);
    let claim = claim_of_one.hypot(claim_of_other);

    // Both norms are root mean squares over area; this is that of the differences, relative to light there or to the median.
    let both = || one.radiosity.chunks(3).zip(other.radiosity.chunks(3)).zip(expected.surfaces());
    let reflected = |values: &[f32], surface: &Surface| -> Vec<f64> {
        let exitance = &expected.materials()[surface.material as usize].exitance;
        values.iter().zip(exitance).map(|(&b, e)| f64::from(b) - e).collect()
    };
    let length = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
    let mut light: Vec<f64> =
        both().map(|((one, _), surface)| length(&reflected(one, surface))).filter(|light| light.is_finite()).collect();
    light.sort_by(f64::total_cmp);
    let median = light[light.len() / 2];
    let (mut sum, mut area) = (0.0, 0.0);
    for ((one, other), surface) in both().filter(|((one, _), _)| !one[0].is_nan()) {
        let (one, other) = (reflected(one, surface), reflected(other, surface));
        let off: Vec<f64> = one.iter().zip(&other).map(|(a, b)| a - b).collect();
        sum += surface.polygon.area() * (length(&off) / length(&one).max(median)).powi(2);
        area += surface.polygon.area();
    }
    let off = (sum / area).sqrt();
    assert!(off <= claim, "{off} off, claimed {claim}");
}
