//! What texels hold, against exact values and gathers.

use std::f64::consts::PI;

use patchlight::scene::SurfacePoint;

use super::rooms::{Room, crowded, cube, regathered, straight, values};
use super::triangles::{self, Random, sub, times};
use super::{apart, baked, middles, options, room_with_box, texel};

#[test]
fn every_texel_of_a_furnace_has_its_radiosity_padding_included() {
    let (_, lightmap) = baked(cube(&[0.5], &[1.0]), &options(0.07));
    let texels: Vec<f32> =
        lightmap.pages.iter().flat_map(|page| page.radiance.clone()).filter(|&radiance| radiance != 0.0).collect();
    // Six faces of 15 x 15 texels, with two around each.
    assert_eq!((lightmap.report.texels, lightmap.report.hidden, texels.len()), (6 * 15 * 15, 0, 6 * 19 * 19));
    let (_, most) = apart(texels.iter().map(|&radiance| (PI * f64::from(radiance), 2.0)));
    assert!(most < 0.01, "{most}");
}

/// The form factor of a point of the plane z = 0, facing up, to a polygon that runs clockwise seen from there (Lambert 1760).
pub fn lambert(point: [f64; 3], corners: &[[f64; 3]]) -> f64 {
    let unit = |v: [f64; 3]| times(v, 1.0 / v.iter().map(|x| x * x).sum::<f64>().sqrt());
    let term = |k: usize| {
        let (a, b) = (unit(sub(corners[k], point)), unit(sub(corners[(k + 1) % corners.len()], point)));
        let angle = a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>().acos();
        angle * unit(triangles::cross(b, a))[2]
    };
    (0..corners.len()).map(term).sum::<f64>() / (2.0 * PI)
}

#[test]
fn a_lamp_over_a_floor_is_lamberts_lamp() {
    let mut room = Room::default();
    let (floor, lamp) = (room.material(&[0.8], &[0.0]), room.material(&[0.0], &[10.0]));
    room.quad([0.0; 3], [2.0, 0.0, 0.0], [0.0, 1.5, 0.0], floor);
    room.quad([0.6, 0.4, 0.7], [0.0, 0.5, 0.0], [0.5, 0.0, 0.0], lamp);
    let (evaluator, lightmap) = baked(room.scene(), &options(0.02));
    let scene = evaluator.solution().scene();
    let lamp: Vec<[f64; 3]> = scene.surfaces()[1].polygon.vertices().collect();
    let face = lightmap.atlas.faces(scene).find(|face| face.surface == 0).unwrap();
    let texels = middles(scene, &lightmap, &face);
    assert_eq!(texels.len(), 100 * 75);
    let exact = |point: &SurfacePoint| 8.0 * lambert(point.position, &lamp);
    let (mean, most) = apart(texels.iter().map(|(at, point)| (texel(&lightmap, face.page, *at)[0], exact(point))));
    assert!(mean < 0.005 && most < 0.05, "{mean} {most}");
    // Much of that was interpolated; and the irradiance is that over the reflectance.
    assert!(lightmap.report.gathered[0] < 2 * 7500 / 3, "{:?}", lightmap.report);
    let (radiosity, irradiance) = (&lightmap.pages[face.page], lightmap.irradiance(scene, face.page));
    let at = texels[1234].0;
    let index = at[1] as usize * radiosity.width as usize + at[0] as usize;
    assert!((irradiance.radiance[index] * 0.8 / radiosity.radiance[index] - 1.0).abs() < 1e-5);
    // The lamp reflects nothing, and is as bright as it emits.
    let lamp = lightmap.atlas.faces(scene).find(|face| face.surface == 1).unwrap();
    assert!(middles(scene, &lightmap, &lamp).iter().all(|(at, _)| (texel(&lightmap, lamp.page, *at)[0] - 10.0).abs() < 1e-5));
}

