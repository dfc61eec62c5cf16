//! The light of lamps at a place, by rays that do without links.
//!
//! Each lamp is cut into pieces that are small as seen from the place, each with its exact form factor. Rays are spread over the pieces by
//! what they carry, so no single ray weighs much, even a millimetre from a lamp.

use glam::DVec3;

use super::light_paths::Place;
use crate::form_factor::{kernel, point_to_polygon};
use crate::geometry::{Facet, Part, sampling};
use crate::hierarchy::for_each_piece;
use crate::scene::{Scene, SurfaceId};
use crate::transmittance::Rays;
use crate::visibility::Segment;

/// A piece is small if its radius is below this part of its distance.
const SMALL: f64 = 0.5;

/// A lamp is cut so many times at most.
const MAX_SPLITS: u8 = 6;

/// Where more than this part of all area emits, rays over the hemisphere meet emitters well enough, and there are no lamps.
const MOSTLY_EMITTING: f64 = 0.2;

/// The emitters that are sampled by rays of their own.
pub(super) struct Lamps<'a> {
    scene: &'a Scene,
    surfaces: Vec<SurfaceId>,
}

/// A piece of a lamp as seen from a place.
struct Piece {
    lamp: SurfaceId,
    part: Option<Part>,
    form_factor: f64,
    carried: f64,
}

/// A ray to a piece of a lamp.
struct Drawn {
    place: usize,
    lamp: SurfaceId,
    /// The piece's exact form factor, and the sample of it that this ray is.
    form_factor: f64,
    sampled: f64,
    /// How many of its kind the ray stands for: pieces are drawn by what they carry.
    share: f64,
}

impl<'a> Lamps<'a> {
    pub fn new(scene: &'a Scene) -> Self {
        let area = |id: SurfaceId| scene.surface(id).polygon.area();
        let all = || (0..scene.surfaces().len() as u32).map(SurfaceId);
        let mut surfaces: Vec<SurfaceId> = all().filter(|&id| scene.material_of(id).emits()).collect();
        if surfaces.iter().map(|&id| area(id)).sum::<f64>() > MOSTLY_EMITTING * all().map(area).sum::<f64>() {
            surfaces.clear();
        }
        Self { scene, surfaces }
    }

    /// Whether the emission of a surface is sampled here, so that other rays must leave it out.
    pub fn contains(&self, surface: SurfaceId) -> bool {
        !self.surfaces.is_empty() && self.scene.material_of(surface).emits()
    }

    /// Adds the irradiance from all lamps at each place, by `count` rays; without bias for any number of rays. `irradiance` has the
    /// channels of the first place first.
    pub fn add_sampled_irradiance(&self, places: &[Place], rays: &Rays<'_>, count: u32, irradiance: &mut [f64]) {
        if self.surfaces.is_empty() {
            return;
        }
        let (mut pieces, mut segments, mut drawn) = (Vec::new(), Vec::new(), Vec::new());
        for (index, place) in places.iter().enumerate() {
            self.aim(place, index, count, &mut pieces, &mut segments, &mut drawn);
        }
        let mut occluded = Vec::new();
        rays.occluded(&segments, &mut occluded);

        // What is blocked is taken from the exact form factor: there is no noise where nothing is blocked.
        let channels = self.scene.channels();
        for (drawn, occluded) in drawn.into_iter().zip(occluded) {
            let visible = drawn.form_factor - if occluded { drawn.sampled } else { 0.0 };
            let exitance = &self.scene.material_of(drawn.lamp).exitance;
            for (h, e) in irradiance[drawn.place * channels..][..channels].iter_mut().zip(exitance) {
                *h += visible * drawn.share * e;
            }
        }
    }

    /// Spreads the rays of a place over the pieces of lamps by what they carry, systematically from a random start.
    fn aim(
        &self,
        place: &Place,
        index: usize,
        count: u32,
        pieces: &mut Vec<Piece>,
        segments: &mut Vec<Segment>,
        drawn: &mut Vec<Drawn>,
    ) {
        let receiver = self.scene.surface(place.surface);
        let normal = receiver.polygon.facet().normal;
        pieces.clear();
        for &lamp in &self.surfaces {
            self.cut(place.point, normal, lamp, None, pieces);
        }
        let total: f64 = pieces.iter().map(|piece| piece.carried).sum();
        if total <= 0.0 {
            return;
        }
        let start = sampling::unit(sampling::hash(place.seed, 5));
        let (mut above, mut next) = (0.0, 0);
        for (number, piece) in pieces.iter().enumerate() {
            above += piece.carried;
            let whole = self.scene.surface(piece.lamp).polygon.facet();
            let facet = piece.part.as_ref().map_or(whole, |part| part.facet(whole.normal));
            let first = next;
            while next < count && (f64::from(next) + start) / f64::from(count) * total < above {
                let [u, v, ..] = sampling::sobol_4d(next - first, sampling::hash(place.seed, number as u64));
                let y = facet.point_at(u, v);
                let to_plane = self.scene.surface(piece.lamp).plane;
                segments.push(Segment { from: place.point.to_array(), to: y.to_array(), from_plane: receiver.plane, to_plane });
                drawn.push(Drawn {
                    place: index,
                    lamp: piece.lamp,
                    form_factor: piece.form_factor,
                    sampled: facet.area * kernel(place.point, normal, y, facet.normal),
                    share: total / (piece.carried * f64::from(count)),
                });
                next += 1;
            }
        }
    }

    /// Cuts a lamp, or a part of one, into pieces that are small as seen from `point`, and keeps those that can be seen.
    fn cut(&self, point: DVec3, normal: DVec3, lamp: SurfaceId, part: Option<Part>, pieces: &mut Vec<Piece>) {
        let whole = self.scene.surface(lamp).polygon.facet();
        let facet: Facet<'_> = part.as_ref().map_or(whole, |part| part.facet(whole.normal));
        let form_factor = point_to_polygon(point, normal, &facet);
        if form_factor <= 0.0 {
            return;
        }
        let splits = part.map_or(0, |part| part.splits);
        if facet.radius * facet.radius > SMALL * SMALL * point.distance_squared(facet.centroid) && splits < MAX_SPLITS {
            for_each_piece(&facet, |corners| self.cut(point, normal, lamp, Some(Part::new(corners, splits + 1)), pieces));
            return;
        }
        let brightest = self.scene.material_of(lamp).exitance.iter().copied().fold(0.0, f64::max);
        pieces.push(Piece { lamp, part, form_factor, carried: form_factor * brightest });
    }
}
