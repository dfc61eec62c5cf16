//! The edges of a scene, welded: surfaces share edges by position alone, and often only in part.
//!
//! Sides of polygons that lie on one line and touch or overlap become one chain, in which every stretch knows the faces that meet there. So an edge
//! between two faces is known as such, whatever its parts belong to, and casts a shadow only where it is a silhouette.

use glam::DVec3;
use rayon::prelude::*;

use super::faces::{Faces, Plane};
use crate::geometry::{Aabb, edges as sides_of};
use crate::scene::SurfaceId;

/// Shorter stretches, in tolerances, are none.
const SHORTEST: f64 = 4.0;

/// A face along an edge.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wing {
    pub plane: u32,
    /// The unit vector across the edge into the face, in its plane.
    pub inward: DVec3,
    /// How far the face reaches from the edge, in metres.
    width: f64,
}

/// A stretch of a line along which the same faces meet.
#[derive(Clone, Debug)]
pub(super) struct Edge {
    pub ends: [DVec3; 2],
    pub wings: Vec<Wing>,
}

/// On which side of a plane through an edge the faces along it lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Shadow {
    /// All in the plane: it sees them edge-on.
    Nowhere,
    /// Behind it, or in it.
    Behind,
    /// In front of it, or in it.
    InFront,
    /// On both sides: the edge is no silhouette.
    Both,
}

impl Edge {
    /// Where its faces lie as seen along a plane through it.
    fn shadow(&self, normal: DVec3, on_plane: f64) -> Shadow {
        let heights = self.wings.iter().map(|wing| normal.dot(wing.inward) * wing.width);
        let (front, behind) = heights.fold((false, false), |(f, b), height| (f | (height > on_plane), b | (height < -on_plane)));
        match (front, behind) {
            (false, false) => Shadow::Nowhere,
            (false, true) => Shadow::Behind,
            (true, false) => Shadow::InFront,
            (true, true) => Shadow::Both,
        }
    }

    /// A plane through it, seen from each side on which its faces leave light free that comes along the plane.
    pub fn free_sides(&self, plane: &Plane, on_plane: f64) -> impl Iterator<Item = Plane> + use<> {
        let (front, back) = (Some(*plane), Some(plane.reversed()));
        let sides = match self.shadow(plane.normal, on_plane) {
            Shadow::Behind => [front, None],
            Shadow::InFront => [None, back],
            Shadow::Nowhere => [front, back],
            Shadow::Both => [None, None],
        };
        sides.into_iter().flatten()
    }

    /// Whether two of its faces continue each other: no plane makes it a silhouette.
    fn is_flat(&self) -> bool {
        let continues = |a: &Wing, b: &Wing| a.plane == b.plane && a.inward.dot(b.inward) < 0.0;
        self.wings.iter().enumerate().any(|(k, a)| self.wings[..k].iter().any(|b| continues(a, b)))
    }
}

/// A side of a polygon.
#[derive(Clone, Copy)]
struct Side {
    surface: SurfaceId,
    start: DVec3,
    edge: DVec3,
}

/// The part of a line along which a face lies.
struct Stretch {
    from: f64,
    to: f64,
    wing: Wing,
}

/// All edges that can be silhouettes.
pub(super) fn welded(faces: &Faces<'_>) -> Vec<Edge> {
    // All sides, the longest first: a long one knows its line best.
    let mut sides = Vec::new();
    let mut sides_of_surface = vec![0..0; faces.scene.surfaces().len()];
    for surface in faces.ids() {
        let first = sides.len();
        sides.extend(sides_of(faces.facet(surface).vertices).map(|(start, edge)| Side { surface, start, edge }));
        sides_of_surface[surface.index()] = first..sides.len();
    }
    let mut order: Vec<usize> = (0..sides.len()).filter(|&k| sides[k].edge.length() > faces.tolerance).collect();
    order.sort_by(|&a, &b| sides[b].edge.length_squared().total_cmp(&sides[a].edge.length_squared()).then(a.cmp(&b)));

    // Each takes all that continues or overlaps it along its line.
    let mut is_taken = vec![false; sides.len()];
    let mut chains: Vec<(Line, Vec<Side>, [f64; 2])> = Vec::new();
    for first in order {
        if is_taken[first] {
            continue;
        }
        let line = Line { origin: sides[first].start, along: sides[first].edge.normalize() };
        let (mut low, mut high) = (0.0, sides[first].edge.length());
        let mut chain = vec![first];
        is_taken[first] = true;
        loop {
            let before = chain.len();
            let bounds = Aabb::around([line.at(low), line.at(high)]);
            for k in faces.near(&bounds).into_iter().flat_map(|surface| sides_of_surface[surface.index()].clone()) {
                let Some([from, to]) = line.part(&sides[k], faces.tolerance).filter(|_| !is_taken[k]) else { continue };
                if from <= high + faces.tolerance && to >= low - faces.tolerance {
                    (low, high) = (low.min(from), high.max(to));
                    is_taken[k] = true;
                    chain.push(k);
                }
            }
            if chain.len() == before {
                break;
            }
        }
        chains.push((line, chain.into_iter().map(|k| sides[k]).collect(), [low, high]));
    }
    chains.into_par_iter().flat_map_iter(|(line, chain, range)| line.edges(faces, &chain, range)).collect()
}

