//! A borrowed planar convex polygon: what form factors and sampling look at.

use glam::DVec3;

/// A planar convex polygon seen from its front, borrowed from a [`Polygon`](super::Polygon) or from the hierarchy.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Facet<'a> {
    /// Counter-clockwise seen from the front; three or more.
    pub vertices: &'a [DVec3],
    /// Unit normal of the front.
    pub normal: DVec3,
    /// In m^2, positive.
    pub area: f64,
    /// The centroid of the area.
    pub centroid: DVec3,
    /// Distance from the centroid to the farthest vertex.
    pub radius: f64,
}

impl Facet<'_> {
    /// Signed height of `point` above the plane, positive in front.
    pub fn height(&self, point: DVec3) -> f64 {
        self.normal.dot(point - self.vertices[0])
    }

    /// The point of the polygon at `(u, v)` in the unit square; uniform `(u, v)` give points uniform by area.
    ///
    /// The polygon is a fan of triangles around vertex 0; `u` picks the triangle by area and is reused inside it.
    pub fn point_at(&self, u: f64, v: f64) -> DVec3 {
        let origin = self.vertices[0];
        let twice_area = |k: usize| (self.vertices[k] - origin).cross(self.vertices[k + 1] - origin).dot(self.normal);

        // Pick the triangle of the fan in which `u` falls, and stretch `u` over it.
        let last = self.vertices.len() - 2;
        let mut left = u * 2.0 * self.area;
        let mut triangle = 1;
        while triangle < last && left > twice_area(triangle) {
            left -= twice_area(triangle);
            triangle += 1;
        }
        let u = (left / twice_area(triangle)).clamp(0.0, 1.0);

        // Stretch the unit square over the triangle: `s` grows away from vertex 0, `v` runs along the opposite edge.
        let s = u.sqrt();
        let (b, c) = (self.vertices[triangle], self.vertices[triangle + 1]);
        origin + s * ((b - origin) * (1.0 - v) + (c - origin) * v)
    }
}
