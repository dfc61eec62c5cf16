//! From what was added to a scene that can be solved.

use patchlight::geometry::Polygon;
use patchlight::scene::import::{ArrayFace, Diagnostic, DiagnosticKind, Diagnostics, Imported, polygons_of_arrays};
use patchlight::scene::{Material, Scene, Sides};

use super::note::{Note, patchlight_diagnostic_code as Code};
use crate::status::{Ending, Outcome, PATCHLIGHT_INVALID_SCENE};

/// What was added so far.
pub struct Draft {
    pub channels: usize,
    pub sides: Sides,
    pub materials: Vec<MaterialRow>,
    pub vertices: Vec<[f64; 3]>,
    /// Numbers of vertices, face after face.
    pub corners: Vec<u64>,
    pub faces: Vec<ArrayFace>,
    pub files: Vec<Imported>,
}

/// A material as it was added.
pub struct MaterialRow {
    pub reflectance: Vec<f64>,
    pub exitance: Vec<f64>,
}

/// A scene that can be solved.
pub struct Committed {
    pub scene: Scene,
    /// The files that it was read from, if any.
    pub files: String,
    /// What was repaired or is suspicious.
    pub warnings: Vec<String>,
}

/// A commit tells so many mistakes at most.
const MOST_MISTAKES: usize = 1000;

/// Coordinates may not be larger than this, as in files.
const LARGEST_COORDINATE: f64 = 1e30;

impl Draft {
    pub fn new(channels: usize, sides: Sides) -> Self {
        let (materials, vertices, corners) = (Vec::new(), Vec::new(), Vec::new());
        Self { channels, sides, materials, vertices, corners, faces: Vec::new(), files: Vec::new() }
    }

    /// Lets go of what is in the scene by now.
    pub fn clear(&mut self) {
        *self = Self::new(self.channels, self.sides);
    }

    /// The scene, and what was noted.
    pub fn build(&self) -> (Outcome<Committed>, Vec<Note>) {
        let mistakes = self.mistakes();
        if let Some(first) = mistakes.first() {
            let more =
                if mistakes.len() > 1 { format!(" (and {} more, see the diagnostics)", mistakes.len() - 1) } else { String::new() };
            return (Err(Ending::new(PATCHLIGHT_INVALID_SCENE, format_args!("{}{more}", first.text))), mistakes);
        }

        // The faces of arrays, then those of files; the same with materials.
        let mut diagnostics = Diagnostics::default();
        let corners: Vec<[f64; 3]> = self.corners.iter().map(|&corner| self.vertices[corner as usize]).collect();
        let mut polygons = match polygons_of_arrays(&corners, &self.faces, &mut diagnostics) {
            Ok(polygons) => polygons,
            Err(error) => return self.failed(error.to_string(), diagnostics),
        };
        let mut materials: Vec<Material> = self.materials.iter().enumerate().map(|(k, row)| row.named(k)).collect();
        let mut faces = self.faces.len() as u32;
        for file in &self.files {
            append(&mut polygons, &mut materials, faces, &file.scene);
            faces += file.lines.len() as u32;
            diagnostics.items.extend(file.diagnostics.items.iter().cloned());
        }

        // The scene.
        let scene = match Scene::new(self.channels, materials, polygons, self.sides) {
            Ok(scene) => scene,
            Err(error) => return self.failed(error.to_string(), diagnostics),
        };
        let is_dark = !scene.surfaces().iter().any(|surface| scene.materials()[surface.material as usize].emits());
        diagnostics.items.retain(|item| item.kind != DiagnosticKind::NoLight);
        if is_dark {
            diagnostics
                .push(Diagnostic::new(DiagnosticKind::NoLight, "no light: no material of a face emits, so everything is black"));
        }
        let files: Vec<String> = self.files.iter().map(|file| file.file.display().to_string()).collect();
        let notes = diagnostics.items.iter().map(Note::of).collect();
        (Ok(Committed { scene, files: files.join(", "), warnings: diagnostics.warnings() }), notes)
    }

    /// What all of it together is wrong with.
    fn failed(&self, message: String, diagnostics: Diagnostics) -> (Outcome<Committed>, Vec<Note>) {
        let mut notes: Vec<Note> = diagnostics.items.iter().map(Note::of).collect();
        notes.push(Note::mistake(Code::PATCHLIGHT_BAD_SCENE, None, message.clone()));
        (Err(Ending::new(PATCHLIGHT_INVALID_SCENE, message)), notes)
    }

    /// What is wrong with each face and material.
    fn mistakes(&self) -> Vec<Note> {
        let mut mistakes = Vec::new();
        let mut first = 0;
        for (number, face) in self.faces.iter().enumerate() {
            let corners = &self.corners[first..first + face.corners];
            first += face.corners;
            if mistakes.len() >= MOST_MISTAKES {
                break;
            }
            if let Some((code, text)) = self.mistake_of(face, corners) {
                mistakes.push(Note::mistake(code, Some(number as u64), format!("face {}: {text}", number + 1)));
            }
        }
        for (number, row) in self.materials.iter().enumerate() {
            if let Some(text) = row.mistake() {
                mistakes.push(Note::mistake(Code::PATCHLIGHT_BAD_MATERIAL, None, format!("material {number}: {text}")));
            }
        }
        mistakes.truncate(MOST_MISTAKES);
        mistakes
    }

    fn mistake_of(&self, face: &ArrayFace, corners: &[u64]) -> Option<(Code, String)> {
        let (vertices, materials) = (self.vertices.len(), self.materials.len());
        if let Some(corner) = corners.iter().find(|&&corner| corner >= vertices as u64) {
            return Some((
                Code::PATCHLIGHT_BAD_INDEX,
                format!("vertex {corner} does not exist: there are {vertices}, numbered from 0"),
            ));
        }
        if face.material as usize >= materials {
            let text = format!("material {} does not exist: there are {materials}, numbered from 0", face.material);
            return Some((Code::PATCHLIGHT_BAD_INDEX, text));
        }
        let is_bad = |&&corner: &&u64| !self.vertices[corner as usize].iter().all(|x| x.abs() <= LARGEST_COORDINATE);
        let bad = corners.iter().find(is_bad)?;
        Some((
            Code::PATCHLIGHT_BAD_VERTEX,
            format!("vertex {bad} has a coordinate that is not a number below {LARGEST_COORDINATE:e}"),
        ))
    }
}

impl MaterialRow {
    fn named(&self, number: usize) -> Material {
        Material { name: format!("material {number}"), reflectance: self.reflectance.clone(), exitance: self.exitance.clone() }
    }

    /// What is wrong with it by itself. What is wrong with all of them together, the scene finds.
    fn mistake(&self) -> Option<String> {
        if let Some(rho) = self.reflectance.iter().find(|rho| !(0.0..1.0).contains(*rho)) {
            return Some(format!("reflectance {rho} is not in [0, 1)"));
        }
        let bad = self.exitance.iter().find(|e| !e.is_finite() || **e < 0.0);
        bad.map(|e| format!("exitance {e} W/m^2 is negative or not finite"))
    }
}

/// Puts a scene that was read behind what there is.
fn append(polygons: &mut Vec<(Polygon, u32, u32)>, materials: &mut Vec<Material>, first_face: u32, scene: &Scene) {
    let first_material = materials.len() as u32;
    materials.extend(scene.materials().iter().cloned());
    let of_surfaces = scene.surfaces().iter();
    polygons
        .extend(of_surfaces.map(|surface| (surface.polygon.clone(), first_material + surface.material, first_face + surface.face)));
}
