//! Textures: images as linear colours, and their mean over triangles.

use std::io::Cursor;

use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

/// Larger images are refused: decoded, this many pixels take 256 MiB.
const MOST_PIXELS: u64 = 1 << 26;

/// Images are kept with so many texels at most, each the mean of those that it covers: no face shows more than its own mean.
const MOST_TEXELS: usize = 1 << 18;

/// The edges of a triangle are divided into so many parts for each texel that they cross: parts that hold an edge of a texel are then few.
const PARTS_OF_A_TEXEL: f64 = 4.0;

/// But into no more than this, so that a triangle has its square of parts, each with the colour in its middle.
const MOST_DIVISIONS: f64 = 64.0;

/// An image in linear light.
pub(super) struct Picture {
    width: usize,
    height: usize,
    /// Row after row from the top left, where texture coordinates are 0, 0.
    texels: Vec<[f32; 3]>,
}

/// How a texture goes on outside of its image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Wrap {
    Repeat,
    Mirror,
    Clamp,
}

impl Wrap {
    /// By its number in OpenGL.
    pub fn of(number: u32) -> Self {
        match number {
            33071 => Self::Clamp,
            33648 => Self::Mirror,
            _ => Self::Repeat,
        }
    }

    /// The texel at a coordinate, of `count`.
    fn texel(self, at: f64, count: usize) -> usize {
        let inside = match self {
            Self::Clamp => at.clamp(0.0, 1.0),
            Self::Repeat => at - at.floor(),
            Self::Mirror => 1.0 - (at.rem_euclid(2.0) - 1.0).abs(),
        };
        ((inside * count as f64) as usize).min(count - 1)
    }
}

impl Picture {
    /// Decodes a PNG or JPEG image. The error says what is wrong.
    pub fn decode(bytes: &[u8]) -> Result<Self, String> {
        let (width, height, channels, pixels) = match bytes {
            [0x89, b'P', b'N', b'G', ..] => decode_png(bytes)?,
            [0xff, 0xd8, ..] => decode_jpeg(bytes)?,
            _ => return Err("it is neither PNG nor JPEG".to_owned()),
        };
        if width == 0 || height == 0 || pixels.len() < width * height * channels {
            return Err("it has fewer pixels than it says".to_owned());
        }
        Ok(Self::reduced(width, height, channels, &pixels))
    }

    /// The image in linear light, each texel the mean of a block of pixels.
    fn reduced(width: usize, height: usize, channels: usize, pixels: &[u8]) -> Self {
        let mut block = 1;
        while width.div_ceil(block) * height.div_ceil(block) > MOST_TEXELS {
            block += 1;
        }
        let linear: [f32; 256] = std::array::from_fn(|code| linear(code as u8));
        let colour = |x: usize, y: usize| {
            let pixel = &pixels[(y * width + x) * channels..];
            // Grey images have one channel, or two with opacity.
            std::array::from_fn::<f32, 3, _>(|k| linear[usize::from(pixel[if channels < 3 { 0 } else { k }])])
        };
        let (columns, rows) = (width.div_ceil(block), height.div_ceil(block));
        let mut texels = Vec::with_capacity(columns * rows);
        for (row, column) in (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column))) {
            let (mut sum, mut count) = ([0.0_f32; 3], 0.0);
            for y in (row * block..(row + 1) * block).take_while(|&y| y < height) {
                for x in (column * block..(column + 1) * block).take_while(|&x| x < width) {
                    sum.iter_mut().zip(colour(x, y)).for_each(|(sum, c)| *sum += c);
                    count += 1.0;
                }
            }
            texels.push(sum.map(|sum| sum / count));
        }
        Self { width: columns, height: rows, texels }
    }

    /// The mean over a triangle of texture coordinates: it is divided evenly until parts are small beside a texel, or there are 4096.
    pub fn mean(&self, corners: [[f64; 2]; 3], wrap: [Wrap; 2]) -> [f64; 3] {
        let size = [self.width as f64, self.height as f64];
        let length = |a: [f64; 2], b: [f64; 2]| ((a[0] - b[0]) * size[0]).hypot((a[1] - b[1]) * size[1]);
        let longest = (0..3).map(|k| length(corners[k], corners[(k + 1) % 3])).fold(0.0, f64::max);
        let divisions = (PARTS_OF_A_TEXEL * longest).ceil().clamp(1.0, MOST_DIVISIONS) as usize;

        let mut sum = [0.0; 3];
        let mut add = |u: f64, v: f64| {
            let (u, v) = (u / divisions as f64, v / divisions as f64);
            let at = |k: usize| corners[0][k] + u * (corners[1][k] - corners[0][k]) + v * (corners[2][k] - corners[0][k]);
            let texel = wrap[1].texel(at(1), self.height) * self.width + wrap[0].texel(at(0), self.width);
            sum.iter_mut().zip(self.texels[texel]).for_each(|(sum, c)| *sum += f64::from(c));
        };
        for row in 0..divisions {
            for column in 0..divisions - row {
                let (u, v) = (column as f64, row as f64);
                add(u + 1.0 / 3.0, v + 1.0 / 3.0);
                if column + row + 1 < divisions {
                    add(u + 2.0 / 3.0, v + 2.0 / 3.0);
                }
            }
        }
        sum.map(|sum| sum / (divisions * divisions) as f64)
    }
}

