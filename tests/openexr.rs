//! The C++ OpenEXR writer against the Rust one: each file is read by both libraries, and all pixels are the same to the bit.
#![cfg(feature = "openexr")]

use std::fs;
use std::io::Cursor;
use std::path::Path;

use openexr::prelude::{Frame, InputFile};
use patchlight::output::{Provenance, Quantity, write_exr, write_openexr};
use patchlight::picture::Image;
use patchlight::solve::SolveOptions;

fn picture(width: u32, height: u32, channels: usize) -> Image {
    let count = width as usize * height as usize * channels;
    let radiance = (0..count).map(|k| (k as f32 + 1.0) * 1.7_f32.powi((k % 80) as i32 - 40)).collect();
    Image { radiance, ..Image::black(width, height, channels) }
}

fn names(channels: usize) -> Vec<&'static str> {
    match channels {
        1 => vec!["Y"],
        3 => vec!["R", "G", "B"],
        _ => ["0", "1", "2", "3", "4"][..channels].to_vec(),
    }
}

/// The bits of the channels, in the order of `names`, as the Rust library reads them.
fn read_by_exr(path: &Path, names: &[&str]) -> Vec<Vec<u32>> {
    use exr::prelude::{FlatSamples, ReadChannels, ReadLayers};
    let image = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .from_file(path)
        .unwrap();
    let attributes = &image.layer_data.attributes;
    assert!(attributes.software_name.as_ref().unwrap().to_string().starts_with("patchlight "));
    assert!(attributes.comments.as_ref().unwrap().to_string().contains("quantity: radiance\nunit: W/m^2/sr\n"));
    let list = &image.layer_data.channel_data.list;
    assert_eq!(list.len(), names.len());
    let samples = |name: &&str| {
        let channel = list.iter().find(|channel| channel.name.to_string() == *name).unwrap();
        let FlatSamples::F32(samples) = &channel.sample_data else { panic!("{name} is not 32-bit float") };
        samples.iter().map(|sample| sample.to_bits()).collect()
    };
    names.iter().map(samples).collect()
}

/// The same, as the C++ library reads them.
fn read_by_openexr(path: &Path, names: &[&str]) -> Vec<Vec<u32>> {
    let file = InputFile::new(path, 0).unwrap();
    let window: [i32; 4] = *file.header().data_window();
    let frames = names.iter().map(|name| Frame::new::<f32, _, _>(&[name], window).unwrap()).collect();
    let (_file, frames) = file.into_reader(frames).unwrap().read_pixels(window[1], window[3]).unwrap();
    frames.iter().map(|frame| frame.as_slice::<f32>().iter().map(|sample| sample.to_bits()).collect()).collect()
}

#[test]
fn both_writers_and_both_readers_agree_on_every_pixel() {
    let directory = tempfile::tempdir().unwrap();
    let provenance = Provenance::new(&SolveOptions::default());
    for (width, height, channels) in [(37, 23, 3), (16, 16, 1), (64, 48, 3), (1, 1, 3), (5, 40, 5)] {
        let image = picture(width, height, channels);
        let names = names(channels);
        let expected: Vec<Vec<u32>> =
            (0..channels).map(|channel| image.pixels().map(|pixel| pixel[channel].to_bits()).collect()).collect();

        let [by_rust, by_cpp] = ["rust.exr", "cpp.exr"].map(|name| directory.path().join(name));
        let mut bytes = Cursor::new(Vec::new());
        write_exr(&mut bytes, &image, Quantity::Radiance, &provenance).unwrap();
        fs::write(&by_rust, bytes.into_inner()).unwrap();
        let mut bytes = Cursor::new(Vec::new());
        write_openexr(&mut bytes, &image, Quantity::Radiance, &provenance).unwrap();
        fs::write(&by_cpp, bytes.into_inner()).unwrap();

        for path in [&by_rust, &by_cpp] {
            let what = format!("{width}x{height}, {channels} channels, {}", path.display());
            assert!(read_by_exr(path, &names) == expected, "{what}, read by exr");
            assert!(read_by_openexr(path, &names) == expected, "{what}, read by openexr");
        }
    }
}

#[test]
fn a_picture_that_is_not_well_formed_is_no_picture() {
    let mut image = picture(4, 4, 3);
    image.radiance.pop();
    let provenance = Provenance::new(&SolveOptions::default());
    assert!(write_openexr(&mut Cursor::new(Vec::new()), &image, Quantity::Radiance, &provenance).is_err());
}
