//! Rays to what is undecided: parts of sources of which it is not known what hides them, and sources that bring little.
//!
//! What is undecided is cut into strata that are small as seen from the point and bring about equally much, and two independent rays go to
//! each: half the square of their difference tells the variance of either, without bias. A ray to a stratum of the form factor F that samples it as s
//! and finds it visible, v = 1, or not, v = 0, counts
//!
//! ```text
//! v s + beta (F - s)
//! ```
//!
//! with beta the part of the other rays of its group that see something, so that there is no bias (as in `paths/next_event`). Of sources that bring
//! little, a stratum is a share of all that they would bring, and each of its rays draws one of them.

use glam::DVec3;

use super::view::View;
use crate::form_factor::{from_directions, kernel, point_to_polygon};
use crate::geometry::{Facet, Part, for_each_piece, sampling, streams};
use crate::scene::SurfaceId;
use crate::transmittance::Rays;
use crate::visibility::Segment;

/// A stratum is small if its radius is at most this part of its distance: the kernel then varies by about as much as visibility does.
const SMALL: f64 = 0.5;

/// A source is cut so many times at most: strata around a point a ten-thousandth of its size away are small then.
const MAX_SPLITS: u8 = 14;

/// Strata come from quartering what is too large, so they bring from a quarter to all of the most: on average this part, if every size between
/// is as likely on a logarithmic scale, (1 - 1/4) / ln 4.
const OF_MOST: f64 = 0.54;

/// A ray that was drawn.
struct Drawn {
    source: SurfaceId,
    form_factor: f64,
    sampled: f64,
    /// One over the expected number of rays to the stratum.
    share: f64,
    group: u32,
}

/// A form factor below this is what rounding leaves of none, see [`direct_irradiance`](super::direct_irradiance): it is not cut further.
const ROUNDING: f64 = 1e-12;

/// Rays from a point to what is undecided, in pairs; memory that is reused.
#[derive(Default)]
pub(super) struct UndecidedRays {
    /// The strata of a source: ranges of corners, and form factors.
    corners: Vec<DVec3>,
    strata: Vec<([usize; 2], f64)>,
    segments: Vec<Segment>,
    drawn: Vec<Drawn>,
    occluded: Vec<bool>,
    /// By group: its rays, and those that see a source.
    seeing: Vec<[u32; 2]>,
}

impl UndecidedRays {
    pub fn restart(&mut self) {
        self.segments.clear();
        self.drawn.clear();
        self.seeing.clear();
    }

    pub fn is_empty(&self) -> bool {
        self.drawn.is_empty()
    }

