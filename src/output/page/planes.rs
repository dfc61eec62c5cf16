//! Measuring planes as a page has them.

use serde_json::{Value, json};

use crate::output::MeasuredPlane;
use crate::scene::Scene;

/// What a page tells of planes, and by sensor what they show, plane after plane; not a number where nothing was measured.
pub(super) fn told(planes: &[MeasuredPlane], scene: &Scene) -> (Value, Vec<f32>) {
    let mut values = Vec::new();
    let told = planes.iter().map(|measured| {
        let shown = measured.shown(scene);
        values.extend_from_slice(&shown.values.lux);
        let summary = shown.summary.map(|summary| {
            let factor = |value: f64| shown.daylight_factor(value, scene);
            json!({
                "count": summary.count,
                "mean": summary.mean,
                "standard_error": summary.standard_error,
                "minimum": summary.minimum,
                "maximum": summary.maximum,
                "uniformity": summary.uniformity(),
                "daylight_factor": factor(summary.mean).zip(factor(summary.minimum)).map(|(mean, minimum)| [mean, minimum]),
            })
        });
        let MeasuredPlane { name, plane, .. } = measured;
        json!({
            "name": name,
            "origin": plane.origin,
            "edges": plane.edges,
            "counts": plane.counts,
            "quantity": shown.quantity.name(),
            "unit": shown.quantity.unit(),
            "outdoors": shown.outdoors,
            "summary": summary,
        })
    });
    (Value::Array(told.collect()), values)
}
