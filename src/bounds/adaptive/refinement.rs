//! The elements of a small scene, and what each gathers from.

use std::collections::HashMap;

use rayon::prelude::*;

use crate::bounds::form_factors::{BoundedPair, FormFactorBounds, FormFactorRule, PairBounds};
use crate::bounds::groups::{Plans, Step};
use crate::bounds::input::BoundsInput;
use crate::bounds::system::Iterate;
use crate::hierarchy::{Hierarchy, NodeId};
use crate::progress::Stop;
use crate::scene::Scene;

/// The work of bounding two polygons, in units of [`SolveOptions::bounds_work`](crate::solve::SolveOptions::bounds_work).
pub(super) const WORK_OF_POLYGONS: u64 = 4;

/// Pairs that one task bounds.
const PAIRS_A_TASK: usize = 32;

/// What is split.
#[derive(Default)]
pub(super) struct Choice {
    /// Elements that are split.
    pub receivers: Vec<NodeId>,
    /// Receivers with the source that is replaced by its children.
    pub opened: Vec<(NodeId, NodeId)>,
}

impl Choice {
    pub fn is_empty(&self) -> bool {
        self.receivers.is_empty() && self.opened.is_empty()
    }
}

/// A source of a leaf.
#[derive(Clone, Copy)]
struct Gathered {
    source: NodeId,
    bounds: FormFactorBounds,
    /// Whether its children take its place: then its form factor is that of all of them.
    is_opened: bool,
}

/// Elements, and by leaf its sources with the ranges of their form factors.
pub(super) struct Refinement<'a> {
    scene: &'a Scene,
    hierarchy: Hierarchy,
    rule: FormFactorRule,
    /// Ordered by source.
    gathered: Vec<Vec<Gathered>>,
    work: u64,
}

