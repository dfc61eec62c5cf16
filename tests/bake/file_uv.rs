//! Lightmaps that a file lays out by its second texture coordinates.

use std::f64::consts::PI;

use patchlight::bake::{Atlas, BakeError, FaceOnAtlas, LightPart, UvProblem};
use patchlight::output::{Provenance, write_lightmap_glb};
use patchlight::progress::Silent;
use patchlight::scene::import::{ImportOptions, Imported, read_scene};
use patchlight::solve::SolveOptions;
use serde_json::json;

use super::files::chunks;
use super::glb::Maker;
use super::light::lambert;
use super::rooms::solve;
use super::triangles::{add, times};
use super::{BakeOptions, apart, options, texel};

type Uv = fn([f32; 3]) -> [f32; 2];

const FLAT: Uv = |[x, y, _]| [0.05 + 0.2 * x, 0.05 + 0.2 * y];
const MIRRORED: Uv = |[x, y, _]| [0.95 - 0.2 * x, 0.5 + 0.2 * y];
const LAMP: Uv = |[x, y, _]| [0.6 + 0.2 * (x - 0.6), 0.05 + 0.2 * (y - 0.4)];

/// An L-shaped floor, a concave face that is unfolded in two pieces, under a lamp.
fn l_shape([flat, mirrored, lamp]: [Option<Uv>; 3]) -> Imported {
    let mut maker = Maker::new();
    let floor = maker.add("materials", json!({ "pbrMetallicRoughness": { "baseColorFactor": [0.8, 0.8, 0.8, 1.0] } }));
    let light = maker.add(
        "materials",
        json!({ "pbrMetallicRoughness": { "baseColorFactor": [0.0, 0.0, 0.0, 1.0] }, "emissiveFactor": [1.0, 1.0, 1.0] }),
    );
    let l = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]].map(|[x, y]| [x, y, 0.0]);
    let of = |corners: [usize; 4]| corners.map(|k| l[k]).to_vec();
    let halves = [(of([0, 1, 2, 3]), flat), (of([0, 3, 4, 5]), mirrored)];
    let above = vec![[0.6, 0.4, 0.7], [0.6, 0.9, 0.7], [1.1, 0.9, 0.7], [1.1, 0.4, 0.7]];
    for (parts, material) in [(halves.to_vec(), floor), (vec![(above, lamp)], light)] {
        let corners: Vec<[f32; 3]> = parts.iter().flat_map(|(corners, _)| corners.clone()).collect();
        let mut attributes = json!({ "POSITION": maker.floats(&corners) });
        let uv = parts.iter().map(|(corners, uv)| corners.iter().map(|&at| Some((*uv)?(at))).collect::<Option<Vec<_>>>());
        let uv = uv.collect::<Option<Vec<Vec<[f32; 2]>>>>();
        if let Some(uv) = uv {
            attributes["TEXCOORD_1"] = json!(maker.floats(&uv.concat()));
        }
        let indices: Vec<u32> = (0..parts.len() as u32).flat_map(|k| [0, 1, 2, 0, 2, 3].map(|corner| 4 * k + corner)).collect();
        let indices = maker.indices(&indices);
        let mesh = maker.mesh(json!({ "attributes": attributes, "indices": indices, "material": material }));
        maker.node(json!({ "mesh": mesh }));
    }
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("l.glb");
    std::fs::write(&file, maker.glb()).unwrap();
    read_scene(&file, &ImportOptions { keep_uv: true, ..ImportOptions::default() }).unwrap()
}

/// The texels whose middles lie well within a triangle, with the points there.
fn middles(face: &FaceOnAtlas, [width, height]: [u32; 2]) -> Vec<([f64; 2], [f64; 3])> {
    let at: Vec<[f64; 2]> = face.uv.iter().map(|uv| [uv[0] * f64::from(width), uv[1] * f64::from(height)]).collect();
    let doubled = |a: [f64; 2], b: [f64; 2], c: [f64; 2]| (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    let whole = doubled(at[0], at[1], at[2]);
    let mut found = Vec::new();
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        let middle = [f64::from(x) + 0.5, f64::from(y) + 0.5];
        let weights = [0, 1, 2].map(|k| doubled(middle, at[(k + 1) % 3], at[(k + 2) % 3]) / whole);
        if weights.iter().all(|weight| *weight > 0.02) {
            let corner = |k: usize| times(face.vertices[k], weights[k]);
            found.push((middle, add(corner(0), add(corner(1), corner(2)))));
        }
    }
    found
}

