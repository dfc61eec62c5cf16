//! Functions of direction: clamped cosines around many axes, added up to second order.

use std::ops::AddAssign;

use glam::DVec3;
use serde::{Deserialize, Serialize};

/// The sum of `w_i max(0, n_i . d)` over weighted unit axes n_i, as a function of the unit direction d.
///
/// Each clamped cosine stands as its expansion to second order, `3/32 + c/2 + 15/32 c^2` (Ramamoorthi, Hanrahan 2001), which is off by
/// 3/32 at most. Weighted by areas with their normals it is the area that they show towards d; weighted by what arrives along d_i,
/// it is the irradiance of a surface with normal d.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Lobes {
    /// The sums of w, of w n, and of w n n^T: xx and yy, of which with zz the sum is that of w; then xy, yz, zx.
    weight: f64,
    first: DVec3,
    squares: [f64; 2],
    products: DVec3,
}

impl Lobes {
    /// Adds a lobe.
    pub fn add(&mut self, weight: f64, axis: DVec3) {
        self.weight += weight;
        self.first += weight * axis;
        self.squares[0] += weight * axis.x * axis.x;
        self.squares[1] += weight * axis.y * axis.y;
        self.products += weight * axis * DVec3::new(axis.y, axis.z, axis.x);
    }

    /// The sum in one direction.
    pub fn at(&self, direction: DVec3) -> f64 {
        let d = direction;
        let [xx, yy] = self.squares;
        let squares = DVec3::new(xx, yy, self.weight - xx - yy).dot(d * d);
        let products = 2.0 * self.products.dot(d * DVec3::new(d.y, d.z, d.x));
        3.0 / 32.0 * self.weight + 0.5 * self.first.dot(d) + 15.0 / 32.0 * (squares + products)
    }

    /// The sum of all weights.
    pub fn weight(&self) -> f64 {
        self.weight
    }
}

impl AddAssign for Lobes {
    fn add_assign(&mut self, other: Self) {
        self.weight += other.weight;
        self.first += other.first;
        self.squares.iter_mut().zip(other.squares).for_each(|(sum, other)| *sum += other);
        self.products += other.products;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::sampling;

    fn direction(seed: u64) -> DVec3 {
        let [z, angle] = [1, 2].map(|k| sampling::unit(sampling::hash(seed, k)));
        let (z, angle) = (2.0 * z - 1.0, std::f64::consts::TAU * angle);
        let radius = (1.0 - z * z).sqrt();
        DVec3::new(radius * angle.cos(), radius * angle.sin(), z)
    }

    #[test]
    fn one_lobe_is_a_clamped_cosine_within_its_expansion() {
        for seed in 0..200 {
            let (axis, towards) = (direction(seed), direction(seed + 1000));
            let mut lobes = Lobes::default();
            lobes.add(2.0, axis);
            let (found, exact) = (lobes.at(towards), 2.0 * axis.dot(towards).max(0.0));
            assert!((found - exact).abs() <= 2.0 * 0.0938, "{found} instead of {exact}");
            let c = axis.dot(towards);
            assert!((found - 2.0 * (3.0 / 32.0 + c / 2.0 + 15.0 / 32.0 * c * c)).abs() < 1e-12);
        }
    }

    #[test]
    fn power_arrives_in_full() {
        // What weighted axes receive from a lobe is what the lobe shows to them: sum w_i H(n_i) = sum over directions of h P(d).
        let (mut shown, mut incoming) = (Lobes::default(), Lobes::default());
        let faces: Vec<(f64, DVec3)> = (0..20).map(|k| (0.5 + k as f64, direction(k))).collect();
        faces.iter().for_each(|&(area, normal)| shown.add(area, normal));
        let arriving: Vec<(f64, DVec3)> = (0..7).map(|k| (1.0 + k as f64, direction(100 + k))).collect();
        arriving.iter().for_each(|&(h, towards)| incoming.add(h, towards));
        let received: f64 = faces.iter().map(|&(area, normal)| area * incoming.at(normal)).sum();
        let sent: f64 = arriving.iter().map(|&(h, towards)| h * shown.at(towards)).sum();
        assert!((received - sent).abs() < 1e-9 * sent);
    }
}
