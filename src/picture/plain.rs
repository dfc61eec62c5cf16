//! A scene in plain shades, whatever its light: grey by the angle to the eye, and surfaces in colours of their own.
//!
//! Backs of one-sided surfaces are bluish. What of the coloured surfaces lies behind others may show through these as stripes; places are marked
//! with crosses or dots, whatever stands before them. Cost: a ray, or with stripes two, for each of [`SUBSAMPLES`] samples of a pixel.

use glam::DVec3;
use rayon::prelude::*;

use super::camera::{Camera, CameraError, CameraRays};
use crate::scene::{Scene, SurfaceId};
use crate::visibility::{Hit, Ray, Visibility};

/// Samples of a pixel.
const SUBSAMPLES: u32 = 4;

const NOTHING: [u8; 3] = [28, 30, 34];
const FRONT: [u8; 3] = [228, 228, 226];
const DARK: [u8; 3] = [20, 20, 20];

/// Backs of one-sided surfaces, in 8-bit sRGB where the eye looks at them straight.
pub const BACK_COLOUR: [u8; 3] = [112, 122, 158];

/// How bright a surface is that is seen from the side, beside one that is seen straight.
const GRAZING: f64 = 0.42;

/// Stripes are so many units of letters wide, and as far apart as [`PERIOD`] says.
const STRIPE: u32 = 2;
const PERIOD: u32 = 7;

/// How much of a stripe is its own colour.
const STRIPE_SHARE: f64 = 0.8;

/// What is shown.
pub struct PlainView<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// Of all of it.
    pub visibility: &'a dyn Visibility,
    /// By surface, its colour in 8-bit sRGB, if it has one.
    pub colours: &'a [Option<[u8; 3]>],
    /// Of those surfaces alone that are seen through others.
    pub through: Option<&'a dyn Visibility>,
    /// Places that are marked.
    pub places: &'a [PlainMark],
}

/// A marked place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlainMark {
    /// Where, in metres.
    pub place: [f64; 3],
    /// In 8-bit sRGB.
    pub colour: [u8; 3],
    /// A cross instead of a dot.
    pub is_cross: bool,
}

/// The picture.
#[derive(Clone, Debug, PartialEq)]
pub struct PlainPicture {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Row after row from the top left, in 8-bit sRGB.
    pub pixels: Vec<[u8; 3]>,
    /// Whether a back is seen.
    pub shows_backs: bool,
    /// Whether stripes are seen.
    pub shows_stripes: bool,
}

/// What is seen at a sample.
#[derive(Clone, Copy)]
struct Seen {
    colour: [f64; 3],
    is_back: bool,
    /// The colour of what shows through.
    behind: Option<[u8; 3]>,
}

