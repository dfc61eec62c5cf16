//! The part of a source that a point sees: exactly, as convex pieces.
//!
//! From the source, cut to what is above the horizon, the outlines of all blockers are taken one after the other, the largest first. The work may
//! be limited; then the pieces are what the blockers so far leave, and the rest is undecided.

use glam::DVec3;

use super::blockers::Blockers;
use super::candidates::Candidates;
use super::outline::Outline;
use super::pieces::Pieces;
use super::view::View;

/// What a point sees of a source; memory that is reused.
#[derive(Default)]
pub(crate) struct VisiblePart {
    pieces: Pieces,
    outline: Outline,
    candidates: Candidates,
}

/// What is known of the visible part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Visible {
    /// The form factor of what is not known to be hidden: of the visible part, where that is decided.
    pub form_factor: f64,
    /// Whether all blockers were taken out.
    pub is_decided: bool,
}

impl VisiblePart {
    /// Finds the part of the source that the point sees, in no more than about so many [`steps`](Pieces::steps).
    pub(super) fn find(&mut self, view: &View<'_>, blockers: &Blockers, most_steps: u64) -> Visible {
        let Self { pieces, outline, candidates } = self;
        pieces.restart(view.source.vertices.iter().map(|&v| v - view.point));
        pieces.keep_inside(view.normal);
        let Some(cone) = pieces.iter().next() else { return Visible { form_factor: 0.0, is_decided: true } };
        candidates.find(view, cone, blockers, outline, most_steps);
        pieces.steps = candidates.steps;
        let are_all_found = candidates.steps <= most_steps;

        // Take out one blocker after the other.
        let (count, mut taken) = (candidates.len(), 0);
        for number in candidates.by_size() {
            if pieces.is_empty() || pieces.steps > most_steps {
                break;
            }
            if outline.trace(view, blockers, blockers.get(number)) {
                pieces.subtract(outline);
            }
            taken += 1;
        }
        let is_decided = pieces.is_empty() || are_all_found && taken == count;
        Visible { form_factor: pieces.form_factor(view.normal), is_decided }
    }

    /// The pieces that were found last, by unit directions to their corners.
    pub(super) fn pieces(&self) -> impl ExactSizeIterator<Item = &[DVec3]> + Clone {
        self.pieces.iter()
    }
}
