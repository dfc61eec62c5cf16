//! The table of all options. To add one, write it here: nothing else has to be told of it.
//!
//! ```text
//! /// What it does: documentation of the field, and help of the program.
//! key: Type = default, range, "unit";
//! ```
//!
//! Ranges are those of [`kinds`](super::kinds); where there is no unit, it is left out. The first group is the struct of all options, the
//! others are fields of it, as in `options.links.tolerance`. [`declare`](super::declare) makes the rest of it.

use serde::{Deserialize, Serialize};

use super::choices::{Bounds, Norm, Solver, Strategy, Subdivision, Sweep};
use super::declare::options;
use super::error::OptionsError;
use super::interest::Interest;
use super::kinds::{Flag, Kind, OneName, OptionType, SkipNames, Text, above, any, at_least, between, check, read, type_of};
use crate::links::Skips;

/// More work on bounds takes minutes and gigabytes, and brings little.
const MOST_BOUNDS_WORK: u64 = 1 << 24;

options! {
    /// What decides the answer, kept in the solution.
    SolveOptions {
        /// Error asked for, relative to the reflected light, as `norm` says, over all surfaces, channels pooled.
        error: f64 = 0.02, above(0.0).below(1.0);

        /// Relative to what errors are: local, to the light at each place, or to typical light where it is darker; or energy, to all light.
        norm: Norm = Norm::Local, OneName;

        /// How pairs of nodes are refined.
        strategy: Strategy = Strategy::Default, OneName;

        /// Which solver finds the values: over links, over cells, or the one that promises the requested error for less.
        solver: Solver = Solver::Auto, OneName;

        /// What is said about the error: estimate, or guaranteed, which proves lower and upper radiosities.
        bounds: Bounds = Bounds::Estimate, OneName;

        /// How much is done to tighten guaranteed bounds: 1 for a pair that is taken apart, 4 for a pair of polygons of which all is
        /// proved that can be. The more, the narrower. If not given, 131072 in scenes of few surfaces; else it follows from error and
        /// the number of surfaces. Few are 90.
        bounds_work: Option<u64> = None, between(0, MOST_BOUNDS_WORK);

        /// What the answer is wanted for: where errors count, with strategy error-driven. 'view' is what the camera of the picture sees.
        importance: Interest = Interest::Total, Text(Interest::RANGE);

        /// Whether the answer is wanted as a function on the surfaces as well, the lit mesh. Then error is asked for of both together, values and
        /// what the function is off them.
        lit_mesh: bool = false, Flag;

        /// Whether what paths bring is kept with the solution, so that it can be solved again for other reflectances and emission, without a ray.
        /// The solver is then that over cells.
        keep_transport: bool = false, Flag;

        /// Seed of every random choice.
        seed: u64 = 0, any();

        /// Stop refining at this many links; values over cells hang on few. If not given, there is no limit.
        max_links: Option<u64> = None, at_least(1), "links";

        /// Visibility rays to a point. If not given, they follow from error.
        point_rays: Option<u32> = None, between(1, 1 << 20), "rays";

        /// How many values at points will be taken, about; fewer than 2048 count as 2048, and so does none given. The more, the more work
        /// the solve puts into knowing its error and into fine cells: either spares rays to every point.
        expected_values: Option<u64> = None, any(), "values";
    }

    /// The solver over links.
    LinkOptions as links {
        /// Tolerance of the oracle. If not given, it follows from error.
        tolerance: Option<f64> = None, above(0.0), "root mean square of the reflected radiosity";

        /// Visibility rays for a link from a surface that reflects only.
        rays_per_link: u32 = 4, between(1, 1024), "rays";

        /// Visibility rays for a link from an emitter.
        rays_per_light_link: u32 = 9, between(1, 1024), "rays";

        /// Rays with which the radiosity of each leaf is taken anew at its centre after the sweeps; 0 leaves the leaves alone. If not
        /// given, they follow from error.
        leaf_rays: Option<u32> = None, between(0, 1 << 20), "rays";

        /// Relative accuracy of the links' form factors; 0 takes them exactly.
        form_factor_accuracy: f64 = 0.02, between(0.0, 1.0);

        /// Elements of this area are not split.
        min_element: f64 = 1e-8, between(0.0, 1.0), "area of all surfaces";

        /// How elements are split: regular, or along discontinuities of direct light as far as they matter at the error asked for.
        subdivision: Subdivision = Subdivision::Regular, OneName;

        /// Discontinuities that together change what a surface reflects by less than this are left out of subdivision. If not given, the error asked for.
        discontinuity_tolerance: Option<f64> = None, between(0.0, 1.0), "what lit surfaces reflect, about";

        /// How radiosities are iterated over the links: all nodes at once, or each from what was just reflected.
        sweep: Sweep = Sweep::Jacobi, OneName;

        /// Sweeps end when all changes that are still to come add up to less than this.
        sweep_tolerance: f64 = 1e-3, above(0.0).below(1.0), "largest reflected radiosity";

        /// What is left out because it would be in vain.
        skips: Skips = Skips::ALL, SkipNames;
    }

    /// The solver over cells.
    CellOptions as cells {
        /// Positions at which the radiosities of cells are found. Overrides what follows from error.
        positions: Option<u64> = None, between(256, 1 << 24), "positions";

        /// Paths and rays from each of these positions. Overrides what follows from error.
        position_rays: Option<u32> = None, between(1, 1024), "rays";
    }

    /// Strategy uniform.
    UniformOptions as uniform {
        /// The largest element. If not given, surfaces are not split.
        element_area: Option<f64> = None, above(0.0), "m^2";
    }

    /// The strategies original94, culling94, lazy94 and lazy94+reduction (Holzschuch, Sillion, Drettakis 1994).
    Holzschuch94Options as holzschuch94 {
        /// Iterations, each of which links, refines, and lets light travel once.
        iterations: u32 = 10, between(1, 1000);

        /// eps_link of lazy linking: pairs that carry less are not linked.
        link_tolerance: f64 = 0.2, between(0.0, 1.0), "tolerance of refinement";

        /// eps_reduce of link reduction: the part by which form factors must differ for refinement to be worth it.
        reduce_tolerance: f64 = 0.2, between(0.0, 1.0);

        /// The smallest form factor that link culling leaves.
        cull_form_factor: f64 = 1e-3, between(0.0, 1.0);

        /// Whether lazy linking gives surfaces an ambient term for what they miss.
        ambient: bool = true, Flag;
    }

    /// The strategies bottom-up98 and top-down98 (Chang, Shih 1998).
    ChangShih98Options as chang_shih98 {
        /// F_eps: links whose form factors may be wrong by this are refined.
        form_factor_tolerance: f64 = 0.02, above(0.0).at_most(1.0);

        /// A_eps: no element is smaller.
        bottom_area: f64 = 1.0 / 256.0, between(1.0 / 1024.0, 1.0), "area of the largest surface";

        /// Points that are sampled on each node; bottom-up on the smallest elements alone.
        bottom_samples: u32 = 4, between(1, 8);
    }

    /// Strategy multiresolution96 (Soler, Sillion 1996).
    Multiresolution96Options as multiresolution96 {
        /// The standard error that a link's transmittance may have by maps; where they cannot have it so small, rays are cast. 0 asks rays alone.
        transmittance_tolerance: f64 = 0.1, between(0.0, 1.0), "unoccluded form factor";

        /// Memory that maps may take once they are complete; the largest clusters come first.
        map_memory: u64 = 256 << 20, between(0, 1 << 40), "bytes";
    }
}

