//! Measuring planes: grids of sensors that all look the same way.

use std::str::FromStr;

use glam::DVec3;
use thiserror::Error;

use super::camera::parse_vector;
use crate::scene::{Scene, SurfacePoint, Up};

/// A plane has at most so many sensors: they must fit into memory.
const MOST_SENSORS: u64 = 1 << 24;

/// A parallelogram, cut into equal fields with a sensor in the middle of each.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasuringPlane {
    /// A corner, in metres.
    pub origin: [f64; 3],
    /// The edges from there, in metres; sensors look along their cross product.
    pub edges: [[f64; 3]; 2],
    /// Fields along each edge.
    pub counts: [u32; 2],
}

/// A measuring plane as typed: `origin=x,y,z u=x,y,z v=x,y,z counts=NxM`, or a horizontal one `height=m`, with `spacing=m` and `up=x|y|z` if wanted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlaneRequest {
    /// Given in full.
    Given(MeasuringPlane),
    /// Over the floor.
    Horizontal {
        /// Above the lowest point of the scene, in metres.
        height: f64,
        /// From sensor to sensor, in metres, at most; if not given, by the size of the plane ([`MeasuringPlane::over`]).
        spacing: Option<f64>,
        /// The axis that points up, 0, 1 or 2; if not given, that of the scene, or y.
        up: Option<usize>,
    },
}

/// Why a text or numbers are no measuring plane.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum PlaneError {
    /// The text cannot be understood.
    #[error(
        "plane: '{part}' {reason}; write 'height=0.75', with spacing=0.5 and up=z if wanted, or 'origin=x,y,z u=x,y,z v=x,y,z counts=NxM'"
    )]
    BadText {
        /// The part that is not understood.
        part: String,
        /// Why.
        reason: &'static str,
    },
    /// The edges span no area.
    #[error("plane: its edges u and v span no area; they must not be parallel")]
    NoArea,
    /// There are none, or too many.
    #[error("plane: it has {0} sensors, and there must be from 1 to {MOST_SENSORS}")]
    BadCount(u64),
}

impl MeasuringPlane {
    /// Checks that it has an area, and sensors.
    ///
    /// # Errors
    /// See [`PlaneError`].
    pub fn validate(&self) -> Result<(), PlaneError> {
        let [u, v] = self.edges.map(DVec3::from);
        let count = u64::from(self.counts[0]) * u64::from(self.counts[1]);
        // An angle of less than 1e-9 is one that rounding makes.
        let has_area = u.cross(v).length() > 1e-9 * u.length() * v.length();
        if !has_area {
            return Err(PlaneError::NoArea);
        }
        if count == 0 || count > MOST_SENSORS { Err(PlaneError::BadCount(count)) } else { Ok(()) }
    }

    /// The horizontal plane over the box around a scene, `height` metres above its lowest point, with fields of at most `spacing` metres.
    /// Seen from above its first edge goes to the right, and the second one up.
    ///
    /// Without a spacing it is that of EN 12464-1: `p = 0.2 * 5^log10(d)`, d the longer side of the plane.
    ///
    /// # Errors
    /// See [`PlaneError`].
    pub fn over(scene: &Scene, height: f64, spacing: Option<f64>, up: usize) -> Result<Self, PlaneError> {
        let bounds = scene.bounds();
        // With y up a plan has x to the right and z down.
        let (right, ahead) = ((up + 1) % 3, (up + 2) % 3);
        let (right, ahead, sign) = if up == 1 { (ahead, right, -1.0) } else { (right, ahead, 1.0) };
        let size = bounds.max - bounds.min;
        let mut origin = bounds.min;
        origin[up] += height;
        if sign < 0.0 {
            origin[ahead] = bounds.max[ahead];
        }
        let (mut u, mut v) = (DVec3::ZERO, DVec3::ZERO);
        (u[right], v[ahead]) = (size[right], sign * size[ahead]);

        let spacing = spacing.unwrap_or_else(|| 0.2 * 5_f64.powf(size[right].max(size[ahead]).log10()));
        let count = |length: f64| (length / spacing).ceil().max(1.0) as u32;
        let plane = Self {
            origin: origin.to_array(),
            edges: [u.to_array(), v.to_array()],
            counts: [count(size[right]), count(size[ahead])],
        };
        plane.validate().map(|()| plane)
    }

