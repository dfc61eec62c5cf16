//! How the requested error is shared between values at points and the function that is made from them.
//!
//! The function is off the truth by what the values are off, and by what it is off the values. The two have nothing to do with each other, so their
//! squares add up.
//!
//! The work of either is about inverse to the square of its error. If values with a part p of the squared error take v / p, and the mesh takes
//! m / (1 - p), both take least in all where `p / (1 - p)` is the root of v / m.

/// The part of the squared error that the mesh may have: best where it takes 16 times what the values take at the same error; within a tenth of the
/// least work from 5 to 130 times. Above 0, below 1.
const MESH_PART: f64 = 0.8;

/// The mesh is not asked for a smaller part of the squared error than this, however much of it the values have: it would take four times as long as
/// was meant.
const LEAST_MESH_PART: f64 = MESH_PART / 4.0;

/// The error that is asked of values at points where the whole is to have this one.
pub(super) fn error_of_values(whole: f64) -> f64 {
    whole * (1.0 - MESH_PART).sqrt()
}

/// The error that is asked of the function beside values of which an error is claimed: all that these leave of the whole; if they leave too
/// little, as much as was meant for it.
pub(super) fn error_of_mesh(whole: f64, claimed_of_values: f64) -> f64 {
    let left = 1.0 - (claimed_of_values / whole).powi(2);
    whole * if left >= LEAST_MESH_PART { left } else { MESH_PART }.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_together_have_the_error_that_is_asked_for() {
        for part in [0.0, 0.1, 1.0, 1.5, 1.9] {
            let values = part * error_of_values(0.02);
            let of_mesh = error_of_mesh(0.02, values);
            assert!((values.hypot(of_mesh) - 0.02).abs() < 1e-15, "{part}");
        }
        // Values that leave nothing, or of which nothing is known.
        for values in [0.0199, 0.02, 0.5, f64::INFINITY, f64::NAN] {
            assert_eq!(error_of_mesh(0.02, values), 0.02 * MESH_PART.sqrt());
        }
    }
}
