//! Oracles: whether a pair of nodes may interact as it stands, or which of the two is to be split.
//!
//! An oracle sees numbers only. One file each.

mod area_weighted;
mod brightness_weighted;
mod decision;
mod error_driven;
mod uniform;

pub use area_weighted::AreaWeighted;
pub use brightness_weighted::BrightnessWeighted;
pub use decision::{Candidate, Decision, RefinementOracle};
pub use error_driven::{ErrorDriven, LinkError};
pub use uniform::Uniform;
