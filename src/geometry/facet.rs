//! A borrowed planar convex polygon: the form in which form factors and sampling take polygons.

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

/// A quadrilateral is a parallelogram if its opposite edges differ by no more than so many times its radius.
const SKEW: f64 = 1e-12;

impl<'a> Facet<'a> {
    /// A piece of a polygon with this normal: area, centroid and radius follow from the vertices.
    pub fn of_part(vertices: &'a [DVec3], normal: DVec3) -> Self {
        let origin = vertices[0];
        let (mut twice_area, mut moment) = (0.0, DVec3::ZERO);
        for corner in vertices[1..].windows(2) {
            let (b, c) = (corner[0] - origin, corner[1] - origin);
            let triangle = b.cross(c).dot(normal);
            twice_area += triangle;
            moment += triangle * (b + c);
        }
        let centroid = origin + moment / (3.0 * twice_area);
        let radius = vertices.iter().map(|vertex| vertex.distance_squared(centroid)).fold(0.0, f64::max).sqrt();
        Self { vertices, normal, area: 0.5 * twice_area, centroid, radius }
    }

    /// Signed height of `point` above the plane, positive in front.
    pub fn height(&self, point: DVec3) -> f64 {
        self.normal.dot(point - self.vertices[0])
    }

    /// Whether a point of the plane is on the inner side of every edge.
    pub fn contains(&self, point: DVec3) -> bool {
        let mut a = self.vertices[self.vertices.len() - 1];
        self.vertices.iter().all(|&b| {
            let inner = (b - a).cross(point - a).dot(self.normal) >= 0.0;
            a = b;
            inner
        })
    }

    /// Distance in metres from `point` to the nearest point of the polygon, interior included.
    pub fn distance_to(&self, point: DVec3) -> f64 {
        let height = self.height(point);
        let mut inside = true;
        let mut nearest_sq = f64::INFINITY;
        for (k, &a) in self.vertices.iter().enumerate() {
            let b = self.vertices[if k + 1 == self.vertices.len() { 0 } else { k + 1 }];
            let (edge, from_a) = (b - a, point - a);
            inside &= edge.cross(from_a).dot(self.normal) >= 0.0;
            let length_sq = edge.length_squared();
            let along = if length_sq > 0.0 { (from_a.dot(edge) / length_sq).clamp(0.0, 1.0) } else { 0.0 };
            nearest_sq = nearest_sq.min((from_a - along * edge).length_squared());
        }
        if inside { height.abs() } else { nearest_sq.sqrt() }
    }

    /// The point of the polygon at `(u, v)` in the unit square; uniform `(u, v)` give points uniform by area.
    ///
    /// A parallelogram is the square stretched, so that evenly spread `(u, v)` stay so. Other polygons are fans of triangles around
    /// vertex 0; `u` picks the triangle by area and is reused inside it.
    pub fn point_at(&self, u: f64, v: f64) -> DVec3 {
        let origin = self.vertices[0];
        if let &[_, b, c, d] = self.vertices
            && (b + d - c).distance_squared(origin) <= (SKEW * self.radius).powi(2)
        {
            return origin + u * (b - origin) + v * (d - origin);
        }
        let twice_area = |k: usize| (self.vertices[k] - origin).cross(self.vertices[k + 1] - origin).dot(self.normal);

        // Pick the triangle of the fan in which `u` falls, and stretch `u` over it.
        let last = self.vertices.len() - 2;
        let mut left = u * 2.0 * self.area;
        let mut triangle = 1;
        let mut whole = twice_area(triangle);
        while triangle < last && left > whole {
            left -= whole;
            triangle += 1;
            whole = twice_area(triangle);
        }
        let u = if whole > 0.0 { (left / whole).clamp(0.0, 1.0) } else { 0.0 };

        // Stretch the unit square over the triangle: `s` grows away from vertex 0, `v` runs along the opposite edge.
        let s = u.sqrt();
        let (b, c) = (self.vertices[triangle], self.vertices[triangle + 1]);
        origin + s * ((b - origin) * (1.0 - v) + (c - origin) * v)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Polygon, gauss_rule};

    /// Mean and second moments of the points over a fine regular grid, against the integrals over the polygon.
    fn assert_uniform(vertices: &[[f64; 3]]) {
        let polygon = Polygon::new(vertices).unwrap();
        let facet = polygon.facet();
        let (mut area, mut mean, mut square) = (0.0, DVec3::ZERO, DVec3::ZERO);
        crate::geometry::for_each_gauss_point(facet.vertices, facet.normal, 4, |x, weight| {
            area += weight;
            mean += weight * x;
            square += weight * x * x;
        });
        let n = 400;
        let (mut sampled_mean, mut sampled_square) = (DVec3::ZERO, DVec3::ZERO);
        for i in 0..n {
            for j in 0..n {
                let x = facet.point_at((i as f64 + 0.5) / n as f64, (j as f64 + 0.5) / n as f64);
                assert!(facet.distance_to(x) < 1e-12, "{x} is not on the polygon");
                sampled_mean += x / (n * n) as f64;
                sampled_square += x * x / (n * n) as f64;
            }
        }
        // A column of the grid that falls on the border of two triangles goes to one of them: off by up to 1/n.
        assert!(sampled_mean.distance(mean / area) < 1.0 / n as f64, "mean {sampled_mean}, want {}", mean / area);
        assert!(sampled_square.distance(square / area) < 4.0 / n as f64, "squares {sampled_square}, want {}", square / area);
    }

    #[test]
    fn point_at_is_uniform_by_area() {
        assert_uniform(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
        assert_uniform(&[[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 1.0, 0.0], [0.0, 1.0, 0.0]]);
        assert_uniform(&[[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [2.0, 1.0, 0.0], [0.0, 1.0, 0.0]]);
        assert_uniform(&[[1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [3.0, 1.0, 1.0], [2.0, 2.0, 2.0], [0.0, 1.0, 1.0]]);
    }

    #[test]
    fn point_at_survives_vertices_on_a_straight_edge() {
        assert_uniform(&[[0.0, 0.0, 0.0], [0.5, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.5, 0.0]]);
        let polygon = Polygon::new(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.5, 0.0]]).unwrap();
        for (u, v) in [(0.0, 0.0), (1.0, 1.0), (1.0, 0.0), (0.0, 1.0)] {
            assert!(polygon.facet().point_at(u, v).is_finite());
        }
    }

    #[test]
    fn distance_is_to_interior_edge_or_vertex() {
        let polygon = Polygon::new(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]).unwrap();
        let facet = polygon.facet();
        assert_eq!(facet.distance_to(DVec3::new(0.5, 0.5, -2.0)), 2.0);
        assert_eq!(facet.distance_to(DVec3::new(0.5, 5.0, 3.0)), 5.0);
        assert_eq!(facet.distance_to(DVec3::new(2.0, 3.0, 2.0)), 3.0);
        assert_eq!(facet.distance_to(DVec3::new(0.25, 0.5, 0.0)), 0.0);
    }

    #[test]
    fn gauss_points_lie_on_the_polygon() {
        let polygon = Polygon::new(&[[0.0, 0.0, 1.0], [3.0, 0.0, 1.0], [2.0, 1.0, 1.0], [0.0, 1.0, 1.0]]).unwrap();
        crate::geometry::for_each_gauss_point(polygon.facet().vertices, polygon.facet().normal, gauss_rule(5).len(), |x, _| {
            assert!(polygon.facet().distance_to(x) < 1e-14);
        });
    }
}
