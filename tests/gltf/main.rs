//! glTF scenes: what is read of them, whatever way it is written; what is said of the rest; and that bad files are refused.

mod bad;
mod furnished_room;
#[path = "../support/glb.rs"]
mod glb;
mod lights;
#[path = "../support/same_light.rs"]
mod same_light;

use std::f64::consts::PI;

use glb::{Maker, checkers, glb_of, small_room};
use patchlight::scene::Surface;
use patchlight::scene::import::{DiagnosticKind, ImportError, ImportOptions, Imported, Textures, read_scene};
use serde_json::{Value, json};

fn read_with(name: &str, bytes: &[u8], options: &ImportOptions) -> Result<Imported, ImportError> {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join(name);
    std::fs::write(&file, bytes).unwrap();
    read_scene(&file, options)
}

fn read(bytes: &[u8]) -> Result<Imported, ImportError> {
    read_with("a.glb", bytes, &ImportOptions::default())
}

fn texts(imported: &Imported) -> Vec<(DiagnosticKind, String)> {
    let items = imported.diagnostics.items.iter();
    items.map(|item| (item.kind, item.text.clone())).filter(|(kind, _)| *kind != DiagnosticKind::NoLight).collect()
}

/// A vertex on a grid of 1e-6 m.
fn grid(vertex: [f64; 3]) -> [i64; 3] {
    vertex.map(|x| (1e6 * x).round() as i64)
}

/// The vertices of a surface from the least on.
fn corners(surface: &Surface) -> Vec<[i64; 3]> {
    let mut corners: Vec<[i64; 3]> = surface.polygon.vertices().map(grid).collect();
    let least = (0..corners.len()).min_by_key(|&k| corners[k]).unwrap();
    corners.rotate_left(least);
    corners
}

#[test]
fn a_room_has_its_surfaces_materials_and_names() {
    let imported = read(&small_room().glb()).unwrap();
    let scene = &imported.scene;
    assert_eq!(texts(&imported), []);
    assert_eq!(scene.surfaces().len(), 7);
    assert_eq!(scene.objects().names(), ["room (wall)", "floor (floor)", "lamp (lamp)"]);
    let of: Vec<Option<usize>> = (0..15).map(|face| scene.objects().of(face)).collect();
    assert_eq!(of, [[Some(0); 10].as_slice(), &[Some(1); 2], &[Some(2); 2], &[None]].concat());
    assert_eq!(scene.objects().name_of(13), Some("lamp (lamp)"));
    assert_eq!(imported.lines.len(), 14);

    // Base colour is reflectance, of a texture half white and half black the half; emission is a radiance, times pi.
    let material = |name: &str| scene.materials().iter().find(|material| material.name == name).unwrap();
    assert_eq!(material("wall").reflectance, [0.6, 0.5, 0.4]);
    assert!(material("floor").reflectance.iter().all(|rho| (rho - 0.25).abs() < 1e-12), "{:?}", material("floor"));
    assert_eq!(material("lamp").exitance, [1.0, 0.75, 0.5].map(|factor| PI * 4.0 * factor));

    // Fronts are inside, the lamp looks down, and lies where its nodes say.
    for surface in scene.surfaces() {
        let (centre, normal) = (surface.polygon.centroid(), surface.polygon.normal());
        let inwards: f64 = (0..3).map(|k| normal[k] * (1.0 - centre[k])).sum();
        assert!(inwards > 0.0);
    }
    let lamp = scene.surfaces().iter().find(|surface| surface.material == 2).unwrap();
    assert!((lamp.polygon.area() - 0.36).abs() < 1e-12 && lamp.polygon.normal() == [0.0, -1.0, 0.0]);
    assert!((lamp.polygon.centroid()[1] - 1.99).abs() < 1e-12);
}

/// A square of 1 m in a corner, in a scene with a material of its own.
fn square(make: impl FnOnce(&mut Maker) -> Value) -> Vec<u8> {
    let mut maker = Maker::new();
    let pbr = json!({ "baseColorFactor": [0.5, 0.5, 0.5, 1.0], "metallicFactor": 0.0 });
    maker.add("materials", json!({ "pbrMetallicRoughness": pbr }));
    let mut primitive = make(&mut maker);
    primitive["material"] = json!(0);
    let mesh = maker.mesh(primitive);
    maker.node(json!({ "mesh": mesh }));
    maker.glb()
}

const CORNERS: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];

