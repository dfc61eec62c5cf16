//! Pictures that tell numbers: irradiance, illuminance, false colours, and lines over pictures.

use std::collections::HashSet;
use std::f64::consts::PI;
use std::io::Cursor;

use patchlight::form_factor::point_form_factor;
use patchlight::geometry::Polygon;
use patchlight::output::{Display, LUMENS_PER_WATT, Look, PngExposure, Provenance, Quantity, Scale, write_display};
use patchlight::picture::{Camera, Image};
use patchlight::pipeline::{self, Evaluator};
use patchlight::progress::Silent;
use patchlight::scene::{Material, Scene, Sides};
use patchlight::solve::{RunOptions, SolveOptions};

const REFLECTANCE: [f64; 3] = [0.5, 0.25, 0.125];
const EXITANCE: [f64; 3] = [8.0, 4.0, 2.0];

fn rectangle(corner: [f64; 3], u: [f64; 3], v: [f64; 3]) -> Polygon {
    let at = |s: f64, t: f64| std::array::from_fn(|k| corner[k] + s * u[k] + t * v[k]);
    Polygon::new(&[at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)]).unwrap()
}

/// A lamp that reflects nothing, and looks down on a floor a metre below.
fn polygons() -> Vec<Polygon> {
    vec![
        rectangle([-0.5, 1.0, -0.5], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]),
        rectangle([-2.0, 0.0, -2.0], [0.0, 0.0, 4.0], [4.0, 0.0, 0.0]),
    ]
}

fn solved(polygons: &[Polygon]) -> Evaluator {
    let material = |reflectance: [f64; 3], exitance: [f64; 3]| Material {
        name: "m".to_owned(),
        reflectance: reflectance.to_vec(),
        exitance: exitance.to_vec(),
    };
    let materials = vec![material([0.0; 3], EXITANCE), material(REFLECTANCE, [0.0; 3])];
    let faces = polygons.iter().zip(0..).map(|(polygon, face)| (polygon.clone(), u32::from(face > 0), face)).collect();
    let scene = Scene::new(3, materials, faces, Sides::Front).unwrap();
    let options = SolveOptions { error: 0.02, ..SolveOptions::default() };
    let run = RunOptions { threads: 1, ..RunOptions::default() };
    pipeline::solve(scene, &options, &run, &Silent).unwrap().0
}

/// From above on the floor: two metres in each direction, beyond the lamp.
fn camera(height: f64) -> Camera {
    Camera { eye: [0.0, height, 0.0], target: [0.0; 3], up: [0.0, 0.0, -1.0], field_of_view_degrees: 90.0, width: 240, height: 160 }
}

#[test]
fn irradiance_is_what_a_floor_under_a_lamp_gets() {
    let polygons = polygons();
    let evaluator = solved(&polygons);
    // Below the lamp, which is seen from its back beyond.
    let camera = camera(0.9);
    let mesh = evaluator.lit_mesh(0.02, &Silent).unwrap();
    for mesh in [None, Some(&mesh)] {
        let image = evaluator.render_irradiance(mesh, &camera, &Silent).unwrap().unwrap();
        for (column, row) in [(120, 80), (30, 20), (200, 100), (120, 10)] {
            // The picture is 1.8 m high on the floor.
            let place = |pixel: f64, middle: f64| (pixel + 0.5 - middle) / 80.0 * 0.9;
            let point = [place(f64::from(column), 120.0), 0.0, place(f64::from(row), 80.0)];
            let factor = point_form_factor(point, [0.0, 1.0, 0.0], &polygons[0]);
            for (channel, exitance) in EXITANCE.into_iter().enumerate() {
                let found = PI * f64::from(image.radiance[(row as usize * 240 + column as usize) * 3 + channel]);
                assert!((found / (exitance * factor) - 1.0).abs() < 0.03, "{point:?}: {found} for {}", exitance * factor);
            }
        }
        // Lux: the luminance of the irradiance, by 179 lm to a watt.
        let luminance = image.to_luminance().unwrap();
        let [r, g, b] = [0, 1, 2].map(|channel| image.radiance[(80 * 240 + 120) * 3 + channel]);
        let expected = f64::from(0.2126 * r + 0.7152 * g + 0.0722 * b);
        assert!((f64::from(luminance.radiance[80 * 240 + 120]) / expected - 1.0).abs() < 1e-6 && LUMENS_PER_WATT == 179.0);
    }
}

#[test]
fn irradiance_is_not_known_where_nothing_is_reflected_and_times_reflectance_is_radiance_elsewhere() {
    let evaluator = solved(&polygons());
    // From below the floor's level sideways: the lamp's front and the floor are seen.
    let camera = Camera { eye: [0.0, 0.3, 1.8], target: [0.0, 0.6, 0.0], up: [0.0, 1.0, 0.0], ..camera(1.0) };
    let radiance = evaluator.render(&camera, &Silent).unwrap().unwrap();
    let irradiance = evaluator.render_irradiance(None, &camera, &Silent).unwrap().unwrap();
    let (mut lamp, mut floor) = (0, 0);
    for (number, (&l, &h)) in radiance.radiance.iter().zip(&irradiance.radiance).enumerate() {
        let channel = number % 3;
        if f64::from(l) == (EXITANCE[channel] / PI) as f32 as f64 {
            assert_eq!(h, 0.0);
            lamp += 1;
        } else if l > 0.0 && h > 0.0 && (f64::from(h) * REFLECTANCE[channel] / f64::from(l) - 1.0).abs() < 1e-5 {
            floor += 1;
        } else if l > 0.0 {
            // A pixel at the border of both.
            assert!(f64::from(l) > REFLECTANCE[channel] * f64::from(h) * 0.999);
        }
    }
    assert!(lamp > 1000 && floor > 10_000, "{lamp} {floor}");
}

