//! A model made of quads, boxes and prisms, and its OBJ and MTL text.
//!
//! Faces run counter-clockwise seen from outside; y points up, lengths are metres.

use std::collections::{BTreeSet, HashMap};
use std::fmt::Write as _;

/// A point.
pub type Point = [f64; 3];

/// The six sides of a box by the axis that they face.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Side {
    Left,
    Right,
    Bottom,
    Top,
    Back,
    Front,
}

/// A turn about the vertical through the origin, then a move.
#[derive(Clone, Copy)]
pub struct Place {
    origin: Point,
    cos: f64,
    sin: f64,
}

impl Place {
    pub const WORLD: Self = Self { origin: [0.0; 3], cos: 1.0, sin: 0.0 };

    pub fn at(origin: Point, degrees: f64) -> Self {
        let (sin, cos) = degrees.to_radians().sin_cos();
        Self { origin, cos, sin }
    }

    pub fn apply(self, [x, y, z]: Point) -> Point {
        let [ox, oy, oz] = self.origin;
        [ox + self.cos * x + self.sin * z, oy + y, oz - self.sin * x + self.cos * z]
    }
}

/// Vertices, faces and materials.
#[derive(Default)]
pub struct Model {
    header: String,
    materials: Vec<(String, String)>,
    used: BTreeSet<String>,
    face_count: usize,
    faces: String,
    vertices: String,
    vertex_numbers: HashMap<String, usize>,
    material: String,
    pub place: Option<Place>,
}

impl Model {
    pub fn new(header: &[&str]) -> Self {
        let header = header.iter().map(|line| format!("# {line}\n")).collect();
        Self { header, ..Self::default() }
    }

    /// Defines a material: reflectance, emitted radiance in W/(m^2 sr).
    pub fn material(&mut self, name: &str, reflectance: Point, radiance: Point) {
        let text = |values: Point| values.map(|value| value.to_string()).join(" ");
        let text = format!("newmtl {name}\nKd {}\nKe {}\n\n", text(reflectance), text(radiance));
        self.materials.push((name.to_owned(), text));
    }

    /// Starts an object; what follows is placed at `place`.
    pub fn object(&mut self, name: &str, place: Place) {
        let _ = writeln!(self.faces, "o {name}");
        self.place = Some(place);
        self.material.clear();
    }

    /// A polygon, counter-clockwise seen from its front.
    pub fn face(&mut self, material: &str, corners: &[Point]) {
        if self.material != material {
            let _ = writeln!(self.faces, "usemtl {material}");
            self.material = material.to_owned();
            self.used.insert(material.to_owned());
        }
        self.face_count += 1;
        self.faces.push('f');
        for &corner in corners {
            let text = self.place.unwrap_or(Place::WORLD).apply(corner).map(decimal).join(" ");
            let next = self.vertex_numbers.len() + 1;
            let number = *self.vertex_numbers.entry(text.clone()).or_insert_with(|| {
                let _ = writeln!(self.vertices, "v {text}");
                next
            });
            let _ = write!(self.faces, " {number}");
        }
        self.faces.push('\n');
    }

    /// How many polygons there are.
    pub fn face_count(&self) -> usize {
        self.face_count
    }

    /// A polygon that is seen from both sides.
    pub fn sheet(&mut self, material: &str, corners: &[Point]) {
        self.face(material, corners);
        self.face(material, &corners.iter().rev().copied().collect::<Vec<_>>());
    }

