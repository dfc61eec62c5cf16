//! Nodes of a light tree: bounds of the light that each of up to four children can send to a place.
//!
//! They are computed side by side in f32: rounding changes the probabilities of draws, but they remain those that are divided by.

/// Cosines are widened by this much against rounding: sines of small angles are known to the root of the rounding of f32.
const SLACK: f32 = 1e-3;

/// Children of a node.
pub(super) const WIDTH: usize = 4;

/// One number for each child, or child and axis.
pub(super) type Lanes = [f32; WIDTH];

/// Up to four children; unused lanes have no power.
pub(super) struct Node {
    /// The centre of each child's box, and half of its diagonal.
    pub centre: [Lanes; 3],
    pub radius: Lanes,
    /// All normals are within the half-angle of a cone around `axis`, in [0, pi].
    pub axis: [Lanes; 3],
    pub cos_half_angle: Lanes,
    pub sin_half_angle: Lanes,
    /// Area times brightness.
    pub power: Lanes,
    pub below: [Below; WIDTH],
    /// The nodes below it are those up to this one.
    pub end: u32,
}

/// What a child is.
#[derive(Clone, Copy)]
pub(super) enum Below {
    Source(u32),
    Node(u32),
}

/// Points of one normal, in the units of a tree: all within `reach` of `point`.
pub(super) struct Receiver {
    pub point: [f32; 3],
    pub reach: f32,
    pub normal: [f32; 3],
}

impl Below {
    /// The same where so many nodes stand before those of its tree.
    pub fn behind(self, before: u32) -> Self {
        match self {
            Self::Source(_) => self,
            Self::Node(index) => Self::Node(before + index),
        }
    }
}

impl Node {
    pub const EMPTY: Self = Self {
        centre: [[0.0; WIDTH]; 3],
        radius: [1.0; WIDTH],
        axis: [[0.0; WIDTH]; 3],
        cos_half_angle: [1.0; WIDTH],
        sin_half_angle: [0.0; WIDTH],
        power: [0.0; WIDTH],
        below: [Below::Node(0); WIDTH],
        end: 0,
    };

    /// By child: a bound of the light that it sends to the receiver, up to a common factor, and its nearness, the square of radius
    /// over distance. The bound is power times the largest cosines over the square of the distance. The radius is that of the
    /// child's box plus the reach of the receiver; the distance counts as no less than that.
    pub fn bound_sent(&self, receiver: &Receiver) -> (Lanes, Lanes) {
        // Distances and projections, in arrays and without branches, so that the compiler computes four children side by side.
        let (mut distance_sq, mut to_receiver, mut to_axis) = ([0.0; WIDTH], [0.0; WIDTH], [0.0; WIDTH]);
        for axis in 0..3 {
            for k in 0..WIDTH {
                let towards = self.centre[axis][k] - receiver.point[axis];
                distance_sq[k] += towards * towards;
                to_receiver[k] += towards * receiver.normal[axis];
                to_axis[k] -= towards * self.axis[axis][k];
            }
        }

        // The largest cosines at both ends: directions vary by the angle under which the radius is seen, at the sources by the cone
        // of normals too.
        let (mut sent, mut nearness_sq) = ([0.0; WIDTH], [0.0; WIDTH]);
        for k in 0..WIDTH {
            let radius = self.radius[k] + receiver.reach;
            let radius_sq = radius * radius;
            let far_sq = largest(distance_sq[k], radius_sq);
            let sin_sq = radius_sq / far_sq;
            let seen_angle = (sin_sq.sqrt(), (1.0 - sin_sq).sqrt());
            let per_distance = 1.0 / far_sq.sqrt();
            let at_receiver = less(angle(to_receiver[k] * per_distance), seen_angle);
            let at_sources =
                less(less(angle(to_axis[k] * per_distance), seen_angle), (self.sin_half_angle[k], self.cos_half_angle[k]));
            let cosines = largest(at_receiver.1 + SLACK, 0.0) * largest(at_sources.1 + SLACK, 0.0);
            let is_inside = distance_sq[k] <= radius_sq;
            sent[k] = self.power[k] * if is_inside { 1.0 } else { cosines } / far_sq;
            nearness_sq[k] = radius_sq / largest(distance_sq[k], f32::MIN_POSITIVE);
        }
        (sent, nearness_sq)
    }
}

/// The larger of two numbers that are not NaN.
fn largest(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// Sine and cosine of an angle in [0, pi] by its cosine, which rounding may have left a little outside [-1, 1].
fn angle(cos: f32) -> (f32, f32) {
    (largest(1.0 - cos * cos, 0.0).sqrt(), cos)
}

/// Sine and cosine of `a - b`, or of 0 if that is negative; angles in [0, pi], given by their sines and cosines.
fn less(a: (f32, f32), b: (f32, f32)) -> (f32, f32) {
    let is_less = a.1 >= b.1;
    let (sin, cos) = (a.0 * b.1 - a.1 * b.0, a.1 * b.1 + a.0 * b.0);
    (if is_less { 0.0 } else { sin }, if is_less { 1.0 } else { cos })
}
