//! Light at the vertices of faces, against exact means.

use patchlight::bake::{BakeOptions, Only, VertexLight};
use patchlight::output::{ExportFormat, Provenance, export_vertex_light};
use patchlight::pipeline::Evaluator;
use patchlight::progress::Silent;
use patchlight::scene::Scene;
use patchlight::solve::SolveOptions;

use super::files::chunks;
use super::light::lambert;
use super::rooms::{Room, cube, solve};
use super::{apart, room_with_box};

fn baked(scene: Scene, within: f64) -> (Evaluator, VertexLight) {
    let evaluator = solve(scene, &SolveOptions { error: 0.02, ..SolveOptions::default() }).0;
    let light = evaluator.bake_vertices(&BakeOptions::default(), within, &Silent).unwrap().unwrap();
    (evaluator, light)
}

#[test]
fn every_vertex_of_a_furnace_has_its_radiosity() {
    for within in [f64::INFINITY, 0.1, 1e-3] {
        let (_, light) = baked(cube(&[0.5], &[1.0]), within);
        assert_eq!((light.radiosity.len(), light.points, light.hidden), (24, 24 * 16, 0));
        let (_, most) = apart(light.radiosity.iter().map(|&b| (f64::from(b), 2.0)));
        assert!(most < 0.01, "{within}: {most}");
    }
}

#[test]
fn a_vertex_has_the_mean_over_the_part_of_its_face_around_it() {
    for within in [f64::INFINITY, 0.3] {
        let mut room = Room::default();
        let (floor, lamp) = (room.material(&[0.8], &[0.0]), room.material(&[0.0], &[10.0]));
        room.quad([0.0; 3], [2.0, 0.0, 0.0], [0.0, 1.5, 0.0], floor);
        room.quad([0.6, 0.4, 0.7], [0.0, 0.5, 0.0], [0.5, 0.0, 0.0], lamp);
        let (evaluator, light) = baked(room.scene(), within);
        let scene = evaluator.solution().scene();
        let lamp: Vec<[f64; 3]> = scene.surfaces()[1].polygon.vertices().collect();
        // The part has the shape of the face: shrunk until its longer side is that long.
        let part = f64::min(within / 1.0, 1.0);
        for (vertex, &found) in scene.surfaces()[0].polygon.vertices().zip(&light.radiosity) {
            let (mut sum, count) = (0.0, 60);
            for k in 0..count * count {
                let along =
                    |k: i32, corner: f64, far: f64| corner + (far - corner) * 0.5 * part * (f64::from(k) + 0.5) / f64::from(count);
                let [x, y] = [along(k % count, vertex[0], 2.0 - vertex[0]), along(k / count, vertex[1], 1.5 - vertex[1])];
                sum += 8.0 * lambert([x, y, 0.0], &lamp);
            }
            let exact = sum / f64::from(count * count);
            assert!((f64::from(found) / exact - 1.0).abs() < 0.02, "{vertex:?}, {within}: {found}, want {exact}");
        }
        // The lamp reflects nothing, and is as bright as it emits.
        assert!(light.radiosity[4..].iter().all(|&b| b == 10.0));
    }
}

#[test]
fn what_stands_on_a_face_hides_vertices_which_are_told() {
    let (evaluator, light) = baked(room_with_box(), f64::INFINITY);
    // The box stands on its bottom; nothing else is hidden.
    assert_eq!(light.hidden, 4);
    let scene = evaluator.solution().scene();
    let mut radiosity = light.radiosity.iter();
    for surface in scene.surfaces() {
        let normal = surface.polygon.normal();
        let is_bottom = surface.material == 1 && normal[2] < -0.5;
        for b in radiosity.by_ref().take(surface.polygon.vertices().len()) {
            assert!(if is_bottom { *b == 0.0 } else { *b > 0.1 }, "{normal:?}: {b}");
        }
    }
    let only = BakeOptions { only: Some(Only::Material("m1".to_owned())), ..BakeOptions::default() };
    assert_eq!(evaluator.bake_vertices(&only, 0.1, &Silent).unwrap().unwrap().surfaces.len(), 6);
}

#[test]
fn files_have_the_light_at_vertices_of_faces() {
    let (evaluator, light) = baked(cube(&[0.5, 0.6, 0.7], &[1.0, 0.5, 0.25]), f64::INFINITY);
    let solution = evaluator.solution();
    let provenance = Provenance::new(solution.options());
    let written = |format| {
        let mut file = Vec::new();
        export_vertex_light(&mut file, format, solution, &light, &provenance).unwrap();
        file
    };
    let bytes: Vec<u8> = light.radiosity.iter().flat_map(|b| b.to_le_bytes()).collect();

    let ply = written(ExportFormat::Ply);
    let end = ply.windows(11).position(|bytes| bytes == b"end_header\n").unwrap() + 11;
    let header = String::from_utf8(ply[..end].to_vec()).unwrap();
    for line in
        ["element vertex 24", "property float B_r", "element face 6", "property uint surface", "comment quantity: radiosity"]
    {
        assert!(header.contains(line), "{header}");
    }
    let vertices: Vec<u8> = ply[end..end + 24 * 36].chunks(36).flat_map(|vertex| vertex[24..].to_vec()).collect();
    assert_eq!(vertices, bytes);
    // A face: how many, four indices, the surface; face, material, object and group.
    assert_eq!(ply.len() - end - 24 * 36, 6 * (21 + 16));

    let glb = written(ExportFormat::Glb);
    let (json, binary) = chunks(&glb);
    let mut found = Vec::new();
    for mesh in json["meshes"].as_array().unwrap() {
        let attributes = &mesh["primitives"][0]["attributes"];
        assert!(attributes["COLOR_0"].is_number());
        let accessor = &json["accessors"][attributes["_RADIOSITY"].as_u64().unwrap() as usize];
        let view = &json["bufferViews"][accessor["bufferView"].as_u64().unwrap() as usize];
        let [start, length] = ["byteOffset", "byteLength"].map(|key| view[key].as_u64().unwrap() as usize);
        found.extend_from_slice(&binary[start..start + length]);
    }
    assert_eq!(found, bytes);
    assert!(written(ExportFormat::Vtp).len() > 1000);
}
