//! Whether a polygon stays out of the way between two others: out of the convex hull of both.
//!
//! Two convex polytopes are apart if and only if one of few directions shows it: the normal of a face of one, or the cross product
//! of an edge of each (separating axes; Gottschalk, Lin, Manocha 1996). Faces of the hull of two polygons are these themselves, and
//! triangles of an edge of one with a vertex of the other; its edges are theirs, and the connections of their vertices. What only
//! touches is apart.

use glam::DVec3;

use super::Facet;

/// Whether `blocker` and the convex hull of `receiver` and `source` overlap by no more than `tolerance` metres.
///
/// "No" proves nothing where rounding decides; "yes" is proved by the direction that was found.
pub(crate) fn is_apart(receiver: &[DVec3], source: &[DVec3], blocker: &Facet<'_>, tolerance: f64) -> bool {
    let parts = |axis: DVec3| {
        let along = |points: &[DVec3], range: [f64; 2]| {
            points.iter().map(|point| axis.dot(*point)).fold(range, |[low, high], at| [low.min(at), high.max(at)])
        };
        const NOTHING: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];
        let hull = along(source, along(receiver, NOTHING));
        let own = along(blocker.vertices, NOTHING);
        let overlap = f64::min(hull[1] - own[0], own[1] - hull[0]);
        let length = axis.length();
        length > 0.0 && overlap <= tolerance * length
    };

    // Faces: of the blocker, and of the hull.
    if parts(blocker.normal) {
        return true;
    }
    let sides =
        |of: &[DVec3], with: &[DVec3]| edges(of).any(|(start, edge)| with.iter().any(|&vertex| parts(edge.cross(vertex - start))));
    if sides(receiver, source) || sides(source, receiver) {
        return true;
    }

    // Edges with edges.
    edges(blocker.vertices).any(|(_, edge)| {
        edges(receiver).chain(edges(source)).any(|(_, other)| parts(edge.cross(other)))
            || receiver.iter().any(|&from| source.iter().any(|&to| parts(edge.cross(to - from))))
    })
}

/// The edges of a polygon: where each starts, and where it leads.
pub(crate) fn edges(vertices: &[DVec3]) -> impl Iterator<Item = (DVec3, DVec3)> + '_ {
    vertices.iter().enumerate().map(|(k, &start)| (start, vertices[if k + 1 == vertices.len() { 0 } else { k + 1 }] - start))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Polygon;

    fn square(corner: [f64; 3], u: [f64; 3], v: [f64; 3]) -> Polygon {
        let at = |s: f64, t: f64| std::array::from_fn(|k| corner[k] + s * u[k] + t * v[k]);
        Polygon::new(&[at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)]).unwrap()
    }

    fn apart(blocker: &Polygon) -> bool {
        let floor = square([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
        let ceiling = square([0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]);
        is_apart(floor.facet().vertices, ceiling.facet().vertices, &blocker.facet(), 1e-12)
    }

    #[test]
    fn what_stands_beside_or_touches_is_apart_and_what_reaches_in_is_not() {
        let wall = |x: f64| square([x, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
        assert!(apart(&wall(1.0)) && apart(&wall(1.5)) && apart(&wall(0.0)));
        assert!(!apart(&wall(0.999)));
        // A tilted sheet over a corner: apart only by the cross product of two edges.
        let sheet = |distance: f64| square([1.0 + distance, 0.5, 0.3], [-0.4, 0.4, 0.1], [0.4, 0.4, 0.0]);
        assert!(!apart(&sheet(0.1)) && apart(&sheet(0.5)));
        assert!(!apart(&square([0.4, 0.4, 0.5], [0.2, 0.0, 0.0], [0.0, 0.2, 0.0])));
    }

    #[test]
    fn a_point_of_the_blocker_inside_the_hull_is_never_missed() {
        use crate::geometry::sampling;
        let unit = |seed, k| sampling::unit(sampling::hash(seed, k));
        let vector = |seed: u64, k: u64| DVec3::new(unit(seed, 3 * k), unit(seed, 3 * k + 1), unit(seed, 3 * k + 2));
        let (mut separate, mut together) = (0, 0);
        for seed in 0..3000 {
            let triangle = |k: u64, size: f64| [0, 1, 2].map(|i| vector(seed, 4 * k) + size * (vector(seed, 4 * k + i + 1) - 0.5));
            let (receiver, source, blocker) = (triangle(0, 0.6), triangle(1, 0.6), triangle(2, 0.6));
            let Ok(polygon) = Polygon::from_vertices(blocker.to_vec()) else { continue };
            let apart = is_apart(&receiver, &source, &polygon.facet(), 0.0);

            // Segments between the two that pass through the blocker prove the contrary of "apart".
            let inside =
                |points: &[DVec3; 3], s: f64, t: f64| points[0] + s * ((points[1] - points[0]) + t * (points[2] - points[1]));
            let crosses = (0..400).any(|k| {
                let [u, v, s, t] = sampling::sobol_4d(k, seed);
                let (x, y) = (inside(&receiver, u, v), inside(&source, s, t));
                let (height_x, height_y) = (polygon.facet().height(x), polygon.facet().height(y));
                height_x * height_y < 0.0 && polygon.facet().contains(x + (y - x) * (height_x / (height_x - height_y)))
            });
            assert!(!(apart && crosses), "seed {seed}");
            separate += u32::from(apart);
            together += u32::from(crosses);
        }
        assert!(separate > 300 && together > 300, "{separate} apart, {together} crossed");
    }
}
