//! GLB files made by hand.
#![allow(dead_code, reason = "each test uses a part")]

use std::collections::BTreeMap;

use patchlight::scene::Scene;
use serde_json::{Value, json};

/// JSON and binary chunk, put together piece by piece.
pub struct Maker {
    pub json: Value,
    pub binary: Vec<u8>,
}

impl Maker {
    pub fn new() -> Self {
        let json = json!({
            "asset": { "version": "2.0" }, "scene": 0, "scenes": [{ "nodes": [] }], "nodes": [], "meshes": [], "accessors": [],
            "bufferViews": [], "buffers": [], "materials": [], "textures": [], "images": [], "samplers": [],
            "extensionsUsed": [], "extensionsRequired": [],
        });
        Self { json, binary: Vec::new() }
    }

    /// Adds to a list of the JSON: the number of what was added.
    pub fn add(&mut self, list: &str, value: Value) -> usize {
        let list = self.json[list].as_array_mut().unwrap();
        list.push(value);
        list.len() - 1
    }

    pub fn view(&mut self, bytes: &[u8]) -> usize {
        self.binary.resize(self.binary.len().next_multiple_of(4), 0);
        let offset = self.binary.len();
        self.binary.extend_from_slice(bytes);
        self.add("bufferViews", json!({ "buffer": 0, "byteOffset": offset, "byteLength": bytes.len() }))
    }

    /// An accessor of floats.
    pub fn floats<const N: usize>(&mut self, vectors: &[[f32; N]]) -> usize {
        let bytes: Vec<u8> = vectors.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
        let view = self.view(&bytes);
        let of = |pick: fn(f32, f32) -> f32| -> Vec<f32> {
            (0..N).map(|k| vectors.iter().map(|vector| vector[k]).reduce(pick).unwrap_or(0.0)).collect()
        };
        let kind = ["SCALAR", "VEC2", "VEC3", "VEC4"][N - 1];
        let (least, most) = (of(f32::min), of(f32::max));
        let accessor =
            json!({ "bufferView": view, "componentType": 5126, "count": vectors.len(), "type": kind, "min": least, "max": most });
        self.add("accessors", accessor)
    }

    /// An accessor of whole numbers.
    pub fn indices(&mut self, indices: &[u32]) -> usize {
        let bytes: Vec<u8> = indices.iter().flat_map(|x| x.to_le_bytes()).collect();
        let view = self.view(&bytes);
        self.add("accessors", json!({ "bufferView": view, "componentType": 5125, "count": indices.len(), "type": "SCALAR" }))
    }

    /// A mesh of one primitive.
    pub fn mesh(&mut self, primitive: Value) -> usize {
        self.add("meshes", json!({ "primitives": [primitive] }))
    }

    /// A node at the top of the scene.
    pub fn node(&mut self, node: Value) -> usize {
        let number = self.add("nodes", node);
        self.json["scenes"][0]["nodes"].as_array_mut().unwrap().push(json!(number));
        number
    }

    /// The JSON as it is written: without empty lists.
    fn text(&self) -> String {
        let mut json = self.json.clone();
        json.as_object_mut().unwrap().retain(|_, value| value.as_array().is_none_or(|list| !list.is_empty()));
        json.to_string()
    }

    /// The file.
    pub fn glb(&mut self) -> Vec<u8> {
        self.binary.resize(self.binary.len().next_multiple_of(4), 0);
        if !self.binary.is_empty() {
            self.json["buffers"] = json!([{ "byteLength": self.binary.len() }]);
        }
        glb_of(self.text().as_bytes(), &self.binary)
    }
}

/// A GLB file of its two chunks.
pub fn glb_of(json: &[u8], binary: &[u8]) -> Vec<u8> {
    let mut json = json.to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let length = 12 + 8 + json.len() + if binary.is_empty() { 0 } else { 8 + binary.len() };
    let mut file = [&b"glTF"[..], &2_u32.to_le_bytes(), &(length as u32).to_le_bytes()].concat();
    for (kind, body) in [(b"JSON", &json[..]), (b"BIN\0", binary)] {
        if !body.is_empty() {
            file.extend((body.len() as u32).to_le_bytes());
            file.extend(kind);
            file.extend(body);
        }
    }
    file
}

