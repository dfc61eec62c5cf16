//! Reference cases from tests/fixtures: each has its name, its source and the digits that can be trusted. Their groups:
//! - A1: from a point to a polygon (Lambert's sum; Baum, Rushmeier, Winget 1989);
//! - A2: between rectangles (C-11 to C-15 of Howell's catalogue of configuration factors);
//! - A3: between any polygons (contour integral; Schroeder, Hanrahan 1993);
//! - A4: with something between. From `x` to `y` in parallel planes, blocked in a plane at the part t of the way, the change of variables
//!   `m = x + t (y - x)` makes of the blocked part a signed sum of the terms of Howell's C-13;
//! - A5: closed forms of the radiosity equation: furnaces, patches, concentric spheres;
//! - A6: continuous solutions by Nystroem's method, and a cube by collocation, good to some 2e-5.
#![allow(dead_code, reason = "each test uses a part")]

use serde_json::Value;

/// Form factors: groups A1 to A4.
pub fn form_factor_cases() -> Vec<Value> {
    cases(include_str!("../fixtures/exact_cases.json"))
}

/// Solutions of the radiosity equation: groups A5 and A6.
pub fn solution_cases() -> Vec<Value> {
    cases(include_str!("../fixtures/solution_cases.json"))
}

fn cases(text: &str) -> Vec<Value> {
    let all: Value = serde_json::from_str(text).unwrap();
    all["cases"].as_array().unwrap().clone()
}

/// The value of one case.
pub fn value(case: &Value) -> f64 {
    case["value"].as_str().unwrap().parse().unwrap()
}

/// The value of the solution case with this name and quantity.
pub fn solution_value(name: &str, quantity: &str) -> f64 {
    let fits = |case: &Value| case["name"] == name && case["quantity"] == quantity;
    value(solution_cases().iter().find(|case| fits(case)).unwrap_or_else(|| panic!("no case {name}, {quantity}")))
}

pub fn vector(value: &Value) -> [f64; 3] {
    std::array::from_fn(|k| value[k].as_f64().unwrap())
}

pub fn vectors(value: &Value) -> Vec<[f64; 3]> {
    value.as_array().unwrap().iter().map(vector).collect()
}
