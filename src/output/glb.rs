//! The lit scene as binary glTF 2.0 (`.glb`), which shows it as it is in every viewer.
//!
//! A node with a mesh for each object, group and material, by the name of the object, or of the first of these that has one. Vertices have `COLOR_0`, linear radiances times `2^EV`, at most 1, which materials show
//! unlit (KHR_materials_unlit); and `_RADIOSITY`, in W/m^2 as it is, up to four channels a vector (numbered `_RADIOSITY_0`, ... where there are more); and
//! `_FACE`, the number of their face in the input from 0, a float, as the format asks for: exact up to 2^24. `extras` of nodes name all three.
//! `asset.extras` states software, quantity, unit, options and the exposure EV: positions are floats, in metres.

use std::collections::{BTreeMap, HashMap};
use std::io::{self, Write};

use serde_json::{Value, json};

use super::patches::Patches;
use super::png::KEY;
use super::{Provenance, Quantity};
use crate::picture::luminance;

/// Accessors of glTF: their number in OpenGL.
pub(super) const FLOAT: u32 = 5126;
pub(super) const UNSIGNED_INT: u32 = 5125;

/// The parts of a file while it is put together.
#[derive(Default)]
pub(super) struct File {
    pub views: Vec<Value>,
    pub accessors: Vec<Value>,
    pub binary: Vec<u8>,
}

impl File {
    /// Adds an accessor: its number.
    pub fn accessor(&mut self, bytes: impl IntoIterator<Item = [u8; 4]>, component: u32, width: usize, more: Value) -> usize {
        let start = self.binary.len();
        self.binary.extend(bytes.into_iter().flatten());
        let length = self.binary.len() - start;
        let target = if component == FLOAT { 34962 } else { 34963 };
        self.views.push(json!({ "buffer": 0, "byteOffset": start, "byteLength": length, "target": target }));
        let kind = ["SCALAR", "VEC2", "VEC3", "VEC4"][width - 1];
        let mut accessor =
            json!({ "bufferView": self.views.len() - 1, "componentType": component, "count": length / (4 * width), "type": kind });
        if let (Value::Object(accessor), Value::Object(more)) = (&mut accessor, more) {
            accessor.extend(more);
        }
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    /// Adds bytes that no accessor reads, such as an image: the number of their view. What follows starts at a multiple of four bytes.
    pub fn view(&mut self, bytes: &[u8]) -> usize {
        self.views.push(json!({ "buffer": 0, "byteOffset": self.binary.len(), "byteLength": bytes.len() }));
        self.binary.extend_from_slice(bytes);
        self.binary.resize(self.binary.len().next_multiple_of(4), 0);
        self.views.len() - 1
    }

    /// Writes the whole, one scene of all nodes: `parts` are its nodes, meshes, unlit materials and what else there is. What is told of how it was made
    /// stands in `asset.extras`, with the exposure EV.
    pub fn write(
        self,
        writer: &mut impl Write,
        mut parts: Value,
        (quantity, ev): (Quantity, f64),
        provenance: &Provenance,
    ) -> io::Result<()> {
        let statements = provenance.statements(quantity).into_iter().map(|(key, text)| (key.to_owned(), json!(text)));
        let mut extras = Value::Object(statements.collect());
        extras["exposure"] = json!(ev);
        let nodes: Vec<usize> = (0..parts["nodes"].as_array().map_or(0, Vec::len)).collect();
        parts["asset"] = json!({ "version": "2.0", "generator": provenance.software(), "extras": extras });
        parts["extensionsUsed"] = json!(["KHR_materials_unlit"]);
        parts["scene"] = json!(0);
        parts["scenes"] = json!([{ "nodes": nodes }]);
        parts["accessors"] = json!(self.accessors);
        parts["bufferViews"] = json!(self.views);
        parts["buffers"] = json!([{ "byteLength": self.binary.len() }]);
        write_chunks(writer, parts.to_string().into_bytes(), &self.binary)
    }
}

/// Adds an accessor of positions, with the box around them, which the format asks for: its number.
pub(super) fn with_bounds(file: &mut File, positions: &[[f32; 3]]) -> usize {
    let bound = |pick: fn(f32, f32) -> f32| std::array::from_fn(|k| positions.iter().map(|at| at[k]).fold(positions[0][k], pick));
    let (least, most): ([f32; 3], [f32; 3]) = (bound(f32::min), bound(f32::max));
    let bytes = positions.as_flattened().iter().map(|x| x.to_le_bytes());
    file.accessor(bytes, FLOAT, 3, json!({ "min": least, "max": most }))
}

/// A patch: the number of its face in the input, from 0, and indices of vertices.
type PartOfFace<'a> = (u32, &'a [u32]);

