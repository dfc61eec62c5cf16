//! In which triangle of a surface a point lies: a grid of cells, each with the triangles that reach into it.

use glam::DVec2;

use super::element::barycentric;
use super::surface_mesh::SurfaceMesh;

/// Cells for each triangle.
const CELLS: f64 = 4.0;

/// Triangles lie in so many cells each on average, at most; else there are fewer cells by this factor.
const MOST_ENTRIES: usize = 32;
const COARSER: f64 = 0.25;

/// Finds triangles by points.
#[derive(Clone)]
pub(super) struct Locator {
    origin: DVec2,
    /// Cells per metre, and how many there are.
    scale: DVec2,
    size: [usize; 2],
    /// By cell, where its triangles begin; and one more.
    starts: Vec<u32>,
    triangles: Vec<u32>,
}

impl Locator {
    pub fn new(mesh: &SurfaceMesh) -> Self {
        // A grid of about square cells over the box of all nodes: coarser where long triangles would lie in too many of them.
        let (min, max) =
            mesh.nodes().iter().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(min, max), &at| (min.min(at), max.max(at)));
        let extent = (max - min).max(DVec2::splat(f64::MIN_POSITIVE));
        let triangles = mesh.triangles().len();
        let mut cells = CELLS * triangles as f64;
        let mut locator = Self::grid(min, extent, cells);
        while cells > 1.0 && locator.entries(mesh) > MOST_ENTRIES * triangles {
            cells *= COARSER;
            locator = Self::grid(min, extent, cells);
        }

