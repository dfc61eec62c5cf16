//! All pairs of surfaces, linked in batches.

use rayon::prelude::*;

use super::context::{RefineDirection, SampledContext};
use super::kernels::Kernel;
use super::refine::refine;
use super::sampled_link::{SampledLink, link_set};
use super::trees::Tree;
use crate::hierarchy::Hierarchy;
use crate::links::exchange::is_dark;
use crate::links::limits::{Holding, RefineEnd, RefineLimits};
use crate::links::link_set::{LinkSet, Pair};
use crate::scene::SurfaceId;

/// All links, and how they were found.
pub(crate) struct SampledLinks {
    pub links: LinkSet,
    pub end: RefineEnd,
    /// Pairs of nodes without a link because they are behind one another or in one plane.
    pub behind: u64,
    /// Links of which no sample got through.
    pub unseen: u64,
}

/// Rays after which limits are checked again, as far as no single pair of surfaces takes more.
const BATCH_RAYS: u64 = 1 << 21;

impl SampledContext<'_> {
    /// Subdivides all surfaces, and links all pairs of them.
    ///
    /// Where a limit ends it, the pairs of surfaces that are left are dormant.
    pub fn link(&self, hierarchy: &mut Hierarchy, limits: &RefineLimits<'_>) -> SampledLinks {
        let (trees, mut end) = self.subdivide(hierarchy, limits);
        let hierarchy = &*hierarchy;
        let mut pairs = (0..trees.len()).flat_map(|first| (first + 1..trees.len()).map(move |second| (first, second)));
        let mut to_go = trees.len() * trees.len().saturating_sub(1) / 2;
        let (mut linked, mut left_out) = (Vec::new(), Vec::new());
        let mut counts = Counts::default();
        let mut batch = Vec::new();
        loop {
            // The next pairs of surfaces, until they make a batch.
            batch.clear();
            let mut rays = 0;
            while rays < BATCH_RAYS && end == RefineEnd::Content {
                let Some((first, second)) = pairs.next() else { break };
                rays += trees[first].elements() * trees[second].elements() * u64::from(self.samples).pow(2);
                batch.push((first, second));
            }
            if batch.is_empty() {
                break;
            }

            // Their links, in the order of the pairs, as far as they fit.
            let links: Vec<(Vec<SampledLink>, Counts)> =
                batch.par_iter().map(|&(first, second)| self.link_surfaces(hierarchy, &trees[first], &trees[second])).collect();
            for (&pair, (links, found)) in batch.iter().zip(links) {
                to_go -= 1;
                let holding = Holding { links: 2 * (linked.len() + links.len()), unlinked: 2 * (left_out.len() + to_go) };
                if end == RefineEnd::Content {
                    end = limits.exceeded(hierarchy, holding, 0).unwrap_or(end);
                }
                if end == RefineEnd::Content {
                    linked.extend(links);
                    counts.behind += found.behind;
                    counts.unseen += found.unseen;
                } else {
                    left_out.push(pair);
                }
            }
            if end == RefineEnd::Content {
                end = limits.says_end(hierarchy, 2 * linked.len(), 0).unwrap_or(end);
            }
        }
        let surface = |tree: usize| trees[tree].root();
        let both = |(first, second)| [(first, second), (second, first)];
        let dormant = left_out
            .into_iter()
            .chain(pairs)
            .flat_map(both)
            .map(|(a, b)| Pair { receiver: surface(a), source: surface(b) })
            .collect();
        SampledLinks { links: link_set(hierarchy, &linked, dormant), end, behind: counts.behind, unseen: counts.unseen }
    }

    /// The complete trees of all surfaces, in order.
    fn subdivide(&self, hierarchy: &mut Hierarchy, limits: &RefineLimits<'_>) -> (Vec<Tree>, RefineEnd) {
        let mut end = RefineEnd::Content;
        let trees = (0..self.scene.surfaces().len() as u32)
            .map(|surface| {
                let root = hierarchy.node_of(SurfaceId(surface));
                if end == RefineEnd::Content {
                    end = limits.exceeded(hierarchy, Holding::default(), 0).unwrap_or(end);
                }
                let min_area = if end == RefineEnd::Content { self.min_area } else { f64::INFINITY };
                Tree::complete(hierarchy, root, min_area)
            })
            .collect();
        (trees, end)
    }

    /// The links between two surfaces.
    fn link_surfaces(&self, hierarchy: &Hierarchy, first: &Tree, second: &Tree) -> (Vec<SampledLink>, Counts) {
        let is_dark = |link: &SampledLink| is_dark(self.scene, hierarchy, Pair { receiver: link.first, source: link.second });
        let whole = SampledLink { first: first.root(), second: second.root(), kernel: Kernel::default() };
        if is_dark(&whole) {
            return (Vec::new(), Counts { behind: 1, unseen: 0 });
        }
        let mut links = match self.direction {
            RefineDirection::BottomUp => {
                let bottom = self.sample(hierarchy, first.level(0), second.level(0));
                refine(hierarchy, first, second, bottom, self.form_factor_tolerance)
            }
            RefineDirection::TopDown => self.refine_top_down(hierarchy, first.root(), second.root()),
        };
        let all = links.len();
        links.retain(|link| link.kernel.unoccluded > 0.0 || !is_dark(link));
        let unseen = links.iter().filter(|link| link.kernel.exchange == 0.0).count();
        let counts = Counts { behind: (all - links.len()) as u64, unseen: unseen as u64 };
        (links, counts)
    }
}

/// Pairs that carry nothing.
#[derive(Clone, Copy, Default)]
struct Counts {
    behind: u64,
    unseen: u64,
}
