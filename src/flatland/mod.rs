//! Flatland: visibility at many resolutions in two dimensions (Soler, Sillion 1996, "Accurate Error Bounds for Multi-Resolution Visibility").
//!
//! The question: what fraction of the light that leaves a segment arrives at another, through a cluster of many segments, to a requested error, and
//! without looking at each of them. Clusters form a hierarchy of boxes ([`Hierarchy`]). With each is stored how much it lets through by direction, and two
//! terms that tell how far single lines are off that ([`DirectionalTransmittance`]). From these follows, for a receiver and a source, a bound of the
//! error of taking the cluster as a whole, BVE ([`bound_visibility_error`]). Clusters for which it is too large are opened, and of the requested error each
//! hands back what it did not use ([`form_factor`]).
//!
//! ```text
//! F_rs = mu(lines from the front of r to the front of s that nothing blocks) / (2 length of r),      mu = drho dtheta
//! ```
//!
//! The paper's formulas are followed; where it has gaps or mistakes, each module says what they are and how they are closed, with section or equation. All
//! bounds here are proven, up to rounding, without regularity assumptions: a form factor lies within its error of the true one. What is proven is
//! the same for any hierarchy, and checked against lengths of strings with every occluder ([`exact_form_factor`]).
//!
//! This layer is of its own. Nothing in three dimensions uses it.
//!
//! ```
//! use patchlight::flatland::{Hierarchy, Segment, exact_form_factor, form_factor};
//!
//! // Fronts are to the left, from the first end to the second.
//! let receiver = Segment::new([0.0, 0.0], [1.0, 0.0])?;
//! let source = Segment::new([1.0, 2.0], [0.0, 2.0])?;
//! let leaf = |k: u32| Segment::new([0.1 * f64::from(k), 0.9], [0.1 * f64::from(k) + 0.04, 1.1]);
//! let leaves = (0..10).map(leaf).collect::<Result<Vec<_>, _>>()?;
//!
//! let found = form_factor(&receiver, &source, &Hierarchy::of(&leaves, 64), 0.01);
//! let exact = exact_form_factor(&receiver, &source, &leaves);
//! assert!((found.form_factor - exact).abs() <= found.error && found.error <= 0.01);
//! # Ok::<(), patchlight::flatland::SegmentError>(())
//! ```

mod form_factor;
mod hierarchy;
mod lines;
mod segment;
mod shadow;
mod sightlines;
mod strings;
mod transmittance;
mod visibility_error;

pub use form_factor::{Approximation, Work, form_factor};
pub use hierarchy::{ClusterId, Hierarchy};
pub use segment::{Segment, SegmentError};
pub use sightlines::Sightlines;
pub use strings::exact_form_factor;
pub use transmittance::{DirectionalTransmittance, Resolution};
pub use visibility_error::{AsWhole, Seen, bound_correlation, bound_visibility_error};
