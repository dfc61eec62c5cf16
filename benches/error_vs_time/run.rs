//! One run of a program: what it took and how wrong it was.

use std::fs::File;
use std::path::Path;
use std::process::Command;
use std::time::Duration;

use super::points::read_values;
use super::problem::{BAKE_POINTS, Problem};
use super::process::{Timed, timed};

/// No run may take longer.
const MOST_SECONDS: &str = "90";
/// Nothing that is run takes longer, references by others included.
const LONGEST: Duration = Duration::from_secs(3600);

/// What the program is asked for.
pub struct Job {
    /// `auto`, `links` or `cells`.
    pub solver: &'static str,
    pub backend: &'static str,
    pub error: f64,
    pub seed: u64,
    /// With the points of a whole bake instead of the scored ones alone.
    pub bake: bool,
}

impl Job {
    pub fn new(solver: &'static str, backend: &'static str, error: f64) -> Self {
        Self { solver, backend, error, seed: 0, bake: false }
    }

    /// What sets the run apart but for the error and the seed: the solver, and what else is not as by default.
    pub fn way(&self) -> String {
        let backend = if self.backend == "auto" { "" } else { ", obvhs" };
        let bake = if self.bake { ", bake" } else { "" };
        format!("{}{backend}{bake}", self.solver)
    }
}

/// What a run took and gave.
pub struct Measured {
    /// Program and way, the same for all runs of one curve.
    pub who: String,
    /// Asked for: an error, or a peer's setting.
    pub asked: String,
    pub requested: Option<f64>,
    pub cpu_s: f64,
    pub wall_s: f64,
    /// `||B - R|| / ||R - E||` at the scored points.
    pub error: f64,
    /// What the reference's own noise adds to that, at most.
    pub reference_noise: f64,
    pub claimed: Option<f64>,
    /// Exit code 0: what was asked for is said to be reached.
    pub reached: bool,
    pub bake: bool,
}

impl Measured {
    pub fn line(&self) -> String {
        let claimed = self.claimed.map_or(String::new(), |claimed| format!(", claimed {:.2}%", 100.0 * claimed));
        let Self { who, asked, cpu_s, wall_s, error, .. } = self;
        let bake = if self.bake { ", bake" } else { "" };
        let end = if self.reached { "" } else { ", not reached" };
        format!("{who}, {asked}{bake}: {cpu_s:.2} CPU-s, {wall_s:.2} s, error {:.2}%{claimed}{end}", 100.0 * error)
    }

    /// Whether what is claimed covers what is measured.
    pub fn claim_holds(&self) -> Option<bool> {
        self.claimed.map(|claimed| self.error <= claimed.hypot(self.reference_noise))
    }
}

/// Runs the program of this build.
pub fn patchlight(problem: &Problem, job: &Job, folder: &Path) -> Measured {
    let (values, report) = (folder.join("values.csv"), folder.join("report.json"));
    let points = if job.bake { problem.bake_points(folder, BAKE_POINTS) } else { problem.points_file(folder) };
    let mut command = Command::new(env!("CARGO_BIN_EXE_patchlight"));
    command.arg("solve").arg(&problem.scene).args(["--error", &job.error.to_string(), "--backend", job.backend]);
    command.args(["--seed", &job.seed.to_string(), "--time", MOST_SECONDS, "--progress", "none"]);
    // As values are scored here.
    command.args(["--norm", "energy", "--set", &format!("solver={}", job.solver)]);
    command.arg("--points").arg(points).arg("--values").arg(&values).arg("--report").arg(&report);
    let timed = timed_well(&mut command);

    let report: serde_json::Value =
        serde_json::from_reader(File::open(&report).expect("the program wrote a report")).expect("a report is JSON");
    // The scored points come first.
    let found = &read_values(&values)[..problem.points.len()];
    let (error, reference_noise) = problem.error_of(found);
    let backend = if job.backend == "auto" { "" } else { ", obvhs" };
    Measured {
        who: format!("patchlight, solver={}{backend}", job.solver),
        asked: format!("{}%", 100.0 * job.error),
        requested: Some(job.error),
        cpu_s: timed.cpu_s,
        wall_s: timed.wall_s,
        error,
        reference_noise,
        claimed: Some(report["error"]["estimate"].as_f64().unwrap_or(f64::INFINITY)),
        reached: timed.code == Some(0),
        bake: job.bake,
    }
}

/// Runs a command some times; it must end well, or by a limit that it was given.
pub fn timed_well(command: &mut Command) -> Timed {
    let timed = timed(command, LONGEST);
    assert!(matches!(timed.code, Some(0 | 4)), "{command:?} ended with {:?}", timed.code);
    timed
}
