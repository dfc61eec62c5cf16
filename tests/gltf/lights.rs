//! Lights that are no surfaces (KHR_lights_punctual).

use std::f64::consts::{FRAC_1_SQRT_2, PI};

use patchlight::scene::{Distribution, LightShape};
use serde_json::json;

use super::{DiagnosticKind, read, small_room, texts};

/// The small room with these lights, each at a node of its own, with what else the node says.
fn with(lights: &[(serde_json::Value, serde_json::Value)]) -> Vec<u8> {
    let mut maker = small_room();
    maker.json["extensionsUsed"] = json!(["KHR_lights_punctual"]);
    let all: Vec<_> = lights.iter().map(|(light, _)| light).collect();
    maker.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": all } });
    for (number, (_, node)) in lights.iter().enumerate() {
        let mut node = node.clone();
        node["extensions"] = json!({ "KHR_lights_punctual": { "light": number } });
        maker.node(node);
    }
    maker.glb()
}

#[test]
fn lights_stand_and_look_as_their_nodes_do() {
    let cone = json!({ "innerConeAngle": 0.25, "outerConeAngle": 0.5 });
    let file = with(&[
        (
            json!({ "type": "point", "color": [1, 0.5, 0], "intensity": 358 }),
            json!({ "name": "bulb", "translation": [1, 2, 0.5], "scale": [3, 3, 3] }),
        ),
        (
            json!({ "type": "spot", "name": "cone", "intensity": 179, "spot": cone, "range": 5 }),
            json!({ "name": "lamp", "scale": [2, 2, 2] }),
        ),
        // A quarter of a turn about x turns -z to y.
        (json!({ "type": "directional" }), json!({ "rotation": [FRAC_1_SQRT_2, 0.0, 0.0, FRAC_1_SQRT_2] })),
    ]);
    let imported = read(&file).unwrap();
    let lights = imported.scene.lights();
    let names: Vec<(&str, &str)> = lights.iter().map(|light| (light.name.as_str(), light.kind())).collect();
    assert_eq!(names[..2], [("bulb", "point"), ("lamp/cone", "spot")]);
    assert!(names[2].0.starts_with("node ") && names[2].1 == "sun");

    // 179 lm/W, whatever the scale; 2 pi (1 - cos i) and 2 pi / 3 of the falloff.
    assert_eq!(lights[0].strength, [2.0, 1.0, 0.0]);
    let LightShape::Point(bulb) = &lights[0].shape else { panic!() };
    assert!(bulb.position() == [1.0, 2.0, 0.5] && *bulb.distribution() == Distribution::Uniform);
    let expected = 2.0 * PI * (1.0 - 0.25_f64.cos() + (0.25_f64.cos() - 0.5_f64.cos()) / 3.0);
    assert!((lights[1].flux().unwrap()[1] - expected).abs() < 1e-12);
    let LightShape::Sun(sun) = &lights[2].shape else { panic!() };
    let off: f64 = sun.towards().iter().zip([0.0, -1.0, 0.0]).map(|(a, b)| (a - b).abs()).sum();
    assert!(off < 1e-12 && sun.diameter() == 0.0, "{sun:?}");
    assert_eq!(lights[2].strength, [1.0 / 179.0; 3]);

    let notes: Vec<String> =
        texts(&imported).into_iter().filter(|(kind, _)| *kind == DiagnosticKind::Light).map(|(_, text)| text).collect();
    assert_eq!(
        notes,
        [
            "3 lights (KHR_lights_punctual): their candelas and lux are divided by 179 lm/W",
            "the range of 1 lights is left out: their light falls off with the square of the distance"
        ]
    );
}

#[test]
fn what_is_no_light_is_told() {
    for (light, node, words) in [
        (json!({ "type": "area" }), json!({ "name": "a" }), "light 0, of 'a': its type is 'area'"),
        (json!({ "type": "point", "intensity": -1 }), json!({ "name": "a" }), "light 0, of 'a': strength -"),
        (json!({ "type": "point", "intensity": "x" }), json!({ "name": "a" }), "light 0, of 'a': invalid type"),
        (
            json!({ "type": "spot", "spot": { "outerConeAngle": 2.0 } }),
            json!({ "name": "a" }),
            "light 0, of 'a': its cones are not",
        ),
        (
            json!({ "type": "directional" }),
            json!({ "name": "a", "scale": [0, 0, 0] }),
            "light 0, of 'a': its direction is no vector",
        ),
    ] {
        let error = read(&with(&[(light, node)])).unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    }
    let mut maker = small_room();
    maker.node(json!({ "name": "a", "extensions": { "KHR_lights_punctual": { "light": 4 } } }));
    let error = read(&maker.glb()).unwrap_err().to_string();
    assert!(error.contains("light 4, of 'a': it does not exist: there are 0"), "{error}");
}
