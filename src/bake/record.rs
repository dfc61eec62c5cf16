//! What a bake leaves for a later one of a changed scene: where charts lie in space, and both parts of the light of their texels.
//!
//! A chart of the later scene takes light from the record if faces and texels lie in space as they did, to the bit. Whether that light still holds, the
//! record cannot tell: `change` measures it.

use std::collections::HashMap;

use serde::{Deserialize, Serialize};

use super::coverage::Site;
use super::lattice::Notes;
use super::options::{BakeError, BakeOptions, EarlierProblem};
use super::texels::Texels;
use crate::scene::Scene;

/// What a bake leaves for a later one of the same scene, changed here and there.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BakeRecord {
    terms: Terms,
    charts: Vec<ChartRecord>,
}

/// What bakes must have in common.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Terms {
    /// The side of a texel in metres.
    pub texel: f64,
    /// Of the light.
    pub channels: u32,
    /// Whether direct light is kept apart: twice as many numbers a texel.
    pub is_apart: bool,
    /// The error that is asked for, relative, and whether in the local norm.
    pub error: f64,
    pub is_local: bool,
}

/// A chart that reflects something.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct ChartRecord {
    /// What tells where faces and texels lie in space.
    outline: Vec<f64>,
    reflectance: Vec<f64>,
    /// Columns and rows.
    size: [u32; 2],
    /// By texel, from its middle: where its value was taken.
    sites: Vec<[f32; 2]>,
    /// By texel: whether a line of the scene's shape crosses it.
    is_marked: Vec<bool>,
    /// Reflected radiosity in W/m^2 of each part, with direct light where that is apart, by texel; NaN where there is none.
    parts: [Vec<f32>; 2],
}

/// Bit by bit: texels without light are equal.
impl PartialEq for ChartRecord {
    fn eq(&self, other: &Self) -> bool {
        let bits = |chart: &Self| chart.parts.each_ref().map(|part| part.iter().map(|x| x.to_bits()).collect::<Vec<u32>>());
        (&self.outline, &self.reflectance, self.size) == (&other.outline, &other.reflectance, other.size)
            && (&self.sites, &self.is_marked) == (&other.sites, &other.is_marked)
            && bits(self) == bits(other)
    }
}

/// The light of a chart in an earlier bake.
pub(crate) struct Base<'a> {
    of: &'a ChartRecord,
    /// By number of a texel: what its light is multiplied by, since the chart reflects more or less than it did.
    factors: Vec<f32>,
}

