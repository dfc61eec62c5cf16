//! Solutions of which a byte or a field was changed: what is still read can be asked for values, bounds, pictures and exports.

use patchlight::scene::{LightGrouping, Sides};
use patchlight::solve::{Bounds, Solution, SolveOptions, Solver};
use rayon::prelude::*;
use serde::Deserialize;
use serde_json::{Number, Value};

use super::triangles::Random;
use super::{harness, scene, solved, stored};

/// Solutions of several scenes by either solver, some with bounds, some with a lit mesh; so small that they are read often.
fn solutions() -> Vec<Solution> {
    let of = |name: &str, sides, solver, bounds, max_links| {
        let (point_rays, max_links) = (Some(4), Some(max_links));
        let bounds_work = Some(64);
        let options = SolveOptions { error: 0.9, solver, bounds, bounds_work, point_rays, max_links, ..SolveOptions::default() };
        solved(scene(name, sides), &options).solution().clone()
    };
    let with_mesh = |name: &str, solver| {
        let max_links = Some(100);
        let options = SolveOptions { error: 0.9, solver, lit_mesh: true, max_links, ..SolveOptions::default() };
        let solution = solved(scene(name, Sides::Front), &options).solution().clone();
        assert!(solution.mesh().is_some());
        solution
    };
    // The light of an emitter kept apart, by either solver.
    let with_groups = |name: &str, solver, lit_mesh| {
        let grouped = scene(name, Sides::Front).with_light_groups(&LightGrouping::Materials).unwrap();
        let options = SolveOptions { error: 0.9, solver, lit_mesh, max_links: Some(100), ..SolveOptions::default() };
        let solution = solved(grouped, &options).solution().clone();
        assert!(solution.light_groups_report().is_some_and(|report| report.error.estimate.is_finite()));
        solution
    };
    let with_transport = |name: &str| {
        let options = SolveOptions { error: 0.9, keep_transport: true, ..SolveOptions::default() };
        let solution = solved(scene(name, Sides::Front), &options).solution().clone();
        assert!(solution.transport().is_some());
        solution
    };
    vec![
        with_transport("furnace.obj"),
        with_transport("cornell.obj"),
        with_groups("furnace.obj", Solver::Links, true),
        with_groups("cornell.obj", Solver::Cells, false),
        of("furnace.obj", Sides::Front, Solver::Links, Bounds::Guaranteed, 1000),
        of("four_polygons.obj", Sides::Both, Solver::Links, Bounds::Guaranteed, 200),
        of("cornell.obj", Sides::Both, Solver::Links, Bounds::Estimate, 200),
        of("cornell.obj", Sides::Front, Solver::Cells, Bounds::Estimate, 200),
        of("two_rooms.obj", Sides::Front, Solver::Links, Bounds::Guaranteed, 100),
        with_mesh("furnace.obj", Solver::Links),
        with_mesh("cornell.obj", Solver::Cells),
    ]
}

#[test]
fn single_bytes_do_no_harm() {
    let (mut random, mut taken) = (Random(5), 0);
    for solution in solutions() {
        let body = stored(&solution).split_off(harness::HEADER);
        for _ in 0..60 {
            let mut changed = body.clone();
            let at = random.below(changed.len());
            changed[at] = [random.bits() as u8, 0, 1, 0x7f, 0x80, 0xff, changed[at] ^ 1, changed[at] ^ 0x40][random.below(8)];
            taken += u32::from(harness::read_body(&changed));
        }
    }
    // Some bytes may be anything: of a radiosity, say.
    assert!(taken > 20, "{taken}");
}

/// A way to every number, name, list and flag of a value.
fn places(value: &Value, path: &mut String, found: &mut Vec<String>) {
    found.push(path.clone());
    let length = path.len();
    let mut below = |key: &str, value: &Value| {
        *path += &format!("/{key}");
        places(value, path, found);
        path.truncate(length);
    };
    match value {
        Value::Array(items) => items.iter().enumerate().for_each(|(index, item)| below(&index.to_string(), item)),
        Value::Object(fields) => fields.iter().for_each(|(key, field)| below(key, field)),
        _ => {}
    }
}

