//! What may be asked of a solve.

use std::str::FromStr;

use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::Interest;
use crate::links::Skips;
use crate::visibility::Backend;

/// How pairs of nodes are refined.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Strategy {
    /// Brightness-weighted refinement in which the receiver's area counts: what the measurements say is best.
    #[default]
    Default,
    /// BF refinement with multigridding as in Hanrahan, Salzman, Aupperle 1991.
    Hanrahan91,
    /// Every surface split to the same depth, every pair of elements linked.
    Uniform,
    /// All pairs of surfaces linked at first, BF refinement, a bounce of light an iteration: the original algorithm of Holzschuch,
    /// Sillion, Drettakis 1994. This and the next three take 16 rays a link.
    Original94,
    /// The same with link culling: pairs of reflecting surfaces with little form factor are forgotten (Lischinski 1994, section
    /// 4.1.1).
    Culling94,
    /// Lazy linking: pairs of surfaces are linked once they carry enough (Holzschuch, Sillion, Drettakis 1994, section 3).
    Lazy94,
    /// Lazy linking and link reduction (section 4).
    #[serde(rename = "lazy94+reduction")]
    Lazy94Reduction,
    /// Links by the error of their form factors alone, found bottom-up from samples on the smallest elements (Chang, Shih 1998).
    BottomUp98,
    /// The same top-down, from samples on each node that is looked at: what that paper compares with.
    TopDown98,
    /// Links are split that add most to the error, by their form-factor bounds and by importance (Lischinski 1994, section 5.3).
    ErrorDriven,
}

impl Strategy {
    /// All names, as typed on the command line.
    pub const NAMES: [&'static str; 10] = [
        "default",
        "hanrahan91",
        "uniform",
        "original94",
        "culling94",
        "lazy94",
        "lazy94+reduction",
        "bottom-up98",
        "top-down98",
        "error-driven",
    ];

    /// Whether links start from pairs of surfaces, and are what the options make them, whatever error they lead to.
    pub fn links_surfaces(self) -> bool {
        self.forgets_pairs() || self.links_once()
    }

    /// Whether all links are made at once, without regard to light.
    pub fn links_once(self) -> bool {
        matches!(self, Self::BottomUp98 | Self::TopDown98)
    }

    /// Whether pairs of which no ray arrived are dropped.
    pub fn forgets_pairs(self) -> bool {
        matches!(self, Self::Original94 | Self::Culling94 | Self::Lazy94 | Self::Lazy94Reduction)
    }
}

impl FromStr for Strategy {
    type Err = OptionsError;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        match name {
            "default" => Ok(Self::Default),
            "hanrahan91" => Ok(Self::Hanrahan91),
            "uniform" => Ok(Self::Uniform),
            "original94" => Ok(Self::Original94),
            "culling94" => Ok(Self::Culling94),
            "lazy94" => Ok(Self::Lazy94),
            "lazy94+reduction" => Ok(Self::Lazy94Reduction),
            "bottom-up98" => Ok(Self::BottomUp98),
            "top-down98" => Ok(Self::TopDown98),
            "error-driven" => Ok(Self::ErrorDriven),
            _ => Err(OptionsError::UnknownStrategy(name.to_owned())),
        }
    }
}

/// An option outside its legal range.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum OptionsError {
    /// The name is none of [`Strategy::NAMES`].
    #[error("unknown strategy '{0}'; choose one of {list}", list = Strategy::NAMES.join(", "))]
    UnknownStrategy(String),
    /// A number is out of range.
    #[error("{option} is {value}, it must be {range}")]
    OutOfRange {
        /// The option's key.
        option: &'static str,
        /// What was given.
        value: String,
        /// What is legal.
        range: &'static str,
    },
    /// `--set` names no option.
    #[error("unknown option '{0}'; choose one of {list}", list = SolveOptions::KEYS.join(", "))]
    UnknownKey(String),
}