    /// The sensors, row after row along the first edge.
    pub fn sensors(&self) -> Vec<SurfacePoint> {
        let (origin, [u, v]) = (DVec3::from(self.origin), self.edges.map(DVec3::from));
        // To add 0 leaves no -0 in files.
        let normal = (u.cross(v).normalize() + 0.0).to_array();
        let [columns, rows] = self.counts;
        let at = |number: u32, count: u32| (f64::from(number) + 0.5) / f64::from(count);
        let of_row = |row: u32| {
            let position = move |column: u32| (origin + at(column, columns) * u + at(row, rows) * v).to_array();
            (0..columns).map(move |column| SurfacePoint { position: position(column), normal })
        };
        (0..rows).flat_map(of_row).collect()
    }
}

impl PlaneRequest {
    /// The plane that is asked for, in a scene.
    ///
    /// # Errors
    /// See [`PlaneError`].
    pub fn in_scene(&self, scene: &Scene) -> Result<MeasuringPlane, PlaneError> {
        match *self {
            Self::Given(plane) => Ok(plane),
            Self::Horizontal { height, spacing, up } => {
                let up = up.or(scene.up().map(Up::index)).unwrap_or(Up::Y.index());
                MeasuringPlane::over(scene, height, spacing, up)
            }
        }
    }
}

/// The parts of a request, by their keys.
#[derive(Default)]
struct Parts {
    vectors: [Option<[f64; 3]>; 3],
    counts: Option<[u32; 2]>,
    lengths: [Option<f64>; 2],
    up: Option<usize>,
}

impl FromStr for PlaneRequest {
    type Err = PlaneError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let mut parts = Parts::default();
        for part in text.split_whitespace() {
            parts.add(part).map_err(|reason| PlaneError::BadText { part: part.to_owned(), reason })?;
        }
        let bad = |reason| PlaneError::BadText { part: text.to_owned(), reason };
        match parts {
            Parts { vectors: [Some(origin), Some(u), Some(v)], counts: Some(counts), lengths: [None, None], up: None } => {
                let plane = MeasuringPlane { origin, edges: [u, v], counts };
                plane.validate().map(|()| Self::Given(plane))
            }
            Parts { vectors: [None, None, None], counts: None, lengths: [Some(height), spacing], up } => {
                Ok(Self::Horizontal { height, spacing, up })
            }
            _ => Err(bad("is neither a plane in full nor a height")),
        }
    }
}

