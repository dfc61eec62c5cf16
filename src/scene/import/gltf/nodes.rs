//! The tree of nodes: which mesh stands where (glTF 2.0 Specification, section 3.5).

use glam::{DAffine3, DMat3, DMat4, DQuat, DVec3};

use super::accessors::Accessors;
use super::container::shown;
use super::json::{Node, Root};

/// A mesh at its place.
pub(super) struct Instance {
    /// The name of its node.
    pub name: String,
    /// Its mesh.
    pub mesh: usize,
    pub to_world: DAffine3,
}

/// What the nodes of a scene hold.
#[derive(Default)]
pub(super) struct Placed {
    /// In the order of the tree: a node, then its children.
    pub instances: Vec<Instance>,
    /// Perspective cameras: where they stand, and their vertical field of view in radians.
    pub cameras: Vec<(DAffine3, f64)>,
    /// Lights: the names of their nodes, their numbers, and where they stand.
    pub lights: Vec<(String, usize, DAffine3)>,
}

/// Walks through the nodes of the scene that is to be shown: the default one, else the first, else all nodes that are no children.
pub(super) fn placed(accessors: &Accessors<'_>) -> Result<Placed, String> {
    let root = accessors.root;
    let mut placed = Placed::default();
    let mut seen = vec![false; root.nodes.len()];
    let mut waiting: Vec<(usize, DAffine3)> = top(root)?.into_iter().rev().map(|node| (node, DAffine3::IDENTITY)).collect();
    while let Some((number, parent)) = waiting.pop() {
        let all = root.nodes.len();
        let node =
            root.nodes.get(number).ok_or_else(|| format!("node {number} does not exist: there are {all}, numbered from 0"))?;
        let name = node.name.as_deref().map_or_else(|| format!("node {number}"), shown);
        if std::mem::replace(&mut seen[number], true) {
            return Err(format!("'{name}' (node {number}) is reached twice: it has two parents, or is below itself"));
        }
        let to_world =
            parent * transform(node).map_err(|what| format!("the {what} of '{name}' (node {number}) is no transform"))?;
        if let Some(mesh) = node.mesh {
            let copies = copies(node, accessors).map_err(|reason| format!("'{name}' (node {number}): {reason}"))?;
            let of_copy = |copy: DAffine3| Instance { name: name.clone(), mesh, to_world: to_world * copy };
            placed.instances.extend(copies.into_iter().map(of_copy));
        }
        if let Some(camera) = node.camera.and_then(|camera| root.cameras.get(camera)?.perspective.as_ref()) {
            placed.cameras.push((to_world, camera.yfov));
        }
        let light = node.extensions.get("KHR_lights_punctual").and_then(|extension| extension.get("light")?.as_u64());
        if let Some(light) = light {
            placed.lights.push((name, light as usize, to_world));
        }
        waiting.extend(node.children.iter().rev().map(|&child| (child, to_world)));
    }
    Ok(placed)
}

/// The nodes at the top.
fn top(root: &Root) -> Result<Vec<usize>, String> {
    let number = root.scene.unwrap_or(0);
    if let Some(scene) = root.scenes.get(number) {
        return Ok(scene.nodes.clone());
    }
    if root.scene.is_some() {
        return Err(format!("scene {number} does not exist: there are {}, numbered from 0", root.scenes.len()));
    }
    let mut is_child = vec![false; root.nodes.len()];
    for &child in root.nodes.iter().flat_map(|node| &node.children) {
        if let Some(is_child) = is_child.get_mut(child) {
            *is_child = true;
        }
    }
    Ok((0..root.nodes.len()).filter(|&node| !is_child[node]).collect())
}

/// Where the copies of a node's mesh stand in its frame (EXT_mesh_gpu_instancing): one where nothing else is said.
fn copies(node: &Node, accessors: &Accessors<'_>) -> Result<Vec<DAffine3>, String> {
    let Some(instancing) = node.extensions.get("EXT_mesh_gpu_instancing") else { return Ok(vec![DAffine3::IDENTITY]) };
    let of = |key: &str| instancing.get("attributes").and_then(|all| all.get(key)?.as_u64()).map(|number| number as usize);
    let translations = of("TRANSLATION").map(|number| accessors.vectors::<3>(number)).transpose()?;
    let rotations = of("ROTATION").map(|number| accessors.vectors::<4>(number)).transpose()?;
    let scales = of("SCALE").map(|number| accessors.vectors::<3>(number)).transpose()?;
    let lengths = [translations.as_ref().map(Vec::len), rotations.as_ref().map(Vec::len), scales.as_ref().map(Vec::len)];
    let count = lengths.into_iter().flatten().max().unwrap_or(0);
    if lengths.into_iter().flatten().any(|length| length != count) {
        return Err("its copies have more of some attributes than of others".to_owned());
    }
    let copy = |k: usize| Node {
        translation: translations.as_ref().map(|all| all[k]),
        rotation: rotations.as_ref().map(|all| all[k]),
        scale: scales.as_ref().map(|all| all[k]),
        ..Node::default()
    };
    (0..count).map(|k| transform(&copy(k)).map_err(|what| format!("the {what} of its copy {k} is no transform"))).collect()
}

/// From the frame of a node to that of its parent; the error names what cannot be one.
fn transform(node: &Node) -> Result<DAffine3, &'static str> {
    let transform = match &node.matrix {
        Some(matrix) => DAffine3::from_mat4(DMat4::from_cols_array(matrix)),
        None => {
            let rotation = DQuat::from_array(node.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]));
            // Numbers are rounded, so the length is made exact again.
            let length = rotation.length();
            if !length.is_finite() || length == 0.0 {
                return Err("rotation");
            }
            let turned = DMat3::from_quat(rotation / length);
            let scale = DMat3::from_diagonal(DVec3::from(node.scale.unwrap_or([1.0; 3])));
            DAffine3::from_mat3_translation(turned * scale, DVec3::from(node.translation.unwrap_or([0.0; 3])))
        }
    };
    if transform.is_finite() { Ok(transform) } else { Err("matrix") }
}
