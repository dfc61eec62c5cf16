//! From triangles back to the faces that they were cut from: files of triangles alone make as few surfaces as those of polygons.
//!
//! A face grows from a triangle over edges to triangles in its plane, as long as it remains a disc: each addition shares an edge with it and brings a
//! new corner, or shares two or three edges that follow each other. So its contour is one simple polygon, and what surrounds a hole becomes
//! several faces. Corners in the middle of straight edges are then left out. Faces start at the largest triangles, whose planes are known best.
//!
//! Cost: O(n log n) for n triangles.

use std::collections::{HashMap, VecDeque};

use glam::DVec3;

use crate::geometry::Aabb;
use crate::progress::Stop;

/// Normals of joined triangles differ by no more than this angle in radians, edges that count as straight turn by no more: facets of curved surfaces are to
/// keep their edges. The planes of a scene are told apart by the same angle.
const ANGLE_TOLERANCE: f64 = 1e-3;

/// Places are known to this fraction of their size: files of floats have seven digits, transforms cost one.
const DISTANCE_TOLERANCE: f64 = 1e-6;

/// A face of joined triangles.
pub(super) struct Joined {
    /// Its corners, counter-clockwise from the front.
    pub corners: Vec<DVec3>,
    /// Its triangles, as indices into those that were given, in their order.
    pub triangles: Vec<usize>,
}

/// Vertices by their places, triangles by these, and what lies where.
struct Soup {
    /// The number of the first vertex at the place of each.
    places: Vec<u32>,
    normals: Vec<DVec3>,
    /// The triangle on the left of an edge from one place to another; `None` where there are several.
    left: HashMap<(u32, u32), Option<usize>>,
    tolerance: f64,
}

/// Joins triangles: the faces, in the order of their first triangles; only some of them if stopped before. Triangles without area stay alone. Vertices must be
/// finite.
pub(super) fn joined(vertices: &[DVec3], triangles: &[[u32; 3]], stop: Stop<'_>) -> Vec<Joined> {
    let soup = Soup::new(vertices, triangles);
    let mut order: Vec<usize> = (0..triangles.len()).collect();
    order.sort_by(|&a, &b| soup.normals[b].length().total_cmp(&soup.normals[a].length()).then(a.cmp(&b)));

    let mut taken = vec![false; triangles.len()];
    let mut faces = Vec::new();
    for seed in order {
        if stop() {
            break;
        }
        if !taken[seed] {
            faces.push(soup.grown(seed, vertices, triangles, &mut taken));
        }
    }
    faces.sort_by_key(|face| face.triangles[0]);
    faces
}

impl Soup {
    fn new(vertices: &[DVec3], triangles: &[[u32; 3]]) -> Self {
        // Adding 0 makes -0 and 0 the same.
        let mut first: HashMap<[u64; 3], u32> = HashMap::with_capacity(vertices.len());
        let key = |vertex: &DVec3| vertex.to_array().map(|x| (x + 0.0).to_bits());
        let places: Vec<u32> = (0_u32..).zip(vertices).map(|(k, vertex)| *first.entry(key(vertex)).or_insert(k)).collect();

        let normal = |corners: &[u32; 3]| {
            let [a, b, c] = corners.map(|corner| vertices[corner as usize]);
            (b - a).cross(c - a)
        };
        let mut left: HashMap<(u32, u32), Option<usize>> = HashMap::with_capacity(3 * triangles.len());
        for (number, corners) in triangles.iter().enumerate() {
            let corners = corners.map(|corner| places[corner as usize]);
            for k in 0..3 {
                left.entry((corners[k], corners[(k + 1) % 3])).and_modify(|triangle| *triangle = None).or_insert(Some(number));
            }
        }
        let farthest = vertices.iter().map(|vertex| vertex.abs().max_element()).fold(0.0, f64::max);
        let size = Aabb::around(vertices.iter().copied()).diagonal().max(farthest);
        Self { places, normals: triangles.iter().map(normal).collect(), left, tolerance: DISTANCE_TOLERANCE * size }
    }

