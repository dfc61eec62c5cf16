//! What the loop needs of a solver.

use super::report::{SolveReport, StoppedBy};
use super::solution::Solution;
use super::step::NextStep;
use crate::error::ErrorEstimate;
use crate::links::RefineEnd;

/// A solver as the loop sees it: over links, or over cells.
pub(super) trait Way<'a> {
    /// Finds radiosities as finely as is planned by now; tells what ended that.
    fn advance(&mut self) -> RefineEnd;

    /// Finds the cell radiosities that values and the replicates of the error estimate end in, as finely as is planned by now.
    fn find_cells(&mut self);

    /// Estimates the error of the values that a user would get now; `None` if that was cut short.
    fn estimate_error(&mut self) -> Option<ErrorEstimate>;

    /// Decides what to do about an error, and plans it.
    fn plan_next(&mut self, error: &ErrorEstimate) -> NextStep;

    /// The same solve over cells from here on.
    fn into_cells(self: Box<Self>) -> Box<dyn Way<'a> + 'a>;

    /// Whether the memory allows cells as fine as is planned by now.
    fn has_room(&mut self) -> bool;

    /// The solution so far, with its report.
    fn finish(self: Box<Self>, stopped_by: StoppedBy) -> (Solution, SolveReport);
}
