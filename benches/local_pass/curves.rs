//! Table 4.4: how many discontinuities there are, and how many there could be.

use patchlight::discontinuities::of_emitters;

use super::cpu::cpu_seconds;
use super::measure::read;
use super::tables::heading;

pub fn print<'a>(names: impl Iterator<Item = &'a str>) {
    println!("\n### Discontinuities\n");
    heading(&[
        "scene",
        "source edges l",
        "edges m",
        "worst case of a polygon, 2 l m",
        "D0",
        "D1",
        "D2",
        "most of a polygon",
        "CPU-s",
    ]);
    for name in names {
        let scene = read(name);
        let start = cpu_seconds();
        let counters = *of_emitters(&scene, 0.0).counters();
        println!(
            "| {name} | {} | {} | {} | {} | {} | {} | {} | {:.1} |",
            counters.source_edges,
            counters.edges,
            counters.worst_case_per_surface(),
            counters.d0,
            counters.d1,
            counters.d2,
            counters.most_per_surface,
            cpu_seconds() - start
        );
    }
}
