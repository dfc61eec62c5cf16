//! The links so far, and what became of every pair of surfaces.

use super::pairs::PairSet;
use crate::hierarchy::{Hierarchy, NodeId};
use crate::links::limits::{Holding, RefineEnd, RefineLimits};
use crate::links::link_set::{Link, LinkSet, Pair};
use crate::scene::{Scene, SurfaceId};

/// Which pairs of surfaces are linked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum TopLevel {
    /// All, before the first iteration.
    All,
    /// In each iteration those that carry more than `tolerance` W/m^2 by now: eps_link.
    Lazy {
        /// eps_link, in W/m^2.
        tolerance: f64,
    },
    /// All but those between surfaces that do not emit with form factors below this, in both directions.
    Culled {
        /// The smallest form factor that is worth a link.
        form_factor: f64,
    },
}

/// A link for both directions: the light that two nodes exchange.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct MutualLink {
    /// `A_first F_first,second = A_second F_second,first` in m^2, as if nothing were in between.
    pub exchange: f64,
    pub first: NodeId,
    pub second: NodeId,
    /// The part that gets through, above 0.
    pub visibility: f32,
    /// Whether every ray arrived.
    pub is_fully_visible: bool,
    /// Marked for good: refining would not tell more (section 4).
    pub is_reduced: bool,
}

/// All links so far, and what became of every pair of surfaces.
#[derive(Clone, Debug)]
pub(crate) struct MutualLinks {
    pub(super) strategy: TopLevel,
    pub(super) links: Vec<MutualLink>,
    /// Pairs of surfaces that are not classified yet.
    pub(super) unclassified: PairSet,
    pub(super) unclassified_count: usize,
    /// Pairs of nodes of which no ray arrived.
    pub(super) unseen: Vec<Pair>,
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
    ///
    /// # Errors
    /// The limit that leaves no room for all pairs of surfaces, each of which is held.
    pub fn new(strategy: TopLevel, scene: &Scene, hierarchy: &Hierarchy, limits: &RefineLimits<'_>) -> Result<Self, RefineEnd> {
        let surfaces = scene.surfaces().len();
        let unclassified_count = surfaces * (surfaces - 1) / 2;
        let holding = Holding { links: 0, unlinked: 2 * unclassified_count };
        if let Some(limit) = limits.exceeded(hierarchy, holding, 0).or_else(|| limits.says_end(hierarchy, 0, holding.unlinked)) {
            return Err(limit);
        }
        Ok(Self {
            strategy,
            links: Vec::new(),
            unclassified: PairSet::all(surfaces, limits.halt).ok_or(RefineEnd::Stopped)?,
            unclassified_count,
            unseen: Vec::new(),
            counts: MutualCounts::default(),
        })
    }

    /// How many links there are, each direction counted.
    pub fn len(&self) -> u64 {
        2 * self.links.len() as u64
    }

    /// How many pairs of surfaces are not classified yet.
    pub fn unclassified_count(&self) -> usize {
        self.unclassified_count
    }

    /// What a solution would hold with so many more links for both directions, and pairs without one.
    pub(super) fn holding(&self, links: usize, unlinked: usize) -> Holding {
        let unlinked = self.unclassified_count + self.unseen.len() + unlinked;
        Holding { links: 2 * (self.links.len() + links), unlinked: 2 * unlinked }
    }

    /// How many of so many pairs may be linked, and the limit that keeps out the rest.
    pub(super) fn links_to_go(
        &self,
        hierarchy: &Hierarchy,
        limits: &RefineLimits<'_>,
        wanted: usize,
    ) -> (usize, Option<RefineEnd>) {
        let exceeded = |links| limits.exceeded(hierarchy, self.holding(links, wanted - links), 0);
        let Some(limit) = exceeded(wanted) else { return (wanted, None) };
        let (mut fits, mut exceeds) = (0, wanted);
        while fits + 1 < exceeds {
            let tried = fits.midpoint(exceeds);
            if exceeded(tried).is_none() { fits = tried } else { exceeds = tried }
        }
        (fits, Some(limit))
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
