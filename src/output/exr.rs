//! OpenEXR images: linear 32-bit floats, nothing lost.

use std::io::{self, Seek, Write};

use ::exr::prelude::{AnyChannel, AnyChannels, Encoding, FlatSamples, Layer, LayerAttributes, SmallVec, Text, WritableImage};

use super::{Provenance, Quantity};
use crate::picture::Image;

/// Writes `image` as OpenEXR: 32-bit float, ZIP-compressed scan lines. The channel is `Y` where there is one, `R`, `G`, `B` where
/// there are three, else they are numbered from 0 with leading zeros, so that they sort; the layer `se` holds their standard errors, where
/// these are known. The attribute `software` holds name and
/// version, `comments` one line each for software, quantity, unit and options.
///
/// # Errors
/// What the writer says, and [`io::ErrorKind::InvalidInput`] for an image that is not [well formed](Image::is_well_formed).
pub fn write_exr(writer: &mut (impl Write + Seek), image: &Image, quantity: Quantity, provenance: &Provenance) -> io::Result<()> {
    write_exr_layers(writer, &[("", image)], quantity, provenance)
}

/// Writes images of one size as layers of a file: each has its channels by its name, as in `direct.R`; those of the layer without a name stand alone.
///
/// # Errors
/// As [`write_exr`], and [`io::ErrorKind::InvalidInput`] if sizes differ or there is no image.
pub fn write_exr_layers(
    writer: &mut (impl Write + Seek),
    layers: &[(&str, &Image)],
    quantity: Quantity,
    provenance: &Provenance,
) -> io::Result<()> {
    let image = first_of(layers)?;
    let channels: SmallVec<[AnyChannel<FlatSamples>; 4]> = layers
        .iter()
        .flat_map(|&(layer, image)| named_channels(layer, image, quantity))
        .map(|(name, samples)| AnyChannel::new(name.as_str(), FlatSamples::F32(samples)))
        .collect();

    // Only attributes that the format knows: the crate writes others in the order of a hash table.
    let attributes = LayerAttributes {
        software_name: Some(Text::from(provenance.software())),
        comments: Some(Text::from(comments(quantity, provenance).as_str())),
        ..LayerAttributes::default()
    };
    let size = (image.width as usize, image.height as usize);
    let layer = Layer::new(size, attributes, Encoding::SMALL_LOSSLESS, AnyChannels::sort(channels));
    ::exr::prelude::Image::from_layer(layer).write().non_parallel().to_buffered(writer).map_err(|error| match error {
        ::exr::error::Error::Io(error) => error,
        other => io::Error::other(other.to_string()),
    })
}

/// What both EXR writers state.
pub(super) fn comments(quantity: Quantity, provenance: &Provenance) -> String {
    provenance.statements(quantity).iter().map(|(key, text)| format!("{key}: {text}")).collect::<Vec<_>>().join("\n")
}

/// The first of some layers, all of which are well formed and of its size.
pub(super) fn first_of<'a>(layers: &[(&str, &'a Image)]) -> io::Result<&'a Image> {
    let invalid = |text: &str| io::Error::new(io::ErrorKind::InvalidInput, text);
    let &(_, first) = layers.first().ok_or_else(|| invalid("there is no image to write"))?;
    if layers.iter().any(|(_, image)| !image.is_well_formed()) {
        return Err(invalid("the image has more or fewer values than pixels and channels"));
    }
    let is_as_large = |image: &Image| (image.width, image.height) == (first.width, first.height);
    if layers.iter().all(|(_, image)| is_as_large(image)) { Ok(first) } else { Err(invalid("the layers differ in size")) }
}

/// The channels of a layer with their names, each row after row; after those of the quantity those of its standard error, where it is known.
pub(super) fn named_channels(layer: &str, image: &Image, quantity: Quantity) -> impl Iterator<Item = (String, Vec<f32>)> + use<> {
    let prefix = if layer.is_empty() { String::new() } else { format!("{layer}.") };
    let scale = quantity.per_radiance();
    let samples = |numbers: &[f32], channel: usize| -> Vec<f32> {
        numbers.iter().skip(channel).step_by(image.channels).map(|number| number * scale).collect()
    };
    let mut named = Vec::new();
    for (kind, numbers) in [("", Some(&image.radiance)), (STANDARD_ERROR, image.standard_error.as_ref())] {
        let Some(numbers) = numbers else { continue };
        let names = channel_names(image.channels).into_iter().enumerate();
        named.extend(names.map(|(channel, name)| (format!("{prefix}{kind}{name}"), samples(numbers, channel))));
    }
    named.into_iter()
}

/// The layer of standard errors.
const STANDARD_ERROR: &str = "se.";

/// `Y` for one channel, `R`, `G`, `B` for three, else numbers from 0 with leading zeros, so that they sort.
fn channel_names(channels: usize) -> Vec<String> {
    match channels {
        1 => vec!["Y".to_owned()],
        3 => ["R", "G", "B"].map(str::to_owned).to_vec(),
        _ => {
            let digits = (channels - 1).to_string().len();
            (0..channels).map(|channel| format!("{channel:0digits$}")).collect()
        }
    }
}