/// Options that belong together.
#[derive(Debug)]
pub struct OptionGroup {
    /// The name of their field in [`SolveOptions`], and in reports; `general` for its own fields.
    pub name: &'static str,
    /// What they are for.
    pub about: &'static str,
    /// The options.
    pub options: &'static [OptionEntry],
}

/// An option as it is typed, read, checked and listed.
#[derive(Debug)]
pub struct OptionEntry {
    /// Its key, as in `--set key=value`.
    pub key: &'static str,
    /// What it does.
    pub help: &'static str,
    /// What a number of 1 stands for; empty where it needs no unit.
    pub unit: &'static str,
    value_type: fn() -> OptionType,
    range: fn() -> String,
    show: fn(&SolveOptions) -> Option<String>,
    check: fn(&SolveOptions) -> Result<(), OptionsError>,
    reset: fn(&mut SolveOptions),
    set: fn(&mut SolveOptions, &str) -> Result<(), OptionsError>,
}

impl OptionEntry {
    /// What its value is.
    pub fn value_type(&self) -> OptionType {
        (self.value_type)()
    }

    /// What is legal, as in "it must be ...".
    pub fn range(&self) -> String {
        (self.range)()
    }

    /// Its value in `options` as it is typed; `None` if nobody has given it.
    pub fn value(&self, options: &SolveOptions) -> Option<String> {
        (self.show)(options)
    }

    /// Sets it back to its default.
    pub fn reset(&self, options: &mut SolveOptions) {
        (self.reset)(options);
    }

    /// Whether its value in `options` is in range.
    pub(super) fn check(&self, options: &SolveOptions) -> Result<(), OptionsError> {
        (self.check)(options)
    }

    /// Reads its value from text.
    pub(super) fn set(&self, options: &mut SolveOptions, text: &str) -> Result<(), OptionsError> {
        (self.set)(options, text)
    }
}
