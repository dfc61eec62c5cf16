//! A convex polygon cut in two: along a line, or into halves of about equal area. Both parts are convex, run like the polygon, and share the corners
//! of the cut to the bit.

use glam::DVec3;

use super::Facet;

/// The parts of a convex polygon on either side of a line in its plane, first where `height` above the line is positive; `None` if it lies on one side.
///
/// Corners nearer to the line than `tolerance` count as on it, so that no side of a part is shorter.
pub(crate) fn cut_along(vertices: &[DVec3], height: impl Fn(DVec3) -> f64, tolerance: f64) -> Option<[Vec<DVec3>; 2]> {
    let snapped = |vertex: DVec3| {
        let height = height(vertex);
        if height.abs() <= tolerance { 0.0 } else { height }
    };
    let (mut above, mut below) = (Vec::new(), Vec::new());
    let (mut is_above, mut is_below) = (false, false);
    let mut a = *vertices.last()?;
    let mut height_a = snapped(a);
    for &b in vertices {
        let height_b = snapped(b);
        if height_a * height_b < 0.0 {
            let crossing = a + (b - a) * (height_a / (height_a - height_b));
            above.push(crossing);
            below.push(crossing);
        }
        if height_b >= 0.0 {
            above.push(b);
        }
        if height_b <= 0.0 {
            below.push(b);
        }
        is_above |= height_b > 0.0;
        is_below |= height_b < 0.0;
        (a, height_a) = (b, height_b);
    }
    (is_above && is_below).then_some([above, below])
}

/// A polygon cut from the middle of its longest side to the corner, or the middle of a side, with which its parts are most alike in area
/// (`SplitEqual`; Lischinski 1994, section 4.2).
pub(crate) fn halve(polygon: &Facet<'_>) -> [Vec<DVec3>; 2] {
    let count = polygon.vertices.len();
    let corner = |k: usize| polygon.vertices[k % count];
    let length = |k: usize| corner(k).distance_squared(corner(k + 1));
    let longest = (0..count).max_by(|&a, &b| length(a).total_cmp(&length(b))).unwrap_or(0);
    let middle = 0.5 * (corner(longest) + corner(longest + 1));

    // Walk around from the middle: after `step` sides, and half a side more, how far from half of the area?
    let twice_area = |a: DVec3, b: DVec3| (a - middle).cross(b - middle).dot(polygon.normal);
    let mut swept = 0.0;
    let mut best = (f64::INFINITY, middle, 0, 0);
    for step in 1..count {
        let (a, b) = (corner(longest + step), corner(longest + step + 1));
        let half_way = 0.5 * (a + b);
        let ends = [(swept + twice_area(a, half_way), half_way, step + 1), (swept + twice_area(a, b), b, step + 2)];
        for (area, end, next) in ends.into_iter().take(if step + 1 < count { 2 } else { 1 }) {
            let off = (area - polygon.area).abs();
            if off < best.0 {
                best = (off, end, step, next);
            }
        }
        swept += twice_area(a, b);
    }
    let (_, end, last, next) = best;
    let first = [middle].into_iter().chain((1..=last).map(|step| corner(longest + step))).chain([end]);
    let second = [end].into_iter().chain((next..=count).map(|step| corner(longest + step))).chain([middle]);
    [first.collect(), second.collect()]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Polygon;

    fn area(vertices: &[DVec3]) -> f64 {
        Polygon::from_vertices(vertices.to_vec()).unwrap().area()
    }

    fn polygon(vertices: &[[f64; 2]]) -> Polygon {
        Polygon::new(&vertices.iter().map(|v| [v[0], v[1], 0.0]).collect::<Vec<_>>()).unwrap()
    }

    #[test]
    fn parts_make_the_whole_and_share_the_cut() {
        let hexagon = polygon(&[[0.0, 0.0], [2.0, 0.0], [3.0, 1.0], [2.5, 2.0], [1.0, 2.5], [0.0, 1.0]]);
        for k in 0..100 {
            let (sin, cos) = (0.0628 * f64::from(k)).sin_cos();
            let height = |v: DVec3| cos * (v.x - 1.3) + sin * (v.y - 1.1);
            let [above, below] = cut_along(hexagon.facet().vertices, height, 1e-6).unwrap();
            assert!((area(&above) + area(&below) - hexagon.area()).abs() < 1e-14);
            assert!(above.iter().all(|&v| height(v) >= -1e-6) && below.iter().all(|&v| height(v) <= 1e-6));
            let shared: Vec<&DVec3> = above.iter().filter(|v| below.contains(v)).collect();
            assert!(shared.len() == 2 && shared.iter().all(|v| height(**v).abs() <= 1e-6), "{shared:?}");
        }
    }

    #[test]
    fn a_line_that_touches_leaves_one_part_and_one_near_a_corner_goes_through_it() {
        let square = polygon(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
        let vertices = square.facet().vertices;
        assert_eq!(cut_along(vertices, |v| v.x + 1e-9, 1e-6), None);
        assert_eq!(cut_along(vertices, |v| v.x + v.y - 1e-7, 1e-6), None);
        let [above, below] = cut_along(vertices, |v| v.y - v.x + 1e-7, 1e-6).unwrap();
        assert_eq!((above.len(), below.len(), area(&above), area(&below)), (3, 3, 0.5, 0.5));
    }

    #[test]
    fn halves_are_alike() {
        for (vertices, least) in [
            (&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]][..], 0.5),
            (&[[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [0.0, 1.0]], 0.5),
            (&[[0.0, 0.0], [1.0, 0.0], [0.2, 1.0]], 0.5),
            (&[[0.0, 0.0], [2.0, 0.0], [3.0, 1.0], [2.5, 2.0], [1.0, 2.5], [0.0, 1.0]], 0.4),
        ] {
            let whole = polygon(vertices);
            let parts = halve(&whole.facet()).map(|part| area(&part) / whole.area());
            assert!((parts[0] + parts[1] - 1.0).abs() < 1e-14 && parts[0].min(parts[1]) >= least - 1e-14, "{parts:?}");
        }
        // Long ones are cut across.
        let long = polygon(&[[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [0.0, 1.0]]);
        assert!(halve(&long.facet()).iter().all(|part| part.len() == 4 && Facet::of_part(part, DVec3::Z).radius < 1.0));
    }
}
