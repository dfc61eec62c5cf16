//! Every run by itself: docs/error_vs_time.md to read, and a CSV file by which two builds can be compared.

use std::fmt::Write as _;
use std::io;
use std::path::Path;

use super::run::{Job, Measured};
use super::scored::Scored;
use super::section::percent;
use super::tables;

/// The whole of docs/error_vs_time.md.
pub fn text(scenes: &[Scored]) -> String {
    let mut text = String::from(
        "# Error against time, scene by scene and run by run\n\nWritten by `make bench-error`, like its part of [BENCHMARKS.md](../BENCHMARKS.md), which says what the \
         columns mean. Medians over seeds, of two the larger value, stand above the runs.\n",
    );
    scenes.iter().for_each(|scored| scene(&mut text, scored));
    text
}

/// One scene: medians, then one row for every run and for peers.
fn scene(text: &mut String, scored: &Scored) {
    let problem = &scored.problem;
    let _ = writeln!(text, "\n## {}\n\n{} points; reference: {}.\n", problem.name, problem.points.len(), problem.reference_is);
    let file = problem.file_name();
    let _ = writeln!(text, "![error against CPU time](error_vs_time_{file}_cpu.svg)");
    let _ = writeln!(text, "![error against wall time](error_vs_time_{file}_wall.svg)\n");
    tables::medians(text, scored);
    let _ = writeln!(
        text,
        "| program | asked for | seed | CPU-s | wall s | measured | claimed | peers' CPU-s for the same error |\n|---|---|---|---|---|---|---|---|"
    );
    for (job, run) in scored.ours() {
        let beside = scored.best_of_peers(run).map_or(String::new(), |(peer, cpu_s)| format!("{cpu_s:.2} ({peer})"));
        line(text, run, &job.seed.to_string(), &beside);
    }
    scored.peers().iter().for_each(|run| line(text, run, "", ""));
}

fn line(text: &mut String, run: &Measured, seed: &str, beside: &str) {
    let Measured { who, asked, cpu_s, wall_s, .. } = run;
    let (bake, end) = (if run.bake { ", bake" } else { "" }, if run.reached { "" } else { " (not reached)" });
    let (error, claimed) = (percent(run.error), run.claimed.map_or(String::new(), percent));
    let _ = writeln!(text, "| {who} | {asked}{bake}{end} | {seed} | {cpu_s:.2} | {wall_s:.2} | {error} | {claimed} | {beside} |");
}

/// Writes all runs, errors as fractions; of peers `way` is the program with its setting.
pub fn write_csv(file: &Path, scenes: &[Scored]) -> io::Result<()> {
    let mut writer = csv::Writer::from_path(file)?;
    writer.write_record([
        "scene",
        "way",
        "backend",
        "seed",
        "requested",
        "cpu_s",
        "wall_s",
        "measured",
        "claimed",
        "reached",
        "bake",
    ])?;
    for scored in scenes {
        let scene = scored.problem.name.as_str();
        for (job, run) in scored.ours() {
            let Job { solver, backend, seed, error, .. } = job;
            write_row(&mut writer, run, [scene, solver, backend, &seed.to_string(), &error.to_string()])?;
        }
        for run in scored.peers() {
            write_row(&mut writer, run, [scene, &format!("{}: {}", run.who, run.asked), "", "", ""])?;
        }
    }
    writer.flush()
}

/// A row: what was asked, then what came of it.
fn write_row<W: io::Write>(writer: &mut csv::Writer<W>, run: &Measured, asked: [&str; 5]) -> csv::Result<()> {
    let claimed = run.claimed.map_or(String::new(), |claimed| format!("{claimed:.6}"));
    let (cpu_s, wall_s, measured) = (format!("{:.3}", run.cpu_s), format!("{:.3}", run.wall_s), format!("{:.6}", run.error));
    let (reached, bake) = (run.reached.to_string(), run.bake.to_string());
    writer.write_record(asked.into_iter().chain([cpu_s.as_str(), &wall_s, &measured, &claimed, &reached, &bake]))
}
