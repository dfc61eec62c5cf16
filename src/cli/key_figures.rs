//! What a solve tells on stderr at its end.

use patchlight::bounds::{BoundsReport, Certainty};
use patchlight::output::RunReport;
use patchlight::solve::{ErrorReport, LitMeshReport, Norm, SolveReport};

use super::light_groups::tell_groups;
use super::progress::Voice;

/// What matters most, on a few lines.
pub fn tell_key_figures(voice: Voice, run: &RunReport, report: &SolveReport) {
    let scene = &run.scene;
    let channels = if scene.channels == 1 { "1 channel".to_owned() } else { format!("{} channels", scene.channels) };
    voice.figure("scene", format_args!("{}: {} surfaces, {channels}", scene.file.display(), scene.surfaces));
    voice.figure("backend", format_args!("{}", report.backend));
    let counts = &report.counts;
    voice.figure("solution", format_args!("{} elements, {} links, {} rays", counts.elements, counts.links, counts.rays));
    let error = &report.error;
    let claim = claim_in_words(error, run.options.norm);
    if run.options.lit_mesh {
        voice.figure("error", format_args!("{claim}, of values at points"));
        voice.figure("mesh", format_args!("{}", mesh_in_words(report)));
    } else {
        let reached = if report.converged { "reached" } else { "not reached" };
        let asked = 100.0 * run.options.error;
        voice.figure("error", format_args!("{claim}; {asked:.2}% asked for: {reached} (stopped by {})", stopped_by_name(report)));
    }
    if let Some(groups) = &report.light_groups {
        tell_groups(voice, groups);
    }
    if let Some(transport) = &report.transport {
        let (terms, mb) = (transport.terms, transport.bytes as f64 * 1e-6);
        voice.figure("transport", format_args!("{terms} terms of paths over {} cells, {mb:.1} MB", transport.cells));
    } else if run.options.keep_transport {
        voice.warn(format_args!("what paths bring is not kept: a limit ended the solve before"));
    }
    if let Some(links) = &report.link_error {
        let part = 100.0 * links.estimated_error / links.reflected;
        voice.figure(
            "links",
            format_args!("leave {part:.2}% of what elements reflect open, weighted by importance: an estimated error"),
        );
    }
    if let Some(bounds) = &report.bounds {
        voice.figure("bounds", format_args!("{}", bounds_in_words(bounds)));
    }
}

/// How good the lit mesh is, or why there is none.
fn mesh_in_words(report: &SolveReport) -> String {
    let Some(mesh) = &report.lit_mesh else {
        return format!("not made: the solve was stopped by {}", stopped_by_name(report));
    };
    let LitMeshReport { elements, nodes, off_values, whole, .. } = mesh;
    let off = 100.0 * off_values.estimate;
    let claim = if whole.estimate.is_finite() {
        let reached = if report.converged { "reached" } else { "not reached" };
        let (claimed, asked) = (100.0 * whole.estimate, 100.0 * report.error.requested);
        format!("{claimed:.2}% claimed of both together; {asked:.2}% asked for: {reached} (stopped by {})", stopped_by_name(report))
    } else {
        "nothing can be said about both together".to_owned()
    };
    format!("{elements} elements, {nodes} nodes, claimed to be {off:.2}% off the values; {claim}")
}

/// What bounds prove. It is a mean over the area, of elements: single points have bounds of their own, which may be wider or narrower.
fn bounds_in_words(bounds: &BoundsReport) -> String {
    let apart = if bounds.relative_error <= 1.0 {
        format!("{:.2}% of the reflected light apart in the mean over the area", 100.0 * bounds.relative_error)
    } else {
        "have not closed in: farther apart, in the mean over the area, than what is certainly reflected".to_owned()
    };
    let in_doubt = bounds.conditions.iter().filter(|condition| condition.could_matter);
    let reasons: Vec<String> = in_doubt.map(|condition| condition.kind.to_string()).collect();
    match (bounds.certainty, bounds.conditions.len()) {
        (Certainty::Estimate, _) if reasons.is_empty() => format!("{apart}: an estimate"),
        (Certainty::Estimate, _) => {
            format!("{apart}: an estimate, because of {}; the report says where", reasons.join(" and "))
        }
        (Certainty::Guaranteed, 1) => format!("{apart}: proved, on a condition that the report lists"),
        (Certainty::Guaranteed, count) => format!("{apart}: proved, on {count} conditions that the report lists"),
    }
}

/// Where light was found on less than this part of the area, the claim says so.
const WORTH_TELLING: f64 = 0.99;

/// The claim, or that there is none: nothing was estimated, or nothing can be.
pub fn claim_in_words(error: &ErrorReport, norm: Norm) -> String {
    if !error.estimate.is_finite() {
        let why = if norm == Norm::Local && error.lit > 0.0 {
            let claimed = error.where_found.map(|found| found.estimate).filter(|claimed| claimed.is_finite());
            let there = claimed.map_or_else(String::new, |claimed| format!(", where {:.2}% is claimed", 100.0 * claimed));
            let lit = 100.0 * error.lit;
            format!("light comes to much of the area by paths too rare to tell how much; it was found on {lit:.0}%{there}")
        } else {
            "too little was done to estimate it".to_owned()
        };
        return format!("nothing can be said about it in the {norm} norm: {why}");
    }
    let (percent, confidence) = (100.0 * error.estimate, 100.0 * error.confidence);
    let where_lit = if norm == Norm::Local && error.lit < WORTH_TELLING {
        format!(", on the {:.0}% of the area where light was found", 100.0 * error.lit)
    } else {
        String::new()
    };
    format!("{percent:.2}% claimed in the {norm} norm with {confidence:.0}% confidence{where_lit}")
}

/// The name that the report uses.
pub fn stopped_by_name(report: &SolveReport) -> String {
    serde_json::to_value(report.stopped_by).ok().and_then(|name| name.as_str().map(str::to_owned)).unwrap_or_default()
}

pub fn tell_time(voice: Voice, run: &RunReport) {
    let time = &run.time_s;
    let cpu = run.cpu_s.total.map_or(String::new(), |seconds| format!(", {seconds:.2} CPU-s"));
    voice.figure(
        "time",
        format_args!(
            "{:.2} s{cpu}: load {:.2}, solve {:.2}, sample {:.2}, output {:.2}",
            time.total,
            time.load,
            time.total - time.load - time.sample - time.output,
            time.sample,
            time.output
        ),
    );
    if run.processes > 1 {
        let megabytes = run.given_bytes as f64 * 1e-6;
        voice.figure("team", format_args!("{} processes, the first of which got {megabytes:.1} MB from the others", run.processes));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_that_is_not_known_is_not_claimed() {
        let known = ErrorReport { estimate: 0.0123, confidence: 0.98, ..ErrorReport::default() };
        assert_eq!(claim_in_words(&known, Norm::Energy), "1.23% claimed in the energy norm with 98% confidence");
        let half = claim_in_words(&ErrorReport { lit: 0.5, ..known }, Norm::Local);
        assert_eq!(half, "1.23% claimed in the local norm with 98% confidence, on the 50% of the area where light was found");
        for estimate in [f64::INFINITY, f64::NAN] {
            let unknown = claim_in_words(&ErrorReport { estimate, ..known }, Norm::Local);
            assert!(unknown.starts_with("nothing can be said about it in the local norm"), "{unknown}");
        }
    }
}
