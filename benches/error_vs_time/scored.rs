//! All runs of one scene: ours beside those of peers.

use super::problem::Problem;
use super::run::{Job, Measured};
use super::section::median;

/// A scene and its runs: one for each job in their order, then those of peers.
pub struct Scored {
    pub problem: Problem,
    pub jobs: Vec<Job>,
    pub runs: Vec<Measured>,
}

/// Runs that differ by their seeds alone: medians, each of its own column.
pub struct Row {
    /// Solver, and what else is not as by default.
    pub way: String,
    pub requested: f64,
    pub cpu_s: f64,
    pub error: f64,
    pub claimed: f64,
    pub runs: usize,
    /// Of these, the ones whose claim holds.
    pub holding: usize,
    /// Of these, the ones that said to have reached what was asked for.
    pub reached: usize,
    /// The fastest peer to `error`, and its CPU seconds.
    pub peer: Option<(String, f64)>,
}

impl Scored {
    /// Our runs, each with what was asked for.
    pub fn ours(&self) -> impl Iterator<Item = (&Job, &Measured)> {
        self.jobs.iter().zip(&self.runs)
    }

    /// The runs of peers.
    pub fn peers(&self) -> &[Measured] {
        &self.runs[self.jobs.len()..]
    }

    /// A row for each way and requested error, way by way.
    pub fn rows(&self) -> Vec<Row> {
        let mut ways: Vec<String> = Vec::new();
        for job in &self.jobs {
            if !ways.contains(&job.way()) {
                ways.push(job.way());
            }
        }
        let mut rows = Vec::new();
        for way in ways {
            let mut requested: Vec<f64> = self.jobs.iter().filter(|job| job.way() == way).map(|job| job.error).collect();
            requested.dedup();
            rows.extend(requested.into_iter().map(|error| self.row(&way, error)));
        }
        rows
    }

    /// Medians over the runs of one way that were asked for the same error.
    fn row(&self, way: &str, requested: f64) -> Row {
        let mut runs: Vec<&Measured> =
            self.ours().filter(|(job, _)| job.way() == way && job.error == requested).map(|(_, run)| run).collect();
        runs.sort_by(|a, b| a.error.total_cmp(&b.error));
        let middle = runs[runs.len() / 2];
        Row {
            way: way.to_owned(),
            requested,
            cpu_s: median(runs.iter().map(|run| run.cpu_s)),
            error: middle.error,
            claimed: median(runs.iter().map(|run| run.claimed.unwrap_or(f64::INFINITY))),
            runs: runs.len(),
            holding: runs.iter().filter(|run| run.claim_holds() == Some(true)).count(),
            reached: runs.iter().filter(|run| run.reached).count(),
            peer: self.best_of_peers(middle).map(|(name, cpu_s)| (name.to_owned(), cpu_s)),
        }
    }

    /// The peer that takes the least CPU time to the error of a run, by the straight line through its own runs in logarithms, beyond
    /// them with the slope of a path tracer.
    pub fn best_of_peers(&self, run: &Measured) -> Option<(&str, f64)> {
        let mut best: Option<(&str, f64)> = None;
        let mut names: Vec<&str> = self.peers().iter().map(|peer| peer.who.as_str()).collect();
        names.dedup();
        for name in names {
            let of_peer = self.peers().iter().filter(|peer| peer.who == name && peer.bake == run.bake);
            let mut curve: Vec<(f64, f64)> = of_peer.map(|peer| (peer.error, peer.cpu_s)).collect();
            curve.sort_by(|a, b| b.0.total_cmp(&a.0));
            let Some(cpu_s) = cpu_s_at(&curve, run.error) else { continue };
            if best.is_none_or(|(_, least)| cpu_s < least) {
                best = Some((name, cpu_s));
            }
        }
        best
    }
}

/// CPU seconds at an error on a curve of errors, falling, and CPU seconds.
fn cpu_s_at(curve: &[(f64, f64)], error: f64) -> Option<f64> {
    let (coarsest, finest) = (curve.first()?, curve.last()?);
    if error >= coarsest.0 {
        return Some(coarsest.1);
    }
    if error <= finest.0 {
        return Some(finest.1 * (finest.0 / error).powi(2));
    }
    let pair = curve.windows(2).find(|pair| pair[1].0 <= error)?;
    let along = (pair[0].0 / error).ln() / (pair[0].0 / pair[1].0).ln();
    Some(pair[0].1 * (pair[1].1 / pair[0].1).powf(along))
}
