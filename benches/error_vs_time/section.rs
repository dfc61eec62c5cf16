//! The section of BENCHMARKS.md that this benchmark writes.

use std::fmt::Write as _;
use std::io;
use std::path::Path;

use super::problem::Problem;
use super::run::Measured;

const BEGIN: &str = "<!-- error_vs_time: from here on written by `make bench-error` -->\n";
const END: &str = "<!-- error_vs_time: up to here -->\n";

/// Puts the text between the marks.
pub fn write(file: &Path, text: &str) -> io::Result<()> {
    let old = std::fs::read_to_string(file)?;
    let missing = || io::Error::new(io::ErrorKind::InvalidData, "the marks are missing");
    let (before, rest) = old.split_once(BEGIN).ok_or_else(missing)?;
    let (_, after) = rest.split_once(END).ok_or_else(missing)?;
    std::fs::write(file, format!("{before}{BEGIN}\n{text}\n{END}{after}"))
}

/// All tables.
pub fn text(measured: &[(Problem, Vec<Measured>)]) -> String {
    let mut text = String::new();
    for (problem, runs) in measured {
        curves(&mut text, problem, runs);
    }
    claims(&mut text, measured);
    text
}

fn percent(part: f64) -> String {
    format!("{:.2}%", 100.0 * part)
}

/// One row for every run of one scene; peers, and where they are faster.
fn curves(text: &mut String, problem: &Problem, runs: &[Measured]) {
    let name = &problem.name;
    let _ = writeln!(text, "### {name}\n\n{} points; reference: {}.\n", problem.points.len(), problem.reference_is);
    let file = problem.file_name();
    let _ = writeln!(text, "![error against CPU time](docs/error_vs_time_{file}_cpu.svg)");
    let _ = writeln!(text, "![error against wall time](docs/error_vs_time_{file}_wall.svg)\n");
    let peers: Vec<&Measured> = runs.iter().filter(|run| run.requested.is_none()).collect();
    let _ = writeln!(
        text,
        "| program | asked for | CPU-s | wall s | measured | claimed | peers' CPU-s for the same error |\n|---|---|---|---|---|---|---|"
    );
    let mut lost = Vec::new();
    for run in runs {
        let claimed = run.claimed.map_or(String::new(), percent);
        let beside = if run.requested.is_some() { best_of_peers(&peers, run) } else { None };
        if let Some((peer, cpu_s)) = beside.filter(|(_, cpu_s)| *cpu_s < run.cpu_s) {
            lost.push(format!("{} at {} ({:.2} CPU-s for {peer}'s {cpu_s:.2})", run.who, run.asked, run.cpu_s));
        }
        let beside = beside.map_or(String::new(), |(peer, cpu_s)| format!("{cpu_s:.2} ({peer})"));
        let (bake, end) = (if run.bake { ", bake" } else { "" }, if run.reached { "" } else { " (not reached)" });
        let _ = writeln!(
            text,
            "| {} | {}{bake}{end} | {:.2} | {:.2} | {} | {claimed} | {beside} |",
            run.who,
            run.asked,
            run.cpu_s,
            run.wall_s,
            percent(run.error)
        );
    }
    if peers.is_empty() {
        let _ = writeln!(text, "\nNo peers were installed for this run.\n");
    } else if lost.is_empty() {
        let _ = writeln!(text, "\nNo peer was faster for the same error.\n");
    } else {
        let _ = writeln!(text, "\nWhere we lose: {}.\n", lost.join("; "));
    }
}

/// The peer that takes the least CPU time to the error of a run, by the straight line through its own runs in logarithms, beyond
/// them with the slope of a path tracer.
fn best_of_peers<'a>(peers: &[&'a Measured], run: &Measured) -> Option<(&'a str, f64)> {
    let mut best: Option<(&str, f64)> = None;
    let mut names: Vec<&str> = peers.iter().map(|peer| peer.who.as_str()).collect();
    names.dedup();
    for name in names {
        let mut curve: Vec<(f64, f64)> =
            (peers.iter().filter(|peer| peer.who == name && peer.bake == run.bake)).map(|peer| (peer.error, peer.cpu_s)).collect();
        curve.sort_by(|a, b| b.0.total_cmp(&a.0));
        let (Some(&coarsest), Some(&finest)) = (curve.first(), curve.last()) else { continue };
        let cpu_s = if run.error >= coarsest.0 {
            coarsest.1
        } else if run.error <= finest.0 {
            finest.1 * (finest.0 / run.error).powi(2)
        } else {
            let Some(pair) = curve.windows(2).find(|pair| pair[1].0 <= run.error) else { continue };
            let along = (pair[0].0 / run.error).ln() / (pair[0].0 / pair[1].0).ln();
            pair[0].1 * (pair[1].1 / pair[0].1).powf(along)
        };
        if best.is_none_or(|(_, least)| cpu_s < least) {
            best = Some((name, cpu_s));
        }
    }
    best
}

/// Whether claims are true, over all runs that claimed anything.
fn claims(text: &mut String, measured: &[(Problem, Vec<Measured>)]) {
    let _ = writeln!(text, "### Are the claims true?\n");
    let _ = writeln!(
        text,
        "| scene | runs | claim holds | said to be reached | of these, reached | claimed / measured, median |\n|---|---|---|---|---|---|"
    );
    let mut all = [0; 4];
    let mut untrue = Vec::new();
    for (problem, runs) in measured {
        let claiming: Vec<&Measured> = runs.iter().filter(|run| run.claimed.is_some() && !run.bake).collect();
        let reached: Vec<&&Measured> = claiming.iter().filter(|run| run.reached).collect();
        let is_true = |run: &Measured| run.requested.is_some_and(|requested| run.error <= requested.hypot(run.reference_noise));
        let mut ratios: Vec<f64> =
            claiming.iter().filter_map(|run| Some(run.claimed? / run.error)).filter(|ratio| ratio.is_finite()).collect();
        ratios.sort_by(f64::total_cmp);
        let counts = [
            claiming.len(),
            claiming.iter().filter(|run| run.claim_holds() == Some(true)).count(),
            reached.len(),
            reached.iter().filter(|run| is_true(run)).count(),
        ];
        all.iter_mut().zip(counts).for_each(|(sum, count)| *sum += count);
        untrue.extend(
            claiming.iter().filter(|run| run.claim_holds() == Some(false)).map(|run| format!("{}, {}", problem.name, run.line())),
        );
        let median = ratios.get(ratios.len() / 2).copied().unwrap_or(f64::NAN);
        let [runs, holds, said, true_ones] = counts;
        let _ = writeln!(text, "| {} | {runs} | {holds} | {said} | {true_ones} | {median:.2} |", problem.name);
    }
    let [runs, holds, said, true_ones] = all;
    let _ = writeln!(text, "| all | {runs} | {holds} | {said} | {true_ones} | |\n");
    if !untrue.is_empty() {
        let _ = writeln!(text, "Claims that do not hold:\n");
        let _ = writeln!(text, "- {}", untrue.join("\n- "));
    }
}
