//! Convex polygons of one plane that make larger convex polygons together.
//!
//! Two that have an edge in common, from corner to corner, become one if their union is convex; so do unions, until no two are left that can. What is cut
//! into a grid becomes one polygon again. Where several unions are possible, the order of the polygons decides.
//!
//! Cost: O(n log n) for n polygons, each union checked corner by corner against its edges.

use std::collections::HashMap;

use glam::DVec3;

use super::Polygon;

/// A union has so many corners at most: to check one takes time with their square.
const MOST_CORNERS: usize = 16;

/// An edge from one place to another, by the bits of their coordinates.
type Edge = [[u64; 3]; 2];

/// What has an edge of which several polygons have a copy.
const SEVERAL: usize = usize::MAX;

/// The unions of `polygons`, which lie in one plane and face one way: each with the number of its first member, in the order of these.
/// `None` where that stays alone.
pub(crate) fn convex_unions(polygons: &[&Polygon]) -> Vec<(usize, Option<Polygon>)> {
    let mut pieces = Pieces::new(polygons);
    for piece in 0..polygons.len() {
        while pieces.join_a_neighbour(piece) {}
    }
    let alone_or_joined = pieces.pieces.into_iter().flatten().map(|Piece { first, polygon, is_union }| {
        let union = is_union.then_some(polygon);
        (first, union)
    });
    let mut unions: Vec<_> = alone_or_joined.collect();
    unions.sort_unstable_by_key(|(first, _)| *first);
    unions
}

/// A polygon, or a union of some.
struct Piece {
    /// The least number of its members.
    first: usize,
    polygon: Polygon,
    is_union: bool,
}

/// All pieces; `None` for those that others have taken in.
struct Pieces {
    pieces: Vec<Option<Piece>>,
    /// The piece on the left of each edge.
    left: HashMap<Edge, usize>,
}

impl Pieces {
    fn new(polygons: &[&Polygon]) -> Self {
        let alone = |(first, polygon): (usize, &&Polygon)| Some(Piece { first, polygon: (*polygon).clone(), is_union: false });
        let mut pieces = Self { pieces: polygons.iter().enumerate().map(alone).collect(), left: HashMap::new() };
        for (piece, polygon) in polygons.iter().enumerate() {
            pieces.add_edges(piece, polygon);
        }
        pieces
    }

    fn add_edges(&mut self, piece: usize, polygon: &Polygon) {
        for edge in edges(polygon) {
            self.left.entry(edge).and_modify(|piece| *piece = SEVERAL).or_insert(piece);
        }
    }

    /// Takes a neighbour into a piece, if there is one with which it makes a convex polygon.
    fn join_a_neighbour(&mut self, number: usize) -> bool {
        let Some(piece) = &self.pieces[number] else { return false };
        let found = edges(&piece.polygon).enumerate().find_map(|(k, edge)| {
            let other = *self.left.get(&[edge[1], edge[0]])?;
            let is_alone = other != number && self.left.get(&edge) == Some(&number);
            let neighbour = self.pieces.get(other).filter(|_| is_alone)?.as_ref()?;
            Some((other, union(&piece.polygon, k, &neighbour.polygon, edge[1])?))
        });
        let Some((other, polygon)) = found else { return false };
        let mut first = number;
        for member in [number, other] {
            let Some(taken) = self.pieces[member].take() else { continue };
            first = first.min(taken.first);
            for edge in edges(&taken.polygon) {
                if self.left.get(&edge) == Some(&member) {
                    self.left.remove(&edge);
                }
            }
        }
        self.add_edges(number, &polygon);
        self.pieces[number] = Some(Piece { first, polygon, is_union: true });
        true
    }
}

/// The edges of a polygon, in their order.
fn edges(polygon: &Polygon) -> impl Iterator<Item = Edge> {
    let vertices = polygon.facet().vertices;
    (0..vertices.len()).map(|k| [place(vertices[k]), place(vertices[(k + 1) % vertices.len()])])
}

/// Adding 0 makes -0 and 0 the same.
fn place(vertex: DVec3) -> [u64; 3] {
    vertex.to_array().map(|x| (x + 0.0).to_bits())
}

