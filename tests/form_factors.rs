//! Form factors against closed forms, identities and references of their own.

use std::collections::BTreeMap;

use patchlight::form_factor::{exact_area_form_factor, point_form_factor};
use patchlight::geometry::Polygon;
use serde_json::Value;

/// The reference values of groups A1 to A4 (each with its source), as far as they concern form factors.
const CASES: &str = include_str!("fixtures/exact_cases.json");

fn vector(value: &Value) -> [f64; 3] {
    let number = |k: usize| value[k].as_f64().unwrap();
    [number(0), number(1), number(2)]
}

fn polygon(value: &Value) -> Polygon {
    Polygon::new(&value.as_array().unwrap().iter().map(vector).collect::<Vec<_>>()).unwrap()
}

#[test]
fn every_reference_case_through_the_exact_path() {
    let cases: Value = serde_json::from_str(CASES).unwrap();
    let mut counts = BTreeMap::new();
    let mut worst = Vec::new();
    for case in cases["cases"].as_array().unwrap() {
        let (name, group) = (case["name"].as_str().unwrap(), case["group"].as_str().unwrap());
        *counts.entry(group).or_insert(0) += 1;
        let geometry = &case["geometry"];
        let polygons = &geometry["polygons"];
        let value = match group {
            "A1" => {
                let (x, normal) = (vector(&geometry["receiver_point"]), vector(&geometry["receiver_normal"]));
                point_form_factor(x, normal, &polygon(&polygons["emitter"]))
            }
            "A2" | "A3" => {
                let (p1, p2) = (polygon(&polygons["P1"]), polygon(&polygons["P2"]));
                let exchange = exact_area_form_factor(&p1, &p2);
                assert_eq!(exchange.to_bits(), exact_area_form_factor(&p2, &p1).to_bits(), "{name} is not symmetric");
                exchange / p1.area()
            }
            // Occluded: those need rays.
            "A4" => continue,
            other => panic!("{name} is of unknown group {other}"),
        };
        let expected: f64 = case["value"].as_str().unwrap().parse().unwrap();
        let error = if expected == 0.0 { value.abs() / 1e-14 } else { (value / expected - 1.0).abs() / if name.starts_with("sliver") { 1e-6 } else { 1e-10 } };
        println!("{name}: {value:e} {error:e}");
        if !(error <= 1.0) { worst.push(name); }
    }
    assert_eq!(counts, BTreeMap::from([("A1", 13), ("A2", 11), ("A3", 5), ("A4", 11)]));
    assert!(worst.is_empty(), "{worst:?}");
}
