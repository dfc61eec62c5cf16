//! Links by the error of their form factors alone, from samples of the kernel (Chang, Shih 1998): bottom-up, and top-down to
//! compare.
//!
//! A link between p and q gets its form factors from the mean kernel `<G>` of samples, and may get it wrong by `(max G - min G) A`
//! with A the area of the source. G holds the visibility, which has no lower bound that is easy to find, so min G is taken as zero
//! (section 4) and the error of a form factor is `max G A`. Top-down a pair of nodes is judged by samples on the nodes themselves;
//! bottom-up by all samples on the elements below, from which maxima and sums rise to the nodes above: these are better known then,
//! and nothing is sampled twice.
//!
//! Neither looks at light: links are made once. Both link pairs of surfaces, know no clusters, and subdivide every surface
//! completely, down to A_eps, beforehand. Maxima of samples are estimates, no bounds.
//!
//! Cost: bottom-up `(n A / A_eps)^2 / 2` pairs of elements, each asked `samples^2` rays, whatever the tolerance; top-down as many
//! rays for each pair of nodes that is judged, which the tolerance decides.

mod context;
mod kernels;
mod linking;
mod refine;
mod sampled_link;
mod top_down;
mod trees;

#[cfg(test)]
mod tests;

pub(crate) use context::{RefineDirection, SampledContext};
