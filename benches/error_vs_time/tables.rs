//! The section of BENCHMARKS.md that this benchmark writes: medians over seeds, and whether claims are true.

use std::fmt::Write as _;

use super::run::Measured;
use super::scored::{Row, Scored};
use super::section::{median, percent};

/// The peer that is meant where none is named.
const USUAL_PEER: &str = "Mitsuba 3";

/// All tables.
pub fn text(scenes: &[Scored]) -> String {
    let mut text = String::new();
    for scored in scenes {
        scene(&mut text, scored);
    }
    claims(&mut text, scenes);
    text
}

/// One scene: a row for each way and requested error, and where peers are faster.
fn scene(text: &mut String, scored: &Scored) {
    let problem = &scored.problem;
    let _ = writeln!(text, "### {}\n\n{} points; reference: {}.\n", problem.name, problem.points.len(), problem.reference_is);
    let _ = writeln!(text, "![error against CPU time](docs/error_vs_time_{}_cpu.svg)\n", problem.file_name());
    let _ = writeln!(
        text,
        "| solver | asked for | CPU-s | measured | claimed | claims hold | peer's CPU-s |\n|---|---|---|---|---|---|---|"
    );
    let rows = scored.rows();
    rows.iter().for_each(|row| line(text, row));
    let lost: Vec<String> = rows.iter().filter_map(lost).collect();
    let _ = match (scored.peers().is_empty(), lost.is_empty()) {
        (true, _) => writeln!(text, "\nNo peers were installed for this run.\n"),
        (false, true) => writeln!(text, "\nNo peer was faster.\n"),
        (false, false) => writeln!(text, "\nWhere we lose: {}.\n", lost.join("; ")),
    };
}

/// One row of a scene's table.
fn line(text: &mut String, row: &Row) {
    let Row { way, cpu_s, runs, holding, .. } = row;
    let requested = 100.0 * row.requested;
    let end = if row.reached < row.runs { format!(" ({} not reached)", row.runs - row.reached) } else { String::new() };
    let (error, claimed) = (percent(row.error), percent(row.claimed));
    let peer = row.peer.as_ref().map_or(String::new(), |(name, cpu_s)| {
        if name == USUAL_PEER { format!("{cpu_s:.2}") } else { format!("{cpu_s:.2} ({name})") }
    });
    let _ = writeln!(text, "| {way} | {requested}%{end} | {cpu_s:.2} | {error} | {claimed} | {holding}/{runs} | {peer} |");
}

/// What to say of a row in which a peer was faster.
fn lost(row: &Row) -> Option<String> {
    let (peer, cpu_s) = row.peer.as_ref().filter(|(_, cpu_s)| *cpu_s < row.cpu_s)?;
    Some(format!("{} at {}% ({:.2} CPU-s for {peer}'s {cpu_s:.2})", row.way, 100.0 * row.requested, row.cpu_s))
}

/// Whether claims are true, over all runs that claimed anything.
fn claims(text: &mut String, scenes: &[Scored]) {
    let _ = writeln!(text, "### Are the claims true?\n");
    let _ = writeln!(
        text,
        "| scene | runs | claim holds | said to be reached | of these, reached | claimed / measured, median |\n|---|---|---|---|---|---|"
    );
    let mut all = [0; 4];
    let mut untrue = Vec::new();
    for scored in scenes {
        let claiming: Vec<&Measured> = scored.runs.iter().filter(|run| run.claimed.is_some() && !run.bake).collect();
        let counts = counts(&claiming);
        all.iter_mut().zip(counts).for_each(|(sum, count)| *sum += count);
        let failing = claiming.iter().filter(|run| run.claim_holds() == Some(false));
        untrue.extend(failing.map(|run| format!("{}, {}", scored.problem.name, run.line())));
        let ratios = claiming.iter().filter_map(|run| Some(run.claimed? / run.error)).filter(|ratio| ratio.is_finite());
        let [runs, holds, said, reached] = counts;
        let ratio = median(ratios);
        let _ = writeln!(text, "| {} | {runs} | {holds} | {said} | {reached} | {ratio:.2} |", scored.problem.name);
    }
    let [runs, holds, said, reached] = all;
    let _ = writeln!(text, "| all | {runs} | {holds} | {said} | {reached} | |\n");
    if !untrue.is_empty() {
        let _ = writeln!(text, "Claims that do not hold:\n");
        let _ = writeln!(text, "- {}", untrue.join("\n- "));
    }
}

/// Runs, those whose claim holds, those said to have reached what was asked for, and those of them that did.
fn counts(claiming: &[&Measured]) -> [usize; 4] {
    let has_reached = |run: &Measured| run.requested.is_some_and(|requested| run.error <= requested.hypot(run.reference_noise));
    let said: Vec<_> = claiming.iter().filter(|run| run.reached).collect();
    let holding = claiming.iter().filter(|run| run.claim_holds() == Some(true)).count();
    [claiming.len(), holding, said.len(), said.iter().filter(|run| has_reached(run)).count()]
}
