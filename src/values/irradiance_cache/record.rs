//! Records of indirect irradiance, and the fit through those around a point.
//!
//! A record is the indirect irradiance at a point, kept for its neighbours (Ward, Rubinstein, Clear 1988). Instead of gradients, a
//! plane is fitted through the records around a point by weighted least squares. How far the records lie from the plane, beyond
//! their own noise, is an estimate of its error.

use glam::{DMat3, DVec2, DVec3};
use serde::{Deserialize, Serialize};

use super::plane_cells::{CellKey, PlaneCells};
use crate::geometry::{sampling, streams};
use crate::hierarchy::Hierarchy;
use crate::paths::{BatchSums, PathScratch, Place};
use crate::values::final_gather::FinalGather;

/// The indirect irradiance at a point, kept for its neighbours.
#[derive(Serialize, Deserialize)]
pub(super) struct Record {
    at: DVec2,
    /// By channel, in W/m^2: the mean of two independent gathers, and its variance by their difference.
    mean: Vec<f64>,
    variance: Vec<f64>,
    /// By channel, the sum over cells of the squares of what each brings, in W^2/m^4.
    by_cells_sq: Vec<f64>,
    /// The part of cosine-distributed rays that meet something within [`REACH`] cells.
    near: f64,
}

/// What a fit says of a place in one channel.
#[derive(Clone, Copy, Debug)]
pub(in crate::values) struct Fitted {
    /// The indirect irradiance in W/m^2, and its variance in W^2/m^4.
    pub irradiance: f32,
    pub variance: f32,
    /// The sum over cells of the squares of what each brings, in W^2/m^4.
    pub by_cells_sq: f32,
}

impl Fitted {
    pub const NONE: Self = Self { irradiance: f32::NAN, variance: f32::NAN, by_cells_sq: f32::NAN };
}

/// Where a record is taken.
pub(super) struct Site {
    at: DVec2,
    place: Place,
}

/// A record within reach of a place, with its weight in the fit, and the fit's basis there: the offset in units of the reach, and
/// 1.
struct Weighted<'r> {
    weight: f64,
    basis: DVec3,
    record: &'r Record,
}

/// Takes records, and fits planes through them.
pub(super) struct Recorder<'a> {
    pub gather: &'a FinalGather<'a>,
    pub hierarchy: &'a Hierarchy,
    pub cells: &'a PlaneCells<'a>,
    /// Paths from a record.
    pub paths: u32,
    pub seed: u64,
    /// The size of a cell, in metres.
    pub size: f64,
    /// A point lies on a surface within so many metres.
    pub tolerance: f64,
}

/// Points tried in a cell until one lies on a surface.
const TRIES: u64 = 2;

/// A fit takes records within so many cells; what a ray meets within that distance is near.
const REACH: f64 = 2.0;

/// Rays that tell at a record, and at a point, how much is near.
const RECORD_NEAR_RAYS: u32 = 64;
const POINT_NEAR_RAYS: u32 = 16;

/// What is near at a point may differ from the fit by so many standard deviations of the point's rays, and by the slack besides.
/// Empirical.
const NEAR_SIGMAS: f64 = 2.0;
const NEAR_SLACK: f64 = 0.02;

/// The least number of records for a fit, and of degrees of freedom beyond the fit's three.
const LEAST_RECORDS: usize = 6;
const LEAST_FREEDOM: f64 = 1.0;

/// The records must not lie close to a line: the least determinant of their moments, by unit weight and in units of the reach.
const LEAST_DETERMINANT: f64 = 1e-4;

