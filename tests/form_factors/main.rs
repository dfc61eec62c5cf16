//! Form factors against closed forms, against identities, and against quadratures of their own.
#![expect(clippy::print_stdout, reason = "what was measured belongs into the test's output")]

mod claims;
#[path = "../random_polygons/mod.rs"]
mod random_polygons;

use std::collections::BTreeMap;
use std::f64::consts::PI;

use patchlight::form_factor::{
    Estimate, estimate_area_form_factor, exact_area_form_factor, point_form_factor, sided_area_form_factor,
};
use patchlight::geometry::Polygon;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use random_polygons::{KINDS, Kind, Random, Vector, add, cross, dot, normalized, random_pair, scaled, sub};
use rayon::prelude::*;
use serde_json::Value;

/// The reference values of groups A1 to A4, each with its source.
const CASES: &str = include_str!("../fixtures/exact_cases.json");

fn vector(value: &Value) -> Vector {
    std::array::from_fn(|k| value[k].as_f64().unwrap())
}

fn vertices(value: &Value) -> Vec<Vector> {
    value.as_array().unwrap().iter().map(vector).collect()
}

fn polygon(vertices: &[Vector]) -> Polygon {
    Polygon::new(vertices).unwrap_or_else(|error| panic!("{error}: {vertices:?}"))
}

/// The pairs of polygons of groups A2 and A3 by name.
fn reference_pairs() -> Vec<(String, Vec<Vector>, Vec<Vector>)> {
    let cases: Value = serde_json::from_str(CASES).unwrap();
    let pairs = cases["cases"].as_array().unwrap().iter().filter(|case| case["group"] == "A2" || case["group"] == "A3");
    pairs
        .map(|case| {
            let polygons = &case["geometry"]["polygons"];
            (case["name"].as_str().unwrap().to_owned(), vertices(&polygons["P1"]), vertices(&polygons["P2"]))
        })
        .collect()
}

fn assert_close(value: f64, expected: f64, relative: f64, what: &str) {
    assert!((value - expected).abs() <= relative * expected.abs(), "{what}: {value:e}, expected {expected:e}");
}

#[test]
fn every_reference_case_through_the_exact_path() {
    let cases: Value = serde_json::from_str(CASES).unwrap();
    let mut counts = BTreeMap::new();
    for case in cases["cases"].as_array().unwrap() {
        let (name, group) = (case["name"].as_str().unwrap(), case["group"].as_str().unwrap());
        *counts.entry(group).or_insert(0) += 1;
        let geometry = &case["geometry"];
        let polygons = &geometry["polygons"];
        let value = match group {
            "A1" => {
                let (x, normal) = (vector(&geometry["receiver_point"]), vector(&geometry["receiver_normal"]));
                point_form_factor(x, normal, &polygon(&vertices(&polygons["emitter"])))
            }
            "A2" | "A3" => {
                let (p1, p2) = (polygon(&vertices(&polygons["P1"])), polygon(&vertices(&polygons["P2"])));
                exact_area_form_factor(&p1, &p2) / p1.area()
            }
            // Occluded: these need rays and are tested with them.
            "A4" => continue,
            other => panic!("{name} is of the unknown group {other}"),
        };

        let expected: f64 = case["value"].as_str().unwrap().parse().unwrap();
        // What the exact path claims; in a sliver most of the contour cancels.
        let tolerance = if name.starts_with("sliver") { 1e-6 } else { 1e-10 };
        if expected == 0.0 {
            assert!(value.abs() <= 1e-14, "{name}: {value:e}, expected 0");
        } else {
            assert_close(value, expected, tolerance, name);
        }
    }
    assert_eq!(counts, BTreeMap::from([("A1", 13), ("A2", 11), ("A3", 5), ("A4", 11)]), "a case is missing");
}

