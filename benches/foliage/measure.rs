//! What a method makes of the links, and what it takes.

use patchlight::hierarchy::Hierarchy;
use patchlight::scene::Scene;
use patchlight::transmittance::maps::{MapOptions, MapResolution, Maps};
use patchlight::visibility::{Segment, Visibility};

use crate::cpu::cpu_seconds;
use crate::links::{Crossing, passing, weighted};

/// A method over all links.
#[derive(Default)]
pub struct Measured {
    /// The root mean square, over links, of what the transmittance is off.
    pub error: f64,
    /// The same over links that maps have answered.
    pub error_of_answered: f64,
    /// CPU seconds with maps made, and the part of making them: what a second run with the same maps takes less.
    pub seconds: f64,
    pub making: f64,
    /// The part of the links that maps have answered.
    pub answered: f64,
    /// The root mean square of what maps say that they are off.
    pub claimed: f64,
    pub bytes: u64,
}

/// The methods, on one set of links.
pub struct Ladder<'a> {
    pub scene: &'a Scene,
    pub hierarchy: &'a Hierarchy,
    pub visibility: &'a dyn Visibility,
    pub crossings: &'a [Crossing],
}

impl Ladder<'_> {
    /// So many rays a link.
    pub fn rays(&self, rays: usize) -> Measured {
        let start = cpu_seconds();
        let found: Vec<f64> = self.crossings.iter().map(|crossing| self.by_rays(crossing, rays)).collect();
        let seconds = cpu_seconds() - start;
        let square = |(found, crossing): (&f64, &Crossing)| (found - crossing.passes).powi(2);
        let error = root_mean(found.iter().zip(self.crossings).map(square));
        Measured { error, seconds, ..Measured::default() }
    }

    /// Maps where they are good enough by so many lines, else as many rays as have that error where half of the light passes.
    pub fn maps(&self, resolution: MapResolution, tolerance: f64, lines: usize) -> Measured {
        let rays = ((0.25 / (tolerance * tolerance)).ceil() as usize).min(crate::links::LINES);
        let options = MapOptions { resolution, ..MapOptions::default() };
        let start = cpu_seconds();
        let maps = Maps::new(self.scene, self.hierarchy, &options);
        let ask = |crossing: &Crossing| {
            let lines = &crossing.lines[..lines.min(crossing.lines.len())];
            let segments: Vec<Segment> = lines.iter().map(|line| line.0).collect();
            let answer = maps.estimate(self.hierarchy, crossing.pair, &segments, tolerance);
            answer.map(|(passes, error)| (weighted(lines, passes.into_iter()), error))
        };
        let by_maps: Vec<_> = self.crossings.iter().map(ask).collect();
        let made = cpu_seconds();
        self.crossings.iter().for_each(|crossing| {
            std::hint::black_box(ask(crossing));
        });
        let asked = cpu_seconds();
        let by_rays = |(crossing, by_maps): (&Crossing, &Option<(f64, f64)>)| match by_maps {
            Some((passes, _)) => *passes,
            None => self.by_rays(crossing, rays),
        };
        let found: Vec<f64> = self.crossings.iter().zip(&by_maps).map(by_rays).collect();
        let done = cpu_seconds();

        let square = |(found, crossing): (&f64, &Crossing)| (found - crossing.passes).powi(2);
        let of_answered = self.crossings.iter().zip(&by_maps).filter_map(|(crossing, answer)| {
            let (passes, _) = answer.as_ref()?;
            Some(square((passes, crossing)))
        });
        Measured {
            error: root_mean(found.iter().zip(self.crossings).map(square)),
            error_of_answered: root_mean(of_answered),
            seconds: (made - start) + (done - asked),
            making: (made - start) - (asked - made),
            answered: by_maps.iter().flatten().count() as f64 / self.crossings.len().max(1) as f64,
            claimed: root_mean(by_maps.iter().flatten().map(|(_, error)| error * error)),
            bytes: maps.memory_bytes(),
        }
    }

    fn by_rays(&self, crossing: &Crossing, rays: usize) -> f64 {
        passing(&crossing.lines[..rays.min(crossing.lines.len())], self.visibility)
    }
}

fn root_mean(squares: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = squares.fold((0.0, 0), |(sum, count), square| (sum + square, count + 1));
    if count > 0 { (sum / f64::from(count)).sqrt() } else { 0.0 }
}
