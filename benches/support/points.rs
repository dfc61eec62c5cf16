//! Points of scenes, and values at them, in CSV files.
#![allow(dead_code, reason = "each bench uses a part")]

use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::path::Path;

use patchlight::scene::{Material, Scene, SurfaceId, SurfacePoint};
use patchlight::visibility::{Backend, OccluderMesh, Ray, build};

use crate::triangles::{Random, cross, dot, sub};

/// Rays that tell whether a point is covered.
const RAYS: usize = 32;

/// Points that are left out, by how many of the rays from them meet backs of faces.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum LeftOut {
    /// Any, the second side of a sheet being one too: also points that lie near the edge of what covers them.
    AnyBack,
    /// All: points inside of solids alone.
    AllBacks,
}

/// Points uniform by area on the materials that are `wanted`, each with its surface.
pub fn spread(
    scene: &Scene,
    wanted: impl Fn(&Material) -> bool,
    left_out: LeftOut,
    count: usize,
    seed: u64,
) -> Vec<(SurfaceId, SurfacePoint)> {
    let visibility = build(Backend::Obvhs, &OccluderMesh::of_scene(scene)).expect("the backend of every build");
    let mut random = Random(seed);
    let mut below = Vec::new();
    let mut total = 0.0;
    for id in (0..scene.surfaces().len() as u32).map(SurfaceId).filter(|&id| wanted(scene.material_of(id))) {
        total += scene.surface(id).polygon.area();
        below.push((total, id));
    }

    let mut points = Vec::with_capacity(count);
    let mut hits = vec![None; RAYS];
    while points.len() < count {
        let drawn = total * random.unit();
        let id = below[below.partition_point(|(area, _)| *area <= drawn).min(below.len() - 1)].1;
        let surface = scene.surface(id);
        let normal = surface.polygon.normal();
        let Some(position) = point_of(&surface.polygon.vertices().collect::<Vec<_>>(), normal, &mut random) else {
            continue;
        };
        let rays: Vec<Ray> = (0..RAYS)
            .map(|_| Ray { origin: position, direction: cosine(normal, &mut random), origin_plane: surface.plane() })
            .collect();
        visibility.first_hits(&rays, &mut hits);
        let meets_back = |ray: &Ray, surface: u32| {
            let met = scene.surface(SurfaceId(surface));
            dot(met.polygon.normal(), ray.direction) > 0.0 && (left_out == LeftOut::AnyBack || met.twin().is_none())
        };
        let mut backs = rays.iter().zip(&hits).map(|(ray, hit)| hit.is_some_and(|hit| meets_back(ray, hit.surface)));
        let is_left_out = if left_out == LeftOut::AnyBack { backs.any(|back| back) } else { backs.all(|back| back) };
        if !is_left_out {
            points.push((id, SurfacePoint { position, normal }));
        }
    }
    points
}

/// A point of a convex polygon.
fn point_of(corners: &[[f64; 3]], normal: [f64; 3], random: &mut Random) -> Option<[f64; 3]> {
    // A parallelogram over each triangle of the fan, of which half is used: uniform, as triangles are drawn by area.
    let area = |k: usize| dot(cross(sub(corners[k], corners[0]), sub(corners[k + 1], corners[0])), normal);
    let total: f64 = (1..corners.len() - 1).map(area).sum();
    let mut drawn = total * random.unit();
    let k = (1..corners.len() - 1).find(|&k| {
        drawn -= area(k);
        drawn < 0.0
    })?;
    let (mut s, mut t) = (random.unit(), random.unit());
    if s + t > 1.0 {
        (s, t) = (1.0 - s, 1.0 - t);
    }
    let (u, v) = (sub(corners[k], corners[0]), sub(corners[k + 1], corners[0]));
    Some(std::array::from_fn(|axis| corners[0][axis] + s * u[axis] + t * v[axis]))
}

/// A direction by the cosine.
fn cosine(normal: [f64; 3], random: &mut Random) -> [f64; 3] {
    // A point of the unit sphere that touches the plane.
    let (height, angle) = (2.0 * random.unit() - 1.0, TAU * random.unit());
    let radius = (1.0 - height * height).sqrt();
    let sphere = [radius * angle.cos(), radius * angle.sin(), height];
    std::array::from_fn(|k| normal[k] * (1.0 + 1e-9) + sphere[k])
}

/// Writes points as the program reads them.
pub fn write_points<'a>(file: &Path, points: impl Iterator<Item = &'a SurfacePoint>) {
    let mut text = String::from("x,y,z,nx,ny,nz\n");
    for SurfacePoint { position: [x, y, z], normal: [nx, ny, nz] } in points {
        let _ = writeln!(text, "{x},{y},{z},{nx},{ny},{nz}");
    }
    std::fs::write(file, text).expect("points are written");
}

/// Radiosities by point from a CSV file with a header; not numbers where there are none.
pub fn read_values(file: &Path) -> Vec<[f64; 3]> {
    let mut reader = csv::Reader::from_path(file).expect("values were written");
    let names = reader.headers().expect("a header").clone();
    let column = |name: &str| names.iter().position(|other| other == name).expect("a column for each channel");
    let columns = ["B_r", "B_g", "B_b"].map(column);
    let rows = reader.records().map(|row| row.expect("a row of values"));
    rows.map(|row| columns.map(|column| row[column].parse().unwrap_or(f64::NAN))).collect()
}
