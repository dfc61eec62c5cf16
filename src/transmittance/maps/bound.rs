//! What surely passes along segments, and what may: bounds that rest on what is proved of cells and surfaces.

use super::estimate::{Blocker, Maps, Traveller};
use crate::hierarchy::{Hierarchy, NodeId};
use crate::visibility::Segment;

impl Maps<'_> {
    /// What passes along a segment, at least and at most: 1 and 1 if it is free by proof, 0 and 0 if it is blocked, 0 and 1 if more than `most_opened`
    /// clusters had to be opened to know. Proved up to rounding, in f64.
    pub fn bound_passing(&self, hierarchy: &Hierarchy, segment: &Segment, most_opened: usize) -> [f64; 2] {
        let traveller = Traveller::along(segment);
        let (mut waiting, mut opened) = (vec![NodeId::ROOT], 0);
        while let Some(node) = waiting.pop() {
            if !hierarchy.is_cluster(node) {
                if Blocker::of(self.scene, hierarchy, node).is_some_and(|blocker| blocker.blocks(&traveller)) {
                    return [0.0, 0.0];
                }
                continue;
            }
            let Some([enters, leaves]) = traveller.part_in_box(hierarchy.bounds(node)) else { continue };

            // By the finest cell of its map, if the line passes it from side to side.
            let whole = self.map_of(node).filter(|_| enters > 0.0 && leaves < 1.0);
            match whole.map(|map| self.part(hierarchy, node, map, &traveller.line, 0).proved) {
                Some([_, 0.0]) => continue,
                Some([1.0, _]) => return [0.0, 0.0],
                _ => {}
            }
            opened += 1;
            if opened > most_opened {
                return [0.0, 1.0];
            }
            waiting.extend(hierarchy.children(node));
        }
        [1.0, 1.0]
    }

    /// Bounds of what passes between two nodes, that hold with probability `confidence`, below 1: the mean of [`Maps::bound_passing`] over independent
    /// segments, widened by what the mean of so many may be off (Hoeffding 1963). At least one segment.
    pub fn sampled_bounds(&self, hierarchy: &Hierarchy, segments: &[Segment], most_opened: usize, confidence: f64) -> [f64; 2] {
        let count = segments.len() as f64;
        let sums = segments.iter().fold([0.0, 0.0], |[low, high], segment| {
            let [least, most] = self.bound_passing(hierarchy, segment, most_opened);
            [low + least, high + most]
        });
        let half_width = ((2.0 / (1.0 - confidence)).ln() / (2.0 * count)).sqrt();
        [(sums[0] / count - half_width).max(0.0), (sums[1] / count + half_width).min(1.0)]
    }
}