/// How radiosities are iterated over the links.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Sweep {
    /// Every node gathers from the sweep before: parallel.
    #[default]
    Jacobi,
    /// Every node gathers from what was just reflected (Gauss-Seidel): fewer sweeps, one thread.
    InPlace,
}

impl FromStr for Sweep {
    type Err = OptionsError;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        match name {
            "jacobi" => Ok(Self::Jacobi),
            "in-place" => Ok(Self::InPlace),
            _ => Err(OptionsError::OutOfRange { option: "sweep", value: name.to_owned(), range: "jacobi or in-place" }),
        }
    }
}

/// How values at points are gathered.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Gather {
    /// The way that promises the requested error for less: the hemisphere where many surfaces reflect, or few reflect nearly all.
    #[default]
    Auto,
    /// Over the links above the point: for few sources.
    Links,
    /// By light paths over the hemisphere, to radiosities that are resolved finer than elements: for many sources.
    Hemisphere,
}

impl FromStr for Gather {
    type Err = OptionsError;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        match name {
            "auto" => Ok(Self::Auto),
            "links" => Ok(Self::Links),
            "hemisphere" => Ok(Self::Hemisphere),
            _ => Err(OptionsError::OutOfRange { option: "gather", value: name.to_owned(), range: "auto, links or hemisphere" }),
        }
    }
}

/// What is to be known about how wrong the answer can be.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Bounds {
    /// An estimate with its confidence.
    #[default]
    Estimate,
    /// Nothing beyond what the solve itself needs to know: the same estimate.
    None,
    /// Lower and upper radiosities as well that hold at every point. Surfaces are linked then, and values are gathered over links.
    Guaranteed,
}

impl Bounds {
    /// All names, as typed on the command line.
    pub const NAMES: [&'static str; 3] = ["none", "estimate", "guaranteed"];
}

impl FromStr for Bounds {
    type Err = OptionsError;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        match name {
            "none" => Ok(Self::None),
            "estimate" => Ok(Self::Estimate),
            "guaranteed" => Ok(Self::Guaranteed),
            _ => Err(OptionsError::OutOfRange { option: "bounds", value: name.to_owned(), range: "none, estimate or guaranteed" }),
        }
    }
}

