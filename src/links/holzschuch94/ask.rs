//! The visibility of pairs, asked once: the links of those of which a ray arrives.

use rayon::prelude::*;

use super::context::MutualContext;
use super::mutual_links::{MutualLink, MutualLinks};
use crate::hierarchy::{Hierarchy, NodeId};
use crate::links::link_set::Pair;
use crate::links::sample_pairs::{SamplePairs, passes, sampled_transmittance};

/// Visibility rays for every link (section 2.1, footnote 2).
pub(crate) const RAYS_PER_LINK: u32 = 16;

/// Pairs that ask for visibility together: about a thousand segments.
const CHUNK: usize = 64;

/// Two nodes that are worth a link if anything gets through.
#[derive(Clone, Copy)]
pub(super) struct Promising {
    pub first: NodeId,
    pub second: NodeId,
    pub exchange: f64,
}

impl MutualLinks {
    /// The links of the pairs of which a ray arrives; the others are noted as unseen.
    pub(super) fn ask(&mut self, hierarchy: &Hierarchy, context: &MutualContext<'_>, promising: &[Promising]) -> Vec<MutualLink> {
        let asked: Vec<Vec<Option<MutualLink>>> =
            promising.par_chunks(CHUNK).map(|pairs| context.ask_chunk(hierarchy, pairs)).collect();
        self.counts.rays += promising.len() as u64 * u64::from(RAYS_PER_LINK);
        let mut links = Vec::with_capacity(promising.len());
        for (pair, link) in promising.iter().zip(asked.into_iter().flatten()) {
            match link {
                Some(link) => links.push(link),
                None => self.unseen.push(Pair { receiver: pair.first, source: pair.second }),
            }
        }
        links
    }
}

impl MutualContext<'_> {
    /// Casts the rays of some pairs; `None` for those of which none arrives.
    fn ask_chunk(&self, hierarchy: &Hierarchy, pairs: &[Promising]) -> Vec<Option<MutualLink>> {
        let mut samples = SamplePairs::default();
        for pair in pairs {
            let ends = Pair { receiver: pair.first, source: pair.second };
            let seed = ends.seed(self.seed);
            samples.add(self.scene, hierarchy, ends, RAYS_PER_LINK, seed);
        }
        let mut occluded = Vec::new();
        self.rays.occluded(&samples.segments, &mut occluded);
        let rays = RAYS_PER_LINK as usize;
        let link = |((pair, kernels), occluded): ((&Promising, &[f64]), &[bool])| {
            let is_fully_visible = occluded.iter().all(|occluded| !occluded);
            let visibility = if is_fully_visible { 1.0 } else { sampled_transmittance(kernels, occluded.iter().map(passes)) };
            let Promising { first, second, exchange } = *pair;
            (visibility > 0.0).then_some(MutualLink {
                exchange,
                first,
                second,
                visibility: visibility as f32,
                is_fully_visible,
                is_reduced: false,
            })
        };
        pairs.iter().zip(samples.kernels.chunks(rays)).zip(occluded.chunks(rays)).map(link).collect()
    }
}
