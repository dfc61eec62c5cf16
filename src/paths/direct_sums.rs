//! Direct light with its own variance, as sums over batches.

use super::batch_sums::BatchSums;
use super::place::Receives;
use crate::direct::{DirectEffort, DirectLight, DirectScratch, Method};

/// Direct irradiance at a place; memory that is reused.
#[derive(Default)]
pub(super) struct DirectSums {
    scratch: DirectScratch,
    irradiance: Vec<f64>,
    variance: Vec<f64>,
}

impl DirectSums {
    /// Adds the direct irradiance at each place: exactly, or by rays, of which there are about `count`.
    pub fn add_irradiance(
        &mut self,
        direct: &DirectLight<'_>,
        places: &[impl Receives],
        count: u32,
        irradiance: &mut BatchSums<'_>,
    ) {
        let effort = DirectEffort { rays: count, method: Method::Cheaper };
        for (number, place) in places.iter().enumerate() {
            for sums in [&mut self.irradiance, &mut self.variance] {
                sums.clear();
                sums.resize(irradiance.channels(), 0.0);
            }
            let receiver = place.receiver(direct.scene);
            direct.add_irradiance(&receiver, effort, &mut self.scratch, &mut self.irradiance, &mut self.variance);
            direct.add_lights(&receiver, count, &mut self.scratch, &mut self.irradiance, &mut self.variance);
            for (channel, (&h, &variance)) in self.irradiance.iter().zip(&self.variance).enumerate() {
                irradiance.add(number, channel, h, variance);
            }
        }
    }
}
