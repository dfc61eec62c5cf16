//! Error against time as an SVG file, both axes logarithmic, one line for each way.

use std::collections::BTreeMap;

use super::plot::{Plot, Scale};
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

/// Lines of all ways; whole bakes are ways of their own. A triangle marks the error that is claimed.
pub fn log_log(title: &str, runs: &[Measured], time: Time) -> String {
    let mut curves: BTreeMap<String, Vec<&Measured>> = BTreeMap::new();
    for run in runs {
        let name = if run.bake { format!("{}, bake", run.who) } else { run.who.clone() };
        curves.entry(name).or_default().push(run);
    }
    let measured = |run: &Measured| (time.of(run), 100.0 * run.error);
    let claimed = |run: &Measured| run.claimed.filter(|claimed| claimed.is_finite()).map(|claimed| (time.of(run), 100.0 * claimed));
    let points: Vec<(f64, f64)> = runs.iter().flat_map(|run| [Some(measured(run)), claimed(run)]).flatten().collect();

    let mut plot = Plot::new(title, [Scale::Logarithmic; 2], [" s", "%"], "", &points);
    for (name, mut curve) in curves {
        curve.sort_by(|a, b| time.of(a).total_cmp(&time.of(b)));
        let line: Vec<(f64, f64)> = curve.iter().map(|run| measured(run)).collect();
        plot.curve(&name, &line, curve[0].bake, true);
        curve.iter().filter_map(|run| claimed(run)).for_each(|place| plot.triangle(place));
    }
    plot.finish()
}
