//! Links as Holzschuch, Sillion, Drettakis 1994 make them: between surfaces first, for both directions at once, refined by BF.
//!
//! Beside the link tree that starts from (root, root), which holds its pairs of surfaces only implicitly, this is the paper's own form, for
//! comparison: clusters play no part, every pair of surfaces is asked, and n(n-1)/2 bits tell which have been classified. A link is
//! asked for its visibility once, by 16 rays; a pair of which no ray arrived is dropped. No rays of their own give it an unbiased value.
//!
//! Cost: O(n^2) pairs in every iteration, without rays for those that are not worth it.

mod ask;
mod context;
mod dormant;
mod mutual_links;
mod pairs;
mod reduction;
mod refine;
mod top_level;

pub(crate) use ask::RAYS_PER_LINK;
pub(crate) use context::MutualContext;
pub(crate) use mutual_links::{MutualLinks, TopLevel};
