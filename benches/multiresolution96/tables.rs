//! What was measured, as Markdown.

use super::measure::{Ladder, Rung};

pub fn print(ladders: &[Ladder]) {
    for ladder in ladders {
        one(ladder);
    }
    summary(ladders);
}

fn one(ladder: &Ladder) {
    println!("\n### {}\n", ladder.shape.name());
    println!(
        "F_0 {:.6}, F {:.6}, through the box {:.6}; {} clusters, hierarchy {:.1} ms, exact {:.1} ms\n",
        ladder.unoccluded,
        ladder.exact,
        ladder.through_box,
        ladder.clusters,
        1e3 * ladder.hierarchy_s,
        1e3 * ladder.exact_s
    );
    heading(&["epsilon", "F^epsilon", "error", "claimed", "opened", "wholes", "segments", "mean depth", "integrals", "CPU-ms"]);
    for Rung { tolerance, found, cpu_s } in &ladder.rungs {
        let work = &found.work;
        println!(
            "| {tolerance:.5} | {:.6} | {:.6} | {:.6} | {} | {} | {} | {:.1} | {} | {:.3} |",
            found.form_factor,
            (found.form_factor - ladder.exact).abs(),
            found.error,
            work.opened,
            work.wholes,
            work.segments,
            work.mean_depth(),
            work.integrals,
            1e3 * cpu_s
        );
    }
}

/// Costs over those for an error of 0.
fn summary(ladders: &[Ladder]) {
    println!("\n### All\n");
    heading(&[
        "cluster",
        "F_0",
        "F",
        "F_box",
        "BVE of the root",
        "CPU-ms for 0",
        "time at 1/4",
        "1/2",
        "3/4",
        "clusters at 1/4",
        "1/2",
        "3/4",
    ]);
    for ladder in ladders {
        let last = ladder.rungs.len() - 1;
        let at = |of: fn(&Rung) -> f64| {
            let part = |quarter: usize| format!("{:.0}%", 100.0 * of(&ladder.rungs[quarter * last / 4]) / of(&ladder.rungs[0]));
            [1, 2, 3].map(part).join(" | ")
        };
        println!(
            "| {} | {:.4} | {:.4} | {:.4} | {:.4} | {:.2} | {} | {} |",
            ladder.shape.name(),
            ladder.unoccluded,
            ladder.exact,
            ladder.through_box,
            ladder.root_error,
            1e3 * ladder.rungs[0].cpu_s,
            at(|rung| rung.cpu_s),
            at(used)
        );
    }
}

/// Clusters that were taken as they are, as wholes or as segments.
pub fn used(rung: &Rung) -> f64 {
    (rung.found.work.wholes + rung.found.work.segments) as f64
}

fn heading(columns: &[&str]) {
    println!("| {} |\n|{}", columns.join(" | "), "---|".repeat(columns.len()));
}
