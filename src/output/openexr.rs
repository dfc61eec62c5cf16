//! OpenEXR images through the C++ library (feature `openexr`): the same pixels and attributes as [`write_exr`](super::write_exr).
//!
//! The library writes to a path only, so the file is made in the temporary directory and copied from there.
#![allow(unsafe_code, reason = "the crate's call that writes pixels is unsafe")]

use std::io::{self, Seek, Write};

use ::openexr::core::attribute::CppStringAttribute;
use ::openexr::core::header::Header;
use ::openexr::prelude::{CHANNEL_FLOAT, Compression, Frame, FrameBuffer, OutputFile};

use super::exr::{comments, first_of, named_channels};
use super::{Provenance, Quantity};
use crate::picture::Image;

/// Writes `image` as OpenEXR: 32-bit float, ZIP-compressed scan lines.
///
/// # Errors
/// What the library or the writer says, and [`io::ErrorKind::InvalidInput`] for an image that is not [well formed](Image::is_well_formed)
/// or has more than 2^31 - 1 pixels on a side.
pub fn write_openexr(
    writer: &mut (impl Write + Seek),
    image: &Image,
    quantity: Quantity,
    provenance: &Provenance,
) -> io::Result<()> {
    write_openexr_layers(writer, &[("", image)], quantity, provenance)
}

/// The same of images of one size, as [`write_exr_layers`](super::write_exr_layers).
///
/// # Errors
/// As [`write_openexr`], and [`io::ErrorKind::InvalidInput`] if sizes differ or there is no image.
pub fn write_openexr_layers(
    writer: &mut (impl Write + Seek),
    layers: &[(&str, &Image)],
    quantity: Quantity,
    provenance: &Provenance,
) -> io::Result<()> {
    let image = first_of(layers)?;
    let invalid = |text| io::Error::new(io::ErrorKind::InvalidInput, text);
    let (Ok(width), Ok(height)) = (i32::try_from(image.width), i32::try_from(image.height)) else {
        return Err(invalid("the image is too large"));
    };
    let temporary = tempfile::Builder::new().prefix("patchlight-").suffix(".exr").tempfile()?;
    // The crate panics on paths that are not UTF-8.
    if temporary.path().to_str().is_none() {
        return Err(invalid("the path of the temporary directory is not UTF-8"));
    }
    write_file(temporary.path(), layers, [width, height], quantity, provenance).map_err(io::Error::other)?;
    io::copy(&mut std::fs::File::open(temporary.path())?, writer).map(drop)
}

fn write_file(
    path: &std::path::Path,
    layers: &[(&str, &Image)],
    [width, height]: [i32; 2],
    quantity: Quantity,
    provenance: &Provenance,
) -> Result<(), ::openexr::Error> {
    // What is in the file.
    let mut header = Header::from_dimensions(width, height);
    header.set_compression(Compression::Zip);
    header.insert("software", &CppStringAttribute::from_value(provenance.software()))?;
    header.insert("comments", &CppStringAttribute::from_value(&comments(quantity, provenance)))?;
    let window = [0, 0, width - 1, height - 1];
    let mut frame_buffer = FrameBuffer::new();
    for (name, samples) in layers.iter().flat_map(|&(layer, image)| named_channels(layer, image, quantity)) {
        header.channels_mut().insert(&name, &CHANNEL_FLOAT);
        frame_buffer.insert_frame(Frame::with_vec(&[name.as_str()], samples, window)?)?;
    }

    // All of it at once.
    let mut file = OutputFile::new(path, &header, 0)?;
    file.set_frame_buffer(&frame_buffer)?;
    // SAFETY: the library reads `height` scan lines of every channel from the frame buffer's slices. Each slice points into a frame of
    // width times height floats with the file's data window, which `frame_buffer` owns until after the call.
    unsafe { file.write_pixels(height) }
}
