//! Where lights are and where they look: the axes of a file, and directions of lights.

use glam::DVec3;

use super::super::ImportError;
use super::table::Table;
use crate::scene::Up;

/// The axes of the world: unit vectors.
pub(super) struct Axes {
    pub up: DVec3,
    pub north: DVec3,
    pub east: DVec3,
}

impl Axes {
    /// Of the table at the top of a file: `up` is "x", "y" or "z" or a vector; if nothing is said that of the scene, else y; `north` is a vector across it: if nothing is said, -z
    /// where y is up, y where z is up, z where x is up, and else the axis that is most across.
    pub fn of(table: &Table<'_>, of_scene: Option<Up>) -> Result<Self, ImportError> {
        let up = match table.get("up") {
            None => of_scene.unwrap_or(Up::Y).vector(),
            Some(up) if up.is_text() => match up.text()? {
                "x" => DVec3::X,
                "y" => DVec3::Y,
                "z" => DVec3::Z,
                other => return Err(up.wrong(format_args!("'up' is '{other}', it must be x, y or z, or three numbers"))),
            },
            Some(up) => unit(up.vector()?).ok_or_else(|| up.wrong("'up' is no vector of a length above 0"))?,
        };
        let north = match table.get("north") {
            Some(north) => {
                let across = DVec3::from(north.vector()?);
                aside(across, up).ok_or_else(|| north.wrong("'north' must point aside of 'up', not along it"))?
            }
            None => {
                let axes = [DVec3::NEG_Z, DVec3::Y, DVec3::Z];
                let number = (0..3).min_by(|&a, &b| up.dot(axes[a]).abs().total_cmp(&up.dot(axes[b]).abs())).unwrap_or(0);
                let fallback = axes[number];
                let chosen = [(DVec3::Y, DVec3::NEG_Z), (DVec3::Z, DVec3::Y), (DVec3::X, DVec3::Z)];
                let north = chosen.iter().find(|(axis, _)| *axis == up).map_or(fallback, |(_, north)| *north);
                aside(north, up).unwrap_or(north)
            }
        };
        Ok(Self { up, north, east: north.cross(up) })
    }

    /// Unit vector to a sun: `azimuth` in degrees from north over east, and `elevation` in degrees over the horizon; or against the `direction` in which
    /// its light goes.
    pub fn to_sun(&self, table: &Table<'_>) -> Result<DVec3, ImportError> {
        let (direction, azimuth, elevation) = (table.get("direction"), table.get("azimuth"), table.get("elevation"));
        match (direction, azimuth, elevation) {
            (Some(direction), None, None) => {
                unit(direction.vector()?).map(|to| -to).ok_or_else(|| direction.wrong("'direction' has no length"))
            }
            (None, Some(azimuth), Some(elevation)) => {
                let (sin, cos) = azimuth.number(-360.0, 360.0)?.to_radians().sin_cos();
                let (height, across) = elevation.number(-90.0, 90.0)?.to_radians().sin_cos();
                Ok((across * (cos * self.north + sin * self.east) + height * self.up).normalize())
            }
            _ => Err(table.wrong(
                "say where the sun stands: by 'azimuth', in degrees from north over east, and 'elevation', in degrees over the horizon; \
                 or by 'direction', the vector in which its light goes",
            )),
        }
    }
}

/// Unit vector in which a light at `position` looks: its `direction`, or `towards` a point; `None` if nothing is said.
pub(super) fn looking(table: &Table<'_>, position: DVec3) -> Result<Option<DVec3>, ImportError> {
    let Some(said) = table.one_of(&["direction", "towards"])? else { return Ok(None) };
    let vector = DVec3::from(said.vector()?);
    let direction = if said.key == "towards" { vector - position } else { vector };
    let direction = unit(direction.to_array());
    direction.map(Some).ok_or_else(|| said.wrong(format_args!("'{}' leaves no direction: its length is 0", said.key)))
}

/// The unit vector across `axis` in the direction of `vector`; `None` if it lies along it.
pub(super) fn aside(vector: DVec3, axis: DVec3) -> Option<DVec3> {
    let vector = vector.try_normalize()?;
    let across = vector - axis * axis.dot(vector);
    (across.length() > 1e-6).then(|| across.normalize())
}

fn unit(vector: [f64; 3]) -> Option<DVec3> {
    DVec3::from(vector).try_normalize()
}
