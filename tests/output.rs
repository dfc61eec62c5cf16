//! Files written, then read back by readers of their own: nothing is lost, everything is stated, damage is found.

mod support;

use std::collections::BTreeMap;
use std::fs;
use std::io::Cursor;
use std::path::Path;

use exr::prelude::{FlatSamples, ReadChannels, ReadLayers};
use patchlight::output::{
    Destination, PngExposure, Provenance, Quantity, SOLUTION_FORMAT_VERSION, SolutionFileError, auto_exposure, is_solution_file,
    read_solution, read_solution_from, write_exr, write_ply, write_png, write_solution,
};
use patchlight::picture::Image;
use patchlight::solve::{Solution, SolveOptions};
use support::solved;

fn provenance() -> Provenance {
    Provenance::new(&SolveOptions { seed: 77, ..SolveOptions::default() })
}

/// A picture with values over the whole range of floats, no two alike.
fn picture(channels: usize) -> Image {
    let (width, height) = (37, 23);
    let radiance = (0..width * height * channels).map(|k| (k as f32 + 1.0) * 1.7_f32.powi((k % 80) as i32 - 40)).collect();
    Image { width: width as u32, height: height as u32, channels, radiance, standard_error: None }
}

/// Channels by name, comments, software.
fn read_exr(bytes: &[u8]) -> (BTreeMap<String, Vec<f32>>, String, String) {
    let image = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .from_buffered(Cursor::new(bytes))
        .unwrap();
    let layer = image.layer_data;
    let channels = layer.channel_data.list.into_iter().map(|channel| {
        let FlatSamples::F32(samples) = channel.sample_data else { panic!("{} is not 32-bit float", channel.name) };
        (channel.name.to_string(), samples)
    });
    let text = |text: Option<exr::prelude::Text>| text.unwrap().to_string();
    (channels.collect(), text(layer.attributes.comments), text(layer.attributes.software_name))
}

fn exr_of(image: &Image, quantity: Quantity) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    write_exr(&mut bytes, image, quantity, &provenance()).unwrap();
    bytes.into_inner()
}

#[test]
fn exr_keeps_every_bit_and_states_what_it_holds() {
    for (channels, names) in [(3, vec!["R", "G", "B"]), (1, vec!["Y"]), (2, vec!["0", "1"])] {
        let image = picture(channels);
        let (read, comments, software) = read_exr(&exr_of(&image, Quantity::Radiance));
        assert_eq!(read.len(), channels);
        for (channel, name) in names.into_iter().enumerate() {
            let expected: Vec<f32> = image.pixels().map(|pixel| pixel[channel]).collect();
            assert_eq!(read[name], expected, "channel {name} of {channels}");
        }
        assert_eq!(software, concat!("patchlight ", env!("CARGO_PKG_VERSION")));
        assert!(comments.contains("quantity: radiance\nunit: W/m^2/sr\n") && comments.contains("\"seed\":77"), "{comments}");
    }
}

#[test]
fn exr_numbers_bands_so_that_they_sort() {
    let image = picture(11);
    let (read, _, _) = read_exr(&exr_of(&image, Quantity::Radiance));
    for (channel, samples) in read.values().enumerate() {
        assert!(samples.iter().eq(image.pixels().map(|pixel| &pixel[channel])), "{channel}");
    }
    assert!(read.contains_key("00") && read.contains_key("10"));
}

#[test]
fn exr_of_radiosity_is_pi_times_radiance() {
    let image = picture(3);
    let (read, comments, _) = read_exr(&exr_of(&image, Quantity::Radiosity));
    assert!(read["G"].iter().eq(image.pixels().map(|p| p[1] * std::f32::consts::PI).collect::<Vec<_>>().iter()));
    assert!(comments.contains("quantity: radiosity\nunit: W/m^2\n"), "{comments}");
}

#[test]
fn the_same_picture_gives_the_same_bytes() {
    let image = picture(3);
    assert_eq!(exr_of(&image, Quantity::Radiance), exr_of(&image, Quantity::Radiance));
    let png = || {
        let mut bytes = Vec::new();
        write_png(&mut bytes, &image, PngExposure::Auto, &provenance()).unwrap();
        bytes
    };
    assert_eq!(png(), png());
}

