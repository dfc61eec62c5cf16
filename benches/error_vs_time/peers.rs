//! Programs that others light scenes with, run by small scripts in an environment of their own.

use std::path::{Path, PathBuf};
use std::process::Command;

use super::points::read_values;
use super::problem::{BAKE_POINTS, Problem};
use super::run::{Measured, timed_well};

/// Samples a point that a path tracer takes.
const SAMPLES: [u32; 4] = [16, 64, 256, 1024];

/// For references: another seed, and so many samples that their noise is a tenth of what is scored.
const REFERENCE_SAMPLES: u32 = 16_384;
/// Where the noise is larger than this, so many times as many.
const NOISY: f64 = 0.008;
const MORE_SAMPLES: u32 = 4;

/// Settings of Radiance's rtrace: of those that were tried the best ones for little and for much time.
const RADIANCE: [&str; 2] = ["-ab 4 -aa .3 -ar 16 -ad 128 -as 32", "-ab 6 -aa .3 -ar 8 -ad 256 -as 64"];

/// A Python environment with Mitsuba 3 and perhaps Radiance.
pub struct Peers {
    python: PathBuf,
    scripts: PathBuf,
    radiance: bool,
}

/// The environment that `PATCHLIGHT_PEERS` names, if it is good for anything.
pub fn installed() -> Option<Peers> {
    let environment = PathBuf::from(std::env::var_os("PATCHLIGHT_PEERS")?);
    let python = environment.join("bin/python");
    let imports = |module: &str| {
        let status = Command::new(&python).args(["-c", &format!("import {module}")]).status();
        status.is_ok_and(|status| status.success())
    };
    if !imports("mitsuba") {
        eprintln!("no peers: {} cannot import mitsuba", python.display());
        return None;
    }
    let scripts = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/error_vs_time/peers");
    let radiance = imports("pyradiance");
    Some(Peers { python, scripts, radiance })
}

impl Peers {
    /// All peers and settings on one scene.
    pub fn run(&self, problem: &Problem, folder: &Path) -> Vec<Measured> {
        let points = problem.points_file(folder);
        let values = folder.join("peer.csv");
        let mut runs = Vec::new();
        for samples in SAMPLES {
            let mut command = self.mitsuba(problem, &points, &values, samples, 11);
            runs.push(measure(problem, "Mitsuba 3", &format!("{samples} samples"), &mut command, &values, false));
        }
        if problem.bakes {
            let points = problem.bake_points(folder, BAKE_POINTS);
            for samples in &SAMPLES[..2] {
                let mut command = self.mitsuba(problem, &points, &values, *samples, 11);
                runs.push(measure(problem, "Mitsuba 3", &format!("{samples} samples"), &mut command, &values, true));
            }
        }
        // What both emits and reflects cannot be said in Radiance.
        if self.radiance && problem.reference_is != "exact" {
            for setting in RADIANCE {
                let mut command = Command::new(&self.python);
                command.arg(self.scripts.join("radiance_points.py")).arg(&problem.scene).arg(&points).arg(&values).arg(setting);
                runs.push(measure(problem, "Radiance", setting, &mut command, &values, false));
            }
        }
        runs
    }

    /// A converged reference: values, its noise in the norm of errors, and what it is.
    pub fn reference(&self, problem: &Problem, folder: &Path) -> (Vec<[f64; 3]>, f64, String) {
        let first = self.reference_of(problem, folder, REFERENCE_SAMPLES);
        if first.1 > NOISY { self.reference_of(problem, folder, MORE_SAMPLES * REFERENCE_SAMPLES) } else { first }
    }

    fn reference_of(&self, problem: &Problem, folder: &Path, samples: u32) -> (Vec<[f64; 3]>, f64, String) {
        let points = problem.points_file(folder);
        let halves = [977, 978].map(|seed| {
            let values =
                folder.join(format!("{}_{}_points_{samples}_samples_{seed}.csv", problem.file_name(), problem.points.len()));
            if !values.is_file() {
                timed_well(&mut self.mitsuba(problem, &points, &values, samples, seed));
            }
            read_values(&values)
        });
        let mean: Vec<[f64; 3]> =
            halves[0].iter().zip(&halves[1]).map(|(a, b)| std::array::from_fn(|k| 0.5 * (a[k] + b[k]))).collect();
        let sum_sq = |value: &dyn Fn(usize, usize) -> f64| -> f64 {
            (0..mean.len()).flat_map(|point| (0..3).map(move |k| (point, k))).map(|(point, k)| value(point, k).powi(2)).sum()
        };
        let noise =
            (sum_sq(&|point, k| 0.5 * (halves[0][point][k] - halves[1][point][k])) / sum_sq(&|point, k| mean[point][k])).sqrt();
        (mean, noise, format!("Mitsuba 3, {} samples", 2 * samples))
    }

    fn mitsuba(&self, problem: &Problem, points: &Path, values: &Path, samples: u32, seed: u32) -> Command {
        let mut command = Command::new(&self.python);
        command.arg(self.scripts.join("mitsuba_points.py")).arg(&problem.scene).arg(points).arg(values);
        command.args([samples.to_string(), seed.to_string()]);
        command
    }
}

/// Runs a peer and scores the values that it writes.
fn measure(problem: &Problem, who: &str, asked: &str, command: &mut Command, values: &Path, bake: bool) -> Measured {
    let timed = timed_well(command);
    let (error, reference_noise) = problem.error_of(&read_values(values)[..problem.points.len()]);
    let (who, asked) = (who.to_owned(), asked.to_owned());
    let (cpu_s, wall_s) = (timed.cpu_s, timed.wall_s);
    Measured { who, asked, requested: None, cpu_s, wall_s, error, reference_noise, claimed: None, reached: true, bake }
}