/// What a PNG holds: RGB and the texts of its chunks.
fn read(file: Vec<u8>) -> (Vec<u8>, String) {
    let mut reader = png::Decoder::new(Cursor::new(file)).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    assert_eq!(reader.next_frame(&mut bytes).unwrap().color_type, png::ColorType::Rgb);
    let texts = reader.info().uncompressed_latin1_text.iter().map(|chunk| format!("{}: {}\n", chunk.keyword, chunk.text));
    (bytes, texts.collect())
}

#[test]
fn false_colours_are_those_of_the_values_and_the_file_says_so() {
    let provenance = Provenance::new(&SolveOptions::default());
    let scale: Scale = "0..500".parse().unwrap();
    for (quantity, per_number) in [(Quantity::Radiance, 1.0), (Quantity::Irradiance, PI), (Quantity::Illuminance, 179.0 * PI)] {
        // One channel that rises from row to row, beyond the scale.
        let number = |row: u32| (f64::from(row) * 5.0 / per_number) as f32;
        let radiance = (0..120_u32).flat_map(|row| std::iter::repeat_n(number(row), 200)).collect();
        let image = Image { radiance, ..Image::black(200, 120, 1) };
        let mut file = Vec::new();
        let display = Display { image: &image, quantity, look: Look::Scale(scale), marks: None };
        write_display(&mut file, &display, &provenance).unwrap();
        let (bytes, texts) = read(file);
        for row in 0..120_u32 {
            let pixel = &bytes[3 * 200 * row as usize..][..3];
            let expected = scale.colour(f64::from(row) * 5.0);
            assert!((0..3).all(|k| pixel[k].abs_diff(expected[k]) <= 1), "{row}: {pixel:?} {expected:?}");
        }
        assert_eq!(bytes[3 * 200 * 100..][..3], bytes[3 * 200 * 119..][..3]);
        let (name, unit) = (quantity.name(), quantity.unit());
        for text in [format!("Quantity: {name}\n"), format!("Unit: {unit}\n"), format!("Scale: 0..500 {unit}")] {
            assert!(texts.contains(&text), "{texts}");
        }
    }
    // A picture without room for a legend is refused.
    let image = Image::black(100, 100, 1);
    let display = Display { image: &image, quantity: Quantity::Radiance, look: Look::Scale(scale), marks: None };
    assert!(write_display(Vec::new(), &display, &provenance).is_err());
}

#[test]
fn lines_lie_over_what_is_seen_and_not_over_what_hides_it() {
    // A sheet over the middle of the floor hides a part of it.
    let mut polygons = polygons();
    polygons.push(rectangle([-0.3, 0.2, -0.3], [0.0, 0.0, 0.6], [0.6, 0.0, 0.0]));
    let evaluator = solved(&polygons);
    let camera = camera(0.9);
    let mesh = evaluator.lit_mesh(0.05, &Silent).unwrap();
    let of_mesh = evaluator.mark_mesh(&mesh, &camera, &Silent).unwrap().unwrap();
    let of_curves = evaluator.mark_curves(1e-3, &camera, &Silent).unwrap().unwrap();
    for (marks, name) in [(&of_mesh, "mesh"), (&of_curves, "curves")] {
        let pixels: HashSet<usize> = marks.pixels().map(|(pixel, _)| pixel).collect();
        assert!(pixels.len() > 200 && pixels.iter().all(|&pixel| pixel < 240 * 160), "{name}: {}", pixels.len());
        // The shadow ends where the lamp's far side goes under the sheet's edge: 0.5 m from the middle, 44.4 of the 80 pixels to 0.9 m.
        assert!(pixels.iter().any(|pixel| (75..=76).contains(&(pixel % 240))), "{name}");
    }
    // No curve of the floor below is drawn over the sheet, which has none: it lies 0.7 m before the eye.
    let sheet = |pixel: usize| (pixel % 240).abs_diff(120) < 30 && (pixel / 240).abs_diff(80) < 30;
    assert!(of_curves.pixels().all(|(pixel, _)| !sheet(pixel) && pixel % 240 >= 75));
    assert!(of_mesh.pixels().any(|(pixel, _)| sheet(pixel)), "the sheet has elements of its own");

    // They are drawn in their colours, over light and over false colours.
    let image = evaluator.render_mesh(&mesh, &camera, &Silent).unwrap().unwrap();
    let provenance = Provenance::new(&SolveOptions::default());
    for look in [Look::Light(PngExposure::Auto), Look::Scale("0..1".parse().unwrap())] {
        let mut file = Vec::new();
        let display = Display { image: &image, quantity: Quantity::Radiance, look, marks: Some(&of_mesh) };
        write_display(&mut file, &display, &provenance).unwrap();
        let (bytes, _) = read(file);
        let left = of_mesh.pixels().filter(|(pixel, _)| pixel % 240 < 120);
        assert!(left.into_iter().all(|(pixel, colour)| bytes[3 * pixel..][..3] == colour));
    }
}
