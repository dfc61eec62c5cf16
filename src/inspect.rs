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

use std::collections::BTreeMap;
use std::path::Path;

use glam::DVec3;

pub use self::findings::{FindingClass, Findings};
use self::overlaps::overlapping_faces;
use crate::geometry::Frame;
use crate::scene::Scene;
use crate::scene::import::{Diagnostic, DiagnosticKind};
use crate::visibility::{Hit, Ray, Visibility};

/// Points by default: shares are then right to about one percent.
pub const DEFAULT_POINTS: u32 = 1 << 11;

/// Rays from each point.
const RAYS_PER_POINT: u32 = 16;

/// A point lies inside of something if so many of its rays, or more, meet backs.
const RAYS_OF_INSIDE: u32 = 15;

/// Shares below this are not reported: edges and contacts cause such by rounding.
const SHARE_WORTH_TELLING: f64 = 0.005;

/// The most faces that are named.
const NAMED_FACES: usize = 5;

/// What the rays met.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Inspection {
    /// How many points rays were cast from.
    pub points: u32,
    /// How many of them lie inside of closed objects.
    pub inside: u32,
    /// Where these are, in metres.
    pub inside_at: Vec<[f64; 3]>,
    /// How many rays left the other points.
    pub rays: u32,
    /// How many of these rays left the scene.
    pub escaped: u32,
    /// How many of them met the back of a one-sided surface first.
    pub met_back: u32,
    /// The faces whose backs were met: 0-based number in the input and how often, the most met first.
    pub back_faces: Vec<(u32, u32)>,
    /// Faces that lie in the front of others, nearer than visibility tells apart: the 0-based number of each, ascending, and that of one other.
    pub overlapping: Vec<(u32, u32)>,
}

/// Casts rays from `points` points (at least one) on the surfaces of `scene`; `visibility` must be of that scene.
pub fn inspect(scene: &Scene, visibility: &dyn Visibility, points: u32) -> Inspection {
    let points = points.clamp(1, u32::MAX / RAYS_PER_POINT);

    // Areas up to and with each surface, to pick surfaces by area.
    let mut total = 0.0;
    let areas: Vec<f64> = (scene.surfaces().iter())
        .map(|surface| {
            total += surface.polygon.area();
            total
        })
        .collect();

    // Rays from points at even steps through the areas.
    let sample = |index, dimension, seed| f64::from(sobol_burley::sample(index, dimension, seed));
    let mut queries = Vec::with_capacity((points * RAYS_PER_POINT) as usize);
    for point in 0..points {
        let picked = (f64::from(point) + 0.5) / f64::from(points) * total;
        let surface = &scene.surfaces()[areas.partition_point(|&area| area < picked).min(areas.len() - 1)];
        let facet = surface.polygon.facet();
        let origin = facet.point_at(sample(point, 0, 0), sample(point, 1, 0));
        let frame = Frame::around(facet.normal);

        // Points of the unit disk, lifted to the hemisphere, are cosine-distributed directions (Malley's method).
        queries.extend((0..RAYS_PER_POINT).map(|ray| {
            let (radius, angle) = (sample(ray, 0, point + 1).sqrt(), std::f64::consts::TAU * sample(ray, 1, point + 1));
            let height = (1.0 - radius * radius).max(0.0).sqrt();
            let direction = frame.to_world(DVec3::new(radius * angle.cos(), radius * angle.sin(), height));
            Ray { origin: origin.to_array(), direction: direction.to_array(), origin_plane: surface.plane }
        }));
    }
    let mut hits = vec![None; queries.len()];
    visibility.first_hits(&queries, &mut hits);

    // What they meet; `back` is the surface whose back a ray meets first.
    let back = |ray: &Ray, hit: &Option<Hit>| {
        let surface = &scene.surfaces()[hit.as_ref()?.surface as usize];
        let behind = surface.polygon.facet().normal.dot(DVec3::from(ray.direction)) > 0.0;
        (surface.twin.is_none() && behind).then_some(surface)
    };
    let mut inspection = Inspection { points, overlapping: overlapping_faces(scene), ..Inspection::default() };
    let mut met: BTreeMap<u32, u32> = BTreeMap::new();
    let per_point = RAYS_PER_POINT as usize;
    for (rays, hits) in queries.chunks(per_point).zip(hits.chunks(per_point)) {
        let backs: Vec<_> = rays.iter().zip(hits).filter_map(|(ray, hit)| back(ray, hit)).collect();
        if backs.len() >= RAYS_OF_INSIDE as usize {
            inspection.inside += 1;
            inspection.inside_at.push(rays[0].origin);
            continue;
        }
        inspection.rays += RAYS_PER_POINT;
        inspection.escaped += hits.iter().filter(|hit| hit.is_none()).count() as u32;
        inspection.met_back += backs.len() as u32;
        for surface in backs {
            *met.entry(surface.face).or_default() += 1;
        }
    }
    inspection.back_faces = met.into_iter().collect();
    inspection.back_faces.sort_by_key(|&(face, count)| (std::cmp::Reverse(count), face));
    inspection
}

