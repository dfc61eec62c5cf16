//! Light at the vertices of faces: the mean over the part of the face that is nearest to each.
//!
//! A point at the vertex itself lies on an edge, often in a corner where walls meet, and says nothing of the face. The part of a face around a vertex is the
//! quadrangle of the vertex, the middles of its two edges and the face's centroid, or the same shrunk towards the vertex. These parts make up the face.

use glam::DVec3;

use super::options::{BakeError, BakeOptions};
use crate::geometry::Facet;
use crate::scene::{Scene, SurfaceId};

/// Points along each direction of a part.
const ALONG: usize = 4;

/// Radiosities at the vertices of surfaces.
#[derive(Clone, Debug, PartialEq)]
pub struct VertexLight {
    /// The numbers of the surfaces, in their order.
    pub surfaces: Vec<u32>,
    /// By surface, vertex and channel, in W/m^2: the mean over the surface's part around each vertex.
    pub radiosity: Vec<f32>,
    /// Points that were gathered.
    pub points: u64,
    /// Vertices around which something stands on the surface: these have the mean of its other vertices, or what it emits.
    pub hidden: u64,
}

impl VertexLight {
    /// Points that are gathered at most for the vertices of a scene.
    pub fn most_points(scene: &Scene) -> u64 {
        let vertices: usize = scene.surfaces().iter().map(|surface| surface.polygon.facet().vertices.len()).sum();
        (vertices * ALONG * ALONG) as u64
    }
}

/// A point of a part with what it weighs there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Weighted {
    pub point: DVec3,
    pub weight: f64,
}

/// The surfaces whose vertices are baked.
pub(crate) fn surfaces_of(scene: &Scene, options: &BakeOptions) -> Result<Vec<SurfaceId>, BakeError> {
    options.validate()?;
    let chosen = options.chosen(scene)?;
    Ok((0..).zip(chosen).filter(|(_, chosen)| *chosen).map(|(number, _)| SurfaceId(number)).collect())
}

/// Points of the part of a face around a vertex, no farther along an edge than `within` metres; none lies on an edge.
pub(crate) fn points_around(facet: &Facet<'_>, vertex: usize, within: f64) -> Vec<Weighted> {
    let count = facet.vertices.len();
    let corner = facet.vertices[vertex];
    let next = 0.5 * (facet.vertices[(vertex + 1) % count] - corner);
    let before = 0.5 * (facet.vertices[(vertex + count - 1) % count] - corner);
    let across = facet.centroid - corner;
    let shrunk = (within / next.length().max(before.length())).min(1.0);
    let along = |k: usize| (k as f64 + 0.5) / ALONG as f64;
    let point = |k: usize| {
        // Bilinear over the quadrangle; the weight is the area that a step covers.
        let (s, t) = (along(k % ALONG), along(k / ALONG));
        let twist = across - next - before;
        let area = (next + t * twist).cross(before + s * twist).length();
        Weighted { point: corner + shrunk * (s * next + t * before + s * t * twist), weight: area }
    };
    (0..ALONG * ALONG).map(point).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Polygon;

    #[test]
    fn parts_make_up_the_face_and_have_its_centroid() {
        let polygon =
            Polygon::new(&[[0.0, 0.0, 1.0], [2.0, 0.0, 1.0], [2.5, 1.0, 1.0], [1.0, 2.0, 1.0], [-0.5, 1.0, 1.0]]).unwrap();
        let facet = polygon.facet();
        let all: Vec<Weighted> = (0..5).flat_map(|vertex| points_around(&facet, vertex, f64::INFINITY)).collect();
        let area: f64 = all.iter().map(|of| of.weight / 16.0).sum();
        assert!((area / facet.area - 1.0).abs() < 1e-12, "{area} {}", facet.area);
        let mean = all.iter().map(|of| of.weight / 16.0 * of.point).sum::<DVec3>() / area;
        assert!(mean.distance(facet.centroid) < 0.02, "{mean} {}", facet.centroid);
        assert!(all.iter().all(|of| facet.contains(of.point)));

        // Shrunk, they lie close to the vertex.
        let close = points_around(&facet, 1, 0.1);
        assert!(close.iter().all(|of| of.point.distance(DVec3::new(2.0, 0.0, 1.0)) < 0.3 && facet.contains(of.point)));
    }
}