        // Count the triangles of each cell, then fill them in.
        for triangle in 0..mesh.triangles().len() {
            locator.cells_of(mesh.corners(triangle)).for_each(|cell| locator.starts[cell + 1] += 1);
        }
        (1..locator.starts.len()).for_each(|cell| locator.starts[cell] += locator.starts[cell - 1]);
        locator.triangles = vec![0; locator.starts.last().map_or(0, |&count| count as usize)];
        let mut next = locator.starts.clone();
        for triangle in 0..mesh.triangles().len() {
            for cell in locator.cells_of(mesh.corners(triangle)) {
                locator.triangles[next[cell] as usize] = triangle as u32;
                next[cell] += 1;
            }
        }
        locator
    }

    /// A grid of about so many cells, one at least, with nothing in them.
    fn grid(origin: DVec2, extent: DVec2, cells: f64) -> Self {
        let cells = cells.max(1.0);
        let side = (extent.x * extent.y / cells).sqrt().max(extent.max_element() / cells);
        let size = [extent.x, extent.y].map(|extent| ((extent / side).ceil() as usize).max(1));
        let scale = DVec2::new(size[0] as f64, size[1] as f64) / extent;
        Self { origin, scale, size, starts: vec![0; size[0] * size[1] + 1], triangles: Vec::new() }
    }

    /// In how many cells triangles lie, added.
    fn entries(&self, mesh: &SurfaceMesh) -> usize {
        let cells_of = |triangle: usize| {
            let [[from_x, from_y], [to_x, to_y]] = self.range_of(mesh.corners(triangle));
            (to_x - from_x + 1) * (to_y - from_y + 1)
        };
        (0..mesh.triangles().len()).map(cells_of).sum()
    }

    /// The first and the last cell that the box of a triangle meets.
    fn range_of(&self, [a, b, c]: [DVec2; 3]) -> [[usize; 2]; 2] {
        [self.cell(a.min(b).min(c)), self.cell(a.max(b).max(c))]
    }

    /// The cells that the box of a triangle meets.
    fn cells_of(&self, corners: [DVec2; 3]) -> impl Iterator<Item = usize> + use<> {
        let ([[from_x, from_y], [to_x, to_y]], width) = (self.range_of(corners), self.size[0]);
        (from_y..=to_y).flat_map(move |row| (from_x..=to_x).map(move |column| row * width + column))
    }

    /// Column and row of the cell nearest to a point.
    fn cell(&self, at: DVec2) -> [usize; 2] {
        let cell = (at - self.origin) * self.scale;
        [(cell.x.max(0.0) as usize).min(self.size[0] - 1), (cell.y.max(0.0) as usize).min(self.size[1] - 1)]
    }

    /// The triangle that a point lies in, or nearest to of those around, and its barycentric coordinates there, within the triangle.
    pub fn find(&self, mesh: &SurfaceMesh, at: DVec2) -> Option<(usize, [f64; 3])> {
        let [column, row] = self.cell(at);
        let cell = row * self.size[0] + column;
        let around = &self.triangles[self.starts[cell] as usize..self.starts[cell + 1] as usize];
        let mut best: Option<(f64, usize, [f64; 3])> = None;
        for &triangle in around {
            let coordinates = barycentric(mesh.corners(triangle as usize), at);
            let least = coordinates.iter().copied().fold(f64::INFINITY, f64::min);
            if best.is_none_or(|(other, ..)| least > other) {
                best = Some((least, triangle as usize, coordinates));
            }
            if least >= 0.0 {
                break;
            }
        }
        best.map(|(_, triangle, coordinates)| {
            let inside = coordinates.map(|l| l.max(0.0));
            let sum: f64 = inside.iter().sum();
            (triangle, inside.map(|l| l / sum))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::sampling;
    use crate::mesh::bends::Bends;
    use crate::mesh::triangulation::triangulate;

    /// Strips across a square, from corner to corner: each meets all cells of a fine grid by its box.
    #[test]
    fn long_triangles_take_no_more_memory() {
        let count = 2000_u32;
        let at = |k: u32, side: f64| DVec2::new(side + f64::from(k) / f64::from(count), side);
        let nodes: Vec<DVec2> = (0..count).flat_map(|k| [at(k, 0.0), at(k + 1, 0.0), at(k, 1.0)]).collect();
        let triangles: Vec<[u32; 6]> = (0..count).map(|k| [0, 1, 2, 0, 1, 2].map(|corner| 3 * k + corner)).collect();
        let mesh = serde_json::json!({ "nodes": nodes, "triangles": triangles, "reflected": vec![0.0; nodes.len()], "errors": [] });
        let mesh: SurfaceMesh = serde_json::from_value(mesh).unwrap();
        let locator = Locator::new(&mesh);
        assert!(locator.triangles.len() <= MOST_ENTRIES * count as usize, "{}", locator.triangles.len());
        assert!(locator.find(&mesh, at(77, 0.5)).is_some());
    }

    #[test]
    fn every_point_is_found_in_a_triangle_around_it() {
        for size in [DVec2::new(2.0, 1.5), DVec2::new(3.0, 1e-3)] {
            let corner = |x: f64, y: f64| DVec2::new(x, y) * size;
            let polygon = [corner(-0.5, -0.5), corner(0.5, -0.5), corner(0.5, 0.5), corner(-0.5, 0.5)];
            let mut triangles = triangulate(&polygon, &[], 0.02 * size.x * size.y, 0.0);
            (0..300).for_each(|step| triangles.bisect(step * 7 % triangles.triangles.len() as u32, &mut Bends::unknown()));
            let linear: Vec<f32> = triangles.nodes.iter().map(|node| (1.0 + 0.3 * node.at.x) as f32).collect();
            let mesh = SurfaceMesh::new(&triangles, linear);
            let locator = Locator::new(&mesh);
            for number in 0..2000 {
                let random = |k: u64| sampling::unit(sampling::hash(number, k)) - 0.5;
                let at = corner(random(0), random(1));
                let (triangle, coordinates) = locator.find(&mesh, at).unwrap();
                let found: DVec2 = mesh.corners(triangle).iter().zip(coordinates).map(|(&corner, l)| l * corner).sum();
                assert!(found.distance(at) < 1e-9, "{at} found at {found}");
                let mut value = [0.0];
                mesh.reflected_at(triangle, coordinates, &mut value);
                assert!((value[0] - (1.0 + 0.3 * at.x)).abs() < 1e-6);
            }
        }
    }
}