/// What decides the answer: kept in the solution.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SolveOptions {
    /// Requested error in the norm `||B - B_true|| / ||B_true - E||` over all surfaces, channels pooled; in (0, 1). Default 0.02.
    pub error: f64,
    /// How pairs are refined.
    pub strategy: Strategy,
    /// What is to be known about how wrong the answer can be.
    pub bounds: Bounds,
    /// How much is done to tighten guaranteed bounds where clusters are linked: 1 for a pair that is taken apart, 4 for a pair of polygons
    /// of which all is proved that can be. The more, the narrower. If `None` it follows from `error` and the number of surfaces: in an
    /// office of some thousand surfaces bounds then take as long as the solve, or twice as long; in large halls longer.
    pub bounds_work: Option<u64>,
    /// What the answer is wanted for: where errors count. For [`Strategy::ErrorDriven`] alone.
    pub importance: Interest,
    /// Seed of every random choice.
    pub seed: u64,
    /// Stop refining at this many links.
    pub max_links: Option<u64>,
    /// Tolerance of the oracle in units of the root mean square of the reflected radiosity; above 0. Follows from `error` if
    /// `None`.
    pub tolerance: Option<f64>,
    /// Visibility rays to a point, 1 to 2^20. Follows from `error` if `None`.
    pub point_rays: Option<u32>,
    /// How values at points are gathered.
    pub gather: Gather,
    /// How many values at points will be taken, about; `None` and fewer than 2048 count as 2048. The more, the more work the solve puts
    /// into knowing its error and into fine cells: either spares rays to every point.
    pub expected_values: Option<u64>,
    /// Visibility rays for a link from a surface that reflects only, 1 to 1024.
    pub rays_per_link: u32,
    /// Visibility rays for a link from a lamp, 1 to 1024.
    pub rays_per_light_link: u32,
    /// Rays with which the radiosity of each leaf is taken anew at its centre after the sweeps, at most 2^20; 0 leaves the leaves
    /// alone. By default as many as the requested error needs.
    pub leaf_rays: Option<u32>,
    /// Relative accuracy of the links' form factors, 0 to 1; 0 takes them exactly.
    pub form_factor_accuracy: f64,
    /// The largest element of [`Strategy::Uniform`] in m^2; above 0.
    pub element_area: Option<f64>,
    /// Elements of this part of the area of all surfaces are not split, 0 to 1.
    pub min_element: f64,
    /// How radiosities are iterated.
    pub sweep: Sweep,
    /// Sweeps end when all changes that are still to come add up to less than this part of the largest reflected radiosity; above
    /// 0, below 1.
    pub sweep_tolerance: f64,
    /// Iterations of the strategies of 1994, 1 to 1000.
    pub iterations: u32,
    /// eps_link of lazy linking as a part of the refinement tolerance, 0 to 1.
    pub link_tolerance: f64,
    /// eps_reduce of link reduction: the part by which form factors must differ for refinement to be worth it, 0 to 1.
    pub reduce_tolerance: f64,
    /// The smallest form factor that link culling leaves, 0 to 1.
    pub cull_form_factor: f64,
    /// Whether lazy linking gives surfaces an ambient term for what they miss.
    pub ambient: bool,
    /// What is left out because it would be in vain.
    pub skips: Skips,
    /// F_eps of the strategies of 1998: links whose form factors may be wrong by this are refined; above 0, at most 1.
    pub form_factor_tolerance: f64,
    /// A_eps of the strategies of 1998 as a part of the area of the largest surface: no element is smaller; 1/1024 to 1.
    pub bottom_area: f64,
    /// Points on each node that the strategies of 1998 sample, on the smallest elements if bottom-up; 1 to 8.
    pub bottom_samples: u32,
}

impl Default for SolveOptions {
    fn default() -> Self {
        Self {
            error: 0.02,
            strategy: Strategy::Default,
            bounds: Bounds::Estimate,
            bounds_work: None,
            importance: Interest::Total,
            seed: 0,
            max_links: None,
            tolerance: None,
            point_rays: None,
            gather: Gather::Auto,
            expected_values: None,
            rays_per_link: 4,
            rays_per_light_link: 9,
            leaf_rays: None,
            form_factor_accuracy: 0.02,
            element_area: None,
            min_element: 1e-8,
            sweep: Sweep::Jacobi,
            sweep_tolerance: 1e-3,
            iterations: 10,
            link_tolerance: 0.2,
            reduce_tolerance: 0.2,
            cull_form_factor: 1e-3,
            ambient: true,
            skips: Skips::ALL,
            form_factor_tolerance: 0.02,
            bottom_area: 1.0 / 256.0,
            bottom_samples: 4,
        }
    }
}

impl SolveOptions {
    /// The keys that [`SolveOptions::set`] knows.
    pub const KEYS: [&'static str; 28] = [
        "error",
        "strategy",
        "bounds",
        "bounds_work",
        "importance",
        "seed",
        "max_links",
        "tolerance",
        "point_rays",
        "gather",
        "expected_values",
        "rays_per_link",
        "rays_per_light_link",
        "leaf_rays",
        "form_factor_accuracy",
        "element_area",
        "min_element",
        "sweep",
        "sweep_tolerance",
        "iterations",
        "link_tolerance",
        "reduce_tolerance",
        "cull_form_factor",
        "ambient",
        "skips",
        "form_factor_tolerance",
        "bottom_area",
        "bottom_samples",
    ];

