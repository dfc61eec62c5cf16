//! Radiance pictures (`.hdr`): a common exponent for three mantissas of 8 bits, so values are within half a percent of the largest channel (G. Ward, Real pixels, in
//! Graphics Gems II, 1991). Scan lines are run-length encoded, as Radiance has done since version 2 (`src/common/color.c`).

use std::io::{self, Write};

use super::{Provenance, Quantity};
use crate::picture::Image;

/// Widths of scan lines that can be run-length encoded.
const ENCODED_WIDTHS: std::ops::Range<u32> = 8..0x8000;

/// From this length on a run is shorter than what it stands for.
const SHORTEST_RUN: usize = 4;

/// The longest run, and the longest row of bytes that are no run.
const LONGEST: (usize, usize) = (127, 128);

/// Writes an image of one or three channels: a picture of linear light, or of another quantity. Lines of the header state software, quantity, unit and options.
///
/// # Errors
/// What the writer says, and [`io::ErrorKind::InvalidInput`] for an image that is not [well formed](Image::is_well_formed) or has other channels.
pub fn write_hdr(writer: &mut impl Write, image: &Image, quantity: Quantity, provenance: &Provenance) -> io::Result<()> {
    if !image.is_well_formed() || !matches!(image.channels, 1 | 3) {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "a .hdr picture has one or three channels; write .exr for others"));
    }
    writeln!(writer, "#?RADIANCE")?;
    for (key, text) in provenance.statements(quantity) {
        writeln!(writer, "{}={text}", key.to_uppercase())?;
    }
    write!(writer, "FORMAT=32-bit_rle_rgbe\n\n-Y {} +X {}\n", image.height, image.width)?;

    let scale = quantity.per_radiance();
    let pixels: Vec<[u8; 4]> =
        image.pixels().map(|pixel| rgbe(std::array::from_fn(|k| scale * pixel[k % image.channels]))).collect();
    for line in pixels.chunks_exact(image.width as usize) {
        if ENCODED_WIDTHS.contains(&image.width) {
            write_encoded(writer, line)?;
        } else {
            writer.write_all(line.as_flattened())?;
        }
    }
    Ok(())
}

/// Mantissas and exponent of a colour: each channel is (mantissa + 1/2) 2^(exponent - 136). Negative values are 0.
fn rgbe(colour: [f32; 3]) -> [u8; 4] {
    let largest = colour.into_iter().fold(0.0, f32::max);
    if largest < 1e-32 {
        return [0; 4];
    }
    let (_, exponent) = libm::frexpf(largest.min(1.7e38));
    let scale = libm::ldexpf(1.0, 8 - exponent);
    let [r, g, b] = colour.map(|value| (value.max(0.0) * scale) as u8);
    [r, g, b, (exponent + 128) as u8]
}

/// A scan line: its four planes one after the other, each as runs and rows of bytes.
fn write_encoded(writer: &mut impl Write, line: &[[u8; 4]]) -> io::Result<()> {
    let mut code = vec![2, 2, (line.len() >> 8) as u8, line.len() as u8];
    for plane in 0..4 {
        let bytes: Vec<u8> = line.iter().map(|pixel| pixel[plane]).collect();
        let mut rest = bytes.as_slice();
        while !rest.is_empty() {
            let run = run_at(rest);
            if run >= SHORTEST_RUN {
                code.extend([128 + run as u8, rest[0]]);
                rest = &rest[run..];
                continue;
            }
            let most = rest.len().min(LONGEST.1);
            let row = (1..most).find(|&k| run_at(&rest[k..]) >= SHORTEST_RUN).unwrap_or(most);
            code.push(row as u8);
            code.extend_from_slice(&rest[..row]);
            rest = &rest[row..];
        }
    }
    writer.write_all(&code)
}

/// How many bytes at the start are the same.
fn run_at(bytes: &[u8]) -> usize {
    bytes.iter().take(LONGEST.0).take_while(|&&byte| byte == bytes[0]).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_kept_to_a_part_of_the_largest_channel() {
        assert_eq!(rgbe([0.0, -1.0, 0.0]), [0; 4]);
        assert_eq!(rgbe([1.0, 0.5, 0.25]), [128, 64, 32, 129]);
        for exponent in -60..60 {
            let colour = [0.7, 0.3, 0.001].map(|x: f32| libm::ldexpf(x, exponent));
            let [r, g, b, e] = rgbe(colour);
            for (mantissa, value) in [r, g, b].into_iter().zip(colour) {
                let read = libm::ldexpf(f32::from(mantissa) + 0.5, i32::from(e) - 136);
                assert!((read - value).abs() <= colour[0] / 128.0, "{read} {value}");
            }
        }
    }
}
