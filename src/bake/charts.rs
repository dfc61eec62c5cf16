//! Charts: faces that lie in one plane, face the same way, are of one material, and hang together.
//!
//! One material, since radiosity jumps where reflectance does. Faces hang together if one lies just beyond the middle of an edge of the other, which
//! holds where edges end in the middle of others, too.

use glam::{DVec2, DVec3};

use crate::geometry::{Aabb, Facet};
use crate::scene::{Scene, SurfaceId};
use crate::visibility::SurfaceBoxes;

/// A neighbour is looked for so many times the distance that counts as touching beyond an edge.
const BEYOND: f64 = 4.0;

/// Faces of a plane on a grid of texels, by right-handed coordinates: counter-clockwise is as seen from the front.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Chart {
    /// In their order.
    pub surfaces: Vec<SurfaceId>,
    /// Of all of them.
    pub material: u32,
    /// Where texels lie.
    pub grid: TexelGrid,
    /// Of a chart that a file lays out, what it holds: parts of surfaces, and the file's own triangles by number.
    pub of_file: Option<FileParts>,
    /// Columns and rows that hold all faces: numbers that may be larger than any page.
    pub extent: [f64; 2],
}

/// What a chart of a file holds.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FileParts {
    /// Convex parts of surfaces, counter-clockwise on the page, in texels of the chart.
    pub polygons: Vec<(SurfaceId, Vec<DVec2>)>,
    /// Numbers of triangles of the file, with the surface that each lies on first of all.
    pub triangles: Vec<(u32, SurfaceId)>,
}

/// Texels on a plane: parallelograms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TexelGrid {
    /// The corner of the first texel.
    pub origin: DVec3,
    /// From a column, and from a row, to the next.
    pub steps: [DVec3; 2],
    /// What tells columns and rows: 1 over its own step, 0 over the other.
    pub duals: [DVec3; 2],
}

impl TexelGrid {
    /// With these steps, which are not parallel.
    pub fn new(origin: DVec3, steps: [DVec3; 2]) -> Self {
        let [u, v] = steps;
        let (uu, uv, vv) = (u.dot(u), u.dot(v), v.dot(v));
        let duals = [vv * u - uv * v, uu * v - uv * u].map(|dual| dual / (uu * vv - uv * uv));
        Self { origin, steps, duals }
    }

    /// Coordinates of a point of the plane in texels.
    pub fn to_texels(self, point: DVec3) -> DVec2 {
        let from = point - self.origin;
        DVec2::new(self.duals[0].dot(from), self.duals[1].dot(from))
    }

    /// The point of the plane at coordinates in texels.
    pub fn to_space(self, at: DVec2) -> DVec3 {
        self.origin + at.x * self.steps[0] + at.y * self.steps[1]
    }

    /// The same, counted from a texel.
    pub fn counted_from(self, at: [u32; 2]) -> Self {
        Self { origin: self.to_space(DVec2::from(at.map(f64::from))), ..self }
    }
}

impl Chart {
    /// Coordinates of a point of the plane in texels.
    pub fn to_texels(&self, point: DVec3) -> DVec2 {
        self.grid.to_texels(point)
    }

    /// The point of the plane at coordinates in texels.
    pub fn to_space(&self, at: DVec2) -> DVec3 {
        self.grid.to_space(at)
    }

    /// The convex parts of surfaces that it holds, counter-clockwise, in texels.
    pub fn polygons(&self, scene: &Scene) -> Vec<(SurfaceId, Vec<DVec2>)> {
        let whole = |&surface: &SurfaceId| {
            (surface, scene.surface(surface).polygon.vertices().map(|vertex| self.to_texels(DVec3::from(vertex))).collect())
        };
        match &self.of_file {
            Some(parts) => parts.polygons.clone(),
            None => self.surfaces.iter().map(whole).collect(),
        }
    }

    /// Columns and rows.
    pub fn size(&self) -> [usize; 2] {
        self.extent.map(|count| count as usize)
    }

