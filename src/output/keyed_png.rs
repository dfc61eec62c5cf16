//! A picture in colours with a key that says in words what they mean, as PNG.

use std::io::{self, Write};

use super::glyphs::{ADVANCE, HEIGHT, for_each_pixel};
use super::png::into_io;

/// Letters grow with the picture: a pixel of theirs is one pixel in pictures up to twice this high.
const HEIGHT_OF_UNIT: usize = 360;

/// All in pixels of letters.
const MARGIN: usize = 4;
const SWATCH: usize = 9;
const LINE: usize = HEIGHT + 4;

const DARK: [u8; 3] = [24, 24, 24];
const LIGHT: [u8; 3] = [236, 236, 236];

/// A line of a key.
#[derive(Clone, Debug, PartialEq)]
pub struct KeyLine {
    /// The colour that it explains, in 8-bit sRGB, if it explains one.
    pub colour: Option<[u8; 3]>,
    /// What it means: small letters and digits are drawn, all of it is a text of the file.
    pub text: String,
}

/// Writes pixels of 8-bit sRGB, row after row from the top left, and a key on their right, by which the file is wider; lines for which it is not high
/// enough are cut off. All lines stand in the file as the text `Description`, too.
///
/// # Errors
/// What the writer says, and [`io::ErrorKind::InvalidInput`] for more or fewer pixels than the size has.
pub fn write_keyed_png(writer: impl Write, [width, height]: [u32; 2], pixels: &[[u8; 3]], key: &[KeyLine]) -> io::Result<()> {
    if pixels.is_empty() || pixels.len() as u64 != u64::from(width) * u64::from(height) {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "there are more or fewer pixels than width and height say"));
    }
    let key_pixels = drawn(key, height as usize);
    let key_width = key_pixels.len() / height as usize;
    let rows = pixels.chunks(width as usize).zip(key_pixels.chunks(key_width));
    let bytes: Vec<u8> = rows.flat_map(|(pixels, key)| [pixels, key].concat()).flatten().collect();

    let mut encoder = ::png::Encoder::new(writer, width + key_width as u32, height);
    encoder.set_color(::png::ColorType::Rgb);
    encoder.set_depth(::png::BitDepth::Eight);
    encoder.set_source_srgb(::png::SrgbRenderingIntent::Perceptual);
    let lines: Vec<&str> = key.iter().map(|line| line.text.as_str()).collect();
    encoder.add_text_chunk("Software".to_owned(), concat!("patchlight ", env!("CARGO_PKG_VERSION")).to_owned()).map_err(into_io)?;
    encoder.add_text_chunk("Description".to_owned(), lines.join("\n")).map_err(into_io)?;
    let mut writer = encoder.write_header().map_err(into_io)?;
    writer.write_image_data(&bytes).and_then(|()| writer.finish()).map_err(into_io)
}

/// The pixels of a key of this height.
fn drawn(key: &[KeyLine], height: usize) -> Vec<[u8; 3]> {
    let longest = key.iter().map(|line| line.text.chars().count()).max().unwrap_or(0);
    let grain = (height / HEIGHT_OF_UNIT).max(1);
    let width = grain * (3 * MARGIN + SWATCH + longest * ADVANCE);
    let mut pixels = vec![DARK; width * height];
    let mut paint = |[x, y]: [usize; 2], size: usize, colour: [u8; 3]| {
        for row in (grain * y).min(height)..(grain * (y + size)).min(height) {
            pixels[row * width + grain * x..][..grain * size].fill(colour);
        }
    };
    for (number, line) in key.iter().enumerate() {
        let top = MARGIN + number * LINE;
        if let Some(colour) = line.colour {
            paint([MARGIN, top - 1], SWATCH, colour);
        }
        let left = if line.colour.is_some() { 2 * MARGIN + SWATCH } else { MARGIN };
        for_each_pixel(&line.text, |column, row| paint([left + column, top + row], 1, LIGHT));
    }
    pixels
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(size: [u32; 2], key: &[KeyLine]) -> (Vec<u8>, Vec<u8>) {
        let mut file = Vec::new();
        write_keyed_png(&mut file, size, &vec![[9; 3]; (size[0] * size[1]) as usize], key).unwrap();
        let mut reader = ::png::Decoder::new(io::Cursor::new(&file)).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut pixels).unwrap();
        (file, pixels)
    }

    #[test]
    fn a_key_has_its_colours_and_words_beside_the_picture() {
        let key = [("3 faces dropped", Some([1, 2, 3])), ("nothing else", None)];
        let key = key.map(|(text, colour)| KeyLine { colour, text: text.to_owned() });
        let (file, pixels) = written([30, 200], &key);
        let width = pixels.len() / 3 / 200;
        let at = |x: usize, y: usize| &pixels[3 * (width * y + x)..][..3];
        assert_eq!((at(29, 0), at(30, 0), at(30 + MARGIN, MARGIN)), (&[9; 3][..], &DARK[..], &[1, 2, 3][..]));
        assert!(pixels.chunks(3).filter(|pixel| *pixel == LIGHT).count() > 100);
        assert!(String::from_utf8_lossy(&file).contains("3 faces dropped\nnothing else"));

        // Low pictures have the lines that there is room for.
        assert!(written([7, 5], &key).1.len() > 3 * 7 * 5);
        assert!(write_keyed_png(&mut Vec::new(), [2, 2], &[[0; 3]; 3], &key).is_err());
    }
}