/// The union of `a` and of `b` on the other side of edge number `k` of `a`, which ends at `end`; `None` if that is not convex.
fn union(a: &Polygon, k: usize, b: &Polygon, end: [u64; 3]) -> Option<Polygon> {
    let (normal, own, others) = (a.facet().normal, a.facet().vertices, b.facet().vertices);
    if own.len() + others.len() > MOST_CORNERS + 2 {
        return None;
    }

    // From the end of the edge around `a` to its start, from there around `b`.
    let start = others.iter().position(|&vertex| place(vertex) == end)?;
    let around = |vertices: &[DVec3], from: usize| (0..vertices.len()).map(|i| vertices[(from + i) % vertices.len()]).collect();
    let (own, others): (Vec<DVec3>, Vec<DVec3>) = (around(own, k + 1), around(others, start));
    let mut corners = own.clone();
    corners.extend(&others[2..]);

    // Where both meet it must turn left, or go straight on: then there is no corner.
    for meeting in [own.len() - 1, 0] {
        let count = corners.len();
        let (before, here, after) = (corners[(meeting + count - 1) % count], corners[meeting], corners[(meeting + 1) % count]);
        let along = after - before;
        let outward = (here - before).cross(after - here).dot(normal) / along.length();
        let straight = Polygon::PLANARITY_TOLERANCE * along.length();
        if outward < -straight {
            return None;
        }
        if outward <= straight {
            corners.remove(meeting);
        }
    }
    Polygon::from_vertices(corners).ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::sampling;

    /// The cells of a skewed grid, without some.
    fn grid(columns: u32, rows: u32, is_hole: impl Fn(u32, u32) -> bool) -> Vec<Polygon> {
        let at = |i: u32, j: u32| {
            let (u, v) = (f64::from(i) / f64::from(columns), f64::from(j) / f64::from(rows));
            [3.0 * u + 0.4 * v, 2.0 * v - 0.1 * u, 0.7 * u + 0.3 * v]
        };
        let cells = (0..rows).flat_map(|j| (0..columns).map(move |i| (i, j))).filter(|&(i, j)| !is_hole(i, j));
        let cell = |(i, j)| Polygon::new(&[at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]).unwrap();
        cells.map(cell).collect()
    }

    fn unions(polygons: &[Polygon]) -> Vec<(usize, Option<Polygon>)> {
        convex_unions(&polygons.iter().collect::<Vec<_>>())
    }

    /// Of all unions, and of what stays alone.
    fn area(polygons: &[Polygon]) -> f64 {
        unions(polygons).iter().map(|(first, union)| union.as_ref().unwrap_or(&polygons[*first]).area()).sum()
    }

    #[test]
    fn a_grid_is_one_polygon_of_four_corners_in_any_order() {
        for seed in 0..20 {
            let mut cells = grid(7, 5, |_, _| false);
            cells.sort_by_key(|cell| sampling::hash(seed, cell.centroid()[0].to_bits() ^ cell.centroid()[1].to_bits()));
            let whole = unions(&cells);
            let covered = area(&cells);
            let expected: f64 = cells.iter().map(Polygon::area).sum();
            assert!((covered / expected - 1.0).abs() < 1e-9, "seed {seed}: {covered} of {expected}");
            assert!(whole.len() <= 5, "seed {seed}: {} are left", whole.len());
        }
        let in_order = unions(&grid(7, 5, |_, _| false));
        assert_eq!(in_order.len(), 1);
        assert_eq!(in_order[0].1.as_ref().unwrap().vertices().len(), 4);
    }

    #[test]
    fn unions_are_convex_and_cover_what_their_members_cover() {
        // Around a hole, and an L.
        for is_hole in [|i: u32, j: u32| i == 1 && j == 1, |i: u32, j: u32| i > 0 && j > 0] {
            let cells = grid(3, 3, is_hole);
            let expected: f64 = cells.iter().map(Polygon::area).sum();
            assert!((area(&cells) / expected - 1.0).abs() < 1e-9);
            assert!((2..=4).contains(&unions(&cells).len()));
        }
    }

    #[test]
    fn what_does_not_belong_together_stays_alone() {
        // Triangles that make a dart, an edge with a corner in its middle, and two copies beside a third.
        let triangle = |a: [f64; 2], b: [f64; 2], c: [f64; 2]| Polygon::new(&[a, b, c].map(|[x, y]| [x, y, 0.0])).unwrap();
        let dart = [triangle([0.0, 0.0], [1.0, 0.0], [0.0, 1.0]), triangle([1.0, 0.0], [3.0, 3.0], [0.0, 1.0])];
        assert_eq!(unions(&dart).len(), 1);
        let dart = [triangle([0.0, 0.0], [1.0, 0.0], [0.0, 1.0]), triangle([1.0, 0.0], [-0.2, 1.4], [0.0, 1.0])];
        assert_eq!(unions(&dart), vec![(0, None), (1, None)]);
        let beside = [triangle([0.0, 0.0], [2.0, 0.0], [0.0, 2.0]), triangle([0.0, 0.0], [0.0, -1.0], [1.0, 0.0])];
        assert_eq!(unions(&beside).len(), 2);
        let copies = [dart[0].clone(), dart[0].clone(), triangle([1.0, 0.0], [1.0, 1.0], [0.0, 1.0])];
        assert_eq!(unions(&copies).len(), 3);
    }

    #[test]
    fn a_fan_of_many_triangles_becomes_polygons_of_few_corners() {
        let rim = |k: u32| {
            let (y, x) = (f64::from(k % 100) / 100.0 * std::f64::consts::TAU).sin_cos();
            [x, y, 0.0]
        };
        let fan: Vec<Polygon> = (0..100).map(|k| Polygon::new(&[[0.0; 3], rim(k), rim(k + 1)]).unwrap()).collect();
        let found = unions(&fan);
        assert!(found.len() < 10 && found.iter().all(|(_, union)| union.as_ref().unwrap().vertices().len() <= MOST_CORNERS));
        let expected: f64 = fan.iter().map(Polygon::area).sum();
        assert!((area(&fan) / expected - 1.0).abs() < 1e-9);
    }
}
