//! Bounds at points: gathered there where that is possible, else those of the leaf that each lies on.

use glam::DVec3;
use rayon::prelude::*;

use super::point_gather::PointGather;
use super::radiosity_bounds::RadiosityBounds;
use crate::hierarchy::Hierarchy;
use crate::scene::{Scene, SurfacePoint};

/// A point lies on a surface if it is no farther than this part of the scene's diagonal, as for values at points.
const TOLERANCE: f64 = 1e-5;

/// Lower and upper radiosities at points, rounded outwards.
#[derive(Clone, Debug, PartialEq)]
pub struct PointBounds {
    /// Channels per value.
    pub channels: usize,
    /// `channels` lower radiosities per point in W/m^2, point after point; NaN at points that lie on no surface.
    pub lower: Vec<f32>,
    /// The upper ones.
    pub upper: Vec<f32>,
}

impl RadiosityBounds {
    /// The bounds at points, in their order: in the current rayon pool.
    pub(crate) fn at(&self, scene: &Scene, hierarchy: &Hierarchy, points: &[SurfacePoint]) -> PointBounds {
        let channels = self.channels();
        let tolerance = TOLERANCE * scene.bounds().diagonal();
        let unknown = vec![f32::NAN; channels * points.len()];
        let mut bounds = PointBounds { channels, lower: unknown.clone(), upper: unknown };
        let gather = self.elements.as_ref().map(|elements| PointGather::new(scene, elements));
        let at_point = |((lower, upper), point): ((&mut [f32], &mut [f32]), &SurfacePoint)| {
            let position = DVec3::from(point.position);
            let Some(surface) = hierarchy.surface_at(position, DVec3::from(point.normal), tolerance) else { return };
            let leaf = hierarchy.leaf_at(surface, position);
            let of_leaf = || self.lower(leaf).iter().zip(self.upper(leaf)).map(|(&lower, &upper)| [lower, upper]).collect();
            let found: Vec<[f64; 2]> = gather.as_ref().map_or_else(of_leaf, |gather| gather.at(surface, position));
            for (channel, [least, most]) in found.into_iter().enumerate() {
                (lower[channel], upper[channel]) = (rounded_down(least), rounded_up(most));
            }
        };
        let by_point = bounds.lower.par_chunks_mut(channels).zip(bounds.upper.par_chunks_mut(channels));
        by_point.zip(points).for_each(at_point);
        bounds
    }
}

impl PointBounds {
    /// Moves values that lie outside of their bounds to the nearer one.
    pub(crate) fn confine(&self, values: &mut [f32]) {
        for (value, (lower, upper)) in values.iter_mut().zip(self.lower.iter().zip(&self.upper)) {
            if !value.is_nan() {
                *value = value.max(*lower).min(*upper);
            }
        }
    }
}

fn rounded_down(value: f64) -> f32 {
    let near = value as f32;
    if f64::from(near) > value { near.next_down() } else { near }
}

fn rounded_up(value: f64) -> f32 {
    let near = value as f32;
    if f64::from(near) < value { near.next_up() } else { near }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_are_rounded_outwards() {
        for value in [0.1, 1.0 / 3.0, 1.0, 16_777_217.0, 1e-40, 0.0] {
            assert!(f64::from(rounded_down(value)) <= value && value <= f64::from(rounded_up(value)));
            assert!(rounded_up(value) <= rounded_down(value).next_up());
        }
    }

    #[test]
    fn values_are_confined_and_missing_ones_left() {
        let bounds = PointBounds { channels: 1, lower: vec![1.0, 1.0, 1.0, f32::NAN], upper: vec![2.0, 2.0, 2.0, f32::NAN] };
        let mut values = [0.5, 1.5, 3.0, f32::NAN];
        bounds.confine(&mut values);
        assert_eq!(values[..3], [1.0, 1.5, 2.0]);
        assert!(values[3].is_nan());
    }
}
