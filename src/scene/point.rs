//! A point that somebody asks about.

use thiserror::Error;

/// A point that lies on a surface, with the normal of the side that is looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// In metres.
    pub position: [f64; 3],
    /// Unit normal of the side that is looked at.
    pub normal: [f64; 3],
}

/// Why numbers are no point on a surface.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum PointError {
    /// A coordinate is NaN or infinite.
    #[error("a coordinate is not finite")]
    NotFinite,
    /// The normal is not of length 1 within [`SurfacePoint::UNIT_TOLERANCE`].
    #[error("its normal has length {0}, not 1")]
    NotUnit(f64),
}

impl SurfacePoint {
    /// The length of a normal that is given may be off by this: numbers of four digits are by 1e-4.
    pub const UNIT_TOLERANCE: f64 = 1e-3;

    /// A point of numbers that nobody has checked yet.
    ///
    /// # Errors
    /// See [`PointError`].
    pub fn checked(position: [f64; 3], normal: [f64; 3]) -> Result<Self, PointError> {
        if !position.iter().chain(&normal).all(|x| x.is_finite()) {
            return Err(PointError::NotFinite);
        }
        let length = normal.iter().map(|x| x * x).sum::<f64>().sqrt();
        if (length - 1.0).abs() > Self::UNIT_TOLERANCE {
            return Err(PointError::NotUnit(length));
        }
        Ok(Self { position, normal })
    }
}
