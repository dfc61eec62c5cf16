//! Bounds on form factors over a receiver, against points of it: they must hold everywhere, and be near what is attained.
#![allow(clippy::print_stdout, reason = "a test tells what it measured")]

#[path = "support/fixtures.rs"]
mod fixtures;
#[allow(dead_code, reason = "other tests use other parts")]
mod random_polygons;

use fixtures::{form_factor_cases, value, vector, vectors};
use patchlight::form_factor::{bound_form_factor, estimate_form_factor_range, exact_area_form_factor, point_form_factor};
use patchlight::geometry::Polygon;
use random_polygons::{KINDS, Kind, Random, Vector, add, cross, normalized, random_pair, scaled, sub};

/// The rounding of a form factor at a point, which the bounds' own allowance need not cover.
const ROUNDING: f64 = 1e-13;

/// A point of the open polygon: a mean of its vertices, pulled towards a few of them.
fn inner_point(vertices: &[Vector], random: &mut Random, sharpness: i32) -> Vector {
    let weights: Vec<f64> = vertices.iter().map(|_| random.unit().powi(sharpness) + 1e-9).collect();
    let total: f64 = weights.iter().sum();
    vertices.iter().zip(weights).fold([0.0; 3], |sum, (&v, weight)| add(sum, scaled(weight / total, v)))
}

/// What sampling found of a pair.
struct Found {
    least: f64,
    most: f64,
}

/// Looks at `looks` points spread over the receiver, then climbs from the best.
fn sample(receiver: &Polygon, source: &Polygon, looks: usize, random: &mut Random) -> Found {
    let vertices: Vec<Vector> = receiver.vertices().collect();
    let at = |x: Vector| point_form_factor(x, receiver.normal(), source);
    let (mut found, mut best) = (Found { least: f64::INFINITY, most: 0.0 }, receiver.centroid());
    for look in 0..looks {
        let x = inner_point(&vertices, random, [1, 4, 30][look % 3]);
        let factor = at(x);
        found.least = found.least.min(factor);
        if factor > found.most {
            (found.most, best) = (factor, x);
        }
    }
    let mut reach = 0.5;
    for _ in 0..looks {
        let x = add(best, scaled(reach, sub(inner_point(&vertices, random, 4), best)));
        let factor = at(x);
        if factor > found.most {
            (found.most, best) = (factor, x);
        } else {
            reach = f64::max(0.9 * reach, 1e-3);
        }
    }
    found
}

/// Bounds against points for `count` random pairs of a kind: the worst violations below and above, and all slacks `upper / most -
/// 1`.
fn check_kind(kind: Kind, count: usize, looks: usize) -> (f64, f64, Vec<f64>) {
    let mut random = Random::new(0xb0_0d + kind as u64);
    let (mut below, mut above, mut slacks) = (0.0_f64, 0.0_f64, Vec::new());
    for _ in 0..count {
        let (a, b) = random_pair(&mut random, kind);
        let (Ok(receiver), Ok(source)) = (Polygon::new(&a), Polygon::new(&b)) else { continue };
        for (receiver, source) in [(&receiver, &source), (&source, &receiver)] {
            let [least, most] = bound_form_factor(receiver, source);
            let found = sample(receiver, source, looks, &mut random);
            below = below.max(least - found.least);
            above = above.max(found.most - most);
            assert!(least <= most && (0.0..=1.0).contains(&least) && most <= 1.0, "{kind:?}: [{least}, {most}]");
            if found.most > 1e-9 {
                slacks.push(most / found.most - 1.0);
            }
        }
    }
    slacks.sort_by(f64::total_cmp);
    (below, above, slacks)
}

/// Checks so many pairs of each kind; all slacks.
fn check(kinds: &[Kind], count: usize, looks: usize) -> Vec<f64> {
    let mut all = Vec::new();
    for &kind in kinds {
        let (below, above, slacks) = check_kind(kind, count, looks);
        let at = |q: f64| slacks[((slacks.len() - 1) as f64 * q) as usize];
        println!(
            "{kind:?}: {} pairs, violations {below:.1e} {above:.1e}, slack median {:.4}, 90% {:.4}, most {:.3}",
            slacks.len(),
            at(0.5),
            at(0.9),
            at(1.0)
        );
        assert!(below <= ROUNDING && above <= ROUNDING, "{kind:?}: {below:e} below, {above:e} above");
        all.extend(slacks);
    }
    all
}

