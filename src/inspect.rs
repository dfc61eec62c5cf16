//! Is a scene what its author meant? Rays from its surfaces tell.
//!
//! From points on the fronts, uniform by area, rays leave by the cosine law. If the first thing that such a ray meets is the back of
//! a face without a second side, light ends there that should be reflected: most often the face is wound the wrong way. Rays that
//! meet nothing measure how open the scene is. Shares are sampled: about 1/sqrt(rays) of accuracy, no guarantee. The points come from
//! an Owen-scrambled Sobol sequence (B. Burley, JCGT 9(4), 2020), so the same scene gives the same answer.

use std::collections::BTreeMap;
use std::path::Path;

use glam::DVec3;

use crate::geometry::Frame;
use crate::scene::Scene;
use crate::scene::import::{Diagnostic, DiagnosticKind};
use crate::visibility::{Ray, Visibility};

/// So many rays tell shares to about half a percent.
pub const DEFAULT_RAYS: u32 = 1 << 14;

/// A share below this is the noise of edges and contacts, not worth a word.
const SHARE_WORTH_TELLING: f64 = 0.005;

/// So many of the worst faces are named.
const NAMED_FACES: usize = 5;

/// What the rays met.
#[derive(Clone, Debug, PartialEq)]
pub struct Inspection {
    /// How many rays were cast.
    pub rays: u32,
    /// How many of them left the scene.
    pub escaped: u32,
    /// How many met the back of a one-sided surface first.
    pub met_back: u32,
    /// The faces whose backs were met: 0-based number in the input and how often, the most met first.
    pub back_faces: Vec<(u32, u32)>,
}

/// Casts `rays` rays (at least one) from the surfaces of `scene` into the scene that `visibility` was built of.
pub fn inspect(scene: &Scene, visibility: &dyn Visibility, rays: u32) -> Inspection {
    let rays = rays.max(1);

    // Areas up to and with each surface, to pick surfaces by area.
    let mut total = 0.0;
    let areas: Vec<f64> = (scene.surfaces().iter())
        .map(|surface| {
            total += surface.polygon.area();
            total
        })
        .collect();

    let sample = |index, dimension| f64::from(sobol_burley::sample(index, dimension, 0));
    let queries: Vec<Ray> = (0..rays)
        .map(|index| {
            let picked = (f64::from(index) + 0.5) / f64::from(rays) * total;
            let surface = &scene.surfaces()[areas.partition_point(|&area| area < picked).min(areas.len() - 1)];
            let facet = surface.polygon.facet();
            let origin = facet.point_at(sample(index, 0), sample(index, 1));

            // A point of the unit disk lifted to the hemisphere follows the cosine law (Malley's method).
            let (radius, angle) = (sample(index, 2).sqrt(), std::f64::consts::TAU * sample(index, 3));
            let height = (1.0 - radius * radius).max(0.0).sqrt();
            let local = DVec3::new(radius * angle.cos(), radius * angle.sin(), height);
            let direction = Frame::around(facet.normal).to_world(local);
            Ray { origin: origin.to_array(), direction: direction.to_array(), origin_plane: surface.plane }
        })
        .collect();
    let mut hits = vec![None; queries.len()];
    visibility.first_hits(&queries, &mut hits);

    // Count what was met.
    let mut inspection = Inspection { rays, escaped: 0, met_back: 0, back_faces: Vec::new() };
    let mut backs: BTreeMap<u32, u32> = BTreeMap::new();
    for (ray, hit) in queries.iter().zip(hits) {
        let Some(hit) = hit else {
            inspection.escaped += 1;
            continue;
        };
        let surface = &scene.surfaces()[hit.surface as usize];
        if surface.twin.is_none() && surface.polygon.facet().normal.dot(DVec3::from(ray.direction)) > 0.0 {
            inspection.met_back += 1;
            *backs.entry(surface.face).or_default() += 1;
        }
    }
    inspection.back_faces = backs.into_iter().collect();
    inspection.back_faces.sort_by_key(|&(face, count)| (std::cmp::Reverse(count), face));
    inspection
}

impl Inspection {
    /// What a user should hear of it. `lines` holds the line of each face in `file`, see
    /// [`Imported::lines`](crate::scene::import::Imported::lines).
    pub fn suspicions(&self, file: &Path, lines: &[u32]) -> Vec<Diagnostic> {
        let share = |count: u32| f64::from(count) / f64::from(self.rays);
        let percent = |count| format!("{:.1}%", 100.0 * share(count));
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
                let line = lines.get(face as usize).copied().unwrap_or(0);
                diagnostics.push(Diagnostic::new(DiagnosticKind::BackFaceSeen, text).at(file, line).face(face + 1));
            }
        }

        if share(self.escaped) >= SHARE_WORTH_TELLING {
            let text = format!("the scene is open: {} of the rays from its surfaces leave it", percent(self.escaped));
            diagnostics.push(Diagnostic::new(DiagnosticKind::Open, text).at(file, 0));
        }
        diagnostics
    }
}
