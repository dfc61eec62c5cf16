//! What becomes of texels that a limit kept from being found.
//!
//! In a chart where some are known, the others are filled from beside them, ring after ring. A chart of which nothing is known has the radiosities of the
//! solver's own elements: these are coarse, and nothing is claimed for them.

use glam::DVec3;
use rayon::prelude::*;

use super::fill::Canvas;
use super::texels::Texels;
use crate::scene::{Scene, SurfaceId};

/// The reflected radiosity of the solver's own elements at a point, by channel in W/m^2.
pub(crate) type Coarse<'a> = &'a (dyn Fn(SurfaceId, DVec3) -> Vec<f32> + Sync);

/// Texels of which some part was not found: those that were interpolated or filled from others of their chart, and those that are coarse.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct NotFound {
    pub filled: u64,
    pub coarse: u64,
}

impl NotFound {
    /// Of all charts.
    pub fn of(texels: &[Texels<'_>]) -> Self {
        let mut all = Self::default();
        for texels in texels {
            if texels.is_coarse {
                all.coarse += texels.sites.iter().filter(|site| site.is_covered()).count() as u64;
            } else {
                all.filled += texels.not_found;
            }
        }
        all
    }
}

/// Gives a value of this part to all texels that have none, and notes how many these are, with those `between` others that have one already, chart by
/// chart.
pub(crate) fn complete(scene: &Scene, texels: &mut [Texels<'_>], between: &[u64], coarse: Coarse<'_>) {
    texels.par_iter_mut().zip(between).for_each(|(texels, between)| {
        let wanted: Vec<usize> = (0..texels.sites.len()).filter(|&index| texels.is_wanted(index)).collect();
        let is_found = |index: usize| texels.sites[index].is_covered() && texels.is_known(index);
        if wanted.is_empty() {
            texels.not_found = texels.not_found.max(*between);
            return;
        }
        if (0..texels.sites.len()).any(is_found) {
            fill(texels, &wanted);
        } else {
            take_coarse(scene, texels, &wanted, coarse);
        }
        texels.not_found = texels.not_found.max(between + wanted.len() as u64);
    });
}

/// Fills texels of a chart from others of it.
fn fill(texels: &mut Texels<'_>, wanted: &[usize]) {
    let (count, channels) = (texels.numbers(), texels.channels());
    let mut canvas = Canvas::new(texels.chart.size(), count);
    for index in (0..texels.sites.len()).filter(|&index| texels.sites[index].is_covered()) {
        canvas.numbers[index * count..][..count].copy_from_slice(texels.numbers_of(index));
    }
    canvas.fill();
    for &index in wanted {
        let (reflected, straight) = canvas.numbers[index * count..][..count].split_at(channels);
        texels.set(index, reflected, straight);
    }
}

/// Gives texels what the solver's elements reflect beyond what is known before.
fn take_coarse(scene: &Scene, texels: &mut Texels<'_>, wanted: &[usize], coarse: Coarse<'_>) {
    let nothing = vec![0.0; texels.channels()];
    for &index in wanted {
        let mut reflected = coarse(SurfaceId(texels.sites[index].surface), texels.point(scene, index));
        let before = &texels.before[index * texels.numbers()..][..texels.channels()];
        reflected.iter_mut().zip(before).for_each(|(reflected, before)| *reflected = (*reflected - before).max(0.0));
        texels.set(index, &reflected, &nothing);
    }
    texels.is_coarse = true;
}
