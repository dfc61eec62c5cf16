//! glTF 2.0: `.gltf` with files beside it, or all in one `.glb`.
//!
//! What is read: the nodes of the default scene with their transforms, meshes of triangles in all their forms, quantised or not, materials as diffuse ones
//! (`materials`), textures as the mean over each face. A mesh whose transform mirrors it keeps its fronts. Double-sided materials make
//! faces of two sides. Lights without a surface are read (`lights`). Cameras, skins, morphs, animations, points and lines have no part, which is noted.
//!
//! A face is what triangles of a primitive that lie in one plane make together (`join`); it has the number of its first triangle, counted through
//! all instances of the scene. Lengths are metres, and axes stay as they are.
//!
//! The JSON is read by types of ours: the crate for glTF (1.4) panics on files with wrong indices or headers, reads no quantised positions, and
//! refuses files that require these.

mod accessors;
mod buffers;
mod colours;
mod container;
mod json;
mod lights;
mod materials;
mod nodes;
mod primitives;

use std::collections::HashMap;
use std::path::Path;

use glam::DVec3;

use super::faces::FaceFile;
use super::join::{Joined, joined};
use super::text::read_regular_file;
use super::{Diagnostic, DiagnosticKind, Diagnostics, ImportError, ImportOptions, Textures};
use crate::progress::Stop;
use crate::scene::{FileUv, UvTriangle};
use accessors::Accessors;
use buffers::{Buffers, Place};
use colours::Colours;
use container::shown;
use materials::{Materials, Means};
use nodes::{Instance, Placed};
use primitives::{Shape, Triangles};

/// Coordinates may not be larger than this, as in all files.
const LARGEST_COORDINATE: f64 = 1e30;

/// A scene has no more triangles than this, instances counted: a small file may name a mesh many times.
const MOST_TRIANGLES: usize = 1 << 24;

/// Reads a glTF file.
pub(super) fn read(
    file: &Path,
    options: &ImportOptions,
    diagnostics: &mut Diagnostics,
    stop: Stop<'_>,
) -> Result<FaceFile, ImportError> {
    let bytes = read_regular_file(file).map_err(|reason| ImportError::Unreadable { file: file.to_owned(), reason })?;
    let wrong = |reason: String| ImportError::Syntax { file: file.to_owned(), line: 0, face: None, reason };
    let (root, binary) = container::open(&bytes).map_err(wrong)?;

    // Where the meshes stand, and the bytes that they are made of.
    let mut read = FaceFile::default();
    let place = Place { file, allow_any_path: options.allow_any_path };
    let buffers = Buffers::read(&root, binary, &place, &mut read.libraries).map_err(wrong)?;
    let accessors = Accessors { root: &root, buffers };
    let placed = nodes::placed(&accessors).map_err(wrong)?;

    let of_mesh =
        |mesh: &json::Mesh| mesh.primitives.iter().fold(0, |sum: usize, part| sum.saturating_add(primitives::count(part, &root)));
    let in_all = placed.instances.iter().filter_map(|instance| root.meshes.get(instance.mesh));
    if in_all.fold(0, |sum: usize, mesh| sum.saturating_add(of_mesh(mesh))) > MOST_TRIANGLES {
        return Err(wrong(format!(
            "the scene has more than {MOST_TRIANGLES} triangles, copies of meshes counted: that is too many"
        )));
    }

    // Mesh after mesh, with one material after the other.
    let mut reader = Reader { accessors, place, options, read, materials: Materials::new(), shapes: HashMap::new(), left_out: 0 };
    for instance in &placed.instances {
        let mesh = root.meshes.get(instance.mesh);
        let all = root.meshes.len();
        let mesh =
            mesh.ok_or_else(|| wrong(format!("'{}': mesh {} does not exist: there are {all}", instance.name, instance.mesh)))?;
        for primitive in 0..mesh.primitives.len() {
            if stop() {
                return Err(ImportError::Cancelled);
            }
            let name = name_of(instance, mesh, primitive);
            reader.add(instance, primitive, &name, stop).map_err(|reason| wrong(format!("{name}: {reason}")))?;
        }
    }

    let (lights, of_lights) = lights::read(&root, &placed).map_err(wrong)?;
    reader.read.lights = lights;
    diagnostics.items.extend(of_lights.into_iter().map(|text| Diagnostic::new(DiagnosticKind::Light, text).at(file, 0)));
    let left_out = reader.left_out;
    note_left_out(&root, &placed, left_out, |kind, text| diagnostics.push(Diagnostic::new(kind, text).at(file, 0)));
    for (kind, text) in reader.materials.notes() {
        diagnostics.push(Diagnostic::new(kind, text).at(file, 0));
    }
    Ok(FaceFile { materials: reader.materials.materials, ..reader.read })
}

