//! Bad files: each is refused with the reason, and none does harm.

use serde_json::{Value, json};

use super::glb::{Maker, glb_of, small_room};
use super::read;

/// The error of a small room in which something was changed.
fn error_of(change: impl FnOnce(&mut Maker)) -> String {
    let mut maker = small_room();
    maker.glb();
    change(&mut maker);
    let mut json = maker.json.clone();
    json.as_object_mut().unwrap().retain(|_, value| value.as_array().is_none_or(|list| !list.is_empty()));
    read(&glb_of(json.to_string().as_bytes(), &maker.binary)).expect_err("a bad file").to_string()
}

/// The same where one value of the JSON is replaced.
fn error_with(pointer: &str, value: Value) -> String {
    error_of(|maker| match maker.json.pointer_mut(pointer) {
        Some(place) => *place = value,
        None => {
            let (parent, key) = pointer.rsplit_once('/').unwrap();
            maker.json.pointer_mut(parent).unwrap()[key] = value;
        }
    })
}

#[test]
fn each_mistake_is_told() {
    let cases = [
        ("/asset/version", json!("1.0"), "glTF version '1.0'"),
        ("/extensionsRequired", json!(["KHR_draco_mesh_compression"]), "requires the extension KHR_draco_mesh_compression"),
        ("/scene", json!(7), "scene 7 does not exist"),
        ("/scenes/0/nodes/0", json!(70), "node 70 does not exist"),
        ("/nodes/2/children", json!([3]), "'ceiling' (node 3) is reached twice"),
        ("/nodes/3/children", json!([2, 2]), "'lamp' (node 2) is reached twice"),
        ("/nodes/0/rotation", json!([0, 0, 0, 0]), "the rotation of 'room' (node 0) is no transform"),
        ("/nodes/0/mesh", json!(9), "'room': mesh 9 does not exist"),
        ("/nodes/0/scale", json!([1e300, 1e300, 1e300]), "room: vertex 1, counted from 0, has a coordinate"),
        ("/meshes/0/primitives/0/mode", json!(9), "room: mode 9"),
        ("/meshes/0/primitives/0/indices", json!(99), "room: accessor 99 does not exist"),
        ("/meshes/0/primitives/0/attributes", json!({}), "room: it has no POSITION"),
        ("/meshes/0/primitives/0/attributes/POSITION", json!("x"), "room: its POSITION is \"x\""),
        ("/meshes/0/primitives/0/attributes/POSITION", json!(1), "room: accessor 1 has the type 'SCALAR'"),
        ("/meshes/0/primitives/0/material", json!(5), "room: material 5 does not exist"),
        ("/meshes/0/primitives/0/extensions", json!({ "EXT_meshopt_compression": {} }), "room: it is compressed by EXT_meshopt"),
        ("/meshes/1/primitives/0/attributes/TEXCOORD_0", json!(0), "floor: it has more or fewer TEXCOORD_0 than vertices"),
        ("/materials/1/pbrMetallicRoughness/baseColorTexture/index", json!(3), "texture 3 does not exist"),
        ("/materials/0/pbrMetallicRoughness/baseColorFactor", json!([1e40, 0, 0, 1]), "a value of material 'wall' is"),
        ("/images/0/bufferView", json!(0), "image 0: it is neither PNG nor JPEG"),
        ("/accessors/0/count", json!(1_000_000_000), "accessor 0 has 1000000000 items of 12 bytes, more than the 96 bytes"),
        ("/accessors/0/count", json!(u64::MAX), "accessor 0 has"),
        ("/accessors/0/byteOffset", json!(u64::MAX), "accessor 0 has"),
        ("/accessors/0/componentType", json!(1), "unknown componentType 1"),
        ("/accessors/0/bufferView", json!(null), "accessor 0 has no bufferView, so no data"),
        ("/accessors/1/count", json!(-1), "the JSON is no glTF 2.0"),
        ("/bufferViews/0/byteLength", json!(1u64 << 40), "bufferView 0 has 1099511627776 bytes from byte 0 on, but buffer 0 has"),
        ("/bufferViews/0/byteOffset", json!(u64::MAX), "bufferView 0 has"),
        ("/bufferViews/0/byteStride", json!(4), "byteStride of 4, but items of 12 bytes"),
        ("/bufferViews/0/buffer", json!(3), "is of buffer 3, which does not exist"),
        ("/buffers/0/byteLength", json!(1_000_000_000), "buffer 0 should have 1000000000 bytes and has"),
        ("/buffers/0/uri", json!("missing.bin"), "buffer 0 cannot be read: missing.bin: No such file"),
        ("/buffers/0/uri", json!("https://a/b.bin"), "buffer 0 cannot be read: 'https://a/b.bin' lies on no disk"),
        ("/buffers/0/uri", json!("data:;base64,@@"), "buffer 0 cannot be read: its data URI is no base64"),
    ];
    for (pointer, value, expected) in cases {
        let error = error_with(pointer, value.clone());
        assert!(error.contains("a.glb: ") && error.contains(expected), "{pointer} = {value}: {error}");
    }
}

