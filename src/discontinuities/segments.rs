//! What is found: segments of lines, for each surface.

use glam::DVec3;

use super::counters::Counters;
use crate::scene::SurfaceId;

/// The least derivative of irradiance that jumps across a curve, 0 being irradiance itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Degree {
    /// Irradiance jumps.
    D0,
    /// Its gradient jumps.
    D1,
    /// Its curvature jumps.
    D2,
}

impl Degree {
    /// What pictures show it in, in 8-bit sRGB: red, green, blue.
    pub const fn colour(self) -> [u8; 3] {
        match self {
            Self::D0 => [230, 30, 30],
            Self::D1 => [20, 140, 40],
            Self::D2 => [30, 80, 230],
        }
    }
}

/// A straight piece of a curve on a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    pub(crate) ends: [DVec3; 2],
    /// How sharp the curve is; where several coincide, the sharpest.
    pub degree: Degree,
    /// Whose light it belongs to; of several the one that changes most, and the first surface of a source in pieces. `None` for contacts, and for lights
    /// that are no surfaces.
    pub source: Option<SurfaceId>,
    /// At most what can come and go around the curve of the irradiance by its sources, in W/m^2: of points of the curve, what the edges that cast
    /// it can hide. Of lights that are no surfaces the most that they bring to some points along it. Infinite for contacts.
    pub change: f64,
}

impl Segment {
    /// Both ends, in metres, in the plane of the surface to the tolerance.
    pub fn ends(&self) -> [[f64; 3]; 2] {
        self.ends.map(|end| end.to_array())
    }
}

/// A straight piece of a curve, and the surface that it lies on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurveSegment {
    /// The number of the surface.
    pub surface: u32,
    /// How sharp the curve is.
    pub degree: Degree,
    /// Both ends, in metres.
    pub ends: [[f64; 3]; 2],
}

/// A surface that sends light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Source {
    /// Which.
    pub surface: SurfaceId,
    /// W/m^2, taken as constant; sources of 0 or less send nothing.
    pub radiosity: f64,
}

/// The number of no emitter.
pub(super) const NO_EMITTER: u32 = u32::MAX;

/// The discontinuities of all surfaces.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Discontinuities {
    segments: Vec<Segment>,
    /// Where the segments of each surface begin, and one more.
    first: Vec<u32>,
    counters: Counters,
}

impl Discontinuities {
    /// `first` tells where the segments of each surface begin, and where the last ends.
    pub(super) fn new(segments: Vec<Segment>, first: Vec<u32>, counters: Counters) -> Self {
        Self { segments, first, counters }
    }

    /// The segments of a surface, the sharpest first, and of these the ones of most effect. They do not overlap, but may cross; their ends are the same
    /// to the bit where they meet.
    pub fn of(&self, surface: SurfaceId) -> &[Segment] {
        &self.segments[self.first[surface.index()] as usize..self.first[surface.index() + 1] as usize]
    }

    /// What it took.
    pub fn counters(&self) -> &Counters {
        &self.counters
    }
}