    /// The face around a triangle; what it takes is marked.
    fn grown(&self, seed: usize, vertices: &[DVec3], triangles: &[[u32; 3]], taken: &mut [bool]) -> Joined {
        let places = |triangle: usize| triangles[triangle].map(|corner| self.places[corner as usize]);
        let normal = self.normals[seed].normalize_or_zero();
        let origin = vertices[places(seed)[0] as usize];
        let is_in_plane = |triangle: usize| {
            let own = self.normals[triangle].normalize_or_zero();
            let is_near = |place: u32| (vertices[place as usize] - origin).dot(normal).abs() <= self.tolerance;
            own.dot(normal) > 0.0 && own.cross(normal).length() <= ANGLE_TOLERANCE && places(triangle).into_iter().all(is_near)
        };

        taken[seed] = true;
        let mut contour = Contour::around(places(seed));
        let mut members = vec![seed];
        let mut waiting = VecDeque::from([seed]);
        while let Some(member) = waiting.pop_front() {
            let corners = places(member);
            for k in 0..3 {
                // The other side of an edge, if one triangle lies there and one here.
                let edge = (corners[k], corners[(k + 1) % 3]);
                let neighbour = self.left.get(&(edge.1, edge.0)).copied().flatten();
                let Some(neighbour) = neighbour.filter(|&other| !taken[other] && self.left[&edge].is_some()) else { continue };
                if is_in_plane(neighbour) && contour.add(places(neighbour)) {
                    taken[neighbour] = true;
                    members.push(neighbour);
                    // What could not be added yet may be once two of its edges are there: then it is asked from here again.
                    waiting.push_back(neighbour);
                }
            }
        }
        members.sort_unstable();
        let corners: Vec<DVec3> = contour.places().into_iter().map(|place| vertices[place as usize]).collect();
        Joined { corners: without_straight_corners(&corners, self.tolerance), triangles: members }
    }
}

/// The contour of a disc of triangles: each place occurs in it once. The disc lies on the left.
struct Contour {
    next: HashMap<u32, u32>,
    start: u32,
}

impl Contour {
    fn around([a, b, c]: [u32; 3]) -> Self {
        Self { next: HashMap::from([(a, b), (b, c), (c, a)]), start: a }
    }

    /// Adds a triangle, if the disc remains one.
    fn add(&mut self, corners: [u32; 3]) -> bool {
        let is_shared = |k: usize| self.next.get(&corners[(k + 1) % 3]) == Some(&corners[k]);
        let shared = [0, 1, 2].map(is_shared);
        match shared.iter().filter(|&&shared| shared).count() {
            1 => {
                // Across one edge, to a new corner.
                let k = shared.iter().position(|&shared| shared).unwrap_or(0);
                let [a, b, new] = [corners[k], corners[(k + 1) % 3], corners[(k + 2) % 3]];
                if self.next.contains_key(&new) {
                    return false;
                }
                self.next.extend([(b, new), (new, a)]);
                true
            }
            2 => {
                // Across two edges, whose common corner is inside then.
                let k = shared.iter().position(|&shared| !shared).unwrap_or(0);
                let [a, b, inside] = [corners[k], corners[(k + 1) % 3], corners[(k + 2) % 3]];
                self.next.remove(&inside);
                self.next.insert(a, b);
                if self.start == inside {
                    self.start = a;
                }
                true
            }
            _ => false,
        }
    }

    fn places(&self) -> Vec<u32> {
        let mut places = vec![self.start];
        let mut at = self.next[&self.start];
        while at != self.start {
            places.push(at);
            at = self.next[&at];
        }
        places
    }
}

