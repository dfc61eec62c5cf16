//! Ever more elements, by either subdivision.

use patchlight::scene::Scene;
use patchlight::solve::{SolveOptions, Strategy, Subdivision};

use super::exact::Exact;
use super::measure::{Errors, Measured, elements, measure, options, uniform};

/// A ladder ends with the first rung of so many elements of the floor.
const MOST_ELEMENTS: usize = 4000;

/// So many ever finer rungs at most.
const MOST_RUNGS: i32 = 40;

/// The tolerance of the first rung.
const FIRST_TOLERANCE: f64 = 256.0;

/// Orders are told from so many elements on: below that neither has found the shadows.
const FROM: usize = 64;

/// An error of a rung.
type Error = fn(&Measured) -> f64;

/// What decides which elements are split.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Way {
    /// All that are larger than some area.
    Uniform,
    /// Those whose links carry more error, by their area, than some tolerance: the default.
    AreaWeighted,
}

impl Way {
    pub const ALL: [Self; 2] = [Self::Uniform, Self::AreaWeighted];

    pub fn name(self) -> &'static str {
        match self {
            Self::Uniform => "all larger than an area (uniform)",
            Self::AreaWeighted => "by area-weighted error (default)",
        }
    }

    fn options(self, subdivision: Subdivision, area: f64, step: i32) -> SolveOptions {
        let half = 0.5_f64.powi(step);
        match self {
            Self::Uniform => uniform(subdivision, area * half),
            Self::AreaWeighted => options(Strategy::Default, subdivision, FIRST_TOLERANCE * half),
        }
    }
}

/// Both subdivisions by one way.
pub struct Comparison {
    pub way: Way,
    pub regular: Vec<Measured>,
    pub discontinuities: Vec<Measured>,
}

impl Comparison {
    pub fn of(way: Way, scene: &Scene, exact: &Exact) -> Self {
        let area = scene.surface(exact.floor).polygon.area();
        let ladder = |subdivision| {
            let mut rungs: Vec<Measured> = Vec::new();
            let mut step = 0;
            while rungs.last().is_none_or(|last| last.elements < MOST_ELEMENTS) && step < MOST_RUNGS {
                let rung = measure(&elements(scene, exact, &way.options(subdivision, area, step)), exact);
                if rungs.last().is_none_or(|last| rung.elements > last.elements) {
                    rungs.push(rung);
                }
                step += 1;
            }
            rungs
        };
        Self { way, regular: ladder(Subdivision::Regular), discontinuities: ladder(Subdivision::Discontinuities) }
    }

    pub fn print(&self) {
        println!("\n### {}\n", self.way.name());
        for (name, rungs) in [("regular", &self.regular), ("discontinuities", &self.discontinuities)] {
            println!(
                "\n| {name}: elements | RMS | L-infinity | RMS, open floor | L-infinity | RMS of best constants | L-infinity |"
            );
            println!("|---|---|---|---|---|---|---|");
            for rung in rungs {
                let [all, open, best] =
                    [rung.all, rung.open, rung.best].map(|errors: Errors| format!("{:.4} | {:.3}", errors.rms, errors.largest));
                println!("| {} | {all} | {open} | {best} |", rung.elements);
            }
        }
        println!("\n| orders in the number of elements, from {FROM} on | RMS | L-infinity |\n|---|---|---|");
        for (name, rungs) in [("regular", &self.regular), ("discontinuities", &self.discontinuities)] {
            println!("| {name} | {:.2} | {:.2} |", order(rungs, |rung| rung.all.rms), order(rungs, |rung| rung.all.largest));
        }
        let rms: [(&str, Error); 2] = [("RMS", |rung| rung.all.rms), ("RMS of best constants", |rung| rung.best.rms)];
        for (name, error) in rms {
            let ratio = |rung: &Measured| {
                let driven = at(&self.discontinuities, rung.elements, error)?;
                Some(format!("{}: {:.2}", rung.elements, driven / error(rung)))
            };
            let ratios: Vec<String> = self.regular.iter().filter_map(ratio).collect();
            println!("\n{name} of discontinuities over that of regular, at the elements of regular: {}", ratios.join(", "));
        }
    }
}

/// The error with so many elements, between rungs by a power law.
fn at(rungs: &[Measured], elements: usize, error: Error) -> Option<f64> {
    let after = rungs.iter().position(|rung| rung.elements >= elements)?;
    let [before, after] = [after.checked_sub(1)?, after].map(|k| &rungs[k]);
    let logs = |rung: &Measured| ((rung.elements as f64).ln(), error(rung).ln());
    let ((x0, y0), (x1, y1)) = (logs(before), logs(after));
    Some((y0 + (y1 - y0) * ((elements as f64).ln() - x0) / (x1 - x0)).exp())
}

/// Minus the slope of the least-squares line through the logarithms.
fn order(rungs: &[Measured], error: impl Fn(&Measured) -> f64) -> f64 {
    let points: Vec<(f64, f64)> =
        rungs.iter().filter(|rung| rung.elements >= FROM).map(|rung| ((rung.elements as f64).ln(), error(rung).ln())).collect();
    let mean = |of: &dyn Fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / points.len() as f64;
    let (x, y) = (mean(&|p| p.0), mean(&|p| p.1));
    -mean(&|p| (p.0 - x) * (p.1 - y)) / mean(&|p| (p.0 - x).powi(2))
}
