//! Three simple scenes after figure 5.3 of the thesis, which shows them without measures: a lamp above a floor; a wall at either side; and
//! something in the way. All is grey with reflectances between 0.3 and 0.7, the left wall brighter than the right one.

use patchlight::scene::Scene;

use crate::rooms::Room;

/// One of the scenes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Configuration {
    /// Direct illumination only.
    Direct,
    /// Interreflections without occlusion.
    Walls,
    /// Interreflections with occlusion.
    Occluded,
}

/// A rectangle with its reflectance and exitance, facing along `u x v`.
#[derive(Clone, Copy)]
pub struct Face {
    pub corner: [f64; 3],
    pub u: [f64; 3],
    pub v: [f64; 3],
    pub reflectance: f64,
    pub exitance: f64,
    pub material: &'static str,
}

/// Side of the lamp and of the sheet in the way, both in the middle; the floor has side 1, the walls as well.
const LAMP: f64 = 0.25;
const SHEET: f64 = 0.375;
const SHEET_HEIGHT: f64 = 0.5;

impl Configuration {
    pub const ALL: [Self; 3] = [Self::Direct, Self::Walls, Self::Occluded];

    pub fn letter(self) -> char {
        match self {
            Self::Direct => 'a',
            Self::Walls => 'b',
            Self::Occluded => 'c',
        }
    }

    pub fn name(self) -> &'static str {
        match self {
            Self::Direct => "direct light alone",
            Self::Walls => "interreflection",
            Self::Occluded => "interreflection, occluded",
        }
    }

    /// All faces; the floor is the first, the sides of the sheet are the last.
    pub fn faces(self) -> Vec<Face> {
        let grey = |corner, u, v, reflectance, material| Face { corner, u, v, reflectance, exitance: 0.0, material };
        let low = 0.5 * (1.0 - LAMP);
        let lamp = Face {
            corner: [low, low, 1.0],
            u: [0.0, LAMP, 0.0],
            v: [LAMP, 0.0, 0.0],
            reflectance: 0.0,
            exitance: 10.0,
            material: "lamp",
        };
        let mut faces = vec![grey([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], 0.5, "floor"), lamp];
        if self != Self::Direct {
            faces.push(grey([0.0; 3], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], 0.7, "left"));
            faces.push(grey([1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0], 0.3, "right"));
        }
        if self == Self::Occluded {
            let (low, across, along) = (0.5 * (1.0 - SHEET), [SHEET, 0.0, 0.0], [0.0, SHEET, 0.0]);
            faces.push(grey([low, low, SHEET_HEIGHT], across, along, 0.4, "sheet"));
            faces.push(grey([low, low, SHEET_HEIGHT], along, across, 0.4, "sheet"));
        }
        faces
    }

    pub fn scene(self) -> Scene {
        let mut room = Room::default();
        for face in self.faces() {
            let material = room.named_material(face.material, &[face.reflectance], &[face.exitance]);
            room.quad(face.corner, face.u, face.v, material);
        }
        room.scene()
    }
}
