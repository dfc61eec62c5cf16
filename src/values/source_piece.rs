//! A source as seen from a point over links, or a piece of one: what it may bring, and how sure that is.

use crate::geometry::Part;
use crate::hierarchy::NodeId;

/// The uncertainty left of a link of which all rays arrived, and of one of which none did; 1 is that of a half visible source.
/// Sources that bring nothing are linked more coarsely, so theirs is larger. Empirical.
const DOUBT_OF_SEEN: f64 = 0.1;
const DOUBT_OF_HIDDEN: f64 = 0.4;

/// The transmittance that is expected by the link, 0 to 1.
#[derive(Clone, Copy)]
pub(super) struct Expected {
    pub transmittance: f64,
    /// The same where the link is one between polygons; 0 where a cluster is in it, whose parts may be seen or not.
    pub control: f64,
}

/// A source, or a piece of one, as seen from the point.
#[derive(Clone, Copy)]
pub(super) struct SourcePiece {
    /// The node whose radiosity it has.
    pub node: NodeId,
    /// The part of the node's polygon, where it was split below the elements.
    pub part: Option<Part>,
    pub form_factor: f64,
    /// The form factor of that node.
    pub of_whole: f64,
    /// The reflected radiosity that rays to it decide about, in W/m^2 in the largest channel: of a polygon the standard deviation
    /// that is expected, of a cluster all that it brings.
    pub worth: f64,
    pub near: bool,
    pub expected: Expected,
    pub rays: u32,
    /// The probability with which the rays are cast.
    pub chance: f64,
}

impl SourcePiece {
    /// A piece without rays yet; `None` if it brings nothing.
    pub fn new(node: NodeId, part: Option<Part>, form_factor: f64, worth: f64, near: bool, expected: Expected) -> Option<Self> {
        let piece = Self { node, part, form_factor, of_whole: form_factor, worth, near, expected, rays: 0, chance: 1.0 };
        (worth > 0.0).then_some(piece)
    }

    /// The variance of what the piece brings, by the sums over its rays and over their squares; of a single ray by how far it is from
    /// what was expected.
    pub fn sampled_variance(&self, brought: f64, sum: f64, sum_sq: f64, radiosity: f64) -> f64 {
        if self.rays <= 1 {
            return (brought - self.form_factor * self.expected.transmittance * radiosity).powi(2);
        }
        let count = f64::from(self.rays);
        (sum_sq - sum * sum / count).max(0.0) * count / (count - 1.0)
    }
}

impl Expected {
    /// Where no link tells: it may be seen or not.
    pub const UNKNOWN: Self = Self { transmittance: 0.5, control: 0.0 };

    /// The uncertainty of the visibility of the source: the standard deviation of a yes or no, in halves, and a least uncertainty between
    /// [`DOUBT_OF_HIDDEN`] and [`DOUBT_OF_SEEN`].
    pub fn doubt(self) -> f64 {
        let seen = self.transmittance;
        let least = DOUBT_OF_HIDDEN + (DOUBT_OF_SEEN - DOUBT_OF_HIDDEN) * seen;
        least + (1.0 - least) * 2.0 * (seen * (1.0 - seen)).sqrt()
    }
}