#[test]
fn reference_cases_survive_scaling_rotation_and_translation() {
    let mut random = Random::new(3);
    for (name, p1, p2) in reference_pairs() {
        let exchange = |f: &dyn Fn(Vector) -> Vector| {
            let map = |vertices: &[Vector]| polygon(&vertices.iter().map(|&v| f(v)).collect::<Vec<_>>());
            exact_area_form_factor(&map(&p1), &map(&p2))
        };
        let expected = exchange(&|v| v);
        // Ten times what the exact path claims, and for slivers what cancels of their contour.
        let tolerance = |plain: f64| if name.starts_with("sliver") { 1e3 * plain } else { plain };
        for factor in [1e-6, 1e6] {
            let value = exchange(&|v| scaled(factor, v)) / (factor * factor);
            assert_close(value, expected, tolerance(1e-9), &format!("{name} scaled by {factor:e}"));
        }
        for _ in 0..5 {
            let (x, y, z) = random.frame();
            let rotate = |v: Vector| add(add(scaled(v[0], x), scaled(v[1], y)), scaled(v[2], z));
            assert_close(exchange(&rotate), expected, tolerance(1e-9), &format!("{name} rotated"));
        }
        // A translation by a million sizes leaves ten digits of the size, fewer of what is smaller than it. The sizes of the
        // pair with a ratio of a thousand and of the thin ones are those of the smaller polygon and of the gap.
        let size = match name.as_str() {
            "par_scale_1_to_1e-3" => 1e-3,
            "sliver_1e-4" => 1e-4,
            "par_close_z0.01" => 0.01,
            "perp_edge_H0.1_W10" | "par_EES_example" | "par_equal_X0.1_Y0.1" => 0.1,
            _ => 1.0,
        };
        let offset = scaled(1e6 * size, [1.0, -0.7, 0.4]);
        assert_close(exchange(&|v| add(v, offset)), expected, 1e-6, &format!("{name} translated"));
    }
}

/// Pieces of the polygon between its vertices, the middles of its edges and its centroid.
fn pieces(polygon: &Polygon) -> Vec<Polygon> {
    let v: Vec<Vector> = polygon.vertices().collect();
    let n = v.len();
    (0..n)
        .map(|k| {
            let (before, here, after) = (v[(k + n - 1) % n], v[k], v[(k + 1) % n]);
            let corners = [scaled(0.5, add(before, here)), here, scaled(0.5, add(here, after)), polygon.centroid()];
            Polygon::new(&corners).unwrap()
        })
        .collect()
}

#[test]
fn exact_exchange_is_additive_and_symmetric_to_the_bit() {
    // Pieces meet other rules than the whole: far ones Gauss points, near ones the contour.
    let mut random = Random::new(17);
    for kind in KINDS {
        let mut worst: f64 = 0.0;
        for _ in 0..300 {
            let (a, b) = random_pair(&mut random, kind);
            let (a, b) = (polygon(&a), polygon(&b));
            let whole = exact_area_form_factor(&a, &b);
            assert_eq!(whole.to_bits(), exact_area_form_factor(&b, &a).to_bits(), "{kind:?} is not symmetric");
            let pieces_of_b = pieces(&b);
            let sum: f64 = pieces(&a).iter().flat_map(|a| pieces_of_b.iter().map(|b| exact_area_form_factor(a, b))).sum();

            // Relative to the value, but no closer than 1e-12 of what the smaller one could receive. Each is good to 1e-10, slivers to less.
            let scale = whole.max(1e-3 * a.area().min(b.area()));
            worst = worst.max((sum - whole).abs() / scale);
        }
        println!("{kind:?}: worst difference between a whole and its pieces {worst:.1e}");
        assert!(worst < if kind == Kind::Sliver { 1e-6 } else { 1e-9 }, "{kind:?}: {worst:e}");
    }
}

/// The walls of a box with sides `size`, turned and moved, each split `level` times in both directions; facing inwards.
fn box_elements(size: Vector, level: u32, random: &mut Random) -> Vec<Polygon> {
    let (x, y, z) = random.frame();
    let axes = [scaled(size[0], x), scaled(size[1], y), scaled(size[2], z)];
    let origin = random.direction();
    let n = 1 << level;
    let mut elements = Vec::new();
    for axis in 0..3 {
        let (u, v, w) = (axes[axis], axes[(axis + 1) % 3], axes[(axis + 2) % 3]);
        for (base, first, second) in [(origin, v, w), (add(origin, u), w, v)] {
            let corner =
                |i: usize, j: usize| add(base, add(scaled(i as f64 / n as f64, first), scaled(j as f64 / n as f64, second)));
            for i in 0..n {
                for j in 0..n {
                    elements.push(polygon(&[corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)]));
                }
            }
        }
    }
    elements
}

fn row_sum(elements: &[Polygon], row: usize) -> f64 {
    let receiver = &elements[row];
    // Each is good to 1e-10, and all rounding of the sum is below 1e-12.
    elements.par_iter().map(|source| exact_area_form_factor(receiver, source)).collect::<Vec<_>>().iter().sum::<f64>()
        / receiver.area()
}

#[test]
fn rows_of_a_closed_box_sum_to_one_after_subdivision() {
    let mut random = Random::new(41);
    for size in [[1.0, 1.0, 1.0], [3.0, 1.7, 0.4]] {
        for level in 0..=5 {
            let elements = box_elements(size, level, &mut random);
            for _ in 0..4 {
                let row = random.below(elements.len());
                let sum = row_sum(&elements, row);
                assert!((sum - 1.0).abs() < 1e-9, "box {size:?}, level {level}, row {row}: {sum}");
            }
        }
    }
}

