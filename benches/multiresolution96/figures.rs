//! Figure 5 for this implementation, errors beside those claimed, and the clusters, as SVG files.

use std::fmt::Write as _;
use std::path::Path;

use super::measure::{Ladder, Rung};
use super::plot::{Plot, Scale};
use super::tables::used;

/// A curve, with its name.
type Curve = (String, Vec<(f64, f64)>);

/// Panels of the drawing of clusters, in pixels, and how many stand side by side.
const PANEL: f64 = 200.0;
const MARGIN: f64 = 14.0;
const COLUMNS: usize = 4;

pub fn draw(ladders: &[Ladder], folder: &Path) -> std::io::Result<()> {
    let Some(first) = ladders.first() else { return Ok(()) };
    let curve = |name: &str, of: &dyn Fn(&Rung) -> f64| -> Curve {
        (name.to_owned(), first.rungs.iter().map(|rung| (rung.tolerance, of(rung))).collect())
    };
    let part = |of: fn(&Rung) -> f64| move |rung: &Rung| 100.0 * of(rung) / of(&first.rungs[0]);
    let cost = [
        curve("CPU time", &part(|rung| rung.cpu_s)),
        curve("clusters that were used", &part(used)),
        curve("clusters that were opened", &part(|rung| rung.found.work.opened as f64)),
        curve("their mean depth", &part(|rung| rung.found.work.mean_depth())),
    ];
    let errors = [
        curve("asked for", &|rung| rung.tolerance),
        curve("claimed", &|rung| rung.found.error),
        curve("true", &|rung| (rung.found.form_factor - first.exact).abs()),
    ];
    let over_root = |ladder: &Ladder| -> Curve {
        let point = |rung: &Rung| (rung.tolerance / ladder.root_error, 100.0 * rung.cpu_s / ladder.rungs[0].cpu_s);
        (ladder.shape.name(), ladder.rungs.iter().map(point).collect())
    };
    let all: Vec<Curve> = ladders.iter().map(over_root).collect();

    let file = |name: &str| folder.join(format!("multiresolution96_{name}.svg"));
    std::fs::write(file("figure_5"), plot("Cost, of that for an error of 0", "%", "epsilon", &cost))?;
    std::fs::write(file("errors"), plot("Error of the form factor", "", "epsilon", &errors))?;
    std::fs::write(file("others"), plot("CPU time, of that for an error of 0", "%", "epsilon over BVE of the root", &all))?;
    std::fs::write(file("clusters"), clusters(ladders))
}

fn plot(title: &str, unit: &str, across: &str, curves: &[Curve]) -> String {
    let points: Vec<(f64, f64)> = curves.iter().flat_map(|(_, points)| points.clone()).collect();
    let mut plot = Plot::new(title, [Scale::Linear; 2], ["", unit], across, &points);
    // Opened ones hide those that were used: a binary tree has one less of them.
    let is_dashed = |name: &str| name.ends_with("opened");
    curves.iter().for_each(|(name, points)| plot.curve(name, points, is_dashed(name), curves.len() <= 4));
    plot.finish()
}

/// The segments of all clusters, each as large as its panel. Light goes up.
fn clusters(ladders: &[Ladder]) -> String {
    let mut svg = String::new();
    for (k, ladder) in ladders.iter().enumerate() {
        let [column, row] = [k % COLUMNS, k / COLUMNS].map(|at| at as f64);
        let (x, y) = (MARGIN + column * (PANEL + MARGIN), MARGIN + row * (PANEL + 2.0 * MARGIN));
        let ends: Vec<[f64; 2]> = ladder.segments.iter().flat_map(|segment| segment.ends()).collect();
        let reach = ends.as_flattened().iter().fold(0.0, |most: f64, at| most.max(at.abs()));
        let at = |[px, py]: [f64; 2]| {
            let middle = 0.5 * PANEL;
            format!("{:.1} {:.1}", x + middle * (1.0 + px / reach), y + MARGIN + middle * (1.0 - py / reach))
        };
        // Writing to a string does not fail.
        let _ = writeln!(svg, "<text x=\"{x}\" y=\"{:.1}\">{}</text>", y + 8.0, ladder.shape.name());
        let lines: String = ends.chunks_exact(2).map(|ends| format!("M{}L{}", at(ends[0]), at(ends[1]))).collect();
        let _ = writeln!(svg, "<path d=\"{lines}\" stroke=\"black\" fill=\"none\"/>");
    }
    let rows = ladders.len().div_ceil(COLUMNS) as f64;
    let (width, height) = (MARGIN + COLUMNS as f64 * (PANEL + MARGIN), MARGIN + rows * (PANEL + 2.0 * MARGIN));
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" font-family=\"sans-serif\" font-size=\"11\">\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"white\"/>\n{svg}</svg>\n"
    )
}
