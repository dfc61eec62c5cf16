//! Is a scene what its author meant? Rays from its surfaces tell.
//!
//! Rays leave random points of the fronts in cosine-distributed directions. A ray that first meets the back of a one-sided face
//! tells that light is lost there that should be reflected: most often the face is wound the wrong way. A point from which nearly
//! all rays meet backs lies inside of a closed object, like the floor under a box: that is no mistake, and its rays do not count.
//! Rays that meet nothing measure how open the scene is. Shares are sampled, to about 1/sqrt(rays), without a guarantee. The points
//! come from an Owen-scrambled Sobol sequence (B. Burley, JCGT 9(4), 2020), so the same scene gives the same answer. Faces that cover one place
//! are found exactly (`overlaps`); what was found of each face can be drawn (`findings`).

mod findings;
mod overlaps;
mod rays;

use std::collections::BTreeMap;
use std::path::Path;

pub use self::findings::{FindingClass, Findings};
use self::overlaps::overlapping_faces;
pub use self::rays::{LostRay, SurfaceRays};
use crate::scene::Scene;
use crate::scene::import::{Diagnostic, DiagnosticKind};
use crate::visibility::Visibility;

/// Points by default: shares are then right to about one percent.
pub const DEFAULT_POINTS: u32 = 1 << 11;

/// Shares below this are not reported: edges and contacts cause such by rounding.
const SHARE_WORTH_TELLING: f64 = 0.005;

/// The most faces that are named.
const NAMED_FACES: usize = 5;

/// What is found about a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Inspection {
    /// What rays met.
    pub met: SurfaceRays,
    /// The faces whose backs were met: 0-based number in the input and how often, the most met first.
    pub back_faces: Vec<(u32, u32)>,
    /// Faces that lie in the front of others, nearer than visibility tells apart: the 0-based number of each, ascending, and that of one other.
    pub overlapping: Vec<(u32, u32)>,
}

/// Casts rays from `points` points (at least one) on the surfaces of `scene`; `visibility` must be of that scene.
pub fn inspect(scene: &Scene, visibility: &dyn Visibility, points: u32) -> Inspection {
    let met = SurfaceRays::cast(scene, visibility, points);
    let mut of_face: BTreeMap<u32, u32> = BTreeMap::new();
    for face in met.lost.iter().filter_map(|ray| ray.back_of) {
        *of_face.entry(face).or_default() += 1;
    }
    let mut back_faces: Vec<(u32, u32)> = of_face.into_iter().collect();
    back_faces.sort_by_key(|&(face, count)| (std::cmp::Reverse(count), face));
    Inspection { met, back_faces, overlapping: overlapping_faces(scene) }
}

impl Inspection {
    /// The part of the area that lies inside of closed objects, if it is worth telling.
    fn inside_share(&self) -> Option<f64> {
        let share = self.met.inside_at.len() as f64 / f64::from(self.met.points.max(1));
        (share >= SHARE_WORTH_TELLING).then_some(share)
    }