/// A room of 2 m, closed, seen from inside, with a lamp under its ceiling: indexed triangles, a textured floor, nested nodes.
pub fn small_room() -> Maker {
    let mut maker = Maker::new();
    let corner = |k: usize| [k & 1, k >> 1 & 1, k >> 2].map(|bit| 2.0 * bit as f32);
    let corners = maker.floats(&std::array::from_fn::<_, 8, _>(corner));
    let inwards = [[0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3], [0, 1, 3, 2], [4, 6, 7, 5]];
    let indices: Vec<u32> = inwards[1..].iter().flat_map(|&[a, b, c, d]| [a, b, c, a, c, d]).collect();
    let indices = maker.indices(&indices);
    let wall = maker.add(
        "materials",
        json!({ "name": "wall", "pbrMetallicRoughness": { "baseColorFactor": [0.6, 0.5, 0.4, 1.0], "metallicFactor": 0.0 } }),
    );
    let walls = maker.mesh(json!({ "attributes": { "POSITION": corners }, "indices": indices, "material": wall }));
    maker.node(json!({ "name": "room", "mesh": walls }));

    let image = maker.view(&checkers());
    maker.add("images", json!({ "bufferView": image, "mimeType": "image/png" }));
    let texture = maker.add("textures", json!({ "source": 0 }));
    let pbr = json!({ "baseColorTexture": { "index": texture }, "baseColorFactor": [0.5, 0.5, 0.5, 1.0], "metallicFactor": 0.0 });
    let floor = maker.add("materials", json!({ "name": "floor", "pbrMetallicRoughness": pbr }));
    let at = maker.floats(&[[0.0, 0.0, 0.0], [0.0, 0.0, 2.0], [2.0, 0.0, 0.0], [2.0, 0.0, 2.0]]);
    let uv = maker.floats(&[[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0]]);
    let floor = maker.mesh(json!({ "attributes": { "POSITION": at, "TEXCOORD_0": uv }, "material": floor, "mode": 5 }));
    maker.node(json!({ "name": "floor", "mesh": floor }));

    let strength = json!({ "KHR_materials_emissive_strength": { "emissiveStrength": 4.0 } });
    let black = json!({ "baseColorFactor": [0.0, 0.0, 0.0, 1.0], "metallicFactor": 0.0 });
    let lamp = json!({ "name": "lamp", "emissiveFactor": [1.0, 0.75, 0.5], "extensions": strength, "pbrMetallicRoughness": black });
    let lamp = maker.add("materials", lamp);
    maker.json["extensionsUsed"] = json!(["KHR_materials_emissive_strength"]);
    let at = maker.floats(&[[-0.5, 0.0, -0.5], [0.5, 0.0, -0.5], [0.5, 0.0, 0.5], [-0.5, 0.0, 0.5]]);
    let lamp = maker.mesh(json!({ "attributes": { "POSITION": at }, "material": lamp, "mode": 6 }));
    let lamp = maker.add("nodes", json!({ "name": "lamp", "mesh": lamp, "scale": [0.6, 1.0, 0.6] }));
    maker.node(json!({ "name": "ceiling", "translation": [1.0, 1.99, 1.0], "children": [lamp] }));
    maker
}

/// A PNG of 2 x 2 pixels: white and black in turn.
pub fn checkers() -> Vec<u8> {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, 2, 2);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.write_header().unwrap().write_image_data(&[255, 0, 0, 255]).unwrap();
    file
}

/// A scene as a GLB: a node for each material, turned and moved, with its surfaces as triangles that have vertices of their own.
pub fn scene_as_glb(scene: &Scene) -> Vec<u8> {
    let mut maker = Maker::new();
    let mut of_material: BTreeMap<u32, Vec<[f32; 3]>> = BTreeMap::new();
    for surface in scene.surfaces() {
        let corners: Vec<[f64; 3]> = surface.polygon.vertices().collect();
        // The node turns by 90 degrees around y, then moves along x: here the other way round.
        let own = |k: usize| [-corners[k][2], corners[k][1], corners[k][0] - 8.0].map(|x| x as f32);
        let triangles = (1..corners.len() - 1).flat_map(|k| [own(0), own(k), own(k + 1)]);
        of_material.entry(surface.material).or_default().extend(triangles);
    }
    let half = 0.5_f64.sqrt();
    for (number, positions) in of_material {
        let material = &scene.materials()[number as usize];
        let color = [material.reflectance[0], material.reflectance[1], material.reflectance[2], 1.0];
        let radiance: Vec<f64> = material.exitance.iter().map(|e| e / std::f64::consts::PI).collect();
        let most = radiance.iter().copied().fold(1.0, f64::max);
        let factor: Vec<f64> = radiance.iter().map(|l| l / most).collect();
        let pbr = json!({ "baseColorFactor": color, "metallicFactor": 0.0 });
        let strength = json!({ "KHR_materials_emissive_strength": { "emissiveStrength": most } });
        let material =
            json!({ "name": material.name, "pbrMetallicRoughness": pbr, "emissiveFactor": factor, "extensions": strength });
        let material = maker.add("materials", material);
        let positions = maker.floats(&positions);
        let mesh = maker.mesh(json!({ "attributes": { "POSITION": positions }, "material": material }));
        maker.node(json!({ "mesh": mesh, "rotation": [0.0, half, 0.0, half], "translation": [8.0, 0.0, 0.0] }));
    }
    maker.json["extensionsUsed"] = json!(["KHR_materials_emissive_strength"]);
    maker.glb()
}
