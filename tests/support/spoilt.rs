//! Scenes that are spoilt at random.
#![allow(dead_code, reason = "each test uses a part")]

use std::f64::consts::PI;

use patchlight::scene::{Material, Scene};

use crate::triangles::Random;

/// The faces of a scene as `(corners, material)`.
pub type Faces = Vec<(Vec<[f64; 3]>, u32)>;

/// A scene with some faces jittered, reversed, repeated, flattened to nearly nothing, scaled or taken out.
pub fn spoilt(faces: &Faces, random: &mut Random) -> Faces {
    let mut faces = faces.clone();
    for _ in 0..=random.below(8) {
        let at = random.below(faces.len());
        let (corners, material) = faces[at].clone();
        let some = random.below(corners.len());
        match random.below(8) {
            0 => {
                let far = [1e-12, 1e-9, 1e-7, 1e-6, 1e-3, 0.1][random.below(6)];
                let jitter = |x: f64, random: &mut Random| x + far * (2.0 * random.unit() - 1.0);
                faces[at].0.iter_mut().for_each(|corner| *corner = corner.map(|x| jitter(x, random)));
            }
            1 => faces[at].0.reverse(),
            2 => faces.push((corners, material)),
            3 => faces.push((corners.into_iter().rev().collect(), material)),
            4 => faces[at].0[some] = corners[(some + 1) % corners.len()],
            5 => {
                // A sliver: one corner close to the line between its neighbours.
                let (before, after) = (corners[(some + corners.len() - 1) % corners.len()], corners[(some + 1) % corners.len()]);
                let part = 10.0_f64.powi(-(random.below(13) as i32));
                let middle: [f64; 3] = std::array::from_fn(|k| (before[k] + after[k]) / 2.0);
                faces[at].0[some] = std::array::from_fn(|k| middle[k] + part * (corners[some][k] - middle[k]));
            }
            6 => {
                let scale = [0.3, 3.0][random.below(2)];
                faces[at].0.iter_mut().for_each(|corner| *corner = corner.map(|x| scale * x));
            }
            _ if faces.len() > 1 => drop(faces.swap_remove(at)),
            _ => {}
        }
    }
    faces
}

/// The scene as an OBJ file, every face with vertices of its own: so that it is repaired as any other is.
pub fn obj(faces: &Faces, materials: &[Material]) -> String {
    let mut text = "mtllib scene.mtl\n".to_owned();
    for (corners, material) in faces {
        corners.iter().for_each(|[x, y, z]| text += &format!("v {x:e} {y:e} {z:e}\n"));
        let indices: Vec<String> = (1..=corners.len()).rev().map(|back| format!("-{back}")).collect();
        text += &format!("usemtl {}\nf {}\n", materials[*material as usize].name, indices.join(" "));
    }
    text
}

/// The faces of a scene.
pub fn faces_of(scene: &Scene) -> Faces {
    scene.surfaces().iter().map(|surface| (surface.polygon.vertices().collect(), surface.material)).collect()
}

/// Materials of which one may be black, nearly white, dark, or a million times as bright.
pub fn spoilt_materials(materials: &[Material], random: &mut Random) -> Vec<Material> {
    let mut materials = materials.to_vec();
    let at = random.below(materials.len());
    let Material { reflectance, exitance, .. } = &mut materials[at];
    match random.below(6) {
        0 => reflectance.fill(0.0),
        1 => reflectance.fill(0.99),
        2 => exitance.fill(0.0),
        3 => exitance.iter_mut().for_each(|e| *e *= 1e6),
        4 => exitance.fill(1e-6),
        _ => {}
    }
    materials
}

/// Materials as an MTL file.
pub fn mtl(materials: &[Material]) -> String {
    let triple = |values: &[f64], unit: f64| values.iter().map(|value| format!(" {:e}", value / unit)).collect::<String>();
    let text = |m: &Material| format!("newmtl {}\nKd{}\nKe{}\n", m.name, triple(&m.reflectance, 1.0), triple(&m.exitance, PI));
    materials.iter().map(text).collect()
}
