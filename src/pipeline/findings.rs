//! What is wrong with a scene: a picture of what was found, and rays from its surfaces.

use super::{Evaluator, PipelineError};
use crate::inspect::{FindingClass, Findings, SurfaceRays};
use crate::output::KeyLine;
use crate::picture::{BACK_COLOUR, Camera, PlainMark, PlainPicture, PlainView};
use crate::scene::Scene;
use crate::scene::import::DiagnosticKind;
use crate::visibility::{self, Backend, OccluderMesh, Visibility};

/// Draws a scene in plain shades, with surfaces in the colours of what was found about them, and the key to these. `visibility` must be of that
/// scene. Repairs and suspicions show through what hides them.
///
/// # Errors
/// [`PipelineError::Camera`] if the camera sees nothing, and [`PipelineError::Visibility`] where what is found cannot be looked for.
pub fn picture_of_findings(
    scene: &Scene,
    findings: &Findings,
    visibility: &dyn Visibility,
    camera: &Camera,
) -> Result<(PlainPicture, Vec<KeyLine>), PipelineError> {
    let class_of = |surface: u32| findings.of_surfaces.get(surface as usize).copied().flatten();
    let colours: Vec<Option<[u8; 3]>> =
        (0..scene.surfaces().len() as u32).map(|surface| Some(FindingClass::ALL[class_of(surface)?].colour)).collect();

    // What is wrong is looked for behind everything else.
    let is_wrong = |surface: u32| class_of(surface).is_some_and(|class| !FindingClass::ALL[class].is_note());
    let either_side = |surface: u32| {
        let twin = scene.surfaces()[surface as usize].twin();
        is_wrong(surface) || twin.is_some_and(|twin| is_wrong(twin.0))
    };
    let mesh = OccluderMesh::of_surfaces(scene, either_side);
    let through = if mesh.triangles.is_empty() { None } else { Some(visibility::build(Backend::Auto, &mesh)?) };

    let mark = |&(class, place): &(usize, [f64; 3])| {
        let FindingClass { colour, .. } = FindingClass::ALL[class];
        PlainMark { place, colour, is_cross: !FindingClass::ALL[class].is_note() }
    };
    let places: Vec<PlainMark> = findings.places.iter().map(mark).collect();
    let view = PlainView { scene, visibility, colours: &colours, through: through.as_deref(), places: &places };
    let picture = view.take(camera)?;
    let key = key(findings, &picture);
    Ok((picture, key))
}

impl Evaluator {
    /// Rays from `points` points on the surfaces, and which of them light would be lost on.
    pub fn surface_rays(&self, points: u32) -> SurfaceRays {
        self.pool.install(|| SurfaceRays::cast(self.solution.scene(), &*self.visibility, points))
    }
}

/// What the colours mean, with numbers.
fn key(findings: &Findings, picture: &PlainPicture) -> Vec<KeyLine> {
    let line = |colour, text: String| KeyLine { colour, text };
    let mut key = Vec::new();
    if findings.are_notes() {
        key.push(line(None, "nothing is found wrong".to_owned()));
    }
    for (class, &faces) in FindingClass::ALL.iter().zip(&findings.faces).filter(|(_, faces)| **faces > 0) {
        let noun = if faces == 1 { "face" } else { "faces" };
        key.push(line(Some(class.colour), format!("{}: {faces} {noun}", class.words)));
    }
    let dots = FindingClass::ALL.iter().find(|class| class.kinds.contains(&DiagnosticKind::Inside));
    if let (Some(share), Some(class)) = (findings.inside, dots) {
        key.push(line(Some(class.colour), format!("{}: {:.1}% of the area", class.words, 100.0 * share)));
    }
    if findings.elsewhere > 0 {
        key.push(line(None, format!("about no face: {}", findings.elsewhere)));
    }
    if picture.shows_backs {
        key.push(line(Some(BACK_COLOUR), "backs, seen from here".to_owned()));
    }
    if picture.shows_stripes {
        key.push(line(None, "stripes: behind what is seen".to_owned()));
    }
    key
}
