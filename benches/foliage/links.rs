//! The links that are looked at: samples of their lines, and how much really passes.

use patchlight::geometry::Polygon;
use patchlight::hierarchy::{Hierarchy, NodeId};
use patchlight::scene::{Scene, Sides, Surface, SurfaceId};
use patchlight::solve::Solution;
use patchlight::visibility::{Segment, Visibility};

use crate::triangles::{Random, add, cross, dot, spread, sub, times};

/// As many links are looked at, spread evenly over all.
pub const MOST_LINKS: usize = 3000;

/// Rays of the reference.
const REFERENCE: usize = 4096;

/// A link that meets something: not all of its rays arrive, and some do.
pub struct Crossing {
    pub pair: [NodeId; 2],
    /// Lines between the nodes, with kernel values.
    pub lines: Vec<(Segment, f64)>,
    /// The part that passes, by other lines.
    pub passes: f64,
}

/// Lines that methods may take.
pub const LINES: usize = 256;

/// The links of a solution.
pub fn of_solution(solution: &Solution) -> Vec<[NodeId; 2]> {
    solution.links().iter().map(|(receiver, link)| [receiver, link.source]).collect()
}

/// The scene with lawn and sky in tiles, and all pairs of a tile of the lawn, about 1 m^2 large, and one of the sky, some m^2 large: beams that are
/// wide against leaves.
pub fn tiled(scene: &Scene) -> Scene {
    let tiles_of = |surface: &Surface| match scene.materials()[surface.material as usize].name.as_str() {
        "lawn" => 16,
        "sky" => 4,
        _ => 1,
    };
    let mut faces = Vec::new();
    for surface in scene.surfaces() {
        let corners: Vec<[f64; 3]> = surface.polygon.vertices().collect();
        let tiles = if corners.len() == 4 { tiles_of(surface) } else { 1 };
        if tiles == 1 {
            faces.push((surface.polygon.clone(), surface.material, surface.face));
            continue;
        }
        let (u, v) = (sub(corners[1], corners[0]), sub(corners[3], corners[0]));
        let at = |i: i32, j: i32| {
            let part = |k: i32| f64::from(k) / f64::from(tiles);
            add(corners[0], add(times(u, part(i)), times(v, part(j))))
        };
        for (i, j) in (0..tiles).flat_map(|i| (0..tiles).map(move |j| (i, j))) {
            let tile = Polygon::new(&[at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]).expect("a tile");
            faces.push((tile, surface.material, surface.face));
        }
    }
    Scene::new(scene.channels(), scene.materials().to_vec(), faces, Sides::Front).expect("a scene")
}

/// All pairs of a surface of the lawn and one of the sky.
pub fn of_lawn_and_sky(scene: &Scene) -> Vec<[SurfaceId; 2]> {
    let of_material = |material: &str| -> Vec<SurfaceId> {
        (0..scene.surfaces().len() as u32).map(SurfaceId).filter(|&id| scene.material_of(id).name == material).collect()
    };
    let (lawn, sky) = (of_material("lawn"), of_material("sky"));
    lawn.iter().flat_map(|&receiver| sky.iter().map(move |&source| [receiver, source])).collect()
}

impl Crossing {
    /// Those among some pairs.
    pub fn of(scene: &Scene, hierarchy: &Hierarchy, all: &[[NodeId; 2]], visibility: &dyn Visibility) -> Vec<Self> {
        let stride = (all.len() / MOST_LINKS).max(1);
        let crossing = |(index, &pair): (usize, &[NodeId; 2])| {
            let mut random = Random(index as u64);
            let few = drawn(scene, hierarchy, pair, 64, &mut random);
            if !(0.01..0.99).contains(&passing(&few, visibility)) {
                return None;
            }
            let reference = drawn(scene, hierarchy, pair, REFERENCE, &mut random);
            let lines = drawn(scene, hierarchy, pair, LINES, &mut random);
            Some(Self { pair, lines, passes: passing(&reference, visibility) })
        };
        all.iter().step_by(stride).enumerate().filter_map(crossing).collect()
    }
}