#[test]
fn rows_of_a_closed_tetrahedron_sum_to_one_after_subdivision() {
    let mut random = Random::new(43);
    let (x, y, z) = random.frame();
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.1, 0.0], [0.3, 0.9, 0.1], [0.4, 0.2, 0.7]];
    let corner = corners.map(|v: Vector| add(add(scaled(v[0], x), scaled(v[1], y)), scaled(v[2], z)));
    let mut triangles: Vec<[Vector; 3]> = [[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]].map(|face| face.map(|k| corner[k])).to_vec();
    for level in 0..=4 {
        let elements: Vec<Polygon> = triangles.iter().map(|t| polygon(t)).collect();
        for _ in 0..4 {
            let row = random.below(elements.len());
            let sum = row_sum(&elements, row);
            assert!((sum - 1.0).abs() < 1e-9, "level {level}, row {row}: {sum}");
        }
        let middle = |a: Vector, b: Vector| scaled(0.5, add(a, b));
        triangles = triangles
            .iter()
            .flat_map(|&[a, b, c]| {
                let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            })
            .collect();
    }
}

/// From a point on the floor at `distance` from a wall of height `height` that begins in front of it and runs `width` to one side
/// (Howell's catalogue, B-4).
fn wall_beside(distance: f64, width: f64, height: f64) -> f64 {
    let slant = distance.hypot(height);
    ((width / distance).atan() - distance / slant * (width / slant).atan()) / (2.0 * PI)
}

#[test]
fn points_near_the_foot_of_a_wall_follow_the_closed_form() {
    let wall = polygon(&[[1.0, 0.0, 0.0], [1.0, 0.0, 1.0], [1.0, 1.0, 1.0], [1.0, 1.0, 0.0]]);
    let mut last = 0.0;
    for distance in [1e-1, 1e-2, 1e-3, 1e-6, 1e-9, 1e-12] {
        for y in [0.5, 0.3, 1e-3, 1.0 - 1e-6, 0.0] {
            let x = 1.0 - distance;
            let expected = wall_beside(1.0 - x, y, 1.0) + wall_beside(1.0 - x, 1.0 - y, 1.0);
            let value = point_form_factor([x, y, 0.0], [0.0, 0.0, 1.0], &wall);
            // The closed form is a difference of angles that differ less and less.
            assert_close(value, expected, 1e-9, &format!("{distance:e} from the wall at {y}"));
        }
        let value = point_form_factor([1.0 - distance, 0.5, 0.0], [0.0, 0.0, 1.0], &wall);
        assert!(value > last && value < 0.5, "{distance:e} from the wall: {value}");
        last = value;
    }
    // At 1e-12 from it a wall takes up one half but for some 1e-12.
    assert!(last > 0.5 - 1e-11);
    for on_the_wall in [[1.0, 0.5, 0.0], [1.0, 0.0, 0.0], [1.0, 0.5, 0.5], [1.0, 1.0, 1.0], [1.0, 7.0, 0.0]] {
        assert_eq!(point_form_factor(on_the_wall, [0.0, 0.0, 1.0], &wall), 0.0);
    }
}

#[test]
fn polygons_with_many_vertices_are_the_sum_of_their_triangles() {
    let corner = |k: usize| {
        let (sin, cos) = (k as f64 * 2.0 * PI / 74.0).sin_cos();
        [cos, -1.4 * sin, 1.0]
    };
    let whole = polygon(&(0..74).map(corner).collect::<Vec<_>>());
    let fan: Vec<Polygon> = (1..73).map(|k| polygon(&[corner(0), corner(k), corner(k + 1)])).collect();
    let normals = [[0.0, 0.0, 1.0], normalized([1.0, 0.2, 0.1]), normalized([-0.3, 1.0, -0.2])];
    for normal in normals {
        let x = [0.2, -0.1, 0.3];
        let sum: f64 = fan.iter().map(|triangle| point_form_factor(x, normal, triangle)).sum();
        // Sums of 74 terms, but for rounding.
        assert_close(point_form_factor(x, normal, &whole), sum, 1e-12, &format!("normal {normal:?}"));
    }
    let floor = polygon(&[[-1.0, -1.0, 0.0], [2.0, -1.0, 0.0], [2.0, 1.5, 0.0], [-1.0, 1.5, 0.0]]);
    let sum: f64 = fan.iter().map(|triangle| exact_area_form_factor(&floor, triangle)).sum();
    // What the exact path claims.
    assert_close(exact_area_form_factor(&floor, &whole), sum, 1e-10, "exchange");
}