/// What a part of a mesh is called: by its node, its mesh where that has another name, and its number where there are several.
fn name_of(instance: &Instance, mesh: &json::Mesh, primitive: usize) -> String {
    let mut name = instance.name.clone();
    if let Some(of_mesh) = mesh.name.as_deref().map(shown).filter(|of_mesh| *of_mesh != name) {
        name += &format!("/{of_mesh}");
    }
    if mesh.primitives.len() > 1 {
        name += &format!("/{primitive}");
    }
    name
}

/// What is read so far.
struct Reader<'a> {
    accessors: Accessors<'a>,
    place: Place<'a>,
    options: &'a ImportOptions,
    read: FaceFile,
    materials: Materials,
    /// The triangles of primitives by mesh and number: instances share them.
    shapes: HashMap<(usize, usize), Triangles>,
    /// Primitives of points and lines.
    left_out: usize,
}

impl Reader<'_> {
    /// Adds the faces of a primitive of an instance.
    fn add(&mut self, instance: &Instance, number: usize, name: &str, stop: Stop<'_>) -> Result<(), String> {
        let primitive = &self.accessors.root.meshes[instance.mesh].primitives[number];
        if let Some(packed) = primitive.extensions.keys().find(|key| key.contains("draco") || key.contains("meshopt")) {
            return Err(format!("it is compressed by {}, which is not supported; export it without", shown(packed)));
        }
        let shape = Shape::of(primitive)?;
        if shape == Shape::Nothing {
            self.left_out += 1;
            return Ok(());
        }
        let material = self.materials.read(primitive.material, &self.accessors, &self.place, &mut self.read.libraries)?;
        let textured = material.colour_texture.is_some() || material.radiance_texture.is_some();
        if textured && self.options.textures == Textures::Reject {
            return Err("its material has a texture, and --texture reject wants none".to_owned());
        }

        // Its triangles, in the world.
        let key = (instance.mesh, number);
        if !self.shapes.contains_key(&key) {
            self.shapes.insert(key, primitives::read(primitive, shape, self.options.keep_uv, &self.accessors)?);
        }
        let first_face = self.read.lines.len();
        let own = &self.shapes[&key];
        let vertices: Vec<DVec3> = own.positions.iter().map(|&at| instance.to_world.transform_point3(at)).collect();
        if let Some(bad) = vertices.iter().position(|at| !at.to_array().iter().all(|x| x.abs() <= LARGEST_COORDINATE)) {
            return Err(format!(
                "vertex {bad}, counted from 0, has a coordinate that is not a number below {LARGEST_COORDINATE:e}"
            ));
        }
        let triangles = if instance.to_world.matrix3.determinant() < 0.0 {
            own.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect()
        } else {
            own.triangles.clone()
        };

        // Faces that lie in one plane, each with the means of what it is coloured by.
        self.read.lines.resize(first_face + triangles.len(), 0);
        self.read.vertices += vertices.len();
        let faces = joined(&vertices, &triangles, stop);
        let source = self.materials.source_of(primitive.material);
        let colours = Colours::read(&self.materials, source, (primitive, own), &vertices, &self.accessors)?;
        let means: Vec<Means> = faces.iter().map(|face| colours.means(face)).collect();
        if self.options.keep_uv {
            add_uv(&mut self.read.uv, first_face as u32, &faces, (&vertices, &triangles), own.uv.as_deref());
        }
        self.push(primitive.material, first_face as u32, faces, means);

        let of_material = self.materials.source_of(primitive.material).name.clone();
        let name = if of_material.is_empty() { name.to_owned() } else { format!("{name} ({of_material})") };
        self.read.objects.push_run(&name, triangles.len());
        Ok(())
    }

    /// Adds faces with their materials; those of double-sided ones are followed by their backs.
    fn push(&mut self, material: Option<usize>, first_face: u32, faces: Vec<Joined>, means: Vec<Means>) {
        for (face, means) in faces.into_iter().zip(means) {
            let number = first_face + face.triangles[0] as u32;
            let index = self.materials.of_face(material, means);
            self.read.push(number, index, face.corners.iter().copied());
            if self.materials.source_of(material).is_double_sided {
                self.read.push(number, index, face.corners.into_iter().rev());
            }
        }
    }
}

