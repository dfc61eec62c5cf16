//! The reference: every triangle, in f64, in the coordinates of the scene.
//!
//! A segment passes through a triangle if the three volumes that it spans with the edges have the same sign (Pluecker coordinates).
//! Each is computed from its edge alone, and only its sign changes if the edge is taken in the other direction, so no segment slips
//! through between two triangles that share an edge. A volume no larger than rounding counts as 0, on the edge, so none slips
//! through where many meet at a vertex.

use glam::DVec3;

use super::{Hit, OccluderMesh, Ray, Segment, Visibility};

/// What rounding may add to a volume, as a part of the product of the three lengths: a cross and a dot product of sums, each
/// rounded.
const VOLUME_ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Tests every triangle: O(triangles) per query.
pub(super) struct BruteForce {
    mesh: OccluderMesh,
    /// The diagonal of the box around the mesh, and its centre.
    size: f64,
    centre: DVec3,
    tolerance: f64,
}

impl BruteForce {
    pub(super) fn new(mesh: &OccluderMesh) -> Self {
        let bounds = mesh.bounds();
        let centre = if bounds.is_empty() { DVec3::ZERO } else { bounds.centre() };
        Self { size: bounds.diagonal(), centre, tolerance: mesh.contact_tolerance(), mesh: mesh.clone() }
    }

    /// The distance of the triangle's plane from `from` as a part of the way to `to`, if the triangle blocks the segment.
    fn crossing(&self, triangle: usize, from: DVec3, to: DVec3) -> Option<f64> {
        // The ends must lie on different sides of the plane, neither of them in it.
        let [a, b, c] = self.mesh.triangles[triangle].map(|vertex| DVec3::from(self.mesh.vertices[vertex as usize]));
        let normal = (b - a).cross(c - a).try_normalize()?;
        let (from_height, to_height) = (normal.dot(from - a), normal.dot(to - a));
        let contact = from_height.abs() <= self.tolerance || to_height.abs() <= self.tolerance;
        if contact || (from_height > 0.0) == (to_height > 0.0) {
            return None;
        }

        // The segment must pass all edges on the same side.
        let (a, b, c, direction) = (a - from, b - from, c - from, to - from);
        let volume = |p: DVec3, q: DVec3| {
            let (edge, sum) = (q - p, q + p);
            let volume = edge.cross(sum).dot(direction);
            let rounding = VOLUME_ROUNDING * edge.length() * sum.length() * direction.length();
            if volume.abs() <= rounding { 0.0 } else { volume }
        };
        let (u, v, w) = (volume(a, b), volume(b, c), volume(c, a));
        let inside = (u >= 0.0 && v >= 0.0 && w >= 0.0) || (u <= 0.0 && v <= 0.0 && w <= 0.0);
        inside.then(|| from_height / (from_height - to_height))
    }

    fn is_occluded(&self, segment: &Segment) -> bool {
        let (from, to) = (DVec3::from(segment.from), DVec3::from(segment.to));
        if !(to - from).is_finite() || from == to {
            return true;
        }
        (0..self.mesh.triangles.len())
            .filter(|&k| self.mesh.planes[k] != segment.from_plane && self.mesh.planes[k] != segment.to_plane)
            .any(|k| self.crossing(k, from, to).is_some())
    }

    fn first_hit(&self, ray: &Ray) -> Option<Hit> {
        // A segment that ends beyond the mesh.
        let (origin, direction) = (DVec3::from(ray.origin), DVec3::from(ray.direction));
        let largest = direction.abs().max_element();
        if !origin.is_finite() || !direction.is_finite() || largest == 0.0 {
            return None;
        }
        let unit = (direction / largest).normalize();
        let reach = 2.0 * (self.size + origin.distance(self.centre));
        let length = largest * (direction / largest).length();

        (0..self.mesh.triangles.len())
            .filter(|&k| self.mesh.planes[k] != ray.origin_plane)
            .filter_map(|k| {
                let part = self.crossing(k, origin, origin + reach * unit)?;
                Some(Hit { surface: self.mesh.surfaces[k], distance: part * reach / length })
            })
            .min_by(|a, b| a.distance.total_cmp(&b.distance))
    }
}

impl Visibility for BruteForce {
    fn description(&self) -> String {
        "brute force".to_owned()
    }

    fn occluded(&self, segments: &[Segment], occluded: &mut [bool]) {
        for (segment, occluded) in segments.iter().zip(occluded) {
            *occluded = self.is_occluded(segment);
        }
    }

    fn first_hits(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        for (ray, hit) in rays.iter().zip(hits) {
            *hit = self.first_hit(ray);
        }
    }
}
