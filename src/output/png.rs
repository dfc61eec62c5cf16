//! Pictures for display: 8-bit sRGB, exposed and tone-mapped.
//!
//! A pixel's radiance is multiplied by `2^EV`, compressed by a tone curve, and encoded with the sRGB transfer function (IEC
//! 61966-2-1).
//!
//! The tone curve leaves values up to [`SHOULDER`] as they are, so that most of the picture stays true to the radiances, and bends
//! what is brighter towards 1 (white) without ever reaching it:
//!
//! ```text
//! f(x) = x                                x <= s
//! f(x) = 1 - (1-s)^2 / (x + 1 - 2 s)      x >  s       value and slope continuous at s
//! ```
//!
//! It is applied to the largest channel of a pixel, and the others keep their ratio to it, so that colours keep their hue; very
//! bright pixels then fade towards white, as on film, instead of becoming flat patches of saturated colour.
//!
//! Or pixels show a quantity in false colours (`false_colours`), with a legend (`legend`).

use std::io::{self, Write};

use super::false_colours::Scale;
use super::legend::{self, LEAST_SIZE_WITH_LEGEND};
use super::srgb::encode_srgb;
use super::{Provenance, Quantity};
use crate::picture::{Image, Marks, luminance};

/// Where the tone curve leaves the straight line, in linear light.
pub const SHOULDER: f32 = 0.5;

/// How fast bright colours fade to white: at `x` the curve has taken `x - f(x)` away, and the colour keeps
/// `1 / (1 + FADE (x - f(x)))`.
const FADE: f32 = 0.15;

/// The linear value that the average of a picture (geometric mean of the luminances) is exposed to: lighter than the 18% of a
/// photographer's grey card, since rooms have white walls and the tone curve keeps emitters below white.
pub(super) const KEY: f64 = 0.22;

/// How bright a PNG picture is made.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum PngExposure {
    /// As [`auto_exposure`] finds.
    #[default]
    Auto,
    /// Fixed: radiances are multiplied by `2^EV`, so at 0 a radiance of 1 W/m^2/sr is the display's white before the tone curve.
    Ev(f64),
}

/// The exposure value that brings the geometric mean of the pixels' luminances to 0.22; 0 for a black picture.
///
/// Black pixels, such as those in which nothing is hit, do not count; emitters count like everything else.
pub fn auto_exposure(image: &Image) -> f64 {
    let (mut sum, mut count) = (0.0, 0_u64);
    for luminance in image.pixels().map(|pixel| f64::from(luminance(pixel))).filter(|y| y.is_normal() && *y > 0.0) {
        sum += luminance.log2();
        count += 1;
    }
    if count == 0 { 0.0 } else { KEY.log2() - sum / count as f64 }
}

/// How the numbers of a picture become colours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Look {
    /// As light: exposed and tone-mapped.
    Light(PngExposure),
    /// As false colours on a scale of the quantity: of its luminance by Rec. 709 if there are three channels, else of their mean. With a legend.
    Scale(Scale),
}

/// A picture to look at.
#[derive(Clone, Debug)]
pub struct Display<'a> {
    /// What its numbers are.
    pub image: &'a Image,
    /// What they stand for; as light it is [`Quantity::Radiance`].
    pub quantity: Quantity,
    /// How they are shown.
    pub look: Look,
    /// Lines over the picture.
    pub marks: Option<&'a Marks>,
}

/// Writes `image` as PNG, as light: see [`write_display`].
///
/// # Errors
/// As [`write_display`].
pub fn write_png(writer: impl Write, image: &Image, exposure: PngExposure, provenance: &Provenance) -> io::Result<f64> {
    let display = Display { image, quantity: Quantity::Radiance, look: Look::Light(exposure), marks: None };
    Ok(write_display(writer, &display, provenance)?.unwrap_or(0.0))
}

/// Writes a picture as PNG: as light grey for one channel, sRGB for three, else grey from the mean of the channels; in colour where there are marks or
/// false colours. Text chunks state software, quantity, unit, options and exposure or scale. Returns the exposure value that was used.
///
/// # Errors
/// What the writer says, and [`io::ErrorKind::InvalidInput`] for an image that is not [well formed](Image::is_well_formed), or too small for a
/// legend ([`LEAST_SIZE_WITH_LEGEND`]).
pub fn write_display(writer: impl Write, display: &Display<'_>, provenance: &Provenance) -> io::Result<Option<f64>> {
    let Display { image, quantity, .. } = *display;
    let invalid = |text| io::Error::new(io::ErrorKind::InvalidInput, text);
    if !image.is_well_formed() {
        return Err(invalid("the image has more or fewer values than pixels and channels"));
    }
    if matches!(display.look, Look::Scale(_))
        && (image.width < LEAST_SIZE_WITH_LEGEND[0] || image.height < LEAST_SIZE_WITH_LEGEND[1])
    {
        return Err(invalid("the image is too small for a legend"));
    }
    let (bytes, ev) = display.colours();
    let coloured = bytes.len() > image.width as usize * image.height as usize;

    let title = |key: &str| key[..1].to_uppercase() + &key[1..];
    let mut texts: Vec<(String, String)> =
        provenance.statements(quantity).into_iter().map(|(key, text)| (title(key), text)).collect();
    let (key, text) = match (display.look, ev) {
        (Look::Scale(scale), _) => ("Scale", format!("{}..{} {}, a helix in Oklab", scale.low(), scale.high(), quantity.unit())),
        (_, ev) => ("Exposure", format!("EV {:.4}: radiance times 2^EV, shoulder above {SHOULDER}, sRGB", ev.unwrap_or(0.0))),
    };
    texts.push((key.to_owned(), text));
    let colour = if coloured { ::png::ColorType::Rgb } else { ::png::ColorType::Grayscale };
    write_pixels(writer, [image.width, image.height], (colour, &bytes), texts)?;
    Ok(ev)
}

