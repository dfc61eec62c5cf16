//! Things that nearly touch.

use patchlight::visibility::Backend;

use super::super::rooms::Room;
use super::made::Made;
use super::parts::{closed_room, matt, panel, solid};

/// Backends in f32 tell what is farther apart in the hall.
const RESOLVED: f64 = 1e-5;

/// A hall of 10 x 10 x 4 m: a box floats a gap above its floor, a lamp hangs a gap under its ceiling.
pub fn gaps(gap: f64) -> Made {
    let mut room = Room::default();
    closed_room(&mut room, [10.0, 10.0, 4.0]);
    panel(&mut room, [5.0, 5.0], [2.0, 2.0], 4.0 - gap, 60.0);
    let object = matt(&mut room, "object", [0.6, 0.45, 0.35]);
    solid(&mut room, [2.0, 3.0, gap], [5.0, 6.0, 1.0 + gap], object);
    let backend = if gap < RESOLVED { Backend::BruteForce } else { Backend::Auto };
    Made { backend, ..Made::of(room) }
}
