//! Lit meshes.

use std::iter::repeat_n;
use std::path::PathBuf;
use std::sync::Arc;

use patchlight::mesh::{LitMesh, MeshPart};
use patchlight::output::{Destination, ExportFormat, write_mesh_ply};
use patchlight::progress::Observer;
use patchlight::scene::Scene;
use pyo3::prelude::*;

use crate::arrays::array;
use crate::errors::Failure;
use crate::lit::Lit;
use crate::picture::Picture;
use crate::values::points;
use crate::watch::{Listener, watched};

/// Radiosity as a function on the surfaces, from `Solution.mesh`: M elements with six nodes each, between which it is quadratic; N nodes. It is
/// read at once, so values and pictures have no noise of their own. Each array is a new one.
///
/// `meshio.Mesh(mesh.nodes, [("triangle6", mesh.elements)], point_data={"radiosity": mesh.radiosity})` takes it as it is.
#[pyclass(frozen, module = "patchlight")]
pub struct Mesh {
    lit: Arc<Lit>,
    /// Unless it is the solution's own.
    made: Option<LitMesh>,
}

type Made<'py> = PyResult<Bound<'py, PyAny>>;

#[pymethods]
impl Mesh {
    /// Where the nodes are: float64 array (N, 3) in metres. Elements of one surface share nodes, but where light may have a step.
    #[getter]
    fn nodes<'py>(&self, py: Python<'py>) -> Made<'py> {
        let mesh = self.lit_mesh()?;
        let positions = mesh.parts(self.scene()?).flat_map(|part| part.nodes).flatten().collect();
        array(py, positions, &[mesh.nodes(), 3]).map(Bound::into_any)
    }

    /// The nodes of each element: int64 array (M, 6), rows of `nodes`. First the corners, counter-clockwise from the front, then the middles of the
    /// edges from the first to the second, from that to the third, and back.
    #[getter]
    fn elements<'py>(&self, py: Python<'py>) -> Made<'py> {
        let mesh = self.lit_mesh()?;
        let nodes = mesh.element_nodes().flatten().map(i64::from).collect();
        array(py, nodes, &[mesh.elements(), 6]).map(Bound::into_any)
    }

    /// The surface that each element lies on: int64 array (M,).
    #[getter]
    fn surface<'py>(&self, py: Python<'py>) -> Made<'py> {
        let mesh = self.lit_mesh()?;
        let surface = |part: MeshPart<'_>| repeat_n(i64::from(part.surface), part.elements.len());
        let surfaces = mesh.parts(self.scene()?).flat_map(surface).collect();
        array(py, surfaces, &[mesh.elements()]).map(Bound::into_any)
    }

    /// Radiosities at the nodes: float32 array (N, C) in W/m^2.
    #[getter]
    fn radiosity<'py>(&self, py: Python<'py>) -> Made<'py> {
        let (scene, mesh) = (self.scene()?, self.lit_mesh()?);
        let radiosity = mesh.parts(scene).flat_map(|part| part.radiosity).collect();
        array(py, radiosity, &[mesh.nodes(), scene.channels()]).map(Bound::into_any)
    }

    /// The standard error of what is read in each element: float32 array (M,) in W/m^2, all channels together: the root of the sum of their squares, in
    /// the mean over the element. NaN where it is not known, as with other weights of light groups.
    #[getter]
    fn standard_error<'py>(&self, py: Python<'py>) -> Made<'py> {
        let (scene, mesh) = (self.scene()?, self.lit_mesh()?);
        let errors = mesh.parts(scene).flat_map(|part| part.standard_errors).collect();
        array(py, errors, &[mesh.elements()]).map(Bound::into_any)
    }

    /// How far the mesh is off the values at points, relative to these: measured at points that had no part in making it.
    #[getter]
    fn measured(&self) -> PyResult<f64> {
        Ok(self.lit_mesh()?.measured)
    }

    /// An upper confidence limit of that. What the values are off the truth, `Solution.error`, comes on top: the whole is the root of both squares.
    #[getter]
    fn claimed(&self) -> PyResult<f64> {
        Ok(self.lit_mesh()?.claimed)
    }

    /// Radiosities at points that lie on surfaces: float32 array (..., C) in W/m^2, with the axes of the points; NaN at points that lie on no surface.
    ///
    /// points, normals, progress: as in `Solution.values`.
    #[pyo3(signature = (points, normals, *, progress=None))]
    fn values<'py>(
        &self,
        points: &Bound<'py, PyAny>,
        normals: &Bound<'py, PyAny>,
        progress: Option<&Bound<'py, PyAny>>,
    ) -> Made<'py> {
        let (py, evaluator, mesh) = (points.py(), self.lit.evaluator()?, self.lit_mesh()?);
        let listener = Listener::new(progress)?;
        let (points, mut shape) = self::points(points, normals)?;
        shape.push(self.scene()?.channels());
        let work = |observer: &dyn Observer| evaluator.values_of_mesh_observed(mesh, &points, observer);
        let values = watched(py, &listener, work)?.ok_or_else(Failure::cancelled)?;
        array(py, values, &shape).map(Bound::into_any)
    }

    /// Takes a picture of it, as `Solution.render` does, but without grain and at once.
    ///
    /// camera, width, height, progress: as in `Solution.render`.
    #[pyo3(signature = (camera=None, *, width=640, height=480, progress=None))]
    fn render(
        &self,
        py: Python<'_>,
        camera: Option<&Bound<'_, PyAny>>,
        width: u32,
        height: u32,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Picture> {
        let (evaluator, mesh) = (self.lit.evaluator()?, self.lit_mesh()?);
        let listener = Listener::new(progress)?;
        let camera = self.lit.camera(py, camera, width, height)?;
        let render = |observer: &dyn Observer| evaluator.render_mesh(mesh, &camera, observer);
        let image = watched(py, &listener, render)?.map_err(Failure::from)?.ok_or_else(Failure::cancelled)?;
        Picture::new(py, image, camera, self.lit.provenance()?)
    }

    /// Writes it: .ply, with four triangles for each element and radiosities at their corners.
    fn write_ply(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let (scene, mesh, provenance) = (self.scene()?, self.lit_mesh()?, self.lit.provenance()?);
        if ExportFormat::of_path(&path).map_err(Failure::from)? != ExportFormat::Ply {
            return Err(Failure::argument("write_ply writes .ply; Solution.export writes .glb and .vtp").into());
        }
        let write = || -> Result<(), Failure> {
            Ok(Destination::new(&path)?.write(|file| write_mesh_ply(file, scene, mesh, &provenance))?)
        };
        py.detach(write)?;
        Ok(())
    }

    /// How many elements there are.
    fn __len__(&self) -> PyResult<usize> {
        Ok(self.lit_mesh()?.elements())
    }

    fn __repr__(&self) -> PyResult<String> {
        let mesh = self.lit_mesh()?;
        let (elements, nodes, claimed) = (mesh.elements(), mesh.nodes(), 100.0 * mesh.claimed);
        Ok(format!("<patchlight.Mesh: {elements} elements, {nodes} nodes, {claimed:.2}% off the values claimed>"))
    }
}

impl Mesh {
    /// The mesh of a solution, or one that was made from it.
    pub fn new(lit: Arc<Lit>, made: Option<LitMesh>) -> Self {
        Self { lit, made }
    }

    fn lit_mesh(&self) -> Result<&LitMesh, Failure> {
        let own = self.lit.evaluator()?.mesh();
        self.made.as_ref().or(own).ok_or_else(|| Failure::internal("the solution lost its mesh"))
    }

    fn scene(&self) -> Result<&Scene, Failure> {
        Ok(self.lit.evaluator()?.solution().scene())
    }
}
