//! BVE: how wrong a form factor can be at most, if the directional transmittance of a cluster stands for what it lets through.
//!
//! Soler and Sillion 1996, section 8.1, bound `|F~ - F|` by
//!
//! ```text
//! 2 delta_theta J_12 sqrt(Delta_rho) / (L_1 r_min)  T(alpha, beta, theta_12)  [R_1(theta_12) + R_2(theta_12)].
//! ```
//!
//! Here it is, of the sightlines that meet the cluster's box and with `delta_theta` half of the angle that they turn by,
//!
//! ```text
//! BVE = delta_theta sqrt(Delta_rho) [rho_1 + rho_2] / L_1.
//! ```
//!
//! *Proof.* With t the mean at the sampled direction, the error is at most `1/(2 L_1) Integral |tau - t| drho dtheta` over these sightlines. Along each
//! theta, Cauchy and Schwarz give `sqrt(Delta_rho) || tau(., theta) - t ||`, and the triangle inequality splits the norm at the sampled direction into `rho_1`
//! and `rho_2`. The interval of theta is `2 delta_theta` long.
//!
//! **Where this departs from the paper**, each time as little as closes a gap:
//! - `T J_12 / r_min` bounds the kernel times the Jacobian of `(x_1, x_2) -> (rho, theta)`, which is 1: `J = r / (cos cos)`, and the kernel in two dimensions
//!   is `cos cos / (2 r)`. Bounded one by one they exceed 1, and grow without end as receiver and source come close. So they are left out, with the factor 2 of the kernel.
//! - `delta_theta` cannot be the interval's diameter if `R_1` is over `[theta - delta_theta, theta + delta_theta]` and `theta_12` its middle: it is half of it.
//! - `F~ = mean F_0` (section 2.3) is wrong by what misses the box, and no norm over lines that meet it can tell. So t stands for tau on sightlines through the
//!   box alone, `F~ = F_0 - (1 - t) F_box` with `F_box` their part of all lines. `Delta_rho` and `delta_theta` are theirs.
//! - The box's shadow is wider in some directions than in the sampled one. `rho_2` is over the widest, with tau = 1 where the sampled lines miss the box.
//! - `theta_12` is not sampled, in general. The next sample takes its place, and the spread of `rho_1` grows by the difference.
//! - A line's tau is that of all it meets, but light meets what lies between its ends. So clusters that are not as a whole between receiver and source are opened.
//!
//! Since it bounds the integral of `|tau - t|`, it holds also where other bodies take light from the same lines, and sums over clusters that stand
//! one behind another: products of numbers from 0 to 1 differ by no more than the sum of the differences of their factors.

use super::hierarchy::{ClusterId, Hierarchy};
use super::sightlines::Sightlines;

/// A cluster as one pair of segments sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// The part of the receiver's lines that are sightlines through the box: all that the cluster can block.
    pub through_box: f64,
    /// The cluster without what is in it. Nothing for a segment and for a cluster that is not between receiver and source.
    pub as_whole: Option<AsWhole>,
}

/// What stands for a cluster.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AsWhole {
    /// Its directional transmittance, from 0 to 1.
    pub transmittance: f64,
    /// BVE: a bound of what this changes the form factor by. Proven, up to rounding.
    pub error: f64,
}

/// What sightlines see of a cluster, and BVE. Nothing, if none meets it.
pub fn bound_visibility_error(sightlines: &Sightlines, hierarchy: &Hierarchy, cluster: ClusterId) -> Option<Seen> {
    let corners = hierarchy.corners(cluster);
    let beam = sightlines.beam(&[&corners])?;
    let stored = hierarchy.directional(cluster).filter(|_| sightlines.enclose(&corners));
    let as_whole = stored.map(|stored| {
        let resolution = stored.around(beam.middle, beam.spread);
        let most = 2.0 * beam.spread * beam.width.sqrt() * (resolution.rho_1 + resolution.rho_2);
        AsWhole { transmittance: resolution.mean, error: sightlines.part_of_all(most) }
    });
    Some(Seen { through_box: sightlines.part_of_all(beam.measure), as_whole })
}

/// A bound of chi, the part of the receiver's lines that two clusters both block: the sightlines that meet both boxes.
///
/// Section 5 says neither which estimate of chi it takes nor how far that is off. Its last formula for chi lacks the kernel, without which
/// `dx_1 dx_2` is no measure of lines.
pub fn bound_correlation(sightlines: &Sightlines, hierarchy: &Hierarchy, clusters: [ClusterId; 2]) -> f64 {
    let [first, second] = clusters.map(|cluster| hierarchy.corners(cluster));
    sightlines.beam(&[&first, &second]).map_or(0.0, |beam| sightlines.part_of_all(beam.measure))
}
