//! Lit scenes as GLB and VTP, pictures as HDR: read back by the formats' own rules, number for number.

#[path = "support/mod.rs"]
mod support;

use patchlight::output::{ExportFormat, Provenance, Quantity, export_elements, export_mesh, write_hdr};
use patchlight::picture::Image;
use patchlight::pipeline::{self, Evaluator};
use patchlight::progress::Silent;
use patchlight::scene::FaceNames;
use patchlight::solve::{Bounds, RunOptions, SolveOptions};
use serde_json::Value;

/// The small room with names for its walls and its lamp, as a mesh and with bounds.
fn lit_room() -> Evaluator {
    let mut objects = FaceNames::default();
    objects.push_run("walls", 6);
    objects.push_run("lamp", 1);
    // The first three walls are a group, all else is in none.
    let mut groups = FaceNames::default();
    groups.push_run("three", 3);
    groups.push_run("", 4);
    let scene = support::small_room(3).with_names(objects, groups);
    let options = SolveOptions { error: 0.2, lit_mesh: true, bounds: Bounds::Guaranteed, ..SolveOptions::default() };
    pipeline::solve(scene, &options, &RunOptions::default(), &Silent).unwrap().0
}

/// JSON and binary chunk of a GLB.
fn chunks(file: &[u8]) -> (Value, &[u8]) {
    let number = |at: usize| u32::from_le_bytes(file[at..at + 4].try_into().unwrap()) as usize;
    assert_eq!((&file[..4], number(4), number(8)), (&b"glTF"[..], 2, file.len()));
    let json = number(12);
    assert_eq!((&file[16..20], &file[24 + json..28 + json]), (&b"JSON"[..], &b"BIN\0"[..]));
    assert_eq!(number(20 + json) + 28 + json, file.len());
    (serde_json::from_slice(&file[20..20 + json]).unwrap(), &file[28 + json..])
}

/// The words of an accessor.
fn words(json: &Value, binary: &[u8], accessor: &Value) -> Vec<[u8; 4]> {
    let accessor = &json["accessors"][accessor.as_u64().unwrap() as usize];
    let view = &json["bufferViews"][accessor["bufferView"].as_u64().unwrap() as usize];
    let [start, length] = ["byteOffset", "byteLength"].map(|key| view[key].as_u64().unwrap() as usize);
    let width = ["SCALAR", "VEC2", "VEC3", "VEC4"].iter().position(|kind| accessor["type"] == *kind).unwrap() + 1;
    assert_eq!(length, 4 * width * accessor["count"].as_u64().unwrap() as usize);
    binary[start..start + length].chunks(4).map(|word| word.try_into().unwrap()).collect()
}

fn floats(json: &Value, binary: &[u8], accessor: &Value) -> Vec<f32> {
    words(json, binary, accessor).into_iter().map(f32::from_le_bytes).collect()
}

#[test]
fn a_glb_shows_the_lit_mesh_and_keeps_its_numbers() {
    let evaluator = lit_room();
    let (solution, mesh) = (evaluator.solution(), evaluator.mesh().unwrap());
    let provenance = Provenance::new(solution.options());
    let mut file = Vec::new();
    export_mesh(&mut file, ExportFormat::Glb, solution, mesh, &provenance).unwrap();
    let (json, binary) = chunks(&file);

    // Objects and materials have their names; the file says what it holds.
    let names = |list: &str| -> Vec<String> {
        json[list].as_array().unwrap().iter().map(|item| item["name"].as_str().unwrap().to_owned()).collect()
    };
    assert_eq!(
        (names("nodes"), names("materials")),
        (vec!["walls".into(), "walls".into(), "lamp".into()], vec!["wall".into(), "lamp".into()])
    );
    let extras = &json["asset"]["extras"];
    assert_eq!((extras["quantity"].as_str(), extras["unit"].as_str()), (Some("radiosity"), Some("W/m^2")));
    let scale = 2.0_f64.powf(extras["exposure"].as_f64().unwrap()) / std::f64::consts::PI;

    // Four triangles for each element, whose nodes have the radiosities of the mesh, and colours that follow from them.
    let (mut found, mut triangles) = (Vec::new(), 0);
    for part in json["meshes"].as_array().unwrap() {
        let primitive = &part["primitives"][0];
        let of = |name: &str| floats(&json, binary, &primitive["attributes"][name]);
        let (positions, radiosity, colours) = (of("POSITION"), of("_RADIOSITY"), of("COLOR_0"));
        let indices = words(&json, binary, &primitive["indices"]);
        triangles += indices.len() / 3;
        assert!(indices.iter().all(|&index| (u32::from_le_bytes(index) as usize) < positions.len() / 3));
        for (b, colour) in radiosity.iter().zip(&colours) {
            assert!((f64::from(*colour) - (f64::from(*b) * scale).min(1.0)).abs() < 1e-6);
        }
        found.extend(positions.chunks(3).zip(radiosity.chunks(3)).map(|(at, b)| [at, b].concat()));
    }
    let mut expected = Vec::new();
    mesh.parts(solution.scene()).for_each(|part| {
        let nodes = part.nodes.iter().map(|at| at.map(|x| x as f32));
        expected.extend(nodes.zip(part.radiosity.chunks(3)).map(|(at, b)| [&at[..], b].concat()));
    });
    let sorted = |mut all: Vec<Vec<f32>>| {
        all.sort_by(|a, b| a.partial_cmp(b).unwrap());
        all
    };
    assert_eq!(triangles, 4 * mesh.elements());
    assert_eq!(sorted(found), sorted(expected));

    // The same bytes each time.
    let mut again = Vec::new();
    export_mesh(&mut again, ExportFormat::Glb, solution, mesh, &provenance).unwrap();
    assert!(file == again);
}

