//! Light groups and other materials as Python says them: dicts by name.

use patchlight::scene::{EmitterName, LightGrouping, LightWeight, Material, Scene};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::reals;
use crate::errors::Failure;

/// How lights are grouped: "material", "object", or a dict of groups by name, each a sequence of "material NAME", "object NAME" and "light NAME".
pub fn grouping(by: &Bound<'_, PyAny>) -> PyResult<LightGrouping> {
    if let Ok(named) = by.cast::<PyDict>() {
        let group = |(name, lights): (Bound<'_, PyAny>, Bound<'_, PyAny>)| -> PyResult<(String, Vec<EmitterName>)> {
            let parse = |text: String| text.parse::<EmitterName>().map_err(Failure::argument);
            let lights = lights.extract::<Vec<String>>()?.into_iter().map(parse).collect::<Result<_, _>>()?;
            Ok((name.extract()?, lights))
        };
        return Ok(LightGrouping::Named(named.iter().map(group).collect::<PyResult<_>>()?));
    }
    match by.extract::<String>().as_deref() {
        Ok("material") => Ok(LightGrouping::Materials),
        Ok("object") => Ok(LightGrouping::Objects),
        _ => Err(Failure::argument("by must be 'material', 'object' or a dict of groups by name").into()),
    }
}

/// Numbers by channel: one for all of them, or one for each.
fn by_channel(numbers: &Bound<'_, PyAny>, channels: usize, name: &str) -> PyResult<Vec<f64>> {
    let numbers: Vec<f64> = reals(numbers, name)?.as_array().iter().copied().collect();
    match numbers.len() {
        1 => Ok(vec![numbers[0]; channels]),
        count if count == channels => Ok(numbers),
        count => Err(Failure::argument(format_args!("{name} has {count} numbers, it must have one, or {channels}")).into()),
    }
}

/// Weights of light groups, by name.
pub fn weights(weights: &Bound<'_, PyDict>, channels: usize) -> PyResult<Vec<LightWeight>> {
    let weight = |(group, numbers): (Bound<'_, PyAny>, Bound<'_, PyAny>)| {
        let group: String = group.extract()?;
        let by_band = by_channel(&numbers, channels, &format!("the weight of group '{group}'"))?;
        Ok(LightWeight { group, by_band })
    };
    weights.iter().map(weight).collect()
}

/// The materials of a scene, those changed that are named.
pub fn materials(
    scene: &Scene,
    reflectance: Option<&Bound<'_, PyDict>>,
    exitance: Option<&Bound<'_, PyDict>>,
) -> PyResult<Vec<Material>> {
    let mut materials = scene.materials().to_vec();
    type Property = fn(&mut Material) -> &mut Vec<f64>;
    let properties: [(_, &str, Property); 2] = [
        (reflectance, "reflectance", |material| &mut material.reflectance),
        (exitance, "exitance", |material| &mut material.exitance),
    ];
    for (changes, what, property) in properties {
        for (name, numbers) in changes.into_iter().flatten() {
            let name: String = name.extract()?;
            let numbers = by_channel(&numbers, scene.channels(), &format!("the {what} of '{name}'"))?;
            let mut is_known = false;
            for material in materials.iter_mut().filter(|material| material.name == name) {
                property(material).clone_from(&numbers);
                is_known = true;
            }
            if !is_known {
                return Err(Failure::argument(format_args!("{what}: there is no material '{name}'")).into());
            }
        }
    }
    Ok(materials)
}
