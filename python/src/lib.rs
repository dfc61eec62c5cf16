//! The Python interface of Patchlight.
//!
//! Thin: values of Python become a validated request, and that becomes calls of the Rust library. Where to begin: `watch` is how long work
//! runs beside Python, `arrays` how arrays come and go, `errors` what becomes an exception; then a file for each class. What is easier said
//! in Python, shapes of arrays above all, stands in `patchlight/_meshes.py`.

mod arrays;
mod camera;
mod diagnostic;
mod errors;
mod links;
mod lit;
mod mesh;
mod names;
mod nodes;
mod options;
mod picture;
mod relight;
mod scene;
mod solution;
mod solve;
mod values;
mod watch;
mod workers;

/// What `patchlight/__init__.py` makes public.
#[pyo3::pymodule]
mod _native {
    #[pymodule_export]
    use crate::camera::CameraView;
    #[pymodule_export]
    use crate::diagnostic::Diagnostic;
    #[pymodule_export]
    use crate::links::Links;
    #[pymodule_export]
    use crate::mesh::Mesh;
    #[pymodule_export]
    use crate::nodes::Nodes;
    #[pymodule_export]
    use crate::options::{OptionText, options};
    #[pymodule_export]
    use crate::picture::Picture;
    #[pymodule_export]
    use crate::scene::Scene;
    #[pymodule_export]
    use crate::solution::Solution;
    #[pymodule_export]
    use crate::solve::{load, solve};
    #[pymodule_export]
    use crate::values::Values;

    use pyo3::prelude::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
