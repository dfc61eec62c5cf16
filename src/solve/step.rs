//! What may be done about an error.

/// What to do next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum NextStep {
    /// Nothing: the claimed error is at most the requested one.
    GoodEnough,
    /// The error may well be small enough, but too little is known to claim it: more rays of each replicate.
    MoreReplicateRays,
    /// The same: more points.
    MorePoints,
    /// Values at points are too noisy: so many times the rays to each.
    MoreRays(f64),
    /// Cell radiosities are too noisy or too coarse: find them more finely. Values may take so many times the rays too.
    FindCells(f64),
    /// Cells as wide as their surfaces make values wrong: go on from where paths arrive on these.
    PassUnresolved,
    /// Refine links to so many times the tolerance.
    Refine(f64),
    /// Go on over cells: refining links would take more.
    TakeCells,
    /// Nothing: more effort would not help, or is not allowed.
    Exhausted,
}

impl NextStep {
    /// Whether values change.
    pub fn changes_values(self) -> bool {
        matches!(self, Self::MoreRays(_) | Self::FindCells(_) | Self::PassUnresolved | Self::Refine(_) | Self::TakeCells)
    }
}

/// What makes values better, or known better.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Choice {
    /// So many times the rays to each point.
    pub rays: f64,
    /// Cells found anew, with more rays.
    pub finds_cells: bool,
    /// Links refined.
    pub refines: bool,
    /// So many times the points.
    pub points: f64,
    /// So many times the rays of each replicate.
    pub replicate_rays: f64,
}

impl Choice {
    pub const NOTHING: Self = Self { rays: 1.0, finds_cells: false, refines: false, points: 1.0, replicate_rays: 1.0 };

    /// The part of it that makes values better.
    pub fn of_values(&self) -> Self {
        Self { points: 1.0, replicate_rays: 1.0, ..*self }
    }

    /// What of it comes first where cells were found anew already: these are judged closer before cells are found once more, if that is wanted too,
    /// because what was measured may be chance.
    pub fn once_judged(self) -> Self {
        let closer = Self { points: self.points, replicate_rays: self.replicate_rays, ..Self::NOTHING };
        if self.finds_cells && closer != Self::NOTHING { closer } else { self }
    }

    /// Whether values stay as they are.
    pub fn keeps_values(&self) -> bool {
        self.rays == 1.0 && !self.finds_cells && !self.refines
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_judged_closer_before_they_are_found_once_more() {
        let cells = Choice { finds_cells: true, ..Choice::NOTHING };
        let closer = Choice { points: 1.5, replicate_rays: 4.0, ..Choice::NOTHING };
        assert_eq!(Choice { finds_cells: true, rays: 2.0, ..closer }.once_judged(), closer);
        for choice in [cells, Choice { rays: 2.0, ..closer }, Choice { refines: true, ..closer }] {
            assert_eq!(choice.once_judged(), choice);
        }
    }
}
