//! Light groups with other weights: sums of what is stored, and what may be claimed for them.
//!
//! Radiosities, cells and the lit mesh are linear in the weights. What a sum is off by follows from what its parts are off by. With B~ as it was
//! solved for all groups together and any number s,
//!
//! ```text
//! sum of w_g B~_g = s B~ + sum of (w_g - s) B~_g,
//! ||error|| <= |s| ||error of all|| + sum of |w_g - s| ||error of g||
//! ```
//!
//! by the triangle inequality, and s is chosen by which that is least: with all weights alike it is the error of the solve, and with one group alone
//! that of the group. It is no estimate of the error itself: errors of groups may cancel. The error is by energy; locally no such law holds.

use super::options::Norm;
use super::report::{ErrorFigure, LightGroupReport, LightGroupsReport};
use super::solution::Solution;
use crate::cells::CellRadiosities;
use crate::error::{self, GroupErrors};
use crate::mesh::{LitMesh, MeshError};
use crate::scene::{LightGroupError, LightWeight};
use crate::sweep::LightIrradiance;
use crate::values::ErrorBars;

impl Solution {
    /// The same with other weights for some light groups: a weighted sum of what is stored. Others keep theirs; a group may be named by a later call
    /// again, since weights are those of what was solved. Bounds are left out.
    ///
    /// What is known of its error is by energy, so [`SolveOptions::norm`](super::SolveOptions::norm) is that from here on.
    ///
    /// # Errors
    /// [`LightGroupError`]: there is no such group, or a weight is out of range.
    pub fn relit(&self, weights: &[LightWeight]) -> Result<Self, LightGroupError> {
        let (Some(known), Some(light)) = (self.scene.light_groups(), &self.groups) else { return Err(LightGroupError::NoGroups) };
        let by_group = known.weighted(weights)?;
        if (0..by_group.len()).all(|group| by_group[group] == known.weights_of(group)) {
            return Ok(self.clone());
        }
        let scene = self.scene.relit(by_group.clone())?;
        let sum = WeightedSum { weights: by_group.concat(), bands: scene.channels() };

        // In the dark noise may take the light below zero.
        let leaves: Vec<f64> = sum.of(&light.leaves, |b| b, |sum| sum.max(0.0));
        let radiosity = self.radiosity.with_leaves(&self.hierarchy, &self.exposure, &leaves);
        let lights = LightIrradiance::of_values(sum.of(&light.lights, |h| h, |sum| sum.max(0.0)));
        let of_floats = |values: &[f32]| sum.of(values, f64::from, |sum| sum as f32);
        let cell_radiosities = light.cells.as_ref().map(|cells| cells.mapped(scene.channels(), of_floats));
        let mesh = self.mesh.as_ref().zip(light.mesh.as_ref());
        let mesh = mesh.map(|(mesh, apart)| mesh.with_reflected(|surface, _| of_floats(&apart[surface])).without_errors());
        let cells_fit = |cells: &CellRadiosities| cells.is_valid(cells.cells(), scene.channels());
        if !radiosity.is_in_range()
            || !cell_radiosities.as_ref().is_none_or(cells_fit)
            || mesh.iter().flat_map(LitMesh::reflected).any(|reflected| !LitMesh::are_in_range(reflected))
        {
            return Err(LightGroupError::TooBright);
        }

        // What is known of errors.
        let error_bars = light.errors.as_ref().filter(|_| self.error_bars.is_some()).map(|errors| sum.error_bars(errors));
        let groups = self.groups.clone();
        let mut relit = Self { scene, radiosity, lights, cell_radiosities, mesh, groups, error_bars, bounds: None, ..self.clone() };
        relit.options.norm = Norm::Energy;
        let off_values = relit.mesh_off_values(&by_group);
        if let Some(mesh) = &mut relit.mesh {
            (mesh.measured, mesh.claimed) = (off_values.measured, off_values.estimate);
        }
        Ok(relit)
    }

    /// What is known of the light groups, with the weights that they have; `None` without groups.
    pub fn light_groups_report(&self) -> Option<LightGroupsReport> {
        let (known, light) = (self.scene.light_groups()?, self.groups.as_ref()?);
        let count = known.names().len();
        let figures = |weights: &[Vec<f64>]| {
            let Some(errors) = &light.errors else {
                return (0.0, ErrorFigure::default(), self.mesh.as_ref().map(|_| ErrorFigure::default()));
            };
            let all = errors.light(weights);
            let values = relative(bound_error(&errors.values, weights), all);
            let mesh = self.mesh.as_ref().map(|_| hypot(values, relative(bound_error(&light.mesh_errors, weights), all)));
            (all, values, mesh)
        };
        let group = |(number, name): (usize, &String)| {
            let weights = known.weights_of(number).to_vec();
            let alone: Vec<Vec<f64>> = (0..count).map(|group| vec![f64::from(u8::from(group == number)); weights.len()]).collect();
            let (light, error, lit_mesh) = figures(&alone);
            LightGroupReport { name: name.clone(), weights, light, error, lit_mesh }
        };
        let weights: Vec<Vec<f64>> = (0..count).map(|group| known.weights_of(group).to_vec()).collect();
        let (_, error, lit_mesh) = figures(&weights);
        Some(LightGroupsReport { error, lit_mesh, groups: known.names().iter().enumerate().map(group).collect() })
    }

