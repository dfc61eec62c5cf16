//! The strategies of 1998: links are made once, by the error of their form factors alone, and light is swept over them to the end.

use std::time::Instant;

use super::plan::Plan;
use super::report::SkippedWork;
use super::{RunOptions, Solver, Strategy};
use crate::links::{RefineDirection, RefineEnd, SampledContext};
use crate::progress::Stage;
use crate::sweep::Closure;

impl Solver<'_> {
    /// Links all pairs of surfaces (Chang, Shih 1998), and sweeps.
    pub(super) fn link_once(&mut self, plan: &Plan, run: &RunOptions, deadline: Option<Instant>) -> RefineEnd {
        self.report.counts.rounds += 1;
        self.progress(Stage::Refine);
        let start = Instant::now();
        let stop = self.refinement_stop(deadline);
        let areas = self.scene.surfaces().iter().map(|surface| surface.polygon.area());
        let context = SampledContext {
            scene: self.scene,
            rays: self.rays,
            direction: if self.options.strategy == Strategy::TopDown98 {
                RefineDirection::TopDown
            } else {
                RefineDirection::BottomUp
            },
            form_factor_tolerance: self.options.form_factor_tolerance,
            min_area: self.options.bottom_area * areas.fold(0.0, f64::max),
            samples: self.options.bottom_samples,
            seed: self.options.seed,
        };
        let limits = self.refine_limits(plan, run, &stop);
        let found = context.link(&mut self.hierarchy, &limits);
        self.links = found.links;
        let pairs = |what: &str, count: u64| SkippedWork { what: what.to_owned(), count: 2 * count, ..SkippedWork::default() };
        self.report.skipped = vec![
            pairs("pairs of nodes behind one another", found.behind),
            pairs("links of which no sample arrived, which were kept", found.unseen),
        ];

        // Sampled form factors may add up to more than 1, and sweeps must converge all the same.
        self.exposure.grow(self.scene, &self.hierarchy, self.rays, self.options.seed);
        self.radiosity.grow(&self.hierarchy);
        self.closure = Closure::needed(self.scene, &self.hierarchy, &self.links, &self.exposure, false);
        self.report.time_s.refine += start.elapsed().as_secs_f64();
        self.sweep(deadline);
        found.end
    }
}
