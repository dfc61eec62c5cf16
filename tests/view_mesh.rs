//! Meshes that are made of what a picture sees: held against better values, against what is known exactly, and against what is seen.

#[path = "support/kirchhoff.rs"]
mod kirchhoff;
#[path = "support/rooms.rs"]
mod rooms;
#[path = "support/triangles.rs"]
mod triangles;

use std::collections::BTreeSet;
use std::f64::consts::PI;

use kirchhoff::kirchhoff;
use patchlight::mesh::LitMesh;
use patchlight::picture::Camera;
use patchlight::pipeline::{Evaluator, ViewMesh};
use patchlight::progress::Silent;
use patchlight::scene::{Scene, SurfaceId, SurfacePoint};
use patchlight::solve::{RunOptions, StoppedBy};
use patchlight::visibility::{Backend, OccluderMesh, build};
use rooms::{Room, read, solved};
use triangles::{Random, add, dot, times};

/// What random positions of a picture show, with the surface: fronts alone.
fn shown_at_random(scene: &Scene, camera: &Camera, count: usize) -> Vec<(SurfacePoint, u32)> {
    let visibility = build(Backend::Auto, &OccluderMesh::of_scene(scene)).unwrap();
    let (through, mut random) = (camera.rays().unwrap(), Random(11));
    let [width, height] = [camera.width, camera.height].map(f64::from);
    let rays: Vec<_> = (0..count).map(|_| through.through(width * random.unit(), height * random.unit())).collect();
    let mut hits = vec![None; count];
    visibility.first_hits(&rays, &mut hits);
    let point = |(ray, hit): (&patchlight::visibility::Ray, &Option<patchlight::visibility::Hit>)| {
        let hit = hit.as_ref()?;
        let normal = scene.surface(SurfaceId(hit.surface)).polygon.normal();
        let position = add(ray.origin, times(ray.direction, hit.distance));
        (dot(normal, ray.direction) < 0.0).then_some((SurfacePoint { position, normal }, hit.surface))
    };
    rays.iter().zip(&hits).filter_map(point).collect()
}

fn made(evaluator: &Evaluator, error: f64, [width, height]: [u32; 2]) -> (Camera, LitMesh) {
    let camera = evaluator.default_camera(width, height);
    let mesh = evaluator.view_mesh(&camera, error, &Silent).unwrap().unwrap();
    (camera, mesh)
}

/// The error of values in three channels in the local norm, every point counting alike: what reflects nothing does not count.
fn local_error(values: &[f32], truth: &[f32], emitted: &[f32]) -> f64 {
    let squares = values.chunks(3).zip(truth.chunks(3)).zip(emitted.chunks(3)).map(|((value, truth), emitted)| {
        let sum = |of: &dyn Fn(usize) -> f32| (0..3).map(|k| f64::from(of(k)).powi(2)).sum::<f64>();
        [sum(&|k| value[k] - truth[k]), sum(&|k| truth[k] - emitted[k])]
    });
    let squares: Vec<[f64; 2]> = squares.filter(|[_, light]| *light > 0.0).collect();
    let mut light: Vec<f64> = squares.iter().map(|of| of[1]).collect();
    light.sort_by(f64::total_cmp);
    let typical = light[light.len() / 2];
    (squares.iter().map(|[error, light]| error / light.max(typical)).sum::<f64>() / squares.len() as f64).sqrt()
}

#[test]
fn what_is_claimed_over_the_pixels_holds_over_links_and_over_cells() {
    for name in ["cornell.obj", "two_rooms.obj"] {
        let (better, _) = solved(read(name), 0.02, 0);
        let (evaluator, of_values) = solved(read(name), 0.04, 0);
        let (camera, mesh) = made(&evaluator, 0.04, [320, 240]);
        assert!(mesh.claimed <= 0.04 && mesh.measured <= mesh.claimed, "{name}: {} claimed", mesh.claimed);
        let shown = shown_at_random(evaluator.solution().scene(), &camera, 3000);
        let points: Vec<SurfacePoint> = shown.iter().map(|(point, _)| *point).collect();
        let truth = better.values_at(&points, &Silent).unwrap().radiosity;
        let scene = evaluator.solution().scene();
        let emitted: Vec<f32> = shown
            .iter()
            .flat_map(|&(_, surface)| {
                let material = scene.surface(SurfaceId(surface)).material;
                scene.materials()[material as usize].exitance.iter().map(|&e| e as f32).collect::<Vec<f32>>()
            })
            .collect();
        let off = local_error(&evaluator.values_of_mesh(&mesh, &points), &truth, &emitted);
        let claimed = mesh.claimed.hypot(of_values).hypot(0.02);
        assert!(off <= claimed, "{name}: {off} off, {claimed} claimed");
        assert!(off > 0.002, "{name}: {off} off is better than what was made");
    }
}