#[test]
fn a_picture_that_is_not_well_formed_is_no_picture() {
    let mut image = picture(3);
    image.radiance.pop();
    assert!(write_exr(&mut Cursor::new(Vec::new()), &image, Quantity::Radiance, &provenance()).is_err());
    assert!(write_png(Vec::new(), &image, PngExposure::Auto, &provenance()).is_err());
}

struct ReadPng {
    colour: png::ColorType,
    bytes: Vec<u8>,
    texts: BTreeMap<String, String>,
}

fn png_of(image: &Image, exposure: PngExposure) -> (ReadPng, f64) {
    let mut file = Vec::new();
    let ev = write_png(&mut file, image, exposure, &provenance()).unwrap();
    let mut reader = png::Decoder::new(Cursor::new(file)).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let frame = reader.next_frame(&mut bytes).unwrap();
    assert_eq!((frame.width, frame.height, frame.bit_depth), (image.width, image.height, png::BitDepth::Eight));
    let texts = reader.info().uncompressed_latin1_text.iter().map(|chunk| (chunk.keyword.clone(), chunk.text.clone())).collect();
    (ReadPng { colour: frame.color_type, bytes, texts }, ev)
}

#[test]
fn png_shows_known_values_at_a_fixed_exposure() {
    // Linear 0.18 and 0.5 are 118 and 188 in sRGB; two stops brighter, 0.045 and 0.125 are as well.
    let image = Image { radiance: vec![0.18, 0.5, 0.0, 0.0, 0.18, 0.18], ..Image::black(2, 1, 3) };
    let (read, ev) = png_of(&image, PngExposure::Ev(0.0));
    assert_eq!((read.colour, read.bytes.as_slice(), ev), (png::ColorType::Rgb, &[118, 188, 0, 0, 118, 118][..], 0.0));
    let darker = Image { radiance: image.radiance.iter().map(|l| l / 4.0).collect(), ..image };
    assert_eq!(png_of(&darker, PngExposure::Ev(2.0)).0.bytes, read.bytes);
}

#[test]
fn png_is_grey_for_other_channel_counts_and_states_its_exposure() {
    let image = Image { radiance: vec![0.1, 0.26, 0.0, 0.0], ..Image::black(2, 1, 2) };
    let (read, _) = png_of(&image, PngExposure::Ev(0.0));
    assert_eq!((read.colour, read.bytes.as_slice()), (png::ColorType::Grayscale, &[118, 0][..]));
    let (read, ev) = png_of(&image, PngExposure::Auto);
    assert_eq!(ev, auto_exposure(&image));
    assert!(read.texts["Exposure"].starts_with(&format!("EV {ev:.4}")), "{:?}", read.texts);
    assert_eq!((read.texts["Quantity"].as_str(), read.texts["Unit"].as_str()), ("radiance", "W/m^2/sr"));
    assert!(read.texts["Software"].starts_with("patchlight ") && read.texts["Options"].contains("\"seed\":77"));
}

#[test]
fn png_shows_black_and_broken_pixels_as_black() {
    let image = Image { radiance: vec![0.0, f32::NAN, -1.0], ..Image::black(3, 1, 1) };
    let (read, ev) = png_of(&image, PngExposure::Auto);
    assert_eq!((read.bytes.as_slice(), ev), (&[0, 0, 0][..], 0.0));
}

/// A face of a PLY file: its corners, its surface, its radiosities.
type PlyFace = (Vec<[f64; 3]>, u32, Vec<f32>);