#[test]
fn what_faces_away_or_lies_in_one_plane_exchanges_nothing() {
    let mut random = Random::new(59);
    for _ in 0..200 {
        // Two polygons of one plane, anywhere, turned and moved: apart, overlapping, and back to back.
        let (x, y, _) = random.frame();
        let origin = scaled(10.0, random.direction());
        let mut place = |size: f64| {
            let (u, v) = (random.signed(), random.signed());
            let corner = |s: f64, t: f64| add(origin, add(scaled(u + size * s, x), scaled(v + size * t, y)));
            polygon(&[corner(0.0, 0.0), corner(1.0, 0.0), corner(1.0, 1.0), corner(0.0, 1.0)])
        };
        let (a, b) = (place(1.0), place(0.7));
        for (a, b) in [(&a, &b), (&a, &b.reversed()), (&a, &a.clone()), (&a, &a.reversed())] {
            assert_eq!(exact_area_form_factor(a, b), 0.0);
            assert_eq!(estimate_area_form_factor(a, b, 0.01), Estimate { value: 0.0, error: 0.0 });
            assert_eq!(sided_area_form_factor(a, b, 3).value, 0.0);
        }
    }

    // A pair that sees each other sees nothing once either is turned over.
    for kind in KINDS {
        if kind == Kind::Crossing {
            continue;
        }
        for _ in 0..50 {
            let (a, b) = random_pair(&mut random, kind);
            let (a, b) = (polygon(&a), polygon(&b));
            let n = a.normal();
            let in_front = b.vertices().all(|v| dot(n, sub(v, a.centroid())) >= -1e-12);
            if in_front {
                assert_eq!(exact_area_form_factor(&a.reversed(), &b), 0.0, "{kind:?}");
                assert_eq!(estimate_area_form_factor(&b, &a.reversed(), 0.01).value, 0.0, "{kind:?}");
            }
        }
    }
}

/// Coordinates that collide, nearly collide, and are far apart.
fn coordinate() -> impl Strategy<Value = f64> {
    prop_oneof![
        8 => prop::sample::select(vec![0.0, 1.0, 0.5, -1.0, 2.0]),
        2 => prop::sample::select(vec![1e-9, -1e-9, 1.0 + 1e-9, 1.0 + 1e-15, 1e-300, 1e6]),
        1 => -1.0..1.0,
    ]
}

fn triangle() -> impl Strategy<Value = Polygon> {
    let vertex = || [coordinate(), coordinate(), coordinate()];
    [vertex(), vertex(), vertex()].prop_filter_map("no area", |vertices| Polygon::new(&vertices).ok())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4000, failure_persistence: None, rng_seed: RngSeed::Fixed(7), ..ProptestConfig::default() })]

    #[test]
    fn no_arrangement_gives_nonsense(a in triangle(), b in triangle(), point in [coordinate(), coordinate(), coordinate()]) {
        let normal = a.normal();
        let from_point = point_form_factor(point, normal, &b);
        prop_assert!((0.0..=1.0).contains(&from_point), "point: {from_point}");

        // On the source itself: exactly 0, but for needles, whose plane is not known that well.
        let longest_sq = b.vertices().flat_map(|v| b.vertices().map(move |w| dot(sub(v, w), sub(v, w)))).fold(0.0, f64::max);
        for on_source in b.vertices().chain([b.centroid()]) {
            let value = point_form_factor(on_source, normal, &b);
            prop_assert!(value == 0.0 || b.area() < 1e-3 * longest_sq, "on the source: {value}");
        }

        let most = a.area().min(b.area()) * (1.0 + 1e-6);
        let exact = exact_area_form_factor(&a, &b);
        prop_assert!((0.0..=most).contains(&exact), "exact: {exact:e} of {most:e}");
        prop_assert_eq!(exact.to_bits(), exact_area_form_factor(&b, &a).to_bits());
        for accuracy in [0.1, 1e-3] {
            let estimate = estimate_area_form_factor(&a, &b, accuracy);
            prop_assert!(estimate.value >= 0.0 && estimate.error >= 0.0 && estimate.value.is_finite(), "{estimate:?}");
            prop_assert_eq!(estimate, estimate_area_form_factor(&b, &a, accuracy));
        }
        let sided = sided_area_form_factor(&a, &b, 3);
        prop_assert!(sided.value >= 0.0 && sided.value.is_finite() && sided.error >= 0.0, "{sided:?}");
    }
}

#[test]
fn the_generator_makes_what_it_says() {
    // The frame is right-handed: the other tests lean on it.
    let (x, y, z) = Random::new(5).frame();
    assert!(dot(cross(x, y), z) > 1.0 - 1e-15);
}
