//! Links by the error of their form factors alone, from samples of the kernel (Chang, Shih 1998): bottom-up, and top-down to
//! compare.
//!
//! A link between p and q gets its form factors from the mean kernel `<G>` of samples, and may get it wrong by `(max G - min G) A`
//! with A the area of the source. G holds the visibility, which has no lower bound that is easy to find, so min G is taken as zero
//! (section 4) and the error of a form factor is `max G A`. Top-down a pair of nodes is judged by samples on the nodes themselves;
//! bottom-up by all samples on the elements below, from which maxima and sums rise to the nodes above: these are better known then,
//! and nothing is sampled twice.
//!
//! Neither looks at light: links are made once. Both link pairs of surfaces, know no clusters, and subdivide every surface
//! completely, down to A_eps, beforehand. Maxima of samples are estimates, no bounds.
//!
//! Cost: bottom-up `(n A / A_eps)^2 / 2` pairs of elements, each asked `samples^2` rays, whatever the tolerance; top-down as many
//! rays for each pair of nodes that is looked at, which the tolerance decides.

mod kernels;
mod refine;
mod top_down;
mod trees;

#[cfg(test)]
mod tests;

use rayon::prelude::*;

use super::exchange::is_dark;
use super::limits::Holding;
use super::{Link, LinkSet, Pair, RefineEnd, RefineLimits};
use crate::hierarchy::{Hierarchy, NodeId};
use crate::scene::{Scene, SurfaceId};
use crate::transmittance::Rays;

use kernels::Kernel;
use trees::Tree;

/// From which end of the trees pairs of nodes are judged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum RefineDirection {
    /// Samples on the smallest elements, combined for what is above them.
    BottomUp,
    /// Samples on every node that is looked at, for itself.
    TopDown,
}

/// What linking looks at: everything but the hierarchy, which grows.
pub(crate) struct SampledContext<'a> {
    pub scene: &'a Scene,
    pub rays: &'a Rays<'a>,
    pub direction: RefineDirection,
    /// F_eps: a link's form factors may be wrong by less than this.
    pub form_factor_tolerance: f64,
    /// A_eps in m^2: no element is smaller.
    pub min_area: f64,
    /// Points on each node that is sampled; the kernel is taken between all points of two nodes.
    pub samples: u32,
    pub seed: u64,
}

/// All links, and how they were found.
pub(crate) struct SampledLinks {
    pub links: LinkSet,
    pub end: RefineEnd,
    /// Pairs of nodes without a link because they are behind one another or in one plane.
    pub behind: u64,
    /// Links of which no sample got through.
    pub unseen: u64,
}

/// A link for both directions.
#[derive(Clone, Copy, Debug, PartialEq)]
struct SampledLink {
    first: NodeId,
    second: NodeId,
    kernel: Kernel,
}

/// Rays between two looks at the limits, as far as no single pair of surfaces takes more.
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
            if end == RefineEnd::Content && limits.says_stop(hierarchy, 2 * linked.len()) {
                end = RefineEnd::Stopped;
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
                refine::refine(hierarchy, first, second, bottom, self.form_factor_tolerance)
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

/// The links by receiver, both directions.
fn link_set(hierarchy: &Hierarchy, linked: &[SampledLink], dormant: Vec<Pair>) -> LinkSet {
    let mut placed = Vec::with_capacity(2 * linked.len());
    for &SampledLink { first, second, kernel } in linked {
        let visibility = if kernel.unoccluded > 0.0 { (kernel.exchange / kernel.unoccluded).min(1.0) as f32 } else { 1.0 };
        for (receiver, source) in [(first, second), (second, first)] {
            // Samples that are close to each other may make more of it than a form factor can be.
            let form_factor = (kernel.unoccluded / hierarchy.area(receiver)).min(1.0);
            placed.push((receiver, Link { form_factor, source, transmittance: visibility, seen: visibility }));
        }
    }
    LinkSet::new(hierarchy.len(), &placed, dormant)
}

/// Whether the error of both form factors is below the tolerance: `max G A < F_eps`. The paper's procedure Error.
fn is_within(hierarchy: &Hierarchy, first: NodeId, second: NodeId, kernel: Kernel, tolerance: f64) -> bool {
    kernel.largest * hierarchy.area(first).max(hierarchy.area(second)) < tolerance
}