/// Reads what the header announces, and nothing else: a small reader for the types that occur.
fn read_ply(file: &[u8]) -> (Vec<String>, Vec<PlyFace>) {
    let mark = b"end_header\n";
    let end = file.windows(mark.len()).position(|w| w == mark).unwrap() + mark.len();
    let header = std::str::from_utf8(&file[..end]).unwrap();
    let mut lines = header.lines();
    assert_eq!((lines.next(), lines.next()), (Some("ply"), Some("format binary_little_endian 1.0")));
    let lines: Vec<String> = lines.map(str::to_owned).collect();
    let count = |element: &str| -> usize {
        let start = format!("element {element} ");
        lines.iter().find_map(|line| line.strip_prefix(&start)).unwrap().parse().unwrap()
    };
    let channels = lines.iter().filter(|line| line.starts_with("property float B_")).count();

    let mut data = &file[end..];
    let mut take = |n: usize| {
        let (head, rest) = data.split_at(n);
        data = rest;
        head.to_vec()
    };
    let vertices: Vec<[f64; 3]> =
        (0..count("vertex")).map(|_| std::array::from_fn(|_| f64::from_le_bytes(take(8).try_into().unwrap()))).collect();
    let faces = (0..count("face"))
        .map(|_| {
            let corners = usize::from(take(1)[0]);
            let corners = (0..corners).map(|_| vertices[u32::from_le_bytes(take(4).try_into().unwrap()) as usize]).collect();
            let surface = u32::from_le_bytes(take(4).try_into().unwrap());
            let radiosity = (0..channels).map(|_| f32::from_le_bytes(take(4).try_into().unwrap())).collect();
            // Face, material, object, group; the scene names no objects.
            assert_eq!(take(16)[8..], [255; 8]);
            (corners, surface, radiosity)
        })
        .collect();
    assert!(data.is_empty(), "{} bytes are left over", data.len());
    (lines, faces)
}

#[test]
fn ply_holds_every_leaf_with_its_radiosity() {
    for channels in [1, 3, 4] {
        let evaluator = solved(channels);
        let mut file = Vec::new();
        write_ply(&mut file, evaluator.solution(), &provenance()).unwrap();
        let (header, faces) = read_ply(&file);
        let mut leaves: Vec<PlyFace> = Vec::new();
        evaluator.solution().for_each_leaf(|polygon, surface, b| leaves.push((polygon.to_vec(), surface, b.to_vec())));
        assert!(leaves.len() >= 7);
        assert_eq!(faces, leaves);
        for line in ["comment quantity: radiosity", "comment unit: W/m^2", "property list uchar uint vertex_indices"] {
            assert!(header.iter().any(|l| l == line), "{line} is not in {header:?}");
        }
        let first = if channels == 3 { "property float B_r" } else { "property float B_0" };
        assert!(header.iter().any(|l| l == first) && header.iter().any(|l| l.contains("\"seed\":77")), "{header:?}");
    }
}

struct Stored {
    directory: tempfile::TempDir,
    bytes: Vec<u8>,
    solution: Solution,
}

fn stored() -> Stored {
    let directory = tempfile::tempdir().unwrap();
    let evaluator = solved(3);
    let path = directory.path().join("room.solution");
    let provenance = Provenance::new(evaluator.solution().options());
    Destination::new(&path).unwrap().write(|file| write_solution(file, evaluator.solution(), &provenance)).unwrap();
    assert!(is_solution_file(&path));
    Stored { directory, bytes: fs::read(&path).unwrap(), solution: evaluator.solution().clone() }
}

/// How many changed copies of a file of this length are tried: all of them together stay below 60 MB.
fn trials(length: usize) -> usize {
    (60_000_000 / length).clamp(40, 4000)
}

impl Stored {
    fn read(&self, bytes: &[u8]) -> Result<Solution, SolutionFileError> {
        let result = read_solution_from(bytes, Path::new("changed.solution"));
        if let Err(error) = &result {
            assert!(error.to_string().contains("changed.solution"), "'{error}' does not name the file");
        }
        result
    }
}

#[test]
fn a_solution_comes_back_as_it_was() {
    let stored = stored();
    assert_eq!(stored.read(&stored.bytes).unwrap(), stored.solution);
    assert_eq!(read_solution(&stored.directory.path().join("room.solution")).unwrap(), stored.solution);
    let text = String::from_utf8_lossy(&stored.bytes);
    assert!(text.contains("quantity: radiosity") && text.contains("unit: W/m^2") && text.contains("software: patchlight "));
}

#[test]
fn the_same_solution_gives_the_same_bytes() {
    let (first, second) = (stored(), stored());
    assert!(first.bytes == second.bytes);
}

