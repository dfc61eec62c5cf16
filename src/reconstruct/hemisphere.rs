//! The gather over the hemisphere: `B(x) = E + rho (direct(x) + mean of what paths from x find)`.
//!
//! Rays to lamps bring direct light, paths over the hemisphere all other, with the radiosities that are resolved in the cells where
//! they end. No links are asked, so the cost of a point is that of its rays, however many surfaces send light there.

use super::light_paths::{Ends, LightPaths, NO_CELL, Place};
use super::resolved::Resolved;

/// Rays to lamps for each path over the hemisphere. At equal numbers of rays, an office came out at 2.25, 1.83 and 1.75% with 1/8,
/// 1/4, 1/2.
const LAMP_RAYS: f64 = 0.5;

/// Rays to lamps, at least.
const LEAST_LAMP_RAYS: u32 = 4;

/// Gathers over the hemisphere.
pub(crate) struct HemisphereGather<'a> {
    pub paths: &'a LightPaths<'a>,
    pub resolved: &'a Resolved,
    /// Bounces that every path takes before it believes a cell: 0 for values, more where values are judged.
    pub bounces: u32,
}

impl HemisphereGather<'_> {
    /// The irradiance H at each place by `rays` rays, in W/m^2, place after place.
    pub fn sampled_irradiance(&self, places: &[Place], rays: u32, ends: &mut Ends, irradiance: &mut [f64]) {
        let channels = self.paths.scene.channels();
        let count = rays.max(1);
        irradiance.fill(0.0);
        let lamp_rays = ((f64::from(count) * LAMP_RAYS) as u32).max(LEAST_LAMP_RAYS);
        self.paths.add_lamps(places, lamp_rays, irradiance);
        self.paths.follow(places, count, self.bounces, ends);

        let share = 1.0 / f64::from(count);
        for (path, &cell) in ends.cell.iter().enumerate() {
            let irradiance = &mut irradiance[path / count as usize * channels..][..channels];
            let own = path * channels..(path + 1) * channels;
            irradiance.iter_mut().zip(&ends.constant[own.clone()]).for_each(|(h, constant)| *h += share * constant);
            if cell != NO_CELL {
                let sent = self.resolved.of(cell).iter().zip(&ends.weight[own]);
                irradiance.iter_mut().zip(sent).for_each(|(h, (&sent, weight))| *h += share * weight * f64::from(sent));
            }
        }
    }
}
