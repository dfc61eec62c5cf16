//! Regular subdivision of a polygon.

use glam::DVec3;

use super::Facet;

/// A polygon that is this many times longer than wide is cut in two, not in four.
const ELONGATED: f64 = 2.0;

/// Calls `visit` with the pieces of a polygon, three or four corners each, counter-clockwise like the polygon.
pub(crate) fn for_each_piece(polygon: &Facet<'_>, mut visit: impl FnMut(&[DVec3])) {
    let vertices = polygon.vertices;
    let count = vertices.len();
    let middle = |k: usize| 0.5 * (vertices[k] + vertices[if k + 1 == count { 0 } else { k + 1 }]);
    let side = |k: usize| vertices[k].distance(vertices[if k + 1 == count { 0 } else { k + 1 }]);
    match *vertices {
        [a, b, c] => {
            let longest = (0..3).max_by(|&i, &j| side(i).total_cmp(&side(j))).unwrap_or(0);
            let height = 2.0 * polygon.area / side(longest);
            if side(longest) > ELONGATED * height * 2.0 {
                let (start, end, apex) = (vertices[longest], vertices[(longest + 1) % 3], vertices[(longest + 2) % 3]);
                visit(&[start, middle(longest), apex]);
                visit(&[middle(longest), end, apex]);
            } else {
                let (ab, bc, ca) = (middle(0), middle(1), middle(2));
                visit(&[a, ab, ca]);
                visit(&[ab, b, bc]);
                visit(&[ca, bc, c]);
                visit(&[ab, bc, ca]);
            }
        }
        [a, b, c, d] => {
            let (length, width) = (side(0) + side(2), side(1) + side(3));
            let (ab, bc, cd, da) = (middle(0), middle(1), middle(2), middle(3));
            if length > ELONGATED * width {
                visit(&[a, ab, cd, d]);
                visit(&[ab, b, c, cd]);
            } else if width > ELONGATED * length {
                visit(&[a, b, bc, da]);
                visit(&[da, bc, c, d]);
            } else {
                let centre = 0.5 * (ab + cd);
                visit(&[a, ab, centre, da]);
                visit(&[ab, b, bc, centre]);
                visit(&[centre, bc, c, cd]);
                visit(&[da, centre, cd, d]);
            }
        }
        _ => {
            for (k, &corner) in vertices.iter().enumerate() {
                visit(&[polygon.centroid, middle(if k == 0 { count - 1 } else { k - 1 }), corner, middle(k)]);
            }
        }
    }
}