    /// The grid of some faces: along the longest edge of the largest, wider than high.
    fn of(scene: &Scene, surfaces: Vec<SurfaceId>, texel: f64) -> Self {
        let area = |surface: &SurfaceId| scene.surface(*surface).polygon.area();
        let largest = surfaces.iter().copied().reduce(|best, other| if area(&other) > area(&best) { other } else { best });
        let largest = largest.unwrap_or(surfaces[0]);
        let facet = scene.surface(largest).polygon.facet();
        let along = longest_edge(&facet);
        let along = (along - along.dot(facet.normal) * facet.normal).normalize();
        let mut axes = [along, facet.normal.cross(along)];

        // The rectangle around all faces, in metres from a corner of one.
        let start = facet.vertices[0];
        let corners = || surfaces.iter().flat_map(|&surface| scene.surface(surface).polygon.facet().vertices.to_vec());
        let bounds = |axis: DVec3| {
            let along = corners().map(|corner| axis.dot(corner - start));
            along.fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], x| [least.min(x), most.max(x)])
        };
        if bounds(axes[1])[1] - bounds(axes[1])[0] > bounds(axes[0])[1] - bounds(axes[0])[0] {
            axes = [axes[1], -axes[0]];
        }

        // Whole texels over it, with what they have too much on all sides alike. What rounding adds to a length adds no texel.
        const ROUNDING: f64 = 1e-6;
        let mut origin = start;
        let extent = axes.map(|axis| {
            let [least, most] = bounds(axis);
            let count = ((most - least) / texel - ROUNDING).ceil().max(1.0);
            origin += axis * (0.5 * (least + most) - 0.5 * count * texel);
            count
        });
        let material = scene.surface(largest).material;
        let grid = TexelGrid::new(origin, axes.map(|axis| texel * axis));
        Self { surfaces, material, grid, of_file: None, extent }
    }
}

/// From corner to corner; the first of equal ones.
fn longest_edge(facet: &Facet<'_>) -> DVec3 {
    let count = facet.vertices.len();
    let edge = |k: usize| facet.vertices[(k + 1) % count] - facet.vertices[k];
    // By what rounding leaves alone: equal edges of a square are equal.
    let is_longer = |edge: DVec3, best: DVec3| edge.length() > best.length() * (1.0 + 1e-9);
    (1..count).map(edge).fold(edge(0), |best, edge| if is_longer(edge, best) { edge } else { best })
}

/// The charts of the surfaces that are `chosen`, by their first surfaces.
pub(super) fn charts(scene: &Scene, chosen: &[bool], texel: f64) -> Vec<Chart> {
    let mut parent: Vec<u32> = (0..scene.surfaces().len() as u32).collect();
    let boxes = SurfaceBoxes::of(scene);
    let beyond = BEYOND * scene.contact_tolerance();
    for (number, surface) in scene.surfaces().iter().enumerate().filter(|(number, _)| chosen[*number]) {
        for_each_beyond(&surface.polygon.facet(), beyond, |point| {
            boxes.for_each_near(&Aabb::around([point - beyond, point + beyond]), |other| {
                if chosen[other.index()] && may_share(scene, SurfaceId(number as u32), other) {
                    let facet = scene.surface(other).polygon.facet();
                    if facet.contains(point - facet.height(point) * facet.normal) {
                        join(&mut parent, number as u32, other.0);
                    }
                }
            });
        });
    }

    // Each with all that hangs together with it.
    let mut of_first: Vec<Vec<SurfaceId>> = vec![Vec::new(); parent.len()];
    for number in (0..parent.len() as u32).filter(|&number| chosen[number as usize]) {
        of_first[root(&mut parent, number) as usize].push(SurfaceId(number));
    }
    of_first.into_iter().filter(|surfaces| !surfaces.is_empty()).map(|surfaces| Chart::of(scene, surfaces, texel)).collect()
}

/// Whether two surfaces may be parts of one chart.
fn may_share(scene: &Scene, one: SurfaceId, other: SurfaceId) -> bool {
    let (a, b) = (scene.surface(one), scene.surface(other));
    let faces_alike = || a.polygon.facet().normal.dot(b.polygon.facet().normal) > 0.0;
    one != other && a.plane() == b.plane() && a.material == b.material && faces_alike()
}

