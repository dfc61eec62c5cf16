//! Figures as small SVG files: one panel, one line a series, iterations across.

use std::fmt::Write as _;
use std::path::Path;

use super::measure::Course;
use super::paper::PaperRoom;
use super::tables::unrefined;

/// How three strategies went in a room.
pub struct Courses {
    pub room: &'static PaperRoom,
    pub original: Course,
    pub lazy: Course,
    pub reduced: Course,
}

/// A line of a plot.
struct Series {
    name: String,
    /// In percent, by iteration.
    values: Vec<f64>,
}

pub fn draw(measured: &[Courses], folder: &Path) -> std::io::Result<()> {
    let each = |value: &dyn Fn(&Courses, usize) -> f64| -> Vec<Series> {
        let values = |m: &Courses| (0..m.original.bounces.len()).map(|k| 100.0 * value(m, k)).collect();
        measured.iter().map(|m| Series { name: m.room.name.to_owned(), values: values(m) }).collect()
    };
    let never = each(&|m, k| unrefined(&m.original.bounces[k]));
    let links = each(&|m, k| m.reduced.bounces[k].links as f64 / m.lazy.bounces[k].links as f64);
    let nodes = each(&|m, k| m.reduced.bounces[k].elements as f64 / m.lazy.bounces[k].elements as f64);
    let time = each(&|m, k| m.reduced.cpu_s[k] / m.lazy.cpu_s[k]);

    // Figure 5 has two lines for each of the paper's two rooms.
    let mut incorrect = Vec::new();
    for m in measured.iter().filter(|m| ["full_office", "dining_room"].contains(&m.room.file)) {
        for (strategy, course) in [("original", &m.original), ("lazy", &m.lazy)] {
            incorrect.push(Series { name: format!("{}, {strategy}", m.room.name), values: incorrect_share(course) });
        }
    }

    for (file, title, series) in [
        ("lazy_linking_figure_2.svg", "Links between surfaces whose BF never exceeded eps_refine, %", never),
        ("lazy_linking_figure_5.svg", "Incorrect energy, %", incorrect),
        ("lazy_linking_figure_6a.svg", "Nodes left after reduction, %", nodes),
        ("lazy_linking_figure_6b.svg", "Links left after reduction, %", links),
        ("lazy_linking_figure_7.svg", "CPU time with reduction, %", time),
    ] {
        std::fs::write(folder.join(file), panel(title, &series))?;
    }
    Ok(())
}

fn incorrect_share(course: &Course) -> Vec<f64> {
    course.bounces.iter().map(|iteration| 100.0 * iteration.incorrect_energy / iteration.total_energy).collect()
}

/// Colours that colour-blind readers tell apart (Okabe, Ito 2008).
const COLOURS: [&str; 5] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00"];

const WIDTH: f64 = 480.0;
const HEIGHT: f64 = 300.0;
const LEFT: f64 = 45.0;
const RIGHT: f64 = 320.0;
const TOP: f64 = 35.0;
const BOTTOM: f64 = 265.0;

/// A plot with its axes from iteration 1 on, and from 0% on.
fn panel(title: &str, series: &[Series]) -> String {
    let most = series.iter().flat_map(|series| &series.values).copied().fold(0.0, f64::max);
    let step = [1.0, 2.0, 5.0, 10.0, 20.0, 25.0].into_iter().find(|step| most / step <= 5.0).unwrap_or(50.0);
    let top = step * (most / step).ceil().max(1.0);
    let count = series.iter().map(|series| series.values.len()).max().unwrap_or(0).max(2);
    let x = |k: usize| LEFT + (RIGHT - LEFT) * k as f64 / (count - 1) as f64;
    let y = |value: f64| BOTTOM - (BOTTOM - TOP) * value / top;

    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" font-family=\"sans-serif\" font-size=\"11\">\n\
         <rect width=\"{WIDTH}\" height=\"{HEIGHT}\" fill=\"white\"/>\n<text x=\"{LEFT}\" y=\"20\" font-size=\"13\">{title}</text>\n"
    );
    let mut tick = 0.0;
    while tick <= top + 1e-9 {
        let at = y(tick);
        let _ = writeln!(svg, "<path d=\"M{LEFT} {at:.1}H{RIGHT}\" stroke=\"#ccc\"/>");
        let _ = writeln!(svg, "<text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{tick}</text>", LEFT - 6.0, at + 4.0);
        tick += step;
    }
    for k in 0..count {
        let _ = writeln!(svg, "<text x=\"{:.1}\" y=\"{}\" text-anchor=\"middle\">{}</text>", x(k), BOTTOM + 15.0, k + 1);
    }
    let middle = 0.5 * (LEFT + RIGHT);
    let _ = writeln!(svg, "<text x=\"{middle}\" y=\"{}\" text-anchor=\"middle\">iteration</text>", BOTTOM + 30.0);
    for (index, series) in series.iter().enumerate() {
        let colour = COLOURS[index % COLOURS.len()];
        let points: Vec<String> = series.values.iter().enumerate().map(|(k, v)| format!("{:.1},{:.1}", x(k), y(*v))).collect();
        let _ = writeln!(svg, "<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"2\"/>", points.join(" "));
        let at = TOP + 10.0 + 18.0 * index as f64;
        let _ = writeln!(svg, "<path d=\"M{} {at}h18\" stroke=\"{colour}\" stroke-width=\"2\"/>", RIGHT + 12.0);
        let _ = writeln!(svg, "<text x=\"{}\" y=\"{}\">{}</text>", RIGHT + 35.0, at + 4.0, series.name);
    }
    svg + "</svg>\n"
}
