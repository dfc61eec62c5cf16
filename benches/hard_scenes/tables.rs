//! What came of all runs: a row for each scene and requested error.

use std::fmt::Write as _;
use std::io;
use std::path::Path;

use super::norms::Norm;
use super::reference::Reference;
use super::run::Run;
use super::scenes::HardScene;
use super::section::{median, percent};

/// A scene and its runs.
pub struct Scored {
    pub name: String,
    pub runs: Vec<Run>,
}

/// The tables of all scenes.
pub fn text(scenes: &[Scored]) -> String {
    let mut text = String::from(
        "| scene | asked for | CPU-s: median, max | max / median | asked / measured | claimed / measured | claims false | reached | said not |\n\
         |---|---|---|---|---|---|---|---|---|\n",
    );
    for scored in scenes {
        let mut asked: Vec<f64> = scored.runs.iter().map(|run| run.asked.error).collect();
        asked.dedup();
        for error in asked {
            row(&mut text, scored, error);
        }
    }
    let faults: Vec<String> = scenes.iter().flat_map(faults).collect();
    let _ = if faults.is_empty() {
        writeln!(text, "\nNo run crashed or had to be killed, and every point got a value.")
    } else {
        writeln!(text, "\nFaults:\n\n- {}", faults.join("\n- "))
    };
    text
}

/// Runs that were asked for the same; seeds that give the same values count once. What was killed took at least what it took.
fn row(text: &mut String, scored: &Scored, error: f64) {
    let mut runs: Vec<&Run> = Vec::new();
    for run in scored.runs.iter().filter(|run| run.asked.error == error) {
        if runs.iter().all(|other| other.values != run.values) {
            runs.push(run);
        }
    }
    let count = runs.len();
    let cpu_s = median(runs.iter().map(|run| run.cpu_s));
    let most = runs.iter().map(|run| run.cpu_s).fold(0.0, f64::max);
    let by_measured =
        |value: fn(&Run) -> f64| median(runs.iter().map(|run| value(run) / run.error().error).filter(|ratio| !ratio.is_nan()));
    let (asked, claimed) = (by_measured(|run| run.asked.error), by_measured(|run| run.claimed));
    let number_of = |is: fn(&Run) -> bool| runs.iter().filter(|run| is(run)).count();
    let wrong = number_of(|run| run.error().least > run.claimed);
    let in_doubt = number_of(|run| run.error().error > run.claimed) - wrong;
    let doubt = if in_doubt > 0 { format!(", {in_doubt} in doubt") } else { String::new() };
    let (reached, said) = (number_of(|run| run.error().error <= run.asked.error), number_of(|run| run.code == Some(4)));
    let _ = writeln!(
        text,
        "| {} | {}% | {cpu_s:.2}, {most:.2} | {:.1} | {asked:.2} | {claimed:.2} | {wrong} of {count}{doubt} | {reached} of {count} | {said} |",
        scored.name,
        100.0 * error,
        most / cpu_s,
    );
}

/// Runs that crashed, were killed or left points without a value.
fn faults(scored: &Scored) -> Vec<String> {
    let is_faulty = |run: &&Run| !run.ended_well() || run.missed > 0;
    scored.runs.iter().filter(is_faulty).map(|run| format!("{}, {}", scored.name, run.line())).collect()
}

/// Writes all runs, errors as fractions.
pub fn write_csv(file: &Path, scenes: &[Scored]) -> io::Result<()> {
    let mut writer = csv::Writer::from_path(file)?;
    writer.write_record([
        "scene",
        "norm",
        "requested",
        "seed",
        "cpu_s",
        "wall_s",
        "local",
        "energy",
        "claimed",
        "code",
        "missed",
    ])?;
    for (name, run) in scenes.iter().flat_map(|scored| scored.runs.iter().map(|run| (scored.name.as_str(), run))) {
        let six = |value: f64| format!("{value:.6}");
        let [local, energy] = run.measured.map(|measured| six(measured.error));
        let code = run.code.map_or(String::new(), |code| code.to_string());
        let (error, seed, missed) = (run.asked.error.to_string(), run.asked.seed.to_string(), run.missed.to_string());
        let (cpu_s, wall_s) = (format!("{:.3}", run.cpu_s), format!("{:.3}", run.wall_s));
        let row = [name, run.asked.norm.name(), &error, &seed, &cpu_s, &wall_s, &local, &energy, &six(run.claimed), &code, &missed];
        writer.write_record(row)?;
    }
    writer.flush()
}

/// The whole of docs/hard_scenes.md.
pub fn document(scenes: &[(HardScene, Reference)]) -> String {
    let mut text = String::from(
        "# Hard scenes\n\nWritten by `cargo bench --bench hard_scenes`, which says how they are made; what runs on them gave stands in \
         [BENCHMARKS.md](../BENCHMARKS.md). Points are uniform by area on all that reflects; references are by path tracing, with their noise, one \
         standard deviation, in both norms.\n\n\
         | scene | what it is | why it is hard | points | noise, local | noise, energy |\n|---|---|---|---|---|---|\n",
    );
    for (HardScene { name, what, why, .. }, reference) in scenes {
        let [local, energy] = Norm::ALL.map(|norm| percent(norm.noise(reference)));
        let _ = writeln!(text, "| {name} | {what} | {why} | {} | {local} | {energy} |", reference.points.len());
    }
    text
}
