//! What was found about the faces of a scene, surface by surface, so that a picture can show it.

use std::collections::{BTreeSet, HashMap, HashSet};

use super::{Inspection, SHARE_WORTH_TELLING};
use crate::scene::Scene;
use crate::scene::import::{DiagnosticKind, Imported, Severity};

/// Kinds of findings that are shown alike.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FindingClass {
    /// The kinds.
    pub kinds: &'static [DiagnosticKind],
    /// Their colour, in 8-bit sRGB.
    pub colour: [u8; 3],
    /// What the face is, before the number of such faces.
    pub words: &'static str,
}

impl FindingClass {
    /// All of them; a surface that several are about has the colour of the first.
    pub const ALL: [Self; 11] = [
        Self::new(&[DiagnosticKind::BackFaceSeen], [230, 40, 40], "back seen by fronts"),
        Self::new(&[DiagnosticKind::CrossingFace], [235, 0, 215], "crosses itself"),
        Self::new(&[DiagnosticKind::Overlap], [255, 140, 0], "in the front of another"),
        Self::new(&[DiagnosticKind::DuplicateFace], [140, 70, 225], "dropped, repeats another"),
        Self::new(&[DiagnosticKind::DegenerateFace], [255, 225, 0], "dropped, no area (crosses)"),
        Self::new(&[DiagnosticKind::NonPlanarFace], [0, 190, 190], "not planar, cut"),
        Self::new(
            &[
                DiagnosticKind::MissingMaterial,
                DiagnosticKind::NoMaterial,
                DiagnosticKind::NoReflectance,
                DiagnosticKind::ReflectanceClamped,
                DiagnosticKind::NegativeValue,
            ],
            [165, 105, 45],
            "of a repaired material",
        ),
        Self::new(&[DiagnosticKind::Sheet], [70, 120, 255], "side of a sheet"),
        Self::new(&[DiagnosticKind::ConcaveFace], [110, 200, 80], "concave, cut"),
        Self::new(&[DiagnosticKind::Flattened], [185, 225, 130], "flattened, rounded digits"),
        Self::new(&[DiagnosticKind::Inside], [255, 255, 255], "inside of objects (dots)"),
    ];

    const fn new(kinds: &'static [DiagnosticKind], colour: [u8; 3], words: &'static str) -> Self {
        Self { kinds, colour, words }
    }

    /// Whether nothing is wrong with such faces.
    pub fn is_note(&self) -> bool {
        self.kinds.iter().all(|kind| kind.severity() == Severity::Note)
    }
}

/// What was found, by surface and by place.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Findings {
    /// By surface, the number of its class in [`FindingClass::ALL`].
    pub of_surfaces: Vec<Option<usize>>,
    /// Places of what has no surface: the number of the class, and where, in metres.
    pub places: Vec<(usize, [f64; 3])>,
    /// By class, how many faces of the input it is about; of what lies inside of closed objects none are counted.
    pub faces: [usize; FindingClass::ALL.len()],
    /// The part of the area that lies inside of closed objects, if it is worth telling.
    pub inside: Option<f64>,
    /// How many repairs and suspicions are about no face that could be shown.
    pub elsewhere: usize,
}

impl Findings {
    /// Whether there are only notes.
    pub fn are_notes(&self) -> bool {
        let is_fine = |(class, &faces): (&FindingClass, &usize)| faces == 0 || class.is_note();
        self.elsewhere == 0 && FindingClass::ALL.iter().zip(&self.faces).all(is_fine)
    }

