//! What files of lightmaps hold.

use std::f64::consts::PI;

use patchlight::bake::{BakeOptions, FaceOnAtlas, Lightmap};
use patchlight::output::{LightmapCode, Provenance, Quantity, write_lightmap_glb, write_lightmap_json, write_lightmap_png};
use patchlight::pipeline::Evaluator;

use super::rooms::crowded;
use super::{baked, options};

/// JSON and binary chunk of a GLB.
pub fn chunks(file: &[u8]) -> (serde_json::Value, &[u8]) {
    let number = |at: usize| u32::from_le_bytes(file[at..at + 4].try_into().unwrap()) as usize;
    assert_eq!((&file[..4], number(4), number(8)), (&b"glTF"[..], 2, file.len()));
    (serde_json::from_slice(&file[20..20 + number(12)]).unwrap(), &file[28 + number(12)..])
}

fn pixels(png: &[u8]) -> (u32, Vec<u8>) {
    let mut reader = png::Decoder::new(std::io::Cursor::new(png)).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut bytes).unwrap();
    bytes.truncate(info.buffer_size());
    (info.width, bytes)
}

/// Few boxes on several pages.
fn pages() -> (Evaluator, Lightmap) {
    baked(crowded(2, 5), &BakeOptions { size: 96, ..options(0.1) })
}

#[test]
fn a_glb_has_a_primitive_for_each_page_and_shows_it() {
    let (evaluator, lightmap) = pages();
    let (solution, scene) = (evaluator.solution(), evaluator.solution().scene());
    let provenance = Provenance::new(solution.options());
    let faces: Vec<FaceOnAtlas> = lightmap.atlas.faces(scene).collect();
    assert!(lightmap.pages.len() > 1);

    // GLB: a primitive for each page, with coordinates that both sets share, and a texture that is the page.
    let mut glb = Vec::new();
    write_lightmap_glb(&mut glb, scene, &lightmap, 0.5, &provenance).unwrap();
    let (json, binary) = chunks(&glb);
    let view = |number: &serde_json::Value| {
        let view = &json["bufferViews"][number.as_u64().unwrap() as usize];
        let [start, length] = ["byteOffset", "byteLength"].map(|key| view[key].as_u64().unwrap() as usize);
        &binary[start..start + length]
    };
    let mut corners = 0;
    for mesh in json["meshes"].as_array().unwrap() {
        let primitive = &mesh["primitives"][0];
        assert_eq!(primitive["attributes"]["TEXCOORD_0"], primitive["attributes"]["TEXCOORD_1"]);
        let accessor = &json["accessors"][primitive["attributes"]["TEXCOORD_1"].as_u64().unwrap() as usize];
        assert_eq!((&accessor["type"], &accessor["componentType"]), (&"VEC2".into(), &5126.into()));
        let uv: Vec<f32> =
            view(&accessor["bufferView"]).chunks(4).map(|word| f32::from_le_bytes(word.try_into().unwrap())).collect();
        let page = primitive["material"].as_u64().unwrap() as usize;
        let expected: Vec<f32> =
            faces.iter().filter(|face| face.page == page).flat_map(|face| face.uv.as_flattened()).map(|&x| x as f32).collect();
        assert_eq!(uv, expected);
        corners += uv.len() / 2;
    }
    assert_eq!(corners, faces.iter().map(|face| face.uv.len()).sum::<usize>());
    let srgb = |x: f64| if x <= 0.0031308 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 };
    for (number, image) in json["images"].as_array().unwrap().iter().enumerate() {
        let (width, bytes) = pixels(view(&image["bufferView"]));
        assert_eq!(width, lightmap.pages[number].width);
        for (byte, &radiance) in bytes.iter().zip(&lightmap.pages[number].radiance) {
            let expected = 255.0 * srgb((f64::from(radiance) * 2.0_f64.sqrt()).min(1.0));
            assert!((f64::from(*byte) - expected).abs() <= 0.51, "{byte} {expected}");
        }
    }
}

#[test]
fn rgbm_and_json_say_the_same_as_the_lightmap() {
    let (evaluator, lightmap) = pages();
    let (solution, scene) = (evaluator.solution(), evaluator.solution().scene());
    let provenance = Provenance::new(solution.options());
    let faces: Vec<FaceOnAtlas> = lightmap.atlas.faces(scene).collect();

    // RGBM gives the numbers back to half a step.
    let range = PI * f64::from(lightmap.pages.iter().flat_map(|page| &page.radiance).fold(0.0_f32, |most, &x| most.max(x)));
    let mut rgbm = Vec::new();
    write_lightmap_png(&mut rgbm, &lightmap.pages[0], (Quantity::Radiosity, LightmapCode::Rgbm { range }), &provenance).unwrap();
    for (pixel, radiance) in pixels(&rgbm).1.chunks(4).zip(lightmap.pages[0].pixels()) {
        let factor = f64::from(pixel[3]) / 255.0 * range / 255.0;
        for (byte, &radiance) in pixel.iter().zip(radiance) {
            assert!((f64::from(*byte) * factor - PI * f64::from(radiance)).abs() <= 0.501 * factor);
        }
    }

    // JSON: every face with its corners.
    let mut json = Vec::new();
    write_lightmap_json(&mut json, scene, &lightmap, Quantity::Radiosity, &provenance).unwrap();
    let json: serde_json::Value = serde_json::from_slice(&json).unwrap();
    let listed = json["faces"].as_array().unwrap();
    assert_eq!((listed.len(), json["pages"].as_array().unwrap().len()), (faces.len(), lightmap.pages.len()));
    for (told, face) in listed.iter().zip(&faces) {
        let uv: Vec<[f64; 2]> = serde_json::from_value(told["uv"].clone()).unwrap();
        assert!(uv.as_flattened().iter().zip(face.uv.as_flattened()).all(|(told, own)| (told - own).abs() < 1e-12));
        assert_eq!(told["face"], u64::from(scene.surfaces()[face.surface as usize].face) + 1);
    }
}
