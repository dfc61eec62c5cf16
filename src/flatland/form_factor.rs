//! RFormFactor and HFormFactor: the form factor through a hierarchy of clusters, to a requested error.
//!
//! Soler and Sillion 1996, section 6. A cluster whose BVE is small enough is taken as a whole. Else, if no more light is blocked by both of its clusters than
//! the error may be, the form factors with either as the only occluder are combined (equation 3): `F = F_1 + F_2 - F_0 + chi`, with chi
//! left out. If more is, the form factor is integrated, which needs no chi (section 5).
//!
//! **Errors are handed down and back**: the cluster with the lesser BVE may use all there is, the other what that left. So what is large and good
//! enough is not opened. What is used at a level is the sum of what was used below.
//!
//! **Gaps of the paper**, and how they are closed:
//! - RFormFactor tests `chi < epsilon` and then hands epsilon down, although leaving chi out is an error too. Here chi is taken off first.
//! - "A certain part of epsilon" (section 6) is not named. It is all: of two halves neither may be enough for a cluster as a whole, and
//!   small clusters take more error for each segment that they spare.
//! - HFormFactor has no epsilon, and compares the BVE of each cluster with the whole. But errors of clusters add up, so it is handed down here too.
//! - It multiplies `tau-bar(theta)` of each line's own direction. BVE is for the mean direction, so that is taken, and the integral has a closed form
//!   (`lines`): segments as they are and boxes with their transmittance, exactly, in place of a quadrature.
//! - Comparisons are with `<=`, so that opaque clusters, and those that no sightline meets both of, are not opened for an error of 0.

use super::hierarchy::{ClusterId, Hierarchy};
use super::lines::{Body, integral_over_lines};
use super::segment::Segment;
use super::sightlines::Sightlines;
use super::visibility_error::{Seen, bound_correlation, bound_visibility_error};

/// A form factor, how wrong it can be, and what it took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Approximation {
    /// The fraction of the power leaving the receiver that arrives at the source, from 0 to 1.
    pub form_factor: f64,
    /// The error that was used. Proven, up to rounding: the true form factor differs by no more. At most what was asked for.
    pub error: f64,
    /// What it took.
    pub work: Work,
}

/// What an approximation took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// Clusters whose contents were looked at.
    pub opened: usize,
    /// Clusters that were taken as a whole.
    pub wholes: usize,
    /// Segments that were taken as they are.
    pub segments: usize,
    /// The sum of depths, 0 at the root, over wholes and segments.
    pub depths: usize,
    /// Integrals over lines.
    pub integrals: usize,
}

impl Work {
    /// The mean depth of what was taken; 0, if nothing was.
    pub fn mean_depth(&self) -> f64 {
        self.depths as f64 / (self.wholes + self.segments).max(1) as f64
    }
}

/// The form factor from a receiver to a source through a hierarchy, wrong by no more than `tolerance`, which is not negative.
///
/// A receiver with no length has the form factor 0.
pub fn form_factor(receiver: &Segment, source: &Segment, hierarchy: &Hierarchy, tolerance: f64) -> Approximation {
    let Some(sightlines) = Sightlines::between(receiver, source) else { return Approximation::default() };
    let mut way = Way { sightlines: &sightlines, hierarchy, work: Work::default() };
    let found = match hierarchy.root() {
        Some(root) => way.r_form_factor(root, 0, tolerance),
        None => Part { form_factor: sightlines.unoccluded(), error: 0.0 },
    };
    // What is left of F_1 + F_2 - F_0 without chi may be less than nothing.
    Approximation { form_factor: found.form_factor.clamp(0.0, sightlines.unoccluded()), error: found.error, work: way.work }
}

/// A form factor with one cluster as the only occluder, and the error that was used.
struct Part {
    form_factor: f64,
    error: f64,
}

/// The way down a hierarchy for one pair of segments.
struct Way<'a> {
    sightlines: &'a Sightlines,
    hierarchy: &'a Hierarchy,
    work: Work,
}

impl Way<'_> {
    /// RFormFactor.
    fn r_form_factor(&mut self, cluster: ClusterId, depth: usize, tolerance: f64) -> Part {
        let unoccluded = self.sightlines.unoccluded();
        let Some(seen) = self.see(cluster) else { return Part { form_factor: unoccluded, error: 0.0 } };

        // Good enough as a whole.
        if let Some(whole) = seen.as_whole.filter(|whole| whole.error <= tolerance) {
            self.take(depth, 1, 0);
            let blocked = (1.0 - whole.transmittance) * seen.through_box;
            return Part { form_factor: unoccluded - blocked, error: whole.error };
        }

        // Both clusters apart, if few sightlines meet both.
        let chi = |children| bound_correlation(self.sightlines, self.hierarchy, children);
        let apart = self.children(cluster).map(|children| (children, chi(children)));
        let Some(([first, second], chi)) = apart.filter(|(_, chi)| *chi <= tolerance) else {
            return self.h_form_factor(cluster, depth, tolerance);
        };
        self.work.opened += 1;
        let left = tolerance - chi;
        let first = self.r_form_factor(first, depth + 1, left);
        let second = self.r_form_factor(second, depth + 1, left - first.error);
        Part { form_factor: first.form_factor + second.form_factor - unoccluded, error: chi + first.error + second.error }
    }

    /// HFormFactor.
    fn h_form_factor(&mut self, cluster: ClusterId, depth: usize, tolerance: f64) -> Part {
        let mut bodies: Vec<Body> = self.sightlines.parts().iter().map(Body::end).collect();
        let error = self.gather(cluster, depth, tolerance, &mut bodies);
        self.work.integrals += 1;
        Part { form_factor: self.sightlines.part_of_all(integral_over_lines(&bodies)), error }
    }

    /// Adds the bodies that stand for a cluster, and returns the error that was used.
    fn gather(&mut self, cluster: ClusterId, depth: usize, tolerance: f64, bodies: &mut Vec<Body>) -> f64 {
        let Some(seen) = self.see(cluster) else { return 0.0 };
        if let Some(whole) = seen.as_whole.filter(|whole| whole.error <= tolerance) {
            self.take(depth, 1, 0);
            bodies.push(Body::occluder(&self.hierarchy.corners(cluster), whole.transmittance));
            return whole.error;
        }
        if let Some([first, second]) = self.children(cluster) {
            self.work.opened += 1;
            let used = self.gather(first, depth + 1, tolerance, bodies);
            return used + self.gather(second, depth + 1, tolerance - used, bodies);
        }
        if let Some(part) = self.hierarchy.segment(cluster).and_then(|segment| self.sightlines.cut(segment)) {
            self.take(depth, 0, 1);
            bodies.push(Body::occluder(&part.points(), 0.0));
        }
        0.0
    }

    fn see(&self, cluster: ClusterId) -> Option<Seen> {
        bound_visibility_error(self.sightlines, self.hierarchy, cluster)
    }

    /// The clusters in a cluster, that with the lesser BVE first.
    fn children(&self, cluster: ClusterId) -> Option<[ClusterId; 2]> {
        let [first, second] = self.hierarchy.children(cluster)?;
        let error = |child| self.see(child).and_then(|seen| seen.as_whole).map_or(0.0, |whole| whole.error);
        Some(if error(first) <= error(second) { [first, second] } else { [second, first] })
    }

    fn take(&mut self, depth: usize, wholes: usize, segments: usize) {
        self.work.wholes += wholes;
        self.work.segments += segments;
        self.work.depths += depth;
    }
}
