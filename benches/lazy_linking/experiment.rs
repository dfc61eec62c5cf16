//! The experiment: rooms, the parameters that are the same for all of them, and what is measured.

use std::path::Path;

use patchlight::scene::Scene;
use patchlight::scene::import::{ImportOptions, read_scene};
use patchlight::solve::{Holzschuch94Options, LinkOptions, SolveOptions};

use super::measure::Run;
use super::paper::PaperRoom;

/// eps_refine in units of the mean reflected radiosity that a room may be expected to have.
pub const REFINE_TOLERANCE: f64 = 0.02;
/// MinArea in m^2: the number of the paper's figure 1.
const MIN_AREA: f64 = 0.001;
/// eps_reduce, which the paper does not tell: by the rule of `tolerances`, as eps_refine.
const REDUCE_TOLERANCE: f64 = 0.4;
/// The smallest form factor that link culling leaves.
const CULL_FORM_FACTOR: f64 = 1e-3;

/// All that is measured of a room.
pub struct Measured {
    pub room: &'static PaperRoom,
    pub original: Run,
    pub culling: Run,
    pub lazy: Run,
    pub reduced: Run,
    /// Of the elements of lazy linking, and of lazy linking with reduction, from those of the original.
    pub lazy_difference: f64,
    pub reduced_difference: f64,
    /// The same of link culling.
    pub culling_difference: f64,
    /// Of the values at points, in the same order.
    pub value_differences: [f64; 3],
    pub default: Option<Comparison>,
}

/// The default strategy beside the original.
pub struct Comparison {
    pub cpu_s: f64,
    pub claimed: f64,
    pub rays: u64,
    pub links: u64,
    /// Errors against a finer solution of the default strategy: its claim is the last number.
    pub error: f64,
    pub original_error: f64,
    pub reduced_error: f64,
    pub reference_claim: f64,
}

pub fn scene_of(room: &PaperRoom) -> Scene {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(format!("{}.obj", room.file));
    let scene = read_scene(&file, &ImportOptions::default()).expect("a scene of the repository").scene;
    assert_eq!(scene.surfaces().len(), room.polygons, "the paper's number of polygons");
    scene
}

/// The parameters of the experiment.
pub fn options_of(scene: &Scene) -> SolveOptions {
    let area: f64 = scene.surfaces().iter().map(|surface| surface.polygon.area()).sum();
    SolveOptions {
        links: LinkOptions { tolerance: Some(REFINE_TOLERANCE), min_element: MIN_AREA / area, ..LinkOptions::default() },
        holzschuch94: Holzschuch94Options {
            reduce_tolerance: REDUCE_TOLERANCE,
            cull_form_factor: CULL_FORM_FACTOR,
            ..Holzschuch94Options::default()
        },
        ..SolveOptions::default()
    }
}
