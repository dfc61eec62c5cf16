//! Lights that are no surfaces (Khronos, KHR_lights_punctual).
//!
//! Point lights and spots are given in candelas, directional ones in lux, times a linear colour; both are divided by [`LUMENS_PER_WATT`], as everywhere
//! here. A light stands where its node stands and looks along the node's -z; scale has no part but in that. Range is left out, since light does not
//! end.

use std::f64::consts::FRAC_PI_4;

use glam::DVec3;
use serde::Deserialize;

use super::container::shown;
use super::json::Root;
use super::nodes::Placed;
use crate::scene::{Distribution, LUMENS_PER_WATT, Light, LightError, LightShape, PointLight, Spot, Sun};

#[derive(Deserialize)]
#[serde(default)]
struct Punctual {
    name: Option<String>,
    color: [f64; 3],
    intensity: f64,
    #[serde(rename = "type")]
    kind: String,
    range: Option<f64>,
    spot: Cone,
}

impl Default for Punctual {
    fn default() -> Self {
        Self { name: None, color: [1.0; 3], intensity: 1.0, kind: String::new(), range: None, spot: Cone::default() }
    }
}

/// Angles to the axis in radians.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase", default)]
struct Cone {
    inner_cone_angle: f64,
    outer_cone_angle: f64,
}

impl Default for Cone {
    fn default() -> Self {
        Self { inner_cone_angle: 0.0, outer_cone_angle: FRAC_PI_4 }
    }
}

/// The lights of a scene, and what is worth knowing of them.
pub(super) fn read(root: &Root, placed: &Placed) -> Result<(Vec<Light>, Vec<String>), String> {
    let all = root.extensions.get("KHR_lights_punctual").and_then(|extension| extension.get("lights")?.as_array());
    let (mut lights, mut with_range) = (Vec::with_capacity(placed.lights.len()), 0);
    for (name, number, to_world) in &placed.lights {
        let wrong = |reason: String| format!("light {number}, of '{name}': {reason}");
        let count = all.map_or(0, Vec::len);
        let value = all.and_then(|all| all.get(*number)).ok_or_else(|| wrong(format!("it does not exist: there are {count}")))?;
        let light = Punctual::deserialize(value).map_err(|error| wrong(error.to_string()))?;
        with_range += usize::from(light.range.is_some());
        let towards = to_world.transform_vector3(DVec3::NEG_Z);
        let shape = shape(&light, to_world.translation, towards).map_err(wrong)?;
        let strength = light.color.iter().map(|channel| channel * light.intensity / LUMENS_PER_WATT).collect();

        // By its node, and its own name where that is another.
        let mut full = name.clone();
        if let Some(own) = light.name.as_deref().map(shown).filter(|own| !own.is_empty() && own != name) {
            full += &format!("/{own}");
        }
        let light = Light { name: full, strength, shape };
        light.wrong(3).map_or(Ok(()), |reason| Err(wrong(reason)))?;
        lights.push(light);
    }
    let mut notes = Vec::new();
    if !lights.is_empty() {
        let count = lights.len();
        notes.push(format!("{count} lights (KHR_lights_punctual): their candelas and lux are divided by {LUMENS_PER_WATT} lm/W"));
    }
    if with_range > 0 {
        notes.push(format!("the range of {with_range} lights is left out: their light falls off with the square of the distance"));
    }
    Ok((lights, notes))
}

fn shape(light: &Punctual, position: DVec3, towards: DVec3) -> Result<LightShape, String> {
    let said = |error: LightError| error.to_string();
    match light.kind.as_str() {
        "point" => Ok(LightShape::Point(PointLight::uniform(position.to_array()))),
        "spot" => {
            let Cone { inner_cone_angle, outer_cone_angle } = light.spot;
            let spot = Spot::new(towards.to_array(), inner_cone_angle, outer_cone_angle).map_err(said)?;
            Ok(LightShape::Point(PointLight::new(position.to_array(), Distribution::Spot(spot))))
        }
        "directional" => Ok(LightShape::Sun(Sun::new((-towards).to_array(), 0.0).map_err(said)?)),
        other => Err(format!("its type is '{}', it must be point, spot or directional", shown(other))),
    }
}