impl Parts {
    /// Takes in `key=value`; says what is wrong with it.
    fn add(&mut self, part: &str) -> Result<(), &'static str> {
        let (key, value) = part.split_once('=').ok_or("has no '='")?;
        let vector = || parse_vector(value).ok_or("needs three numbers");
        let length = || value.parse().ok().filter(|x: &f64| x.is_finite()).ok_or("needs a number of metres");
        let repeated = match key {
            "origin" => self.vectors[0].replace(vector()?).is_some(),
            "u" => self.vectors[1].replace(vector()?).is_some(),
            "v" => self.vectors[2].replace(vector()?).is_some(),
            "counts" => {
                let (columns, rows) = value.split_once(['x', 'X']).ok_or("needs two counts, as in 20x10")?;
                let count = |text: &str| text.parse().map_err(|_| "needs two counts, as in 20x10");
                self.counts.replace([count(columns)?, count(rows)?]).is_some()
            }
            "height" => self.lengths[0].replace(length()?).is_some(),
            "spacing" => {
                let spacing = length()?;
                self.lengths[1].replace(Some(spacing).filter(|&x| x > 0.0).ok_or("must be above 0")?).is_some()
            }
            "up" => self.up.replace(["x", "y", "z"].iter().position(|&axis| axis == value).ok_or("must be x, y or z")?).is_some(),
            _ => return Err("is no key of a plane"),
        };
        if repeated { Err("is given twice") } else { Ok(()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Polygon;
    use crate::scene::{Material, Sides};

    fn floor(size: [f64; 2]) -> Scene {
        let corners = [[0.0, 1.0, 0.0], [0.0, 1.0, size[1]], [size[0], 1.0, size[1]], [size[0], 1.0, 0.0]];
        let grey = Material { name: String::new(), reflectance: vec![0.5], exitance: vec![0.0] };
        Scene::new(1, vec![grey], vec![(Polygon::new(&corners).unwrap(), 0, 0)], Sides::Front).unwrap()
    }

    #[test]
    fn sensors_stand_in_the_middles_of_fields_and_look_along_the_normal() {
        let PlaneRequest::Given(plane) = "origin=1,2,3 u=4,0,0 v=0,0,-2 counts=4x2".parse().unwrap() else { panic!() };
        let sensors = plane.sensors();
        assert_eq!((sensors.len(), sensors[0].position, sensors[7].position), (8, [1.5, 2.0, 2.5], [4.5, 2.0, 1.5]));
        assert!(sensors.iter().all(|sensor| sensor.normal == [0.0, 1.0, 0.0]));
    }

    /// The spacing of a plane of 10 m is 1 m, by the standard's table; one of 5 m has 0.6 m.
    #[test]
    fn a_horizontal_plane_covers_the_scene_and_looks_up() {
        let over = |text: &str, size| text.parse::<PlaneRequest>().unwrap().in_scene(&floor(size)).unwrap();
        let plane = over("height=0.75", [10.0, 5.0]);
        assert_eq!((plane.counts, plane.origin), ([10, 5], [0.0, 1.75, 5.0]));
        assert_eq!(plane.edges, [[10.0, 0.0, 0.0], [0.0, 0.0, -5.0]]);
        assert!(plane.sensors().iter().all(|sensor| sensor.normal == [0.0, 1.0, 0.0]));
        assert_eq!(over("height=0.75", [5.0, 5.0]).counts, [9, 9]);
        assert_eq!(over("spacing=0.5 height=0", [5.0, 2.0]).counts, [10, 4]);
        // With another axis up the plane would have no height to span.
        let flat = "height=1 up=z".parse::<PlaneRequest>().unwrap().in_scene(&floor([2.0, 2.0]));
        assert_eq!(flat, Err(PlaneError::NoArea));
    }

    #[test]
    fn what_is_no_plane_is_told() {
        for (text, reason) in [
            ("", "neither"),
            ("height=0.75 counts=2x2", "neither"),
            ("origin=0,0,0 u=1,0,0 v=0,1,0", "neither"),
            ("height", "no '='"),
            ("height=high", "metres"),
            ("height=1 height=2", "twice"),
            ("height=1 spacing=0", "above 0"),
            ("height=1 up=w", "x, y or z"),
            ("width=1", "no key"),
            ("origin=0,0 u=1,0,0 v=0,1,0 counts=2x2", "three numbers"),
            ("origin=0,0,0 u=1,0,0 v=0,1,0 counts=2", "two counts"),
            ("origin=0,0,0 u=1,0,0 v=2,0,0 counts=2x2", "no area"),
            ("origin=0,0,0 u=1,0,0 v=0,1,0 counts=0x2", "0 sensors"),
            ("origin=0,0,0 u=1,0,0 v=0,1,0 counts=100000x100000", "10000000000 sensors"),
        ] {
            let error = text.parse::<PlaneRequest>().unwrap_err().to_string();
            assert!(error.contains(reason), "{text}: {error}");
        }
    }
}
