//! One run of the program, and how wrong it was.

use std::fs::File;
use std::path::Path;
use std::process::Command;
use std::time::Duration;

use patchlight::scene::Sides;

use super::norms::{Measured, Norm};
use super::options::sides_name;
use super::points::read_values;
use super::process::timed;
use super::reference::Reference;

/// What the program is told of time, in seconds, and what ends it if it does not listen.
const TIME: &str = "60";
const LONGEST: Duration = Duration::from_secs(120);

/// A scene in a file, its points, and what is right there.
pub struct Problem<'a> {
    pub scene: &'a Path,
    pub sides: Sides,
    pub points: &'a Path,
    pub reference: &'a Reference,
}

/// What is asked for.
#[derive(Clone, Copy)]
pub struct Asked {
    pub norm: Norm,
    pub error: f64,
    pub seed: u64,
}

/// What came of it.
pub struct Run {
    pub asked: Asked,
    pub cpu_s: f64,
    pub wall_s: f64,
    /// 0, or 4 if the program said that it did not reach what was asked for; any other is a fault, none a kill.
    pub code: Option<i32>,
    pub claimed: f64,
    /// In each of [`Norm::ALL`].
    pub measured: [Measured; 2],
    /// Points that got no value.
    pub missed: usize,
    pub values: Vec<[f64; 3]>,
}

impl Run {
    /// Measured in the norm that was asked for.
    pub fn error(&self) -> Measured {
        self.measured[self.asked.norm as usize]
    }

    /// Whether there is an answer.
    pub fn ended_well(&self) -> bool {
        matches!(self.code, Some(0 | 4))
    }

    pub fn line(&self) -> String {
        let Asked { norm, error, seed } = self.asked;
        let [local, energy] = self.measured.map(|measured| 100.0 * measured.error);
        let code = self.code.map_or("killed".to_owned(), |code| code.to_string());
        format!(
            "{} {}%, seed {seed}: {:.2} CPU-s, {:.2} s, local {local:.2}%, energy {energy:.2}%, claimed {:.2}%, exit {code}, {} missed",
            norm.name(),
            100.0 * error,
            self.cpu_s,
            self.wall_s,
            100.0 * self.claimed,
            self.missed
        )
    }
}

/// Runs the program of this build.
pub fn patchlight(problem: &Problem, asked: Asked, folder: &Path) -> Run {
    let (values, report) = (folder.join("values.csv"), folder.join("report.json"));
    for old in [&values, &report] {
        // A run that writes nothing must not be given what another wrote.
        let _ = std::fs::remove_file(old);
    }
    let mut command = Command::new(env!("CARGO_BIN_EXE_patchlight"));
    command.arg("solve").arg(problem.scene).args(["--sides", sides_name(problem.sides)]);
    command.args(["--error", &asked.error.to_string(), "--norm", asked.norm.name()]);
    command.args(["--seed", &asked.seed.to_string(), "--time", TIME, "--progress", "none"]);
    command.arg("--points").arg(problem.points).arg("--values").arg(&values).arg("--report").arg(&report);
    let timed = timed(&mut command, LONGEST);

    let values = if values.is_file() { read_values(&values) } else { vec![[f64::NAN; 3]; problem.reference.points.len()] };
    Run {
        asked,
        cpu_s: timed.cpu_s,
        wall_s: timed.wall_s,
        code: timed.code,
        claimed: claim(&report).unwrap_or(f64::INFINITY),
        measured: Norm::ALL.map(|norm| norm.error(&values, problem.reference)),
        missed: values.iter().filter(|value| !value.iter().all(|x| x.is_finite())).count(),
        values,
    }
}

/// The claim in a report, if there is one.
fn claim(report: &Path) -> Option<f64> {
    let report: serde_json::Value = serde_json::from_reader(File::open(report).ok()?).ok()?;
    report["error"]["estimate"].as_f64()
}
