//! A picture of a surface and its discontinuities.

use std::fmt::Write;

use glam::DVec3;

#[cfg(doc)]
use super::segments::Degree;
use super::segments::Discontinuities;
use crate::geometry::Frame;
use crate::scene::{Scene, SurfaceId};

/// The longer side of a picture, in pixels.
const SIZE: f64 = 1000.0;

/// A surface seen from its front as an SVG: in the colours of [`Degree::colour`], and the fainter the less they can change.
pub fn svg(scene: &Scene, discontinuities: &Discontinuities, surface: SurfaceId) -> String {
    let facet = scene.surface(surface).polygon.facet();
    let frame = Frame::around(facet.normal);
    let flat = |point: DVec3| [frame.tangent.dot(point - facet.centroid), -frame.bitangent.dot(point - facet.centroid)];
    let outline: Vec<[f64; 2]> = facet.vertices.iter().map(|&vertex| flat(vertex)).collect();
    let range = |axis: usize| outline.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], p| [l.min(p[axis]), h.max(p[axis])]);
    let (x, y) = (range(0), range(1));
    let scale = SIZE / f64::max(x[1] - x[0], y[1] - y[0]);
    let place = |[px, py]: [f64; 2]| [(px - x[0]) * scale, (py - y[0]) * scale];

    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"-5 -5 {:.1} {:.1}\">\n<polygon fill=\"white\" stroke=\"grey\" points=\"",
        (x[1] - x[0]) * scale + 10.0,
        (y[1] - y[0]) * scale + 10.0
    );
    let point = |[x, y]: [f64; 2]| format!("{x:.2},{y:.2} ");
    text.extend(outline.iter().map(|&corner| point(place(corner))));
    text.push_str("\"/>\n");

    let segments = discontinuities.of(surface);
    let most = segments.iter().map(|segment| segment.change).filter(|change| change.is_finite()).fold(0.0, f64::max);
    for segment in segments.iter().rev() {
        let [r, g, b] = segment.degree.colour();
        let strength = if segment.change < most { (segment.change / most).powf(0.25).max(0.1) } else { 1.0 };
        let [[x1, y1], [x2, y2]] = segment.ends.map(|end| place(flat(end)));
        // Writing to a string does not fail.
        let _ = writeln!(
            text,
            "<line x1=\"{x1:.2}\" y1=\"{y1:.2}\" x2=\"{x2:.2}\" y2=\"{y2:.2}\" stroke=\"rgb({r},{g},{b})\" stroke-opacity=\"{strength:.2}\"/>"
        );
    }
    text.push_str("</svg>\n");
    text
}