#[test]
fn vertices_and_indices_are_checked() {
    // Corner 1 of the room is (2, 0, 0); the first index of the walls is 2.
    let with_bytes = |at: usize, bytes: [u8; 4]| error_of(|maker| maker.binary[at..at + 4].copy_from_slice(&bytes));
    assert!(with_bytes(12, f32::NAN.to_le_bytes()).contains("room: vertex 1, counted from 0, has a coordinate"));
    assert!(with_bytes(16, f32::INFINITY.to_le_bytes()).contains("room: vertex 1, counted from 0"));
    assert!(with_bytes(96, 8_u32.to_le_bytes()).contains("room: it has an index 8, but 8 vertices"));
}

#[test]
fn images_of_too_many_pixels_are_not_decoded() {
    let mut png = Vec::new();
    png::Encoder::new(&mut png, 40_000, 25_000).write_header().unwrap();
    let error = error_of(|maker| {
        let view = maker.view(&png);
        maker.json["images"][0]["bufferView"] = json!(view);
        maker.json["buffers"][0]["byteLength"] = json!(maker.binary.len());
    });
    assert!(error.contains("image 0: it has 40000 x 25000 pixels, and may have 67108864"), "{error}");
}

#[test]
fn a_few_nodes_cannot_make_a_scene_of_any_size() {
    let mut maker = Maker::new();
    let positions = maker.floats(&vec![[0.0; 3]; 30_000]);
    let mesh = maker.mesh(json!({ "attributes": { "POSITION": positions } }));
    for _ in 0..2000 {
        maker.node(json!({ "mesh": mesh }));
    }
    let error = read(&maker.glb()).expect_err("too many triangles").to_string();
    assert!(error.contains("the scene has more than 16777216 triangles, copies of meshes counted"), "{error}");
}

#[test]
fn deep_trees_are_walked() {
    let mut maker = small_room();
    let first = maker.json["nodes"].as_array().unwrap().len();
    for k in 0..200_000 {
        maker.add("nodes", json!({ "children": [first + k + 1] }));
    }
    maker.add("nodes", json!({}));
    maker.json["scenes"][0]["nodes"].as_array_mut().unwrap().push(json!(first));
    assert_eq!(read(&maker.glb()).unwrap().scene.surfaces().len(), 7);
}

#[test]
fn files_that_are_cut_off_are_refused() {
    let whole = small_room().glb();
    for length in 0..whole.len() {
        let error = read(&whole[..length]).expect_err("a part of a file").to_string();
        assert!(error.starts_with('/') && error.contains("a.glb: "), "{error}");
    }
    // The header may be cut to fit as well.
    for length in 12..whole.len() {
        let mut part = whole[..length].to_vec();
        part[8..12].copy_from_slice(&(length as u32).to_le_bytes());
        read(&part).expect_err("a part of a file");
    }
    for length in 0..12_u32 {
        let mut part = whole.clone();
        part[8..12].copy_from_slice(&length.to_le_bytes());
        read(&part).expect_err("a file that says it is shorter than its header");
    }
}
