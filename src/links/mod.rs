//! Which nodes exchange light: links, and how they are found.
//!
//! A link says that receiver r gathers from source s: `B_r += rho_r F_rs B_s`. Links belong to their receivers. Every ordered pair
//! of leaves is covered by exactly one pair of nodes, linked, dormant or proved invisible, because all pairs descend from (root, root).

mod ask;
mod candidate;
mod chang_shih98;
mod context;
mod decide;
mod exchange;
mod holzschuch94;
mod limits;
mod link_set;
pub mod oracle;
mod refine;
mod sample_pairs;
mod skips;

pub(crate) use chang_shih98::{RefineDirection, SampledContext};
pub(crate) use context::{MapsOfLinks, RefineContext};
pub(crate) use holzschuch94::{MutualContext, MutualLinks, RAYS_PER_LINK, TopLevel};
pub(crate) use limits::{RefineEnd, RefineLimits};
pub use link_set::{Link, LinkSet, Pair};
pub(crate) use refine::{Dropped, Refinement};
pub use skips::Skips;