/// A point just beyond the middle of each edge.
fn for_each_beyond(facet: &Facet<'_>, beyond: f64, mut visit: impl FnMut(DVec3)) {
    let count = facet.vertices.len();
    for k in 0..count {
        let (a, b) = (facet.vertices[k], facet.vertices[(k + 1) % count]);
        let outward = (b - a).cross(facet.normal).normalize_or_zero();
        visit(0.5 * (a + b) + beyond * outward);
    }
}

/// The first of what hangs together with `number`; on the way everything is brought nearer to it.
fn root(parent: &mut [u32], mut number: u32) -> u32 {
    while parent[number as usize] != number {
        parent[number as usize] = parent[parent[number as usize] as usize];
        number = parent[number as usize];
    }
    number
}

fn join(parent: &mut [u32], one: u32, other: u32) {
    let (a, b) = (root(parent, one), root(parent, other));
    parent[a.max(b) as usize] = a.min(b);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Polygon;
    use crate::scene::{Material, Sides};

    fn rectangle([x, y, z]: [f64; 3], [width, height]: [f64; 2]) -> Polygon {
        Polygon::new(&[[x, y, z], [x + width, y, z], [x + width, y + height, z], [x, y + height, z]]).unwrap()
    }

    fn scene(faces: &[(Polygon, u32)]) -> Scene {
        let material = |name: &str| Material { name: name.to_owned(), reflectance: vec![0.5], exitance: vec![0.0] };
        let faces = faces.iter().zip(0..).map(|((polygon, material), face)| (polygon.clone(), *material, face)).collect();
        Scene::new(1, vec![material("a"), material("b")], faces, Sides::Front).unwrap()
    }

    #[test]
    fn faces_hang_together_along_parts_of_edges_but_not_at_corners_or_over_materials_or_planes() {
        let floor = rectangle([0.0, 0.0, 0.0], [2.0, 1.0]);
        let faces = [
            (floor.clone(), 0),
            // Beside its long edge, two short ones.
            (rectangle([0.0, 1.0, 0.0], [0.5, 1.0]), 0),
            (rectangle([1.5, 1.0, 0.0], [0.5, 1.0]), 0),
            // At a corner; of another material; higher; seen from below.
            (rectangle([2.0, 1.0, 0.0], [1.0, 1.0]), 0),
            (rectangle([2.0, 0.0, 0.0], [1.0, 0.5]), 1),
            (rectangle([0.0, -1.0, 0.1], [2.0, 1.0]), 0),
            (rectangle([0.0, -1.0, 0.0], [2.0, 1.0]).reversed(), 0),
        ];
        let scene = scene(&faces);
        let charts = charts(&scene, &[true; 7], 0.25);
        let surfaces: Vec<Vec<u32>> = charts.iter().map(|chart| chart.surfaces.iter().map(|id| id.0).collect()).collect();
        // The one at the corner touches face 2 along an edge.
        assert_eq!(surfaces, [vec![0, 1, 2, 3], vec![4], vec![5], vec![6]]);
        assert_eq!(charts[0].size(), [12, 8]);
    }

    #[test]
    fn a_chart_keeps_lengths_and_is_wider_than_high() {
        let scene = scene(&[(rectangle([0.3, 0.1, 0.0], [0.52, 1.93]), 0)]);
        let chart = &charts(&scene, &[true], 0.1)[0];
        assert_eq!(chart.size(), [20, 6]);
        assert!((chart.grid.steps[0].cross(chart.grid.steps[1]) / 0.01).distance(DVec3::Z) < 1e-13);
        let facet = scene.surface(SurfaceId(0)).polygon.facet();
        for &vertex in facet.vertices {
            let at = chart.to_texels(vertex);
            assert!(at.cmpge(DVec2::ZERO).all() && at.cmple(DVec2::new(20.0, 6.0)).all(), "{at}");
            assert!(chart.to_space(at).distance(vertex) < 1e-12);
        }
        let [a, b] = [0, 2].map(|k| chart.to_texels(facet.vertices[k]));
        assert!((a.distance(b) * 0.1 - facet.vertices[0].distance(facet.vertices[2])).abs() < 1e-12);
    }
}
