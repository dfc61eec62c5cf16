//! The strategies of 1998: links are made once, by the error of their form factors alone, and light is swept over them to the end.

use std::time::Instant;

use crate::links::{RefineDirection, RefineEnd, SampledContext};
use crate::progress::Stage;
use crate::solve::linked::Linked;
use crate::solve::options::Strategy;
use crate::solve::report::SkippedWork;
use crate::sweep::Closure;

/// Links all pairs of surfaces (Chang, Shih 1998), and sweeps.
pub(super) fn link_once(linked: &mut Linked<'_>) -> RefineEnd {
    linked.report.counts.rounds += 1;
    linked.progress(Stage::Refine);
    let start = Instant::now();
    let (stop, allows, halt) = (linked.refinement_stop(), linked.refinement_memory(), linked.job.stop());
    let areas = linked.job.scene.surfaces().iter().map(|surface| surface.polygon.area());
    let context = SampledContext {
        scene: linked.job.scene,
        rays: linked.job.rays,
        direction: if linked.job.options.strategy == Strategy::TopDown98 {
            RefineDirection::TopDown
        } else {
            RefineDirection::BottomUp
        },
        form_factor_tolerance: linked.job.options.chang_shih98.form_factor_tolerance,
        min_area: linked.job.options.chang_shih98.bottom_area * areas.fold(0.0, f64::max),
        samples: linked.job.options.chang_shih98.bottom_samples,
        seed: linked.job.options.seed,
    };
    let limits = linked.refine_limits(&stop, &allows, &halt);
    let found = context.link(&mut linked.hierarchy, &limits);
    linked.links = found.links;
    let pairs = |what: &str, count: u64| SkippedWork { what: what.to_owned(), count: 2 * count, ..SkippedWork::default() };
    linked.report.skipped = vec![
        pairs("pairs of nodes behind one another", found.behind),
        pairs("links of which no sample arrived, which were kept", found.unseen),
    ];

    // Sampled form factors may add up to more than 1, and sweeps must converge all the same.
    linked.grow();
    linked.closure = Closure::needed(linked.job.scene, &linked.hierarchy, &linked.links, &linked.exposure, false);
    linked.report.time_s.refine += start.elapsed().as_secs_f64();
    linked.sweep();
    found.end
}