#[test]
fn texels_lie_where_the_file_says_mirrored_or_not_and_hold_lamberts_light() {
    let Imported { scene, uv, .. } = l_shape([Some(FLAT), Some(MIRRORED), Some(LAMP)]);
    // The floor is one concave face, cut into convex ones.
    assert_eq!((scene.surfaces()[0].face, scene.surfaces()[1].face, uv.triangles.len()), (0, 0, 6));
    let evaluator = solve(scene, &SolveOptions { error: 0.02, ..SolveOptions::default() }).0;
    let scene = evaluator.solution().scene();
    let atlas = Atlas::of_file(scene, &uv, &BakeOptions { separate: true, ..options(0.02) }).unwrap();
    // 3.25 m^2 on 0.13 of the page: 5 m are 250 texels, in blocks of four 252.
    assert_eq!((atlas.pages(), atlas.charts()), (&[[252, 252]][..], 3));
    let lightmap = evaluator.bake(&atlas, None, &Silent).unwrap().unwrap();

    let lamp: Vec<[f64; 3]> = scene.surfaces().last().unwrap().polygon.vertices().collect();
    let faces: Vec<FaceOnAtlas> = atlas.faces(scene).collect();
    assert_eq!(faces.len(), 6);
    let mut pairs = Vec::new();
    for face in &faces {
        let texels = middles(face, [252, 252]);
        assert!(texels.len() > 10);
        let is_floor = face.vertices[0][2] == 0.0;
        pairs.extend(texels.into_iter().map(|(at, point)| {
            let exact = if is_floor { 0.8 * PI * lambert(point, &lamp) } else { PI };
            (texel(&lightmap, 0, at)[1], exact)
        }));
    }
    // The floor's 3 m^2, without what lies at edges.
    assert!(pairs.len() > 5500, "{}", pairs.len());
    let (mean, most) = apart(pairs.into_iter());
    assert!(mean < 0.006 && most < 0.06, "{mean} {most}");

    // All of this light is direct; irradiance is that over the reflectance, padding included.
    let irradiance = lightmap.irradiance_of(scene, LightPart::Direct, 0).unwrap();
    let lit = lightmap.pages[0].radiance.iter().zip(&irradiance.radiance).filter(|(_, h)| **h > 0.0);
    let (_, most) = apart(lit.map(|(&b, &h)| (f64::from(h) * 0.8, f64::from(b))));
    assert!(most < 1e-5, "{most}");
    let lit = irradiance.radiance.iter().filter(|h| **h > 0.0).count() / 3;
    assert!(lit as u64 > lightmap.report.texels, "{lit} texels have light, padding included: {:?}", lightmap.report);

    // Written, the coordinates are those of the file.
    let mut glb = Vec::new();
    write_lightmap_glb(&mut glb, scene, &lightmap, 0.0, &Provenance::new(evaluator.solution().options())).unwrap();
    let (json, binary) = chunks(&glb);
    let mut written: Vec<[u32; 2]> = Vec::new();
    for mesh in json["meshes"].as_array().unwrap() {
        let number = mesh["primitives"][0]["attributes"]["TEXCOORD_1"].as_u64().unwrap() as usize;
        let view = &json["bufferViews"][json["accessors"][number]["bufferView"].as_u64().unwrap() as usize];
        let [start, length] = ["byteOffset", "byteLength"].map(|key| view[key].as_u64().unwrap() as usize);
        let words = binary[start..start + length].chunks(4).map(|word| u32::from_le_bytes(word.try_into().unwrap()));
        written.extend(words.collect::<Vec<u32>>().chunks(2).map(|two| [two[0], two[1]]));
    }
    let mut of_file: Vec<[u32; 2]> =
        uv.triangles.iter().flat_map(|triangle| triangle.uv.map(|uv| uv.map(|x| (x as f32).to_bits()))).collect();
    written.sort_unstable();
    of_file.sort_unstable();
    assert_eq!(written, of_file);
}

#[test]
fn what_a_file_lays_out_wrong_is_refused_with_the_face() {
    let refused = |uv: [Option<Uv>; 3]| {
        let imported = l_shape(uv);
        match Atlas::of_file(&imported.scene, &imported.uv, &options(0.02)) {
            Err(BakeError::Uv(why)) => why,
            other => panic!("{other:?}"),
        }
    };
    let (flat, mirrored, lamp) = (Some(FLAT), Some(MIRRORED), Some(LAMP));
    assert_eq!(refused([flat, mirrored, None]), UvProblem::Without { face: 5 });
    assert_eq!(refused([None; 3]), UvProblem::Without { face: 1 });
    assert!(matches!(refused([flat, flat, flat]), UvProblem::Overlap { faces: [1, 5], .. }));
    let beside: Uv = |[x, y, _]| [0.1 + x, y];
    assert!(matches!(refused([flat, Some(beside), lamp]), UvProblem::Outside { face: 1, uv } if uv[0] > 1.0));
    let line: Uv = |[x, ..]| [x / 4.0, x / 4.0];
    assert_eq!(refused([Some(line), mirrored, lamp]), UvProblem::NoArea { face: 1 });

    // Pages have limits, whoever lays them out.
    let imported = l_shape([flat, mirrored, lamp]);
    let small = BakeOptions { size: 64, ..options(0.02) };
    assert!(matches!(Atlas::of_file(&imported.scene, &imported.uv, &small), Err(BakeError::PageTooLarge { size: 64, .. })));
}