/// Another value of about the same kind.
fn changed(value: &Value, random: &mut Random) -> Value {
    let whole =
        [0, 1, 2, 3, 7, 255, 1 << 16, (1 << 31) - 1, 1 << 31, u64::from(u32::MAX) - 1, u64::from(u32::MAX), 1 << 40, u64::MAX];
    let real = [0.0, -0.0, -1.0, 0.5, 1.0, 1e-300, 5e-324, -1e300, 1e300, f64::MAX, 1e-9, 1e9, 1e30, 1e40];
    match value {
        Value::Number(number) if number.is_f64() => {
            let own = number.as_f64().unwrap();
            let near = [own * 1.000_000_001, -own, own * 1e12, own * 1e-12];
            Value::from(if random.below(3) == 0 { near[random.below(4)] } else { real[random.below(real.len())] })
        }
        Value::Number(number) => {
            let own = number.as_u64().unwrap_or(0);
            let near = [own.wrapping_add(1), own.wrapping_sub(1), own / 2];
            Value::from(if random.below(3) == 0 { near[random.below(3)] } else { whole[random.below(whole.len())] })
        }
        Value::Null => Value::Number(Number::from(whole[random.below(whole.len())])),
        Value::Bool(flag) => Value::Bool(!flag),
        Value::Array(items) => {
            let mut items = items.clone();
            match random.below(4) {
                0 => items.clear(),
                1 => drop(items.pop()),
                2 => items.extend(items.last().cloned()),
                _ if items.len() > 1 => {
                    let at = random.below(items.len() - 1);
                    items.swap(at, at + 1);
                }
                _ => items.extend_from_within(..),
            }
            Value::Array(items)
        }
        other => other.clone(),
    }
}

/// Each of these would make the program fail, hang or show nonsense.
#[test]
fn meshes_that_are_none_are_refused() {
    let options = SolveOptions { error: 0.5, lit_mesh: true, ..SolveOptions::default() };
    let solution = solved(scene("furnace.obj", Sides::Front), &options).solution().clone();
    let value = serde_json::to_value(&solution).unwrap();
    let refused = |path: &str, change: &dyn Fn(&Value) -> Value, words: &str| {
        let mut value = value.clone();
        let place = value.pointer_mut(path).unwrap_or_else(|| panic!("{path}"));
        *place = change(place);
        let error = Solution::deserialize(&value).unwrap_err().to_string();
        assert!(error.contains(words), "{path}: {error}");
    };
    let number = |value: &Value| value.as_f64().unwrap();
    refused("/mesh/claimed", &|_| Value::from(-1.0), "error of the lit mesh");
    refused("/mesh/surfaces", &|of| Value::from(of.as_array().unwrap()[1..].to_vec()), "does not fit the scene");
    let surface = value["mesh"]["surfaces"].as_array().unwrap().iter().position(|of| !of.is_null()).unwrap();
    let of = |rest: &str| format!("/mesh/surfaces/{surface}/{rest}");
    refused(&of("triangles/0/0"), &|_| Value::from(u32::MAX), "an element is none");
    refused(&of("triangles/0/3"), &|_| value.pointer(&of("triangles/0/0")).unwrap().clone(), "an element is none");
    refused(
        &of("triangles/0"),
        &|nodes| Value::from([1, 0, 2, 3, 5, 4].map(|k: usize| nodes[k].clone()).to_vec()),
        "an element is none",
    );
    refused(&of("triangles"), &|all| Value::from(all.as_array().unwrap()[1..].to_vec()), "do not fill the polygon");
    refused(&of("triangles"), &|all| Value::from([&all.as_array().unwrap()[..]; 2].concat()), "do not fill the polygon");
    refused(&of("nodes/0/0"), &|x| Value::from(number(x) + 10.0), "outside of the polygon");
    refused(&of("reflected/0"), &|_| Value::from(3e38), "not finite at a node");
    refused(&of("reflected"), &|all| Value::from(all.as_array().unwrap()[1..].to_vec()), "too many or too few");
    refused(&of("errors"), &|all| Value::from(all.as_array().unwrap()[1..].to_vec()), "too many or too few standard errors");
    refused(&of("errors/0"), &|_| Value::from(-1.0), "a standard error is negative");
}

/// Light of groups that does not fit, or names that are none.
#[test]
fn light_groups_that_are_none_are_refused() {
    let scene = scene("cornell.obj", Sides::Front).with_light_groups(&LightGrouping::Materials).unwrap();
    let options = SolveOptions { error: 0.5, solver: Solver::Cells, lit_mesh: true, ..SolveOptions::default() };
    let value = serde_json::to_value(solved(scene, &options).solution()).unwrap();
    let refused = |path: &str, change: &dyn Fn(&Value) -> Value, words: &str| {
        let mut value = value.clone();
        let place = value.pointer_mut(path).unwrap_or_else(|| panic!("{path}"));
        *place = change(place);
        let error = Solution::deserialize(&value).unwrap_err().to_string();
        assert!(error.contains(words), "{path}: {error}");
    };
    let shorter = |all: &Value| Value::from(all.as_array().unwrap()[1..].to_vec());
    for (path, words) in [
        ("/scene/light_groups/of_material", "do not fit the scene"),
        ("/scene/light_groups/exitance", "do not fit the scene"),
        ("/scene/light_groups/names", "do not fit the scene"),
        ("/groups/leaves", "does not fit the scene"),
        ("/groups/reflected", "does not fit the scene"),
        ("/groups/cells/values", "does not fit the scene"),
        ("/groups/mesh", "does not fit the scene"),
        ("/groups/mesh_errors", "does not fit the scene"),
        ("/groups/errors/values", "does not fit the scene"),
        ("/groups/errors/light", "does not fit the scene"),
    ] {
        refused(path, &shorter, words);
    }
    refused("/groups/leaves/0", &|_| Value::from(1e300), "does not fit the scene");
    refused("/groups/reflected/0", &|_| Value::from(-1.0), "does not fit the scene");
    refused("/groups", &|_| Value::Null, "is missing, or of none");
    refused("/scene/light_groups", &|_| Value::Null, "is missing, or of none");
    refused("/scene/light_groups/weights/0/0", &|_| Value::from(2.0), "not what its light group says");
    refused("/scene/light_groups/weights/0/0", &|_| Value::from(-1.0), "do not fit the scene");
    refused("/scene/light_groups/names/0", &|_| Value::from(""), "names of their own");
}

