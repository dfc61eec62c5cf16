//! Table 3, and how far the links of the living room are from a dense sampling of their own.

use patchlight::form_factor::exact_area_form_factor;
use patchlight::geometry::Polygon;
use patchlight::hierarchy::NodeId;
use patchlight::scene::{Scene, SurfaceId};
use patchlight::solve::{Solution, Strategy};
use patchlight::visibility::{Backend, OccluderMesh, Segment, Visibility, build};

use super::paper::{LIVING_ROOM, TOLERANCES};
use super::rooms::point_of;
use super::run::{elements_below, run, scene};
use super::table::{heading, percent};
use super::triangles::{Random, dot, sub};

/// Links that are looked at, drawn by what they would exchange if nothing were in between, and rays for each.
const LINKS: usize = 1000;
const RAYS: usize = 4096;
/// Runs with other samples.
const SEEDS: u64 = 3;

/// What all seeds come to.
#[derive(Default)]
struct Found {
    links: usize,
    refine_cpu_s: f64,
    gather_s: f64,
    off: Off,
}

/// How far links above the smallest elements are from the dense sampling.
#[derive(Default)]
struct Off {
    /// `sum |A F - dense| / sum dense`.
    misplaced: f64,
    /// What the noise of the dense sampling adds to it.
    noise: f64,
    /// The median of `|A F - dense| / dense` by what is exchanged.
    median: f64,
}

pub fn tables() {
    let scene = scene("living_room");
    let backend = build(Backend::Auto, &OccluderMesh::of_scene(&scene)).expect("a backend");
    let count = elements_below(run(&scene, Strategy::BottomUp98, 1.0, 1, 0).solution()).0.len();
    println!(
        "\n{} surfaces, {count} elements, {} pairs of them (paper: 246, 2270, 2575315).",
        scene.surfaces().len(),
        count * (count - 1) / 2
    );
    let columns = ["F_eps", "samples", "links", "refine CPU-s", "gather s", "upper links off", "median"];
    heading("**Table 3.** The living room; in brackets the paper's, for one sample on each smallest element.", &columns);
    for (tolerance, (links, refine_s, gather_s)) in TOLERANCES.iter().zip(LIVING_ROOM) {
        for (name, strategy, samples) in [
            ("bottom-up, 1", Strategy::BottomUp98, 1),
            ("bottom-up, 4", Strategy::BottomUp98, 4),
            ("top-down, 4", Strategy::TopDown98, 4),
        ] {
            let found = measure(&scene, &*backend, strategy, *tolerance, samples);
            let paper = |text: String| if samples == 1 { format!(" ({text})") } else { String::new() };
            println!(
                "| {tolerance:.3} | {name} | {}{} | {:.2}{} | {:.3}{} | {} (noise {}) | {} |",
                found.links,
                paper(links.to_string()),
                found.refine_cpu_s,
                paper(refine_s.to_string()),
                found.gather_s,
                paper(gather_s.to_string()),
                percent(found.off.misplaced),
                percent(found.off.noise),
                percent(found.off.median)
            );
        }
    }
}

/// Links of the first seed, means of the rest.
fn measure(scene: &Scene, backend: &dyn Visibility, strategy: Strategy, tolerance: f64, samples: u32) -> Found {
    let mut found = Found::default();
    for seed in 0..SEEDS {
        let run = run(scene, strategy, tolerance, samples, seed);
        let off = off(scene, backend, run.solution());
        let share = 1.0 / SEEDS as f64;
        if seed == 0 {
            found.links = run.links();
        }
        found.refine_cpu_s += share * run.refine_cpu_s;
        found.gather_s += share * (run.report.time_s.gather + run.report.time_s.push_pull);
        found.off.misplaced += share * off.misplaced;
        found.off.noise += share * off.noise;
        found.off.median += share * off.median;
    }
    found
}