    /// What a user should be told. `lines` holds the line of each face in `file`, see
    /// [`Imported::lines`](crate::scene::import::Imported::lines).
    pub fn suspicions(&self, file: &Path, lines: &[u32]) -> Vec<Diagnostic> {
        let share = |count| self.met.share(count);
        let (escaped, met_back) = (self.met.escaped(), self.met.met_back());
        let percent = |count| format!("{:.1}%", 100.0 * share(count));
        let line_of = |face: u32| lines.get(face as usize).copied().unwrap_or(0);
        let mut diagnostics = Vec::new();

        // The worst faces with their lines.
        if share(met_back) >= SHARE_WORTH_TELLING {
            for (rank, &(face, count)) in self.back_faces.iter().take(NAMED_FACES).enumerate() {
                let mut text = format!("its back is met first by {} of the rays from surfaces; it is black there", percent(count));
                if rank == 0 {
                    text += &format!(
                        " (all backs: {}, {} faces; if this is not meant, turn the faces or use --sides both)",
                        percent(met_back),
                        self.back_faces.len()
                    );
                }
                diagnostics.push(Diagnostic::new(DiagnosticKind::BackFaceSeen, text).at(file, line_of(face)).face(face + 1));
            }
        }

        for &(face, other) in &self.overlapping {
            let text = format!("lies in the front of face {}: light that arrives there arrives at both", other + 1);
            diagnostics.push(Diagnostic::new(DiagnosticKind::Overlap, text).at(file, line_of(face)).face(face + 1));
        }

        if let Some(inside) = self.inside_share() {
            let text = format!("{:.1}% of the area lies inside of closed objects, where no light comes", 100.0 * inside);
            diagnostics.push(Diagnostic::new(DiagnosticKind::Inside, text).at(file, 0));
        }
        if share(escaped) >= SHARE_WORTH_TELLING {
            let text = format!("the scene is open: {} of the rays from its surfaces leave it", percent(escaped));
            diagnostics.push(Diagnostic::new(DiagnosticKind::Open, text).at(file, 0));
        }
        diagnostics
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Polygon;
    use crate::scene::{Material, Sides};
    use crate::visibility::{Backend, OccluderMesh, build};

    /// The inside of a unit cube; the faces in `turned` face outwards, those in `missing` are not there.
    fn cube(turned: &[usize], missing: &[usize], sides: Sides) -> Scene {
        let corner = |bits: usize| [bits & 1, bits >> 1 & 1, bits >> 2].map(|bit| bit as f64);
        let inwards = [[0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3], [0, 1, 3, 2], [4, 6, 7, 5]];
        let faces = (0..6)
            .filter(|face| !missing.contains(face))
            .map(|face| {
                let polygon = Polygon::new(&inwards[face].map(corner)).unwrap();
                (if turned.contains(&face) { polygon.reversed() } else { polygon }, 0, face as u32)
            })
            .collect();
        let grey = Material { name: String::new(), reflectance: vec![0.5], exitance: vec![1.0] };
        Scene::new(1, vec![grey], faces, sides).unwrap()
    }

    fn inspected(scene: &Scene) -> Inspection {
        let visibility = build(Backend::BruteForce, &OccluderMesh::of_scene(scene)).unwrap();
        inspect(scene, visibility.as_ref(), 600)
    }

    #[test]
    fn a_closed_cube_is_beyond_suspicion() {
        let inspection = inspected(&cube(&[], &[], Sides::Front));
        assert_eq!((inspection.met.points, inspection.met.rays, inspection.met.lost.len()), (600, 9600, 0));
        assert_eq!(inspection.suspicions(Path::new("a.obj"), &[]), []);
    }

    #[test]
    fn the_open_share_is_the_form_factor_to_the_opening() {
        // From each of five sides of a cube one fifth of the light reaches the sixth in the mean over adjacent and opposite: with
        // F(opposite) = 0.199825 and four times F(adjacent) = 0.200044 the mean is exactly 1/5.
        let inspection = inspected(&cube(&[], &[1], Sides::Front));
        let share = inspection.met.share(inspection.met.escaped());
        assert!((share - 0.2).abs() < 0.01, "{share}");
        let diagnostics = inspection.suspicions(Path::new("a.obj"), &[]);
        assert_eq!(diagnostics.iter().map(|d| d.kind).collect::<Vec<_>>(), [DiagnosticKind::Open]);
    }

    #[test]
    fn a_turned_wall_is_named_with_its_line() {
        let scene = cube(&[3], &[], Sides::Front);
        let inspection = inspected(&scene);
        assert_eq!(inspection.back_faces.len(), 1);
        assert_eq!(inspection.back_faces[0], (3, inspection.met.met_back()));
        let told = inspection.suspicions(Path::new("a.obj"), &[10, 20, 30, 40, 50, 60]);
        let text = told.iter().find(|d| d.kind == DiagnosticKind::BackFaceSeen).unwrap().to_string();
        assert!(text.starts_with("a.obj:40: face 4: ") && text.contains("--sides both"), "{text}");

        // With both sides there is no back.
        assert_eq!(inspected(&cube(&[3], &[], Sides::Both)).met.met_back(), 0);
    }

    #[test]
    fn the_same_scene_gives_the_same_answer() {
        let scene = cube(&[2], &[0], Sides::Front);
        assert_eq!(inspected(&scene), inspected(&scene));
    }
}
