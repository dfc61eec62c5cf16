//! What was measured, as Markdown.

use super::measured::{Ladder, Measured, Profile, Rung, Size};
use super::thesis;

pub fn print(measured: &Measured) {
    let configuration = measured.configuration;
    println!("\n### {}. {}\n", configuration.letter(), configuration.name());
    println!("The reference is off by about {:.0e} of the mean.\n", measured.reference_error);
    if !measured.sizes.is_empty() {
        sizes(measured);
        profiles(measured);
    }
    ladders(measured);
}

fn percent(part: f64) -> String {
    format!("{:.2}%", 100.0 * part)
}

fn heading(columns: &[&str]) {
    println!("| {} |\n|{}", columns.join(" | "), "---|".repeat(columns.len()));
}

/// Figures 5.7 to 5.9.
fn sizes(measured: &Measured) {
    println!("Elements of one size, errors over the floor. The thesis, {}.\n", thesis::of_sizes(measured.configuration));
    heading(&[
        "h",
        "links",
        "L1 measured",
        "estimated (5.7)",
        "ratio",
        "estimated at most (5.5)",
        "ratio",
        "from bounds (5.7)",
        "ratio",
        "bound (5.5)",
        "ratio",
        "maximum measured",
        "estimated",
        "bound",
        "probes outside of bounds",
    ]);
    for row in &measured.sizes {
        let (of, estimated, bound) = (row.measured, row.estimated, row.bound);
        println!(
            "| 1/{} | {} | {} | {} | {:.2} | {} | {:.2} | {} | {:.1} | {} | {:.1} | {} | {} | {} | {} |",
            row.per_side,
            row.links,
            percent(of.l1),
            percent(estimated.l1),
            estimated.l1 / of.l1,
            percent(2.0 * estimated.l1),
            2.0 * estimated.l1 / of.l1,
            percent(bound.l1),
            bound.l1 / of.l1,
            percent(2.0 * bound.l1),
            2.0 * bound.l1 / of.l1,
            percent(of.l_infinity),
            percent(estimated.l_infinity),
            percent(bound.l_infinity),
            row.outside
        );
    }
    let [coarse, fine] = [measured.sizes.len() / 2, measured.sizes.len() - 1].map(|k| &measured.sizes[k]);
    let order = |of: fn(&Size) -> f64| (of(coarse) / of(fine)).ln() / (f64::from(fine.per_side) / f64::from(coarse.per_side)).ln();
    println!(
        "\nOrder in h over the finer half: measured {:.2}, estimated {:.2}, bound {:.2}.\n",
        order(|row| row.measured.l1),
        order(|row| row.estimated.l1),
        order(|row| row.bound.l1)
    );
}

/// Figures 5.4 to 5.6.
fn profiles(measured: &Measured) {
    println!(
        "Bounds along the middle of the floor, hierarchical solutions. The thesis, {}.\n",
        thesis::of_bounds(measured.configuration)
    );
    heading(&["links", "sweeps", "mean width", "largest width", "probes outside", "probes within the bounds before"]);
    for (index, profile) in measured.profiles.iter().enumerate() {
        let widths = || profile.bounds.iter().map(|[lower, upper]| (upper - lower) / measured.mean);
        let within = |before: &Profile| {
            let pairs = profile.bounds.iter().zip(&before.bounds);
            pairs.filter(|(now, before)| now[0] >= before[0] - 1e-9 && now[1] <= before[1] + 1e-9).count()
        };
        let nested = index.checked_sub(1).map(|before| within(&measured.profiles[before]));
        println!(
            "| {} | {} | {} | {} | {} | {} |",
            profile.links,
            profile.sweeps,
            percent(widths().sum::<f64>() / profile.bounds.len() as f64),
            percent(widths().fold(0.0, f64::max)),
            profile.outside,
            nested.map_or("".to_owned(), |nested| format!("{nested} of {}", profile.bounds.len()))
        );
    }
    println!();
}

/// Figure 5.10.
fn ladders(measured: &Measured) {
    println!("Links and measured L1 error of the floor. The thesis, {}.\n", thesis::OF_LINKS);
    heading(&["refinement", "links: error (estimated, of all that counts)", "CPU-s of the last"]);
    for ladder in &measured.ladders {
        let rung = |rung: &Rung| {
            let estimated = rung.estimated.map_or(String::new(), |estimated| format!(" ({})", percent(estimated)));
            format!("{}: {}{estimated}", rung.links, percent(rung.l1))
        };
        let rungs: Vec<String> = ladder.rungs.iter().map(rung).collect();
        let cpu_s = ladder.rungs.last().map_or(0.0, |rung| rung.cpu_s);
        println!("| {} | {} | {cpu_s:.1} |", ladder.name, rungs.join("; "));
    }
    let is_brightness = |ladder: &&Ladder| ladder.name.starts_with("brightness");
    let brightness = measured.ladders.iter().filter(is_brightness).flat_map(|ladder| &ladder.rungs);
    if let Some(best) = brightness.min_by(|a, b| a.l1.total_cmp(&b.l1)) {
        println!(
            "\nLinks for the least error that brightness-weighted refinement reached, {} with {}:\n",
            percent(best.l1),
            best.links
        );
        for ladder in measured.ladders.iter().filter(|ladder| !is_brightness(ladder)) {
            match links_for(ladder, best.l1) {
                Some(links) => println!("- {}: {links:.0}, {:.3} of these", ladder.name, links / best.links as f64),
                None => println!("- {}: not reached", ladder.name),
            }
        }
    }
}

/// The links with which a ladder first has no more than this error, between its rungs by a power law.
fn links_for(ladder: &Ladder, error: f64) -> Option<f64> {
    let after = ladder.rungs.iter().position(|rung| rung.l1 <= error)?;
    let Some(before) = after.checked_sub(1) else { return Some(ladder.rungs[after].links as f64) };
    let [before, after] = [before, after].map(|k| (ladder.rungs[k].links as f64, ladder.rungs[k].l1));
    let t = (before.1 / error).ln() / (before.1 / after.1).ln();
    Some(before.0 * (after.0 / before.0).powf(t))
}
