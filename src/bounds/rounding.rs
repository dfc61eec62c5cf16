//! What rounding may do to sums of products of numbers that are not negative.

/// By this part of itself a sum of so many terms is widened: it allows for the rounding of each, and for a few steps more.
pub(super) fn rounding(terms: usize) -> f64 {
    f64::EPSILON * (terms as f64 + 8.0)
}
