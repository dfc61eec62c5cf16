//! Error against time as an SVG file, both axes logarithmic, one line for each way.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use super::run::Measured;

/// Which time goes across.
#[derive(Clone, Copy)]
pub enum Time {
    Cpu,
    Wall,
}

impl Time {
    fn of(self, run: &Measured) -> f64 {
        match self {
            Self::Cpu => run.cpu_s,
            Self::Wall => run.wall_s,
        }
        .max(0.01)
    }
}

/// Colours that colour-blind readers tell apart (Okabe, Ito 2008).
const COLOURS: [&str; 8] = ["#000000", "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#f0e442"];

const WIDTH: f64 = 640.0;
const HEIGHT: f64 = 360.0;
const LEFT: f64 = 50.0;
const RIGHT: f64 = 400.0;
const TOP: f64 = 35.0;
const BOTTOM: f64 = 315.0;

/// An axis from one power of ten to another.
struct Axis {
    low: f64,
    high: f64,
    from: f64,
    to: f64,
}

impl Axis {
    fn over(values: impl Iterator<Item = f64>, from: f64, to: f64) -> Self {
        let (low, high) = values.fold((f64::INFINITY, 0.0), |(low, high), value| (f64::min(low, value), f64::max(high, value)));
        Self { low: low.log10().floor(), high: high.log10().ceil().max(low.log10().floor() + 1.0), from, to }
    }

    fn at(&self, value: f64) -> f64 {
        self.from + (self.to - self.from) * (value.log10() - self.low) / (self.high - self.low)
    }

    fn ticks(&self) -> impl Iterator<Item = f64> + use<> {
        (self.low as i32..=self.high as i32).map(|power| 10f64.powi(power))
    }
}

/// Lines of all ways; whole bakes are ways of their own. A triangle marks the error that is claimed.
pub fn log_log(title: &str, runs: &[Measured], time: Time) -> String {
    let mut curves: BTreeMap<String, Vec<&Measured>> = BTreeMap::new();
    for run in runs {
        let name = if run.bake { format!("{}, bake", run.who) } else { run.who.clone() };
        curves.entry(name).or_default().push(run);
    }
    let x = Axis::over(runs.iter().map(|run| time.of(run)), LEFT, RIGHT);
    let claims = runs.iter().filter_map(|run| run.claimed).filter(|claimed| claimed.is_finite());
    let y = Axis::over(runs.iter().map(|run| 100.0 * run.error).chain(claims.map(|claimed| 100.0 * claimed)), BOTTOM, TOP);

    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" font-family=\"sans-serif\" font-size=\"11\">\n\
         <rect width=\"{WIDTH}\" height=\"{HEIGHT}\" fill=\"white\"/>\n<text x=\"{LEFT}\" y=\"20\" font-size=\"13\">{title}</text>\n"
    );
    for tick in y.ticks() {
        let at = y.at(tick);
        let _ = writeln!(svg, "<path d=\"M{LEFT} {at:.1}H{RIGHT}\" stroke=\"#ccc\"/>");
        let _ = writeln!(svg, "<text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{tick}%</text>", LEFT - 6.0, at + 4.0);
    }
    for tick in x.ticks() {
        let at = x.at(tick);
        let _ = writeln!(svg, "<path d=\"M{at:.1} {TOP}V{BOTTOM}\" stroke=\"#ccc\"/>");
        let _ = writeln!(svg, "<text x=\"{at:.1}\" y=\"{}\" text-anchor=\"middle\">{tick} s</text>", BOTTOM + 15.0);
    }
    for (index, (name, mut curve)) in curves.into_iter().enumerate() {
        curve.sort_by(|a, b| time.of(a).total_cmp(&time.of(b)));
        let colour = COLOURS[index % COLOURS.len()];
        let dash = if curve[0].bake { " stroke-dasharray=\"5 3\"" } else { "" };
        let places: Vec<String> =
            curve.iter().map(|run| format!("{:.1},{:.1}", x.at(time.of(run)), y.at(100.0 * run.error))).collect();
        let _ = writeln!(
            svg,
            "<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\"{dash} stroke-width=\"1.5\"/>",
            places.join(" ")
        );
        for run in &curve {
            let (at, up) = (x.at(time.of(run)), y.at(100.0 * run.error));
            let _ = writeln!(svg, "<circle cx=\"{at:.1}\" cy=\"{up:.1}\" r=\"2.5\" fill=\"{colour}\"/>");
            if let Some(claimed) = run.claimed.filter(|claimed| claimed.is_finite()) {
                let up = y.at(100.0 * claimed);
                let _ = writeln!(svg, "<path d=\"M{:.1} {:.1}l3 5h-6z\" fill=\"none\" stroke=\"{colour}\"/>", at, up - 3.0);
            }
        }
        let at = TOP + 10.0 + 18.0 * index as f64;
        let _ = writeln!(svg, "<path d=\"M{} {at}h18\" stroke=\"{colour}\"{dash} stroke-width=\"2\"/>", RIGHT + 12.0);
        let _ = writeln!(svg, "<text x=\"{}\" y=\"{}\">{name}</text>", RIGHT + 35.0, at + 4.0);
    }
    svg + "</svg>\n"
}
