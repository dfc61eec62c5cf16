//! What was noted about a scene: repairs, notes and suspicions, each with its place in the input.

use std::fmt;
use std::path::{Path, PathBuf};

use serde::Serialize;

/// How serious a diagnostic is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Severity {
    /// The input was changed: what is solved is not exactly what the file says.
    Repair,
    /// The input is taken as it is, but may not be what was meant.
    Suspicion,
    /// Worth knowing; nothing is wrong.
    Note,
}

/// What a diagnostic is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum DiagnosticKind {
    /// A face without area was dropped.
    DegenerateFace,
    /// A face on the same vertices with the same winding as an earlier one was dropped.
    DuplicateFace,
    /// A face whose vertices lie in no plane was cut into triangles.
    NonPlanarFace,
    /// A material library is missing or cannot be read; none of its materials is needed.
    MissingLibrary,
    /// A material is defined nowhere; it is grey 0.5.
    MissingMaterial,
    /// A texture is missing or cannot be read; its material has one colour.
    MissingTexture,
    /// Faces that name no material are grey 0.5.
    NoMaterial,
    /// A material without `Kd` is grey 0.5.
    NoReflectance,
    /// A reflectance of 1 or more was lowered to 0.99.
    ReflectanceClamped,
    /// A negative reflectance or emission was raised to 0.
    NegativeValue,
    /// A material is defined twice; the first definition counts.
    MaterialDefinedTwice,
    /// The file is not UTF-8 and was read as Latin-1.
    NotUtf8,
    /// Nothing emits light.
    NoLight,
    /// A face crosses itself.
    CrossingFace,
    /// Backs of one-sided faces are seen from the fronts of others.
    BackFaceSeen,
    /// A face lies in the front of another, nearer than visibility tells apart.
    Overlap,
    /// Part of the light leaves the scene.
    Open,
    /// Textures, highlights or transparency, which diffuse materials do not have, were left out.
    IgnoredProperty,
    /// Statements that are no part of the format were left out.
    UnknownKeyword,
    /// Points, lines, curves and curved surfaces were left out.
    IgnoredElement,
    /// Corners were moved onto the plane of their face by less than the digits of the file are worth.
    Flattened,
    /// Part of the surfaces lies inside of closed objects, as a floor does under a box.
    Inside,
    /// A concave face was cut into convex pieces, which changes nothing.
    ConcaveFace,
    /// Two faces on the same vertices with opposite winding: the two sides of a sheet.
    Sheet,
    /// The file has a camera: what to type to look through it.
    Camera,
    /// How lights that are no surfaces are read, and what of them is left out.
    Light,
}

impl DiagnosticKind {
    /// Its severity.
    pub fn severity(self) -> Severity {
        match self {
            Self::DegenerateFace
            | Self::DuplicateFace
            | Self::NonPlanarFace
            | Self::MissingLibrary
            | Self::MissingMaterial
            | Self::MissingTexture
            | Self::NoMaterial
            | Self::NoReflectance
            | Self::ReflectanceClamped
            | Self::NegativeValue
            | Self::MaterialDefinedTwice => Severity::Repair,
            Self::NotUtf8
            | Self::NoLight
            | Self::CrossingFace
            | Self::BackFaceSeen
            | Self::Overlap
            | Self::IgnoredProperty
            | Self::UnknownKeyword
            | Self::IgnoredElement => Severity::Suspicion,
            Self::Open | Self::Flattened | Self::Inside | Self::ConcaveFace | Self::Sheet | Self::Camera | Self::Light => {
                Severity::Note
            }
        }
    }
}

/// One thing that was noted.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Diagnostic {
    /// What it is about.
    pub kind: DiagnosticKind,
    /// The file, where it is about one.
    pub file: Option<PathBuf>,
    /// The line in the file, from 1.
    pub line: Option<u32>,
    /// The number of the face in the file, from 1.
    pub face: Option<u32>,
    /// The object that the face belongs to, where the file names it.
    pub object: Option<String>,
    /// The material that it is about, where it is about one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub material: Option<String>,
    /// What was found and what was made of it.
    pub text: String,
}

