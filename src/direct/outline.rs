//! The outline of a blocker as seen from a point.

use glam::DVec3;

use super::blockers::Blocker;
use super::view::View;

/// A corner within this angle of a plane lies on it, in radians: some hundred times what rounding of directions leaves, and far below what any
/// answer needs to be exact to.
pub(super) const SLIVER: f64 = 1e-12;

/// The cone from a point to the part of a blocker that stands in front of the source; memory that is reused.
#[derive(Default)]
pub(super) struct Outline {
    /// Unit normals, pointing inwards, of the planes through the point and an edge.
    pub planes: Vec<DVec3>,
    /// The corners as seen from the point.
    corners: Vec<DVec3>,
    /// The heights of corners over the source's plane.
    heights: Vec<f64>,
}

impl Outline {
    /// Takes the outline of a blocker that may stand between; false where it hides nothing: what touches the point, stands behind the source, or
    /// is seen edge-on.
    pub fn trace(&mut self, view: &View<'_>, blocker: Blocker<'_>, contact: f64) -> bool {
        let height = blocker.height(view.point);
        if blocker.is_touched(height, contact) {
            return false;
        }
        self.cut_to_front(view, blocker.vertices(), contact);

        // Seen from behind, the corners run the other way.
        self.planes.clear();
        let count = self.corners.len();
        for k in 0..count {
            let (a, b) = (self.corners[k], self.corners[if k + 1 == count { 0 } else { k + 1 }]);
            let normal = if height > 0.0 { b.cross(a) } else { a.cross(b) };
            let length_sq = normal.length_squared();
            // A corner given twice, or an edge that points straight at the point, bounds nothing.
            if length_sq > SLIVER * SLIVER * a.length_squared() * b.length_squared() {
                self.planes.push(normal / length_sq.sqrt());
            }
        }
        self.planes.len() > 2
    }

    /// Takes the corners of what is in front of the source's plane.
    fn cut_to_front(&mut self, view: &View<'_>, vertices: &[DVec3], contact: f64) {
        self.corners.clear();
        let height = |v: DVec3| {
            let height = view.source.height(v);
            if height.abs() <= contact { 0.0 } else { height }
        };
        self.heights.clear();
        self.heights.extend(vertices.iter().map(|&v| height(v)));
        if self.heights.iter().all(|&height| height >= 0.0) {
            self.corners.extend(vertices.iter().map(|&v| v - view.point));
            return;
        }
        for k in 0..vertices.len() {
            let next = if k + 1 == vertices.len() { 0 } else { k + 1 };
            let (a, b, height_a, height_b) = (vertices[k], vertices[next], self.heights[k], self.heights[next]);
            if height_a >= 0.0 {
                self.corners.push(a - view.point);
            }
            if (height_a > 0.0 && height_b < 0.0) || (height_a < 0.0 && height_b > 0.0) {
                self.corners.push(a + (b - a) * (height_a / (height_a - height_b)) - view.point);
            }
        }
    }

    /// Whether the outline and a piece overlap by no more than [`SLIVER`]: then an edge of one has all of the other outside.
    pub fn is_apart_from(&self, piece: &[DVec3]) -> bool {
        let is_outside = |plane: &DVec3| piece.iter().all(|corner| plane.dot(*corner) <= SLIVER);
        let has_outline_outside = |k: usize| {
            let plane = piece[if k + 1 == piece.len() { 0 } else { k + 1 }].cross(piece[k]);
            self.corners.iter().all(|corner| plane.dot(*corner) <= 0.0)
        };
        self.planes.iter().any(is_outside) || (0..piece.len()).any(has_outline_outside)
    }
}