/// Leaves out corners in the middle of edges that are straight: from one real corner to the next, if all in between lie on the line.
fn without_straight_corners(corners: &[DVec3], tolerance: f64) -> Vec<DVec3> {
    let count = corners.len();
    let turns = |&k: &usize| {
        let (before, after) = (corners[k] - corners[(k + count - 1) % count], corners[(k + 1) % count] - corners[k]);
        before.cross(after).length() > ANGLE_TOLERANCE * before.length() * after.length() || before.dot(after) <= 0.0
    };
    let turning: Vec<usize> = (0..count).filter(turns).collect();
    if turning.len() < 3 {
        return corners.to_vec();
    }
    let mut kept = Vec::with_capacity(turning.len());
    for (index, &from) in turning.iter().enumerate() {
        let to = turning.get(index + 1).map_or(turning[0] + count, |&to| to);
        let (start, along) = (corners[from], (corners[to % count] - corners[from]).normalize_or_zero());
        let between = || (from + 1..to).map(|k| corners[k % count]);
        kept.push(start);
        if between().any(|corner| (corner - start).cross(along).length() > tolerance) {
            kept.extend(between());
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A grid of squares of two triangles each, without those squares that are left out.
    fn grid(size: u32, is_hole: impl Fn(u32, u32) -> bool) -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let at = |x: u32, y: u32| y * (size + 1) + x;
        let vertices =
            (0..=size).flat_map(|y| (0..=size).map(move |x| DVec3::new(f64::from(x), f64::from(y), 0.25 * f64::from(x)))).collect();
        let squares = (0..size).flat_map(|y| (0..size).map(move |x| (x, y))).filter(|&(x, y)| !is_hole(x, y));
        let triangles =
            squares.flat_map(|(x, y)| [[at(x, y), at(x + 1, y), at(x + 1, y + 1)], [at(x, y), at(x + 1, y + 1), at(x, y + 1)]]);
        (vertices, triangles.collect())
    }

    fn area(corners: &[DVec3]) -> f64 {
        let fan = |k: usize| (corners[k] - corners[0]).cross(corners[k + 1] - corners[0]);
        0.5 * (1..corners.len() - 1).map(fan).sum::<DVec3>().length()
    }

    #[test]
    fn a_grid_becomes_a_square_of_four_corners() {
        let (vertices, triangles) = grid(30, |_, _| false);
        let faces = joined(&vertices, &triangles, &|| false);
        assert_eq!(faces.len(), 1);
        assert_eq!((faces[0].corners.len(), faces[0].triangles.len()), (4, 1800));
        assert!((area(&faces[0].corners) - 900.0 * 1.0625_f64.sqrt()).abs() < 1e-9);
    }

    #[test]
    fn around_a_hole_lie_several_faces_that_cover_the_same() {
        let (vertices, triangles) = grid(9, |x, y| (3..6).contains(&x) && (3..6).contains(&y));
        let faces = joined(&vertices, &triangles, &|| false);
        assert!((2..8).contains(&faces.len()), "{}", faces.len());
        let all: f64 = faces.iter().map(|face| area(&face.corners)).sum();
        assert!((all - 72.0 * 1.0625_f64.sqrt()).abs() < 1e-9);
        let mut members: Vec<usize> = faces.iter().flat_map(|face| face.triangles.clone()).collect();
        members.sort_unstable();
        assert!(members.into_iter().eq(0..triangles.len()));
    }

    #[test]
    fn repeated_vertices_are_one_and_edges_of_a_box_stay() {
        // Two triangles with vertices of their own, and one that stands up from them.
        let v = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
        let vertices = [
            v(0.0, 0.0, 0.0),
            v(1.0, 0.0, 0.0),
            v(1.0, 1.0, 0.0),
            v(0.0, 0.0, -0.0),
            v(1.0, 1.0, 0.0),
            v(0.0, 1.0, 0.0),
            v(1.0, 0.5, 1.0),
        ];
        let faces = joined(&vertices, &[[0, 1, 2], [3, 4, 5], [2, 1, 6]], &|| false);
        assert_eq!(faces.iter().map(|face| face.triangles.clone()).collect::<Vec<_>>(), [vec![0, 1], vec![2]]);
        assert_eq!(faces[0].corners.len(), 4);
        // Backs are no part of a front, and of three triangles at an edge none is joined.
        assert_eq!(joined(&vertices, &[[0, 1, 2], [3, 5, 4]], &|| false).len(), 2);
        assert_eq!(joined(&vertices, &[[0, 1, 2], [3, 4, 5], [3, 4, 6]], &|| false).len(), 3);
    }

    #[test]
    fn round_contours_keep_their_corners() {
        let corner = |k: f64| {
            let (y, x) = (k / 2000.0 * std::f64::consts::TAU).sin_cos();
            DVec3::new(x, y, 0.0)
        };
        let circle: Vec<DVec3> = (0..2000).map(f64::from).map(corner).collect();
        assert_eq!(without_straight_corners(&circle, 1e-6).len(), 2000);
        // So fine that no corner turns by the angle that counts: all stay.
        let fine: Vec<DVec3> = (0..20_000).map(|k| corner(0.1 * f64::from(k))).collect();
        assert_eq!(without_straight_corners(&fine, 1e-6).len(), 20_000);
    }
}