/// A line with a unit direction.
#[derive(Clone, Copy)]
struct Line {
    origin: DVec3,
    along: DVec3,
}

impl Line {
    fn at(&self, t: f64) -> DVec3 {
        self.origin + t * self.along
    }

    fn place(&self, point: DVec3) -> f64 {
        self.along.dot(point - self.origin)
    }

    fn distance(&self, point: DVec3) -> f64 {
        (point - self.at(self.place(point))).length()
    }

    /// From where to where a side lies on the line, if it does.
    fn part(&self, side: &Side, tolerance: f64) -> Option<[f64; 2]> {
        let (start, end) = (side.start, side.start + side.edge);
        let [a, b] = [self.place(start), self.place(end)];
        (self.distance(start) <= tolerance && self.distance(end) <= tolerance).then_some([a.min(b), a.max(b)])
    }

    /// The edges of a chain of sides.
    fn edges(&self, faces: &Faces<'_>, chain: &[Side], range: [f64; 2]) -> Vec<Edge> {
        let mut stretches: Vec<Stretch> = chain.iter().filter_map(|side| self.wing_of(faces, side)).collect();
        let bounds = Aabb::around(range.map(|t| self.at(t)));
        for surface in faces.near(&bounds) {
            self.through(faces, surface, range, &mut stretches);
        }

        // Where faces begin or end, in order; places within the tolerance are one.
        let mut places: Vec<f64> = stretches.iter().flat_map(|stretch| [stretch.from, stretch.to]).collect();
        places.sort_by(f64::total_cmp);
        places.dedup_by(|b, a| *b - *a <= faces.tolerance);

        // The faces of each stretch between two places; stretches with the same faces are one.
        let mut edges: Vec<Edge> = Vec::new();
        for pair in places.windows(2) {
            let middle = 0.5 * (pair[0] + pair[1]);
            let mut wings: Vec<Wing> = Vec::new();
            for stretch in stretches.iter().filter(|stretch| stretch.from < middle && stretch.to > middle) {
                match wings.iter_mut().find(|wing| wing.continues(&stretch.wing)) {
                    Some(wing) => wing.width = wing.width.max(stretch.wing.width),
                    None => wings.push(stretch.wing),
                }
            }
            wings.sort_by(|a, b| a.plane.cmp(&b.plane).then_with(|| a.inward.x.total_cmp(&b.inward.x)));
            let ends = [self.at(pair[0]), self.at(pair[1])];
            match edges.last_mut().filter(|edge| edge.ends[1] == ends[0] && same_wings(&edge.wings, &wings)) {
                Some(edge) => edge.ends[1] = ends[1],
                None => edges.push(Edge { ends, wings }),
            }
        }
        // What is left between places that should be one is no edge.
        let is_edge = |edge: &Edge| edge.ends[0].distance(edge.ends[1]) > SHORTEST * faces.tolerance;
        edges.retain(|edge| is_edge(edge) && !edge.wings.is_empty() && !edge.is_flat());
        edges
    }

    /// The face of a side.
    fn wing_of(&self, faces: &Faces<'_>, side: &Side) -> Option<Stretch> {
        let facet = faces.facet(side.surface);
        let [a, b] = [self.place(side.start), self.place(side.start + side.edge)];
        let inward = facet.normal.cross(if a < b { self.along } else { -self.along }).try_normalize()?;
        let width = facet.vertices.iter().map(|&vertex| inward.dot(vertex - self.origin)).fold(0.0, f64::max);
        let wing = Wing { plane: faces.scene.surface(side.surface).plane(), inward, width };
        Some(Stretch { from: a.min(b), to: a.max(b), wing })
    }

