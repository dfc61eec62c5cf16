//! Lightmaps: the light of a solution as textures.
//!
//! Where a file has coordinates for lightmaps, these say where its triangles lie (`file_charts`, `compose`). Else coplanar faces of one material that hang together are a chart, laid into its page as it is, without distortion (`charts`, `atlas`). Each texel has a
//! *site*: the middle of its square, or the centroid of the part that a face covers if no face covers the middle (`coverage`). Sites on which something stands have no light and get none (`hidden`); what no site covers is filled from the same
//! chart, so that nothing leaks in from elsewhere (`fill`).
//!
//! Values are read off a lit mesh, or gathered where they are needed: on a lattice first, then wherever the values in between differ from what the
//! lattice says (`lattice`); the rest is interpolated. Interpolated texels are held against gathers of their own, which tells how far they are off
//! (`gathered`). Of an earlier bake of a scene that was changed since, light is kept where it changed by a linear function (`record`, `change`); how far that is off is found in the same way. What a limit keeps from being found is filled from others, or has the solver's own light (`cut_short`).

mod atlas;
mod change;
mod charts;
mod compose;
mod coverage;
mod cut_short;
mod file_charts;
mod fill;
mod gathered;
mod hidden;
mod lattice;
mod lightmap;
mod options;
mod record;
mod seams;
mod texels;
mod vertices;

pub use atlas::{Atlas, FaceOnAtlas};
pub(crate) use cut_short::{NotFound, complete};
pub use gathered::Kept;
pub(crate) use gathered::{Aim, Asked, Found, gather};
pub(crate) use hidden::hide;
pub(crate) use lightmap::finish;
pub use lightmap::{BakeReport, LightPart, Lightmap};
pub use options::{BakeError, BakeOptions, EarlierProblem, Only, UvProblem};
pub use record::BakeRecord;
pub(crate) use record::{Base, Terms};
pub use seams::Seams;
pub(crate) use texels::{Texels, texels_of};
pub use vertices::VertexLight;
pub(crate) use vertices::{points_around, surfaces_of};