impl Diagnostic {
    /// A diagnostic about no place.
    pub fn new(kind: DiagnosticKind, text: impl Into<String>) -> Self {
        Self { kind, file: None, line: None, face: None, object: None, material: None, text: text.into() }
    }

    /// The same about a line of a file.
    #[must_use]
    pub fn at(mut self, file: &Path, line: u32) -> Self {
        self.file = Some(file.to_owned());
        self.line = (line > 0).then_some(line);
        self
    }

    /// The same about a face, counted from 1.
    #[must_use]
    pub fn face(mut self, face: u32) -> Self {
        self.face = Some(face);
        self
    }

    /// The same about a material.
    #[must_use]
    pub fn material(mut self, name: &str) -> Self {
        self.material = Some(name.to_owned());
        self
    }

    /// How serious it is.
    pub fn severity(&self) -> Severity {
        self.kind.severity()
    }

    /// The face that it is about, where that was not dropped.
    fn face_in_scene(&self) -> Option<u32> {
        self.face.filter(|_| !matches!(self.kind, DiagnosticKind::DegenerateFace | DiagnosticKind::DuplicateFace))
    }
}

/// `file:line: object: face N: text`, as far as they are known.
impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(file) = &self.file {
            write!(f, "{}", file.display())?;
            if let Some(line) = self.line {
                write!(f, ":{line}")?;
            }
            write!(f, ": ")?;
        }
        if let Some(object) = &self.object {
            write!(f, "{object}: ")?;
        }
        if let Some(face) = self.face {
            write!(f, "face {face}: ")?;
        }
        write!(f, "{}", self.text)
    }
}

/// All that was noted, in the order of the input.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Diagnostics {
    /// One by one.
    pub items: Vec<Diagnostic>,
}

impl Diagnostics {
    /// So many of one kind are listed by [`Diagnostics::lines`] before "... and N more".
    pub const LISTED_PER_KIND: usize = 4;

    /// Adds one.
    pub fn push(&mut self, diagnostic: Diagnostic) {
        self.items.push(diagnostic);
    }

    /// How many there are of a kind.
    pub fn count(&self, kind: DiagnosticKind) -> usize {
        self.items.iter().filter(|item| item.kind == kind).count()
    }

    /// The first of a kind.
    pub fn first(&self, kind: DiagnosticKind) -> Option<&Diagnostic> {
        self.items.iter().find(|item| item.kind == kind)
    }

    /// Lines to show of one severity: kind after kind, the first few of each, then how many more there are.
    pub fn lines(&self, severity: Severity) -> Vec<String> {
        self.listed(severity).into_iter().map(|(line, _)| line).collect()
    }

    /// Lines of one severity, with the face in the scene that each is about.
    fn listed(&self, severity: Severity) -> Vec<(String, Option<u32>)> {
        let mut of_kind: std::collections::BTreeMap<DiagnosticKind, Vec<&Diagnostic>> = Default::default();
        for item in self.items.iter().filter(|item| item.severity() == severity) {
            of_kind.entry(item.kind).or_default().push(item);
        }

        let mut lines = Vec::new();
        for items in of_kind.values() {
            lines.extend(items.iter().take(Self::LISTED_PER_KIND).map(|item| (item.to_string(), item.face_in_scene())));
            if items.len() > Self::LISTED_PER_KIND {
                lines.push((format!("... and {} more like this", items.len() - Self::LISTED_PER_KIND), None));
            }
        }
        lines
    }

    /// Lines that a user should see without asking: repairs and suspicions.
    pub fn warnings(&self) -> Vec<String> {
        let mut lines = self.lines(Severity::Repair);
        lines.extend(self.lines(Severity::Suspicion));
        lines
    }

    /// The face that each of [`Self::warnings`] is about, by its number in the input from 1; `None` where it is about none, or about one that was dropped.
    pub fn warned_faces(&self) -> Vec<Option<u32>> {
        let of = |severity| self.listed(severity).into_iter().map(|(_, face)| face);
        of(Severity::Repair).chain(of(Severity::Suspicion)).collect()
    }
}
