//! What the plan says of links: tolerances, and the oracle that refines by them.

use super::{MAX_POINT_RAYS, Plan, TOLERANCE_OF_PAPERS_POWER};
use crate::links::oracle::{AreaWeighted, BrightnessWeighted, RefinementOracle, Uniform};
use crate::solve::effort::{Law, REFERENCE_AREA};
use crate::solve::options::Strategy;
use crate::solve::scale::Scale;

/// The first steps of the first round take tolerances so many times as large: each finds the brightness by which the next refines.
const FIRST_STEPS: [f64; 3] = [16.0, 4.0, 1.0];

impl Plan {
    /// The tolerances of this round's steps, falling.
    pub fn tolerances(&self) -> Vec<f64> {
        if self.refinements == 0 && self.options.strategy != Strategy::Uniform {
            FIRST_STEPS.iter().map(|factor| factor * self.tolerance).collect()
        } else {
            vec![self.tolerance]
        }
    }

    /// So many times the tolerance leaves the error times `factor`.
    pub fn tolerance_factor(&self, factor: f64) -> f64 {
        match self.options.strategy {
            Strategy::Default => Law::tolerance_factor(factor),
            _ => factor.powf(TOLERANCE_OF_PAPERS_POWER),
        }
    }

    /// So many times the tolerance leaves so much of the square of the error.
    pub fn left_by_links(&self, tolerance_factor: f64) -> f64 {
        match self.options.strategy {
            Strategy::Default => Law::left_by_links(tolerance_factor),
            _ => tolerance_factor.powf(2.0 / TOLERANCE_OF_PAPERS_POWER),
        }
    }

    /// The tolerance of links, in units of the scale.
    pub fn tolerance(&self) -> f64 {
        self.tolerance
    }

    /// The oracle of the chosen strategy at `tolerance`.
    pub fn oracle(&self, tolerance: f64) -> Box<dyn RefinementOracle> {
        let Scale { radiosity, area } = self.scale;
        let (tolerance, min_area) = (tolerance * radiosity, self.min_area());
        match self.options.strategy {
            Strategy::Default => Box::new(AreaWeighted { tolerance, reference_area: REFERENCE_AREA * area, min_area }),
            Strategy::Uniform => Box::new(Uniform { element_area: self.options.uniform.element_area.unwrap_or(area) }),
            _ => Box::new(BrightnessWeighted { tolerance, min_area }),
        }
    }

    /// The irradiance that a link may carry unrefined in the strategies of 1994, in W/m^2: eps_refine.
    pub fn irradiance_tolerance(&self) -> f64 {
        self.tolerance * self.scale.radiosity
    }

    /// Nodes of this area or less are not split, in m^2.
    pub fn min_area(&self) -> f64 {
        self.options.links.min_element * self.scale.area
    }

    /// Visibility rays with which the radiosity of a leaf is taken anew; 0 leaves it alone.
    pub fn leaf_rays(&self) -> u32 {
        if self.over_cells {
            return 0;
        }
        self.options.links.leaf_rays.unwrap_or_else(|| self.law.leaf_rays().min(MAX_POINT_RAYS))
    }
}
