//! What was measured, as Markdown.

use super::measure::{Ladder, Row, Rung};

pub fn print(ladder: &Ladder) {
    println!("\n### {} ({} polygons)\n", ladder.name, ladder.surfaces);
    let apart = ladder.reference;
    println!("The reference over links and one over cells differ by {} in L1, {} RMS.\n", percent(apart.l1), percent(apart.rms));
    heading(&["tolerance", "links", "nodes", "leaves", "CPU-s", "way", "L1", "RMS", "largest", "us a point"]);
    for rung in &ladder.rungs {
        rung.rows.iter().for_each(|row| line(rung, row));
    }
}

fn line(rung: &Rung, row: &Row) {
    let counts = &rung.report.counts;
    println!(
        "| {:.2e} | {} | {} | {} | {:.2} | {} | {} | {} | {} | {:.1} |",
        rung.tolerance,
        counts.links,
        counts.elements,
        rung.leaves,
        rung.cpu_s,
        row.way.name(),
        percent(row.errors.l1),
        percent(row.errors.rms),
        percent(row.errors.largest),
        row.micros
    );
}

pub fn percent(part: f64) -> String {
    format!("{:.2}%", 100.0 * part)
}

pub fn heading(columns: &[&str]) {
    println!("| {} |\n|{}", columns.join(" | "), "---|".repeat(columns.len()));
}
