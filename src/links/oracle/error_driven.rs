//! Error-driven refinement (Lischinski 1994, section 5.3.2): links are split that add most to the error of what one wants to know.
//!
//! It does not look at pairs that may be linked, but at links after a solve, because what a link does wrong is known by then.

use super::decision::Decision;

/// What a link does wrong, and the nodes it is between.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkError {
    /// What the link adds to the error, in the units of the tolerance.
    pub share: f64,
    /// What the irradiance of the receiver is wrong by because the form factor varies over the receiver.
    pub by_form_factor: f64,
    /// The same because the radiosity varies over the source.
    pub by_source: f64,
    /// In m^2.
    pub receiver_area: f64,
    /// In m^2.
    pub source_area: f64,
}

/// Splits links that add more than `tolerance` to the error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorDriven {
    /// In the units of [`LinkError::share`].
    pub tolerance: f64,
    /// Nodes of this area or less are not split, in m^2.
    pub min_area: f64,
}

impl ErrorDriven {
    /// What becomes of a link: the receiver is split if the form factor makes the larger error, else the source.
    pub fn decide(&self, error: &LinkError) -> Decision {
        let (receiver, source) = (error.receiver_area > self.min_area, error.source_area > self.min_area);
        if error.share <= self.tolerance {
            Decision::Link
        } else if receiver && (error.by_form_factor >= error.by_source || !source) {
            Decision::SplitReceiver
        } else if source && error.by_source > 0.0 {
            Decision::SplitSource
        } else {
            Decision::Link
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_makes_the_larger_error_is_split_down_to_the_smallest_area() {
        let oracle = ErrorDriven { tolerance: 1.0, min_area: 0.1 };
        let error = LinkError { share: 2.0, by_form_factor: 0.2, by_source: 0.1, receiver_area: 1.0, source_area: 1.0 };
        assert_eq!(oracle.decide(&error), Decision::SplitReceiver);
        assert_eq!(oracle.decide(&LinkError { share: 1.0, ..error }), Decision::Link);
        assert_eq!(oracle.decide(&LinkError { by_source: 0.3, ..error }), Decision::SplitSource);
        assert_eq!(oracle.decide(&LinkError { receiver_area: 0.1, ..error }), Decision::SplitSource);
        assert_eq!(oracle.decide(&LinkError { by_source: 0.3, source_area: 0.1, ..error }), Decision::SplitReceiver);
        assert_eq!(oracle.decide(&LinkError { by_source: 0.0, receiver_area: 0.1, ..error }), Decision::Link);
    }
}