#[test]
fn a_solution_cut_off_anywhere_is_found_out() {
    let stored = stored();
    let whole = stored.bytes.len();
    for length in (0..whole.min(2048)).chain([whole / 2, whole - 1]) {
        match stored.read(&stored.bytes[..length]) {
            Err(SolutionFileError::NotASolution(_)) => assert!(length < 8, "{length}"),
            Err(SolutionFileError::CutOff { found, .. }) => assert_eq!(found, length as u64),
            other => panic!("{length} bytes: {other:?}"),
        }
    }
}

#[test]
fn a_flipped_bit_anywhere_is_found_out() {
    let stored = stored();
    let step = stored.bytes.len().div_ceil(trials(stored.bytes.len()));
    for at in (0..24).chain((24..stored.bytes.len()).step_by(step)) {
        let mut bytes = stored.bytes.clone();
        bytes[at] ^= 1 << (at % 8);
        let error = stored.read(&bytes).expect_err("a flipped bit was not noticed");
        match at {
            0..8 => assert!(matches!(error, SolutionFileError::NotASolution(_)), "{at}: {error}"),
            8..12 => assert!(matches!(error, SolutionFileError::WrongVersion { .. }), "{at}: {error}"),
            12..20 => {
                assert!(matches!(error, SolutionFileError::CutOff { .. } | SolutionFileError::TooLong(_)), "{at}: {error}");
            }
            _ => assert!(matches!(error, SolutionFileError::Damaged { .. }), "{at}: {error}"),
        }
    }
}

#[test]
fn bytes_after_the_end_are_found_out() {
    let stored = stored();
    let mut bytes = stored.bytes.clone();
    bytes.push(0);
    assert!(matches!(stored.read(&bytes), Err(SolutionFileError::TooLong(_))));
}

#[test]
fn another_version_and_other_files_are_named_as_such() {
    let stored = stored();
    let mut bytes = stored.bytes.clone();
    bytes[8..12].copy_from_slice(&(SOLUTION_FORMAT_VERSION + 1).to_le_bytes());
    let message = stored.read(&bytes).unwrap_err().to_string();
    let (own, other) = (SOLUTION_FORMAT_VERSION, SOLUTION_FORMAT_VERSION + 1);
    assert!(
        message.contains(&format!("solution format {other}, this program reads format {own}; solve the scene again")),
        "{message}"
    );
    assert!(matches!(stored.read(b"v 0 0 0\nv 1 0 0\n"), Err(SolutionFileError::NotASolution(_))));
    assert!(matches!(stored.read(b""), Err(SolutionFileError::NotASolution(_))));
    let missing = stored.directory.path().join("missing.solution");
    assert!(matches!(read_solution(&missing), Err(SolutionFileError::Read { .. })));
}

/// A file whose header and checksum are right for a body that is not.
fn forged(body: &[u8]) -> Vec<u8> {
    let mut bytes = b"\x89PLSOL\r\n".to_vec();
    bytes.extend(SOLUTION_FORMAT_VERSION.to_le_bytes());
    bytes.extend((body.len() as u64).to_le_bytes());
    bytes.extend(crc32fast::hash(body).to_le_bytes());
    bytes.extend(body);
    bytes
}

#[test]
fn forged_bodies_with_right_checksums_do_no_harm() {
    let stored = stored();
    let body = &stored.bytes[24..];
    assert!(stored.read(&forged(body)).is_ok());
    // Nothing, lengths of 2^63, and a body that goes on.
    for bad in [&[][..], &[0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x7f], &[0, 3, 0xff, 0xff, 0xff, 0xff, 0x7f]] {
        assert!(matches!(stored.read(&forged(bad)), Err(SolutionFileError::Damaged { .. })));
    }
    assert!(matches!(stored.read(&forged(&[body, &[0]].concat())), Err(SolutionFileError::Damaged { .. })));
    // Any byte changed, checksum made to fit: an error or a solution that validates, never a panic or a huge allocation.
    let step = body.len().div_ceil(trials(4 * body.len()));
    for at in (0..body.len()).step_by(step) {
        for value in [0x00, 0x7f, 0x80, 0xff] {
            let mut changed = body.to_vec();
            changed[at] = value;
            if let Ok(solution) = stored.read(&forged(&changed)) {
                assert_eq!(solution.validate(), Ok(()));
            }
        }
    }
}
