//! Between two polygons, exactly.

use crate::geometry::Facet;

/// `A_r F_rs`, exact.
pub(crate) fn exact_exchange(receiver: &Facet<'_>, source: &Facet<'_>) -> f64 {
    super::estimate_exchange(receiver, source, 1e-3).value
}
