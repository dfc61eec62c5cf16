//! How many rays a value at a point takes.

/// The square of the noise of a value falls with this power of its rays: 1 for independent rays, up to 2 for directions that are spread
/// evenly over what varies smoothly. Measured by `cargo bench --bench effort`, which names the range.
pub(crate) const NOISE_POWER: f64 = 1.3;

/// How many rays a value at a point takes, and which.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RayBudget {
    /// Rays from the point.
    pub rays: u32,
    /// Over links: the least probability of a ray to a source that is worth less than one, in (0, 1]. Smaller for pictures, where
    /// more noise at each of many points does no harm.
    pub least_chance: f64,
    /// Picks the random numbers, together with the point.
    pub seed: u64,
}

/// [`RayBudget::least_chance`] of values. Empirical.
const LEAST_CHANCE: f64 = 0.5;

/// A value where one of the rays of another ends takes one of so many of its rays, and at least [`LEAST_BEYOND`]. Empirical.
const BEYOND: u32 = 32;
const LEAST_BEYOND: u32 = 8;

impl RayBudget {
    /// For a value that a user asks for.
    pub fn of_values(rays: u32, seed: u64) -> Self {
        Self { rays, least_chance: LEAST_CHANCE, seed }
    }

    /// For a value where one of the rays of another ends.
    pub(crate) fn beyond(self) -> Self {
        Self { rays: (self.rays / BEYOND).max(LEAST_BEYOND), ..self }
    }
}
