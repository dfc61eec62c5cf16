//! What does a form factor cost for the accuracy that it has? Prints the true error of each estimate beside its cost.

use std::hint::black_box;
use std::time::Duration;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use patchlight::form_factor::{estimate_area_form_factor, exact_area_form_factor, point_form_factor};
use patchlight::geometry::Polygon;

fn polygon(vertices: &[[f64; 3]]) -> Polygon {
    Polygon::new(vertices).expect("a polygon")
}

/// A unit square at height z that looks down.
fn ceiling(z: f64) -> Polygon {
    polygon(&[[0.0, 0.0, z], [0.0, 1.0, z], [1.0, 1.0, z], [1.0, 0.0, z]])
}

fn floor() -> Polygon {
    polygon(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]])
}

/// From points below a unit square or half of it: all above the horizon, or cut by it.
fn point_to_polygon(criterion: &mut Criterion) {
    let quad = ceiling(1.0);
    let triangle = polygon(&[[0.0, 0.0, 1.0], [0.0, 1.0, 1.0], [1.0, 1.0, 1.0]]);
    let points: Vec<[f64; 3]> =
        (0..1024).map(|k| [k as f64 * 0.618 % 1.0, k as f64 * 0.755 % 1.0, k as f64 * 0.57 % 0.9]).collect();
    let (up, sideways) = ([0.0, 0.0, 1.0], [1.0, 0.0, 0.0]);
    assert!((point_form_factor([0.5, 0.5, 0.0], up, &quad) - 0.239_456_470_460_773_54).abs() < 1e-15);
    assert!((point_form_factor([0.5, 0.5, 0.0], sideways, &quad) - 0.027_855_382_420_046_505).abs() < 1e-15);

    let mut group = criterion.benchmark_group("point_to_polygon (1024 points)");
    for (name, source, normal) in [("quad", &quad, up), ("triangle", &triangle, up), ("quad clipped", &quad, sideways)] {
        group.bench_function(name, |bencher| {
            bencher.iter(|| points.iter().map(|&x| point_form_factor(x, normal, black_box(source))).sum::<f64>());
        });
    }
}

/// Unit squares that share an edge, face each other one size apart, and 3 and 10 sizes apart.
fn pairs() -> [(&'static str, Polygon, f64); 4] {
    let adjacent = polygon(&[[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 1.0, 1.0], [0.0, 0.0, 1.0]]);
    [
        ("adjacent", adjacent, 0.200_043_776_075_403_15),
        ("near", ceiling(1.0), 0.199_824_895_698_387_38),
        ("3 sizes", ceiling(3.0), 0.032_971_397_219_497_24),
        ("10 sizes", ceiling(10.0), 0.003_162_056_838_757_602),
    ]
}

#[expect(clippy::print_stderr, reason = "the errors belong beside the costs")]
fn estimate_exchange(criterion: &mut Criterion) {
    let receiver = floor();
    let mut group = criterion.benchmark_group("estimate_exchange");
    for (name, source, _) in pairs() {
        let exact = exact_area_form_factor(&receiver, &source);
        for accuracy in [0.1, 0.03, 0.01, 1e-3] {
            let estimate = estimate_area_form_factor(&receiver, &source, accuracy);
            let error = (estimate.value / exact - 1.0).abs();
            assert!(error <= accuracy && (estimate.value - exact).abs() <= estimate.error);
            eprintln!("{name}, accuracy {accuracy}: true error {error:.1e}, claimed {:.1e}", estimate.error / estimate.value);
            group.bench_with_input(BenchmarkId::new(name, accuracy), &accuracy, |bencher, &accuracy| {
                bencher.iter(|| estimate_area_form_factor(black_box(&receiver), black_box(&source), accuracy));
            });
        }
    }
}

fn exact_exchange(criterion: &mut Criterion) {
    let receiver = floor();
    let mut group = criterion.benchmark_group("exact_exchange");
    for (name, source, expected) in pairs() {
        let value = exact_area_form_factor(&receiver, &source);
        assert!((value / expected - 1.0).abs() < 1e-9, "{name}: {value}");
        group.bench_function(name, |bencher| bencher.iter(|| exact_area_form_factor(black_box(&receiver), black_box(&source))));
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .sample_size(20)
        .warm_up_time(Duration::from_millis(200))
        .measurement_time(Duration::from_millis(500));
    targets = point_to_polygon, estimate_exchange, exact_exchange
}
criterion_main!(benches);
