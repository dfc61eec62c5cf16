//! `patchlight bake --per-vertex`: light at the vertices of faces.

use std::time::{Duration, Instant};

use patchlight::bake::BakeOptions;
use patchlight::output::{Destination, ExportFormat, Provenance, export_vertex_light};
use patchlight::pipeline::Evaluator;
use patchlight::progress::{Observer, Progress};

use super::exit::{Exit, Failure};
use super::progress::{Voice, Watcher};
use super::ranks;

/// What is written.
#[derive(Debug)]
pub struct PerVertex {
    pub files: Vec<(Destination, ExportFormat)>,
    /// In metres.
    pub within: f64,
}

/// Ends work when the time is over, or an interrupt comes.
struct InTime {
    watcher: Watcher,
    until: Option<Instant>,
}

impl Observer for InTime {
    fn progress(&self, progress: &Progress) {
        self.watcher.progress(progress);
    }

    fn cancelled(&self) -> bool {
        self.watcher.cancelled() || self.until.is_some_and(|until| Instant::now() >= until)
    }
}

impl PerVertex {
    /// Bakes in so many seconds, and writes all files.
    pub fn bake(&self, evaluator: &Evaluator, options: &BakeOptions, time_s: Option<f64>, voice: Voice) -> Result<Exit, Failure> {
        let until = time_s.and_then(|seconds| Instant::now().checked_add(Duration::try_from_secs_f64(seconds).ok()?));
        let observer = InTime { watcher: Watcher::new(voice), until };
        let found = evaluator.bake_vertices(options, self.within, &observer).map_err(Failure::usage)?;
        let is_interrupted = observer.watcher.cancelled();
        drop(observer);
        let Some(light) = found else {
            let why = if is_interrupted { "interrupted" } else { "the time was over" };
            voice.warn(format_args!("light at vertices is not written: {why}"));
            return Ok(if is_interrupted { Exit::Cancelled } else { Exit::Limit });
        };
        let (faces, points, hidden) = (light.surfaces.len(), light.points, light.hidden);
        voice.figure(
            "vertices",
            format_args!(
                "of {faces} faces, gathered at {points} points; around {hidden} something stands, these have the light of others"
            ),
        );
        let solution = evaluator.solution();
        let provenance = Provenance::new(solution.options());
        for (destination, format) in self.files.iter().filter(|_| ranks::is_first()) {
            destination.write(|file| export_vertex_light(file, *format, solution, &light, &provenance))?;
            voice.figure("wrote", format_args!("{} (radiosity in W/m^2 at vertices)", destination.path().display()));
        }
        Ok(Exit::Done)
    }
}
