//! Cell radiosities with the paths that use them.

use std::sync::Arc;

use super::radiosity::CellRadiosities;
use crate::paths::{LightPaths, Resolution};

/// `N` independent solutions for the cell radiosities of one resolution.
pub(crate) struct SolvedCells<'a, const N: usize> {
    pub resolution: Resolution,
    pub paths: Arc<LightPaths<'a>>,
    pub radiosities: [CellRadiosities; N],
}

impl<'a, const N: usize> SolvedCells<'a, N> {
    /// Solves once for each seed; the cells of `paths` must be those of `resolution`.
    pub fn solve(paths: Arc<LightPaths<'a>>, resolution: Resolution, seeds: [u64; N]) -> Self {
        let radiosities = seeds.map(|seed| CellRadiosities::solve(&paths, &resolution, seed));
        Self { resolution, paths, radiosities }
    }
}