impl Recorder<'_> {
    /// A random point of a cell; `None` if no surface was found there. Depends on the cell alone.
    pub fn site(&self, cell: CellKey) -> Option<Site> {
        let parts = [self.size.to_bits(), cell.side.plane.into(), cell.side.is_front.into(), cell.column as u64, cell.row as u64];
        let seed = parts.iter().fold(self.seed, |seed, &part| sampling::hash(seed, part));
        (0..TRIES).find_map(|attempt| {
            let draw = sampling::hash(seed, attempt);
            let within = DVec2::new(sampling::unit(draw), sampling::unit(sampling::hash(draw, streams::SECOND)));
            let at = (DVec2::new(cell.column as f64, cell.row as f64) + within) * self.size;
            let (point, normal) = self.cells.to_space(cell.side, at);
            let surface = self.hierarchy.surface_at(point, normal, self.tolerance)?;
            (self.cells.side_of(surface) == cell.side).then_some(Site { at, place: Place { point, surface, seed } })
        })
    }

    /// The record that is taken at `site`.
    pub fn record(&self, site: &Site, scratch: &mut PathScratch) -> Record {
        let place = |number: u64| Place { seed: sampling::hash(site.place.seed, streams::RECORD + number), ..site.place };
        // Two independent gathers.
        let channels = self.gather.paths.scene.channels();
        let mut by_cells_sq = vec![0.0; channels];
        let halves = [0, 1].map(|half| {
            let mut irradiance = vec![0.0; channels];
            let mut sums = BatchSums::new(channels, 1, &mut irradiance, &mut by_cells_sq);
            self.gather.add_sampled_indirect(&[place(half)], self.paths.div_ceil(2), scratch, &mut sums);
            irradiance
        });
        by_cells_sq.iter_mut().for_each(|sum| *sum *= 0.5);
        Record {
            at: site.at,
            mean: halves[0].iter().zip(&halves[1]).map(|(a, b)| 0.5 * (a + b)).collect(),
            variance: halves[0].iter().zip(&halves[1]).map(|(a, b)| 0.25 * (a - b) * (a - b)).collect(),
            by_cells_sq,
            near: self.gather.paths.sampled_near(&place(2), RECORD_NEAR_RAYS, REACH * self.size),
        }
    }

    /// Fits the indirect irradiance at a place through the records around it, by channel. `false` if the estimated squared
    /// error of the reflected radiosity, summed over the channels, is above `allowed_sq`, in W^2/m^4.
    pub fn fit<'r>(&self, place: &Place, around: &[&'r Record], allowed_sq: f64, irradiance: &mut [Fitted]) -> bool {
        // The records within reach.
        let at = self.cells.to_plane(self.cells.side_of(place.surface), place.point);
        let weigh = |&record: &&'r Record| {
            let offset = (record.at - at) / (REACH * self.size);
            let weight = (1.0 - offset.length_squared()).max(0.0).powi(2);
            (weight > 0.0).then(|| Weighted { weight, basis: offset.extend(1.0), record })
        };
        let within: Vec<Weighted<'r>> = around.iter().filter_map(weigh).collect();

        // Their moments. The last row of the inverse gives the fit's value at the place, by a share of each record.
        let (mut moments, mut sum, mut sum_sq) = (DMat3::ZERO, 0.0, 0.0);
        for &Weighted { weight, basis, .. } in &within {
            moments += DMat3::from_cols(basis * basis.x, basis * basis.y, basis * basis.z) * weight;
            sum += weight;
            sum_sq += weight * weight;
        }
        let effective = sum * sum / sum_sq;
        let freedom = effective - 3.0;
        if within.len() < LEAST_RECORDS || freedom < LEAST_FREEDOM || moments.determinant() < LEAST_DETERMINANT * sum.powi(3) {
            return false;
        }
        let inverse = moments.inverse();
        let share = |of: &Weighted<'r>| of.weight * inverse.z_axis.dot(of.basis);
        let amplified: f64 = within.iter().map(|of| share(of).powi(2)).sum();

        // The fit, and its squared error: what the records lie off it beyond their noise, and the part of their noise that remains.
        let material = self.gather.paths.scene.material_of(place.surface);
        let (mut misfit_sq, mut noise_sq) = (0.0, 0.0);
        for (channel, value) in irradiance.iter_mut().enumerate() {
            let products: DVec3 = within.iter().map(|of| of.basis * (of.weight * of.record.mean[channel])).sum();
            let fitted = inverse * products;
            let (mut apart_sq, mut variance) = (0.0, 0.0);
            for &Weighted { weight, basis, record } in &within {
                apart_sq += weight / sum * (record.mean[channel] - fitted.dot(basis)).powi(2);
                variance += weight / sum * record.variance[channel];
            }
            apart_sq *= effective / freedom;
            let rho_sq = material.reflectance[channel].powi(2);
            let noise = amplified * variance.max(apart_sq);
            misfit_sq += rho_sq * (apart_sq - variance);
            noise_sq += rho_sq * noise;
            let by_cells_sq: f64 = within.iter().map(|of| of.weight / sum * of.record.by_cells_sq[channel]).sum();
            *value = Fitted {
                irradiance: fitted.z.max(0.0) as f32,
                variance: ((apart_sq - variance).max(0.0) + noise) as f32,
                by_cells_sq: by_cells_sq as f32,
            };
        }
        if misfit_sq.max(0.0) + noise_sq > allowed_sq {
            return false;
        }

        // Is there something small close by that no record has seen?
        let near = within.iter().map(|of| share(of) * of.record.near).sum::<f64>().clamp(0.0, 1.0);
        let found = self.gather.paths.sampled_near(place, POINT_NEAR_RAYS, REACH * self.size);
        (found - near).abs() <= NEAR_SIGMAS * (near * (1.0 - near) / f64::from(POINT_NEAR_RAYS)).sqrt() + NEAR_SLACK
    }
}
