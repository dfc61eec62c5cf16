//! Which elements see fronts alone, in every direction: their form factors add up to 1.
//!
//! Follow a ray from p to infinity, and let w(p) be the number of surfaces that it meets from the front, less those that it meets from
//! the back. Over surfaces that close up edge by edge w is the same for every ray from p. If w is nowhere more than 1, a ray that starts
//! where it is 1 meets a front first: behind a back w would be 2. That is proved for one convex room with convex solids in it, where w is 1
//! in the room, and one less in each solid. Any other scene counts as open, and so does an element with something standing on it.

use std::collections::HashMap;

use glam::DVec3;

use crate::geometry::{Aabb, Facet};
use crate::scene::{Scene, SurfaceId};

/// A vertex lies in a plane if it is no farther from it than this part of the size of the scene.
const CONTACT_OF_SIZE: f64 = 1e-12;

/// A room with solids in it.
pub(super) struct Enclosure<'a> {
    scene: &'a Scene,
    /// The closed body that each surface is a part of.
    body_of: Vec<usize>,
    bodies: Vec<Body>,
    room: usize,
    tolerance: f64,
    gap: f64,
}

/// Surfaces that close up edge by edge.
struct Body {
    surfaces: Vec<SurfaceId>,
    bounds: Aabb,
}

impl<'a> Enclosure<'a> {
    /// Finds the room and the solids; `None` if the scene is not made like that.
    pub fn find(scene: &'a Scene) -> Option<Self> {
        let tolerance = CONTACT_OF_SIZE * scene.bounds().diagonal();
        let (body_of, gap) = closed_bodies(scene, tolerance)?;
        let count = body_of.iter().max().map_or(0, |most| most + 1);
        let mut bodies: Vec<Body> = (0..count).map(|_| Body { surfaces: Vec::new(), bounds: Aabb::EMPTY }).collect();
        for (index, &body) in body_of.iter().enumerate() {
            let surface = SurfaceId(index as u32);
            bodies[body].surfaces.push(surface);
            bodies[body].bounds = bodies[body].bounds.union(scene.surface(surface).polygon.bounds());
        }

        // One body is convex seen from inside, all others from outside.
        let all_heights = |body: &Body, fits: &dyn Fn(f64) -> bool| {
            let vertices = || body.surfaces.iter().flat_map(|&other| scene.surface(other).polygon.facet().vertices);
            body.surfaces.iter().all(|&surface| {
                let front = scene.surface(surface).polygon.facet();
                vertices().all(|&vertex| fits(front.height(vertex)))
            })
        };
        let mut room = None;
        for (index, body) in bodies.iter().enumerate() {
            let (inward, outward) =
                (all_heights(body, &|height| height >= -tolerance), all_heights(body, &|height| height <= tolerance));
            match (inward, outward, room) {
                (true, false, None) => room = Some(index),
                (false, true, _) => {}
                // Sheets have two sides and no inside.
                (true, true, _) => {}
                _ => return None,
            }
        }
        let room = room?;
        Some(Self { scene, body_of, bodies, room, tolerance, gap })
    }

    /// Whether all points just in front of an element of `surface` are in the room and in no solid.
    pub fn holds(&self, surface: SurfaceId, element: &Facet<'_>) -> bool {
        let own = self.body_of[surface.index()];
        let is_sheet = |body: &Body| body.surfaces.len() == 2;
        (0..self.bodies.len()).filter(|&body| body != own).all(|index| {
            let body = &self.bodies[index];
            let mut faces = body.surfaces.iter().map(|&face| self.scene.surface(face).polygon.facet());
            if index == self.room {
                faces.all(|face| self.is_in_front(element, &face))
            } else {
                is_sheet(body) || self.is_beside(element, &body.bounds) || faces.any(|face| self.is_in_front(element, &face))
            }
        })
    }

