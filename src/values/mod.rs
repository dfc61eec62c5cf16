//! Values at points: the radiosity equation evaluated once more at the point itself, over links (`over_links`) or over cells
//! (`final_gather`, with an `irradiance_cache` where many points lie close). `sensors` gather off surfaces. `shading` has older methods, to compare.

mod budget;
mod error_bars;
mod final_gather;
mod gather;
mod indirect;
mod irradiance_cache;
mod link_receiver;
mod link_sources;
mod over_links;
mod recorded;
mod reflected;
mod sample;
mod sensors;
mod shading;
mod source_piece;
mod summary;
mod variation;

pub(crate) use budget::{NOISE_POWER, RayBudget};
pub(crate) use error_bars::ErrorBars;
pub(crate) use final_gather::{BATCH, FinalGather, emitter_rays};
pub(crate) use gather::{Gather, Gathered, Over, Part, Scratch};
pub(crate) use indirect::IndirectGather;
pub(crate) use over_links::LinkGather;
pub(crate) use recorded::GatherRecorder;
pub(crate) use reflected::{Reflected, reflected_at};
pub use sample::{Values, ValuesError};
pub(crate) use sample::{tolerance, values_at};
pub use sensors::Irradiances;
pub(crate) use sensors::irradiances_at;
pub(crate) use shading::Shading;
pub use shading::ShadingMethod;
pub use summary::Summary;