impl PlainView<'_> {
    /// Takes the picture.
    ///
    /// # Errors
    /// What [`Camera::validate`] says of the camera.
    pub fn take(&self, camera: &Camera) -> Result<PlainPicture, CameraError> {
        let (through, size) = (camera.rays()?, [camera.width, camera.height]);
        // As wide as letters of a legend, so that stripes are seen in large pictures too.
        let unit = (camera.height / 360).max(1);
        let rows: Vec<(Vec<[u8; 3]>, [bool; 2])> =
            (0..camera.height).into_par_iter().map(|row| self.row((&through, camera.width), row, unit)).collect();
        let any = |k: usize| rows.iter().any(|(_, shown)| shown[k]);
        let (shows_backs, shows_stripes) = (any(0), any(1));
        let mut picture =
            PlainPicture { size, pixels: rows.into_iter().flat_map(|(pixels, _)| pixels).collect(), shows_backs, shows_stripes };
        self.places.iter().for_each(|mark| picture.mark(mark, &through, unit));
        Ok(picture)
    }

    /// A row of pixels; whether it shows backs and stripes.
    fn row(&self, (camera, width): (&CameraRays, u32), row: u32, unit: u32) -> (Vec<[u8; 3]>, [bool; 2]) {
        let of_pixel = |column| (0..SUBSAMPLES).map(move |sample| camera.through_pixel(column, row, sample, SUBSAMPLES));
        let rays: Vec<Ray> = (0..width).flat_map(of_pixel).collect();
        let [mut hits, mut behind] = [vec![None; rays.len()], vec![None; rays.len()]];
        self.visibility.first_hits(&rays, &mut hits);
        if let Some(through) = self.through {
            through.first_hits(&rays, &mut behind);
        }

        let mut shows = [false; 2];
        let seen = rays.iter().zip(hits.iter().zip(&behind)).map(|(ray, (hit, behind))| self.seen(ray, hit, behind));
        let seen: Vec<Seen> = seen.collect();
        let pixels = (0..width).zip(seen.chunks(SUBSAMPLES as usize)).map(|(column, samples)| {
            let is_striped = (column + row) / unit % PERIOD < STRIPE;
            let mut sum = [0.0; 3];
            for Seen { colour, is_back, behind } in samples {
                shows[0] |= is_back;
                shows[1] |= behind.is_some();
                let stripe = behind.filter(|_| is_striped).map_or(*colour, |behind| mixed(*colour, behind));
                sum.iter_mut().zip(stripe).for_each(|(sum, value)| *sum += value / f64::from(SUBSAMPLES));
            }
            sum.map(|value| value.round() as u8)
        });
        (pixels.collect(), shows)
    }

    fn seen(&self, ray: &Ray, hit: &Option<Hit>, behind: &Option<Hit>) -> Seen {
        let Some(hit) = hit else {
            let behind = behind.as_ref().and_then(|hit| self.colour_of(hit.surface));
            return Seen { colour: NOTHING.map(f64::from), is_back: false, behind };
        };
        let direction = DVec3::from(ray.direction);
        let along = self.scene.surface(SurfaceId(hit.surface)).polygon.facet().normal.dot(direction);
        let is_back = along > 0.0 && self.scene.surface(SurfaceId(hit.surface)).twin().is_none();
        let own = self.colour_of(hit.surface);
        let shade = GRAZING + (1.0 - GRAZING) * along.abs();
        let plain = own.unwrap_or(if is_back { BACK_COLOUR } else { FRONT });
        let behind = behind.as_ref().filter(|_| own.is_none()).and_then(|hit| self.colour_of(hit.surface));
        Seen { colour: plain.map(|value| shade * f64::from(value)), is_back: is_back && own.is_none(), behind }
    }

    /// The colour of a surface or of the other side of its sheet.
    fn colour_of(&self, surface: u32) -> Option<[u8; 3]> {
        let twin = || self.scene.surface(SurfaceId(surface)).twin();
        self.colours[surface as usize].or_else(|| self.colours[twin()?.index()])
    }
}

/// A colour with that of a stripe over it.
fn mixed(colour: [f64; 3], stripe: [u8; 3]) -> [f64; 3] {
    std::array::from_fn(|k| colour[k] + STRIPE_SHARE * (f64::from(stripe[k]) - colour[k]))
}

impl PlainPicture {
    /// Draws a mark with a dark rim, so that it is seen on everything.
    fn mark(&mut self, mark: &PlainMark, camera: &CameraRays, unit: u32) {
        let place = DVec3::from(mark.place);
        if camera.depth(place) <= 0.0 {
            return;
        }
        let (x, y) = camera.position(place);
        let [width, height] = self.size.map(i64::from);
        let reach = i64::from(unit) * if mark.is_cross { 4 } else { 1 };
        let is_arm = |dx: i64, dy: i64, wide: i64| !mark.is_cross || (dx.abs() - dy.abs()).abs() < wide;
        let rim = i64::from(unit);
        for (reach, wide, colour) in [(reach + rim, 3 * rim, DARK), (reach, rim, mark.colour)] {
            for (dx, dy) in (-reach..=reach).flat_map(|dy| (-reach..=reach).map(move |dx| (dx, dy))) {
                let (column, row) = (x.floor() as i64 + dx, y.floor() as i64 + dy);
                if is_arm(dx, dy, wide) && (0..width).contains(&column) && (0..height).contains(&row) {
                    self.pixels[(row * width + column) as usize] = colour;
                }
            }
        }
    }
}
