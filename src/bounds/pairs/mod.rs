//! Which pairs are bounded, and how closely; and what pairs without a link hold back.

mod bounded_pairs;
mod held_back;
mod unlinked;
mod worst_first;

pub(super) use bounded_pairs::{bounded_pairs, bounds_in_time};
pub(crate) use held_back::bound_held_back;
pub(super) use unlinked::unlinked_pairs;
pub(crate) use worst_first::Light;