/// Where radiosity and irradiance are the same everywhere, pixels are off that by about their standard errors.
#[test]
fn standard_errors_of_pixels_are_about_what_they_are_off() {
    let furnace = kirchhoff(1, 3);
    let (evaluator, _) = solved(furnace.scene.clone(), 0.05, 0);
    let (camera, mesh) = made(&evaluator, 0.05, [160, 120]);
    let radiances = evaluator.render_mesh(&mesh, &camera, &Silent).unwrap().unwrap();
    let irradiances = evaluator.render_irradiance(Some(&mesh), &camera, &Silent).unwrap().unwrap();
    for image in [radiances, irradiances] {
        let errors = image.standard_error.unwrap();
        let off = image.radiance.iter().enumerate().map(|(k, &value)| (PI * f64::from(value) - furnace.b0[k % 3]).powi(2));
        let told = errors.iter().map(|&error| (PI * f64::from(error)).powi(2));
        let ratio = (off.sum::<f64>() / told.sum::<f64>()).sqrt();
        assert!((0.3..1.3).contains(&ratio), "off by {ratio} standard errors");
    }
}

#[test]
fn in_a_furnace_all_pixels_are_alike() {
    let furnace = kirchhoff(1, 3);
    let (evaluator, claimed) = solved(furnace.scene.clone(), 0.02, 0);
    let (camera, mesh) = made(&evaluator, 0.02, [160, 120]);
    let image = evaluator.render_mesh(&mesh, &camera, &Silent).unwrap().unwrap();
    let off = |(k, &radiance): (usize, &f32)| (PI * f64::from(radiance) / furnace.b0[k % 3] - 1.0).powi(2);
    let offs: Vec<f64> = image.radiance.iter().enumerate().map(off).collect();
    let (mean, all) = ((offs.iter().sum::<f64>() / offs.len() as f64).sqrt(), claimed.hypot(mesh.claimed));
    assert!(mean <= all, "{mean} off, {all} claimed");

    // No pixel shows a place that the mesh has nothing of.
    let largest = offs.into_iter().fold(0.0, f64::max).sqrt();
    assert!(largest < 0.2, "a pixel is off by {largest}");
}

#[test]
fn elements_are_where_something_is_seen() {
    let (evaluator, _) = solved(read("two_rooms.obj"), 0.2, 0);
    let scene = evaluator.solution().scene();
    let (camera, mesh) = made(&evaluator, 0.2, [160, 120]);
    let meshed: BTreeSet<u32> = mesh.parts(scene).map(|part| part.surface).collect();
    let reflecting = (0..scene.surfaces().len()).filter(|&number| {
        let material = scene.surfaces()[number].material;
        scene.materials()[material as usize].reflectance.iter().any(|&rho| rho > 0.0)
    });
    assert!(meshed.len() < reflecting.count() / 2, "the other room is not seen: {meshed:?}");

    // All that many rays find has a value; and what has elements is found by many rays, but for slivers.
    let shown = shown_at_random(scene, &camera, 200_000);
    let seen: BTreeSet<u32> = shown.iter().map(|(_, surface)| *surface).collect();
    let unseen: Vec<&u32> = meshed.difference(&seen).collect();
    assert!(unseen.is_empty(), "{unseen:?} are not seen");

    // Of surfaces that are seen in part, not all has elements.
    let whole = evaluator.lit_mesh(0.2, &Silent).unwrap();
    let area = |mesh: &LitMesh, surfaces: &BTreeSet<u32>| {
        let mut area = 0.0;
        mesh.for_each_element(scene, |surface, nodes, _| {
            if surfaces.contains(&surface) {
                area += triangle_area([nodes[0], nodes[1], nodes[2]]);
            }
        });
        area
    };
    assert!(area(&mesh, &meshed) < 0.95 * area(&whole, &meshed));
}

fn triangle_area([a, b, c]: [[f64; 3]; 3]) -> f64 {
    let (u, v) = (triangles::sub(b, a), triangles::sub(c, a));
    let normal = triangles::cross(u, v);
    0.5 * dot(normal, normal).sqrt()
}

