//! What is computed over links: gather and push-pull, by Jacobi sweeps or in place; importance, against the direction of light; and
//! which part of a node is exposed.

mod change;
mod closure;
mod defect;
mod exposed_points;
mod exposure;
mod gather;
mod importance;
mod in_place;
mod light_irradiance;
mod missing;
mod push;
mod push_pull;
mod radiosity;
mod reflection;

pub(crate) use change::Change;
pub(crate) use closure::Closure;
pub(crate) use defect::Reflections;
pub(crate) use exposed_points::sampled_exposed_point;
pub use exposure::Exposure;
pub(crate) use exposure::{ByPlane, HiddenPoints};
pub(crate) use gather::{Irradiance, gather, gather_into};
pub(crate) use importance::Adjoint;
pub use importance::Importance;
pub(crate) use in_place::sweep_in_place;
pub(crate) use light_irradiance::LightIrradiance;
pub(crate) use missing::{estimate_ambient, incorrect_energy, reflect_ambient, row_sums};
pub(crate) use push::push;
pub(crate) use push_pull::push_pull;
pub use radiosity::Radiosity;
pub(crate) use radiosity::cluster_reflectance;
pub(crate) use reflection::Reflection;

/// The least number of nodes that is worth a task of its own.
const PARALLEL: usize = 256;