#[test]
fn surfaces_without_a_mesh_are_shown_as_they_emit() {
    let scene = support::small_room(3);
    let mut materials = scene.materials().to_vec();
    materials[1].reflectance = vec![0.0; 3];
    let faces = scene.surfaces().iter().map(|surface| (surface.polygon.clone(), surface.material, surface.face)).collect();
    let scene = patchlight::scene::Scene::new(3, materials, faces, scene.sides()).unwrap();
    let options = SolveOptions { error: 0.3, lit_mesh: true, ..SolveOptions::default() };
    let (evaluator, _) = pipeline::solve(scene, &options, &RunOptions::default(), &Silent).unwrap();
    let (solution, mesh) = (evaluator.solution(), evaluator.mesh().unwrap());
    let mut file = Vec::new();
    export_mesh(&mut file, ExportFormat::Glb, solution, mesh, &Provenance::new(solution.options())).unwrap();
    let (json, binary) = chunks(&file);
    let lamp = json["meshes"].as_array().unwrap().iter().find(|part| part["name"] == "lamp").unwrap();
    let radiosity = floats(&json, binary, &lamp["primitives"][0]["attributes"]["_RADIOSITY"]);
    assert_eq!(radiosity, [10.0, 20.0, 30.0].repeat(4));
}

/// The arrays of a VTP file: name, components, bytes.
fn arrays(file: &[u8]) -> Vec<(String, usize, Vec<u8>)> {
    let start = file.windows(24).position(|part| part.starts_with(b"<AppendedData encoding=")).unwrap();
    let data = start + file[start..].iter().position(|&byte| byte == b'_').unwrap() + 1;
    let text = std::str::from_utf8(&file[..start]).unwrap();
    let attribute = |line: &str, key: &str| line.split_once(&format!("{key}=\"")).unwrap().1.split('"').next().unwrap().to_owned();
    let lines = text.lines().filter(|line| line.starts_with("<DataArray"));
    let read = |line: &str| {
        let at = data + attribute(line, "offset").parse::<usize>().unwrap();
        let length = u64::from_le_bytes(file[at..at + 8].try_into().unwrap()) as usize;
        (attribute(line, "Name"), attribute(line, "NumberOfComponents").parse().unwrap(), file[at + 8..at + 8 + length].to_vec())
    };
    lines.map(read).collect()
}

#[test]
fn a_vtp_has_radiosities_irradiances_and_bounds_of_elements() {
    let evaluator = lit_room();
    let solution = evaluator.solution();
    let mut file = Vec::new();
    export_elements(&mut file, ExportFormat::Vtp, solution, &Provenance::new(solution.options())).unwrap();
    let arrays = arrays(&file);
    let of = |name: &str| -> Vec<f32> {
        let array = arrays.iter().find(|array| array.0 == name).unwrap();
        array.2.chunks(4).map(|bytes| f32::from_le_bytes(bytes.try_into().unwrap())).collect()
    };
    let numbers = |name: &str| -> Vec<i64> {
        let array = arrays.iter().find(|array| array.0 == name).unwrap();
        array.2.chunks(8).map(|bytes| i64::from_le_bytes(bytes.try_into().unwrap())).collect()
    };
    let mut expected = (Vec::new(), Vec::new(), 0);
    solution.for_each_leaf(|corners, surface, radiosity| {
        expected.0.extend_from_slice(radiosity);
        expected.1.push(i64::from(surface));
        expected.2 += corners.len();
    });
    assert_eq!((of("radiosity"), numbers("surface")), (expected.0, expected.1));
    assert_eq!((numbers("connectivity").len(), numbers("offsets").last().copied()), (expected.2, Some(expected.2 as i64)));

    // B = E + rho H, and bounds are in order.
    for (k, (b, h)) in of("radiosity").iter().zip(of("irradiance")).enumerate() {
        let material = &solution.scene().materials()[numbers("material")[k / 3] as usize];
        let sum = material.exitance[k % 3] + material.reflectance[k % 3] * f64::from(h);
        assert!((sum - f64::from(*b)).abs() <= 1e-5 * sum, "{sum} {b}");
    }
    assert!(of("lower").iter().zip(of("upper")).all(|(lower, upper)| *lower <= upper));
    assert_eq!(of("lower").len(), of("radiosity").len());
}

