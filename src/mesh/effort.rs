//! How many rays the light at a node takes.
//!
//! # Indirect light
//! The function is off by its noise and by what elements cannot follow. With n nodes of r rays each, the squared noise falls with `r^-b` and the
//! other part with `n^-a`; the work `n r` is least for their sum where the one is a / b times the other. Cubic convergence gives a = 3, edges and
//! corners of light about 1; b is [`NOISE_POWER`]. So they are about equal at best.
//!
//! # Direct light
//! Rays that are spread over what is undecided, one in each of as many strata, leave noise whose square falls with `r^-3/2` (Mitchell 1996). It is not
//! fitted to nodes around, and shows along shadows, so it is to be a small part of what is off. Nor may it be more than the error that is asked for where
//! half of the light is seen, however little of the area that is: along an edge across r strata about the root of r are seen or not, so the deviation is
//! about `r^-3/4 / 2` there.

use crate::values::NOISE_POWER;

/// The part of the squared error that noise may have. Above 0, below 1.
const NOISE_PART: f64 = 0.5;

/// The same in a picture, where what is left of it shows as mottles on smooth walls. As elements are refined, each node has fewer rays, and the noise grows
/// towards the half beyond which all nodes would take twice their gathers.
const NOISE_PART_OF_PICTURE: f64 = 1.0 / 3.0;

/// The same of direct light: elements that follow it well would be bisected for noise otherwise. Above 0, below 1.
const NOISE_PART_OF_DIRECT: f64 = 0.1;

/// The power of one over the rays by which that falls.
const DIRECT_POWER: f64 = 1.5;

/// The part that is left to what elements cannot follow.
pub(super) const FOLLOWED: f64 = 1.0 - NOISE_PART;

/// The claim lies above what is measured, by about this factor.
pub(super) const CLAIMED: f64 = 1.2;

/// The points and the rays by which the noise is measured.
pub(super) const PILOT_POINTS: usize = 512;
pub(super) const PILOT_RAYS: f64 = 64.0;

/// What nodes may take.
pub(super) const RAYS: (f64, f64) = (16.0, 8192.0);

/// The same for direct light: of fewer it often seems that they have no noise.
const DIRECT_RAYS: (f64, f64) = (32.0, 1024.0);

/// The rays of a node for a function, or one for a picture, that may be claimed to be off by `error`, when it has this squared noise with [`PILOT_RAYS`].
pub(super) fn rays_of_nodes(error: f64, noise_sq: f64, is_for_picture: bool) -> f64 {
    let part = if is_for_picture { NOISE_PART_OF_PICTURE } else { NOISE_PART };
    (PILOT_RAYS * too_noisy(error, noise_sq, part).powf(1.0 / NOISE_POWER)).clamp(RAYS.0, RAYS.1)
}

/// The same for direct light, which may have a part of the squared error.
pub(super) fn rays_of_direct(error: f64, part: f64, noise_sq: f64) -> f64 {
    let over = too_noisy(error * part.sqrt(), noise_sq, NOISE_PART_OF_DIRECT);
    let in_penumbras = (2.0 * error).powf(-2.0 / DIRECT_POWER);
    (PILOT_RAYS * over.powf(1.0 / DIRECT_POWER)).max(in_penumbras).clamp(DIRECT_RAYS.0, DIRECT_RAYS.1)
}

/// How many times the squared noise is what it may be, as a part of the squared error. The square of a small error may be 0, which would be as much as no
/// noise.
fn too_noisy(error: f64, noise_sq: f64, part: f64) -> f64 {
    (noise_sq.sqrt() / (error / CLAIMED)).powi(2) / part
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_are_in_range_whatever_is_asked_for() {
        for error in [1e-300, 5e-324, 1e-6, 1.0, 1e300] {
            assert_eq!(rays_of_nodes(error, 0.0, false), RAYS.0);
            for noise_sq in [1e-300, 1e-4, 1.0, 1e300] {
                assert!((RAYS.0..=RAYS.1).contains(&rays_of_nodes(error, noise_sq, true)), "{error} {noise_sq}");
                assert!((DIRECT_RAYS.0..=DIRECT_RAYS.1).contains(&rays_of_direct(error, 0.3, noise_sq)), "{error} {noise_sq}");
            }
        }
        assert!(rays_of_nodes(0.01, 1e-4, false) < rays_of_nodes(0.005, 1e-4, false));
        assert_eq!([0.5, 0.01].map(|error| rays_of_direct(error, 0.3, 0.0).round()), [DIRECT_RAYS.0, 184.0]);
    }
}
