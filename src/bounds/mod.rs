//! How wrong the answer can be: lower and upper radiosities that hold at every point, over elements of their own where there are few
//! surfaces, else over the links that a solve has made.
//!
//! Where to begin:
//! 1. `system`: the two systems of inequalities, and what they consist of;
//! 2. `knapsack`, then `iteration`: how a leaf's inequality is solved, and how all of them are, from outside, so that every iterate holds;
//! 3. `form_factors/pair`: the range of a form factor over a receiver; what is in the way: `blockers`, then `shadow`;
//! 4. `adaptive`: the loop that splits elements of a small scene, with `groups` of sources of which more is known than of each;
//!    `pairs/bounded_pairs`: over links, which pairs get ranges, and how closely;
//! 5. `radiosity_bounds`: all of this in a row; `point_gather`: what follows for single points; `report`: what it says in the usual
//!    norms, and `conditions`: what it rests on.
//!
//! Built on these: bounds of importance, which is the radiosity of what one wants to know (`importance_bounds`); bounds at points
//! (`point_bounds`); which links the gap comes from, for refinement (`attribution`, `link_gaps`); what pairs without a link hold back at
//! most, whatever else is known (`pairs/held_back`); and, for comparison, ranges that are narrower and no bounds (`ranges`).
//!
//! What is proved is about polygons that are planar and do not overlap in one plane, with visibility as
//! [`visibility`](crate::visibility) defines it. Vertices off the plane of their polygon, by up to 1e-6 of its size, are not allowed
//! for. Reports list where a scene is not quite like that.
//!
//! After Lischinski 1994, chapter 5, from which it departs: form factors are bounded by a theorem instead of samples, and the upper
//! system is approached from above, under the condition that form factors add up to at most 1.

mod adaptive;
mod assembly;
mod attribution;
mod conditions;
mod element_bounds;
mod enclosure;
mod evidence;
mod form_factors;
mod groups;
mod importance_bounds;
mod input;
mod iteration;
mod knapsack;
mod link_gaps;
mod pairs;
mod point_bounds;
mod point_gather;
mod radiosity_bounds;
mod ranges;
mod report;
mod rounding;
mod stacks;
mod system;

pub use conditions::{Condition, ConditionKind};
pub use evidence::{Certainty, Evidence};
pub use form_factors::{FormFactorBounds, FormFactorRule, bound_pair};
pub use importance_bounds::ImportanceBounds;
pub(crate) use importance_bounds::bound_importance;
pub(crate) use input::BoundsInput;
pub(crate) use link_gaps::{KnownPairs, LinkGap, LinkGaps, link_gaps};
pub(crate) use pairs::{Light, bound_held_back};
pub use point_bounds::PointBounds;
pub use radiosity_bounds::RadiosityBounds;
pub(crate) use radiosity_bounds::{bound_over_links, bound_radiosities};
pub(crate) use ranges::estimate_ranges;
pub use report::{BoundsReport, ChannelError, EvidenceShare};

#[cfg(test)]
mod tests;
