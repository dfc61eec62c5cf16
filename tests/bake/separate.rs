//! Direct and indirect light apart.

use std::f64::consts::PI;

use patchlight::bake::{Atlas, BakeError, BakeOptions, LightPart, Lightmap};
use patchlight::direct::{DirectEffort, Method, direct_irradiance};
use patchlight::pipeline::Evaluator;
use patchlight::progress::Silent;
use patchlight::scene::{Light, LightShape, PointLight, Scene, Sky, SurfaceId};
use patchlight::solve::{SolveOptions, Solver};
use patchlight::visibility::{Backend, OccluderMesh, build};

use super::rooms::{Room, cube, solve};
use super::{apart, middles, options, room_with_box};

/// Baked with direct and indirect light apart, by either solver.
fn apart_by(scene: Scene, solver: Solver, texel: f64) -> (Evaluator, Lightmap) {
    let solve_options = SolveOptions { error: 0.02, solver, ..SolveOptions::default() };
    let evaluator = solve(scene, &solve_options).0;
    let options = BakeOptions { separate: true, ..options(texel) };
    let atlas = Atlas::new(evaluator.solution().scene(), &options).unwrap();
    let lightmap = evaluator.bake(&atlas, None, &Silent).unwrap().unwrap();
    // Both parts add up to the whole, as radiosity and as irradiance.
    for page in 0..lightmap.pages.len() {
        let [all, direct, indirect] =
            [LightPart::All, LightPart::Direct, LightPart::Indirect].map(|part| lightmap.part(part, page).unwrap().radiance);
        let scene = evaluator.solution().scene();
        let of = |part| lightmap.irradiance_of(scene, part, page).unwrap().radiance;
        let irradiances = [of(LightPart::All), of(LightPart::Direct), of(LightPart::Indirect)];
        for [all, direct, indirect] in [[all, direct, indirect], irradiances] {
            for ((all, direct), indirect) in all.iter().zip(&direct).zip(&indirect) {
                assert!((all - direct - indirect).abs() <= 2e-6 * all && *direct >= 0.0 && *indirect >= 0.0);
            }
        }
    }
    (evaluator, lightmap)
}

#[test]
fn in_a_furnace_direct_light_is_what_walls_emit_and_reflect_of_that() {
    // E = 1, rho = 0.5: B = 2, of which 0.5 was reflected before.
    for solver in [Solver::Links, Solver::Cells] {
        let (_, lightmap) = apart_by(cube(&[0.5], &[1.0]), solver, 0.1);
        for (part, exact) in [(LightPart::Direct, 1.5), (LightPart::Indirect, 0.5)] {
            let radiance = lightmap.part(part, 0).unwrap().radiance;
            let (_, most) = apart(radiance.iter().filter(|&&x| x != 0.0).map(|&x| (PI * f64::from(x), exact)));
            assert!(most < 0.02, "{solver:?}, {part:?}: {most}");
        }
    }
}

#[test]
fn direct_light_is_that_of_the_lamp_alone() {
    for solver in [Solver::Links, Solver::Cells] {
        let (evaluator, lightmap) = apart_by(room_with_box(), solver, 0.1);
        let scene = evaluator.solution().scene();
        let visibility = build(Backend::default(), &OccluderMesh::of_scene(scene)).unwrap();
        let (mut found, mut exact, mut indirect) = (Vec::new(), Vec::new(), 0.0);
        for face in lightmap.atlas.faces(scene) {
            let surface = &scene.surfaces()[face.surface as usize];
            let rho = scene.materials()[surface.material as usize].reflectance[0];
            // Not where texels are filled, under the box, or partly covered, at its foot; nor right behind the lamp.
            let is_open = |[x, y, z]: [f64; 3]| {
                let is_near = (0.7..1.43).contains(&x) && (0.8..1.44).contains(&y);
                !(z < 0.01 && is_near) && z < 1.9
            };
            let texels = middles(scene, &lightmap, &face);
            let texels: Vec<_> = texels.into_iter().filter(|(_, point)| is_open(point.position)).collect();
            let points: Vec<_> = texels.iter().map(|(_, point)| (SurfaceId(face.surface), point.position)).collect();
            let effort = DirectEffort { rays: 1, method: Method::Exact };
            exact.extend(direct_irradiance(scene, &*visibility, &points, effort, 1).irradiance.iter().map(|h| rho * h));
            let at = |part, [x, y]: [f64; 2]| {
                let image = lightmap.part(part, face.page).unwrap();
                PI * f64::from(image.radiance[y as usize * image.width as usize + x as usize])
            };
            if rho > 0.0 {
                found.extend(texels.iter().map(|(at_texel, _)| at(LightPart::Direct, *at_texel)));
                indirect += texels.iter().map(|(at_texel, _)| at(LightPart::Indirect, *at_texel)).sum::<f64>();
            } else {
                exact.truncate(found.len());
            }
        }
        let norm = |numbers: &mut dyn Iterator<Item = f64>| numbers.map(|x| x * x).sum::<f64>().sqrt();
        let off = norm(&mut found.iter().zip(&exact).map(|(a, b)| a - b)) / norm(&mut exact.iter().copied());
        assert!(off < 0.03, "{solver:?}: {off}");
        // Walls of 0.7 send on much of what they get.
        let direct: f64 = found.iter().sum();
        assert!((0.5..3.0).contains(&(indirect / direct)), "{solver:?}: {indirect} {direct}");
    }
}

#[test]
fn light_of_the_sky_and_of_points_is_direct() {
    // Open ground of reflectance 0.5: what arrives comes straight, whatever brings it.
    let light = |name: &str, shape| Light { name: name.to_owned(), strength: vec![1.0], shape };
    for solver in [Solver::Links, Solver::Cells] {
        let mut room = Room::default();
        let grey = room.material(&[0.5], &[0.0]);
        room.quad([-1.0, -1.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0], grey);
        let lamp = LightShape::Point(PointLight::uniform([0.0, 0.0, 1.0]));
        let lights = vec![light("sky", LightShape::Sky(Sky::uniform([0.0, 0.0, 1.0]).unwrap())), light("lamp", lamp)];
        let (_, lightmap) = apart_by(room.scene().with_lights(lights).unwrap(), solver, 0.1);
        let [all, direct] = [LightPart::All, LightPart::Direct].map(|part| lightmap.part(part, 0).unwrap().radiance);
        let lit: Vec<(f32, f32)> = direct.into_iter().zip(all).filter(|(_, all)| *all > 0.0).collect();
        let (_, most) = apart(lit.iter().map(|&(direct, all)| (f64::from(direct), f64::from(all))));
        assert!(most < 1e-5 && lit.len() > 400, "{solver:?}: {most}");
    }
}

#[test]
fn a_mesh_does_not_tell_direct_light() {
    let with_mesh = SolveOptions { error: 0.2, lit_mesh: true, ..SolveOptions::default() };
    let evaluator = solve(room_with_box(), &with_mesh).0;
    let atlas = Atlas::new(evaluator.solution().scene(), &BakeOptions { separate: true, ..options(0.2) }).unwrap();
    assert_eq!(evaluator.bake(&atlas, evaluator.mesh(), &Silent), Err(BakeError::MeshIsWhole));
    assert!(evaluator.bake(&atlas, None, &Silent).unwrap().unwrap().direct.is_some());
}