    /// Whether what is just in front of an element is in front of a face's plane.
    fn is_in_front(&self, element: &Facet<'_>, face: &Facet<'_>) -> bool {
        let heights = element.vertices.iter().map(|&vertex| face.height(vertex));
        let [low, high] =
            heights.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], height| [low.min(height), high.max(height)]);
        low >= -self.tolerance && (high > self.tolerance || face.normal.dot(element.normal) > 0.0)
    }

    fn is_beside(&self, element: &Facet<'_>, bounds: &Aabb) -> bool {
        let own = Aabb::around(element.vertices.iter().copied());
        own.min.cmpgt(bounds.max + self.tolerance).any() || own.max.cmplt(bounds.min - self.tolerance).any()
    }
}

/// How far apart vertices are, in metres, that are taken for one so that a scene is closed; `None` if it is not.
pub(super) fn closed_gap(scene: &Scene) -> Option<f64> {
    Enclosure::find(scene).map(|enclosure| enclosure.gap)
}

/// The number of the closed body of each surface. A body is made of surfaces that share edges, each edge traversed once in either direction;
/// `None` if an edge is left over.
/// And the largest distance between vertices that count as one.
fn closed_bodies(scene: &Scene, tolerance: f64) -> Option<(Vec<usize>, f64)> {
    let count = scene.surfaces().len();
    let mut corners = Corners { tolerance, gap: 0.0, known: Vec::new(), cells: HashMap::new() };
    let numbers: Vec<Vec<usize>> = (scene.surfaces().iter())
        .map(|surface| surface.polygon.facet().vertices.iter().map(|&vertex| corners.find_or_add(vertex)).collect())
        .collect();
    let edges = |surface: usize| {
        let corners = &numbers[surface];
        (0..corners.len()).map(|k| (corners[k], corners[if k + 1 == corners.len() { 0 } else { k + 1 }]))
    };
    let mut by_edge = HashMap::new();
    for surface in 0..count {
        for edge in edges(surface) {
            if by_edge.insert(edge, surface).is_some() {
                return None;
            }
        }
    }

    // Bodies: what is connected over shared edges.
    let mut body_of = vec![usize::MAX; count];
    let mut next = 0;
    for start in 0..count {
        if body_of[start] != usize::MAX {
            continue;
        }
        let mut stack = vec![start];
        body_of[start] = next;
        while let Some(surface) = stack.pop() {
            for (a, b) in edges(surface) {
                let &neighbour = by_edge.get(&(b, a))?;
                if body_of[neighbour] == usize::MAX {
                    body_of[neighbour] = next;
                    stack.push(neighbour);
                }
            }
        }
        next += 1;
    }
    Some((body_of, corners.gap))
}

/// Numbers vertices; those within the tolerance of each other count as one.
struct Corners {
    tolerance: f64,
    gap: f64,
    known: Vec<DVec3>,
    cells: HashMap<[i64; 3], Vec<usize>>,
}

impl Corners {
    fn find_or_add(&mut self, vertex: DVec3) -> usize {
        // Cells are a few tolerances wide: what is within the tolerance lies in the cells that the tolerance reaches.
        let cell = |v: DVec3| v.to_array().map(|x| (x / (4.0 * self.tolerance)).floor() as i64);
        let (low, high) = (cell(vertex - self.tolerance), cell(vertex + self.tolerance));
        for x in low[0]..=high[0] {
            for y in low[1]..=high[1] {
                for z in low[2]..=high[2] {
                    let near = self.cells.get(&[x, y, z]).into_iter().flatten();
                    if let Some(&found) = near.into_iter().find(|&&known| self.known[known].distance(vertex) <= self.tolerance) {
                        self.gap = self.gap.max(self.known[found].distance(vertex));
                        return found;
                    }
                }
            }
        }
        let own = cell(vertex);
        self.cells.entry(own).or_default().push(self.known.len());
        self.known.push(vertex);
        self.known.len() - 1
    }
}
