//! Table 3, and how far the links of the living room are from a dense sampling of their own.

use patchlight::form_factor::point_form_factor;
use patchlight::geometry::Polygon;
use patchlight::hierarchy::NodeId;
use patchlight::scene::{Scene, SurfaceId};
use patchlight::solve::{Solution, Strategy};
use patchlight::visibility::{Backend, OccluderMesh, Segment, Visibility, build};

use super::paper::{LIVING_ROOM, TOLERANCES};
use super::rooms::point_of;
use super::run::{Run, elements_below, run, scene};
use super::triangles::{Random, dot, sub};
use super::{heading, percent};

/// Links that are looked at, drawn by what they exchange, and rays for each.
const LINKS: usize = 400;
const RAYS: usize = 4096;

pub fn tables() {
    let scene = scene("living_room");
    let backend = build(Backend::Auto, &OccluderMesh::of_scene(&scene)).expect("a backend");
    let columns = [
        "F_eps",
        "links bottom-up",
        "refine CPU-s",
        "gather s",
        "upper links off",
        "links top-down",
        "refine CPU-s",
        "upper links off",
    ];
    let count = elements_below(run(&scene, Strategy::BottomUp98, 1.0, 1, 0).solution()).0.len();
    println!(
        "\n{} surfaces, {count} elements, {} pairs of them (paper: 2270, 2575315).",
        scene.surfaces().len(),
        count * (count - 1) / 2
    );
    heading(
        "**Table 3.** The living room, one sample on each smallest element; top-down with four on each node; in brackets the paper's.",
        &columns,
    );
    for (tolerance, (links, refine_s, gather_s)) in TOLERANCES.iter().zip(LIVING_ROOM) {
        let bottom = run(&scene, Strategy::BottomUp98, *tolerance, 1, 0);
        let top = run(&scene, Strategy::TopDown98, *tolerance, 4, 0);
        let sweeping = bottom.report.time_s.gather + bottom.report.time_s.push_pull;
        let off = |run: &Run| {
            let (off, noise) = error_of_links(&scene, &*backend, run.solution());
            format!("{} (noise {})", percent(off), percent(noise))
        };
        println!(
            "| {tolerance:.3} | {} ({links}) | {:.2} ({refine_s}) | {sweeping:.3} ({gather_s}) | {} | {} | {:.2} | {} |",
            bottom.links(),
            bottom.refine_cpu_s,
            off(&bottom),
            top.links(),
            top.refine_cpu_s,
            off(&top)
        );
    }
}

/// The mean of `|F - F_dense| / F` over links above the smallest elements, drawn by what they exchange; and what the noise of the dense
/// sampling adds to it.
fn error_of_links(scene: &Scene, backend: &dyn Visibility, solution: &Solution) -> (f64, f64) {
    let hierarchy = solution.hierarchy();
    let is_upper = |a: NodeId, b: NodeId| !(hierarchy.is_leaf(a) && hierarchy.is_leaf(b));
    let upper: Vec<(NodeId, NodeId, f64)> = (solution.links().iter())
        .filter(|(receiver, link)| *receiver < link.source && is_upper(*receiver, link.source))
        .map(|(receiver, link)| (receiver, link.source, hierarchy.area(receiver) * link.occluded_form_factor()))
        .collect();
    let total: f64 = upper.iter().map(|link| link.2).sum();
    let mut random = Random(98);
    let (mut off, mut noise) = (0.0, 0.0);
    let mut next = 0.0;
    let mut sum = 0.0;
    let step = total / LINKS as f64;
    for &(receiver, source, exchange) in &upper {
        sum += exchange;
        while sum > next + 0.5 * step {
            next += step;
            let (dense, error) = dense_exchange(scene, backend, solution, receiver, source, &mut random);
            off += (exchange - dense).abs() / exchange;
            noise += error / exchange;
        }
    }
    // The mean of the absolute value of a normal deviate is 0.8 of its standard deviation.
    (off / LINKS as f64, 0.8 * noise / LINKS as f64)
}

/// `A F` in m^2 by random points on the receiver and exact form factors from them to the source, of which a ray each tells how much gets
/// through; with its standard error.
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
    let mut unoccluded = 0.0;
    for _ in 0..RAYS {
        let (x, y) = (point_of(&from, random).position, point_of(&to, random).position);
        unoccluded += point_form_factor(x, from.normal(), &to) / RAYS as f64;
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
    (from.area() * (unoccluded - to.area() * mean), from.area() * to.area() * deviation)
}