impl Inspection {
    /// A number of rays as a part of all.
    fn share(&self, rays: u32) -> f64 {
        f64::from(rays) / f64::from(self.rays.max(1))
    }

    /// The part of the area that lies inside of closed objects, if it is worth telling.
    fn inside_share(&self) -> Option<f64> {
        let share = f64::from(self.inside) / f64::from(self.points.max(1));
        (share >= SHARE_WORTH_TELLING).then_some(share)
    }

    /// What a user should be told. `lines` holds the line of each face in `file`, see
    /// [`Imported::lines`](crate::scene::import::Imported::lines).
    pub fn suspicions(&self, file: &Path, lines: &[u32]) -> Vec<Diagnostic> {
        let share = |count| self.share(count);
        let percent = |count| format!("{:.1}%", 100.0 * share(count));
        let line_of = |face: u32| lines.get(face as usize).copied().unwrap_or(0);
        let mut diagnostics = Vec::new();

        // The worst faces with their lines.
        if share(self.met_back) >= SHARE_WORTH_TELLING {
            for (rank, &(face, count)) in self.back_faces.iter().take(NAMED_FACES).enumerate() {
                let mut text = format!("its back is met first by {} of the rays from surfaces; it is black there", percent(count));
                if rank == 0 {
                    text += &format!(
                        " (all backs: {}, {} faces; if this is not meant, turn the faces or use --sides both)",
                        percent(self.met_back),
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
        if share(self.escaped) >= SHARE_WORTH_TELLING {
            let text = format!("the scene is open: {} of the rays from its surfaces leave it", percent(self.escaped));
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
        assert_eq!((inspection.points, inspection.rays, inspection.escaped, inspection.met_back), (600, 9600, 0, 0));
        assert_eq!(inspection.suspicions(Path::new("a.obj"), &[]), []);
    }

    #[test]
    fn the_open_share_is_the_form_factor_to_the_opening() {
        // From each of five sides of a cube one fifth of the light reaches the sixth in the mean over adjacent and opposite: with
        // F(opposite) = 0.199825 and four times F(adjacent) = 0.200044 the mean is exactly 1/5.
        let inspection = inspected(&cube(&[], &[1], Sides::Front));
        let share = f64::from(inspection.escaped) / f64::from(inspection.rays);
        assert!((share - 0.2).abs() < 0.01, "{share}");
        let diagnostics = inspection.suspicions(Path::new("a.obj"), &[]);
        assert_eq!(diagnostics.iter().map(|d| d.kind).collect::<Vec<_>>(), [DiagnosticKind::Open]);
    }

    #[test]
    fn a_turned_wall_is_named_with_its_line() {
        let scene = cube(&[3], &[], Sides::Front);
        let inspection = inspected(&scene);
        assert_eq!(inspection.back_faces.len(), 1);
        assert_eq!(inspection.back_faces[0], (3, inspection.met_back));
        let told = inspection.suspicions(Path::new("a.obj"), &[10, 20, 30, 40, 50, 60]);
        let text = told.iter().find(|d| d.kind == DiagnosticKind::BackFaceSeen).unwrap().to_string();
        assert!(text.starts_with("a.obj:40: face 4: ") && text.contains("--sides both"), "{text}");

        // With both sides there is no back.
        assert_eq!(inspected(&cube(&[3], &[], Sides::Both)).met_back, 0);
    }

    #[test]
    fn the_same_scene_gives_the_same_answer() {
        let scene = cube(&[2], &[0], Sides::Front);
        assert_eq!(inspected(&scene), inspected(&scene));
    }
}
