//! Links, pairs of nodes, and the set of all links by receiver.

use serde::{Deserialize, Serialize};

use crate::geometry::{sampling, streams};
use crate::hierarchy::{Hierarchy, NodeId};

/// What a receiver gathers from one source.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Link {
    /// Form factor F_rs from the receiver to this source, as if nothing were in between.
    pub form_factor: f64,
    /// The node that is gathered from.
    pub source: NodeId,
    /// The part of the unoccluded form factor that gets through: an unbiased sample, which noise may take out of 0 to 1.
    pub transmittance: f32,
    /// The same by other rays, 0 to 1, for oracles alone. Were the value itself to decide what is split, values that came out too low
    /// by chance would be kept and others taken anew, and light would be lost.
    pub seen: f32,
}

/// Links are what a solution holds most of: what they may take decides how large a scene fits.
const _: () = assert!(size_of::<Link>() <= 24, "a link takes more than 24 bytes");

impl Link {
    /// Form factor F_rs, occlusion included.
    pub fn occluded_form_factor(&self) -> f64 {
        self.form_factor * f64::from(self.transmittance)
    }
}

/// A receiver and a source.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Pair {
    /// The node that gathers.
    pub receiver: NodeId,
    /// The node that is gathered from.
    pub source: NodeId,
}

impl Pair {
    /// The pair that covers all others.
    pub(crate) const ALL: Self = Self { receiver: NodeId::ROOT, source: NodeId::ROOT };

    /// The seed of the pair's samples, of the seed of a solve.
    pub(crate) fn seed(self, seed: u64) -> u64 {
        let of_receiver = sampling::hash(seed, streams::PAIRS + u64::from(self.receiver.0));
        sampling::hash(of_receiver, u64::from(self.source.0))
    }
}

/// All links, ordered by receiver, and the pairs that are covered without a link.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LinkSet {
    /// Where each receiver's links start; one more entry than there are nodes.
    starts: Vec<u32>,
    links: Vec<Link>,
    /// Pairs that carry nothing or too little so far to be worth a link: no visibility was computed.
    dormant: Vec<Pair>,
    /// Pairs that were dropped because no ray arrived.
    unseen: Vec<Pair>,
}

impl LinkSet {
    /// No links yet: one dormant pair, (root, root), which covers everything.
    pub(crate) fn unrefined(node_count: usize) -> Self {
        Self::new(node_count, &[], vec![Pair::ALL])
    }

    /// Sorts links by receiver; among the links of a receiver the order stays.
    pub(crate) fn new(node_count: usize, links: &[(NodeId, Link)], dormant: Vec<Pair>) -> Self {
        let mut starts = vec![0u32; node_count + 1];
        for (receiver, _) in links {
            starts[receiver.index() + 1] += 1;
        }
        for index in 0..node_count {
            starts[index + 1] += starts[index];
        }
        let mut next = starts.clone();
        let mut sorted = vec![Link { form_factor: 0.0, source: NodeId::ROOT, transmittance: 0.0, seen: 0.0 }; links.len()];
        for (receiver, link) in links {
            let place = &mut next[receiver.index()];
            sorted[*place as usize] = *link;
            *place += 1;
        }
        Self { starts, links: sorted, dormant, unseen: Vec::new() }
    }

    /// The links with their receivers, in order, and the dormant pairs.
    pub(crate) fn into_parts(self) -> (Vec<(NodeId, Link)>, Vec<Pair>) {
        let mut linked = Vec::with_capacity(self.links.len());
        linked.extend(self.iter().map(|(receiver, link)| (receiver, *link)));
        (linked, self.dormant)
    }

    /// The same links, with these pairs beside them.
    pub(crate) fn with_unlinked(self, dormant: Vec<Pair>, unseen: Vec<Pair>) -> Self {
        Self { dormant, unseen, ..self }
    }

    /// The links of a receiver.
    pub fn of(&self, receiver: NodeId) -> &[Link] {
        match self.starts.get(receiver.index()..receiver.index() + 2) {
            Some(&[start, end]) => &self.links[start as usize..end as usize],
            _ => &[],
        }
    }

    /// How many links there are.
    pub fn len(&self) -> usize {
        self.links.len()
    }

    /// Whether there are no links.
    pub fn is_empty(&self) -> bool {
        self.links.is_empty()
    }

    /// Pairs without a link because their source is dark, or because they are not worth one: no visibility was computed.
    pub fn dormant(&self) -> &[Pair] {
        &self.dormant
    }

    /// Pairs without a link because none of a few rays arrived, which is no proof that no light does.
    pub fn unseen(&self) -> &[Pair] {
        &self.unseen
    }

    /// Receivers with their links.
    pub fn iter(&self) -> impl Iterator<Item = (NodeId, &Link)> {
        (0..self.starts.len().saturating_sub(1) as u32)
            .map(NodeId)
            .flat_map(|node| self.of(node).iter().map(move |link| (node, link)))
    }

    /// Bytes that the links take.
    pub fn memory_bytes(&self) -> u64 {
        let nodes = self.starts.len().saturating_sub(1);
        Self::bytes_of(nodes, self.links.len(), self.dormant.len() + self.unseen.len())
    }

    /// Bytes that so many links and pairs without one take, of so many nodes.
    pub(crate) fn bytes_of(nodes: usize, links: usize, unlinked: usize) -> u64 {
        ((nodes + 1) * size_of::<u32>() + links * size_of::<Link>() + unlinked * size_of::<Pair>()) as u64
    }

    /// Checks what later stages rely on.
    ///
    /// # Errors
    /// Says what is wrong, for links that were read from a file.
    pub fn validate(&self, hierarchy: &Hierarchy) -> Result<(), String> {
        let count = hierarchy.len();
        let ordered = self.starts.windows(2).all(|pair| pair[0] <= pair[1]);
        if self.starts.len() != count + 1 || !ordered || self.starts[0] != 0 || self.starts[count] as usize != self.links.len() {
            return Err("the links are not ordered by receiver".to_owned());
        }
        let is_pair = |receiver: NodeId, source: NodeId| receiver.index() < count && source.index() < count;
        let wrong = |(receiver, link): (NodeId, &Link)| {
            !is_pair(receiver, link.source)
                || receiver == link.source
                || !(0.0..=1.0 + 1e-9).contains(&link.form_factor)
                || !link.transmittance.is_finite()
                || !(0.0..=1.0).contains(&link.seen)
        };
        let unlinked = self.dormant.iter().chain(&self.unseen);
        if self.iter().any(wrong) || unlinked.into_iter().any(|pair| !is_pair(pair.receiver, pair.source)) {
            return Err("a link is out of range".to_owned());
        }
        Ok(())
    }
}
