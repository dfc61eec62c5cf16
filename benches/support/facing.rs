//! Segments between triangles that face each other.

use patchlight::visibility::{OccluderMesh, Segment};

use crate::triangles::{Random, cross, dot, point_on, sub, unit};

fn normal(mesh: &OccluderMesh, triangle: usize) -> [f64; 3] {
    let [a, b, c] = mesh.triangles[triangle].map(|vertex| mesh.vertices[vertex as usize]);
    unit(cross(sub(b, a), sub(c, a)))
}

/// At least `count` segments in groups of `group`, each group between two triangles that see each other's front, were nothing
/// between them; some triangles may be seen from both sides.
pub fn facing_segments(mesh: &OccluderMesh, count: usize, group: usize, has_two_sides: impl Fn(usize) -> bool) -> Vec<Segment> {
    let mut random = Random(2);
    let mut segments = Vec::with_capacity(count);
    while segments.len() < count {
        let (receiver, source) = (random.below(mesh.triangles.len()), random.below(mesh.triangles.len()));
        let way = sub(point_on(mesh, source, &mut random), point_on(mesh, receiver, &mut random));
        let faces = |triangle: usize, way: [f64; 3]| has_two_sides(triangle) || dot(normal(mesh, triangle), way) > 0.0;
        if receiver != source && faces(receiver, way) && faces(source, way.map(|x| -x)) {
            segments.extend((0..group).map(|_| Segment {
                from: point_on(mesh, receiver, &mut random),
                to: point_on(mesh, source, &mut random),
                from_plane: mesh.planes[receiver],
                to_plane: mesh.planes[source],
            }));
        }
    }
    segments
}
