//! The lit mesh: radiosity as a function on the surfaces, by quadratic elements.

mod bisection;
mod build;
mod element;
mod grow;
mod growing;
mod judged;
mod light;
mod lit_mesh;
mod locate;
mod plane;
mod surface_mesh;
mod triangles;
mod triangulation;

pub(crate) use build::MeshBuilder;
pub use lit_mesh::LitMesh;
pub(crate) use lit_mesh::MeshReader;
pub use triangles::triangulated;