#[test]
fn threads_change_nothing_and_a_camera_that_sees_no_front_sees_nothing() {
    let pictures = [1, 2, 3].map(|threads| {
        let (evaluator, _) = solved(read("cornell.obj"), 0.1, threads);
        let (camera, mesh) = made(&evaluator, 0.1, [96, 72]);
        (evaluator.render_mesh(&mesh, &camera, &Silent).unwrap().unwrap(), mesh)
    });
    assert!(pictures[0] == pictures[1] && pictures[0] == pictures[2]);

    let mut room = Room::default();
    let (grey, lamp) = (room.material(&[0.5], &[0.0]), room.material(&[0.0], &[10.0]));
    room.quad([-2.0, -2.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0], grey);
    room.quad([-0.5, -0.5, 0.8], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], lamp);
    let (evaluator, _) = solved(room.scene(), 0.1, 0);
    let below = Camera { eye: [0.0, 0.0, -3.0], target: [0.0; 3], up: [0.0, 1.0, 0.0], ..evaluator.default_camera(32, 24) };
    let mesh = evaluator.view_mesh(&below, 0.1, &Silent).unwrap().unwrap();
    assert_eq!((mesh.elements(), mesh.claimed), (0, 0.0));
    let image = evaluator.render_mesh(&mesh, &below, &Silent).unwrap().unwrap();
    assert!(image.radiance.iter().all(|&radiance| radiance == 0.0));
}

#[test]
fn limits_end_a_mesh_where_it_is_and_what_is_claimed_of_it_holds() {
    let (evaluator, _) = solved(read("cornell.obj"), 0.04, 0);
    let camera = evaluator.default_camera(160, 120);
    let within = |error: f64, run: RunOptions| evaluator.view_mesh_within(&camera, error, &run, &Silent).unwrap();
    let gigabytes = |memory: f64| RunOptions { memory_bytes: Some((1e9 * memory) as u64), ..RunOptions::default() };
    let seconds = |time_s: f64| RunOptions { time_s: Some(time_s), ..RunOptions::default() };

    // Limits that do not act.
    let ample = RunOptions { time_s: Some(1e4), ..gigabytes(4.0) };
    let free = evaluator.view_mesh(&camera, 0.04, &Silent).unwrap();
    assert!(free.is_some() && within(0.04, ample) == ViewMesh { mesh: free, stopped_by: StoppedBy::Error });

    // Those that leave nothing.
    assert_eq!(within(0.04, seconds(0.0)), ViewMesh { mesh: None, stopped_by: StoppedBy::Time });
    assert_eq!(within(0.04, gigabytes(0.001)), ViewMesh { mesh: None, stopped_by: StoppedBy::Memory });
    assert!(evaluator.view_mesh_within(&camera, 0.04, &seconds(f64::NAN), &Silent).is_err());

    // Those that leave some.
    let ViewMesh { mesh, stopped_by } = within(0.01, gigabytes(0.03));
    let mesh = mesh.expect("there is room for some elements");
    assert!(stopped_by == StoppedBy::Memory && mesh.claimed > 0.01, "{stopped_by:?}, {} claimed", mesh.claimed);
    let (better, _) = solved(read("cornell.obj"), 0.02, 0);
    let shown = shown_at_random(better.solution().scene(), &camera, 3000);
    let points: Vec<SurfacePoint> = shown.iter().map(|(point, _)| *point).collect();
    let of_values = evaluator.values_at(&points, &Silent).unwrap().radiosity;
    let scene = better.solution().scene();
    let exitance = |surface: u32| &scene.materials()[scene.surface(SurfaceId(surface)).material as usize].exitance;
    let emitted: Vec<f32> = shown.iter().flat_map(|&(_, surface)| exitance(surface)).map(|&e| e as f32).collect();
    let noise = local_error(&of_values, &better.values_at(&points, &Silent).unwrap().radiosity, &emitted);
    let off = local_error(&evaluator.values_of_mesh(&mesh, &points), &of_values, &emitted);
    assert!(off <= mesh.claimed.hypot(noise), "{off} off values that are {noise} off, {} claimed", mesh.claimed);
}

#[test]
fn pixels_for_which_there_was_no_time_show_one_beside_them() {
    let (evaluator, _) = solved(read("cornell.obj"), 0.1, 0);
    let camera = evaluator.default_camera(96, 72);
    let gathered = evaluator.render(&camera, &Silent).unwrap().unwrap();
    let within = |time_s| {
        let run = RunOptions { time_s: Some(time_s), ..RunOptions::default() };
        evaluator.render_within(&camera, &run, &Silent).unwrap().unwrap()
    };
    let (whole, taken) = within(1e4);
    assert!(taken == 1.0 && whole == gathered);
    let (image, taken) = within(0.0);
    assert!(taken > 0.0 && taken < 0.2, "{taken}");
    let errors = image.standard_error.as_ref().unwrap();
    let is_own = |pixel: usize| !errors[3 * pixel].is_nan();
    assert_eq!((0..96 * 72).filter(|&pixel| is_own(pixel)).count(), (taken * 96.0 * 72.0).round() as usize);
    for pixel in 0..96 * 72 {
        let beside = (pixel / 96 / 4 * 4) * 96 + pixel % 96 / 4 * 4;
        let of = |image: &patchlight::picture::Image, pixel: usize| image.radiance[3 * pixel..][..3].to_vec();
        assert_eq!(of(&image, pixel), of(&gathered, if is_own(pixel) { pixel } else { beside }));
    }
}
