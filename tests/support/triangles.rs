//! Triangle meshes and random numbers for the tests and benches of visibility.
#![allow(dead_code, reason = "each test and bench uses a part")]

use patchlight::visibility::{NO_PLANE, OccluderMesh, Segment};

/// SplitMix64 (Steele, Lea, Flood 2014): a seed gives the same numbers everywhere.
pub struct Random(pub u64);

impl Random {
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// In [0, 1).
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    pub fn below(&mut self, count: usize) -> usize {
        (self.bits() % count as u64) as usize
    }

    /// In the cube of half side `half` around 0.
    pub fn point(&mut self, half: f64) -> [f64; 3] {
        std::array::from_fn(|_| self.between(-half, half))
    }

    /// On the unit sphere.
    pub fn direction(&mut self) -> [f64; 3] {
        loop {
            let v = self.point(1.0);
            let length = dot(v, v).sqrt();
            if length > 0.1 && length < 1.0 {
                return v.map(|x| x / length);
            }
        }
    }
}

/// Evenly spread points of the unit cube of four dimensions, one for each index, by additive recurrence with the generalised golden ratio (Roberts 2018).
pub fn spread(start: [f64; 4], index: usize) -> [f64; 4] {
    const RATIO: f64 = 1.167_303_978_261_418_7;
    std::array::from_fn(|axis| (start[axis] + index as f64 * RATIO.powi(-1 - axis as i32)).fract())
}

pub fn add(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| a[k] + b[k])
}

pub fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| a[k] - b[k])
}

pub fn times(a: [f64; 3], factor: f64) -> [f64; 3] {
    a.map(|x| x * factor)
}

pub fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub fn unit(a: [f64; 3]) -> [f64; 3] {
    times(a, 1.0 / dot(a, a).sqrt())
}

/// A segment between points on no surface.
pub fn segment(from: [f64; 3], to: [f64; 3]) -> Segment {
    Segment { from, to, from_plane: NO_PLANE, to_plane: NO_PLANE }
}

/// Appends a triangle with a surface and a plane of its own.
pub fn push_triangle(mesh: &mut OccluderMesh, corners: [[f64; 3]; 3]) {
    let (vertex, id) = (mesh.vertices.len() as u32, mesh.triangles.len() as u32);
    mesh.vertices.extend(corners);
    mesh.triangles.push([vertex, vertex + 1, vertex + 2]);
    mesh.surfaces.push(id);
    mesh.planes.push(id);
}

/// Appends the parallelogram at `corner` with sides `u` and `v`: two triangles of one surface and one plane.
pub fn push_quad(mesh: &mut OccluderMesh, corner: [f64; 3], u: [f64; 3], v: [f64; 3], surface: u32, plane: u32) {
    let first = mesh.vertices.len() as u32;
    mesh.vertices.extend([corner, add(corner, u), add(add(corner, u), v), add(corner, v)]);
    for triangle in [[0, 1, 2], [0, 2, 3]] {
        mesh.triangles.push(triangle.map(|k| first + k));
        mesh.surfaces.push(surface);
        mesh.planes.push(plane);
    }
}

/// Appends a sphere of 2 `rings` (`rings` - 1) x 2 triangles that share vertices, each with a surface and a plane of its own.
pub fn push_sphere(mesh: &mut OccluderMesh, centre: [f64; 3], radius: f64, rings: u32) {
    let first = mesh.vertices.len() as u32;
    let around = 2 * rings;
    for ring in 0..=rings {
        let polar = std::f64::consts::PI * f64::from(ring) / f64::from(rings);
        for step in 0..around {
            let azimuth = std::f64::consts::TAU * f64::from(step) / f64::from(around);
            // The poles are one point each, whatever the azimuth.
            let sine = if ring == 0 || ring == rings { 0.0 } else { polar.sin() };
            let direction = [sine * azimuth.cos(), sine * azimuth.sin(), polar.cos()];
            mesh.vertices.push(add(centre, times(direction, radius)));
        }
    }
    for ring in 0..rings {
        for step in 0..around {
            let next = (step + 1) % around;
            let [a, b, c, d] =
                [(ring, step), (ring + 1, step), (ring + 1, next), (ring, next)].map(|(r, s)| first + r * around + s);
            for (triangle, degenerate) in [([a, b, c], ring + 1 == rings), ([a, c, d], ring == 0)] {
                if !degenerate {
                    let id = mesh.triangles.len() as u32;
                    mesh.triangles.push(triangle);
                    mesh.surfaces.push(id);
                    mesh.planes.push(id);
                }
            }
        }
    }
}

/// Appends the box with the corners `low` and `high`: six surfaces, six planes, numbered from `id`.
pub fn push_box(mesh: &mut OccluderMesh, low: [f64; 3], high: [f64; 3], id: u32) {
    for axis in 0..3 {
        let size = sub(high, low);
        let side = |k: usize| std::array::from_fn(|axis| if axis == k { size[k] } else { 0.0 });
        let (u, v) = (side((axis + 1) % 3), side((axis + 2) % 3));
        let id = id + 2 * axis as u32;
        push_quad(mesh, low, u, v, id, id);
        push_quad(mesh, add(low, side(axis)), u, v, id + 1, id + 1);
    }
}

/// `count` random triangles in the cube of half side 1, with sides of about `size`.
pub fn soup(random: &mut Random, count: usize, size: f64) -> OccluderMesh {
    let mut mesh = OccluderMesh::default();
    for _ in 0..count {
        let corner = random.point(1.0);
        push_triangle(&mut mesh, [corner, add(corner, random.point(size)), add(corner, random.point(size))]);
    }
    mesh
}

/// The mesh scaled by `scale` about 0, then moved by `offset`.
pub fn placed(mesh: &OccluderMesh, scale: f64, offset: [f64; 3]) -> OccluderMesh {
    let vertices = mesh.vertices.iter().map(|&vertex| add(times(vertex, scale), offset)).collect();
    OccluderMesh { vertices, ..mesh.clone() }
}

/// A point of a triangle, uniform by area.
pub fn point_on(mesh: &OccluderMesh, triangle: usize, random: &mut Random) -> [f64; 3] {
    let [a, b, c] = mesh.triangles[triangle].map(|vertex| mesh.vertices[vertex as usize]);
    let (mut u, mut v) = (random.unit(), random.unit());
    if u + v > 1.0 {
        (u, v) = (1.0 - u, 1.0 - v);
    }
    std::array::from_fn(|k| a[k] + u * (b[k] - a[k]) + v * (c[k] - a[k]))
}