#[test]
fn nothing_leaks_from_under_a_box() {
    let (evaluator, lightmap) = baked(room_with_box(), &options(0.05));
    let scene = evaluator.solution().scene();
    let floor = lightmap.atlas.faces(scene).find(|face| {
        let surface = &scene.surfaces()[face.surface as usize];
        surface.material == 0 && surface.polygon.normal()[2] > 0.5
    });
    let floor = floor.unwrap();
    assert!(lightmap.report.hidden > 40, "{:?}", lightmap.report);

    // Texels beside the foot against gathers with many rays; those in part under it have the light beside it.
    let away = |[x, y, _]: [f64; 3]| {
        let outside = |at: f64, from: f64, to: f64| (from - at).max(at - to);
        outside(x, 0.813, 1.313).max(outside(y, 0.927, 1.327))
    };
    let texels = middles(scene, &lightmap, &floor);
    let beside: Vec<_> = texels.iter().filter(|(_, point)| (0.0..0.1).contains(&away(point.position))).collect();
    assert!(beside.len() > 60);
    let points: Vec<SurfacePoint> = beside.iter().map(|(_, point)| *point).collect();
    let exact = values(&regathered(&evaluator, 4096, 77), &points);
    let (mean, most) = apart(beside.iter().zip(&exact).map(|((at, _), &exact)| (texel(&lightmap, floor.page, *at)[0], exact)));
    assert!(mean < 0.04 && most < 0.25, "{mean} {most}");

    // What is under it was filled from beside it: no darker, no brighter.
    let least = exact.iter().copied().fold(f64::INFINITY, f64::min);
    let most = exact.iter().copied().fold(0.0, f64::max);
    for (at, _) in texels.iter().filter(|(_, point)| away(point.position) < 0.0) {
        let radiosity = texel(&lightmap, floor.page, *at)[0];
        assert!((0.8 * least..1.2 * most).contains(&radiosity), "{radiosity}, beside it {least} to {most}");
    }
}

#[test]
fn facets_of_a_column_have_seams_that_are_told() {
    let (sides, mut room) = (24, Room::default());
    let (wall, stone, lamp) = (room.material(&[0.7], &[0.0]), room.material(&[0.5], &[0.0]), room.material(&[0.0], &[20.0]));
    room.cuboid([-2.0, -2.0, 0.0], straight(4.0, 4.0, 2.0), true, |_, _| wall);
    room.quad([-1.9, -1.9, 1.99], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], lamp);
    let at = |k: i32, z: f64| {
        let (sin, cos) = (2.0 * PI * f64::from(k) / f64::from(sides)).sin_cos();
        [0.5 * cos, 0.5 * sin, z]
    };
    (0..sides).for_each(|k| room.face(&[at(k, 0.0), at(k + 1, 0.0), at(k + 1, 2.0), at(k, 2.0)], stone));
    let (_, lightmap) = baked(room.scene(), &options(0.05));
    let seams = lightmap.report.seams;
    // Neighbours turn by 15 degrees: a point's light changes by a part of that from one to the next.
    assert_eq!(seams.edges, 24);
    assert!(seams.mean > 0.0 && seams.mean < 0.3 && seams.largest >= seams.mean, "{seams:?}");
}

/// What is interpolated, and what is claimed of it, against gathers with sixty times the rays.
#[test]
fn the_error_that_is_told_is_about_what_is_found() {
    let (evaluator, lightmap) = baked(crowded(10, 9), &options(0.04));
    let scene = evaluator.solution().scene();
    let mut random = Random(5);
    let mut drawn: Vec<(usize, [f64; 2], SurfacePoint)> = Vec::new();
    for face in lightmap.atlas.faces(scene) {
        let texels = middles(scene, &lightmap, &face).into_iter().filter(|_| random.unit() < 0.03);
        drawn.extend(texels.map(|(at, point)| (face.page, at, point)));
    }
    let points: Vec<SurfacePoint> = drawn.iter().map(|(_, _, point)| *point).collect();
    let reference = values(&regathered(&evaluator, 16384, 3), &points);
    let pairs = drawn.iter().zip(reference.chunks(3)).filter(|(_, exact)| exact.iter().sum::<f64>() > 0.0);
    let (mut off_sq, mut light): (Vec<f64>, Vec<f64>) = (Vec::new(), Vec::new());
    for ((page, at, _), exact) in pairs {
        let own = texel(&lightmap, *page, *at);
        off_sq.push(own.iter().zip(exact).map(|(a, b)| (a - b).powi(2)).sum());
        light.push(exact.iter().map(|b| b * b).sum());
    }
    let mut sorted = light.clone();
    sorted.sort_by(f64::total_cmp);
    let typical = sorted[sorted.len() / 2];
    let relative: f64 = off_sq.iter().zip(&light).map(|(off, light)| off / light.max(typical)).sum::<f64>() / light.len() as f64;
    let (found, told) = (relative.sqrt(), lightmap.report.whole.unwrap());
    assert!(found < 1.5 * told && told < 0.05, "found {found}, told {told}: {:?}", lightmap.report);
}
