//! Small SVG plots: axes, curves, a legend.
#![allow(dead_code, reason = "each benchmark uses a part")]

use std::fmt::Write as _;

/// Colours that colour-blind readers tell apart (Okabe, Ito 2008).
const COLOURS: [&str; 8] = ["#000000", "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#f0e442"];

const WIDTH: f64 = 640.0;
const HEIGHT: f64 = 360.0;
const LEFT: f64 = 50.0;
const RIGHT: f64 = 400.0;
const TOP: f64 = 35.0;
const BOTTOM: f64 = 315.0;

/// How values are spread over an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scale {
    Linear,
    /// From one power of ten to another.
    Logarithmic,
}

/// An axis from `low` to `high`, on a logarithmic scale the powers of ten.
struct Axis {
    scale: Scale,
    low: f64,
    high: f64,
    from: f64,
    to: f64,
}

impl Axis {
    fn over(scale: Scale, values: impl Iterator<Item = f64>, from: f64, to: f64) -> Self {
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
        let (low, high) = match scale {
            Scale::Linear => (low.min(0.0), high),
            Scale::Logarithmic => (low.log10().floor(), high.log10().ceil().max(low.log10().floor() + 1.0)),
        };
        Self { scale, low, high, from, to }
    }

    fn at(&self, value: f64) -> f64 {
        let value = if self.scale == Scale::Linear { value } else { value.log10() };
        self.from + (self.to - self.from) * (value - self.low) / (self.high - self.low)
    }

    fn ticks(&self) -> Vec<f64> {
        match self.scale {
            Scale::Linear => {
                let rough = (self.high - self.low) / 5.0;
                let power = 10f64.powf(rough.log10().floor());
                let step =
                    [1.0, 2.0, 5.0, 10.0].map(|digit| digit * power).into_iter().find(|&step| step >= rough).unwrap_or(power);
                (0..).map(|k| k as f64 * step).take_while(|&tick| tick <= self.high).collect()
            }
            Scale::Logarithmic => (self.low as i32..=self.high as i32).map(|power| 10f64.powi(power)).collect(),
        }
    }
}

/// A plot that is being drawn.
pub struct Plot {
    svg: String,
    x: Axis,
    y: Axis,
    curves: usize,
}

impl Plot {
    /// Axes that have room for all `points`, ticks named with these units, and what goes across named below.
    pub fn new(title: &str, scales: [Scale; 2], units: [&str; 2], across: &str, points: &[(f64, f64)]) -> Self {
        let x = Axis::over(scales[0], points.iter().map(|point| point.0), LEFT, RIGHT);
        let y = Axis::over(scales[1], points.iter().map(|point| point.1), BOTTOM, TOP);
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" font-family=\"sans-serif\" font-size=\"11\">\n\
             <rect width=\"{WIDTH}\" height=\"{HEIGHT}\" fill=\"white\"/>\n<text x=\"{LEFT}\" y=\"20\" font-size=\"13\">{title}</text>\n"
        );
        for tick in y.ticks() {
            let (at, name) = (y.at(tick), name(tick, units[1]));
            let _ = writeln!(svg, "<path d=\"M{LEFT} {at:.1}H{RIGHT}\" stroke=\"#ccc\"/>");
            let _ = writeln!(svg, "<text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{name}</text>", LEFT - 6.0, at + 4.0);
        }
        for tick in x.ticks() {
            let (at, name) = (x.at(tick), name(tick, units[0]));
            let _ = writeln!(svg, "<path d=\"M{at:.1} {TOP}V{BOTTOM}\" stroke=\"#ccc\"/>");
            let _ = writeln!(svg, "<text x=\"{at:.1}\" y=\"{}\" text-anchor=\"middle\">{name}</text>", BOTTOM + 15.0);
        }
        if !across.is_empty() {
            let middle = 0.5 * (LEFT + RIGHT);
            let _ = writeln!(svg, "<text x=\"{middle}\" y=\"{}\" text-anchor=\"middle\">{across}</text>", BOTTOM + 32.0);
        }
        Self { svg, x, y, curves: 0 }
    }

    /// A line through points, with its name in the legend; dots mark the points.
    pub fn curve(&mut self, curve_name: &str, points: &[(f64, f64)], dashed: bool, dots: bool) {
        let colour = COLOURS[self.curves % COLOURS.len()];
        let dash = if dashed { " stroke-dasharray=\"5 3\"" } else { "" };
        let places: Vec<String> = points.iter().map(|&(x, y)| format!("{:.1},{:.1}", self.x.at(x), self.y.at(y))).collect();
        let _ = writeln!(
            self.svg,
            "<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\"{dash} stroke-width=\"1.5\"/>",
            places.join(" ")
        );
        for &(x, y) in points.iter().filter(|_| dots) {
            let (at, up) = (self.x.at(x), self.y.at(y));
            let _ = writeln!(self.svg, "<circle cx=\"{at:.1}\" cy=\"{up:.1}\" r=\"2.5\" fill=\"{colour}\"/>");
        }
        let at = TOP + 10.0 + 18.0 * self.curves as f64;
        let _ = writeln!(self.svg, "<path d=\"M{} {at}h18\" stroke=\"{colour}\"{dash} stroke-width=\"2\"/>", RIGHT + 12.0);
        let _ = writeln!(self.svg, "<text x=\"{}\" y=\"{}\">{curve_name}</text>", RIGHT + 35.0, at + 4.0);
        self.curves += 1;
    }

    /// A triangle that belongs to the curve that was drawn last.
    pub fn triangle(&mut self, (x, y): (f64, f64)) {
        let colour = COLOURS[self.curves.saturating_sub(1) % COLOURS.len()];
        let (at, up) = (self.x.at(x), self.y.at(y));
        let _ = writeln!(self.svg, "<path d=\"M{at:.1} {:.1}l3 5h-6z\" fill=\"none\" stroke=\"{colour}\"/>", up - 3.0);
    }

    pub fn finish(self) -> String {
        self.svg + "</svg>\n"
    }
}

/// A number of a tick, without the digits that rounding leaves.
fn name(tick: f64, unit: &str) -> String {
    format!("{}{unit}", (tick * 1e9).round() / 1e9)
}
