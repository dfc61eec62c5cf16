//! Scenes as three.js' GLTFExporter writes them: what is in them, by three.js' own reckoning.

use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::process::Command;

use patchlight::scene::import::{ImportOptions, read_scene};
use patchlight::scene::{Distribution, LUMENS_PER_WATT, LightShape, PointLight, Scene, Spot, Sun};
use serde_json::Value;

use super::{is_there, json_of, run};

/// By the name of a material: area, moment of area, and flux of the position through the fronts.
fn sums(scene: &Scene) -> BTreeMap<String, [f64; 5]> {
    let mut sums: BTreeMap<String, [f64; 5]> = BTreeMap::new();
    for surface in scene.surfaces() {
        let (area, centre, normal) = (surface.polygon.area(), surface.polygon.centroid(), surface.polygon.normal());
        let flux: f64 = (0..3).map(|k| area * centre[k] * normal[k]).sum();
        let of = sums.entry(scene.materials()[surface.material as usize].name.clone()).or_default();
        let [x, y, z] = centre.map(|x| area * x);
        of.iter_mut().zip([area, x, y, z, flux]).for_each(|(sum, more)| *sum += more);
    }
    sums
}

/// Reflectance and exitance of a material, the means over its area.
fn means(scene: &Scene, name: &str) -> [Vec<f64>; 2] {
    let (mut sums, mut whole) = ([vec![0.0; 3], vec![0.0; 3]], 0.0);
    for surface in scene.surfaces() {
        let material = &scene.materials()[surface.material as usize];
        if material.name == name {
            whole += surface.polygon.area();
            for (sum, values) in sums.iter_mut().zip([&material.reflectance, &material.exitance]) {
                sum.iter_mut().zip(values).for_each(|(sum, value)| *sum += surface.polygon.area() * value);
            }
        }
    }
    sums.map(|sum| sum.iter().map(|value| value / whole).collect())
}

#[test]
fn scenes_by_three_js_are_what_three_js_says() {
    let mut check = Command::new("node");
    check.args(["-e", "require('three'); require('zlib').crc32('')"]);
    if !is_there(check, "three, a package of Node.js (which must be 20.15 or newer),") {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("three.glb");
    let said = json_of(&run(Command::new("node"), "three_scene.js", &[&file]));
    println!("three.js {}", said["revision"]);
    let scene = read_scene(&file, &ImportOptions::default()).unwrap().scene;

    // Nested, mirrored, copied: each material has its area in its place, and its fronts face as they do there.
    let (sums, expected) = (sums(&scene), said["materials"].as_object().unwrap());
    assert_eq!(sums.keys().collect::<Vec<_>>().len(), expected.len(), "{:?}", sums.keys());
    for (name, of) in expected {
        let number = |value: &Value| value.as_f64().unwrap();
        let moment = &of["moment"];
        let of = [&of["area"], &moment[0], &moment[1], &moment[2], &of["flux"]].map(number);
        let off = sums[name].iter().zip(of).map(|(found, expected)| (found - expected).abs()).fold(0.0, f64::max);
        assert!(off <= 1e-5 * of[0], "{name}: {:?}, expected {of:?}", sums[name]);
    }

    // Colours are linear, textures averaged; radiances become exitances.
    let glow = |strength: f64| [1.0, 0.5, 0.25].map(|channel| PI * strength * channel);
    for (name, reflectance, exitance) in [
        ("floor", [0.25; 3], [0.0; 3]),
        ("mirrored", [0.25, 0.5, 0.75], [0.0; 3]),
        ("curtain", [0.75, 0.5, 0.25], [0.0; 3]),
        ("chair", [0.5, 0.25, 0.125], [0.0; 3]),
        ("lamp", [0.0; 3], glow(4.0)),
        ("dim", [0.0; 3], glow(0.5)),
    ] {
        for (found, expected) in means(&scene, name).iter().zip([reflectance, exitance]) {
            assert!(found.iter().zip(expected).all(|(found, expected)| (found - expected).abs() < 1e-6), "{name}: {found:?}");
        }
    }

    // Lights where they stand, in W/sr and W/m^2.
    let spot = Spot::new([0.0, 0.0, -1.0], 0.25, 0.5).unwrap();
    let expected = [
        ("bulb", vec![358.0, 179.0, 89.5], LightShape::Point(PointLight::uniform([1.0, 2.5, 1.0]))),
        ("spot", vec![179.0; 3], LightShape::Point(PointLight::new([1.0, 2.0, 3.0], Distribution::Spot(spot)))),
        ("sun", vec![895.0; 3], LightShape::Sun(Sun::new([0.0, 0.0, 1.0], 0.0).unwrap())),
    ];
    assert_eq!(scene.lights().len(), expected.len());
    for (light, (name, strength, shape)) in scene.lights().iter().zip(expected) {
        assert_eq!((light.name.as_str(), &light.shape), (name, &shape));
        let off = light.strength.iter().zip(&strength).map(|(found, candela)| (found * LUMENS_PER_WATT / candela - 1.0).abs());
        assert!(off.fold(0.0, f64::max) < 1e-12, "{name}: {:?}", light.strength);
    }
}
