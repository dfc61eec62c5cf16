//! From the table of a light to the light.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use glam::DVec3;

use super::super::text::{lies_below, read_regular_file};
use super::super::{Diagnostic, DiagnosticKind, ImportError};
use super::photometry::Photometry;
use super::place::{Axes, aside, looking};
use super::strength::{Measure, of_seen, strength};
use super::table::{Table, Value};
use crate::scene::{Distribution, Light, LightShape, Luminaire, PointLight, Sky, SkyLight, Spot, Sun};

/// The mean diameter of the sun as it is seen from the earth, in degrees (Allen's Astrophysical Quantities, 4th edition, section 14.1). Shadows of the sun
/// are that soft, so nobody has to ask for it.
const SUN_DIAMETER: f64 = 0.533;

/// What lights of a file have in common.
pub(super) struct Reader<'a> {
    file: &'a Path,
    channels: usize,
    allow_any_path: bool,
    axes: Axes,
    /// Photometric files that were read, by their paths.
    read: HashMap<PathBuf, Photometry>,
    /// The same in the order in which they were read.
    pub files: Vec<PathBuf>,
    pub notes: Vec<Diagnostic>,
    /// How many lights were given by what an eye sees.
    pub photometric: usize,
}

impl<'a> Reader<'a> {
    pub fn new(file: &'a Path, channels: usize, allow_any_path: bool, axes: Axes) -> Self {
        let (read, files, notes) = (HashMap::new(), Vec::new(), Vec::new());
        Self { file, channels, allow_any_path, axes, read, files, notes, photometric: 0 }
    }

    /// The light of a table.
    pub fn light(&mut self, kind: &str, table: &Table<'_>, name: String) -> Result<Light, ImportError> {
        let (strength, shape) = match kind {
            "point" => self.of_point(table, Distribution::Uniform)?,
            "spot" => self.of_spot(table)?,
            "ies" => self.of_luminaire(table)?,
            "sun" => self.of_sun(table)?,
            _ => self.of_sky(table)?,
        };
        let is_seen = ["candela", "lumens", "lux"].iter().any(|key| table.get(key).is_some());
        self.photometric += usize::from(is_seen || (kind == "ies" && table.get("power").is_none()));
        Ok(Light { name, strength, shape })
    }

    fn position(table: &Table<'_>) -> Result<[f64; 3], ImportError> {
        table.needed("position", "[1, 2, 3]")?.vector()
    }

    fn of_point(&self, table: &Table<'_>, distribution: Distribution) -> Result<(Vec<f64>, LightShape), ImportError> {
        let light = PointLight::new(Self::position(table)?, distribution);
        let solid_angle = light.solid_angle();
        let measures = [
            Measure { key: "intensity", is_photometric: false, per: 1.0 },
            Measure { key: "power", is_photometric: false, per: solid_angle },
            Measure { key: "candela", is_photometric: true, per: 1.0 },
            Measure { key: "lumens", is_photometric: true, per: solid_angle },
        ];
        Ok((self.strength(table, &measures)?, LightShape::Point(light)))
    }

    fn of_spot(&self, table: &Table<'_>) -> Result<(Vec<f64>, LightShape), ImportError> {
        let position = Self::position(table)?;
        let axis = looking(table, position.into())?
            .ok_or_else(|| table.wrong("say where the spot looks: by 'direction', a vector, or 'towards', a point"))?;
        let angle = |said: Value<'_>| Ok(said.number(0.0, 90.0)?.to_radians());
        let outer = angle(table.needed("outer", "30")?)?;
        let inner = table.get("inner").map_or(Ok(0.0), angle)?;
        let spot = Spot::new(axis.to_array(), inner, outer).map_err(|error| table.wrong(error))?;
        self.of_point(table, Distribution::Spot(spot))
    }