/// An accessor of vectors of three of one type of component, each on its own 4 or 8 bytes.
fn quantised(maker: &mut Maker, component: u32, numbers: &[Vec<u8>], normalized: bool) -> usize {
    let stride = numbers[0].len().next_multiple_of(4);
    let bytes: Vec<u8> =
        numbers.iter().flat_map(|of_vertex| [&of_vertex[..], &vec![0xee; stride - of_vertex.len()]].concat()).collect();
    let view = maker.view(&bytes);
    maker.json["bufferViews"][view]["byteStride"] = json!(stride);
    maker.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    let count = numbers.len();
    let accessor =
        json!({ "bufferView": view, "componentType": component, "count": count, "type": "VEC3", "normalized": normalized });
    maker.add("accessors", accessor)
}

/// Two triangles of the square's corners.
const INDICES: [u32; 6] = [0, 1, 2, 0, 2, 3];

fn indexed(maker: &mut Maker, positions: usize) -> Value {
    json!({ "attributes": { "POSITION": positions }, "indices": maker.indices(&INDICES) })
}

/// The square as numbers of one type, each made by `of`.
fn square_of_numbers(component: u32, normalized: bool, of: impl Fn(f32) -> Vec<u8>) -> Vec<u8> {
    let numbers = CORNERS.map(|corner| corner.iter().flat_map(|&x| of(x)).collect::<Vec<u8>>());
    square(|maker| {
        let positions = quantised(maker, component, &numbers, normalized);
        indexed(maker, positions)
    })
}

/// The square with some corners that stand apart: `dense` floats, or zeros if there are none.
fn sparse_square(dense: Option<[[f32; 3]; 4]>, replaced: &[u16]) -> Vec<u8> {
    square(|maker| {
        let values: Vec<u8> = replaced.iter().flat_map(|&k| CORNERS[usize::from(k)]).flat_map(f32::to_le_bytes).collect();
        let places: Vec<u8> = replaced.iter().flat_map(|k| k.to_le_bytes()).collect();
        let (places, values) = (maker.view(&places), maker.view(&values));
        let places = json!({ "bufferView": places, "componentType": 5123 });
        let sparse = json!({ "count": replaced.len(), "indices": places, "values": { "bufferView": values } });
        let positions = match dense {
            Some(dense) => maker.floats(&dense),
            None => maker.add("accessors", json!({ "componentType": 5126, "count": 4, "type": "VEC3" })),
        };
        maker.json["accessors"][positions]["sparse"] = sparse;
        indexed(maker, positions)
    })
}

#[test]
fn one_square_is_the_same_however_it_is_written() {
    let strip = [CORNERS[0], CORNERS[1], CORNERS[3], CORNERS[2]];
    let of_mode =
        |mode: u32, corners: &[[f32; 3]]| square(|m| json!({ "attributes": { "POSITION": m.floats(corners) }, "mode": mode }));
    let with_indices = square(|maker| {
        let positions = maker.floats(&CORNERS);
        indexed(maker, positions)
    });
    let ways: [(&str, Vec<u8>); 9] = [
        ("triangles", of_mode(4, &INDICES.map(|k| CORNERS[k as usize]))),
        ("indices", with_indices),
        ("strip", of_mode(5, &strip)),
        ("fan", of_mode(6, &CORNERS)),
        ("bytes", square_of_numbers(5121, false, |x| vec![x as u8])),
        ("signed", square_of_numbers(5120, true, |x| vec![(127.0 * x) as u8])),
        ("shorts", square_of_numbers(5123, true, |x| ((65535.0 * x) as u16).to_le_bytes().to_vec())),
        ("sparse", sparse_square(Some([[9.0; 3], CORNERS[1], [7.0; 3], CORNERS[3]]), &[0, 2])),
        ("zeros", sparse_square(None, &[1, 2, 3])),
    ];
    let expected = CORNERS.map(|corner| grid(corner.map(f64::from)));
    for (way, file) in ways {
        let imported = read(&file).unwrap_or_else(|error| panic!("{way}: {error}"));
        assert_eq!(imported.scene.surfaces().len(), 1, "{way}");
        assert_eq!(corners(&imported.scene.surfaces()[0]), expected, "{way}");
    }
}

