//! What is in a scene, in figures.

use std::collections::HashSet;
use std::fmt;

use serde::Serialize;

use super::import::{Diagnostics, Severity};
use super::{LUMENS_PER_WATT, Light, Scene, Surface, luminance};

/// The figures of a scene, with what was repaired and what is suspicious. Lengths in metres.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SceneSummary {
    /// Different vertex positions.
    pub vertices: usize,
    /// Faces of the input that are in the scene.
    pub faces: usize,
    /// Surfaces: convex planar one-sided polygons.
    pub surfaces: usize,
    /// Triangles that the surfaces consist of.
    pub triangles: usize,
    /// Pairs of surfaces that are the two sides of one sheet.
    pub sheets: usize,
    /// Different planes.
    pub planes: usize,
    /// Materials that surfaces have.
    pub materials: usize,
    /// Surfaces that emit.
    pub emitters: usize,
    /// Spectral channels.
    pub channels: usize,
    /// Area of all surfaces in m^2; a sheet counts on both sides.
    pub area: f64,
    /// Emitted power in W, per channel.
    pub emitted_power: Vec<f64>,
    /// Lights that are no surfaces.
    pub lights: Vec<LightSummary>,
    /// Lower and upper corner of the box around all.
    pub bounds: [[f64; 3]; 2],
    /// Area of the largest surface in m^2, and the number of its face in the file, from 1.
    pub largest: (f64, u32),
    /// Area of the smallest surface in m^2, and the number of its face in the file, from 1.
    pub smallest: (f64, u32),
    /// The lowest and the highest reflectance of any surface in any channel.
    pub reflectance: [f64; 2],
    /// Mean reflectance over area and channels.
    pub mean_reflectance: f64,
    /// What was repaired, in a few lines of each kind.
    pub repairs: Vec<String>,
    /// What is suspicious.
    pub suspicions: Vec<String>,
    /// What else is worth knowing.
    pub notes: Vec<String>,
}

/// A light in figures.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LightSummary {
    /// Its name.
    pub name: String,
    /// Its kind, as in `spot`.
    pub kind: &'static str,
    /// By channel: of a light at a point its flux in W, of a sun the irradiance in W/m^2 of what faces it, of a sky that of the ground.
    pub amount: Vec<f64>,
    /// The unit of that.
    pub unit: &'static str,
    /// The same as an eye sees it, in lm or lx; `None` of spectral bands.
    pub seen: Option<f64>,
}

impl LightSummary {
    fn of(light: &Light) -> Self {
        let (amount, unit) = light.flux().map_or_else(|| (light.strength.clone(), "W/m^2"), |flux| (flux, "W"));
        let seen = luminance(&amount).map(|watts| watts * LUMENS_PER_WATT);
        Self { name: light.name.clone(), kind: light.kind(), amount, unit, seen }
    }
}

/// `'name', spot: 1.0000 1.0000 1.0000 W, 179.0 lm`
impl fmt::Display for LightSummary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let amount: Vec<String> = self.amount.iter().map(|value| format!("{value:.4}")).collect();
        write!(f, "'{}', {}: {} {}", self.name, self.kind, amount.join(" "), self.unit)?;
        let unit = if self.unit == "W" { "lm" } else { "lx" };
        self.seen.map_or(Ok(()), |seen| write!(f, ", {seen:.1} {unit}"))
    }
}

impl SceneSummary {
    /// The figures of `scene`, with the lines of what was noted about it.
    pub fn new(scene: &Scene, diagnostics: &Diagnostics) -> Self {
        let surfaces = scene.surfaces();
        let distinct = |number: &dyn Fn(&Surface) -> u32| surfaces.iter().map(number).collect::<HashSet<_>>().len();
        let material = |surface: &Surface| &scene.materials()[surface.material as usize];
        let vertices: HashSet<[u64; 3]> =
            surfaces.iter().flat_map(|s| s.polygon.vertices()).map(|v| v.map(|x| (x + 0.0).to_bits())).collect();

        // Sums over area, channel by channel.
        let area: f64 = surfaces.iter().map(|surface| surface.polygon.area()).sum();
        let mut emitted_power = vec![0.0; scene.channels()];
        let mut reflected = 0.0;
        let mut reflectance = [f64::INFINITY, f64::NEG_INFINITY];
        for surface in surfaces {
            let (material, area) = (material(surface), surface.polygon.area());
            for (power, exitance) in emitted_power.iter_mut().zip(&material.exitance) {
                *power += exitance * area;
            }
            for &rho in &material.reflectance {
                reflected += rho * area / scene.channels() as f64;
                reflectance = [reflectance[0].min(rho), reflectance[1].max(rho)];
            }
        }

        // The first of equals, so that the answer does not depend on chance.
        let sized = || surfaces.iter().map(|surface| (surface.polygon.area(), surface.face + 1));
        let first_of = |better: fn(f64, f64) -> bool| {
            sized().reduce(|best, next| if better(next.0, best.0) { next } else { best }).unwrap_or((0.0, 0))
        };
        let bounds = scene.bounds();
        Self {
            vertices: vertices.len(),
            faces: distinct(&|surface| surface.face),
            surfaces: surfaces.len(),
            triangles: surfaces.iter().map(|surface| surface.polygon.vertices().len() - 2).sum(),
            sheets: surfaces.iter().filter(|surface| surface.twin.is_some()).count() / 2,
            planes: distinct(&|surface| surface.plane),
            materials: distinct(&|surface| surface.material),
            emitters: surfaces.iter().filter(|surface| material(surface).emits()).count(),
            channels: scene.channels(),
            area,
            emitted_power,
            lights: scene.lights().iter().map(LightSummary::of).collect(),
            bounds: [bounds.min(), bounds.max()],
            largest: first_of(|next, best| next > best),
            smallest: first_of(|next, best| next < best),
            reflectance,
            mean_reflectance: reflected / area,
            repairs: diagnostics.lines(Severity::Repair),
            suspicions: diagnostics.lines(Severity::Suspicion),
            notes: diagnostics.lines(Severity::Note),
        }
    }
}

/// A few lines of text for a terminal.
impl fmt::Display for SceneSummary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let list = |values: &[f64]| values.iter().map(|value| format!("{value:.4}")).collect::<Vec<_>>().join(" ");
        writeln!(f, "faces        {} on {} vertices in {} planes", self.faces, self.vertices, self.planes)?;
        writeln!(f, "surfaces     {} ({} triangles, {} two-sided sheets)", self.surfaces, self.triangles, self.sheets)?;
        writeln!(
            f,
            "area         {:.6} m^2, from {:.3e} (face {}) to {:.3e} (face {})",
            self.area, self.smallest.0, self.smallest.1, self.largest.0, self.largest.1
        )?;
        writeln!(f, "bounds       {} to {} m", list(&self.bounds[0]), list(&self.bounds[1]))?;
        writeln!(f, "materials    {}", self.materials)?;
        writeln!(f, "reflectance  {:.3} to {:.3}, mean {:.3}", self.reflectance[0], self.reflectance[1], self.mean_reflectance)?;
        writeln!(f, "emitters     {} surfaces, {} W in {} channels", self.emitters, list(&self.emitted_power), self.channels)?;
        self.lights.iter().try_for_each(|light| writeln!(f, "light        {light}"))?;
        for (heading, lines) in [("repaired", &self.repairs), ("suspicious", &self.suspicions), ("notes", &self.notes)] {
            if !lines.is_empty() {
                writeln!(f, "{heading}:")?;
                lines.iter().try_for_each(|line| writeln!(f, "  {line}"))?;
            }
        }
        Ok(())
    }
}
