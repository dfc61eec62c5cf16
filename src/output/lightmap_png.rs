//! Pages of a lightmap in 8 bits, which programs turn back into light.
//!
//! sRGB: `encode(min(x 2^EV, 1))`, by the transfer function of IEC 61966-2-1, without a tone curve. RGBM: `x = RGB * A * range`, all of them linear,
//! A as small as the largest channel allows, so that dark light keeps its digits.

use std::io::{self, Write};

use super::srgb::encode_srgb;
use super::{Provenance, Quantity};
use crate::picture::{Image, luminance};

/// How light becomes 8 bits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightmapCode {
    /// sRGB with this exposure value.
    Srgb {
        /// The numbers of the image, radiances or irradiances over pi, are multiplied by `2^EV`.
        ev: f64,
    },
    /// RGBM with this range, in the unit of the quantity.
    Rgbm {
        /// The largest number that there is.
        range: f64,
    },
}

/// Writes a page as PNG. Text chunks state software, quantity, unit, options and how numbers are turned back.
///
/// # Errors
/// What the writer says, and [`io::ErrorKind::InvalidInput`] for an image that is not [well formed](Image::is_well_formed).
pub fn write_lightmap_png(
    writer: impl Write,
    image: &Image,
    (quantity, code): (Quantity, LightmapCode),
    provenance: &Provenance,
) -> io::Result<()> {
    if !image.is_well_formed() {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "the image has more or fewer values than pixels and channels"));
    }
    let (bytes, colours, told): (Vec<u8>, _, _) = match code {
        LightmapCode::Srgb { ev } => {
            let scale = libm::exp2(ev) as f32;
            let bytes = image.pixels().flat_map(|pixel| rgb(pixel).map(|x| encode_srgb((x * scale).min(1.0)))).collect();
            (bytes, ::png::ColorType::Rgb, ("Exposure", format!("sRGB of min(x 2^EV, 1), EV {ev:.4}, x in W/m^2/sr")))
        }
        LightmapCode::Rgbm { range } => {
            let scale = f64::from(quantity.per_radiance()) / range.max(f64::MIN_POSITIVE);
            let bytes = image.pixels().flat_map(|pixel| rgbm(rgb(pixel).map(|x| f64::from(x) * scale))).collect();
            (bytes, ::png::ColorType::Rgba, ("Range", format!("{range:.9e} {}: x = RGB * A * range, linear", quantity.unit())))
        }
    };

    let into_io = |error| match error {
        ::png::EncodingError::IoError(error) => error,
        other => io::Error::other(other),
    };
    let mut encoder = ::png::Encoder::new(writer, image.width, image.height);
    encoder.set_color(colours);
    encoder.set_depth(::png::BitDepth::Eight);
    if let LightmapCode::Srgb { .. } = code {
        encoder.set_source_srgb(::png::SrgbRenderingIntent::RelativeColorimetric);
    }
    for (key, text) in provenance.statements(quantity).into_iter().map(|(key, text)| (key[..1].to_uppercase() + &key[1..], text)) {
        encoder.add_text_chunk(key, text).map_err(into_io)?;
    }
    encoder.add_text_chunk(told.0.to_owned(), told.1).map_err(into_io)?;
    let mut writer = encoder.write_header().map_err(into_io)?;
    writer.write_image_data(&bytes).and_then(|()| writer.finish()).map_err(into_io)
}

/// Three channels as they are, others by their luminance or mean.
fn rgb(pixel: &[f32]) -> [f32; 3] {
    <[f32; 3]>::try_from(pixel).unwrap_or([luminance(pixel); 3])
}

/// Mantissas and a common factor of a colour in [0, 1]: the least of 255 that holds its largest channel.
fn rgbm(colour: [f64; 3]) -> [u8; 4] {
    let largest = colour.into_iter().fold(0.0, f64::max).min(1.0);
    let factor = (255.0 * largest).ceil().max(1.0);
    let [r, g, b] = colour.map(|x| (255.0 * 255.0 * x.max(0.0) / factor).round().min(255.0) as u8);
    [r, g, b, factor as u8]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dark_colours_keep_their_digits_in_rgbm() {
        for exponent in 0..8 {
            let colour = [0.9, 0.37, 0.1].map(|x| x * 0.5_f64.powi(exponent));
            let [r, g, b, m] = rgbm(colour).map(|byte| f64::from(byte) / 255.0);
            let largest_step = m / 255.0;
            for (told, x) in [r, g, b].into_iter().zip(colour) {
                assert!((told * m - x).abs() <= 0.5 * largest_step + 1e-12, "{} {x}", told * m);
            }
            assert!(m <= colour[0] + 1.0 / 255.0);
        }
        assert_eq!(rgbm([0.0; 3]), [0, 0, 0, 1]);
        assert_eq!(rgbm([1.0; 3]), [255; 4]);
    }
}
