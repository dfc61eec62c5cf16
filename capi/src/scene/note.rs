//! What was noted about a scene, as it is kept.

use patchlight::scene::import::{Diagnostic, DiagnosticKind, Mistake, MistakeKind, Severity};

/// How serious a diagnostic is. Values may be added.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum patchlight_severity {
    /// The scene cannot be used.
    PATCHLIGHT_ERROR = 1,
    /// The input was changed: what is solved is not exactly what was given.
    PATCHLIGHT_REPAIR = 2,
    /// The input is taken as it is, but may not be what was meant.
    PATCHLIGHT_SUSPICION = 3,
    /// Worth knowing; nothing is wrong.
    PATCHLIGHT_NOTE = 4,
}

use patchlight_severity::*;

/// What a diagnostic is about. Values may be added within these ranges: 1 to 99 are repairs, 100 to 199 suspicions, 200 to 299 notes, 300 to
/// 399 errors.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum patchlight_diagnostic_code {
    /// A face without area was dropped.
    PATCHLIGHT_DEGENERATE_FACE = 1,
    /// A face on the same vertices with the same winding as an earlier one was dropped.
    PATCHLIGHT_DUPLICATE_FACE = 2,
    /// A face whose vertices lie in no plane was cut into triangles.
    PATCHLIGHT_NON_PLANAR_FACE = 3,
    /// A material library is missing; none of its materials is needed.
    PATCHLIGHT_MISSING_LIBRARY = 4,
    /// A material is defined nowhere; it is grey 0.5.
    PATCHLIGHT_MISSING_MATERIAL = 5,
    /// Faces that name no material are grey 0.5.
    PATCHLIGHT_NO_MATERIAL = 6,
    /// A material without reflectance is grey 0.5.
    PATCHLIGHT_NO_REFLECTANCE = 7,
    /// A reflectance of 1 or more was lowered to 0.99.
    PATCHLIGHT_REFLECTANCE_CLAMPED = 8,
    /// A negative reflectance or emission was raised to 0.
    PATCHLIGHT_NEGATIVE_VALUE = 9,
    /// A material is defined twice; the first definition counts.
    PATCHLIGHT_MATERIAL_DEFINED_TWICE = 10,
    /// A texture is missing or cannot be read; its material has one colour.
    PATCHLIGHT_MISSING_TEXTURE = 11,
    /// The file is not UTF-8 and was read as Latin-1.
    PATCHLIGHT_NOT_UTF8 = 100,
    /// Nothing emits light.
    PATCHLIGHT_NO_LIGHT = 101,
    /// A face crosses itself.
    PATCHLIGHT_CROSSING_FACE = 102,
    /// Backs of one-sided faces are seen from the fronts of others.
    PATCHLIGHT_BACK_FACE_SEEN = 103,
    /// Textures, highlights or transparency were left out.
    PATCHLIGHT_IGNORED_PROPERTY = 104,
    /// Statements that are no part of the format were left out.
    PATCHLIGHT_UNKNOWN_KEYWORD = 105,
    /// Points, lines, curves and curved surfaces were left out.
    PATCHLIGHT_IGNORED_ELEMENT = 106,
    /// A face lies in the front of another, nearer than visibility tells apart.
    PATCHLIGHT_OVERLAP = 107,
    /// Part of the light leaves the scene.
    PATCHLIGHT_OPEN = 200,
    /// Corners were moved onto the plane of their face by less than the digits of a file are worth.
    PATCHLIGHT_FLATTENED = 201,
    /// Part of the surfaces lies inside of closed objects.
    PATCHLIGHT_INSIDE = 202,
    /// A concave face was cut into convex pieces, which changes nothing.
    PATCHLIGHT_CONCAVE_FACE = 203,
    /// Two faces on the same vertices with opposite winding: the two sides of a sheet.
    PATCHLIGHT_SHEET = 204,
    /// The file has a camera: what to give to look through it.
    PATCHLIGHT_FILE_CAMERA = 205,
    /// How lights that are no surfaces are read, and what of them is left out.
    PATCHLIGHT_FILE_LIGHTS = 206,
    /// A face has a vertex or a material that does not exist.
    PATCHLIGHT_BAD_INDEX = 300,
    /// A face has a vertex with a coordinate that is not finite, or too large.
    PATCHLIGHT_BAD_VERTEX = 301,
    /// A material has a reflectance or an exitance that is out of range.
    PATCHLIGHT_BAD_MATERIAL = 302,
    /// All together makes no scene, as without any face.
    PATCHLIGHT_BAD_SCENE = 303,
}