impl<'a> Refinement<'a> {
    /// All pairs of surfaces of which the first reflects; `scene` may have fewer channels than that of the input.
    pub fn new(scene: &'a Scene, input: &BoundsInput<'_>) -> Self {
        let hierarchy = Hierarchy::new(scene);
        let gathered = vec![Vec::new(); hierarchy.len()];
        let mut refinement = Self { scene, hierarchy, rule: input.rule, gathered, work: 0 };
        let surfaces: Vec<NodeId> = refinement.hierarchy.ids().filter(|&node| !refinement.hierarchy.is_cluster(node)).collect();
        let pairs = surfaces.iter().filter(|&&receiver| refinement.reflects(receiver)).flat_map(|&receiver| {
            let gathered = |&source| Gathered { source, bounds: FormFactorBounds::ANYTHING, is_opened: false };
            surfaces.iter().filter(move |&&source| source != receiver).map(move |source| (receiver, gathered(source)))
        });
        let pairs: Vec<(NodeId, Gathered)> = pairs.collect();
        refinement.add(&pairs, input.stop);
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

    /// How many form factors of a leaf are kept: those to its sources, and to what these are parts of.
    pub fn sources_of(&self, leaf: NodeId) -> usize {
        self.gathered[leaf.index()].len()
    }

    /// All pairs, ordered by receiver and source.
    pub fn pairs(&self) -> Vec<BoundedPair> {
        let of_receiver = |(receiver, list): (usize, &'_ Vec<Gathered>)| -> Vec<BoundedPair> {
            let sources = list.iter().filter(|gathered| !gathered.is_opened);
            sources.map(|&Gathered { source, bounds, .. }| (NodeId(receiver as u32), source, bounds)).collect()
        };
        self.gathered.iter().enumerate().flat_map(of_receiver).collect()
    }

    /// How the pairs of each receiver are put together.
    pub fn plans(&self) -> Plans {
        let mut plans = Plans { starts: Vec::with_capacity(self.gathered.len() + 1), steps: Vec::new() };
        let mut entry = 0;
        for list in &self.gathered {
            plans.starts.push(plans.steps.len() as u32);
            let numbers: Vec<u32> = list
                .iter()
                .map(|gathered| {
                    entry += u32::from(!gathered.is_opened);
                    entry.wrapping_sub(1)
                })
                .collect();
            let surfaces = list.iter().map(|gathered| gathered.source);
            for source in surfaces.filter(|&source| self.hierarchy.is_cluster(self.hierarchy.node(source).parent)) {
                self.add_steps(list, &numbers, source, &mut plans.steps);
            }
        }
        plans.starts.push(plans.steps.len() as u32);
        plans
    }

    /// Appends the steps of a source and of all below it; `numbers` are those of the entries of a list.
    fn add_steps(&self, list: &[Gathered], numbers: &[u32], source: NodeId, steps: &mut Vec<Step>) {
        let Ok(at) = list.binary_search_by_key(&source, |gathered| gathered.source) else { return };
        let FormFactorBounds { lower, upper, .. } = list[at].bounds;
        if !list[at].is_opened {
            steps.push(Step::Source(numbers[at]));
            return;
        }
        let children = self.hierarchy.children(source);
        let members = children.len() as u32;
        children.for_each(|child| self.add_steps(list, numbers, child, steps));
        steps.push(Step::Group { members, lower, upper });
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
    pub fn split(&mut self, choice: &Choice, stop: Stop<'_>) {
        // Children of receivers take their lists, each source with what is known of it already.
        let mut pairs = Vec::new();
        for &receiver in &choice.receivers {
            let list = std::mem::take(&mut self.gathered[receiver.index()]);
            self.hierarchy.split(receiver);
            for child in self.hierarchy.children(receiver) {
                pairs.extend(list.iter().map(|&gathered| (child, gathered)));
            }
        }
        self.gathered.resize(self.hierarchy.len(), Vec::new());
        let mut taken: HashMap<(NodeId, NodeId), usize> =
            pairs.iter().enumerate().map(|(at, (child, gathered))| ((*child, gathered.source), at)).collect();

        // Children of sources are added to the lists; of one whose receiver was split, to those of its children.
        for &(receiver, source) in &choice.opened {
            let receivers: Vec<NodeId> =
                if self.hierarchy.is_leaf(receiver) { vec![receiver] } else { self.hierarchy.children(receiver).collect() };
            for receiver in receivers {
                let opened = match taken.remove(&(receiver, source)) {
                    Some(at) => &mut pairs[at].1,
                    None => {
                        let list = &mut self.gathered[receiver.index()];
                        let Ok(at) = list.binary_search_by_key(&source, |gathered| gathered.source) else { continue };
                        &mut list[at]
                    }
                };
                opened.is_opened = true;
                let bounds = opened.bounds;
                let child = |source| (receiver, Gathered { source, bounds: bounds.of_part(), is_opened: false });
                pairs.extend(self.hierarchy.children(source).map(child));
            }
        }
        self.add(&pairs, stop);
    }

    /// Bounds pairs, and adds them to the lists of their receivers. What is known of one already holds as well.
    fn add(&mut self, pairs: &[(NodeId, Gathered)], stop: Stop<'_>) {
        let pair_bounds = PairBounds::new(self.scene, &self.hierarchy, self.rule).fairly();
        let bound = |&(receiver, gathered): &(NodeId, Gathered)| {
            let late = stop();
            let found = if late {
                pair_bounds.bounds_unoccluded(receiver, gathered.source)
            } else {
                pair_bounds.bounds(receiver, gathered.source)
            };
            (receiver, Gathered { bounds: found.and(gathered.bounds), ..gathered })
        };
        let found: Vec<(NodeId, Gathered)> = pairs.par_iter().with_min_len(PAIRS_A_TASK).map(bound).collect();
        self.work += WORK_OF_POLYGONS * pairs.len() as u64;
        let mut changed: Vec<NodeId> = found.iter().map(|(receiver, _)| *receiver).collect();
        for (receiver, gathered) in found {
            self.gathered[receiver.index()].push(gathered);
        }
        changed.dedup();
        for receiver in changed {
            let list = &mut self.gathered[receiver.index()];
            if !list.is_sorted_by_key(|gathered| gathered.source) {
                list.sort_by_key(|gathered| gathered.source);
            }
        }
    }
}
