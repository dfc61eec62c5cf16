//! Error against time and memory, as SVG files.

use std::path::Path;

use patchlight::transmittance::maps::MapResolution;

use crate::measure::Measured;
use crate::plot::{Plot, Scale};
use crate::tables::{ASKED, RAYS, RESOLUTIONS, Table};

/// A curve, with its name.
type Curve = (String, Vec<(f64, f64)>);

pub fn draw(scene: &str, tables: &[Table; 2], folder: &Path) -> std::io::Result<()> {
    for (table, of) in tables.iter().zip(["tiles", "links"]) {
        let file = |name: &str| folder.join(format!("foliage_{scene}_{of}_{name}.svg"));
        std::fs::write(file("time"), plot(&table.title, "CPU time, ms", &of_time(table)))?;
        std::fs::write(file("memory"), plot(&table.title, "memory of maps, MB", &of_memory(table)))?;
    }
    Ok(())
}

fn name_of(MapResolution { directions, offsets }: MapResolution) -> String {
    format!("{directions}/{offsets}")
}

/// Rays alone, and maps that are made already; with the making of maps beside, dashed.
fn of_time(table: &Table) -> Vec<Curve> {
    let rays = table.by_rays.iter().map(|&(error, seconds)| (1e3 * seconds, error)).collect();
    let mut curves = vec![("rays alone".to_owned(), rays)];
    let of = |resolution: MapResolution, seconds: fn(&Measured) -> f64| {
        let points = table.by_maps.iter().filter(|of| of.0 == resolution);
        points.map(|(_, measured)| (1e3 * seconds(measured), measured.error)).collect()
    };
    for resolution in RESOLUTIONS.into_iter().skip(1) {
        curves.push((
            format!("maps {}, made before", name_of(resolution)),
            of(resolution, |measured| measured.seconds - measured.making),
        ));
    }
    for resolution in RESOLUTIONS.into_iter().skip(1) {
        curves.push((format!("maps {}, with making", name_of(resolution)), of(resolution, |measured| measured.seconds)));
    }
    curves
}

/// By how finely maps know lines, with rays for what they do not answer; as many rays alone beside, dashed, which take no memory.
fn of_memory(table: &Table) -> Vec<Curve> {
    let mut curves = Vec::new();
    for (rung, &(tolerance, lines)) in ASKED.iter().enumerate() {
        let measured = table.by_maps.iter().skip(rung).step_by(ASKED.len());
        let points: Vec<_> = measured.map(|(_, measured)| (1e-6 * measured.bytes as f64, measured.error)).collect();
        curves.push((format!("maps, {lines} lines, tolerance {tolerance}"), points));
    }
    let bytes = curves.iter().flat_map(|(_, points)| points.iter().map(|point| point.0));
    let (least, most) = bytes.fold((f64::INFINITY, 0.0), |(least, most): (f64, f64), bytes| (least.min(bytes), most.max(bytes)));
    for (&rays, &(error, _)) in RAYS.iter().zip(&table.by_rays) {
        curves.push((format!("{rays} rays a link"), vec![(least, error), (most, error)]));
    }
    curves
}

fn plot(title: &str, across: &str, curves: &[Curve]) -> String {
    let points: Vec<(f64, f64)> = curves.iter().flat_map(|(_, points)| points.clone()).collect();
    let mut plot = Plot::new(&format!("Error of the transmittance, {title}"), [Scale::Logarithmic; 2], ["", ""], across, &points);
    let is_dashed = |name: &str| name.ends_with("making") || name.ends_with("a link");
    curves.iter().for_each(|(name, points)| plot.curve(name, points, is_dashed(name), true));
    plot.finish()
}