impl BakeRecord {
    /// Of texels whose parts are both known and not yet joined.
    pub(super) fn of(scene: &Scene, texels: &[Texels<'_>], notes: &[Notes], terms: Terms) -> Self {
        let reflecting = texels.iter().zip(notes).filter(|(texels, _)| texels.material.reflects());
        let record = |(texels, notes): (&Texels<'_>, &Notes)| ChartRecord {
            outline: outline(scene, texels),
            reflectance: texels.material.reflectance.clone(),
            size: texels.chart.size().map(|count| count as u32),
            sites: texels.sites.iter().map(Site::offset).collect(),
            is_marked: notes.is_marked.clone(),
            parts: [known(texels, &texels.before), known(texels, &texels.reflected)],
        };
        Self { terms, charts: reflecting.map(record).collect() }
    }

    /// Whether a bake with these options can take from it, for values with this relative error.
    ///
    /// # Errors
    /// [`BakeError::Earlier`] with what does not fit.
    pub fn fits(&self, options: &BakeOptions, error: f64) -> Result<(), BakeError> {
        self.check(Terms { texel: options.texel, is_apart: options.separate, error, ..self.terms })
    }

    /// The same for terms of a scene.
    pub(crate) fn check(&self, now: Terms) -> Result<(), BakeError> {
        let earlier = self.terms;
        let problem = if earlier.channels != now.channels {
            EarlierProblem::Channels { earlier: earlier.channels, now: now.channels }
        } else if earlier.texel != now.texel {
            EarlierProblem::Texel { earlier: earlier.texel, now: now.texel }
        } else if earlier.is_apart != now.is_apart {
            EarlierProblem::Parts
        } else if earlier.is_local != now.is_local {
            EarlierProblem::Norm
        } else if earlier.error > now.error {
            EarlierProblem::Error { earlier: earlier.error, now: now.error }
        } else {
            return Ok(());
        };
        Err(BakeError::Earlier(problem))
    }

    /// The earlier light of charts, where it can be taken.
    ///
    /// # Errors
    /// [`EarlierProblem::Nothing`] if that is of no chart at all.
    pub(crate) fn bases<'a>(&'a self, scene: &Scene, texels: &[Texels<'_>]) -> Result<Vec<Option<Base<'a>>>, BakeError> {
        let bits = |outline: &[f64]| -> Vec<u64> { outline.iter().map(|x| x.to_bits()).collect() };
        let mut by_outline: HashMap<Vec<u64>, &ChartRecord> = HashMap::new();
        self.charts.iter().for_each(|chart| {
            by_outline.entry(bits(&chart.outline)).or_insert(chart);
        });
        let base = |texels: &Texels<'_>| {
            let of = *by_outline.get(&bits(&outline(scene, texels)))?;
            let pairs = || of.reflectance.iter().zip(&texels.material.reflectance);
            if of.sites.len() != texels.sites.len() || pairs().any(|(&was, &is)| was == 0.0 && is > 0.0) {
                return None;
            }
            let factors: Vec<f32> = pairs().map(|(&was, &is)| if was > 0.0 { (is / was) as f32 } else { 0.0 }).collect();
            Some(Base { of, factors: factors.repeat(if texels.is_apart { 2 } else { 1 }) })
        };
        let bases: Vec<Option<Base<'a>>> =
            texels.iter().map(|texels| texels.material.reflects().then(|| base(texels)).flatten()).collect();
        let is_lost = texels.iter().any(|texels| texels.material.reflects()) && bases.iter().all(Option::is_none);
        if is_lost { Err(BakeError::Earlier(EarlierProblem::Nothing)) } else { Ok(bases) }
    }

    /// Whether everything in it is in range and fits together: for one that was read from a file.
    ///
    /// # Errors
    /// What does not.
    pub fn validate(&self) -> Result<(), String> {
        let Terms { texel, channels, is_apart, error, .. } = self.terms;
        if channels == 0 || ![texel, error].iter().all(|number| *number > 0.0 && number.is_finite()) {
            return Err("its texels, channels or error are out of range".to_owned());
        }
        let numbers = channels as usize * if is_apart { 2 } else { 1 };
        let is_light = |x: &f32| x.is_nan() || (0.0..=f32::MAX).contains(x);
        let is_good = |chart: &ChartRecord| {
            let texels = chart.size.iter().try_fold(1_usize, |all, &count| all.checked_mul(count as usize));
            texels == Some(chart.sites.len())
                && chart.is_marked.len() == chart.sites.len()
                && chart.parts.iter().all(|part| part.len() == chart.sites.len() * numbers && part.iter().all(is_light))
                && chart.reflectance.len() == channels as usize
                && chart.reflectance.iter().all(|rho| (0.0..=1.0).contains(rho))
        };
        match self.charts.iter().position(|chart| !is_good(chart)) {
            Some(number) => Err(format!("chart {number} has light, sites or reflectances that do not fit")),
            None => Ok(()),
        }
    }
}

impl Base<'_> {
    /// Whether it tells the light of a texel whose value is taken at `site`: it was taken there before, and lines of the scene's shape cross it as they did.
    pub fn is_of(&self, index: usize, site: &Site, is_marked: bool) -> bool {
        let was_lit = self.of.parts.iter().all(|part| !part[index * self.factors.len()].is_nan());
        was_lit && self.of.sites[index] == site.offset() && self.of.is_marked[index] == is_marked
    }

    /// A part of the light of a texel as this bake would have it if nothing but the chart's own reflectance had changed.
    pub fn numbers(&self, part: usize, index: usize) -> impl Iterator<Item = f64> {
        let numbers = &self.of.parts[part][index * self.factors.len()..][..self.factors.len()];
        numbers.iter().zip(&self.factors).map(|(&number, &factor)| f64::from(number * factor))
    }
}

/// Where faces and texels of a chart lie: the grid, then the corners of all its faces, each list after their number.
fn outline(scene: &Scene, texels: &Texels<'_>) -> Vec<f64> {
    let grid = &texels.chart.grid;
    let mut outline: Vec<f64> = [grid.origin, grid.steps[0], grid.steps[1]].iter().flat_map(|vector| vector.to_array()).collect();
    outline.extend(texels.chart.extent);
    for (_, corners) in texels.chart.polygons(scene) {
        outline.push(corners.len() as f64);
        outline.extend(corners.iter().flat_map(|corner| corner.to_array()));
    }
    outline
}

/// Numbers of texels that have a site; NaN for others.
fn known(texels: &Texels<'_>, numbers: &[f32]) -> Vec<f32> {
    let count = texels.numbers();
    let of_texel =
        |(site, numbers): (&Site, &[f32])| -> Vec<f32> { if site.is_covered() { numbers.to_vec() } else { vec![f32::NAN; count] } };
    texels.sites.iter().zip(numbers.chunks(count)).flat_map(of_texel).collect()
}
