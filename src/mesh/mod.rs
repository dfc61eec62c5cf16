//! The lit mesh: radiosity as a function on the surfaces, by quadratic elements.

mod bends;
mod bisection;
mod build;
mod crossings;
mod cursor;
mod effort;
mod element;
mod expected;
mod fit;
mod grow;
mod growing;
mod judged;
mod light;
mod limits;
mod line;
mod lit_mesh;
mod locate;
mod noise;
mod plane;
mod remedy;
mod seen;
mod spots;
mod surface_mesh;
mod triangles;
mod triangulation;
mod validate;

pub(crate) use build::{LEAST_GATHERS, MeshBuilder};
pub(crate) use cursor::MeshCursor;
pub(crate) use judged::MeshError;
pub(crate) use limits::{MeshLimit, MeshLimits};
pub use lit_mesh::{LitMesh, MeshPart};
pub(crate) use lit_mesh::{MeshIndex, MeshReader};
pub(crate) use seen::{SeenPoint, SeenSurfaces};
pub use triangles::triangulated;
