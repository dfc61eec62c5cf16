//! Where refinement ends though the oracle wants more: at so many links, so much memory, or when it is told to.
//!
//! Limits are kept, not passed: a pair is split only if all that waits may become a link and still fits, and a pair that does not fit
//! as it stands sleeps.

use crate::hierarchy::{Hierarchy, NodeId};
use crate::progress::Stop;

/// Where refinement ends.
pub(crate) struct RefineLimits<'a> {
    /// The most links of all receivers.
    pub max_links: u64,
    /// The most that hierarchy, links and pairs without one may take while refinement works. What the scene takes before the first link is
    /// not asked for.
    pub max_bytes: u64,
    /// Bytes that others need for each node.
    pub node_bytes: u64,
    /// Bytes of a link, or of a pair without one.
    pub link_bytes: u64,
    /// Asked once a wave, with links and elements so far: whether to split nothing more.
    pub stop: &'a (dyn Fn(u64, u64) -> bool + Sync),
    /// Asked once a wave, with the bytes of hierarchy, links and pairs so far: whether there may be more.
    pub allows: &'a (dyn Fn(u64) -> bool + Sync),
    /// Asked within waves: whether to leave what is undecided as it is, without a link.
    pub halt: Stop<'a>,
}

/// How a round of refinement ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum RefineEnd {
    /// The oracle is content.
    Content,
    /// The largest number of links was reached: the remaining pairs were linked as they stand, or left dormant.
    MaxLinks,
    /// The memory budget was reached, or `allows` said no: the remaining pairs were linked as they stand, or left dormant.
    Memory,
    /// `stop` said so: the remaining pairs were linked as they stand, or left dormant once `halt` did.
    Stopped,
}

/// What a solution would hold beside its nodes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Holding {
    /// Links of all receivers, pairs that may still become some included.
    pub links: usize,
    /// Pairs without a link.
    pub unlinked: usize,
}

impl RefineLimits<'_> {
    /// The limit that such a solution exceeds, with `more_bytes` of new nodes.
    pub(super) fn exceeded(&self, hierarchy: &Hierarchy, holding: Holding, more_bytes: u64) -> Option<RefineEnd> {
        if self.bytes(hierarchy, holding.links + holding.unlinked) + more_bytes > self.max_bytes {
            Some(RefineEnd::Memory)
        } else if holding.links as u64 > self.max_links {
            Some(RefineEnd::MaxLinks)
        } else {
            None
        }
    }

    /// What a split adds: children, and bytes if they are still to be made.
    pub(super) fn cost_of_split(&self, hierarchy: &Hierarchy, node: NodeId) -> (usize, u64) {
        if !hierarchy.is_leaf(node) {
            return (hierarchy.children(node).len(), 0);
        }
        let (pieces, bytes) = hierarchy.cost_of_split(node);
        (pieces, bytes + pieces as u64 * self.node_bytes)
    }

    /// What nodes and so many pairs take, with or without links.
    fn bytes(&self, hierarchy: &Hierarchy, pairs: usize) -> u64 {
        hierarchy.memory_bytes() + hierarchy.len() as u64 * self.node_bytes + pairs as u64 * self.link_bytes
    }

    /// Whether `stop` or `allows` says that nothing more is to be split, with so many links and other pairs.
    pub(super) fn says_end(&self, hierarchy: &Hierarchy, links: usize, others: usize) -> Option<RefineEnd> {
        if (self.stop)(links as u64, (hierarchy.len() - hierarchy.cluster_count()) as u64) {
            Some(RefineEnd::Stopped)
        } else if !(self.allows)(self.bytes(hierarchy, links + others)) {
            Some(RefineEnd::Memory)
        } else {
            None
        }
    }
}
