//! How the requested error is shared between values at points and the function that is made from them.
//!
//! The function is off the truth by what the values are off, and by what it is off the values. The two have nothing to do with each other, so their
//! squares add up.
//!
//! The work of either is about inverse to the square of its error. If values with a part p of the squared error take v / p, and the mesh takes
//! m / (1 - p), both take least in all where `p / (1 - p)` is the root of v / m.
//!
//! What values take does not hang on how many surfaces there are, what a mesh takes does, since each surface has some elements. In fourteen rooms with 20
//! to 2,900 surfaces m / v lies around `1 + surfaces / 40`, from a quarter to 2.5 times that. A tenth more work than the least is done at a ratio that is
//! four times too large or too small.

use crate::scene::{Scene, SurfaceId};

/// So many surfaces take as much, beside what a mesh with few takes, as values do.
const SURFACES: f64 = 40.0;

/// The mesh is not asked for less than so much of what was meant for it, however much of the squared error the values have: it would take four times as
/// long.
const LEAST_OF_MEANT: f64 = 0.25;

/// The parts of a squared error.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shares {
    whole: f64,
    /// What the mesh may have of its square.
    of_mesh: f64,
}

impl Shares {
    /// Of an error that is asked for values and mesh of a scene together.
    pub fn of(scene: &Scene, whole: f64) -> Self {
        let all = (0..scene.surfaces().len() as u32).map(SurfaceId);
        Self::by_surfaces(all.filter(|&surface| scene.material_of(surface).reflects()).count(), whole)
    }

    fn by_surfaces(surfaces: usize, whole: f64) -> Self {
        let mesh_over_values = 1.0 + surfaces as f64 / SURFACES;
        Self { whole, of_mesh: 1.0 / (1.0 + mesh_over_values.sqrt().recip()) }
    }

    /// The error that is asked of values at points.
    pub fn error_of_values(self) -> f64 {
        self.whole * (1.0 - self.of_mesh).sqrt()
    }

    /// The error that is asked of the function beside values of which an error is claimed: all that these leave of the whole; if they leave too
    /// little, as much as was meant for it.
    pub fn error_of_mesh(self, claimed_of_values: f64) -> f64 {
        let left = 1.0 - (claimed_of_values / self.whole).powi(2);
        self.whole * if left >= LEAST_OF_MEANT * self.of_mesh { left } else { self.of_mesh }.sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_together_have_the_error_that_is_asked_for() {
        for shares in [0, 20, 3000, 1_000_000].map(|surfaces| Shares::by_surfaces(surfaces, 0.02)) {
            for part in [0.0, 0.1, 0.5, 1.0] {
                let values = part * shares.error_of_values();
                let of_mesh = shares.error_of_mesh(values);
                assert!((values.hypot(of_mesh) - 0.02).abs() < 1e-15, "{part} {shares:?}");
            }
            // Values that leave nothing, or of which nothing is known.
            for values in [0.0199, 0.02, 0.5, f64::INFINITY, f64::NAN] {
                assert_eq!(shares.error_of_mesh(values), 0.02 * shares.of_mesh.sqrt());
            }
        }
        // Where there are few surfaces, each has half.
        assert!((Shares::by_surfaces(0, 0.02).of_mesh - 0.5).abs() < 1e-15);
    }
}
