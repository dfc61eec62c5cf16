//! Medians over seeds, of runs as by default in the section of BENCHMARKS.md, of all in docs/error_vs_time.md; and whether claims are true.

use std::fmt::Write as _;

use super::run::Measured;
use super::scored::{Row, Scored};
use super::section::{median, percent};

/// The peer that is meant where none is named.
const USUAL_PEER: &str = "Mitsuba 3";

/// The way of runs with nothing set but the error.
const DEFAULT_WAY: &str = "auto";

/// The section: what runs as by default cost in every scene, and whether claims are true.
pub fn text(scenes: &[Scored]) -> String {
    let mut text = String::new();
    defaults(&mut text, scenes);
    claims(&mut text, scenes);
    text
}

/// Runs as by default in all scenes, each beside the fastest peer, and by which runs of any kind a peer was faster.
fn defaults(text: &mut String, scenes: &[Scored]) {
    let _ = writeln!(
        text,
        "| scene | asked for | CPU-s | measured | claimed | claims hold | peer's CPU-s | times ours |\n|---|---|---|---|---|---|---|---|"
    );
    for scored in scenes {
        for row in scored.rows().iter().filter(|row| row.way == DEFAULT_WAY) {
            let times = row.peer.as_ref().map_or(String::new(), |(_, cpu_s)| format!("{:.1}", cpu_s / row.cpu_s));
            let _ = writeln!(text, "| {} | {} {times} |", scored.problem.name, cells(row));
        }
    }

    let lost_in = |scored: &Scored| {
        let lost: Vec<String> = scored.rows().iter().filter_map(lost).collect();
        (!lost.is_empty()).then(|| format!("{}, {}", scored.problem.name, lost.join(", ")))
    };
    let lost: Vec<String> = scenes.iter().filter_map(lost_in).collect();
    let _ = match (scenes.iter().all(|scored| scored.peers().is_empty()), lost.is_empty()) {
        (true, _) => writeln!(text, "\nNo peers were installed for this run.\n"),
        (false, true) => writeln!(text, "\nNo peer was faster, nor than links alone, cells alone, obvhs or a bake.\n"),
        (false, false) => writeln!(text, "\nWhere we lose: {}.\n", lost.join("; ")),
    };
}

/// One scene in docs/error_vs_time.md: a row for each way and requested error.
pub fn medians(text: &mut String, scored: &Scored) {
    let _ = writeln!(
        text,
        "| solver | asked for | CPU-s | measured | claimed | claims hold | peer's CPU-s |\n|---|---|---|---|---|---|---|"
    );
    for row in scored.rows() {
        let _ = writeln!(text, "| {} | {}", row.way, cells(&row));
    }
    let _ = writeln!(text);
}

/// What was asked for, found and claimed, as cells of a table.
fn cells(row: &Row) -> String {
    let Row { cpu_s, runs, holding, .. } = row;
    let requested = 100.0 * row.requested;
    let end = if row.reached < row.runs { format!(" ({} not reached)", row.runs - row.reached) } else { String::new() };
    let (error, claimed) = (percent(row.error), percent(row.claimed));
    let peer = row.peer.as_ref().map_or(String::new(), |(name, cpu_s)| {
        if name == USUAL_PEER { format!("{cpu_s:.2}") } else { format!("{cpu_s:.2} ({name})") }
    });
    format!("{requested}%{end} | {cpu_s:.2} | {error} | {claimed} | {holding}/{runs} | {peer} |")
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
