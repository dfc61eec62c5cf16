//! Tables: error, time and memory of maps beside those of rays alone.

use patchlight::transmittance::maps::MapResolution;

use crate::measure::{Ladder, Measured};

/// How finely maps know lines: direction cells along a side of a face, offset cells along a side.
pub const RESOLUTIONS: [MapResolution; 4] = [of_sides(2), of_sides(4), of_sides(8), of_sides(16)];

/// Rays a link of rays alone.
pub const RAYS: [usize; 5] = [1, 4, 16, 64, 256];

/// Tolerances that maps are asked for, and by how many lines.
pub const ASKED: [(f64, usize); 4] = [(0.2, 4), (0.2, 16), (0.1, 16), (0.1, 64)];

/// So many direction cells along a side, and twice as many offset cells.
const fn of_sides(directions: usize) -> MapResolution {
    MapResolution { directions, offsets: 2 * directions }
}

/// What the methods give over one set of links.
#[derive(Default)]
pub struct Table {
    pub title: String,
    /// Error and CPU seconds of rays alone.
    pub by_rays: Vec<(f64, f64)>,
    pub by_maps: Vec<(MapResolution, Measured)>,
}

impl Table {
    /// Measures, and prints as it goes.
    pub fn fill(&mut self, ladder: &Ladder<'_>) {
        println!(
            "| method | error | of answered | claimed | answered | CPU-ms | rays' CPU-ms for that error | CPU-ms of making maps | MB |"
        );
        println!("|---|---|---|---|---|---|---|---|---|");
        for rays in RAYS {
            let measured = ladder.rays(rays);
            println!("| rays, {rays} a link | {:.3} | | | | {:.1} | | | |", measured.error, 1e3 * measured.seconds);
            self.by_rays.push((measured.error, measured.seconds));
        }
        for resolution in RESOLUTIONS {
            for (tolerance, lines) in ASKED {
                let measured = ladder.maps(resolution, tolerance, lines);
                row(resolution, tolerance, lines, &measured, &self.by_rays);
                self.by_maps.push((resolution, measured));
            }
        }
    }
}

fn row(resolution: MapResolution, tolerance: f64, lines: usize, measured: &Measured, by_rays: &[(f64, f64)]) {
    let MapResolution { directions, offsets } = resolution;
    let Measured { error, error_of_answered, seconds, making, answered, claimed, bytes } = measured;
    println!(
        "| maps {directions}/{offsets}, tolerance {tolerance}, {lines} lines | {error:.3} | {error_of_answered:.3} | {claimed:.3} | {:.0}% | {:.1} | {:.1} \
         | {:.0} | {:.1} |",
        100.0 * answered,
        1e3 * (seconds - making),
        1e3 * seconds_of_rays(*error, by_rays),
        1e3 * making,
        *bytes as f64 * 1e-6
    );
}

/// What rays alone take for an error, between two that were measured; beyond, the square of the error falls as work grows.
fn seconds_of_rays(error: f64, by_rays: &[(f64, f64)]) -> f64 {
    let between = by_rays.windows(2).find(|pair| (pair[1].0..=pair[0].0).contains(&error));
    match between {
        Some(&[(more, less_work), (less, more_work)]) => {
            let part = (more / error).ln() / (more / less).ln();
            less_work * (more_work / less_work).powf(part)
        }
        _ => {
            let (nearest, seconds) = if error > by_rays[0].0 { by_rays[0] } else { by_rays[by_rays.len() - 1] };
            seconds * (nearest / error).powi(2)
        }
    }
}