use patchlight_diagnostic_code as Code;

/// A diagnostic as it is kept.
#[derive(Clone, Debug)]
pub struct Note {
    pub code: Code,
    pub severity: patchlight_severity,
    pub face: Option<u64>,
    pub line: Option<u64>,
    pub text: String,
}

impl Note {
    /// For which a commit fails.
    pub fn of_mistake(mistake: &Mistake) -> Self {
        let code = match mistake.kind {
            MistakeKind::BadIndex => Code::PATCHLIGHT_BAD_INDEX,
            MistakeKind::BadVertex => Code::PATCHLIGHT_BAD_VERTEX,
            MistakeKind::BadMaterial => Code::PATCHLIGHT_BAD_MATERIAL,
            MistakeKind::BadScene => Code::PATCHLIGHT_BAD_SCENE,
        };
        Self { code, severity: PATCHLIGHT_ERROR, face: mistake.face, line: None, text: mistake.text.clone() }
    }

    pub fn of(diagnostic: &Diagnostic) -> Self {
        let severity = match diagnostic.severity() {
            Severity::Repair => PATCHLIGHT_REPAIR,
            Severity::Suspicion => PATCHLIGHT_SUSPICION,
            Severity::Note => PATCHLIGHT_NOTE,
        };
        Self {
            code: code_of(diagnostic.kind),
            severity,
            face: diagnostic.face.map(|face| u64::from(face) - 1),
            line: diagnostic.line.map(u64::from),
            text: diagnostic.to_string(),
        }
    }
}

fn code_of(kind: DiagnosticKind) -> Code {
    match kind {
        DiagnosticKind::DegenerateFace => Code::PATCHLIGHT_DEGENERATE_FACE,
        DiagnosticKind::DuplicateFace => Code::PATCHLIGHT_DUPLICATE_FACE,
        DiagnosticKind::NonPlanarFace => Code::PATCHLIGHT_NON_PLANAR_FACE,
        DiagnosticKind::MissingLibrary => Code::PATCHLIGHT_MISSING_LIBRARY,
        DiagnosticKind::MissingMaterial => Code::PATCHLIGHT_MISSING_MATERIAL,
        DiagnosticKind::MissingTexture => Code::PATCHLIGHT_MISSING_TEXTURE,
        DiagnosticKind::NoMaterial => Code::PATCHLIGHT_NO_MATERIAL,
        DiagnosticKind::NoReflectance => Code::PATCHLIGHT_NO_REFLECTANCE,
        DiagnosticKind::ReflectanceClamped => Code::PATCHLIGHT_REFLECTANCE_CLAMPED,
        DiagnosticKind::NegativeValue => Code::PATCHLIGHT_NEGATIVE_VALUE,
        DiagnosticKind::MaterialDefinedTwice => Code::PATCHLIGHT_MATERIAL_DEFINED_TWICE,
        DiagnosticKind::NotUtf8 => Code::PATCHLIGHT_NOT_UTF8,
        DiagnosticKind::NoLight => Code::PATCHLIGHT_NO_LIGHT,
        DiagnosticKind::CrossingFace => Code::PATCHLIGHT_CROSSING_FACE,
        DiagnosticKind::BackFaceSeen => Code::PATCHLIGHT_BACK_FACE_SEEN,
        DiagnosticKind::Open => Code::PATCHLIGHT_OPEN,
        DiagnosticKind::IgnoredProperty => Code::PATCHLIGHT_IGNORED_PROPERTY,
        DiagnosticKind::UnknownKeyword => Code::PATCHLIGHT_UNKNOWN_KEYWORD,
        DiagnosticKind::IgnoredElement => Code::PATCHLIGHT_IGNORED_ELEMENT,
        DiagnosticKind::Overlap => Code::PATCHLIGHT_OVERLAP,
        DiagnosticKind::Flattened => Code::PATCHLIGHT_FLATTENED,
        DiagnosticKind::Inside => Code::PATCHLIGHT_INSIDE,
        DiagnosticKind::ConcaveFace => Code::PATCHLIGHT_CONCAVE_FACE,
        DiagnosticKind::Sheet => Code::PATCHLIGHT_SHEET,
        DiagnosticKind::Camera => Code::PATCHLIGHT_FILE_CAMERA,
        DiagnosticKind::Light => Code::PATCHLIGHT_FILE_LIGHTS,
    }
}
