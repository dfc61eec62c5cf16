//! The paper's tables and figures as Markdown, this implementation beside the paper.

use patchlight::solve::IterationReport;

use super::experiment::Measured;
use super::measure::Run;

pub fn print(measured: &[Measured]) {
    table_1(measured);
    figure_1(measured);
    table_2(measured);
    figure_2(measured);
    table_3(measured);
    counts(measured);
    figure_5(measured);
    figures_6_and_7(measured);
    energy(measured);
    default_strategy(measured);
}

fn heading(title: &str, columns: &[&str]) {
    println!("\n{title}\n\n| {} |\n|{}", columns.join(" | "), "---|".repeat(columns.len()));
}

fn last(run: &Run) -> &IterationReport {
    &run.report.bounces[run.report.bounces.len() - 1]
}

fn ten(run: &Run) -> f64 {
    run.cpu_s[run.cpu_s.len() - 1]
}

pub fn percent(part: f64) -> String {
    format!("{:.1}%", 100.0 * part)
}

fn table_1(measured: &[Measured]) {
    heading("**Table 1.** The rooms.", &["room", "polygons", "what is in it"]);
    for Measured { room, .. } in measured {
        println!("| {} | {} | {} |", room.name, room.polygons, room.description);
    }
}

fn figure_1(measured: &[Measured]) {
    let columns = ["room", "visibility", "form factors", "refine", "gather", "push-pull"];
    heading("**Figure 1.** Where the original algorithm spends its time.", &columns);
    for Measured { room, original, .. } in measured {
        let times = &original.report.time_s;
        let (visibility, form_factor) = (times.visibility, times.form_factor);
        let refine = (times.refine - visibility - form_factor).max(0.0);
        let all = times.refine + times.gather + times.push_pull;
        let shares = [visibility, form_factor, refine, times.gather, times.push_pull].map(|part| percent(part / all));
        println!("| {} | {} |", room.name, shares.join(" | "));
    }
}

fn table_2(measured: &[Measured]) {
    let columns = ["room", "total s", "initial linking s", "share", "paper: total s", "initial linking s", "share"];
    heading("**Table 2.** The original algorithm, ten iterations, and its initial linking.", &columns);
    for Measured { room, original, .. } in measured {
        let times = &original.report.time_s;
        let all = times.refine + times.gather + times.push_pull;
        let (total, linking) = (all, times.initial_linking);
        println!(
            "| {} | {total:.2} | {linking:.2} | {} | {} | {} | {} |",
            room.name,
            percent(linking / total),
            room.original_s,
            room.initial_linking_s,
            percent(room.initial_linking_s / room.original_s)
        );
    }
}

fn figure_2(measured: &[Measured]) {
    let columns = ["room", "after 1", "2", "3", "5", "10"];
    heading("**Figure 2.** Links between surfaces whose BF has never exceeded eps_refine (paper: 65% to 95% after 10).", &columns);
    for Measured { room, original, .. } in measured {
        let share = |k: &usize| unrefined(&original.report.bounces[k - 1]);
        let shares: Vec<String> = [1, 2, 3, 5, 10].iter().map(|k| percent(share(k))).collect();
        println!("| {} | {} |", room.name, shares.join(" | "));
    }
}

/// The part of the top-level links that never carried more than the tolerance.
pub fn unrefined(iteration: &IterationReport) -> f64 {
    1.0 - iteration.top_level_exceeding as f64 / iteration.top_level_links as f64
}

fn table_3(measured: &[Measured]) {
    let columns = ["room", "original", "culling", "lazy", "lazy + reduction", "ratio", "paper", "difference"];
    heading(
        "**Table 3.** CPU-seconds for ten iterations (and for the first picture), ratio of the original to lazy + reduction, \
         the paper's ratio; difference of the two solutions.",
        &columns,
    );
    for m in measured {
        let time = |run: &Run| format!("{:.2} ({:.2})", ten(run), run.cpu_s[0]);
        let paper = m.room.ratios();
        println!(
            "| {} | {} | {} | {} | {} | {:.1} ({:.1}) | {:.1} ({:.1}) | {} |",
            m.room.name,
            time(&m.original),
            time(&m.culling),
            time(&m.lazy),
            time(&m.reduced),
            ten(&m.original) / ten(&m.reduced),
            m.original.cpu_s[0] / m.reduced.cpu_s[0],
            paper[0],
            paper[1],
            percent(m.value_differences[1])
        );
    }
}