    /// What was found while a scene was read, and by rays in it.
    pub fn new(imported: &Imported, inspection: &Inspection) -> Self {
        let scene = &imported.scene;
        let faces = FindingClass::ALL.map(|class| faces_of(class.kinds, imported, inspection));
        let mut class_of: HashMap<u32, usize> = HashMap::new();
        for (class, faces) in faces.iter().enumerate().filter(|(class, _)| !shows_dropped(*class)) {
            faces.iter().for_each(|&face| _ = class_of.entry(face).or_insert(class));
        }

        // What is not in the scene: a face that repeats another is seen there, others have a place.
        let [repeated, degenerate, within] =
            [DiagnosticKind::DuplicateFace, DiagnosticKind::DegenerateFace, DiagnosticKind::Inside].map(class_with);
        let mut places = Vec::new();
        for dropped in &imported.changed.dropped {
            match dropped.repeats {
                Some(shown) => {
                    let class = class_of.entry(shown).or_insert(repeated);
                    *class = repeated.min(*class);
                }
                None => places.push((degenerate, dropped.place)),
            }
        }
        let inside = inspection.inside_share().map_or(&[][..], |_| &inspection.met.inside_at);
        places.extend(inside.iter().map(|&place| (within, place)));
        let shown: HashSet<DiagnosticKind> = FindingClass::ALL.iter().flat_map(|class| class.kinds).copied().collect();
        let is_elsewhere = |kind: DiagnosticKind| !shown.contains(&kind) && kind.severity() != Severity::Note;
        Self {
            of_surfaces: scene.surfaces().iter().map(|surface| class_of.get(&surface.face).copied()).collect(),
            places,
            faces: faces.each_ref().map(BTreeSet::len),
            inside: inspection.inside_share(),
            elsewhere: imported.diagnostics.items.iter().filter(|item| is_elsewhere(item.kind)).count(),
        }
    }
}

/// The number of the class that a kind is in.
fn class_with(kind: DiagnosticKind) -> usize {
    FindingClass::ALL.iter().position(|class| class.kinds.contains(&kind)).unwrap_or(FindingClass::ALL.len() - 1)
}

/// Whether the faces of a class are not in the scene.
fn shows_dropped(class: usize) -> bool {
    matches!(FindingClass::ALL[class].kinds[0], DiagnosticKind::DuplicateFace | DiagnosticKind::DegenerateFace)
}

/// The faces that findings of some kinds are about, by their 0-based numbers.
fn faces_of(kinds: &[DiagnosticKind], imported: &Imported, inspection: &Inspection) -> BTreeSet<u32> {
    let mut faces = BTreeSet::new();
    for kind in kinds {
        let noted = || imported.diagnostics.items.iter().filter(move |item| item.kind == *kind);
        match kind {
            DiagnosticKind::BackFaceSeen if inspection.met.share(inspection.met.met_back()) >= SHARE_WORTH_TELLING => {
                faces.extend(backs_that_count(inspection));
            }
            DiagnosticKind::BackFaceSeen => {}
            DiagnosticKind::Overlap => faces.extend(inspection.overlapping.iter().map(|&(face, _)| face)),
            DiagnosticKind::Flattened => faces.extend(&imported.changed.flattened),
            _ => faces.extend(noted().filter_map(|item| Some(item.face? - 1))),
        }

        // A note about a material is about all its faces, one about a sheet about both sides.
        let named: HashSet<&str> = noted().filter_map(|item| item.material.as_deref()).collect();
        let materials = imported.scene.materials();
        match kind {
            DiagnosticKind::NoMaterial => add_faces_alike(&imported.scene, &mut faces),
            DiagnosticKind::Sheet => add_other_sides(&imported.scene, &mut faces),
            _ if named.is_empty() => {}
            _ => faces.extend(
                (imported.scene.surfaces().iter())
                    .filter(|surface| named.contains(materials[surface.material as usize].name.as_str()))
                    .map(|surface| surface.face),
            ),
        }
    }
    faces
}

/// The faces whose backs most rays met that met any: others are met along edges, by rounding.
fn backs_that_count(inspection: &Inspection) -> impl Iterator<Item = u32> + '_ {
    const PART_OF_RAYS: f64 = 0.95;
    let (enough, mut met) = (PART_OF_RAYS * f64::from(inspection.met.met_back()), 0.0);
    let until_enough = inspection.back_faces.iter().take_while(move |&&(_, count)| {
        let counts = met < enough;
        met += f64::from(count);
        counts
    });
    until_enough.map(|&(face, _)| face)
}

/// Adds all faces of the materials of some.
fn add_faces_alike(scene: &Scene, faces: &mut BTreeSet<u32>) {
    let among = |face: u32| faces.contains(&face);
    let materials: HashSet<u32> = scene.surfaces().iter().filter(|s| among(s.face)).map(|s| s.material).collect();
    faces.extend(scene.surfaces().iter().filter(|surface| materials.contains(&surface.material)).map(|surface| surface.face));
}

/// Adds the faces on the other sides of some.
fn add_other_sides(scene: &Scene, faces: &mut BTreeSet<u32>) {
    let sides = scene.surfaces().iter().filter(|surface| faces.contains(&surface.face));
    let others: Vec<u32> = sides.filter_map(|surface| Some(scene.surface(surface.twin()?).face)).collect();
    faces.extend(others);
}