    /// What claims for any weights follow from; `None` without groups, or where nothing is known.
    pub(crate) fn group_claims(&self) -> Option<GroupClaims> {
        let light = self.groups.as_ref()?;
        let errors = light.errors.as_ref()?;
        let values = errors.values.iter().map(|error| error.claimed).collect();
        let mesh = self.mesh.as_ref().map(|_| light.mesh_errors.iter().map(|error| error.claimed).collect());
        Some(GroupClaims { values, mesh, products: errors.light.clone() })
    }

    /// What the lit mesh is off values, by energy, with these weights by group and band.
    fn mesh_off_values(&self, weights: &[Vec<f64>]) -> ErrorFigure {
        let errors = self.groups.as_ref().and_then(|light| Some((&light.mesh_errors, light.errors.as_ref()?)));
        errors.map_or_else(ErrorFigure::default, |(of_mesh, errors)| relative(bound_error(of_mesh, weights), errors.light(weights)))
    }
}

/// Claimed errors by energy in W/m^2, first of all groups together, then of each alone, and how much light there is.
pub(crate) struct GroupClaims {
    pub values: Vec<f64>,
    /// What the lit mesh is off values, if there is one.
    pub mesh: Option<Vec<f64>>,
    /// The mean products of the light of two groups, by both and the band.
    pub products: Vec<f64>,
}

/// Sums of groups by band.
struct WeightedSum {
    /// By group and band.
    weights: Vec<f64>,
    bands: usize,
}

impl WeightedSum {
    /// Of values by item, group and band, what `finish` makes of each sum, by item and band.
    fn of<T: Copy>(&self, values: &[T], number: impl Fn(T) -> f64, finish: impl Fn(f64) -> T) -> Vec<T> {
        let (bands, mut sums) = (self.bands, Vec::with_capacity(values.len() / self.weights.len() * self.bands));
        for item in values.chunks(self.weights.len()) {
            let of_band = |band: usize| (band..item.len()).step_by(bands).map(|at| self.weights[at] * number(item[at])).sum();
            sums.extend((0..bands).map(of_band).map(&finish));
        }
        sums
    }

    /// What error bars hang on: with all weights alike on what all light does; else on the group of which least is known.
    fn error_bars(&self, errors: &GroupErrors) -> ErrorBars {
        if self.weights.iter().all(|weight| *weight == self.weights[0]) {
            return errors.error_bars[0];
        }
        let lit =
            self.weights.chunks(self.bands).zip(&errors.error_bars[1..]).filter(|(weights, _)| weights.iter().any(|&w| w > 0.0));
        let worst = |worst: ErrorBars, (_, of): (_, &ErrorBars)| ErrorBars {
            noise: worst.noise.max(of.noise),
            bias: worst.bias.max(of.bias),
            of_light: worst.of_light.max(of.of_light),
        };
        lit.fold(ErrorBars { noise: 0.0, bias: 0.0, of_light: 0.0 }, worst)
    }
}

/// Errors of all light and of each group, measured and claimed.
trait Errors {
    fn both(&self) -> [f64; 2];
}

impl Errors for error::ErrorFigure {
    fn both(&self) -> [f64; 2] {
        [self.measured, self.claimed]
    }
}

impl Errors for MeshError {
    fn both(&self) -> [f64; 2] {
        [self.measured, self.claimed]
    }
}

/// Bounds of the error of a sum with weights by group and band, in W/m^2: measured and claimed; infinite where nothing is known.
fn bound_error(errors: &[impl Errors], weights: &[Vec<f64>]) -> [f64; 2] {
    let Some((all, groups)) = errors.split_first() else { return [f64::INFINITY; 2] };
    [0, 1].map(|which| {
        // What has no part in the sum may be unknown.
        let term = |factor: f64, error: f64| if factor == 0.0 { 0.0 } else { factor * error };
        let bound_with = |s: f64| {
            let off = |weights: &Vec<f64>| weights.iter().map(|weight| (weight - s).abs()).fold(0.0, f64::max);
            let apart = weights.iter().zip(groups).map(|(weights, error)| term(off(weights), error.both()[which]));
            term(s, all.both()[which]) + apart.sum::<f64>()
        };
        weights.iter().flatten().map(|&s| bound_with(s)).fold(bound_with(0.0), f64::min)
    })
}

/// An error relative to so much light; where there is none, nothing is wrong.
fn relative([measured, claimed]: [f64; 2], light: f64) -> ErrorFigure {
    let known = |error: f64| if error.is_nan() { f64::INFINITY } else { error };
    let of = |error: f64| if error == 0.0 { 0.0 } else { known(error / light) };
    ErrorFigure { measured: of(measured), estimate: of(claimed) }
}

fn hypot(one: ErrorFigure, other: ErrorFigure) -> ErrorFigure {
    ErrorFigure { estimate: one.estimate.hypot(other.estimate), measured: one.measured.hypot(other.measured) }
}