    /// [`SolveOptions::bounds_work`] for a scene of so many surfaces.
    pub(crate) fn bounds_work_of(&self, surfaces: usize) -> u64 {
        let of_surfaces = 16.0 * surfaces as f64 * (0.1 / self.error).sqrt();
        self.bounds_work.unwrap_or((1 << 13) + of_surfaces as u64)
    }

    /// Rejects values outside their range; never clamps.
    ///
    /// # Errors
    /// [`OptionsError::OutOfRange`] names the option and its range.
    pub fn validate(&self) -> Result<(), OptionsError> {
        let check = |option: &'static str, value: f64, legal: bool, range: &'static str| {
            if legal { Ok(()) } else { Err(OptionsError::OutOfRange { option, value: value.to_string(), range }) }
        };
        let rays = |option, value: u32, most: u32, range| check(option, f64::from(value), (1..=most).contains(&value), range);
        let positive = |option, value: Option<f64>| {
            check(option, value.unwrap_or(1.0), value.is_none_or(|value| value.is_finite() && value > 0.0), "a number above 0")
        };
        check("error", self.error, self.error > 0.0 && self.error < 1.0, "above 0 and below 1")?;
        if self.bounds == Bounds::Guaranteed && self.strategy.forgets_pairs() {
            let range = "none or estimate for the strategies of 1994, which do not account for all pairs";
            return Err(OptionsError::OutOfRange { option: "bounds", value: "guaranteed".to_owned(), range });
        }
        if self.importance != Interest::Total && self.strategy != Strategy::ErrorDriven {
            let range = "total, unless strategy is error-driven";
            return Err(OptionsError::OutOfRange { option: "importance", value: self.importance.to_string(), range });
        }
        check("max_links", 0.0, self.max_links != Some(0), "at least 1")?;
        positive("tolerance", self.tolerance)?;
        positive("element_area", self.element_area)?;
        rays("point_rays", self.point_rays.unwrap_or(1), 1 << 20, "1 to 1048576")?;
        rays("rays_per_link", self.rays_per_link, 1024, "1 to 1024")?;
        rays("rays_per_light_link", self.rays_per_light_link, 1024, "1 to 1024")?;
        let leaf_rays = self.leaf_rays.unwrap_or(0);
        check("leaf_rays", f64::from(leaf_rays), leaf_rays <= 1 << 20, "0 to 1048576")?;
        check("form_factor_accuracy", self.form_factor_accuracy, (0.0..=1.0).contains(&self.form_factor_accuracy), "0 to 1")?;
        check("min_element", self.min_element, (0.0..=1.0).contains(&self.min_element), "0 to 1")?;
        check(
            "sweep_tolerance",
            self.sweep_tolerance,
            self.sweep_tolerance > 0.0 && self.sweep_tolerance < 1.0,
            "above 0 and below 1",
        )?;
        rays("iterations", self.iterations, 1000, "1 to 1000")?;
        check("link_tolerance", self.link_tolerance, (0.0..=1.0).contains(&self.link_tolerance), "0 to 1")?;
        check("reduce_tolerance", self.reduce_tolerance, (0.0..=1.0).contains(&self.reduce_tolerance), "0 to 1")?;
        check("cull_form_factor", self.cull_form_factor, (0.0..=1.0).contains(&self.cull_form_factor), "0 to 1")?;
        check(
            "form_factor_tolerance",
            self.form_factor_tolerance,
            self.form_factor_tolerance > 0.0 && self.form_factor_tolerance <= 1.0,
            "above 0, at most 1",
        )?;
        check("bottom_area", self.bottom_area, (1.0 / 1024.0..=1.0).contains(&self.bottom_area), "1/1024 to 1")?;
        rays("bottom_samples", self.bottom_samples, 8, "1 to 8")
    }

