//! A scene that is put together from arrays and files: what is wrong with them one by one, then with all of them together.

use thiserror::Error;

use super::{ArrayFace, Diagnostic, DiagnosticKind, Diagnostics, Imported, ImportedLights, polygons_of_arrays};
use crate::geometry::Polygon;
use crate::scene::{FaceNames, Light, Material, Scene, SceneError, Sides};

/// What is to become a scene. Faces of arrays come first, then those of files; the same with materials.
pub struct Draft {
    channels: usize,
    sides: Sides,
    materials: Vec<Material>,
    /// In metres.
    pub vertices: Vec<[f64; 3]>,
    /// Numbers of vertices, face after face.
    pub corners: Vec<u64>,
    /// The faces of arrays.
    pub faces: Vec<ArrayFace>,
    /// What was read from files, each with [`Sides::Front`]: sides are made when all faces are known.
    pub files: Vec<Imported>,
    /// Lights that were read for its channels, behind those of files.
    pub lights: Vec<ImportedLights>,
}

/// What a mistake is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MistakeKind {
    /// A face has a vertex or a material that does not exist.
    BadIndex,
    /// A face has a vertex with a coordinate that is not finite, or too large.
    BadVertex,
    /// A material has a reflectance or an exitance that is out of range.
    BadMaterial,
    /// All together makes no scene, as without any face.
    BadScene,
}

/// Something for which a draft makes no scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mistake {
    /// What it is about.
    pub kind: MistakeKind,
    /// The face, counted from 0, where it is about one.
    pub face: Option<u64>,
    /// For people; faces count from 1 there, vertices and materials from 0.
    pub text: String,
}

/// Why a draft makes no scene.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("{}", in_short(mistakes))]
pub struct DraftError {
    /// All that is wrong, up to a thousand; at least one.
    pub mistakes: Vec<Mistake>,
    /// What was noted before that was found.
    pub diagnostics: Diagnostics,
}

fn in_short(mistakes: &[Mistake]) -> String {
    match mistakes {
        [] => String::new(),
        [only] => only.text.clone(),
        [first, others @ ..] => format!("{} (and {} more, see the diagnostics)", first.text, others.len()),
    }
}

/// So many mistakes are told at most.
const MOST_MISTAKES: usize = 1000;

/// Coordinates may not be larger than this, as in files.
const LARGEST_COORDINATE: f64 = 1e30;

impl Draft {
    /// Nothing yet.
    pub fn new(channels: usize, sides: Sides) -> Self {
        let (materials, vertices, corners) = (Vec::new(), Vec::new(), Vec::new());
        Self { channels, sides, materials, vertices, corners, faces: Vec::new(), files: Vec::new(), lights: Vec::new() }
    }

    /// The channels of its materials.
    pub fn channels(&self) -> usize {
        self.channels
    }

    /// Adds a material, with a number for each channel: reflectances from 0 to below 1, exitances in W/m^2. Materials are numbered from 0.
    pub fn add_material(&mut self, reflectance: &[f64], exitance: &[f64]) {
        let name = format!("material {}", self.materials.len());
        self.materials.push(Material { name, reflectance: reflectance.to_vec(), exitance: exitance.to_vec() });
    }

    /// Lets go of what was added.
    pub fn clear(&mut self) {
        *self = Self::new(self.channels, self.sides);
    }

    /// The scene, and what was repaired or is suspicious.
    ///
    /// # Errors
    /// [`DraftError`] tells all that is wrong.
    pub fn build(&self) -> Result<(Scene, Diagnostics), DraftError> {
        // What is wrong with each face and material.
        let mistakes = self.mistakes();
        if !mistakes.is_empty() {
            return Err(DraftError { mistakes, diagnostics: Diagnostics::default() });
        }

        // The faces of arrays, then those of files; the same with materials.
        let mut diagnostics = Diagnostics::default();
        let corners: Vec<[f64; 3]> = self.corners.iter().map(|&corner| self.vertices[corner as usize]).collect();
        let mut polygons = match polygons_of_arrays(&corners, &self.faces, &mut diagnostics) {
            Ok(polygons) => polygons,
            Err(error) => return Err(failed(error.to_string(), diagnostics)),
        };
        let mut materials = self.materials.clone();
        let mut faces = self.faces.len() as u32;
        let [mut objects, mut groups] = [FaceNames::default(), FaceNames::default()];
        for file in &self.files {
            append(&mut polygons, &mut materials, faces, &file.scene);
            objects.append(faces, file.scene.objects());
            groups.append(faces, file.scene.groups());
            faces += file.lines.len() as u32;
            diagnostics.items.extend(file.diagnostics.items.iter().cloned());
        }

        // The scene. Whether anything emits is asked of all of it, not of each file.
        let mut lights: Vec<Light> = self.files.iter().flat_map(|file| file.scene.lights()).cloned().collect();
        for read in &self.lights {
            lights.extend(read.lights.iter().cloned());
            diagnostics.items.extend(read.diagnostics.items.iter().cloned());
        }
        let scene = Scene::new(self.channels, materials, polygons, self.sides);
        let scene = match scene.and_then(|scene| scene.with_lights(lights)) {
            Ok(scene) => scene.with_names(objects, groups),
            Err(error) => return Err(failed(error.to_string(), diagnostics)),
        };
        diagnostics.items.retain(|item| item.kind != DiagnosticKind::NoLight);
        if scene.is_dark() {
            let text = "no light: no material of a face emits, and there are no lights, so everything is black";
            diagnostics.push(Diagnostic::new(DiagnosticKind::NoLight, text));
        }
        Ok((scene, diagnostics))
    }

