//! Peers' runs as docs/error_vs_time.md tells them, for where no peers are installed.

use std::path::Path;

use super::run::Measured;

/// The runs of peers on a scene that were told last; none if there is no such section.
pub fn runs(root: &Path, scene: &str) -> Vec<Measured> {
    let text = std::fs::read_to_string(root.join("docs/error_vs_time.md")).unwrap_or_default();
    let own = text.split("\n## ").find(|section| section.lines().next() == Some(scene)).unwrap_or_default();
    own.lines().filter_map(run).collect()
}

/// The run of a row of the table; `None` for ours.
fn run(row: &str) -> Option<Measured> {
    let cells: Vec<&str> = row.split('|').map(str::trim).collect();
    let [_, who, asked, _, cpu_s, wall_s, error, ..] = cells[..] else { return None };
    if who.starts_with("patchlight") {
        return None;
    }
    let plain = asked.strip_suffix(", bake");
    Some(Measured {
        who: who.to_owned(),
        asked: plain.unwrap_or(asked).to_owned(),
        requested: None,
        cpu_s: cpu_s.parse().ok()?,
        wall_s: wall_s.parse().ok()?,
        error: 0.01 * error.strip_suffix('%')?.parse::<f64>().ok()?,
        reference_noise: 0.0,
        claimed: None,
        reached: true,
        bake: plain.is_some(),
    })
}
