//! Which channels are solved for, and how a solution gets back those of the scene that was given.
//!
//! Channels that repeat others, or in which no light is on, are read off the others. Light groups are carried along as channels behind those of all light,
//! and taken apart at the end.

use std::borrow::Cow;

use super::options::{SolveOptions, Strategy};
use super::report::{SkippedWork, SolveReport};
use super::solution::Solution;
use crate::scene::{DistinctChannels, Scene};

/// A scene, and which of its channels are solved for.
pub(super) struct SolvedChannels {
    scene: Scene,
    /// `None` if all are.
    distinct: Option<DistinctChannels>,
}

impl SolvedChannels {
    pub fn of(scene: Scene, options: &SolveOptions) -> Self {
        let scene = scene.with_weights_of_one();
        let merges = options.links.skips.channels && options.strategy == Strategy::Default;
        let distinct = DistinctChannels::of(&scene).filter(|_| merges);
        Self { scene, distinct }
    }

    /// How many channels the solution will have.
    pub fn kept(&self) -> usize {
        self.scene.channels_with_groups()
    }

    /// The scene in the channels that are solved for.
    pub fn scene(&self) -> Cow<'_, Scene> {
        self.distinct.as_ref().map_or(&self.scene, |channels| &channels.scene).carrying_light_groups()
    }

    /// What was found for these channels, for all of the given scene's.
    pub fn expand(self, (mut solution, mut report): (Solution, SolveReport)) -> (Solution, SolveReport) {
        if let Some(channels) = &self.distinct {
            solution = solution.expanded(channels);
            report.energy = report.energy.times(channels.copies as f64);
            report.skipped.push(SkippedWork {
                what: "channels that repeat others, or in which no light is on".to_owned(),
                count: channels.spared() as u64,
                ..SkippedWork::default()
            });
        }
        let solution = solution.with_groups_apart(self.scene);
        report.memory_bytes = solution.memory_bytes();
        report.light_groups = solution.light_groups_report();
        (solution, report)
    }
}
