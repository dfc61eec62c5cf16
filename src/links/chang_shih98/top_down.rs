//! Linking two surfaces top-down (Hanrahan, Salzman, Aupperle 1991, as Chang, Shih 1998, section 2 and table 2 compare with it).
//!
//! A pair of nodes is judged by samples on itself. If they miss what is largest, the pair is linked though its error is not within
//! the tolerance.

use rayon::prelude::*;

use super::context::SampledContext;
use super::kernels::Kernel;
use super::sampled_link::{SampledLink, is_within};
use super::trees::{children, ids, one};
use crate::hierarchy::{Hierarchy, NodeId};

impl SampledContext<'_> {
    /// The links between two surfaces, in waves.
    pub(super) fn refine_top_down(&self, hierarchy: &Hierarchy, first: NodeId, second: NodeId) -> Vec<SampledLink> {
        let mut links = Vec::new();
        let mut wave = vec![(first, second)];
        while !wave.is_empty() {
            let sampled = |&(a, b): &(NodeId, NodeId)| self.sample(hierarchy, &one(a), &one(b)).at(a, b);
            let kernels: Vec<Kernel> = wave.par_iter().map(sampled).collect();
            let mut next = Vec::new();
            for ((first, second), kernel) in wave.into_iter().zip(kernels) {
                let are_leaves = hierarchy.is_leaf(first) && hierarchy.is_leaf(second);
                if are_leaves || is_within(hierarchy, first, second, kernel, self.form_factor_tolerance) {
                    links.push(SampledLink { first, second, kernel });
                    continue;
                }

                // The larger one is split, which is what the larger form factor goes to; if it cannot be, the other.
                let larger_second = hierarchy.area(second) > hierarchy.area(first);
                if hierarchy.is_leaf(first) || (larger_second && !hierarchy.is_leaf(second)) {
                    next.extend(ids(&children(hierarchy, second)).map(|child| (first, child)));
                } else {
                    next.extend(ids(&children(hierarchy, first)).map(|child| (child, second)));
                }
            }
            wave = next;
        }
        links
    }
}