/// Looks at links above the smallest elements.
fn off(scene: &Scene, backend: &dyn Visibility, solution: &Solution) -> Off {
    // All such links, with what they exchange, and would exchange if nothing were in between.
    let hierarchy = solution.hierarchy();
    let polygon = |node: NodeId| Polygon::new(&hierarchy.polygon(node)).expect("a piece of a surface");
    let is_upper = |a: NodeId, b: NodeId| !(hierarchy.is_leaf(a) && hierarchy.is_leaf(b));
    let upper: Vec<(NodeId, NodeId, f64, f64)> = (solution.links().iter())
        .filter(|(receiver, link)| *receiver < link.source && is_upper(*receiver, link.source))
        .map(|(receiver, link)| {
            let unoccluded = exact_area_form_factor(&polygon(receiver), &polygon(link.source));
            (receiver, link.source, hierarchy.area(receiver) * link.occluded_form_factor(), unoccluded)
        })
        .collect();

    // Some of them, evenly by the latter.
    let total: f64 = upper.iter().map(|link| link.3).sum();
    let mut random = Random(98);
    let (mut drawn, mut sum) = (0, 0.0);
    let (mut misplaced, mut noise, mut exchanged) = (0.0, 0.0, 0.0);
    let mut parts = Vec::with_capacity(LINKS);
    for &(receiver, source, exchange, unoccluded) in &upper {
        sum += unoccluded;
        while sum * LINKS as f64 > (drawn as f64 + 0.5) * total {
            drawn += 1;
            let (dense, error) = dense_exchange(scene, backend, solution, receiver, source, &mut random);
            misplaced += (exchange - dense).abs() / unoccluded;
            noise += error / unoccluded;
            exchanged += dense / unoccluded;
            parts.push(if dense > 0.0 { (exchange - dense).abs() / dense } else { f64::from(exchange > 0.0) });
        }
    }
    parts.sort_unstable_by(f64::total_cmp);

    // The mean of the absolute value of a normal deviate is 0.8 of its standard deviation.
    Off { misplaced: misplaced / exchanged, noise: 0.8 * noise / exchanged, median: parts[parts.len() / 2] }
}

/// `A F` in m^2: the exact one if nothing were in between, less what random pairs of points find hidden; with its standard error.
fn dense_exchange(
    scene: &Scene,
    backend: &dyn Visibility,
    solution: &Solution,
    receiver: NodeId,
    source: NodeId,
    random: &mut Random,
) -> (f64, f64) {
    let hierarchy = solution.hierarchy();
    let [from, to] = [receiver, source].map(|node| Polygon::new(&hierarchy.polygon(node)).expect("a piece of a surface"));
    let plane = |node: NodeId| scene.surface(SurfaceId(hierarchy.surface_of(node).expect("no cluster").0)).plane();
    let mut kernels = Vec::with_capacity(RAYS);
    let mut segments = Vec::with_capacity(RAYS);
    for _ in 0..RAYS {
        let (x, y) = (point_of(&from, random).position, point_of(&to, random).position);
        let d = sub(y, x);
        let (height_y, height_x, distance_sq) = (dot(from.normal(), d), -dot(to.normal(), d), dot(d, d));
        let facing = height_y > 0.0 && height_x > 0.0;
        kernels.push(if facing { height_x * height_y / (std::f64::consts::PI * distance_sq * distance_sq) } else { 0.0 });
        segments.push(Segment { from: x, to: y, from_plane: plane(receiver), to_plane: plane(source) });
    }
    let mut occluded = vec![false; RAYS];
    backend.occluded(&segments, &mut occluded);

    // What is hidden is taken from what is known better.
    let hidden = kernels.iter().zip(&occluded).map(|(kernel, occluded)| if *occluded { *kernel } else { 0.0 });
    let (sum, sum_sq) = hidden.fold((0.0, 0.0), |(sum, sum_sq), k| (sum + k, sum_sq + k * k));
    let mean = sum / RAYS as f64;
    let deviation = ((sum_sq / RAYS as f64 - mean * mean).max(0.0) / RAYS as f64).sqrt();
    (exact_area_form_factor(&from, &to) - from.area() * to.area() * mean, from.area() * to.area() * deviation)
}
