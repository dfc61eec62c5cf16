//! Fits of the curves, as Markdown.

use super::measure::{Curve, Measured};

/// A curve's name and how to find it, and where the law puts what it hangs on for an error of 2%.
type Column = (&'static str, fn(&Measured) -> &Curve, f64);

const COLUMNS: [Column; 7] = [
    ("noise over links, by rays", |measured| &measured.noise_over_links, 210.0),
    ("noise over cells, by rays", |measured| &measured.noise_over_cells, 230.0),
    ("cells, by positions", |measured| &measured.positions, 4096.0),
    ("cells, by paths from each", |measured| &measured.position_rays, 16.0),
    ("links as swept, by tolerance", |measured| &measured.as_swept, 0.43),
    ("links gathered anew, by tolerance", |measured| &measured.links, 0.43),
    ("number of links, by tolerance", |measured| &measured.link_counts, 0.43),
];

/// `y = y_at (x / at)^power`.
struct Fit {
    power: f64,
    y_at: f64,
}

impl Fit {
    /// By least squares of the logarithms; `None` where fewer than two points are positive.
    fn of(curve: &Curve, at: f64) -> Option<Self> {
        let logs: Vec<(f64, f64)> = curve.iter().filter(|(_, y)| *y > 0.0).map(|(x, y)| ((x / at).ln(), y.ln())).collect();
        let count = logs.len() as f64;
        let mean = logs.iter().fold((0.0, 0.0), |sum, (x, y)| (sum.0 + x / count, sum.1 + y / count));
        let spread: f64 = logs.iter().map(|(x, _)| (x - mean.0).powi(2)).sum();
        let power = logs.iter().map(|(x, y)| (x - mean.0) * (y - mean.1)).sum::<f64>() / spread;
        (logs.len() >= 2).then(|| Self { power, y_at: (mean.1 - power * mean.0).exp() })
    }
}

/// Powers and sizes by scene and over all.
pub fn print(all: &[(String, Measured)]) {
    let names: Vec<&str> = COLUMNS.iter().map(|(name, ..)| *name).collect();
    println!("\n| scene | {} |\n|{}", names.join(" | "), "---|".repeat(COLUMNS.len() + 1));
    let mut powers = COLUMNS.map(|_| Vec::new());
    for (name, measured) in all {
        let fits = COLUMNS.map(|(_, curve, at)| Fit::of(curve(measured), at));
        let cells: Vec<String> = fits.iter().zip(COLUMNS).map(|(fit, (name, ..))| shown(fit.as_ref(), name)).collect();
        println!("| {name} | {} |", cells.join(" | "));
        for (powers, fit) in powers.iter_mut().zip(fits) {
            powers.extend(fit.map(|fit| fit.power));
        }
    }
    powers.iter_mut().for_each(|powers| powers.sort_by(f64::total_cmp));
    let row = |name: &str, at: fn(usize) -> usize| {
        let shown = |powers: &Vec<f64>| powers.get(at(powers.len())).map_or("-".to_owned(), |power| format!("{power:.2}"));
        println!("| {name} | {} |", powers.iter().map(shown).collect::<Vec<_>>().join(" | "));
    };
    row("**least power**", |_| 0);
    row("**median power**", |count| count / 2);
    row("**largest power**", |count| count.saturating_sub(1));
}

/// The power, and the size at 2%: a count, or the root of a square in percent.
fn shown(fit: Option<&Fit>, name: &str) -> String {
    let Some(Fit { power, y_at }) = fit else { return "-".to_owned() };
    if name.starts_with("number") { format!("{power:.2}, {y_at:.0}") } else { format!("{power:.2}, {:.2}%", 100.0 * y_at.sqrt()) }
}