    /// Sets one option from text, as `--set key=value` does; see [`SolveOptions::KEYS`].
    ///
    /// # Errors
    /// [`OptionsError`] for an unknown key or a value that does not parse or is out of range.
    pub fn set(&mut self, key: &str, value: &str) -> Result<(), OptionsError> {
        fn parse<T: FromStr>(option: &'static str, value: &str, range: &'static str) -> Result<T, OptionsError> {
            value.trim().parse().map_err(|_| OptionsError::OutOfRange { option, value: value.to_owned(), range })
        }
        const NUMBER: &str = "a number";
        const COUNT: &str = "a whole number, not negative";
        let Some(key) = Self::KEYS.into_iter().find(|known| *known == key) else {
            return Err(OptionsError::UnknownKey(key.to_owned()));
        };
        match key {
            "error" => self.error = parse(key, value, NUMBER)?,
            "strategy" => self.strategy = value.trim().parse()?,
            "bounds" => self.bounds = value.trim().parse()?,
            "bounds_work" => self.bounds_work = Some(parse(key, value, COUNT)?),
            "importance" => self.importance = value.parse()?,
            "seed" => self.seed = parse(key, value, COUNT)?,
            "max_links" => self.max_links = Some(parse(key, value, COUNT)?),
            "tolerance" => self.tolerance = Some(parse(key, value, NUMBER)?),
            "point_rays" => self.point_rays = Some(parse(key, value, COUNT)?),
            "gather" => self.gather = value.trim().parse()?,
            "expected_values" => self.expected_values = Some(parse(key, value, COUNT)?),
            "rays_per_link" => self.rays_per_link = parse(key, value, COUNT)?,
            "rays_per_light_link" => self.rays_per_light_link = parse(key, value, COUNT)?,
            "leaf_rays" => self.leaf_rays = Some(parse(key, value, COUNT)?),
            "form_factor_accuracy" => self.form_factor_accuracy = parse(key, value, NUMBER)?,
            "element_area" => self.element_area = Some(parse(key, value, NUMBER)?),
            "min_element" => self.min_element = parse(key, value, NUMBER)?,
            "sweep" => self.sweep = value.trim().parse()?,
            "sweep_tolerance" => self.sweep_tolerance = parse(key, value, NUMBER)?,
            "iterations" => self.iterations = parse(key, value, COUNT)?,
            "link_tolerance" => self.link_tolerance = parse(key, value, NUMBER)?,
            "reduce_tolerance" => self.reduce_tolerance = parse(key, value, NUMBER)?,
            "cull_form_factor" => self.cull_form_factor = parse(key, value, NUMBER)?,
            "ambient" => self.ambient = parse(key, value, "true or false")?,
            "skips" => {
                self.skips =
                    parse(key, value, "all, none, or behind, black, dark, within, rays, clear, clusters, channels, joined by +")?;
            }
            "form_factor_tolerance" => self.form_factor_tolerance = parse(key, value, NUMBER)?,
            "bottom_area" => self.bottom_area = parse(key, value, NUMBER)?,
            _ => self.bottom_samples = parse(key, value, COUNT)?,
        }
        self.validate()
    }
}

/// How the run goes; none of it changes the answer, except that limits may end it early.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RunOptions {
    /// Worker threads; 0 takes one per core.
    pub threads: usize,
    /// Which code answers visibility queries.
    pub backend: Backend,
    /// Stop after this many seconds of wall time.
    pub time_s: Option<f64>,
    /// Stop when the solution would take more than this many bytes.
    pub memory_bytes: Option<u64>,
}

impl RunOptions {
    /// Rejects values outside their range; never clamps.
    ///
    /// # Errors
    /// [`OptionsError::OutOfRange`] for a time limit that is negative, not a number or longer than a million years.
    pub fn validate(&self) -> Result<(), OptionsError> {
        const MILLION_YEARS_S: f64 = 3.2e13;
        match self.time_s {
            Some(seconds) if !(0.0..MILLION_YEARS_S).contains(&seconds) => Err(OptionsError::OutOfRange {
                option: "time",
                value: seconds.to_string(),
                range: "seconds, not negative, below 3.2e13",
            }),
            _ => Ok(()),
        }
    }
}