#[test]
fn a_vtp_of_a_mesh_has_point_data() {
    let evaluator = lit_room();
    let (solution, mesh) = (evaluator.solution(), evaluator.mesh().unwrap());
    let mut file = Vec::new();
    export_mesh(&mut file, ExportFormat::Vtp, solution, mesh, &Provenance::new(solution.options())).unwrap();
    let arrays = arrays(&file);
    let names: Vec<&str> = arrays.iter().map(|array| array.0.as_str()).collect();
    let of_cells = ["surface", "face", "material", "object", "group", "standard_error"];
    assert_eq!(names, [&["radiosity", "irradiance"][..], &of_cells, &["Points", "connectivity", "offsets"]].concat());
    let radiosity: Vec<f32> = mesh.parts(solution.scene()).flat_map(|part| part.radiosity).collect();
    assert!(arrays[0].2 == radiosity.iter().flat_map(|b| b.to_le_bytes()).collect::<Vec<u8>>());
    assert_eq!(arrays[2].2.len(), 8 * 4 * mesh.elements());

    // Each element is four cells; what reflects nothing is known.
    let errors: Vec<f32> = arrays[7].2.chunks(4).map(|bytes| f32::from_le_bytes(bytes.try_into().unwrap())).collect();
    let of_elements = mesh.parts(solution.scene()).flat_map(|part| part.standard_errors);
    assert!(of_elements.flat_map(|error| [error; 4]).eq(errors[..4 * mesh.elements()].iter().copied()));
    assert!(errors[4 * mesh.elements()..].iter().all(|error| *error == 0.0));
}

#[test]
fn files_tell_faces_and_names_of_the_input() {
    let evaluator = lit_room();
    let (solution, mesh) = (evaluator.solution(), evaluator.mesh().unwrap());
    let (scene, provenance) = (solution.scene(), Provenance::new(solution.options()));
    let written = |format: ExportFormat, of_mesh: bool| {
        let mut file = Vec::new();
        match of_mesh {
            true => export_mesh(&mut file, format, solution, mesh, &provenance).unwrap(),
            false => export_elements(&mut file, format, solution, &provenance).unwrap(),
        }
        file
    };
    for of_mesh in [false, true] {
        // Cells of the one, by number of the list of names; -1 is no name.
        let file = written(ExportFormat::Vtp, of_mesh);
        let arrays = arrays(&file);
        let of = |name: &str| -> Vec<i64> {
            let array = arrays.iter().find(|array| array.0 == name).unwrap();
            array.2.chunks(8).map(|bytes| i64::from_le_bytes(bytes.try_into().unwrap())).collect()
        };
        for (k, &surface) in of("surface").iter().enumerate() {
            let surface = &scene.surfaces()[surface as usize];
            let object = i64::from(surface.face == 6);
            assert_eq!(
                (of("face")[k], of("object")[k], of("group")[k]),
                (surface.face.into(), object, if surface.face < 3 { 0 } else { -1 })
            );
        }
        let names = b"Name=\"objects\" NumberOfTuples=\"1\" format=\"ascii\">119 97 108 108 115 10 108 97 109 112 0<";
        assert!(file.windows(names.len()).any(|part| part == names));

        // Faces of another, behind what else it tells of them.
        let file = written(ExportFormat::Ply, of_mesh);
        let end = file.windows(11).position(|bytes| bytes == b"end_header\n").unwrap();
        let header = std::str::from_utf8(&file[..end]).unwrap();
        for line in ["comment material 0 wall", "comment object 1 lamp", "property uint face", "property int group"] {
            assert!(header.lines().any(|found| found == line), "{header}");
        }
        let numbers: Vec<i32> =
            file[file.len() - 16..].chunks(4).map(|bytes| i32::from_le_bytes(bytes.try_into().unwrap())).collect();
        let mut last = mesh.parts(scene).last().unwrap().surface;
        if !of_mesh {
            solution.for_each_leaf(|_, surface, _| last = surface);
        }
        let is_lamp = i32::from(last == 6);
        assert_eq!(numbers, [last as i32, is_lamp, is_lamp, -1]);

        // Vertices of the third; nodes have the names.
        let file = written(ExportFormat::Glb, of_mesh);
        let (json, binary) = chunks(&file);
        for (node, mesh) in json["nodes"].as_array().unwrap().iter().zip(json["meshes"].as_array().unwrap()) {
            let faces = floats(&json, binary, &mesh["primitives"][0]["attributes"]["_FACE"]);
            let is_lamp = node["extras"]["object"] == "lamp";
            assert_eq!(node["extras"]["material"], if is_lamp { "lamp" } else { "wall" });
            let group = if faces[0] < 3.0 { "three".into() } else { Value::Null };
            let is_like = |&face: &f32| face < 7.0 && (face == 6.0) == is_lamp && (face < 3.0) != group.is_null();
            assert!(node["extras"]["group"] == group && faces.iter().all(is_like));
        }
    }
}

