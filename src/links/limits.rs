//! Where refinement ends though the oracle wants more: at so many links, so much memory, or when it is told to.
//!
//! Limits are kept, not passed: a pair is split only if all that waits may become a link and still fits, and a pair that does not fit
//! as it stands sleeps.

use super::link_set::LinkSet;
use crate::hierarchy::{Hierarchy, NodeId};
use crate::progress::Stop;

/// Where refinement ends.
pub(crate) struct RefineLimits<'a> {
    /// The most links of all receivers.
    pub max_links: u64,
    /// The most that hierarchy, links, pairs without one and radiosities may take. What the scene takes before the first link is not
    /// asked for.
    pub max_bytes: u64,
    /// Radiosities of a node.
    pub channels: usize,
    /// Asked once a wave, with links and elements so far: whether to split nothing more.
    pub stop: &'a (dyn Fn(u64, u64) -> bool + Sync),
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
    /// The memory budget was reached: the remaining pairs were linked as they stand, or left dormant.
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
        let nodes = hierarchy.len();
        let radiosities = (nodes * self.channels * size_of::<f64>()) as u64;
        let links = LinkSet::bytes_of(nodes, holding.links, holding.unlinked);
        if hierarchy.memory_bytes() + radiosities + links + more_bytes > self.max_bytes {
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
        (pieces, bytes + LinkSet::bytes_of(pieces, 0, 0) + (pieces * self.channels * size_of::<f64>()) as u64)
    }

    /// Whether `stop` says so.
    pub(super) fn says_stop(&self, hierarchy: &Hierarchy, links: usize) -> bool {
        (self.stop)(links as u64, (hierarchy.len() - hierarchy.cluster_count()) as u64)
    }
}
