//! The quadratic element of six nodes: corners, then the middles of the edges from each corner to the next.

use glam::DVec2;

/// Barycentric coordinates of a point; a negative one says beyond which edge it lies.
pub(super) fn barycentric([a, b, c]: [DVec2; 3], at: DVec2) -> [f64; 3] {
    let twice_area = (b - a).perp_dot(c - a);
    let of_b = (at - a).perp_dot(c - a) / twice_area;
    let of_c = (b - a).perp_dot(at - a) / twice_area;
    [1.0 - of_b - of_c, of_b, of_c]
}

/// The weights of the six nodes at barycentric coordinates.
pub(super) fn weights([a, b, c]: [f64; 3]) -> [f64; 6] {
    let corner = |l: f64| l * (2.0 * l - 1.0);
    [corner(a), corner(b), corner(c), 4.0 * a * b, 4.0 * b * c, 4.0 * c * a]
}

/// Light that varies by so much within an element, as the least over the most of its nodes, does so since something stands before it.
const STEEP: f64 = 0.5;

/// The value of the function as it counts, from that of its polynomial: across a jump of light that runs through an element, a quadratic function
/// swings beyond what is found on either side by up to an eighth of the jump, so there it is kept within the range of the nodes. Where light is smooth,
/// it may be largest between them.
pub(super) fn limited(nodes: [f64; 6], value: f64) -> f64 {
    let (least, most) = nodes.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), &b| (b.min(least), b.max(most)));
    if least < STEEP * most { value.clamp(least, most) } else { value }
}

/// The function where nodes have these weights, by their values.
pub(super) fn value(nodes: [f64; 6], weights: [f64; 6]) -> f64 {
    limited(nodes, nodes.iter().zip(weights).map(|(b, weight)| weight * b).sum())
}

/// The mean over an element of the sum of the squared weights: the squared noise of the function, where that of its nodes is 1.
pub(super) const NOISE: f64 = 3.0 * (OF_CORNER + OF_MIDDLE);

/// What a corner and the middle of an edge have of that.
const OF_CORNER: f64 = 1.0 / 30.0;
const OF_MIDDLE: f64 = 8.0 / 45.0;

/// Barycentric coordinates of a node, a little inside, drawn by what it has of the noise; for a number that is uniform in [0, 1).
pub(super) fn sampled_node(draw: f64) -> [f64; 3] {
    const INSIDE: f64 = 1e-3;
    let (side, within) = ((3.0 * draw) as usize, (3.0 * draw).fract());
    let corner = |at: usize| if at == side { 1.0 } else { 0.0 };
    let node = if within < OF_CORNER / (OF_CORNER + OF_MIDDLE) {
        [0, 1, 2].map(corner)
    } else {
        [0, 1, 2].map(|at| 0.5 - 0.5 * corner(at))
    };
    node.map(|l| l + INSIDE * (1.0 / 3.0 - l))
}

/// Barycentric coordinates uniform over the triangle, for `u` and `v` uniform in [0, 1).
pub(super) fn sampled_barycentric(u: f64, v: f64) -> [f64; 3] {
    let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
    [1.0 - u - v, u, v]
}

/// The point with barycentric coordinates.
pub(super) fn point_at([a, b, c]: [DVec2; 3], [of_a, of_b, of_c]: [f64; 3]) -> DVec2 {
    of_a * a + of_b * b + of_c * c
}

#[cfg(test)]
mod tests {
    use super::*;

    const CORNERS: [DVec2; 3] = [DVec2::new(1.0, 0.5), DVec2::new(4.0, 1.0), DVec2::new(2.0, 3.0)];

    #[test]
    fn quadratic_functions_are_exact() {
        let [a, b, c] = CORNERS;
        let nodes = [a, b, c, 0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a)];
        let function = |at: DVec2| 3.0 - at.x + 2.0 * at.y + at.x * at.x - 0.7 * at.x * at.y + 0.2 * at.y * at.y;
        for number in 0..100_u32 {
            let [u, v] = [number % 10, number / 10].map(|k| f64::from(k) / 10.0);
            let at = point_at(CORNERS, sampled_barycentric(u, v));
            let interpolated: f64 = weights(barycentric(CORNERS, at)).iter().zip(nodes).map(|(w, node)| w * function(node)).sum();
            assert!((interpolated - function(at)).abs() < 1e-12, "{at}");
        }
    }

    #[test]
    fn jumps_are_not_overshot_and_smooth_peaks_stay() {
        // Dark at one corner and the middles beside it, else bright; and a peak between nodes.
        let jump = [0.1, 1.0, 1.0, 0.1, 1.0, 0.1];
        let peak = [0.9, 0.95, 0.95, 0.98, 0.95, 0.98];
        let (mut under, mut over) = (0.0_f64, 0.0_f64);
        for number in 0..400_u32 {
            let [u, v] = [number % 20, number / 20].map(|k| f64::from(k) / 20.0);
            let weights = weights(sampled_barycentric(u, v));
            let of = |nodes: [f64; 6]| weights.iter().zip(nodes).map(|(w, b)| w * b).sum::<f64>();
            under = under.min(of(jump) - 0.1);
            let kept = limited(jump, of(jump));
            assert!((0.1..=1.0).contains(&kept), "{kept}");
            assert_eq!(limited(peak, of(peak)), of(peak));
            over = over.max(of(peak) - 0.98);
        }
        assert!(under < -0.05 && over > 0.0, "{under} {over}");
    }

    #[test]
    fn points_outside_have_a_negative_coordinate() {
        assert!(barycentric(CORNERS, DVec2::new(1.0, 3.0)).iter().any(|&l| l < 0.0));
        assert!(barycentric(CORNERS, CORNERS.iter().sum::<DVec2>() / 3.0).iter().all(|&l| (l - 1.0 / 3.0).abs() < 1e-12));
    }
}