    /// The outside of a box between two corners, without some of its sides.
    pub fn cuboid(&mut self, material: &str, low: Point, high: Point, without: &[Side]) {
        let corner = |x: usize, y: usize, z: usize| [[low[0], high[0]][x], [low[1], high[1]][y], [low[2], high[2]][z]];
        for (side, corners) in [
            (Side::Left, [corner(0, 0, 0), corner(0, 0, 1), corner(0, 1, 1), corner(0, 1, 0)]),
            (Side::Right, [corner(1, 0, 1), corner(1, 0, 0), corner(1, 1, 0), corner(1, 1, 1)]),
            (Side::Bottom, [corner(0, 0, 0), corner(1, 0, 0), corner(1, 0, 1), corner(0, 0, 1)]),
            (Side::Top, [corner(0, 1, 1), corner(1, 1, 1), corner(1, 1, 0), corner(0, 1, 0)]),
            (Side::Back, [corner(1, 0, 0), corner(0, 0, 0), corner(0, 1, 0), corner(1, 1, 0)]),
            (Side::Front, [corner(0, 0, 1), corner(1, 0, 1), corner(1, 1, 1), corner(0, 1, 1)]),
        ] {
            if !without.contains(&side) {
                self.face(material, &corners);
            }
        }
    }

    /// The side walls of an upright cone stump with `sides` corners around `centre`, seen from outside.
    pub fn walls(&mut self, material: &str, sides: u32, centre: [f64; 2], low: (f64, f64), high: (f64, f64)) {
        let (below, above) = (ring(sides, centre, low), ring(sides, centre, high));
        for k in 0..sides as usize {
            let next = (k + 1) % sides as usize;
            self.face(material, &[below[k], below[next], above[next], above[k]]);
        }
    }

    /// The same seen from inside.
    pub fn inner_walls(&mut self, material: &str, sides: u32, centre: [f64; 2], low: (f64, f64), high: (f64, f64)) {
        let (below, above) = (ring(sides, centre, low), ring(sides, centre, high));
        for k in 0..sides as usize {
            let next = (k + 1) % sides as usize;
            self.face(material, &[below[next], below[k], above[k], above[next]]);
        }
    }

    /// A level disk of (height, radius), seen from above.
    pub fn disk(&mut self, material: &str, sides: u32, centre: [f64; 2], at: (f64, f64)) {
        self.face(material, &ring(sides, centre, at));
    }

    /// A level disk seen from below.
    pub fn disk_below(&mut self, material: &str, sides: u32, centre: [f64; 2], at: (f64, f64)) {
        self.face(material, &ring(sides, centre, at).into_iter().rev().collect::<Vec<_>>());
    }

    /// A ring between two circles of (height, radius), seen from above.
    pub fn rim(&mut self, material: &str, sides: u32, centre: [f64; 2], inner: (f64, f64), outer: (f64, f64)) {
        let (inside, outside) = (ring(sides, centre, inner), ring(sides, centre, outer));
        for k in 0..sides as usize {
            let next = (k + 1) % sides as usize;
            self.face(material, &[inside[k], outside[k], outside[next], inside[next]]);
        }
    }

    /// The texts of `name.obj` and `name.mtl`, with the materials that are used.
    pub fn write(&self, name: &str) -> (String, String) {
        let made = "# Made by examples/generate_scenes: change that, not this file.\n";
        let obj = format!("{}{made}mtllib {name}.mtl\n{}{}", self.header, self.vertices, self.faces);
        let used = self.materials.iter().filter(|(name, _)| self.used.contains(name));
        let materials: String = used.map(|(_, text)| text.as_str()).collect();
        (obj, format!("{made}\n{}", materials.trim_end()) + "\n")
    }
}

/// Corners of a regular polygon at (height, radius), counter-clockwise seen from above.
fn ring(sides: u32, centre: [f64; 2], (height, radius): (f64, f64)) -> Vec<Point> {
    (0..sides)
        .map(|k| {
            let (sin, cos) = ((f64::from(k) + 0.5) / f64::from(sides) * std::f64::consts::TAU).sin_cos();
            [centre[0] + radius * cos, height, centre[1] - radius * sin]
        })
        .collect()
}

/// Up to eight decimals, so that turned faces stay planar within the reader's tolerance.
fn decimal(value: f64) -> String {
    let text = format!("{value:.8}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}
