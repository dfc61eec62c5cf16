//! Linking two surfaces bottom-up: the procedures BottomUpRefine and CreateLink of Chang, Shih 1998, sections 3.3.1 and 3.3.3.
//!
//! Both trees are climbed together, level by level, the lower one until its top is reached. At each level pairs of nodes are judged
//! by what was found one level below. A pair that is within the tolerance waits: its parents may be, too. Below a pair that is not,
//! whatever waits is linked. As maxima and areas only grow on the way up, nothing above that pair is within the tolerance either,
//! so that every pair of elements ends up under one link.

use super::kernels::{Kernel, Table};
use super::sampled_link::{SampledLink, is_within};
use super::trees::{Nodes, Tree, children, ids, one};
use crate::hierarchy::{Hierarchy, NodeId};

/// The links between two surfaces, from the kernels between their smallest elements.
pub(super) fn refine(hierarchy: &Hierarchy, first: &Tree, second: &Tree, bottom: Table, tolerance: f64) -> Vec<SampledLink> {
    let is_within = |a, b, kernel| is_within(hierarchy, a, b, kernel, tolerance);
    let (mut level_of_first, mut level_of_second) = (0, 0);
    let mut table = bottom;

    // The smallest elements are linked whatever their error.
    let mut links: Vec<SampledLink> = table
        .iter()
        .filter(|&(a, b, kernel)| !is_within(a, b, kernel))
        .map(|(a, b, kernel)| SampledLink { first: a, second: b, kernel })
        .collect();
    let mut waiting = links.len() < table.iter().count();

    // One level up after the other, while anything waits.
    while waiting && (level_of_first < first.top() || level_of_second < second.top()) {
        let step = Step { first: level_of_first < first.top(), second: level_of_second < second.top() };
        level_of_first += usize::from(step.first);
        level_of_second += usize::from(step.second);
        let above = Table::new(first.level(level_of_first), second.level(level_of_second), |a, b| {
            let [below_a, below_b] = step.below(hierarchy, a, b);
            table.over(&below_a, &below_b)
        });
        waiting = false;
        for (a, b, kernel) in above.iter() {
            if is_within(a, b, kernel) {
                waiting = true;
            } else {
                create_links(hierarchy, step, &table, (a, b), &is_within, &mut links);
            }
        }
        table = above;
    }

    // What still waits at the top is linked there.
    let at_top = table.iter().filter(|&(a, b, kernel)| waiting && is_within(a, b, kernel));
    links.extend(at_top.map(|(a, b, kernel)| SampledLink { first: a, second: b, kernel }));
    links
}

/// Which of two trees the last step has climbed.
#[derive(Clone, Copy)]
struct Step {
    first: bool,
    second: bool,
}

impl Step {
    /// The nodes at which the table one step below knows what a pair is made of.
    fn below(self, hierarchy: &Hierarchy, a: NodeId, b: NodeId) -> [Nodes; 2] {
        [(self.first, a), (self.second, b)].map(|(climbed, node)| if climbed { children(hierarchy, node) } else { one(node) })
    }
}

/// Links what waits below a pair that is not within the tolerance itself.
fn create_links(
    hierarchy: &Hierarchy,
    step: Step,
    below: &Table,
    (a, b): (NodeId, NodeId),
    is_within: &impl Fn(NodeId, NodeId, Kernel) -> bool,
    links: &mut Vec<SampledLink>,
) {
    let [below_a, below_b] = step.below(hierarchy, a, b);
    let mut link_if_within = |first: NodeId, second: NodeId, kernel: Kernel| {
        let within = is_within(first, second, kernel);
        if within {
            links.push(SampledLink { first, second, kernel });
        }
        within
    };
    let larger_second = hierarchy.area(b) > hierarchy.area(a);
    match step {
        // Both have climbed: the one with the larger area, which makes the larger error, is split first, and then the other.
        Step { first: true, second: true } if larger_second => {
            for child in ids(&below_b) {
                if !link_if_within(a, child, below.over(&below_a, &one(child))) {
                    for other in ids(&below_a) {
                        link_if_within(other, child, below.at(other, child));
                    }
                }
            }
        }
        Step { first: true, second: true } => {
            for child in ids(&below_a) {
                if !link_if_within(child, b, below.over(&one(child), &below_b)) {
                    for other in ids(&below_b) {
                        link_if_within(child, other, below.at(child, other));
                    }
                }
            }
        }
        // One alone has climbed.
        _ => {
            for first in ids(&below_a) {
                for second in ids(&below_b) {
                    link_if_within(first, second, below.at(first, second));
                }
            }
        }
    }
}
