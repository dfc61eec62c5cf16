//! Random pairs of polygons, most of them awkward: touching, thin, crossing each other's planes, of very different sizes.

pub type Vector = [f64; 3];

pub fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub fn add(a: Vector, b: Vector) -> Vector {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

pub fn sub(a: Vector, b: Vector) -> Vector {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub fn scaled(factor: f64, a: Vector) -> Vector {
    a.map(|x| factor * x)
}

pub fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub fn normalized(a: Vector) -> Vector {
    scaled(1.0 / dot(a, a).sqrt(), a)
}

/// SplitMix64 (Steele, Lea, Flood 2014).
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x2545_f491_4f6c_dd1d))
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// In [0, 1).
    pub fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// In [-1, 1).
    pub fn signed(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }

    /// An index below `count`.
    pub fn below(&mut self, count: usize) -> usize {
        (self.next() % count as u64) as usize
    }

    /// Uniform on the sphere.
    pub fn direction(&mut self) -> Vector {
        loop {
            let v = [self.signed(), self.signed(), self.signed()];
            let length_sq = dot(v, v);
            if (1e-3..1.0).contains(&length_sq) {
                return scaled(1.0 / length_sq.sqrt(), v);
            }
        }
    }

    fn perpendicular_to(&mut self, axis: Vector) -> Vector {
        normalized(cross(axis, self.direction()))
    }

    /// A right-handed frame.
    pub fn frame(&mut self) -> (Vector, Vector, Vector) {
        let x = self.direction();
        let y = self.perpendicular_to(x);
        (x, y, cross(x, y))
    }
}

/// How the second polygon lies to the first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// 8 to 100 sizes away.
    Far,
    /// 2.5 to 6 sizes away.
    Middle,
    /// About one size away.
    Near,
    /// With a whole edge in common.
    Edge,
    /// With a part of an edge in common.
    PartOfEdge,
    /// With a vertex in common.
    Vertex,
    /// Thin, down to 1 to 1e5.
    Sliver,
    /// Turned anyhow, so that many cross the other's plane.
    Crossing,
    /// 10 to 1e5 times smaller and not far.
    Small,
}

pub const KINDS: [Kind; 9] =
    [Kind::Far, Kind::Middle, Kind::Near, Kind::Edge, Kind::PartOfEdge, Kind::Vertex, Kind::Sliver, Kind::Crossing, Kind::Small];

/// A rectangle, triangle, quadrilateral or pentagon whose first edge is `first` from `origin` and which lies on the side of `second`.
fn shape(random: &mut Random, origin: Vector, first: Vector, second: Vector) -> Vec<Vector> {
    let end = add(origin, first);
    let at = |x: f64, y: f64| add(origin, add(scaled(x, first), scaled(y, second)));
    match random.below(4) {
        0 => vec![origin, end, at(1.0, 1.0), at(0.0, 1.0)],
        1 => vec![origin, end, at(random.unit(), 1.0)],
        2 => {
            let (a, b, c) = (0.6 + 0.8 * random.unit(), 0.4 * random.signed(), 0.8 + 0.4 * random.unit());
            vec![origin, end, at(a, 1.0), at(b, c)]
        }
        _ => vec![origin, end, at(1.2, 0.5), at(0.5, 1.0), at(-0.2, 0.5)],
    }
}

/// A polygon of about `size` by `width` around `centre` whose front is towards `target`.
fn facing(random: &mut Random, centre: Vector, target: Vector, size: f64, width: f64) -> Vec<Vector> {
    let x = random.direction();
    let y = random.perpendicular_to(x);
    let y = if dot(cross(x, y), sub(target, centre)) < 0.0 { scaled(-1.0, y) } else { y };
    let (first, second) = (scaled(size, x), scaled(width, y));
    let origin = sub(centre, scaled(0.5, add(first, second)));
    shape(random, origin, first, second)
}

/// A polygon that has the first edge of `a`, which runs along `x`, for its own first, the other way round; it rises by `up`.
fn on_edge(random: &mut Random, a: &[Vector], x: Vector, up: Vector) -> Vec<Vector> {
    let mut b = shape(random, a[1], scaled(-1.0, x), up);
    b[1] = a[0];
    b
}

/// The same on a part of the edge that runs along `x` from the origin, and beyond it.
fn on_part_of_edge(random: &mut Random, x: Vector, up: Vector) -> Vec<Vector> {
    let (start, length) = (1.0 + random.unit(), 0.3 + 2.0 * random.unit());
    shape(random, scaled(start, x), scaled(-length, x), up)
}

/// A pair of polygons; the first is of size 1 and somewhere around the origin.
pub fn random_pair(random: &mut Random, kind: Kind) -> (Vec<Vector>, Vec<Vector>) {
    let (x, y, normal) = random.frame();
    let y_size = 0.5 + random.unit();
    let a = shape(random, [0.0; 3], x, scaled(y_size, y));
    let centre = scaled(0.5, add(x, y));
    let size = (1.4 * random.signed()).exp();
    let width = size * (0.5 + random.unit());
    let above = |random: &mut Random, distance: f64| {
        let direction = random.direction();
        let direction = if dot(direction, normal) < 0.0 { scaled(-1.0, direction) } else { direction };
        add(centre, scaled(distance, direction))
    };

    let b = match kind {
        Kind::Far | Kind::Middle | Kind::Near => {
            let (nearest, range) = match kind {
                Kind::Far => (8.0, 100.0),
                Kind::Middle => (2.5, 4.0),
                _ => (0.8, 1.5),
            };
            let distance = nearest + range * random.unit();
            let at = above(random, distance);
            facing(random, at, centre, size, width)
        }
        Kind::Edge | Kind::PartOfEdge => {
            // The angle between the two is 6 to 166 degrees.
            let (sin, cos) = (0.1 + 2.8 * random.unit()).sin_cos();
            let up = scaled(size, add(scaled(cos, y), scaled(sin, normal)));
            if kind == Kind::Edge { on_edge(random, &a, x, up) } else { on_part_of_edge(random, x, up) }
        }
        Kind::Vertex => {
            let first = random.direction();
            let first = if dot(first, normal) < 0.0 { scaled(-1.0, first) } else { first };
            let second = random.perpendicular_to(first);
            let second = if dot(cross(first, second), centre) < 0.0 { scaled(-1.0, second) } else { second };
            shape(random, a[0], scaled(size, first), scaled(size, second))
        }
        Kind::Sliver => {
            let (distance, thinness) = (0.5 + 2.0 * random.unit(), 10_f64.powf(-1.0 - 4.0 * random.unit()));
            let at = above(random, distance);
            facing(random, at, centre, 1.0, thinness)
        }
        Kind::Crossing => {
            let distance = 1.0 + random.unit();
            let at = add(centre, scaled(distance, random.direction()));
            facing(random, at, centre, 2.0 * size, 2.0 * width)
        }
        Kind::Small => {
            let (distance, small) = (0.05 + random.unit(), 10_f64.powf(-1.0 - 4.0 * random.unit()));
            let at = above(random, distance);
            facing(random, at, centre, small, small)
        }
    };
    (a, b)
}
