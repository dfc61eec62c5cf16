//! What a plan is predicted to take, in rays.

use super::effort::Law;
use super::options::Strategy;
use super::plan::{MORE_POSITION_RAYS, MORE_POSITIONS, Plan};
use super::step::Choice;
use super::worthwhile_cells::Traffic;
use crate::error::{REPLICATES, TWICE};
use crate::paths::{CellSize, Illumination};

/// The work of a link in rays: its own, its form factor, its part of sweeps, and of gathers at points. Measured: 8 to 20 microseconds,
/// where a ray takes 0.25.
const LINK_WORK: f64 = 50.0;

/// The work of each ray by which a leaf is gathered anew over its links. Measured: 5 microseconds.
const LEAF_RAY_WORK: f64 = 16.0;

/// The work of a link without what is gathered over it, in rays. Measured: 3 to 8 microseconds.
const MADE_LINK_WORK: f64 = 20.0;

/// The work of a ray of those that leaves cast when they are gathered anew. Measured: 0.35 to 0.6 microseconds.
const GATHERED_RAY_WORK: f64 = 2.0;

/// All pairs of surfaces are linked if that takes this part of what cells take, at most: clusters are estimates.
const ALL_PAIRS_PART: f64 = 0.25;

impl Plan {
    /// What tells for which surfaces cells pay.
    pub fn traffic(&self) -> Traffic {
        let Illumination { lit_area, .. } = self.law.illumination;
        let paths = self.value_rays(self.law.values) * f64::from(u8::from(self.over_cells)) + self.replicate_work();
        Traffic { lit_area, albedo: self.law.illumination.albedo(), paths, cell_work: self.work_of_cell() }
    }

    /// Whether clusters gather and emit: where to link all `pairs` of surfaces would take much of what cells take, and never in the strategies
    /// of the papers, which have none.
    pub fn links_clusters(&self, pairs: f64, of_cells: f64) -> bool {
        let are_many = LINK_WORK * pairs > ALL_PAIRS_PART * of_cells || !self.options.links.skips.clusters;
        self.options.strategy == Strategy::Default && are_many
    }

    /// The work of all replicates so far, in rays: each bounce takes one more, and one to an emitter.
    pub fn replicate_work(&self) -> f64 {
        let paths = REPLICATES as f64 * self.error_points as f64 * f64::from(self.replicate_rays);
        paths * f64::from(1 + 2 * self.replicate_bounces())
    }

    /// The work of all that is left if nothing goes wrong, in rays: cells, replicates, and values, here and of the user.
    pub fn work(&self) -> f64 {
        self.work_with(self.law.values)
    }

    /// The same where so many values are taken beside those that are judged.
    pub fn work_with(&self, values: f64) -> f64 {
        self.cell_work(1.0, 1) + self.value_rays(values) + self.replicate_work()
    }

    /// The rays of values that are judged, and of so many others.
    fn value_rays(&self, others: f64) -> f64 {
        let judged = 1.0 + f64::from(u8::from(self.over_cells)) / TWICE as f64;
        f64::from(self.point_rays) * (judged * self.error_points as f64 + others)
    }

    /// The work of cells with so many times the positions and paths from each.
    fn cell_work(&self, more_positions: f64, more_rays: u32) -> f64 {
        let CellSize { side, most_surfaces, .. } = self.resolution.size;
        let positions = more_positions * (self.law.illumination.lit_area / side.powi(2) + most_surfaces as f64);
        positions * f64::from(more_rays) * self.work_of_cell()
    }

    /// The work of a cell: a path takes a ray, and one to an emitter.
    fn work_of_cell(&self) -> f64 {
        let own = if self.over_cells { self.resolution.rays } else { 0 };
        f64::from(2 * (own + REPLICATES as u32 * self.replicate_resolution().rays))
    }

    /// The work of a solve over links, in rays, if links are made of so many times the tolerance, of which there are so many now, and leaves.
    pub fn work_over_links(&self, links: usize, leaves: usize, tolerance_factor: f64) -> f64 {
        let of_links = LINK_WORK * links as f64 * Law::links_factor(tolerance_factor.min(1.0));
        of_links + LEAF_RAY_WORK * f64::from(self.leaf_rays()) * leaves as f64 + self.work()
    }

    /// The work of links of so many times the tolerance, in rays, of which there are so many now, and whose leaves cast so many rays.
    pub fn work_of_refining(&self, links: usize, cast: u64, tolerance_factor: f64) -> f64 {
        Law::links_factor(tolerance_factor) * (MADE_LINK_WORK * links as f64 + GATHERED_RAY_WORK * cast as f64)
    }

    /// The work of the values of the user, in rays.
    pub fn work_of_values(&self) -> f64 {
        f64::from(self.point_rays) * self.law.values
    }

    /// The work of a choice beside that of refined links, in rays: values are taken anew, here and by the user; where cells are found anew, so are those
    /// of replicates, and the replicates themselves.
    pub fn work_of(&self, choice: &Choice) -> f64 {
        let twice = if self.over_cells { 1.0 / TWICE as f64 } else { 0.0 };
        let taken = (1.0 + twice) * self.error_points as f64;
        let known = if choice.keeps_values() { taken } else { 0.0 };
        let values = taken * choice.points * choice.rays - known + (choice.rays - 1.0) * self.law.values;
        let cells = if choice.finds_cells { self.cell_work(MORE_POSITIONS, MORE_POSITION_RAYS) } else { 0.0 };
        let known = if choice.finds_cells { 0.0 } else { 1.0 };
        f64::from(self.point_rays) * values + cells + (choice.points * choice.replicate_rays - known) * self.replicate_work()
    }
}
