//! Figures 5.4 to 5.10 as SVG files.

use std::path::Path;

use super::measured::{Measured, Size};
use super::plot::{Plot, Scale};
use super::reference::PROBES;

pub fn draw(measured: &Measured, folder: &Path) -> std::io::Result<()> {
    let letter = measured.configuration.letter();
    if !measured.sizes.is_empty() {
        std::fs::write(folder.join(format!("error_bounds_{letter}_profile.svg")), profile(measured))?;
        std::fs::write(folder.join(format!("error_bounds_{letter}_sizes.svg")), sizes(measured))?;
    }
    std::fs::write(folder.join(format!("error_bounds_{letter}_links.svg")), links(measured))
}

/// Figures 5.4 to 5.6: bounds along the middle of the floor, each constant over a cell of the probes.
fn profile(measured: &Measured) -> String {
    let steps = |value: &dyn Fn(usize) -> f64| -> Vec<(f64, f64)> {
        let place = |k: usize| k as f64 / PROBES as f64;
        (0..PROBES).flat_map(|k| [(place(k), value(k)), (place(k + 1), value(k))]).collect()
    };
    let mut curves = Vec::new();
    for (profile, kind) in measured.profiles.iter().zip(["coarse", "fine"]) {
        for (side, name) in ["lower", "upper"].into_iter().enumerate() {
            curves.push((format!("{name}, {kind}"), steps(&|k| profile.bounds[k][side]), kind == "coarse"));
        }
    }
    let middle = |k: usize| ((k as f64 + 0.5) / PROBES as f64, measured.profile[k]);
    curves.push(("exact".to_owned(), (0..PROBES).map(middle).collect(), false));
    let points: Vec<(f64, f64)> = curves.iter().flat_map(|(_, points, _)| points.clone()).collect();
    let title = format!("{}: bounds along the floor, W/m2", measured.configuration.name());
    let mut plot = Plot::new(&title, [Scale::Linear; 2], ["", ""], "x in m", &points);
    curves.iter().for_each(|(name, points, dashed)| plot.curve(name, points, *dashed, false));
    plot.finish()
}

/// Figures 5.7 to 5.9, both norms.
fn sizes(measured: &Measured) -> String {
    type Part = fn(&Size) -> f64;
    let kinds: [(&str, Part, bool); 6] = [
        ("L1 measured", |row| row.measured.l1, false),
        ("L1 estimated", |row| row.estimated.l1, false),
        ("L1 from bounds", |row| row.bound.l1, false),
        ("maximum measured", |row| row.measured.l_infinity, true),
        ("maximum estimated", |row| row.estimated.l_infinity, true),
        ("maximum from bounds", |row| row.bound.l_infinity, true),
    ];
    let curve = |part: Part| -> Vec<(f64, f64)> {
        measured.sizes.iter().map(|row| (1.0 / f64::from(row.per_side), 100.0 * part(row))).collect()
    };
    let points: Vec<(f64, f64)> = kinds.iter().flat_map(|kind| curve(kind.1)).collect();
    let title = format!("{}: error against element size", measured.configuration.name());
    let mut plot = Plot::new(&title, [Scale::Logarithmic; 2], [" m", "%"], "element size", &points);
    kinds.iter().for_each(|&(name, part, dashed)| plot.curve(name, &curve(part), dashed, true));
    plot.finish()
}

/// Figure 5.10.
fn links(measured: &Measured) -> String {
    let curves: Vec<(&str, Vec<(f64, f64)>)> = measured
        .ladders
        .iter()
        .map(|ladder| (ladder.name, ladder.rungs.iter().map(|rung| (rung.links as f64, 100.0 * rung.l1)).collect()))
        .collect();
    let points: Vec<(f64, f64)> = curves.iter().flat_map(|(_, points)| points.clone()).collect();
    let title = format!("{}: L1 error against links", measured.configuration.name());
    let mut plot = Plot::new(&title, [Scale::Logarithmic; 2], ["", "%"], "links", &points);
    curves.iter().for_each(|(name, points)| plot.curve(name, points, false, true));
    plot.finish()
}