/// Keeps the coordinates of the triangles of faces; a primitive has them all, or none.
fn add_uv(
    kept: &mut FileUv,
    first_face: u32,
    faces: &[Joined],
    (vertices, triangles): (&[DVec3], &[[u32; 3]]),
    uv: Option<&[[f64; 2]]>,
) {
    for face in faces {
        let number = first_face + face.triangles[0] as u32;
        let Some(uv) = uv else {
            kept.without.get_or_insert(number);
            return;
        };
        let triangle = |&triangle: &usize| UvTriangle {
            face: number,
            corners: triangles[triangle].map(|corner| vertices[corner as usize].to_array()),
            uv: triangles[triangle].map(|corner| uv[corner as usize]),
        };
        kept.triangles.extend(face.triangles.iter().map(triangle));
    }
}

/// Notes what of a file has no part in the scene.
fn note_left_out(root: &json::Root, placed: &Placed, points_and_lines: usize, mut note: impl FnMut(DiagnosticKind, String)) {
    use DiagnosticKind::{IgnoredElement, IgnoredProperty};
    if points_and_lines > 0 {
        note(IgnoredElement, format!("{points_and_lines} primitives of points or lines are left out: they do not reflect light"));
    }
    if root.scenes.len() > 1 {
        note(IgnoredElement, format!("the file has {} scenes: number {} is read", root.scenes.len(), root.scene.unwrap_or(0)));
    }
    if !root.skins.is_empty() || !root.animations.is_empty() {
        let (skins, animations) = (root.skins.len(), root.animations.len());
        note(IgnoredProperty, format!("{skins} skins and {animations} animations are left out: meshes stand as their nodes say"));
    }
    if root.meshes.iter().flat_map(|mesh| &mesh.primitives).any(|primitive| !primitive.targets.is_empty()) {
        note(IgnoredProperty, "morph targets are left out: meshes have their base shapes".to_owned());
    }
    for name in root.extensions_used.iter().filter(|name| !name.starts_with("KHR_materials_")) {
        match name.as_str() {
            "KHR_mesh_quantization" | "KHR_texture_transform" | "EXT_mesh_gpu_instancing" | "KHR_lights_punctual" => {}
            other => note(IgnoredProperty, format!("extension {} is left out", shown(other))),
        }
    }
    if let Some((to_world, yfov)) = placed.cameras.first() {
        let text = |v: DVec3| format!("{},{},{}", v.x, v.y, v.z);
        let (eye, forward) = (to_world.translation, to_world.transform_vector3(DVec3::NEG_Z));
        let camera = format!(
            "eye={} target={} up={} fov={}",
            text(eye),
            text(eye + forward),
            text(to_world.transform_vector3(DVec3::Y)),
            yfov.to_degrees()
        );
        note(DiagnosticKind::Camera, format!("the first of {} cameras is --camera '{camera}'", placed.cameras.len()));
    }
}
