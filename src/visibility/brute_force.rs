//! The reference: every triangle, in f64.

use glam::DVec3;

use super::{Hit, OccluderMesh, Ray, Segment, Visibility};

/// Tests every triangle.
pub(super) struct BruteForce {
    mesh: OccluderMesh,
}

impl BruteForce {
    pub(super) fn new(mesh: &OccluderMesh) -> Self {
        Self { mesh: mesh.clone() }
    }

    /// Where the line `origin + t direction` meets a triangle (Moeller and Trumbore 1997), `None` if it misses.
    fn meet(&self, triangle: usize, origin: DVec3, direction: DVec3) -> Option<f64> {
        let [a, b, c] = self.mesh.triangles[triangle].map(|vertex| DVec3::from(self.mesh.vertices[vertex as usize]));
        let (e1, e2) = (b - a, c - a);
        let p = direction.cross(e2);
        let determinant = e1.dot(p);
        if determinant == 0.0 {
            return None;
        }
        let s = (origin - a) / determinant;
        let u = s.dot(p);
        let q = s.cross(e1);
        let v = direction.dot(q);
        (u >= 0.0 && v >= 0.0 && u + v <= 1.0).then(|| e2.dot(q))
    }
}

impl Visibility for BruteForce {
    fn description(&self) -> String {
        "brute force".to_owned()
    }

    fn occluded(&self, segments: &[Segment], occluded: &mut [bool]) {
        for (segment, occluded) in segments.iter().zip(occluded) {
            let (from, to) = (DVec3::from(segment.from), DVec3::from(segment.to));
            *occluded = (0..self.mesh.triangles.len())
                .filter(|&k| self.mesh.planes[k] != segment.from_plane && self.mesh.planes[k] != segment.to_plane)
                .any(|k| self.meet(k, from, to - from).is_some_and(|t| t > 1e-9 && t < 1.0 - 1e-9));
        }
    }

    fn first_hits(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        for (ray, hit) in rays.iter().zip(hits) {
            let (origin, direction) = (DVec3::from(ray.origin), DVec3::from(ray.direction));
            *hit = (0..self.mesh.triangles.len())
                .filter(|&k| self.mesh.planes[k] != ray.origin_plane)
                .filter_map(|k| {
                    self.meet(k, origin, direction)
                        .filter(|&t| t > 1e-9)
                        .map(|t| Hit { surface: self.mesh.surfaces[k], distance: t })
                })
                .min_by(|a, b| a.distance.total_cmp(&b.distance));
        }
    }
}