/// The part that passes by rays, weighted by the kernel.
pub fn passing(lines: &[(Segment, f64)], visibility: &dyn Visibility) -> f64 {
    let segments: Vec<Segment> = lines.iter().map(|line| line.0).collect();
    let mut occluded = vec![false; segments.len()];
    visibility.occluded(&segments, &mut occluded);
    weighted(lines, occluded.iter().map(|&occluded| f64::from(u8::from(!occluded))))
}

/// The mean of what passes along lines, weighted by the kernel; nothing is blocked where there is none.
pub fn weighted(lines: &[(Segment, f64)], passes: impl Iterator<Item = f64>) -> f64 {
    let total: f64 = lines.iter().map(|line| line.1).sum();
    let sum: f64 = lines.iter().zip(passes).map(|(line, passes)| line.1 * passes).sum();
    if total > 0.0 { sum / total } else { 1.0 }
}

/// Lines between two nodes that look at each other, up to so many: evenly spread, from a random start.
fn drawn(scene: &Scene, hierarchy: &Hierarchy, pair: [NodeId; 2], count: usize, random: &mut Random) -> Vec<(Segment, f64)> {
    let start = std::array::from_fn(|_| random.unit());
    let mut lines = Vec::with_capacity(count);
    for index in 0..8 * count {
        let [u, v, s, t] = spread(start, index);
        let [(x, receiver), (y, source)] = [point_of(hierarchy, pair[0], [u, v]), point_of(hierarchy, pair[1], [s, t])];
        let way = sub(y, x);
        let length_sq = dot(way, way);
        let surfaces = [receiver, source].map(|leaf| hierarchy.surface_of(leaf).expect("a surface"));
        let normal = |surface: SurfaceId| scene.surface(surface).polygon.normal();
        let (cosine, other) = (dot(normal(surfaces[0]), way), -dot(normal(surfaces[1]), way));
        if cosine > 0.0 && other > 0.0 {
            let [from_plane, to_plane] = surfaces.map(|surface| scene.surface(surface).plane());
            lines.push((Segment { from: x, to: y, from_plane, to_plane }, cosine * other / (length_sq * length_sq)));
        }
        if lines.len() == count {
            break;
        }
    }
    lines
}

/// A point of a node, and the leaf that it is on; uniform `(u, v)` give points uniform by area.
fn point_of(hierarchy: &Hierarchy, mut node: NodeId, [mut u, v]: [f64; 2]) -> ([f64; 3], NodeId) {
    while hierarchy.surface_of(node).is_none() {
        let children: Vec<NodeId> = hierarchy.children(node).collect();
        let areas: Vec<f64> = children.iter().map(|&child| hierarchy.area(child)).collect();
        let child;
        (child, u) = share(&areas, u);
        node = children[child];
    }

    // A triangle of the fan by its area, and a point of it.
    let polygon = hierarchy.polygon(node);
    let sides = |k: usize| [sub(polygon[k + 1], polygon[0]), sub(polygon[k + 2], polygon[0])];
    let area = |k: usize| {
        let [a, b] = sides(k);
        let normal = cross(a, b);
        dot(normal, normal).sqrt()
    };
    let areas: Vec<f64> = (0..polygon.len() - 2).map(area).collect();
    let (triangle, u) = share(&areas, u);
    let root = u.sqrt();
    let [a, b] = sides(triangle);
    (add(polygon[0], add(times(a, root * (1.0 - v)), times(b, root * v))), node)
}

/// Which of some areas a part of their sum falls into, and where in it, 0 to 1.
fn share(areas: &[f64], part: f64) -> (usize, f64) {
    let mut left = part * areas.iter().sum::<f64>();
    for (index, area) in areas.iter().enumerate() {
        if left <= *area || index + 1 == areas.len() {
            return (index, (left / area).clamp(0.0, 1.0));
        }
        left -= area;
    }
    (0, part)
}