/// Width, height, channels and bytes of pixels.
type Pixels = (usize, usize, usize, Vec<u8>);

fn check_size(width: u64, height: u64) -> Result<(), String> {
    if width.saturating_mul(height) > MOST_PIXELS {
        return Err(format!("it has {width} x {height} pixels, and may have {MOST_PIXELS}; make it smaller"));
    }
    Ok(())
}

fn decode_png(bytes: &[u8]) -> Result<Pixels, String> {
    let wrong = |error: png::DecodingError| format!("its PNG is bad: {error}");
    let mut decoder = png::Decoder::new(Cursor::new(bytes));
    decoder.set_transformations(png::Transformations::normalize_to_color8());
    let header = decoder.read_header_info().map_err(wrong)?;
    check_size(u64::from(header.width), u64::from(header.height))?;
    let mut reader = decoder.read_info().map_err(wrong)?;
    let mut pixels = vec![0; reader.output_buffer_size().ok_or("its PNG is too large")?];
    let frame = reader.next_frame(&mut pixels).map_err(wrong)?;
    Ok((frame.width as usize, frame.height as usize, frame.color_type.samples(), pixels))
}

fn decode_jpeg(bytes: &[u8]) -> Result<Pixels, String> {
    let wrong = |error| format!("its JPEG is bad: {error:?}");
    let options = DecoderOptions::default().jpeg_set_out_colorspace(ColorSpace::RGB);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), options);
    decoder.decode_headers().map_err(wrong)?;
    let info = decoder.info().ok_or("its JPEG has no size")?;
    check_size(u64::from(info.width), u64::from(info.height))?;
    let pixels = decoder.decode().map_err(wrong)?;
    Ok((usize::from(info.width), usize::from(info.height), 3, pixels))
}

/// The linear value of an 8-bit sRGB code (IEC 61966-2-1).
fn linear(code: u8) -> f32 {
    let value = f32::from(code) / 255.0;
    if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Left half black, right half white.
    fn halves() -> Picture {
        Picture { width: 2, height: 1, texels: vec![[0.0; 3], [1.0; 3]] }
    }

    #[test]
    fn means_are_those_of_the_areas() {
        let repeat = [Wrap::Repeat; 2];
        // The half of the image below a diagonal: a quarter of it lies right of the middle.
        let mean = halves().mean([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], repeat);
        assert!((mean[0] - 0.25).abs() < 0.02, "{mean:?}");
        let fine = Picture { width: 128, height: 1, texels: (0..128).map(|x| [if x < 64 { 0.0 } else { 1.0 }; 3]).collect() };
        let finely = fine.mean([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], repeat);
        assert!((finely[0] - 0.25).abs() < 0.005, "{finely:?}");
        assert_eq!(halves().mean([[0.1, 0.1], [0.2, 0.1], [0.1, 0.2]], repeat), [0.0; 3]);
    }

    #[test]
    fn textures_go_on_as_they_should() {
        for (wrap, expected) in [(Wrap::Repeat, [1, 0, 1]), (Wrap::Mirror, [0, 1, 0]), (Wrap::Clamp, [0, 1, 1])] {
            assert_eq!([-0.25, 1.25, 1.75].map(|at| wrap.texel(at, 2)), expected, "{wrap:?}");
        }
        assert_eq!(Wrap::Repeat.texel(f64::NAN, 2), 0);
    }

    #[test]
    fn large_images_keep_their_mean() {
        let (width, height) = (3000, 1000);
        let pixels: Vec<u8> = (0..width * height).map(|k| if k % width < width / 3 { 255 } else { 0 }).collect();
        let reduced = Picture::reduced(width, height, 1, &pixels);
        assert!(reduced.texels.len() <= MOST_TEXELS);
        let mean = reduced.texels.iter().map(|texel| f64::from(texel[0])).sum::<f64>() / reduced.texels.len() as f64;
        assert!((mean - 1.0 / 3.0).abs() < 1e-6, "{mean}");
    }
}