#[test]
fn bounds_hold_for_random_pairs_and_are_tight() {
    let mut slacks = check(&KINDS, 120, 60);
    slacks.sort_by(f64::total_cmp);
    let at_90_percent = slacks[(0.9 * (slacks.len() - 1) as f64) as usize];
    println!("all: slack at 90% {at_90_percent:.4}");
    // So near that links need not be much smaller for their bounds than for their error (empirical).
    assert!(at_90_percent <= 0.15, "the upper bounds are {at_90_percent} above what is attained, at the 90% quantile");
}

/// A million pairs, in three parts: `cargo test --release --test form_factor_bounds -- --ignored --nocapture`, some minutes.
const MILLION: usize = 1_000_000 / (2 * KINDS.len()) + 1;

#[test]
#[ignore = "minutes"]
fn bounds_hold_for_a_million_random_pairs_apart() {
    check(&KINDS[..3], MILLION, 60);
}

#[test]
#[ignore = "minutes"]
fn bounds_hold_for_a_million_random_pairs_that_touch() {
    check(&KINDS[3..6], MILLION, 60);
}

#[test]
#[ignore = "minutes"]
fn bounds_hold_for_a_million_random_pairs_that_are_odd() {
    check(&KINDS[6..], MILLION, 60);
}

#[test]
fn form_factors_are_quasi_concave_over_the_receiver() {
    // The theorem itself: on a segment of the receiver nothing is less than at its ends.
    let mut random = Random::new(77);
    let mut checked = 0;
    for round in 0..20_000 {
        let (a, b) = random_pair(&mut random, KINDS[round % KINDS.len()]);
        let (Ok(receiver), Ok(source)) = (Polygon::new(&a), Polygon::new(&b)) else { continue };
        let at = |x: Vector| point_form_factor(x, receiver.normal(), &source);
        let vertices: Vec<Vector> = receiver.vertices().collect();
        let [start, end] = [0, 0].map(|_| inner_point(&vertices, &mut random, 4));
        let ends = at(start).min(at(end));
        let t = random.unit();
        let between = at(add(start, scaled(t, sub(end, start))));
        // But for rounding, which is larger where terms cancel.
        assert!(between >= ends * (1.0 - 1e-9) - ROUNDING, "{between} between ends of at least {ends}");
        checked += usize::from(ends > 0.0);
    }
    assert!(checked > 10_000, "only {checked} segments saw the source");
}

#[test]
fn the_range_over_centre_and_vertices_is_no_upper_bound() {
    // What the thesis takes for the largest is exceeded for many pairs: the reason why it counts as an estimate.
    let mut random = Random::new(5);
    let (mut exceeded, mut pairs) = (0, 0);
    for _ in 0..500 {
        let (a, b) = random_pair(&mut random, Kind::Near);
        let (Ok(receiver), Ok(source)) = (Polygon::new(&a), Polygon::new(&b)) else { continue };
        let [_, most] = estimate_form_factor_range(&receiver, &source);
        let found = sample(&receiver, &source, 60, &mut random);
        exceeded += u32::from(found.most > 1.001 * most);
        pairs += 1;
    }
    println!("the largest of centre and vertices is exceeded for {exceeded} of {pairs} pairs");
    assert!(exceeded > pairs / 20);
}

/// A square of side `size` around a point, with the point in its middle, and its quarters.
fn squares_around(point: Vector, normal: Vector, size: f64) -> Vec<Polygon> {
    let tangent = normalized(cross(normal, if normal[0].abs() < 0.9 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] }));
    let bitangent = cross(normal, tangent);
    let square = |x: f64, y: f64| {
        let corner = |s: f64, t: f64| add(point, add(scaled(size * (x + s), tangent), scaled(size * (y + t), bitangent)));
        Polygon::new(&[corner(0.0, 0.0), corner(1.0, 0.0), corner(1.0, 1.0), corner(0.0, 1.0)]).unwrap()
    };
    vec![square(-0.5, -0.5), square(0.0, 0.0), square(-1.0, 0.0), square(-1.0, -1.0), square(0.0, -1.0)]
}