    fn of_luminaire(&mut self, table: &Table<'_>) -> Result<(Vec<f64>, LightShape), ImportError> {
        // How it hangs: straight down, with its front to the north.
        let position = DVec3::from(Self::position(table)?);
        let axis = looking(table, position)?.unwrap_or(-self.axes.up);
        let front = match table.get("front") {
            Some(said) => {
                aside(said.vector()?.into(), axis).ok_or_else(|| said.wrong("'front' must point aside of where it looks"))?
            }
            None => aside(self.axes.north, axis).unwrap_or(self.axes.up),
        };

        // What it sends: candelas of its file, at the tilt that it has, or another flux.
        let photometry = self.photometry(table)?;
        let (output, tilt_note) = photometry.at_tilt(axis.angle_between(-self.axes.up));
        let peak = photometry.table.peak();
        let wrong = |error: crate::scene::LightError| table.wrong(error);
        let relative = photometry.table.scaled(1.0 / peak).map_err(wrong)?;
        let luminaire = Luminaire::new(relative, axis.to_array(), front.to_array()).map_err(wrong)?;
        let light = PointLight::new(position.to_array(), Distribution::Luminaire(luminaire));
        let measures = [
            Measure { key: "power", is_photometric: false, per: light.solid_angle() },
            Measure { key: "lumens", is_photometric: true, per: light.solid_angle() },
        ];
        let factor = table.get("factor").map(|said| said.number(0.0, 1e6)).transpose()?;
        let strength = match (strength(table, self.channels, &measures)?, factor) {
            (Some(_), Some(_)) => {
                return Err(table.wrong("'factor' is of the flux of the file: leave out what else says how strong it is"));
            }
            (Some(strength), None) => strength,
            (None, factor) => {
                if let Some(note) = tilt_note {
                    self.notes.push(Diagnostic::new(DiagnosticKind::Light, note).at(self.file, table.line()));
                }
                of_seen(table, self.channels, peak * output * factor.unwrap_or(1.0))?
            }
        };
        Ok((strength, LightShape::Point(light)))
    }

    /// What the photometric file of a table says; each is read once.
    fn photometry(&mut self, table: &Table<'_>) -> Result<Photometry, ImportError> {
        let said = table.needed("file", "\"lamp.ies\"")?;
        let path = self.file.parent().unwrap_or(Path::new("")).join(said.text()?);
        if let Some(known) = self.read.get(&path) {
            return Ok(known.clone());
        }
        if !self.allow_any_path && !lies_below(&path, self.file) {
            return Err(said.wrong(format_args!(
                "{} lies neither beside this file nor below its folder: move it there, or allow any path (--allow-any-path)",
                path.display()
            )));
        }
        let bytes = read_regular_file(&path)
            .map_err(|reason| said.wrong(format_args!("{} cannot be read: {reason}; check the name", path.display())))?;
        let photometry = Photometry::read(&path, &bytes)?;
        let notes = photometry.notes().iter().map(|note| Diagnostic::new(DiagnosticKind::Light, note.as_str()).at(&path, 0));
        self.notes.extend(notes);
        self.files.push(path.clone());
        self.read.insert(path, photometry.clone());
        Ok(photometry)
    }

    fn of_sun(&self, table: &Table<'_>) -> Result<(Vec<f64>, LightShape), ImportError> {
        let towards = self.axes.to_sun(table)?;
        // Below pi / 2, as a sun asks.
        let diameter = table.get("diameter").map_or(Ok(SUN_DIAMETER), |said| said.number(0.0, 89.0))?;
        let sun = Sun::new(towards.to_array(), diameter.to_radians()).map_err(|error| table.wrong(error))?;
        Ok((self.strength(table, &of_area())?, LightShape::Sun(sun)))
    }

    fn of_sky(&self, table: &Table<'_>) -> Result<(Vec<f64>, LightShape), ImportError> {
        let kind = table.needed("kind", "\"overcast\"")?;
        let light = match kind.text()? {
            "uniform" => SkyLight::Uniform,
            "overcast" => SkyLight::Overcast,
            "clear" => SkyLight::Clear { sun: self.axes.to_sun(table)?.to_array() },
            other => return Err(kind.wrong(format_args!("'kind' is '{other}', it must be uniform, overcast or clear"))),
        };
        let ground = table.get("ground").map_or(Ok(0.0), |said| said.number(0.0, 0.99))?;
        let sky = Sky::new(self.axes.up.to_array(), light, ground).map_err(|error| table.wrong(error))?;
        Ok((self.strength(table, &of_area())?, LightShape::Sky(sky)))
    }

    /// The strength, which must be said.
    fn strength(&self, table: &Table<'_>, measures: &[Measure]) -> Result<Vec<f64>, ImportError> {
        let keys: Vec<&str> = measures.iter().map(|measure| measure.key).collect();
        strength(table, self.channels, measures)?
            .ok_or_else(|| table.wrong(format_args!("say how strong the light is, by one of {}", keys.join(", "))))
    }
}

/// Measures of what arrives on an area.
fn of_area() -> [Measure; 2] {
    [Measure { key: "irradiance", is_photometric: false, per: 1.0 }, Measure { key: "lux", is_photometric: true, per: 1.0 }]
}
