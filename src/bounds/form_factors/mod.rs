//! Between which numbers the form factor of a pair lies, from every point of the receiver, with what is in the way.

mod blockers;
mod boxes;
mod interval;
mod pair;
mod point_sight;
mod shadow;

pub(super) use blockers::{Blockers, CONTACT_OF_SIZE};
pub(super) use interval::BoundedPair;
pub use interval::{FormFactorBounds, FormFactorRule};
pub(super) use pair::PairBounds;
pub use pair::bound_pair;
pub(super) use point_sight::PointSight;