fn counts(measured: &[Measured]) {
    let columns = [
        "room",
        "Mrays original",
        "culling",
        "lazy",
        "lazy + reduction",
        "ratio",
        "k links original",
        "lazy",
        "lazy + reduction",
        "ratio",
    ];
    heading("**The same in rays and links**: ten iterations (first picture).", &columns);
    for m in measured {
        let first = |run: &Run| run.report.bounces[0];
        let rays = |run: &Run| format!("{:.2} ({:.2})", last(run).link_rays as f64 * 1e-6, first(run).link_rays as f64 * 1e-6);
        let links = |run: &Run| format!("{:.0} ({:.0})", last(run).links as f64 * 1e-3, first(run).links as f64 * 1e-3);
        let ratio = |of: &dyn Fn(&IterationReport) -> u64| {
            let between = |a: &IterationReport, b: &IterationReport| of(a) as f64 / of(b) as f64;
            format!("{:.1} ({:.1})", between(last(&m.original), last(&m.reduced)), between(&first(&m.original), &first(&m.reduced)))
        };
        println!(
            "| {} | {} | {} | {} | {} | {} | {} | {} | {} | {} |",
            m.room.name,
            rays(&m.original),
            rays(&m.culling),
            rays(&m.lazy),
            rays(&m.reduced),
            ratio(&|iteration| iteration.link_rays),
            links(&m.original),
            links(&m.lazy),
            links(&m.reduced),
            ratio(&|iteration| iteration.links)
        );
    }
}

fn figure_5(measured: &[Measured]) {
    let columns = ["room", "original, after 1", "10", "lazy, after 1", "10", "lazy + reduction, after 1", "10"];
    heading("**Figure 5.** Incorrect energy (equations 1 and 2).", &columns);
    for m in measured {
        let shares: Vec<String> = [&m.original, &m.lazy, &m.reduced]
            .into_iter()
            .flat_map(|run| [&run.report.bounces[0], last(run)])
            .map(|iteration| percent(iteration.incorrect_energy / iteration.total_energy))
            .collect();
        println!("| {} | {} |", m.room.name, shares.join(" | "));
    }
}

fn figures_6_and_7(measured: &[Measured]) {
    let columns = ["room", "nodes, after 1", "10", "links, after 1", "10", "time, after 1", "10"];
    heading(
        "**Figures 6 and 7.** What link reduction leaves of nodes, links and time of lazy linking (paper: about half of the nodes and links, \
         less than half of the time).",
        &columns,
    );
    for m in measured {
        let count = m.lazy.report.bounces.len();
        let share =
            |of: &dyn Fn(&Run, usize) -> f64| [0, count - 1].map(|k| percent(of(&m.reduced, k) / of(&m.lazy, k))).join(" | ");
        println!(
            "| {} | {} | {} | {} |",
            m.room.name,
            share(&|run, k| run.report.bounces[k].elements as f64),
            share(&|run, k| run.report.bounces[k].links as f64),
            share(&|run, k| run.cpu_s[k])
        );
    }
}

fn energy(measured: &[Measured]) {
    let columns = [
        "room",
        "values: lazy",
        "lazy + reduction",
        "culling",
        "elements: lazy",
        "lazy + reduction",
        "culling",
        "held back at most",
        "ambient term adds",
    ];
    heading(
        "**Difference and energy.** Difference from the original of values at points and of elements; what pairs without a link hold back at most, and what the ambient term \
         gives back, as shares of the reflected power (lazy linking).",
        &columns,
    );
    for m in measured {
        let balance = m.lazy.report.energy_balance.unwrap_or_default();
        println!(
            "| {} | {} | {} | {} | {} | {} | {} | {} | {:.2}% |",
            m.room.name,
            percent(m.value_differences[0]),
            percent(m.value_differences[1]),
            percent(m.value_differences[2]),
            percent(m.lazy_difference),
            percent(m.reduced_difference),
            percent(m.culling_difference),
            percent(balance.held_back / balance.reflected),
            100.0 * balance.ambient / balance.reflected
        );
    }
}

fn default_strategy(measured: &[Measured]) {
    let columns =
        ["room", "CPU-s", "claimed", "measured", "Mrays", "k links", "error of original", "lazy + reduction", "reference claims"];
    heading(
        "**The default strategy** asked for 5%, values at points; errors against a solution asked for 2%. Those of the strategies of 1994 are of \
         their elements.",
        &columns,
    );
    for m in measured {
        let Some(found) = &m.default else { continue };
        println!(
            "| {} | {:.2} | {} | {} | {:.2} | {:.0} | {} | {} | {} |",
            m.room.name,
            found.cpu_s,
            percent(found.claimed),
            percent(found.error),
            found.rays as f64 * 1e-6,
            found.links as f64 * 1e-3,
            percent(found.original_error),
            percent(found.reduced_error),
            percent(found.reference_claim)
        );
    }
}