/// Writes patches.
pub(super) fn write(writer: &mut impl Write, patches: &Patches<'_>, provenance: &Provenance) -> io::Result<()> {
    let ev = exposure(patches);
    let scale = libm::exp2(ev) / std::f64::consts::PI;
    let scene = patches.scene;

    // Patches by object, group and material.
    let mut parts: BTreeMap<(Option<usize>, Option<usize>, u32), Vec<PartOfFace<'_>>> = BTreeMap::new();
    for (surface, corners) in patches.iter() {
        let of = &scene.surfaces()[surface as usize];
        parts.entry((scene.objects().of(of.face), scene.groups().of(of.face), of.material)).or_default().push((of.face, corners));
    }

    // A mesh and a node for each, and the materials that they have.
    let mut file = File::default();
    let mut materials = Vec::new();
    let mut numbers: HashMap<u32, usize> = HashMap::new();
    let (mut meshes, mut nodes) = (Vec::new(), Vec::new());
    for ((object, group, material), part) in parts {
        let of_scene = &scene.materials()[material as usize];
        let number = *numbers.entry(material).or_insert_with(|| {
            materials.push(json!({
                "name": of_scene.name, "extensions": { "KHR_materials_unlit": {} },
                "pbrMetallicRoughness": { "metallicFactor": 0.0, "roughnessFactor": 1.0 },
                "extras": { "reflectance": of_scene.reflectance, "exitance": of_scene.exitance },
            }));
            materials.len() - 1
        });
        let (object, group) =
            (object.map(|object| &scene.objects().names()[object]), group.map(|group| &scene.groups().names()[group]));
        let name = object.or(group).unwrap_or(&of_scene.name);
        meshes.push(json!({ "name": name, "primitives": [primitive(&mut file, patches, &part, number, scale)] }));
        let extras = json!({ "object": object, "group": group, "material": of_scene.name });
        nodes.push(json!({ "name": name, "mesh": meshes.len() - 1, "extras": extras }));
    }

    let parts = json!({ "nodes": nodes, "meshes": meshes, "materials": materials });
    file.write(writer, parts, (Quantity::Radiosity, ev), provenance)
}

/// A primitive of triangles: fans of the patches, each with the number of its face, with vertices of its own.
fn primitive(file: &mut File, patches: &Patches<'_>, part: &[PartOfFace<'_>], material: usize, scale: f64) -> Value {
    let mut own: HashMap<u32, u32> = HashMap::new();
    let (mut vertices, mut faces, mut indices) = (Vec::new(), Vec::new(), Vec::new());
    for (face, corners) in part {
        let numbers: Vec<u32> = (corners.iter())
            .map(|&corner| {
                *own.entry(corner).or_insert_with(|| {
                    vertices.push(corner);
                    faces.push(*face as f32);
                    vertices.len() as u32 - 1
                })
            })
            .collect();
        indices.extend((1..numbers.len() - 1).flat_map(|k| [numbers[0], numbers[k], numbers[k + 1]]));
    }

    let positions: Vec<[f32; 3]> = vertices.iter().map(|&vertex| patches.vertices[vertex as usize].map(|x| x as f32)).collect();
    let floats = |values: Vec<f32>| values.into_iter().map(f32::to_le_bytes);
    let corners = with_bounds(file, &positions);

    // Colours to look at, and numbers.
    let colour = |&vertex: &u32| {
        let radiosity = patches.radiosity_at(vertex);
        let mean = [radiosity.iter().sum::<f32>() / radiosity.len() as f32; 3];
        <[f32; 3]>::try_from(radiosity).unwrap_or(mean).map(|b| (f64::from(b) * scale).min(1.0) as f32)
    };
    let colours = file.accessor(floats(vertices.iter().flat_map(colour).collect()), FLOAT, 3, json!({}));
    let faces = file.accessor(floats(faces), FLOAT, 1, json!({}));
    let mut attributes = json!({ "POSITION": corners, "COLOR_0": colours, "_FACE": faces });
    let channels = patches.scene.channels();
    let columns =
        |from: usize, to: usize| vertices.iter().flat_map(|&vertex| patches.radiosity_at(vertex)[from..to].to_vec()).collect();
    if channels <= 4 {
        attributes["_RADIOSITY"] = json!(file.accessor(floats(columns(0, channels)), FLOAT, channels, json!({})));
    } else {
        for k in 0..channels {
            attributes[format!("_RADIOSITY_{k}")] = json!(file.accessor(floats(columns(k, k + 1)), FLOAT, 1, json!({})));
        }
    }
    let indices = file.accessor(indices.into_iter().map(u32::to_le_bytes), UNSIGNED_INT, 1, json!({}));
    json!({ "attributes": attributes, "indices": indices, "material": material })
}

/// The exposure value that brings the geometric mean of the luminances, over the area that reflects, to that of pictures; 0 where all is black.
fn exposure(patches: &Patches<'_>) -> f64 {
    let (mut sum, mut total) = (0.0, 0.0);
    for (surface, corners) in patches.iter() {
        let of = &patches.scene.surfaces()[surface as usize];
        let at = |k: usize| glam::DVec3::from(patches.vertices[corners[k] as usize]);
        let area = 0.5 * (1..corners.len() - 1).map(|k| (at(k) - at(0)).cross(at(k + 1) - at(0))).sum::<glam::DVec3>().length();
        let light: f32 = corners.iter().map(|&corner| luminance(patches.radiosity_at(corner))).sum();
        let light = f64::from(light) / (corners.len() as f64 * std::f64::consts::PI);
        if patches.scene.materials()[of.material as usize].reflects() && light.is_normal() {
            sum += area * libm::log2(light);
            total += area;
        }
    }
    if total > 0.0 { libm::log2(KEY) - sum / total } else { 0.0 }
}

/// Writes header and chunks (glTF 2.0 Specification, section 4.4).
fn write_chunks(writer: &mut impl Write, mut json: Vec<u8>, binary: &[u8]) -> io::Result<()> {
    json.resize(json.len().next_multiple_of(4), b' ');
    let length = u32::try_from(12 + 8 + json.len() + 8 + binary.len())
        .map_err(|_| io::Error::other("the scene does not fit into the 4 GiB of a GLB file; write .vtp or .ply"))?;
    writer.write_all(b"glTF")?;
    [2, length].into_iter().try_for_each(|number: u32| writer.write_all(&number.to_le_bytes()))?;
    for (kind, body) in [(b"JSON", json.as_slice()), (b"BIN\0", binary)] {
        writer.write_all(&(body.len() as u32).to_le_bytes())?;
        writer.write_all(kind)?;
        writer.write_all(body)?;
    }
    Ok(())
}
