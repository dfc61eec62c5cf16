//! The elements of a small scene, and what each gathers from.

use std::collections::HashMap;

use rayon::prelude::*;

use super::WORK_OF_POLYGONS;
use crate::bounds::form_factors::{BoundedPair, FormFactorBounds, FormFactorRule, PairBounds};
use crate::bounds::input::BoundsInput;
use crate::bounds::system::Iterate;
use crate::hierarchy::{Hierarchy, NodeId};
use crate::scene::Scene;

use super::choice::Choice;

/// Pairs that one task bounds.
const PAIRS_A_TASK: usize = 32;

/// Elements, and by leaf its sources with the ranges of their form factors.
pub(super) struct Refinement<'a> {
    scene: &'a Scene,
    hierarchy: Hierarchy,
    rule: FormFactorRule,
    gathered: Vec<Vec<(NodeId, FormFactorBounds)>>,
    work: u64,
}

impl<'a> Refinement<'a> {
    /// All pairs of surfaces of which the first reflects; `scene` may have fewer channels than that of the input.
    pub fn new(scene: &'a Scene, input: &BoundsInput<'_>) -> Self {
        let hierarchy = Hierarchy::new(scene);
        let gathered = vec![Vec::new(); hierarchy.len()];
        let mut refinement = Self { scene, hierarchy, rule: input.rule, gathered, work: 0 };
        let surfaces: Vec<NodeId> =
            refinement.hierarchy.ids().filter(|&node| !refinement.hierarchy.is_cluster(node)).collect();
        let pairs = surfaces.iter().filter(|&&receiver| refinement.reflects(receiver)).flat_map(|&receiver| {
            surfaces.iter().filter(move |&&source| source != receiver).map(move |&source| (receiver, source))
        });
        let pairs: Vec<(NodeId, NodeId)> = pairs.collect();
        refinement.add(&pairs, &HashMap::new(), input.stop);
        refinement
    }

    /// Whether a surface or element reflects anything.
    pub fn reflects(&self, node: NodeId) -> bool {
        let surface = self.hierarchy.surface_of(node);
        surface.is_some_and(|surface| self.scene.material_of(surface).reflectance.iter().any(|&rho| rho > 0.0))
    }

    pub fn hierarchy(&self) -> &Hierarchy {
        &self.hierarchy
    }

    pub fn into_hierarchy(self) -> Hierarchy {
        self.hierarchy
    }

    /// The work that was done so far.
    pub fn work(&self) -> u64 {
        self.work
    }

    /// All pairs, ordered by receiver and source.
    pub fn pairs(&self) -> Vec<BoundedPair> {
        let of_receiver = |(receiver, list): (usize, &Vec<(NodeId, FormFactorBounds)>)| {
            list.iter().map(move |&(source, bounds)| (NodeId(receiver as u32), source, bounds)).collect::<Vec<_>>()
        };
        self.gathered.iter().enumerate().flat_map(of_receiver).collect()
    }

    /// Bounds of all nodes from those before the last split: what holds for an element holds for its parts.
    pub fn inherited(&self, before: Iterate, channels: usize) -> Iterate {
        let Iterate { mut lower, mut upper } = before;
        for node in lower.len() / channels..self.hierarchy.len() {
            let parent = self.hierarchy.node(NodeId(node as u32)).parent.index() * channels;
            for channel in 0..channels {
                lower.push(lower[parent + channel]);
                upper.push(upper[parent + channel]);
            }
        }
        Iterate { lower, upper }
    }

    /// Splits receivers, and replaces sources by their children.
    pub fn split(&mut self, choice: &Choice, stop: &(dyn Fn() -> bool + Sync)) {
        // What the lists lose, and the pairs that take its place, each with what is known of it already.
        let (mut pairs, mut known) = (Vec::new(), HashMap::new());
        let mut opened: HashMap<NodeId, Vec<NodeId>> = HashMap::new();
        choice.opened.iter().for_each(|&(receiver, source)| opened.entry(receiver).or_default().push(source));
        for (&receiver, sources) in &opened {
            self.gathered[receiver.index()].retain(|(source, _)| !sources.contains(source));
        }
        for &receiver in &choice.receivers {
            let list = std::mem::take(&mut self.gathered[receiver.index()]);
            let first = self.hierarchy.split(receiver);
            let children: Vec<NodeId> = self.hierarchy.children(receiver).collect();
            debug_assert_eq!(children.first(), Some(&first));
            for &child in &children {
                for &(source, bounds) in &list {
                    pairs.push((child, source));
                    known.insert((child, source), bounds);
                }
            }
        }
        self.gathered.resize(self.hierarchy.len(), Vec::new());

        // In a fixed order: a receiver with opened sources may have been split itself.
        for &(receiver, source) in &choice.opened {
            let receivers: Vec<NodeId> =
                if self.hierarchy.is_leaf(receiver) { vec![receiver] } else { self.hierarchy.children(receiver).collect() };
            for receiver in receivers {
                pairs.extend(self.hierarchy.children(source).map(|child| (receiver, child)));
            }
        }
        self.add(&pairs, &known, stop);
    }

    /// Bounds pairs, and adds them to the lists of their receivers. What is known of one holds for it as well.
    fn add(&mut self, pairs: &[(NodeId, NodeId)], known: &HashMap<(NodeId, NodeId), FormFactorBounds>, stop: &(dyn Fn() -> bool + Sync)) {
        let pair_bounds = PairBounds::new(self.scene, &self.hierarchy, self.rule).fairly();
        let bound = |&(receiver, source): &(NodeId, NodeId)| {
            let known = known.get(&(receiver, source)).copied();
            let bounds = match known {
                Some(known) if stop() => known,
                None if stop() => pair_bounds.bounds_unoccluded(receiver, source),
                Some(known) => pair_bounds.bounds(receiver, source).and(known),
                None => pair_bounds.bounds(receiver, source),
            };
            (receiver, source, bounds)
        };
        let found: Vec<BoundedPair> = pairs.par_iter().with_min_len(PAIRS_A_TASK).map(bound).collect();
        self.work += WORK_OF_POLYGONS * pairs.len() as u64;
        for (receiver, source, bounds) in found {
            self.gathered[receiver.index()].push((source, bounds));
        }
        let receivers = pairs.iter().map(|&(receiver, _)| receiver.index());
        for receiver in receivers {
            let list = &mut self.gathered[receiver];
            if !list.is_sorted_by_key(|(source, _)| *source) {
                list.sort_by_key(|(source, _)| *source);
            }
        }
    }
}
