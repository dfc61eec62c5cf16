//! Occluded form factors with closed forms (group A4 of tests/fixtures), through the general path: links whose visibility is sampled by
//! rays, and gathers at points over them.
//!
//! The source emits 1, the receiver reflects 1/2 and nothing else reflects, so `2 B` on the receiver is the visible form factor. The blocker is
//! a thin black sheet.
//!
//! # Confidence
//! A form factor is the exact unoccluded one less the blocked part, which is sampled: `A_s / n` times the sum of the kernel k over those of
//! n samples that are blocked. One sample has a variance of at most `A_s^2 E[k^2; blocked] <= A_s k_max F_blocked`, so N samples in
//! all give `sigma^2 <= A_s k_max F_blocked / N`. The sampler is stratified, which only makes this less. Values must lie within 4 sigma. From points the
//! visible part of an emitter is found exactly, and values must be exact.
#![allow(clippy::print_stdout, reason = "a test tells what it measured")]

#[path = "support/fixtures.rs"]
mod fixtures;
#[path = "support/rooms.rs"]
mod rooms;
#[path = "support/triangles.rs"]
mod triangles;

use std::f64::consts::PI;

use fixtures::{form_factor_cases, value, vector, vectors};
use patchlight::form_factor::exact_area_form_factor;
use patchlight::geometry::Polygon;
use patchlight::scene::SurfacePoint;
use patchlight::scene::{Scene, SurfaceId};
use patchlight::solve::{LinkOptions, SolveOptions, Solver, Strategy, UniformOptions};
use rooms::{Room, solve, values};
use serde_json::Value;

/// Largest deviation, in standard deviations: 6e-5 of probability for each case.
const SIGMAS: f64 = 4.0;

/// What rounding of transmittances to f32 may do.
const ROUNDING: f64 = 2e-7;

/// Receiver and source, with the blockers between them.
fn scene(receiver: &[[f64; 3]], source: &[[f64; 3]], blockers: &Value) -> Scene {
    let mut room = Room::default();
    let (grey, lamp, black) = (room.material(&[0.5], &[0.0]), room.material(&[0.0], &[1.0]), room.material(&[0.0], &[0.0]));
    room.face(receiver, grey);
    room.face(source, lamp);
    for blocker in blockers.as_array().unwrap() {
        room.sheet(&vectors(blocker), black);
    }
    room.scene()
}

/// Between parallel planes at distance 1 the kernel is largest straight across. All cases are of this kind.
fn largest_kernel(source: &Polygon, z: f64) -> f64 {
    assert!(source.vertices().all(|vertex| (vertex[2] - z).abs() == 1.0), "the bound is for planes at distance 1");
    1.0 / PI
}

#[test]
fn every_case_within_its_confidence() {
    let cases = form_factor_cases();
    let (mut pairs, mut points) = (0, 0);
    for case in cases.iter().filter(|case| case["group"] == "A4") {
        let name = case["name"].as_str().unwrap();
        let geometry = &case["geometry"];
        let (expected, found, sigma) = match case["quantity"].as_str().unwrap() {
            "F_visible(P1->P2)" => {
                pairs += 1;
                polygon_pair(geometry, value(case))
            }
            "F_visible(dA->P)" => {
                points += 1;
                point_and_polygon(geometry, value(case))
            }
            other => panic!("{name}: unknown quantity {other}"),
        };
        println!("{name}: {found:.7}, exact {expected:.7}, {:+.2} sigma of {sigma:.1e}", (found - expected) / sigma.max(ROUNDING));
        assert!((found - expected).abs() <= SIGMAS * sigma + ROUNDING, "{name}: {found} instead of {expected}, sigma {sigma}");
    }
    assert_eq!((pairs, points), (8, 3));
}

/// The mean over the elements of the receiver: exact value, value found, bound of its standard deviation.
fn polygon_pair(geometry: &Value, expected: f64) -> (f64, f64, f64) {
    let (receiver, source) = (vectors(&geometry["polygons"]["P1"]), vectors(&geometry["polygons"]["P2"]));
    let (receiver_polygon, source_polygon) = (Polygon::new(&receiver).unwrap(), Polygon::new(&source).unwrap());
    let rays = 128;
    let options = SolveOptions {
        strategy: Strategy::Uniform,
        error: 0.5,
        uniform: UniformOptions { element_area: Some(1.0 / 64.0) },
        links: LinkOptions { form_factor_accuracy: 0.0, rays_per_light_link: rays, leaf_rays: Some(0), ..LinkOptions::default() },
        ..SolveOptions::default()
    };
    let (evaluator, report) = solve(scene(&receiver, &source, &geometry["blockers"]), &options);
    let solution = evaluator.solution();
    let found = 2.0 * solution.radiosity().of(solution.hierarchy().node_of(SurfaceId(0)))[0];

    // Elements and rays are the same for all pairs of elements, so the samples are spread evenly over both polygons.
    assert_eq!(report.counts.links, 64 * 64);
    let samples = report.counts.links as f64 * f64::from(rays);
    let blocked = exact_area_form_factor(&receiver_polygon, &source_polygon) / receiver_polygon.area() - expected;
    let variance = source_polygon.area() * largest_kernel(&source_polygon, receiver[0][2]) * blocked / samples;
    (expected, found, variance.max(0.0).sqrt())
}

/// The gather at the point, which is put on a square of side 2 around it.
fn point_and_polygon(geometry: &Value, expected: f64) -> (f64, f64, f64) {
    let (position, normal) = (vector(&geometry["receiver_point"]), vector(&geometry["receiver_normal"]));
    assert_eq!(normal, [0.0, 0.0, 1.0]);
    let corner = |dx: f64, dy: f64| [position[0] + dx, position[1] + dy, position[2]];
    let receiver = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
    let source = vectors(&geometry["polygons"]["emitter"]);
    let options = SolveOptions { error: 0.5, solver: Solver::Links, ..SolveOptions::default() };
    let (evaluator, _) = solve(scene(&receiver, &source, &geometry["blockers"]), &options);
    let found = 2.0 * values(&evaluator, &[SurfacePoint { position, normal }])[0];

    // The source is an emitter: of it the gather takes the visible part exactly.
    (expected, found, 0.0)
}