/// What paths bring that does not fit, or comes from nowhere.
#[test]
fn transport_that_is_none_is_refused() {
    let options = SolveOptions { error: 0.5, keep_transport: true, ..SolveOptions::default() };
    let solution = solved(scene("cornell.obj", Sides::Front), &options).solution().clone();
    let mut materials = solution.scene().materials().to_vec();
    materials.iter_mut().for_each(|material| material.exitance.iter_mut().for_each(|e| *e *= 2.0));
    let (brighter, _) = solution.with_materials(materials, &patchlight::progress::Silent).unwrap().unwrap();
    for solution in [solution, brighter] {
        let value = serde_json::to_value(&solution).unwrap();
        let refused = |path: &str, change: &dyn Fn(&Value) -> Value| {
            let mut value = value.clone();
            let place = value.pointer_mut(path).unwrap_or_else(|| panic!("{path}"));
            *place = change(place);
            let error = Solution::deserialize(&value).unwrap_err().to_string();
            assert!(error.contains("transport does not fit") || error.contains("cell radiosities"), "{path}: {error}");
        };
        let shorter = |all: &Value| Value::from(all.as_array().unwrap()[1..].to_vec());
        for path in [
            "products/steps",
            "is_followed",
            "is_sampled",
            "reflected",
            "rows",
            "rows/0/material",
            "rows/3/ends/ends",
            "rows/0/ends/source",
            "rows/0/seen/ends",
            "rows/0/emission/weight",
            "rows/8/emission/product",
            "samples/surface",
            "samples/stands_for",
            "samples/residuals/ends",
            "samples/values/source",
        ] {
            refused(&format!("/transport/{path}"), &shorter);
        }
        for path in [
            "products/steps/0/0",
            "products/steps/0/1",
            "rows/0/material/0",
            "rows/2/ends/source/0",
            "rows/0/ends/product/0",
            "rows/0/emission/source/0",
            "rows/0/ends/ends/0",
            "samples/surface/0",
            "samples/residuals/source/0",
            "samples/values/product/0",
        ] {
            refused(&format!("/transport/{path}"), &|_| Value::from(4_000_000_000_u32));
        }
        refused("/transport/reflected/0", &|_| Value::from(-1.0));
        refused("/transport/samples/stands_for/0", &|_| Value::from(0.0));
        refused("/cell_radiosities", &|_| Value::Null);
    }
}

/// Changes fields of a solution at random, one by one, some of each kind; returns how many are taken, and how many refused.
fn change_fields(solution: &Solution, random: &mut Random) -> [u32; 2] {
    let mut value = serde_json::to_value(solution).unwrap();
    assert_eq!(Solution::deserialize(&value).unwrap(), *solution);
    let mut all = Vec::new();
    places(&value, &mut String::new(), &mut all);
    // A long list has many fields of one kind: each kind is chosen as often.
    let kind = |path: &str| path.split('/').filter(|key| key.parse::<u32>().is_err()).collect::<Vec<_>>().join("/");
    let mut by_kind = std::collections::BTreeMap::<String, Vec<String>>::new();
    all.into_iter().for_each(|path| by_kind.entry(kind(&path)).or_default().push(path));
    let mut counts = [0; 2];
    for paths in by_kind.values() {
        for _ in 0..2 {
            let path = &paths[random.below(paths.len())];
            let place = value.pointer_mut(path).unwrap();
            let other = changed(place, random);
            let before = std::mem::replace(place, other);
            let is_taken =
                Solution::deserialize(&value).is_ok_and(|mutated| harness::read_body(&stored(&mutated).split_off(harness::HEADER)));
            counts[usize::from(!is_taken)] += 1;
            *value.pointer_mut(path).unwrap() = before;
        }
    }
    counts
}

#[test]
fn single_fields_do_no_harm() {
    let changed = |(number, solution): (usize, Solution)| change_fields(&solution, &mut Random(6 + number as u64));
    let counts = solutions().into_par_iter().enumerate().map(changed);
    let [taken, refused] = counts.reduce(|| [0; 2], |a, b| [a[0] + b[0], a[1] + b[1]]);
    assert!(taken > 100 && refused > 200, "{taken} taken, {refused} refused");
}