#[test]
fn mirrors_keep_fronts_and_double_sides_make_sheets() {
    let mut maker = Maker::new();
    let grey = json!({ "baseColorFactor": [0.5, 0.5, 0.5, 1.0], "metallicFactor": 0.0 });
    for sided in [false, true] {
        maker.add("materials", json!({ "pbrMetallicRoughness": grey, "doubleSided": sided }));
    }
    let positions = maker.floats(&CORNERS);
    for material in 0..2 {
        maker.mesh(json!({ "attributes": { "POSITION": positions }, "mode": 6, "material": material }));
    }
    // Mirrored twice is not mirrored; a matrix may mirror as well.
    let mirrored = json!({ "mesh": 0, "scale": [-1.0, 1.0, 1.0] });
    let inner = maker.add("nodes", mirrored.clone());
    maker.node(mirrored);
    maker.node(json!({ "scale": [1.0, -1.0, 1.0], "translation": [0.0, 0.0, 1.0], "children": [inner] }));
    maker.node(json!({ "mesh": 0, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, 0, 0, 0, 5, 1] }));
    maker.node(json!({ "mesh": 1, "translation": [0.0, 0.0, 9.0] }));
    let imported = read(&maker.glb()).unwrap();
    let normals: Vec<f64> = imported.scene.surfaces().iter().map(|surface| surface.polygon.normal()[2]).collect();
    assert_eq!(normals, [1.0, 1.0, -1.0, 1.0, -1.0]);
    let twins: Vec<bool> = imported.scene.surfaces().iter().map(|surface| surface.twin().is_some()).collect();
    assert_eq!(twins, [false, false, false, true, true]);
    assert_eq!(texts(&imported), []);
}

#[test]
fn copies_of_a_mesh_stand_where_they_should() {
    let mut maker = Maker::new();
    let positions = maker.floats(&CORNERS);
    let mesh = maker.mesh(json!({ "attributes": { "POSITION": positions }, "mode": 6 }));
    let half = 0.5_f32.sqrt();
    let (at, turned) =
        (maker.floats(&[[0.0, 0.0, 1.0], [0.0, 0.0, 2.0]]), maker.floats(&[[0.0, 0.0, 0.0, 1.0], [0.0, half, 0.0, half]]));
    let instancing = json!({ "EXT_mesh_gpu_instancing": { "attributes": { "TRANSLATION": at, "ROTATION": turned } } });
    maker.json["extensionsRequired"] = json!(["EXT_mesh_gpu_instancing"]);
    maker.node(json!({ "mesh": mesh, "scale": [2.0, 2.0, 2.0], "extensions": instancing }));
    let scene = read(&maker.glb()).unwrap().scene;
    let found: Vec<_> = scene.surfaces().iter().map(|s| (grid(s.polygon.centroid()), grid(s.polygon.normal()))).collect();
    assert_eq!(found, [([1_000_000, 1_000_000, 2_000_000], [0, 0, 1_000_000]), ([0, 1_000_000, 3_000_000], [1_000_000, 0, 0])]);
}

#[test]
fn what_is_not_diffuse_is_said() {
    let mut maker = small_room();
    let wall = &mut maker.json["materials"][0];
    wall["pbrMetallicRoughness"]["metallicFactor"] = json!(1.0);
    wall["pbrMetallicRoughness"]["baseColorFactor"] = json!([1.0, 0.5, 0.4, 0.5]);
    wall["alphaMode"] = json!("BLEND");
    wall["extensions"] = json!({ "KHR_materials_transmission": { "transmissionFactor": 1.0 } });
    maker.json["meshes"][1]["primitives"][0]["targets"] = json!([{}]);
    maker.json["meshes"][2]["primitives"].as_array_mut().unwrap().push(json!({ "attributes": { "POSITION": 0 }, "mode": 1 }));
    maker.json["cameras"] = json!([{ "type": "perspective", "perspective": { "yfov": PI / 3.0, "znear": 0.1 } }]);
    maker.node(json!({ "camera": 0, "translation": [1.0, 1.0, 0.5], "rotation": [0.0, 1.0, 0.0, 0.0] }));
    let imported = read(&maker.glb()).unwrap();
    let told: Vec<String> = texts(&imported).into_iter().map(|(_, text)| text).collect();
    let parts = [
        "metals reflect their base colour into all directions: materials are diffuse (material 'wall')",
        "alphaMode is left out: what is transparent is taken as opaque (material 'wall')",
        "transmission is left out: glass reflects its base colour, and nothing goes through (material 'wall')",
        "base colours of 1 and more become 0.99 (material 'wall')",
        "morph targets are left out: meshes have their base shapes",
        "1 primitives of points or lines are left out: they do not reflect light",
    ];
    for part in parts {
        assert!(told.iter().any(|text| text == part), "{part}: {told:?}");
    }
    let camera =
        told.iter().find(|text| text.starts_with("the first of 1 cameras is --camera 'eye=1,1,0.5 target=1,1,1.5")).unwrap();
    assert!(camera.ends_with("up=0,1,0 fov=60'") || camera.contains("fov=59.99999") || camera.contains("fov=60"), "{camera}");
    assert_eq!(told.len(), parts.len() + 1, "{told:?}");
    assert_eq!(imported.scene.materials()[0].reflectance[0], 0.99);
}

