//! Figures 4.4 and 4.5 as SVG files.

use std::fmt::Write as _;
use std::path::Path;

use patchlight::discontinuities::{Degree, of_emitters};
use patchlight::scene::Scene;
use patchlight::solve::Subdivision;

use super::exact::Exact;
use super::ladder::{Comparison, Way};
use super::measure::{Element, Measured, elements, uniform};
use super::plot::{Plot, Scale};

/// Elements of the meshes that are drawn, about; and of the one that shows the light on the floor.
const DRAWN: [usize; 4] = [4, 16, 64, 256];
const FINE: usize = 512;

/// A panel and its margin, in pixels.
const PANEL: f64 = 220.0;
const MARGIN: f64 = 10.0;
const CAPTION: f64 = 18.0;

pub fn draw(scene: &Scene, exact: &Exact, comparisons: &[Comparison], folder: &Path) -> std::io::Result<()> {
    std::fs::write(folder.join("discontinuity_meshing_meshes.svg"), meshes(scene, exact))?;
    for comparison in comparisons.iter().filter(|comparison| comparison.way == Way::Uniform) {
        std::fs::write(folder.join("discontinuity_meshing_errors.svg"), errors(comparison))?;
    }
    Ok(())
}

/// Figure 4.5.
fn errors(comparison: &Comparison) -> String {
    let curve = |rungs: &[Measured], of: &dyn Fn(&Measured) -> f64| -> Vec<(f64, f64)> {
        rungs.iter().map(|rung| (rung.elements as f64, of(rung))).collect()
    };
    let of = |name: &str, rungs: &[Measured]| {
        [
            (format!("L-infinity, {name}"), curve(rungs, &|rung| rung.all.largest), true),
            (format!("RMS, {name}"), curve(rungs, &|rung| rung.all.rms), false),
        ]
    };
    let [regular, driven] = [of("regular", &comparison.regular), of("discontinuities", &comparison.discontinuities)];
    let curves: Vec<_> = regular.into_iter().chain(driven).collect();
    let points: Vec<(f64, f64)> = curves.iter().flat_map(|(_, points, _)| points.clone()).collect();
    let mut plot = Plot::new("Error of the floor, brightest 1", [Scale::Logarithmic; 2], ["", ""], "elements", &points);
    curves.iter().for_each(|(name, points, dashed)| plot.curve(name, points, *dashed, true));
    plot.finish()
}

/// Figure 4.4: the light on the floor and its discontinuities, then meshes of as many elements, discontinuity-driven and regular.
fn meshes(scene: &Scene, exact: &Exact) -> String {
    let area = scene.surface(exact.floor).polygon.area();
    let mut svg = String::new();
    let fine = elements(scene, exact, &uniform(Subdivision::Discontinuities, area / FINE as f64));
    panel(&mut svg, exact, [0, 0], &format!("light, by {} elements", fine.len()), |svg| elements_svg(svg, &fine, false));
    panel(&mut svg, exact, [1, 0], "discontinuities: D0 red, D1 black, D2 blue", |svg| segments_svg(svg, scene, exact));
    for (row, subdivision) in [(1, Subdivision::Discontinuities), (2, Subdivision::Regular)] {
        for (column, count) in DRAWN.into_iter().enumerate() {
            let mesh = with_elements(scene, exact, subdivision, area, count);
            let caption = format!("{subdivision}: {}", mesh.len());
            panel(&mut svg, exact, [column, row], &caption, |svg| elements_svg(svg, &mesh, true));
        }
    }
    let (width, height) = (MARGIN + 4.0 * (PANEL + MARGIN), MARGIN + 3.0 * (PANEL + MARGIN + CAPTION));
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" font-family=\"sans-serif\" font-size=\"11\">\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"white\"/>\n{svg}</svg>\n"
    )
}

/// The finest mesh of elements of at most one area, halved again and again, that has no more than `count`.
fn with_elements(scene: &Scene, exact: &Exact, subdivision: Subdivision, area: f64, count: usize) -> Vec<Element> {
    let mesh = |step: i32| elements(scene, exact, &uniform(subdivision, area * 0.5_f64.powi(step)));
    let mut best = mesh(0);
    for step in 1.. {
        let finer = mesh(step);
        if finer.len() > count {
            break;
        }
        best = finer;
    }
    best
}

fn panel(svg: &mut String, exact: &Exact, [column, row]: [usize; 2], caption: &str, content: impl FnOnce(&mut String)) {
    let x = MARGIN + column as f64 * (PANEL + MARGIN);
    let y = MARGIN + row as f64 * (PANEL + MARGIN + CAPTION);
    let scale = PANEL / (exact.high[0] - exact.low[0]);
    // Writing to a string does not fail.
    let _ = writeln!(svg, "<text x=\"{x}\" y=\"{:.1}\">{caption}</text>", y + 10.0);
    let _ = writeln!(
        svg,
        "<g transform=\"translate({:.3} {:.3}) scale({scale:.3})\" stroke-width=\"{:.4}\">",
        x - scale * exact.low[0],
        y + CAPTION - scale * exact.low[1],
        0.5 / scale
    );
    content(svg);
    svg.push_str("</g>\n");
}

fn elements_svg(svg: &mut String, mesh: &[Element], has_lines: bool) {
    for element in mesh {
        // As a screen shows it, about.
        let grey = (255.0 * element.radiosity.clamp(0.0, 1.0).powf(1.0 / 2.2)).round() as u8;
        let colour = format!("#{grey:02x}{grey:02x}{grey:02x}");
        let corners: String = element.corners.iter().map(|[x, z]| format!("{x:.3},{z:.3} ")).collect();
        let line = if has_lines { "#0072b2" } else { &colour };
        let _ = writeln!(svg, "<polygon points=\"{}\" fill=\"{colour}\" stroke=\"{line}\"/>", corners.trim_end());
    }
}

fn segments_svg(svg: &mut String, scene: &Scene, exact: &Exact) {
    let [[x0, z0], [x1, z1]] = [exact.low, exact.high];
    let _ =
        writeln!(svg, "<rect x=\"{x0}\" y=\"{z0}\" width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"grey\"/>", x1 - x0, z1 - z0);
    for segment in of_emitters(scene, 0.0).of(exact.floor) {
        let colour = match segment.degree {
            Degree::D0 => "red",
            Degree::D1 => "black",
            Degree::D2 => "blue",
        };
        let [[ax, _, az], [bx, _, bz]] = segment.ends();
        let _ = writeln!(svg, "<path d=\"M{ax:.3} {az:.3}L{bx:.3} {bz:.3}\" stroke=\"{colour}\"/>");
    }
}