    /// A face that the line runs through, within its plane: it lies on both sides.
    fn through(&self, faces: &Faces<'_>, surface: SurfaceId, range: [f64; 2], stretches: &mut Vec<Stretch>) {
        let facet = faces.facet(surface);
        let plane = Plane { origin: facet.centroid, normal: facet.normal };
        let inwards =
            || sides_of(facet.vertices).filter_map(|(start, edge)| Some((start, facet.normal.cross(edge).try_normalize()?)));
        let [mut from, mut to] = range;
        for (start, inward) in inwards() {
            let (depth, slope) = (inward.dot(self.origin - start), inward.dot(self.along));
            let crossing = -depth / slope;
            if slope > 0.0 && crossing.is_finite() {
                from = from.max(crossing);
            } else if slope < 0.0 && crossing.is_finite() {
                to = to.min(crossing);
            }
        }

        // It must be long enough, in the plane, and not run along a side.
        let middle = self.at(0.5 * (from + to));
        let is_inside = inwards().all(|(start, inward)| inward.dot(middle - start) > faces.on_plane());
        let is_in_plane = [from, to].iter().all(|&t| plane.height(self.at(t)).abs() <= faces.tolerance);
        if to - from <= faces.on_plane() || !is_inside || !is_in_plane {
            return;
        }
        let Some(inward) = facet.normal.cross(self.along).try_normalize() else { return };
        for inward in [inward, -inward] {
            let wing = Wing { plane: faces.scene.surface(surface).plane(), inward, width: facet.radius };
            stretches.push(Stretch { from, to, wing });
        }
    }
}

impl Wing {
    /// Whether two faces along one edge lie on the same side in the same plane.
    fn continues(&self, other: &Self) -> bool {
        self.plane == other.plane && self.inward.dot(other.inward) > 0.0
    }
}

fn same_wings(a: &[Wing], b: &[Wing]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.continues(b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Polygon;
    use crate::scene::{Material, Scene, Sides};

    fn welded_of(rectangles: &[[[f64; 3]; 3]]) -> Vec<Edge> {
        let polygon = |[corner, u, v]: &[[f64; 3]; 3]| {
            let at = |s: f64, t: f64| std::array::from_fn(|k| corner[k] + s * u[k] + t * v[k]);
            Polygon::new(&[at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)]).unwrap()
        };
        let grey = Material { name: "grey".to_owned(), reflectance: vec![0.5], exitance: vec![0.0] };
        let faces = rectangles.iter().zip(0..).map(|(rectangle, face)| (polygon(rectangle), 0, face)).collect();
        welded(&Faces::of(&Scene::new(1, vec![grey], faces, Sides::Front).unwrap()))
    }

    const CUBE: [[[f64; 3]; 3]; 6] = [
        [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]],
        [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        [[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]],
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]],
        [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]],
    ];

    #[test]
    fn a_cube_has_twelve_edges_however_its_faces_are_cut() {
        let whole = welded_of(&CUBE);
        assert!(whole.len() == 12 && whole.iter().all(|edge| edge.wings.len() == 2));
        // The top in three pieces that meet in a T, one side in two.
        let mut pieces = CUBE.to_vec();
        pieces[1] = [[0.0, 0.0, 1.0], [0.4, 0.0, 0.0], [0.0, 1.0, 0.0]];
        pieces.push([[0.4, 0.0, 1.0], [0.6, 0.0, 0.0], [0.0, 0.7, 0.0]]);
        pieces.push([[0.4, 0.7, 1.0], [0.6, 0.0, 0.0], [0.0, 0.3, 0.0]]);
        pieces[4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.3]];
        pieces.push([[0.0, 0.0, 0.3], [1.0, 0.0, 0.0], [0.0, 0.0, 0.7]]);
        let pieces = welded_of(&pieces);
        assert!(pieces.len() == 12 && pieces.iter().all(|edge| edge.wings.len() == 2), "{pieces:?}");
        let length: f64 = pieces.iter().map(|edge| edge.ends[0].distance(edge.ends[1])).sum();
        assert!((length - 12.0).abs() < 1e-12);
    }

    #[test]
    fn an_edge_is_a_silhouette_where_its_faces_lie_on_one_side() {
        let cube = welded_of(&CUBE);
        let vertical = cube.iter().find(|edge| edge.ends.iter().all(|end| end.x == 1.0 && end.y == 1.0)).unwrap();
        assert_eq!(vertical.shadow(DVec3::new(1.0, 1.0, 0.0).normalize(), 1e-5), Shadow::Behind);
        assert_eq!(vertical.shadow(DVec3::new(-1.0, -1.0, 0.0).normalize(), 1e-5), Shadow::InFront);
        assert_eq!(vertical.shadow(DVec3::new(1.0, -1.0, 0.0).normalize(), 1e-5), Shadow::Both);
        assert_eq!(vertical.shadow(DVec3::X, 1e-5), Shadow::Behind);
    }

    #[test]
    fn edges_on_a_face_end_nothing() {
        // The cube on a wide floor: the lower four are no edges of the outline, the floor has its own.
        let mut scene = CUBE.to_vec();
        scene.push([[-5.0, -5.0, 0.0], [10.0, 0.0, 0.0], [0.0, 10.0, 0.0]]);
        let edges = welded_of(&scene);
        assert_eq!(edges.len(), 8 + 4, "{edges:?}");
        assert!(edges.iter().all(|edge| edge.ends[0].distance(edge.ends[1]) > 0.5));
    }
}
