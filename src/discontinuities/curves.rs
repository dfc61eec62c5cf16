//! Curves as they are found, before those of a receiver are welded.

use glam::DVec3;

use super::counters::Counters;
use super::faces::Faces;
use super::segments::{Degree, NO_EMITTER};
use crate::geometry::edges as sides_of;
use crate::scene::SurfaceId;

/// A piece of a curve on a receiver.
#[derive(Clone, Copy, Debug)]
pub(super) struct Curve {
    pub receiver: SurfaceId,
    pub ends: [DVec3; 2],
    pub degree: Degree,
    /// The number of the emitter, or [`NO_EMITTER`].
    pub emitter: u32,
    /// See [`Segment::change`](super::Segment::change).
    pub change: f64,
}

/// Curves and counts.
#[derive(Clone, Default)]
pub(super) struct Found {
    pub curves: Vec<Curve>,
    pub counters: Counters,
}

impl Found {
    /// Whether a segment on a receiver is long enough and not along the border; counts it.
    pub fn admit(&mut self, faces: &Faces<'_>, receiver: SurfaceId, ends: [DVec3; 2]) -> bool {
        /// In tolerances: the ends of what is shorter may be one.
        const SHORTEST: f64 = 4.0;
        self.counters.found += 1;
        if !ends.iter().all(|end| end.is_finite()) || ends[0].distance(ends[1]) <= SHORTEST * faces.tolerance {
            self.counters.too_short += 1;
            return false;
        }
        let is_border = |(start, edge): (DVec3, DVec3)| {
            let room = faces.on_plane() * edge.length();
            ends.iter().all(|&end| (end - start).cross(edge).length() <= room)
        };
        if sides_of(faces.facet(receiver).vertices).any(is_border) {
            self.counters.on_borders += 1;
            return false;
        }
        true
    }

    /// Adds what another has found.
    pub fn append(&mut self, other: Self) {
        self.curves.extend(other.curves);
        self.counters += other.counters;
    }

    /// Adds the foot of an edge that stands close: from farther off, as good as a step.
    pub fn add_foot(&mut self, receiver: SurfaceId, ends: [DVec3; 2]) {
        self.curves.push(Curve { receiver, ends, degree: Degree::D1, emitter: NO_EMITTER, change: f64::INFINITY });
    }

    /// Adds a line of contact.
    pub fn add_contact(&mut self, receiver: SurfaceId, ends: [DVec3; 2]) {
        self.curves.push(Curve { receiver, ends, degree: Degree::D0, emitter: NO_EMITTER, change: f64::INFINITY });
    }
}
