//! What a run tells about itself as plots, in PNG: the error against time, where time went, and where light went.

mod bars;
mod canvas;
mod error_plot;
mod look;

use std::io::{self, Write};

use self::bars::{Bar, Bars};
use self::canvas::Canvas;
use self::look::short;
use super::png::write_pixels;
use super::{Provenance, RunReport};

/// What a plot shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Plot {
    /// What was claimed of the error, and measured, against wall seconds, on logarithmic axes, with what was asked for.
    Error,
    /// Wall seconds by stage.
    Time,
    /// W by what became of them, all channels added, by the elements of the solver.
    Light,
}

impl Plot {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Error, Self::Time, Self::Light];

    /// What its file is called.
    pub const fn file_name(self) -> &'static str {
        match self {
            Self::Error => "error.png",
            Self::Time => "time.png",
            Self::Light => "light.png",
        }
    }

    fn draw(self, report: &RunReport) -> Canvas {
        match self {
            Self::Error => error_plot::draw(report),
            Self::Time => of_time(report).draw(),
            Self::Light => of_light(report).draw(),
        }
    }
}

/// Draws a plot of a run and writes it as PNG.
///
/// # Errors
/// What the writer says.
pub fn write_plot(writer: impl Write, plot: Plot, report: &RunReport, provenance: &Provenance) -> io::Result<()> {
    let Canvas { size, pixels } = plot.draw(report);
    let texts = [("Software", provenance.software()), ("Options", provenance.options())];
    let texts = texts.map(|(key, text)| (key.to_owned(), text.to_owned())).to_vec();
    write_pixels(writer, size.map(|side| side as u32), (::png::ColorType::Rgb, &pixels), texts)
}

/// Stages below this many seconds are left out.
const LEAST_SECONDS: f64 = 5e-4;

fn of_time(report: &RunReport) -> Bars<'static> {
    let times = &report.time_s;
    let solve = &times.solve;
    let stages = [
        ("load", times.load),
        ("build", solve.build),
        ("refine", solve.refine),
        ("gather", solve.gather),
        ("push-pull", solve.push_pull),
        ("resolve", solve.resolve),
        ("error", solve.error),
        ("transport", solve.transport),
        ("mesh", solve.mesh),
        ("bounds", solve.bounds),
        ("sample", times.sample),
        ("output", times.output),
    ];
    let other = times.total - stages.iter().map(|(_, seconds)| seconds).sum::<f64>();
    let named = stages.into_iter().chain([("other", other)]).filter(|(_, seconds)| *seconds > LEAST_SECONDS);
    let bar = |(name, value): (&str, f64)| {
        let text = format!("{} s, {:.0}%", short(value), 100.0 * value / times.total.max(LEAST_SECONDS));
        Bar { name: name.to_owned(), value, text }
    };
    Bars {
        title: "Time by stage",
        axis: "wall-clock time (s)",
        bars: named.map(bar).chain([bar(("total", times.total))]).collect(),
    }
}

fn of_light(report: &RunReport) -> Bars<'static> {
    let energy = &report.energy;
    let always = [("emitted", energy.emitted), ("absorbed", energy.absorbed), ("escaped", energy.escaped)];
    let where_any = [
        ("not accounted for", energy.unaccounted),
        ("brought by lights", energy.of_lights),
        ("held back at most", energy.held_back),
        ("held back unseen", energy.held_back_unseen),
    ];
    let rows = always.into_iter().chain(where_any.into_iter().filter(|(_, watts)| *watts != 0.0));
    let bar = |(name, value): (&str, f64)| {
        let share = if energy.emitted > 0.0 { format!(", {:.1}%", 100.0 * value / energy.emitted) } else { String::new() };
        Bar { name: name.to_owned(), value, text: format!("{} W{share}", short(value)) }
    };
    Bars { title: "Light: where its power goes", axis: "power (W, all channels added)", bars: rows.map(bar).collect() }
}
