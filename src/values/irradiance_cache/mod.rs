//! The irradiance cache (Ward, Rubinstein, Clear 1988): records of indirect irradiance, which points nearby take theirs from.
//!
//! `build` says where records are taken and whether they pay; `record` takes one and fits through several.

mod build;
mod plane_cells;
mod record;

pub(super) use build::{CacheBuilder, IrradianceCache};
pub(super) use record::Fitted;
