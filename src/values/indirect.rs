//! Indirect irradiance: all light at a point but what emitters send straight.

use super::budget::RayBudget;
use super::final_gather::FinalGather;
use super::gather::Scratch;
use super::over_links::LinkGather;
use crate::paths::{BATCHES, BatchSums, Place};

/// Gathers indirect irradiance.
pub(crate) enum IndirectGather<'a> {
    /// Over links, by a gather of reflected light.
    Links(LinkGather<'a>),
    /// Over cells.
    Cells(FinalGather<'a>),
}

impl IndirectGather<'_> {
    /// The irradiance at a place and its variance, by channel, in W/m^2 and squared.
    pub fn sampled_irradiance(&self, place: &Place, budget: RayBudget, scratch: &mut Scratch, found: &mut [[f64; 2]]) {
        let Scratch { links, paths, sums } = scratch;
        let channels = found.len();
        match self {
            Self::Links(gather) => {
                sums.clear();
                sums.resize(channels, 0.0);
                gather.irradiance_at(place, budget, links, sums);
                found.iter_mut().zip(&*sums).zip(&links.variance).for_each(|((found, &h), &variance)| *found = [h, variance]);
            }
            Self::Cells(gather) => {
                let batches = budget.rays.clamp(1, BATCHES);
                sums.clear();
                sums.resize(channels * batches as usize, 0.0);
                let mut sums = BatchSums::new(channels, batches, sums, &mut []);
                let place = std::slice::from_ref(place);
                gather.add_sampled_indirect(place, budget.rays, paths, &mut sums);
                gather.add_sampled_from_reflectors(place, budget.rays, paths, &mut sums);
                for (channel, found) in found.iter_mut().enumerate() {
                    *found = sums.sum_and_variance(0, channel).into();
                }
            }
        }
    }
}