#[test]
fn the_cases_at_points_lie_within_the_bounds_of_every_element_around() {
    let mut checked = 0;
    for case in form_factor_cases().iter().filter(|case| case["group"] == "A1") {
        let (point, normal) =
            (vector(&case["geometry"]["receiver_point"]), normalized(vector(&case["geometry"]["receiver_normal"])));
        let source = Polygon::new(&vectors(&case["geometry"]["polygons"]["emitter"])).unwrap();
        for size in [1.0, 0.1, 1e-3, 1e-6] {
            for element in squares_around(point, normal, size) {
                // Rounding turns small elements a little; the case is that of the turned one.
                let exact = point_form_factor(point, element.normal(), &source);
                assert!((exact - value(case)).abs() <= 1e-9, "{}: {exact}", case["name"]);
                let [least, most] = bound_form_factor(&element, &source);
                assert!(
                    least - ROUNDING <= exact && exact <= most + ROUNDING,
                    "{}: {exact} not in [{least}, {most}]",
                    case["name"]
                );
                checked += 1;
            }
            // Small elements know it well, away from where it jumps: form factors change by less than 100 times the way.
            let [least, most] = bound_form_factor(&squares_around(point, normal, size)[0], &source);
            if size == 1e-6 && case["name"] != "pt_vertical_wall_1e-3_from_edge" {
                assert!(most - least <= 1e-4, "{}: [{least}, {most}]", case["name"]);
            }
        }
    }
    assert_eq!(checked, 13 * 20);
}

#[test]
fn the_means_of_the_cases_lie_within_the_means_of_the_bounds() {
    let mut checked = 0;
    for case in form_factor_cases().iter().filter(|case| case["group"] == "A2" || case["group"] == "A3") {
        let polygons = &case["geometry"]["polygons"];
        let [first, second] = ["P1", "P2"].map(|name| Polygon::new(&vectors(&polygons[name])).unwrap());
        let exact = value(case);
        // The case is read as it is meant: the exact path is good to 1e-10.
        assert!((exact_area_form_factor(&first, &second) / first.area() - exact).abs() <= 1e-9 * exact + 1e-14);
        let mut widths = Vec::new();
        for cuts in [1_usize, 2, 4, 8, 16] {
            // The receiver in strips and again across, by its own first two edges.
            let vertices: Vec<Vector> = first.vertices().collect();
            let (mut least, mut most) = (0.0, 0.0);
            for piece in pieces(&vertices, cuts) {
                let [low, high] = bound_form_factor(&piece, &second);
                least += low * piece.area() / first.area();
                most += high * piece.area() / first.area();
            }
            assert!(least <= exact + ROUNDING && exact <= most + ROUNDING, "{}: {exact} not in [{least}, {most}]", case["name"]);
            widths.push((most - least) / exact);
            checked += 1;
        }
        println!("{}: relative widths {widths:.4?}", case["name"].as_str().unwrap());
        // Sixteen times as fine, and at least half as wide.
        assert!(widths[4] < 0.5 * widths[0] || widths[0] < 1e-6, "{}: {widths:?}", case["name"]);
    }
    assert_eq!(checked, 16 * 5);
}

/// A triangle or parallelogram in `cuts` by `cuts` pieces.
fn pieces(vertices: &[Vector], cuts: usize) -> Vec<Polygon> {
    let n = cuts as f64;
    let (origin, u, v) = (vertices[0], sub(vertices[1], vertices[0]), sub(vertices[vertices.len() - 1], vertices[0]));
    let at = |i: usize, j: usize| add(origin, add(scaled(i as f64 / n, u), scaled(j as f64 / n, v)));
    let mut pieces = Vec::new();
    for i in 0..cuts {
        for j in 0..cuts {
            if vertices.len() == 4 {
                pieces.push(vec![at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
            } else if i + j < cuts {
                pieces.push(vec![at(i, j), at(i + 1, j), at(i, j + 1)]);
                if i + j + 1 < cuts {
                    pieces.push(vec![at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
                }
            }
        }
    }
    pieces.iter().map(|corners| Polygon::new(corners).unwrap()).collect()
}