#[test]
fn textures_are_averaged_over_faces_or_refused() {
    // Two squares with one texture: over the left half of the image, and over all of it four times.
    let mut maker = Maker::new();
    let image = maker.view(&checkers());
    maker.add("images", json!({ "bufferView": image }));
    maker.add("textures", json!({ "source": 0 }));
    let pbr = json!({ "baseColorTexture": { "index": 0 }, "baseColorFactor": [0.8, 0.4, 0.2, 1.0], "metallicFactor": 0.0 });
    let glow = json!({ "index": 0, "extensions": { "KHR_texture_transform": { "offset": [0.5, 0.0], "scale": [0.25, 0.25] } } });
    maker.add("materials", json!({ "pbrMetallicRoughness": pbr, "emissiveFactor": [1, 1, 1], "emissiveTexture": glow }));
    let positions = maker.floats(&CORNERS);
    for (k, uv) in
        [[[0.0, 0.0], [0.5, 0.0], [0.5, 0.5], [0.0, 0.5]], [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]]].iter().enumerate()
    {
        let uv = maker.floats(uv);
        let mesh = maker.mesh(json!({ "attributes": { "POSITION": positions, "TEXCOORD_0": uv }, "mode": 6, "material": 0 }));
        maker.node(json!({ "mesh": mesh, "translation": [0.0, 0.0, k] }));
    }
    let file = maker.glb();
    let imported = read(&file).unwrap();
    let material = |k: usize| &imported.scene.materials()[imported.scene.surfaces()[k].material as usize];
    let is_near = |found: &[f64], expected: [f64; 3]| found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 0.01);
    // The upper left quarter of the image is white, and its upper right one black.
    assert!(is_near(&material(0).reflectance, [0.8, 0.4, 0.2]) && is_near(&material(0).exitance, [0.0; 3]), "{:?}", material(0));
    assert!(is_near(&material(1).reflectance, [0.4, 0.2, 0.1]) && is_near(&material(1).exitance, [0.0; 3]), "{:?}", material(1));

    let reject = ImportOptions { textures: Textures::Reject, ..ImportOptions::default() };
    let error = read_with("a.glb", &file, &reject).unwrap_err().to_string();
    assert!(error.ends_with("node 0: its material has a texture, and --texture reject wants none"), "{error}");
}

#[test]
fn buffers_may_stand_in_the_json_or_beside_it() {
    use base64::Engine as _;
    let mut maker = small_room();
    let expected = read(&maker.glb()).unwrap().scene;

    // In the JSON.
    let data = base64::engine::general_purpose::STANDARD.encode(&maker.binary);
    maker.json["buffers"][0]["uri"] = json!(format!("data:application/octet-stream;base64,{data}"));
    let text = |maker: &Maker| {
        let mut json = maker.json.clone();
        json.as_object_mut().unwrap().retain(|_, value| value.as_array().is_none_or(|list| !list.is_empty()));
        json.to_string()
    };
    let inline = read_with("a.gltf", text(&maker).as_bytes(), &ImportOptions::default()).unwrap();
    assert_eq!(inline.scene, expected);

    // Beside it; elsewhere only if that is allowed.
    let folder = tempfile::tempdir().unwrap();
    let (inner, file) = (folder.path().join("inner"), folder.path().join("inner/a.gltf"));
    std::fs::create_dir_all(inner.join("data")).unwrap();
    std::fs::write(inner.join("data/a b.bin"), &maker.binary).unwrap();
    std::fs::write(folder.path().join("outer.bin"), &maker.binary).unwrap();
    maker.json["buffers"][0]["uri"] = json!("data/a%20b.bin");
    std::fs::write(&file, text(&maker)).unwrap();
    let beside = read_scene(&file, &ImportOptions::default()).unwrap();
    assert_eq!((beside.scene, beside.libraries), (expected.clone(), vec![inner.join("data/a b.bin")]));

    maker.json["buffers"][0]["uri"] = json!("../outer.bin");
    std::fs::write(&file, text(&maker)).unwrap();
    let error = read_scene(&file, &ImportOptions::default()).unwrap_err().to_string();
    assert!(error.ends_with("../outer.bin lies outside of the folder of the scene; allow that by --allow-any-path"), "{error}");
    let allowed = read_scene(&file, &ImportOptions { allow_any_path: true, ..ImportOptions::default() }).unwrap();
    assert_eq!(allowed.scene, expected);
}

#[test]
fn a_file_without_triangles_is_no_scene() {
    assert!(matches!(read(&glb_of(br#"{"asset":{"version":"2.0"}}"#, &[])), Err(ImportError::NoFaces { read: 0, dropped: 0, .. })));
}
