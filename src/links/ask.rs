//! What passes along the segments of a batch: by transmittance maps where these are good enough for a pair, else by rays.

use super::context::{MapsOfLinks, RefineContext};
use super::link_set::Pair;
use super::sample_pairs::{SamplePairs, passes};
use crate::hierarchy::Hierarchy;
use crate::visibility::Segment;

impl RefineContext<'_> {
    /// Asks maps, where there are some, for the last `count` segments of a batch, which are those of a pair.
    pub(super) fn ask_maps(&self, hierarchy: &Hierarchy, pair: Pair, count: u32, samples: &mut SamplePairs) {
        let Some(MapsOfLinks { maps, tolerance }) = self.maps.filter(|_| count > 0) else { return };
        let first = samples.segments.len() - count as usize;
        if let Some((passes, _)) = maps.estimate(hierarchy, [pair.receiver, pair.source], &samples.segments[first..], tolerance) {
            samples.by_maps.push((first, passes));
        }
    }

    /// What passes along all segments of a batch: rays answer those that maps have not.
    pub(super) fn ask_rays(&self, samples: &SamplePairs) -> Vec<f64> {
        let mut occluded = Vec::new();
        if samples.by_maps.is_empty() {
            self.rays.occluded(&samples.segments, &mut occluded);
            return occluded.iter().map(passes).collect();
        }

        // What maps know, and gaps for the rays.
        let mut known = vec![None; samples.segments.len()];
        for (first, passes) in &samples.by_maps {
            known[*first..].iter_mut().zip(passes).for_each(|(known, &passes)| *known = Some(passes));
        }
        let open: Vec<Segment> =
            samples.segments.iter().zip(&known).filter(|(_, known)| known.is_none()).map(|asked| *asked.0).collect();
        self.rays.occluded(&open, &mut occluded);
        let mut by_rays = occluded.iter().map(passes);
        known.into_iter().map(|known| known.or_else(|| by_rays.next()).unwrap_or(0.0)).collect()
    }
}