    /// Draws about `count` rays to the pieces of a source that are left, given by directions to their corners.
    pub fn draw_to_pieces<'p>(
        &mut self,
        view: &View<'_>,
        source: SurfaceId,
        pieces: impl Iterator<Item = &'p [DVec3]> + Clone,
        count: u32,
        seed: u64,
    ) {
        // Cut what is too large, or brings more than a pair of rays should stand for.
        let height = view.source.height(view.point);
        let on_source = |direction: &DVec3| view.point + *direction * (height / -view.source.normal.dot(*direction));
        let whole: f64 = pieces.clone().map(|corners| from_directions(corners, view.normal)).sum();
        let most = (2.0 * whole / f64::from(count.max(2)) / OF_MOST).max(ROUNDING);
        self.strata.clear();
        self.corners.clear();
        let mut piece = Vec::new();
        for corners in pieces {
            piece.clear();
            piece.extend(corners.iter().map(on_source));
            self.cut(view, &Facet::of_part(&piece, view.source.normal), most, 0);
        }

        // A pair of rays to each stratum.
        let group = self.start_group();
        let (strata, corners) = (std::mem::take(&mut self.strata), std::mem::take(&mut self.corners));
        for (number, &([first, end], form_factor)) in strata.iter().enumerate() {
            let facet = Facet::of_part(&corners[first..end], view.source.normal);
            let seed = sampling::hash(seed, number as u64);
            for ray in 0..2 {
                self.draw(view, source, &facet, (form_factor, 0.5, group), sampling::hash(seed, ray));
            }
        }
        (self.strata, self.corners) = (strata, corners);
    }

    /// Starts a group of rays that share what they see; gives its number.
    pub fn start_group(&mut self) -> u32 {
        self.seeing.push([0, 0]);
        self.seeing.len() as u32 - 1
    }

    /// Draws a ray to a uniform point of `facet`, a part of a source with this form factor, share and group.
    pub fn draw(
        &mut self,
        view: &View<'_>,
        source: SurfaceId,
        facet: &Facet<'_>,
        (form_factor, share, group): (f64, f64, u32),
        seed: u64,
    ) {
        let y = facet.point_at(sampling::unit(seed), sampling::unit(sampling::hash(seed, streams::SECOND)));
        let (from, to) = (view.point.to_array(), y.to_array());
        self.segments.push(Segment { from, to, from_plane: view.plane, to_plane: view.source_plane });
        let sampled = facet.area * kernel(view.point, view.normal, y, facet.normal);
        self.drawn.push(Drawn { source, form_factor, sampled, share, group });
    }

    fn cut(&mut self, view: &View<'_>, facet: &Facet<'_>, most: f64, splits: u8) {
        let form_factor = point_to_polygon(view.point, view.normal, facet);
        if form_factor <= 0.0 || !facet.radius.is_finite() {
            return;
        }
        let is_small = facet.radius * facet.radius <= SMALL * SMALL * view.point.distance_squared(facet.centroid);
        if splits < MAX_SPLITS && (form_factor > most || !is_small) {
            for_each_piece(facet, |corners| {
                self.cut(view, &Part::new(corners, splits + 1).facet(facet.normal), most, splits + 1);
            });
            return;
        }
        let first = self.corners.len();
        self.corners.extend_from_slice(facet.vertices);
        self.strata.push(([first, self.corners.len()], form_factor));
    }

    /// Casts the rays that were drawn. Calls `add` for each source with the form factor that a pair of rays found, and its two samples,
    /// whose sum that is.
    pub fn cast(&mut self, rays: &Rays<'_>, mut add: impl FnMut([SurfaceId; 2], [f64; 2])) {
        rays.occluded(&self.segments, &mut self.occluded);
        for (drawn, occluded) in self.drawn.iter().zip(&self.occluded) {
            let [rays, seeing] = &mut self.seeing[drawn.group as usize];
            *rays += 1;
            *seeing += u32::from(!occluded);
        }
        for (pair, occluded) in self.drawn.chunks_exact(2).zip(self.occluded.chunks_exact(2)) {
            let sample = |drawn: &Drawn, occluded: bool| {
                let [rays, seeing] = self.seeing[drawn.group as usize];
                let sees = u32::from(!occluded);
                let beta = if rays > 1 { f64::from(seeing - sees) / f64::from(rays - 1) } else { 0.0 };
                drawn.share * (f64::from(sees) * drawn.sampled + beta * (drawn.form_factor - drawn.sampled))
            };
            add([pair[0].source, pair[1].source], [sample(&pair[0], occluded[0]), sample(&pair[1], occluded[1])]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Polygon;

    /// Specks of a source: of their form factor rounding leaves more, less or nothing.
    #[test]
    fn what_is_left_of_nothing_takes_few_rays() {
        let source = Polygon::new(&[[-24.0, 12.0, 26.0], [-15.0, 54.0, 26.0], [-15.0, -9.0, 26.0]]).unwrap();
        let point = DVec3::new(-37.0, 20.0, 8.0) + DVec3::splat(1e-9);
        let view = View { point, normal: DVec3::X, plane: 0, source: source.facet(), source_plane: 1 };
        let mut undecided = UndecidedRays::default();
        for seed in 0..300 {
            let random = |k: u64| sampling::unit(sampling::hash(seed, k));
            let size = 10.0_f64.powf(-8.0 - 6.0 * random(9));
            let corner = |k: u64| {
                let off = size * DVec3::new(random(2 * k), random(2 * k + 1), 0.0);
                (DVec3::new(-18.0, 14.0, 26.0) + off - point).normalize()
            };
            for piece in [[corner(0), corner(1), corner(2)], [corner(0), corner(2), corner(1)]] {
                undecided.restart();
                undecided.draw_to_pieces(&view, SurfaceId(0), std::iter::once(&piece[..]), 25, 1);
                assert!(undecided.drawn.len() < 1000, "seed {seed}: {} rays to {size:e}", undecided.drawn.len());
            }
        }
    }
}
