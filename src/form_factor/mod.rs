//! The unoccluded kernel and its integrals, in f64.
//!
//! `F_rs` is the fraction of the power leaving receiver r that would arrive at source s with nothing in between. Both are
//! one-sided: what lies behind either plane counts nothing.

mod bounds;
mod contour;
mod exact;
mod gradient;
mod lambert;
mod quadrature;

use crate::geometry::Polygon;

use bounds::estimate_unoccluded_range;
pub(crate) use bounds::{Search, bound_at_point, bound_unoccluded, centre_and_vertices};
pub(crate) use exact::exact_exchange;
pub(crate) use lambert::{from_directions, kernel, point_to_polygon};
pub use quadrature::Estimate;
pub(crate) use quadrature::{estimate_exchange, sided_exchange};

/// The form factor from the point `receiver` with unit normal `normal` to `source`: exact, by Lambert's sum over the edges of the
/// polygon clipped to the horizon.
///
/// Relative error about 1e-14 of the largest edge term; 0 where `source` is behind the horizon or seen from its back.
pub fn point_form_factor(receiver: [f64; 3], normal: [f64; 3], source: &Polygon) -> f64 {
    point_to_polygon(receiver.into(), normal.into(), &source.facet())
}

/// `A_r F_rs` in m^2 between two polygons: exact, symmetric in its arguments.
pub fn exact_area_form_factor(receiver: &Polygon, source: &Polygon) -> f64 {
    exact_exchange(&receiver.facet(), &source.facet())
}

/// `A_r F_rs` in m^2 by quadrature chosen by distance, with relative error about `accuracy`; symmetric in its arguments.
pub fn estimate_area_form_factor(receiver: &Polygon, source: &Polygon, accuracy: f64) -> Estimate {
    estimate_exchange(&receiver.facet(), &source.facet(), accuracy)
}

/// `A_r F_rs` in m^2 by Lambert's sum at `points` by `points` Gauss points of the receiver alone, so not symmetric: an independent
/// check on the others, by asking from either side.
pub fn sided_area_form_factor(receiver: &Polygon, source: &Polygon, points: usize) -> Estimate {
    sided_exchange(&receiver.facet(), &source.facet(), points)
}

/// The least and the largest form factor from a point of the interior of `receiver` to `source` with nothing in between: proven, up to
/// rounding, which is allowed for. Attained by the least; the largest is a bound that may lie above.
pub fn bound_form_factor(receiver: &Polygon, source: &Polygon) -> [f64; 2] {
    bound_unoccluded(&receiver.facet(), &source.facet(), Search::CLOSE)
}

/// The range of the form factor over the receiver's centroid and vertices alone (Lischinski 1994, section 5.2), which is no bound.
pub fn estimate_form_factor_range(receiver: &Polygon, source: &Polygon) -> [f64; 2] {
    estimate_unoccluded_range(&receiver.facet(), &source.facet())
}
