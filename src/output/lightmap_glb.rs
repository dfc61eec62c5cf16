//! The scene with its lightmap as binary glTF 2.0: every viewer shows it as it is lit.
//!
//! A node with a mesh for each object, group and page, whose `extras` name the first two. Vertices have coordinates on the page as `TEXCOORD_1`, where
//! engines look for lightmaps, and the same as
//! `TEXCOORD_0`, which the format asks for, and as `_FACE` the number of their face in the input from 0; materials show the page unlit (KHR_materials_unlit), exposed and in sRGB. `asset.extras` states what a
//! lightmap's file states, and the exposure EV.

use std::collections::BTreeMap;
use std::io::{self, Write};

use serde_json::{Value, json};

use super::glb::{FLOAT, File, UNSIGNED_INT, with_bounds};
use super::lightmap_png::{LightmapCode, write_lightmap_png};
use super::{Provenance, Quantity};
use crate::bake::{FaceOnAtlas, Lightmap};
use crate::scene::Scene;

/// How textures are sampled: linear, and clamped at the edges of a page (numbers of OpenGL).
const LINEAR: u32 = 9729;
const CLAMP_TO_EDGE: u32 = 33071;

/// Writes the faces that were baked, with their pages at an exposure of `ev`.
///
/// # Errors
/// What the writer says, and an error if the file would be larger than the 4 GiB of the format.
pub fn write_lightmap_glb(
    writer: &mut impl Write,
    scene: &Scene,
    lightmap: &Lightmap,
    ev: f64,
    provenance: &Provenance,
) -> io::Result<()> {
    // Faces by page, object and group.
    let mut parts: BTreeMap<(usize, Option<usize>, Option<usize>), Vec<FaceOnAtlas>> = BTreeMap::new();
    for face in lightmap.atlas.faces(scene) {
        let number = scene.surfaces()[face.surface as usize].face;
        parts.entry((face.page, scene.objects().of(number), scene.groups().of(number))).or_default().push(face);
    }

    // A mesh and a node for each.
    let mut file = File::default();
    let (mut meshes, mut nodes) = (Vec::new(), Vec::new());
    for ((page, object, group), faces) in parts {
        let (object, group) =
            (object.map(|object| &scene.objects().names()[object]), group.map(|group| &scene.groups().names()[group]));
        let name = object.or(group).map_or("scene", String::as_str);
        meshes.push(json!({ "name": name, "primitives": [primitive(&mut file, scene, &faces, page)] }));
        nodes.push(json!({ "name": name, "mesh": meshes.len() - 1, "extras": { "object": object, "group": group } }));
    }

    // A texture and a material for each page.
    let (mut images, mut materials) = (Vec::new(), Vec::new());
    for (number, page) in lightmap.pages.iter().enumerate() {
        let mut png = Vec::new();
        write_lightmap_png(&mut png, page, (Quantity::Radiance, LightmapCode::Srgb { ev }), provenance)?;
        images.push(json!({ "name": format!("lightmap {number}"), "mimeType": "image/png", "bufferView": file.view(&png) }));
        materials.push(json!({
            "name": format!("lightmap {number}"), "extensions": { "KHR_materials_unlit": {} },
            "pbrMetallicRoughness": {
                "baseColorTexture": { "index": number, "texCoord": 1 }, "metallicFactor": 0.0, "roughnessFactor": 1.0,
            },
        }));
    }
    let textures: Vec<Value> = (0..images.len()).map(|number| json!({ "sampler": 0, "source": number })).collect();

    let parts = json!({
        "nodes": nodes, "meshes": meshes, "materials": materials, "textures": textures, "images": images,
        "samplers": [{ "magFilter": LINEAR, "minFilter": LINEAR, "wrapS": CLAMP_TO_EDGE, "wrapT": CLAMP_TO_EDGE }],
    });
    file.write(writer, parts, (Quantity::Radiance, ev), provenance)
}

/// A primitive of triangles: fans of the faces, each with vertices of its own.
fn primitive(file: &mut File, scene: &Scene, faces: &[FaceOnAtlas], page: usize) -> Value {
    let (mut positions, mut uv, mut indices): (Vec<[f32; 3]>, Vec<[f32; 2]>, Vec<u32>) = Default::default();
    let mut numbers: Vec<f32> = Vec::new();
    for face in faces {
        let (first, count) = (positions.len() as u32, face.uv.len() as u32);
        positions.extend(face.vertices.iter().map(|vertex| vertex.map(|x| x as f32)));
        uv.extend(face.uv.iter().map(|at| at.map(|x| x as f32)));
        numbers.resize(positions.len(), scene.surfaces()[face.surface as usize].face as f32);
        indices.extend((1..count - 1).flat_map(|k| [first, first + k, first + k + 1]));
    }
    let corners = with_bounds(file, &positions);
    let uv = file.accessor(uv.into_iter().flatten().map(f32::to_le_bytes), FLOAT, 2, json!({}));
    let numbers = file.accessor(numbers.into_iter().map(f32::to_le_bytes), FLOAT, 1, json!({}));
    let indices = file.accessor(indices.into_iter().map(u32::to_le_bytes), UNSIGNED_INT, 1, json!({}));
    let attributes = json!({ "POSITION": corners, "TEXCOORD_0": uv, "TEXCOORD_1": uv, "_FACE": numbers });
    json!({ "attributes": attributes, "indices": indices, "material": page })
}
