//! Lightmaps: held against furnaces, Lambert's formula, gathers and the lit mesh; what lies where; nothing leaks.

#[path = "../support/rooms.rs"]
mod rooms;
#[path = "../support/triangles.rs"]
mod triangles;

#[path = "../support/glb.rs"]
mod glb;

mod again;
mod file_uv;
mod files;
mod layout;
mod light;
mod limits;
mod separate;
mod vertices;

use std::f64::consts::PI;

use patchlight::bake::{Atlas, BakeOptions, FaceOnAtlas, Lightmap};
use patchlight::pipeline::Evaluator;
use patchlight::progress::Silent;
use patchlight::scene::{Scene, SurfacePoint};
use patchlight::solve::SolveOptions;
use rooms::{Room, solve, straight};
use triangles::{add, sub, times};

fn options(texel: f64) -> BakeOptions {
    BakeOptions { texel, ..BakeOptions::default() }
}

/// All that reflects in a scene that was solved for 2%, as texels.
fn baked(scene: Scene, bake: &BakeOptions) -> (Evaluator, Lightmap) {
    let solve_options = SolveOptions { error: 0.02, ..SolveOptions::default() };
    let evaluator = solve(scene, &solve_options).0;
    let atlas = Atlas::new(evaluator.solution().scene(), bake).unwrap();
    let lightmap = evaluator.bake(&atlas, None, &Silent).unwrap().unwrap();
    (evaluator, lightmap)
}

/// The radiosity of the texel that a place of a page, in texels, lies in.
fn texel(lightmap: &Lightmap, page: usize, at: [f64; 2]) -> Vec<f64> {
    let image = &lightmap.pages[page];
    let index = at[1] as usize * image.width as usize + at[0] as usize;
    image.radiance[index * image.channels..][..image.channels].iter().map(|&radiance| PI * f64::from(radiance)).collect()
}

/// The texels whose middles lie on a parallelogram's face, each with the point in its middle.
fn middles(scene: &Scene, lightmap: &Lightmap, face: &FaceOnAtlas) -> Vec<([f64; 2], SurfacePoint)> {
    let size = lightmap.atlas.pages()[face.page].map(f64::from);
    let polygon = &scene.surfaces()[face.surface as usize].polygon;
    let corners: Vec<[f64; 3]> = polygon.vertices().collect();
    assert_eq!(corners.len(), 4);
    let uv: Vec<[f64; 2]> = face.uv.iter().map(|uv| [uv[0] * size[0], uv[1] * size[1]]).collect();
    let sides = [1, 3].map(|k| [uv[k][0] - uv[0][0], uv[k][1] - uv[0][1]]);
    let cross = |a: [f64; 2], b: [f64; 2]| a[0] * b[1] - a[1] * b[0];
    let bounds = |axis: usize| {
        let along = || uv.iter().map(|at| at[axis]);
        along().fold(f64::INFINITY, f64::min).floor() as u32..along().fold(0.0, f64::max).ceil() as u32
    };
    let mut found = Vec::new();
    for (x, y) in bounds(1).flat_map(|y| bounds(0).map(move |x| (x, y))) {
        let at = [f64::from(x) + 0.5, f64::from(y) + 0.5];
        let from = [at[0] - uv[0][0], at[1] - uv[0][1]];
        let whole = cross(sides[0], sides[1]);
        let [s, t] = [cross(from, sides[1]) / whole, cross(sides[0], from) / whole];
        if (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t) {
            let [u, v] = [1, 3].map(|k| sub(corners[k], corners[0]));
            let position = add(corners[0], add(times(u, s), times(v, t)));
            found.push((at, SurfacePoint { position, normal: polygon.normal() }));
        }
    }
    found
}

/// The root mean square of relative differences, and the largest.
fn apart(pairs: impl Iterator<Item = (f64, f64)>) -> (f64, f64) {
    let all: Vec<f64> = pairs.map(|(a, b)| (a - b).abs() / b).collect();
    ((all.iter().map(|x| x * x).sum::<f64>() / all.len() as f64).sqrt(), all.into_iter().fold(0.0, f64::max))
}

/// A room with a box that stands on its floor, off the grid of texels.
fn room_with_box() -> Scene {
    let mut room = Room::default();
    let (wall, wood) = (room.material(&[0.7], &[0.0]), room.material(&[0.4], &[0.0]));
    let lamp = room.material(&[0.0], &[20.0]);
    room.cuboid([0.0; 3], straight(2.0, 2.0, 2.0), true, |_, _| wall);
    room.quad([0.2, 0.2, 1.99], [0.0, 0.6, 0.0], [0.6, 0.0, 0.0], lamp);
    room.cuboid([0.813, 0.927, 0.0], straight(0.5, 0.4, 0.3), false, |_, _| wood);
    room.scene()
}
