//! Lightmaps: held against furnaces, Lambert's formula, gathers and the lit mesh; what lies where; nothing leaks.

#[path = "support/rooms.rs"]
mod rooms;
#[path = "support/triangles.rs"]
mod triangles;

use std::collections::BTreeMap;
use std::f64::consts::PI;

use patchlight::bake::{Atlas, BakeError, BakeOptions, FaceOnAtlas, LightPart, Lightmap, Only};
use patchlight::direct::{DirectEffort, Method, direct_irradiance};
use patchlight::output::{LightmapCode, Provenance, Quantity, write_lightmap_glb, write_lightmap_json, write_lightmap_png};
use patchlight::pipeline::Evaluator;
use patchlight::progress::Silent;
use patchlight::scene::{Scene, SurfaceId, SurfacePoint};
use patchlight::solve::{RunOptions, SolveOptions, Solver};
use patchlight::visibility::{Backend, OccluderMesh, build};
use rooms::{Room, crowded, cube, regathered, solve, straight, values};
use triangles::{Random, add, sub, times};

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
fn lambert(point: [f64; 3], corners: &[[f64; 3]]) -> f64 {
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
fn a_mesh_does_not_tell_direct_light() {
    let options = SolveOptions { error: 0.2, lit_mesh: true, ..SolveOptions::default() };
    let evaluator = solve(room_with_box(), &options).0;
    let atlas = Atlas::new(evaluator.solution().scene(), &BakeOptions { separate: true, ..self::options(0.2) }).unwrap();
    assert_eq!(evaluator.bake(&atlas, evaluator.mesh(), &Silent), Err(BakeError::MeshIsWhole));
    assert!(evaluator.bake(&atlas, None, &Silent).unwrap().unwrap().direct.is_some());
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
fn charts_lie_apart_on_as_many_pages_as_it_takes_and_hold_their_faces() {
    let scene = crowded(12, 3);
    for size in [4096, 128] {
        let options = BakeOptions { size, ..options(0.05) };
        let atlas = Atlas::new(&scene, &options).unwrap();
        assert_eq!(atlas.pages().len() > 1, size == 128);
        assert!(atlas.pages().iter().flatten().all(|&side| side <= size));
        assert_eq!(atlas.faces(&scene).count(), scene.surfaces().len());

        // The box of each chart in texels, which all of its faces lie in, keeps the padding of both from others.
        let mut boxes: BTreeMap<usize, (usize, [[f64; 2]; 2])> = BTreeMap::new();
        for face in atlas.faces(&scene) {
            let page = atlas.pages()[face.page].map(f64::from);
            let of_chart = boxes.entry(face.chart).or_insert((face.page, [[f64::INFINITY; 2], [0.0; 2]]));
            for uv in &face.uv {
                assert!(uv.iter().all(|part| (0.0..=1.0).contains(part)));
                for axis in 0..2 {
                    of_chart.1[0][axis] = of_chart.1[0][axis].min(uv[axis] * page[axis]);
                    of_chart.1[1][axis] = of_chart.1[1][axis].max(uv[axis] * page[axis]);
                }
            }
        }
        let boxes: Vec<_> = boxes.into_values().collect();
        for (number, (page, [from, to])) in boxes.iter().enumerate() {
            for (other_page, [other_from, other_to]) in &boxes[..number] {
                let gap =
                    (0..2).map(|axis| (from[axis] - other_to[axis]).max(other_from[axis] - to[axis])).fold(f64::MIN, f64::max);
                assert!(page != other_page || gap >= 4.0 - 1e-9, "{gap}");
            }
        }
    }
}

#[test]
fn a_lightmap_is_the_same_for_any_number_of_threads_and_reads_a_mesh_as_it_is() {
    let options = SolveOptions { error: 0.1, lit_mesh: true, ..SolveOptions::default() };
    let solution = solve(room_with_box(), &options).0.solution().clone();
    let scene = solution.scene().clone();
    let atlas = Atlas::new(&scene, &self::options(0.05)).unwrap();
    let evaluator = |threads: usize| Evaluator::new(solution.clone(), &RunOptions { threads, ..RunOptions::default() }).unwrap();
    let (one, two) = (evaluator(1), evaluator(2));
    let lightmap = |of: &Evaluator, mesh: bool| of.bake(&atlas, of.mesh().filter(|_| mesh), &Silent).unwrap().unwrap();
    assert!(lightmap(&one, false) == lightmap(&two, false));
    let read = lightmap(&one, true);
    assert!(read == lightmap(&two, true) && read.report.gathered == [0; 2]);

    // Walls that nothing stands on: every texel is the mesh at its middle.
    let face = atlas.faces(&scene).find(|face| scene.surfaces()[face.surface as usize].polygon.normal()[0] > 0.5).unwrap();
    let texels = middles(&scene, &read, &face);
    let points: Vec<SurfacePoint> = texels.iter().map(|(_, point)| *point).collect();
    let of_mesh = one.mesh_values_at(&points).unwrap().radiosity;
    let (_, most) = apart(texels.iter().zip(&of_mesh).map(|((at, _), &b)| (texel(&read, face.page, *at)[0], f64::from(b))));
    assert!(most < 1e-4, "{most}");
}

#[test]
fn parts_are_baked_by_name_and_what_cannot_be_is_refused() {
    let scene = room_with_box();
    let only = |name: &str| BakeOptions { only: Some(Only::Material(name.to_owned())), ..options(0.05) };
    let wood = Atlas::new(&scene, &only("m1")).unwrap();
    assert!(wood.faces(&scene).all(|face| scene.surfaces()[face.surface as usize].material == 1));
    assert_eq!(wood.faces(&scene).count(), 6);
    assert!(matches!(Atlas::new(&scene, &only("stone")), Err(BakeError::Nothing { kind: "material", .. })));
    assert!(matches!(Atlas::new(&scene, &options(1e-6)), Err(BakeError::TooMany { .. })));
    assert!(matches!(Atlas::new(&scene, &options(f64::NAN)), Err(BakeError::BadTexel(_))));
    let small = BakeOptions { size: 16, ..options(0.05) };
    assert!(matches!(Atlas::new(&scene, &small), Err(BakeError::ChartTooLarge { size: 16, .. })));

    // An atlas of another scene.
    let evaluator = solve(cube(&[0.5], &[1.0]), &SolveOptions { error: 0.5, ..SolveOptions::default() }).0;
    assert_eq!(evaluator.bake(&wood, None, &Silent), Err(BakeError::OtherScene));
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

/// JSON and binary chunk of a GLB.
fn chunks(file: &[u8]) -> (serde_json::Value, &[u8]) {
    let number = |at: usize| u32::from_le_bytes(file[at..at + 4].try_into().unwrap()) as usize;
    assert_eq!((&file[..4], number(4), number(8)), (&b"glTF"[..], 2, file.len()));
    (serde_json::from_slice(&file[20..20 + number(12)]).unwrap(), &file[28 + number(12)..])
}

fn pixels(png: &[u8]) -> (u32, Vec<u8>) {
    let mut reader = png::Decoder::new(std::io::Cursor::new(png)).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut bytes).unwrap();
    bytes.truncate(info.buffer_size());
    (info.width, bytes)
}

/// Few boxes on several pages.
fn pages() -> (Evaluator, Lightmap) {
    baked(crowded(2, 5), &BakeOptions { size: 96, ..options(0.1) })
}

#[test]
fn a_glb_has_a_primitive_for_each_page_and_shows_it() {
    let (evaluator, lightmap) = pages();
    let (solution, scene) = (evaluator.solution(), evaluator.solution().scene());
    let provenance = Provenance::new(solution.options());
    let faces: Vec<FaceOnAtlas> = lightmap.atlas.faces(scene).collect();
    assert!(lightmap.pages.len() > 1);

    // GLB: a primitive for each page, with coordinates that both sets share, and a texture that is the page.
    let mut glb = Vec::new();
    write_lightmap_glb(&mut glb, scene, &lightmap, 0.5, &provenance).unwrap();
    let (json, binary) = chunks(&glb);
    let view = |number: &serde_json::Value| {
        let view = &json["bufferViews"][number.as_u64().unwrap() as usize];
        let [start, length] = ["byteOffset", "byteLength"].map(|key| view[key].as_u64().unwrap() as usize);
        &binary[start..start + length]
    };
    let mut corners = 0;
    for mesh in json["meshes"].as_array().unwrap() {
        let primitive = &mesh["primitives"][0];
        assert_eq!(primitive["attributes"]["TEXCOORD_0"], primitive["attributes"]["TEXCOORD_1"]);
        let accessor = &json["accessors"][primitive["attributes"]["TEXCOORD_1"].as_u64().unwrap() as usize];
        assert_eq!((&accessor["type"], &accessor["componentType"]), (&"VEC2".into(), &5126.into()));
        let uv: Vec<f32> =
            view(&accessor["bufferView"]).chunks(4).map(|word| f32::from_le_bytes(word.try_into().unwrap())).collect();
        let page = primitive["material"].as_u64().unwrap() as usize;
        let expected: Vec<f32> =
            faces.iter().filter(|face| face.page == page).flat_map(|face| face.uv.as_flattened()).map(|&x| x as f32).collect();
        assert_eq!(uv, expected);
        corners += uv.len() / 2;
    }
    assert_eq!(corners, faces.iter().map(|face| face.uv.len()).sum::<usize>());
    let srgb = |x: f64| if x <= 0.0031308 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 };
    for (number, image) in json["images"].as_array().unwrap().iter().enumerate() {
        let (width, bytes) = pixels(view(&image["bufferView"]));
        assert_eq!(width, lightmap.pages[number].width);
        for (byte, &radiance) in bytes.iter().zip(&lightmap.pages[number].radiance) {
            let expected = 255.0 * srgb((f64::from(radiance) * 2.0_f64.sqrt()).min(1.0));
            assert!((f64::from(*byte) - expected).abs() <= 0.51, "{byte} {expected}");
        }
    }
}

#[test]
fn rgbm_and_json_say_the_same_as_the_lightmap() {
    let (evaluator, lightmap) = pages();
    let (solution, scene) = (evaluator.solution(), evaluator.solution().scene());
    let provenance = Provenance::new(solution.options());
    let faces: Vec<FaceOnAtlas> = lightmap.atlas.faces(scene).collect();

    // RGBM gives the numbers back to half a step.
    let range = PI * f64::from(lightmap.pages.iter().flat_map(|page| &page.radiance).fold(0.0_f32, |most, &x| most.max(x)));
    let mut rgbm = Vec::new();
    write_lightmap_png(&mut rgbm, &lightmap.pages[0], (Quantity::Radiosity, LightmapCode::Rgbm { range }), &provenance).unwrap();
    for (pixel, radiance) in pixels(&rgbm).1.chunks(4).zip(lightmap.pages[0].pixels()) {
        let factor = f64::from(pixel[3]) / 255.0 * range / 255.0;
        for (byte, &radiance) in pixel.iter().zip(radiance) {
            assert!((f64::from(*byte) * factor - PI * f64::from(radiance)).abs() <= 0.501 * factor);
        }
    }

    // JSON: every face with its corners.
    let mut json = Vec::new();
    write_lightmap_json(&mut json, scene, &lightmap, Quantity::Radiosity, &provenance).unwrap();
    let json: serde_json::Value = serde_json::from_slice(&json).unwrap();
    let listed = json["faces"].as_array().unwrap();
    assert_eq!((listed.len(), json["pages"].as_array().unwrap().len()), (faces.len(), lightmap.pages.len()));
    for (told, face) in listed.iter().zip(&faces) {
        let uv: Vec<[f64; 2]> = serde_json::from_value(told["uv"].clone()).unwrap();
        assert!(uv.as_flattened().iter().zip(face.uv.as_flattened()).all(|(told, own)| (told - own).abs() < 1e-12));
        assert_eq!(told["face"], u64::from(scene.surfaces()[face.surface as usize].face) + 1);
    }
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
