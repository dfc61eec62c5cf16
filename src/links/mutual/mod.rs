//! Links as Holzschuch, Sillion, Drettakis 1994 make them: between surfaces first, for both directions at once, refined by BF.
//!
//! Beside the link tree that starts from (root, root), which holds its pairs of surfaces only implicitly, this is the paper's own form, for
//! comparison: clusters play no part, every pair of surfaces is looked at, and n(n-1)/2 bits tell which have been classified. A link is
//! asked for its visibility once, by 16 rays; a pair of which no ray arrived is dropped. No unbiased second look is taken.
//!
//! Cost: O(n^2) looks at pairs in every iteration, without rays for those that are not worth it.

mod dormant;
mod pairs;
mod reduction;
mod refine;
mod top_level;

use std::sync::atomic::AtomicU64;

pub(crate) use dormant::DormantTransfer;
use pairs::PairSet;
pub(crate) use top_level::TopLevel;

use super::{Link, LinkSet, Pair, RefineEnd, RefineLimits};
use crate::hierarchy::{Hierarchy, NodeId};
use crate::scene::{Scene, SurfaceId};
use crate::transmittance::Rays;

/// Visibility rays for every link (section 2.1, footnote 2).
pub(crate) const RAYS_PER_LINK: u32 = 16;

/// What linking and refining look at: everything but the hierarchy, which grows.
pub(crate) struct MutualContext<'a> {
    pub scene: &'a Scene,
    pub rays: &'a Rays<'a>,
    /// `scene.channels()` radiosities per node; nodes that are newer take their nearest older ancestor's.
    pub radiosity: &'a [f64],
    /// Relative accuracy of form factors.
    pub form_factor_accuracy: f64,
    /// eps_refine in W/m^2: links that carry more irradiance than this are refined.
    pub refine_tolerance: f64,
    /// eps_reduce: refinement that changes form factors by less is taken back. `None` leaves links unreduced.
    pub reduce_tolerance: Option<f64>,
    /// Nodes of this area or less are not split, in m^2: the paper's MinArea.
    pub min_area: f64,
    pub seed: u64,
    /// Spent on form factors of links, added over threads.
    pub form_factor_nanoseconds: AtomicU64,
}

/// A link for both directions: the light that two nodes exchange.
#[derive(Clone, Copy, Debug, PartialEq)]
struct MutualLink {
    /// `A_first F_first,second = A_second F_second,first` in m^2, as if nothing were in between.
    exchange: f64,
    first: NodeId,
    second: NodeId,
    /// The part that gets through, above 0.
    visibility: f32,
    /// Whether every ray arrived.
    is_fully_visible: bool,
    /// Marked for good: refining would not tell more (section 4).
    is_reduced: bool,
}

/// All links so far, and what became of every pair of surfaces.
#[derive(Clone, Debug)]
pub(crate) struct MutualLinks {
    strategy: TopLevel,
    links: Vec<MutualLink>,
    /// Pairs of surfaces that are not classified yet.
    unclassified: PairSet,
    /// Pairs of nodes of which no ray arrived.
    unseen: Vec<Pair>,
    /// Counts of what was done.
    pub counts: MutualCounts,
}

/// Counts of what was done so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct MutualCounts {
    /// Visibility rays for links.
    pub rays: u64,
    /// Pairs of surfaces that were linked.
    pub top_level: u64,
    /// Of these, pairs that carried more than the tolerance at some time.
    pub top_level_exceeding: u64,
    /// Pairs of surfaces behind one another or in one plane.
    pub behind: u64,
    /// Links that are marked as not to be refined.
    pub reduced: u64,
}

impl MutualLinks {
    /// Nothing is linked yet.
    pub fn new(strategy: TopLevel, scene: &Scene) -> Self {
        Self {
            strategy,
            links: Vec::new(),
            unclassified: PairSet::all(scene.surfaces().len()),
            unseen: Vec::new(),
            counts: MutualCounts::default(),
        }
    }

    /// How many links there are, each direction counted.
    pub fn len(&self) -> u64 {
        2 * self.links.len() as u64
    }

    /// The links by receiver.
    pub fn link_set(&self, hierarchy: &Hierarchy) -> LinkSet {
        let mut placed = Vec::with_capacity(2 * self.links.len());
        for link in &self.links {
            for (receiver, source) in [(link.first, link.second), (link.second, link.first)] {
                let form_factor = (link.exchange / hierarchy.area(receiver)).clamp(0.0, 1.0);
                placed.push((receiver, Link { form_factor, source, transmittance: link.visibility, seen: link.visibility }));
            }
        }
        LinkSet::new(hierarchy.len(), &placed, Vec::new())
    }

    /// The pairs of surfaces that were never worth a link.
    pub fn dormant(&self, hierarchy: &Hierarchy) -> Vec<Pair> {
        let node = |surface: usize| hierarchy.node_of(SurfaceId(surface as u32));
        let both = |(a, b)| [Pair { receiver: a, source: b }, Pair { receiver: b, source: a }];
        self.unclassified.iter().flat_map(|(first, second)| both((node(first), node(second)))).collect()
    }

    /// The pairs of nodes of which no ray arrived: dropped, though 16 rays are no proof.
    pub fn unseen(&self) -> Vec<Pair> {
        self.unseen.iter().flat_map(|pair| [*pair, Pair { receiver: pair.source, source: pair.receiver }]).collect()
    }
}

impl MutualContext<'_> {
    /// The brightest channel of a node's radiosity in W/m^2; of a new node that of its nearest ancestor that is old enough.
    fn brightness(&self, hierarchy: &Hierarchy, node: NodeId) -> f64 {
        let channels = self.scene.channels();
        let known = self.radiosity.len() / channels;
        let mut node = node;
        while node.index() >= known {
            node = hierarchy.node(node).parent;
        }
        self.radiosity[node.index() * channels..][..channels].iter().copied().fold(0.0, f64::max)
    }

    /// The product BF: the larger of the irradiances that two nodes send each other, in W/m^2, as if nothing were in between.
    fn largest_irradiance(&self, hierarchy: &Hierarchy, first: NodeId, second: NodeId, exchange: f64) -> f64 {
        let to_first = self.brightness(hierarchy, second) / hierarchy.area(first);
        let to_second = self.brightness(hierarchy, first) / hierarchy.area(second);
        exchange * to_first.max(to_second)
    }
}

/// The limit that is reached with so many links for both directions.
fn limit_reached(limits: &RefineLimits<'_>, links: usize, hierarchy: &Hierarchy) -> RefineEnd {
    limits.reached(hierarchy, 2 * links as u64, links * size_of::<MutualLink>())
}
