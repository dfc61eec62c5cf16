//! Clusters of segments between two segments that face each other.

use std::f64::consts::{FRAC_PI_2, PI};

use patchlight::flatland::Segment;

use super::triangles::Random;

/// Segments in each cluster.
pub const SEGMENTS: usize = 256;

/// Receiver and source are so long, and so far apart, in metres.
pub const ENDS: f64 = 1.0;
pub const DISTANCE: f64 = 6.0;

/// How segments of a cluster are placed. The paper gives no coordinates; the first kind takes the place of its experiment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// At random in a square that lets through about so much.
    Uniform {
        transmittance: f64,
    },
    /// The same, in a square as wide as receiver and source, so that all light goes through it.
    Wide,
    /// In a rectangle four times as high as wide, or the other way, of the same area.
    Along,
    Across,
    /// Around sixteen places.
    Clumps,
    /// In rows and columns at equal distances, each row half covered: the paper's figure 2.
    Rows,
}

impl Shape {
    pub const ALL: [Self; 8] = [
        Self::Uniform { transmittance: 0.5 },
        Self::Uniform { transmittance: 0.8 },
        Self::Uniform { transmittance: 0.1 },
        Self::Wide,
        Self::Along,
        Self::Across,
        Self::Clumps,
        Self::Rows,
    ];

    pub fn name(self) -> String {
        match self {
            Self::Uniform { transmittance } => format!("uniform, {:.0}% pass", 100.0 * transmittance),
            Self::Wide => "as wide as the ends".to_owned(),
            Self::Along => "long, along light".to_owned(),
            Self::Across => "long, across light".to_owned(),
            Self::Clumps => "clumps".to_owned(),
            Self::Rows => "rows".to_owned(),
        }
    }

    /// Width and height of the rectangle, in metres.
    fn extent(self) -> [f64; 2] {
        match self {
            Self::Wide => [ENDS, ENDS],
            Self::Along => [0.5 * SIDE, 2.0 * SIDE],
            Self::Across => [2.0 * SIDE, 0.5 * SIDE],
            _ => [SIDE, SIDE],
        }
    }

    /// The segments, around the origin.
    pub fn segments(self) -> Vec<Segment> {
        let mut random = Random(1996);
        let [width, height] = self.extent();
        let transmittance = if let Self::Uniform { transmittance } = self { transmittance } else { 0.5 };
        let length = -transmittance.ln() * FRAC_PI_2 * width / SEGMENTS as f64;
        let clumps: Vec<[f64; 2]> = (0..16).map(|_| [random.between(-0.5, 0.5), random.between(-0.5, 0.5)]).collect();
        let place = |k: usize| {
            let spread = [random.between(-0.5, 0.5), random.between(-0.5, 0.5)];
            let angle = random.between(0.0, PI);
            let ([x, y], angle) = match self {
                Self::Clumps => (std::array::from_fn(|axis| 0.9 * clumps[k % 16][axis] + 0.1 * spread[axis]), angle),
                Self::Rows => ([k % 16, k / 16].map(|at| (at as f64 + 0.5) / 16.0 - 0.5), 0.0),
                _ => (spread, angle),
            };
            let half = if self == Self::Rows { 0.25 * width / 16.0 } else { 0.5 * length };
            let (dx, dy) = (half * angle.cos(), half * angle.sin());
            let (x, y) = (x * width, y * height);
            Segment::new([x - dx, y - dy], [x + dx, y + dy]).expect("small numbers")
        };
        (0..SEGMENTS).map(place).collect()
    }
}

/// The side of the square, in metres: so that the root of the first cluster is good enough as a whole from about 0.0035 on, as in the paper.
const SIDE: f64 = 0.013;

/// Receiver and source, whose fronts face each other.
pub fn ends() -> [Segment; 2] {
    let (x, y) = (0.5 * ENDS, 0.5 * DISTANCE);
    [([-x, -y], [x, -y]), ([x, y], [-x, y])].map(|(a, b)| Segment::new(a, b).expect("small numbers"))
}