/// Reads a Radiance picture with run-length encoded scan lines.
fn decode_hdr(file: &[u8]) -> (usize, usize, Vec<[f64; 3]>) {
    let head = file.windows(2).position(|two| two == b"\n\n").unwrap() + 2;
    let end = head + file[head..].iter().position(|&byte| byte == b'\n').unwrap();
    let size: Vec<&str> = std::str::from_utf8(&file[head..end]).unwrap().split(' ').collect();
    assert!(file.starts_with(b"#?RADIANCE\n") && size[0] == "-Y" && size[2] == "+X");
    let (height, width): (usize, usize) = (size[1].parse().unwrap(), size[3].parse().unwrap());
    let (mut at, mut pixels) = (end + 1, Vec::new());
    for _ in 0..height {
        let mut line = vec![[0_u8; 4]; width];
        if width < 8 {
            line.iter_mut().for_each(|pixel| {
                pixel.copy_from_slice(&file[at..at + 4]);
                at += 4;
            });
        } else {
            assert_eq!(file[at..at + 4], [2, 2, (width >> 8) as u8, width as u8]);
            at += 4;
            let planes: [usize; 4] = [0, 1, 2, 3];
            for plane in planes {
                let mut x = 0;
                while x < width {
                    let count = usize::from(file[at]);
                    let (count, step) = if count > 128 { (count - 128, 0) } else { (count, 1) };
                    (0..count).for_each(|k| line[x + k][plane] = file[at + 1 + step * k]);
                    x += count;
                    at += 2 + step * (count - 1);
                }
            }
        }
        let value = |mantissa: u8, exponent: u8| {
            if exponent == 0 { 0.0 } else { (f64::from(mantissa) + 0.5) * 2.0_f64.powi(i32::from(exponent) - 136) }
        };
        pixels.extend(line.iter().map(|&[r, g, b, e]| [r, g, b].map(|mantissa| value(mantissa, e))));
    }
    assert_eq!(at, file.len());
    (width, height, pixels)
}

#[test]
fn hdr_pictures_are_within_a_percent() {
    let provenance = Provenance::new(&SolveOptions::default());
    for (width, height, channels) in [(300, 4, 3), (5, 3, 3), (200, 2, 1)] {
        let mut image = Image::black(width, height, channels);
        let count = image.radiance.len();
        for (k, value) in image.radiance.iter_mut().enumerate() {
            // Runs, rows and a wide range.
            *value = if k % count < count / 3 { 0.25 } else { ((k * 7919 % 1000) as f32 / 100.0).exp() * 1e-3 };
        }
        let mut file = Vec::new();
        write_hdr(&mut file, &image, Quantity::Radiosity, &provenance).unwrap();
        let (read_width, read_height, pixels) = decode_hdr(&file);
        assert_eq!((read_width, read_height), (width as usize, height as usize));
        for (found, pixel) in pixels.iter().zip(image.pixels()) {
            let largest = f64::from(pixel.iter().copied().fold(0.0, f32::max)) * std::f64::consts::PI;
            for k in 0..3 {
                let expected = f64::from(pixel[k % channels]) * std::f64::consts::PI;
                assert!((found[k] - expected).abs() <= 0.005 * largest, "{found:?} {pixel:?}");
            }
        }
    }
    assert!(write_hdr(&mut Vec::new(), &Image::black(4, 4, 5), Quantity::Radiance, &provenance).is_err());
}
