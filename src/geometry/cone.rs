//! Cones of directions: which way a group of faces faces.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec3;

/// All directions within `angle` of `axis`, in radians, 0 to pi.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Cone {
    axis: DVec3,
    angle: f64,
}

/// Angles are widened by this wherever rounding may have made them too small.
const WIDENED: f64 = 1e-9;

impl Cone {
    /// All directions.
    pub const ALL: Self = Self { axis: DVec3::Z, angle: PI };

    /// A unit direction alone.
    pub fn of(direction: DVec3) -> Self {
        Self { axis: direction, angle: WIDENED }
    }

    /// The directions from points of one ball to points of another, `apart` from middle to middle, `reach` the sum of the radii.
    pub fn between(apart: DVec3, reach: f64) -> Self {
        let distance = apart.length();
        if distance <= reach * (1.0 + WIDENED) {
            return Self::ALL;
        }
        Self { axis: apart / distance, angle: (reach / distance).asin() + WIDENED }
    }

    /// A cone around both.
    pub fn union(self, other: Self) -> Self {
        let (wide, narrow) = if self.angle >= other.angle { (self, other) } else { (other, self) };
        let between = wide.axis.angle_between(narrow.axis);
        if between + narrow.angle <= wide.angle {
            return wide;
        }
        let angle = 0.5 * (wide.angle + between + narrow.angle) + WIDENED;
        let across = (narrow.axis - wide.axis * wide.axis.dot(narrow.axis)).normalize_or_zero();
        if angle >= PI || across == DVec3::ZERO {
            return Self::ALL;
        }
        let turn = angle - wide.angle;
        Self { axis: (wide.axis * turn.cos() + across * turn.sin()).normalize(), angle }
    }

    /// The largest cosine, 0 if negative, between a direction of this cone and one of another.
    pub fn bound_cosine(&self, other: &Self) -> f64 {
        let least = self.axis.angle_between(other.axis) - (self.angle + other.angle) - WIDENED;
        if least >= FRAC_PI_2 { 0.0 } else { least.max(0.0).cos() }
    }

    /// The opposite directions.
    pub fn reversed(&self) -> Self {
        Self { axis: -self.axis, ..*self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::sampling;

    fn near(axis: DVec3, off: f64, seed: u64) -> DVec3 {
        let [x, y, z] = [1, 2, 3].map(|k| 2.0 * sampling::unit(sampling::hash(seed, k)) - 1.0);
        (axis + off * DVec3::new(x, y, z)).normalize()
    }

    #[test]
    fn a_union_holds_all_and_no_cosine_exceeds_the_bound() {
        for seed in 0..300 {
            let off = 0.05 * (seed % 40) as f64;
            let (axis, other_axis) = (near(DVec3::Z, 10.0, seed), near(DVec3::X, 10.0, seed + 1000));
            let directions: Vec<DVec3> = (0..12).map(|k| near(axis, off, 100 * seed + k)).collect();
            let others: Vec<DVec3> = (0..12).map(|k| near(other_axis, 0.3, 777 + 100 * seed + k)).collect();
            let around = |directions: &[DVec3]| directions.iter().map(|&d| Cone::of(d)).reduce(Cone::union).unwrap();
            let (cone, other) = (around(&directions), around(&others));
            assert!(directions.iter().all(|d| d.angle_between(cone.axis) <= cone.angle));
            let largest = directions.iter().flat_map(|a| others.iter().map(|b| a.dot(*b))).fold(0.0, f64::max);
            assert!(largest <= cone.bound_cosine(&other) && other.bound_cosine(&cone) == cone.bound_cosine(&other));
        }
    }

    #[test]
    fn one_direction_keeps_its_cosine() {
        let (a, b) = (near(DVec3::Z, 0.4, 1), near(DVec3::Z, 0.4, 2));
        assert!((Cone::of(a).bound_cosine(&Cone::of(b)) - a.dot(b)).abs() < 1e-7);
        assert_eq!(Cone::of(a).bound_cosine(&Cone::of(-a)), 0.0);
        assert_eq!(Cone::of(a).reversed().bound_cosine(&Cone::of(a)), 0.0);
    }

    #[test]
    fn directions_between_two_balls_are_in_their_cone() {
        let apart = DVec3::new(3.0, 1.0, -2.0);
        let cone = Cone::between(apart, 1.5);
        for seed in 0..200 {
            let towards = apart + near(DVec3::Z, 20.0, seed) - 0.5 * near(DVec3::Y, 20.0, seed + 500);
            assert!(towards.normalize().angle_between(cone.axis) <= cone.angle);
        }
        assert_eq!(Cone::between(apart, 4.0), Cone::ALL);
    }
}