/// Writes 8-bit sRGB or grey pixels as PNG, with texts by their keys.
pub(super) fn write_pixels(
    writer: impl Write,
    [width, height]: [u32; 2],
    (colour, bytes): (::png::ColorType, &[u8]),
    texts: Vec<(String, String)>,
) -> io::Result<()> {
    let mut encoder = ::png::Encoder::new(writer, width, height);
    encoder.set_compression(::png::Compression::Fast);
    encoder.set_color(colour);
    encoder.set_depth(::png::BitDepth::Eight);
    encoder.set_source_srgb(::png::SrgbRenderingIntent::Perceptual);
    for (key, text) in texts {
        encoder.add_text_chunk(key, text).map_err(into_io)?;
    }
    let mut writer = encoder.write_header().map_err(into_io)?;
    writer.write_image_data(bytes).and_then(|()| writer.finish()).map_err(into_io)
}

impl Display<'_> {
    /// The bytes of all pixels, grey or RGB, and the exposure value of light.
    fn colours(&self) -> (Vec<u8>, Option<f64>) {
        let Self { image, quantity, look, marks } = *self;
        let unmarked = marks.is_none();
        let (mut bytes, ev): (Vec<u8>, _) = match look {
            Look::Scale(scale) => {
                let value = |pixel: &[f32]| f64::from(luminance(pixel) * quantity.per_radiance());
                (image.pixels().flat_map(|pixel| scale.colour(value(pixel))).collect(), None)
            }
            Look::Light(exposure) => {
                let ev = match exposure {
                    PngExposure::Auto => auto_exposure(image),
                    PngExposure::Ev(ev) => ev,
                };
                let factor = ev.exp2() as f32;
                let grey = |pixel: &[f32]| encode_srgb(tone_map([luminance(pixel) * factor; 3])[0]);
                let bytes = match image.channels {
                    3 => image
                        .pixels()
                        .flat_map(|p| tone_map([p[0] * factor, p[1] * factor, p[2] * factor]).map(encode_srgb))
                        .collect(),
                    _ if unmarked => image.pixels().map(grey).collect(),
                    _ => image.pixels().flat_map(|pixel| [grey(pixel); 3]).collect(),
                };
                (bytes, Some(ev))
            }
        };
        for (pixel, colour) in marks.into_iter().flat_map(Marks::pixels) {
            bytes[3 * pixel..][..3].copy_from_slice(&colour);
        }
        if let Look::Scale(scale) = look {
            legend::draw(&mut bytes, [image.width as usize, image.height as usize], &scale, quantity.unit());
        }
        (bytes, ev)
    }
}

pub(super) fn into_io(error: ::png::EncodingError) -> io::Error {
    match error {
        ::png::EncodingError::IoError(error) => error,
        other => io::Error::other(other),
    }
}

/// The tone curve; 0 for what is not a number.
fn tone_map(colour: [f32; 3]) -> [f32; 3] {
    let colour = colour.map(|c| if c > 0.0 { c.min(1e6) } else { 0.0 });
    let peak = colour.into_iter().fold(0.0, f32::max);
    if peak <= SHOULDER {
        return colour;
    }
    let bent = 1.0 - (1.0 - SHOULDER).powi(2) / (peak + 1.0 - 2.0 * SHOULDER);
    let kept = 1.0 / (1.0 + FADE * (peak - bent));
    colour.map(|c| bent + (c / peak * bent - bent) * kept)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_is_straight_then_bends_smoothly_and_stays_below_white() {
        let f = |x: f32| tone_map([x; 3])[0];
        assert_eq!((f(0.0), f(0.25), f(SHOULDER)), (0.0, 0.25, SHOULDER));
        let slope = (f(SHOULDER + 1e-3) - f(SHOULDER)) / 1e-3;
        assert!((slope - 1.0).abs() < 0.01, "{slope}");
        let mut previous = 0.0;
        for x in (0..4000).map(|k| k as f32 * 0.005) {
            assert!(f(x) >= previous && f(x) < 1.0);
            previous = f(x);
        }
        assert_eq!((f(f32::NAN), f(-1.0)), (0.0, 0.0));
        assert!(f(f32::INFINITY) <= 1.0);
    }

    #[test]
    fn bright_colours_keep_their_order_and_fade_to_white() {
        let [r, g, b] = tone_map([4.0, 2.0, 1.0]);
        assert!(r > g && g > b && r < 1.0);
        let [r, _, b] = tone_map([4000.0, 2000.0, 1000.0]);
        assert!(r - b < 0.01, "{r} {b}");
    }

    #[test]
    fn auto_exposure_brings_a_flat_picture_to_the_key() {
        for radiance in [1e-6, 1.0, 37.0, 1e6] {
            let image = Image { radiance: vec![radiance; 48], ..Image::black(4, 4, 3) };
            let exposed = f64::from(radiance) * auto_exposure(&image).exp2();
            assert!((exposed - KEY).abs() < 1e-5, "{exposed}");
        }
        assert_eq!(auto_exposure(&Image::black(4, 4, 3)), 0.0);
    }
}
