//! Cell radiosities with the paths that use them.

use std::sync::Arc;

use super::radiosity::CellRadiosities;
use crate::paths::{LightPaths, Resolution};
use crate::progress::Stop;

/// `N` independent solutions for the cell radiosities of one resolution.
pub(crate) struct SolvedCells<'a, const N: usize> {
    pub resolution: Resolution,
    pub paths: Arc<LightPaths<'a>>,
    pub radiosities: [CellRadiosities; N],
}

impl<'a, const N: usize> SolvedCells<'a, N> {
    /// Solves once for each seed; the cells of `paths` must be those of `resolution`. `None` if stopped before.
    pub fn solve(paths: Arc<LightPaths<'a>>, resolution: Resolution, seeds: [u64; N], stop: Stop<'_>) -> Option<Self> {
        let mut radiosities = Vec::with_capacity(N);
        for seed in seeds {
            radiosities.push(CellRadiosities::solve(&paths, &resolution, seed, stop)?);
        }
        Some(Self { resolution, paths, radiosities: radiosities.try_into().ok()? })
    }
}