    /// What is wrong with each face and material.
    fn mistakes(&self) -> Vec<Mistake> {
        let mut mistakes = Vec::new();
        let mut first = 0_usize;
        for (number, face) in self.faces.iter().enumerate() {
            let corners = self.corners.get(first..first.saturating_add(face.corners)).unwrap_or_default();
            first = first.saturating_add(face.corners);
            if mistakes.len() >= MOST_MISTAKES {
                break;
            }
            if let Some((kind, text)) = self.mistake_of(face, corners) {
                mistakes.push(Mistake { kind, face: Some(number as u64), text: format!("face {}: {text}", number + 1) });
            }
        }
        for (number, material) in self.materials.iter().enumerate() {
            if let Err(SceneError::BadMaterial { reason, .. }) = material.validate(self.channels) {
                let text = format!("material {number}: {reason}");
                mistakes.push(Mistake { kind: MistakeKind::BadMaterial, face: None, text });
            }
        }
        mistakes.truncate(MOST_MISTAKES);
        mistakes
    }

    fn mistake_of(&self, face: &ArrayFace, corners: &[u64]) -> Option<(MistakeKind, String)> {
        let (vertices, materials) = (self.vertices.len(), self.materials.len());
        if let Some(corner) = corners.iter().find(|&&corner| corner >= vertices as u64) {
            let text = format!("vertex {corner} does not exist: there are {vertices}, numbered from 0");
            return Some((MistakeKind::BadIndex, text));
        }
        if face.material as usize >= materials {
            let text = format!("material {} does not exist: there are {materials}, numbered from 0", face.material);
            return Some((MistakeKind::BadIndex, text));
        }
        let is_bad = |&&corner: &&u64| !self.vertices[corner as usize].iter().all(|x| x.abs() <= LARGEST_COORDINATE);
        let bad = corners.iter().find(is_bad)?;
        let text = format!("vertex {bad} has a coordinate that is not a number below {LARGEST_COORDINATE:e}");
        Some((MistakeKind::BadVertex, text))
    }
}

/// What all of it together is wrong with.
fn failed(text: String, diagnostics: Diagnostics) -> DraftError {
    DraftError { mistakes: vec![Mistake { kind: MistakeKind::BadScene, face: None, text }], diagnostics }
}

/// Puts a scene that was read behind what there is.
fn append(polygons: &mut Vec<(Polygon, u32, u32)>, materials: &mut Vec<Material>, first_face: u32, scene: &Scene) {
    let first_material = materials.len() as u32;
    materials.extend(scene.materials().iter().cloned());
    let of_surfaces = scene.surfaces().iter();
    polygons
        .extend(of_surfaces.map(|surface| (surface.polygon.clone(), first_material + surface.material, first_face + surface.face)));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(material: u32) -> Draft {
        let mut draft = Draft::new(1, Sides::Front);
        draft.vertices = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        draft.corners = vec![0, 1, 2, 3];
        draft.faces = vec![ArrayFace { corners: 4, material }];
        draft
    }

    #[test]
    fn what_is_wrong_is_told_all_at_once() {
        let mut draft = square(1);
        draft.corners[2] = 9;
        draft.faces.push(ArrayFace { corners: 3, material: 1 });
        draft.corners.extend([0, 1, 2]);
        draft.add_material(&[1.0], &[0.0]);
        let error = draft.build().unwrap_err();
        let found: Vec<_> = error.mistakes.iter().map(|mistake| (mistake.kind, mistake.face)).collect();
        use MistakeKind::*;
        assert_eq!(found, [(BadIndex, Some(0)), (BadIndex, Some(1)), (BadMaterial, None)]);
        assert_eq!(
            error.to_string(),
            "face 1: vertex 9 does not exist: there are 4, numbered from 0 (and 2 more, see the diagnostics)"
        );
    }

    #[test]
    fn dark_and_empty_scenes_are_told_apart() {
        let mut draft = square(0);
        draft.add_material(&[0.5], &[0.0]);
        let (scene, diagnostics) = draft.build().unwrap();
        assert_eq!(scene.surfaces().len(), 1);
        assert_eq!(diagnostics.items.iter().map(|item| item.kind).collect::<Vec<_>>(), [DiagnosticKind::NoLight]);
        draft.clear();
        assert_eq!(draft.build().unwrap_err().mistakes[0].kind, MistakeKind::BadScene);
    }

    #[test]
    fn faces_that_count_too_many_corners_are_refused() {
        let mut draft = square(0);
        draft.add_material(&[0.5], &[1.0]);
        draft.faces[0].corners = usize::MAX;
        assert_eq!(draft.build().unwrap_err().to_string(), "the faces have other than 4 corners in all");
    }
}
