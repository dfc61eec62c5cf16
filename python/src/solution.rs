//! Solutions.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use patchlight::output::{Destination, ExportFormat, export_elements, write_solution};
use patchlight::progress::Observer;
use patchlight::scene::LightGroups;
use patchlight::solve::{ErrorReport, SolveOptions};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::array;
use crate::camera::CameraView;
use crate::errors::{Failure, warn_of_limit};
use crate::links::Links;
use crate::lit::{Known, Lit};
use crate::mesh::Mesh;
use crate::names::name_of;
use crate::nodes::{Nodes, Which};
use crate::picture::Picture;
use crate::relight::{materials, weights};
use crate::values::{Values, points};
use crate::watch::{Listener, watched};

/// The answer: radiosities of everything, and what values at points and pictures are made from. Unchangeable; may be used by many threads.
///
/// Made by `patchlight.solve` and `patchlight.load`.
#[pyclass(frozen, module = "patchlight")]
pub struct Solution {
    lit: Arc<Lit>,
}

#[pymethods]
impl Solution {
    /// Radiosities at points that lie on surfaces.
    ///
    /// points: float array (..., 3), in metres.
    /// normals: unit normals of the sides that are looked at: float array of the same shape, or (3,) for all points.
    /// progress: as in `solve`; returns it True, `Cancelled` is raised.
    #[pyo3(signature = (points, normals, *, progress=None))]
    fn values(
        &self,
        points: &Bound<'_, PyAny>,
        normals: &Bound<'_, PyAny>,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Values> {
        let (py, evaluator) = (points.py(), self.lit.evaluator()?);
        let listener = Listener::new(progress)?;
        let (points, mut shape) = self::points(points, normals)?;
        shape.push(evaluator.solution().scene().channels());
        let work = |observer: &dyn Observer| evaluator.bounded_values_at(&points, observer);
        let (values, bounds) = watched(py, &listener, work)?.ok_or_else(Failure::cancelled)?;
        Values::new(py, values, bounds, &shape)
    }

    /// What sensors measure: points anywhere in space, on surfaces or off them.
    ///
    /// points: float array (..., 3), in metres.
    /// normals: unit normals of the sides that light arrives at: float array of the same shape, or (3,) for all sensors.
    /// progress: as in `solve`; returns it True, `Cancelled` is raised.
    ///
    /// Returns irradiances and their standard errors: two float32 arrays (..., C) in W/m^2; errors are NaN where they are not known.
    #[pyo3(signature = (points, normals, *, progress=None))]
    fn irradiances<'py>(
        &self,
        points: &Bound<'py, PyAny>,
        normals: &Bound<'py, PyAny>,
        progress: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let (py, evaluator) = (points.py(), self.lit.evaluator()?);
        let listener = Listener::new(progress)?;
        let (sensors, mut shape) = self::points(points, normals)?;
        shape.push(evaluator.solution().scene().channels());
        let found = watched(py, &listener, |observer: &dyn Observer| evaluator.irradiances_at(&sensors, observer))?;
        if found.missing() > 0 {
            return Err(Failure::cancelled().into());
        }
        let numbers = |numbers: Vec<f32>| Ok::<_, PyErr>(array(py, numbers, &shape)?.into_any());
        Ok((numbers(found.irradiance)?, numbers(found.standard_error)?))
    }

    /// A camera that shows the scene. What is given is kept, what is left out is chosen.
    ///
    /// eye, target, up: three coordinates each, in metres. field_of_view: vertical, in degrees. width, height: in pixels.
    #[pyo3(signature = (*, width=640, height=480, **view))]
    fn camera(&self, py: Python<'_>, width: u32, height: u32, view: Option<&Bound<'_, PyDict>>) -> PyResult<CameraView> {
        let request = CameraView::request(view)?;
        self.lit.camera_of(py, &request, width, height).map(CameraView)
    }

    /// Takes a picture, which shows itself in a notebook.
    ///
    /// camera: a `Camera`; text as `patchlight render --camera` takes it, such as "eye=1,1,5 fov=40"; None for a view that shows the scene.
    /// width, height: in pixels, where the camera is no `Camera`.
    /// progress: as in `solve`; returns it True, `Cancelled` is raised.
    #[pyo3(signature = (camera=None, *, width=640, height=480, progress=None))]
    fn render(
        &self,
        py: Python<'_>,
        camera: Option<&Bound<'_, PyAny>>,
        width: u32,
        height: u32,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Picture> {
        let evaluator = self.lit.evaluator()?;
        let listener = Listener::new(progress)?;
        let camera = self.lit.camera(py, camera, width, height)?;
        let image = watched(py, &listener, |observer: &dyn Observer| evaluator.render(&camera, observer))?;
        let image = image.map_err(Failure::from)?.ok_or_else(Failure::cancelled)?;
        Picture::new(py, image, camera, self.lit.provenance()?)
    }

    /// The mesh: radiosity as a function on the surfaces. The one that was solved for with lit_mesh=True, or a new one.
    ///
    /// error: how far a new one may be off the values at points, relative to these, 0 to 1. If left out, it is the mesh of the solution; if that has
    ///     none, a new one, with the error of the solve.
    /// progress: as in `solve`; returns it True, `Cancelled` is raised.
    ///
    /// If what is claimed for a new one is more than was asked for, it warns with `LimitWarning`; `Mesh.claimed` tells.
    #[pyo3(signature = (error=None, *, progress=None))]
    fn mesh(&self, py: Python<'_>, error: Option<f64>, progress: Option<&Bound<'_, PyAny>>) -> PyResult<Mesh> {
        let evaluator = self.lit.evaluator()?;
        let listener = Listener::new(progress)?;
        if error.is_none() && evaluator.mesh().is_some() {
            return Ok(Mesh::new(self.lit.clone(), None));
        }
        let error = error.unwrap_or(evaluator.solution().options().error);
        SolveOptions { error, ..SolveOptions::default() }.validate().map_err(Failure::from)?;
        let made = watched(py, &listener, |observer: &dyn Observer| evaluator.lit_mesh(error, observer))?;
        let made = made.ok_or_else(Failure::cancelled)?;
        if made.claimed > error {
            warn_of_limit(
                py,
                &format!("nothing more can be gained: an error of {} is claimed, {error} was asked for", made.claimed),
            )?;
        }
        Ok(Mesh::new(self.lit.clone(), Some(made)))
    }

    /// The same with other weights for its light groups: a weighted sum of what is stored, exact and quick. Groups that are not named keep theirs.
    ///
    /// weights: a dict from names of groups to a number from 0 on, or one for each channel; of what was solved they are 1.
    ///
    /// `error` is what is known by energy.
    fn relight(&self, weights: &Bound<'_, PyDict>) -> PyResult<Self> {
        let (py, evaluator) = (weights.py(), self.lit.evaluator()?);
        let weights = self::weights(weights, evaluator.solution().scene().channels())?;
        let relit = py.detach(|| evaluator.relit(&weights)).map_err(Failure::from)?;
        let known = relit.solution().light_groups_report().map_or(Known::Nothing, |report| Known::Weighted(report.error.estimate));
        Ok(Self::of(Lit::new(relit, known)))
    }

    /// The same surfaces with other materials, over the transport that `solve(..., keep_transport=True)` stores: no ray is cast. Materials that are
    /// not named stay as they are.
    ///
    /// reflectance: a dict from names of materials to a number from 0 to below 1, or one for each channel. exitance: the same in W/m^2.
    /// error: what is asked for; that of the solution if left out.
    /// progress: as in `solve`; returns it True, `Cancelled` is raised.
    ///
    /// If more is claimed than was asked for, it warns with `LimitWarning`; `error` tells.
    #[pyo3(signature = (reflectance=None, exitance=None, *, error=None, progress=None))]
    fn with_materials(
        &self,
        py: Python<'_>,
        reflectance: Option<&Bound<'_, PyDict>>,
        exitance: Option<&Bound<'_, PyDict>>,
        error: Option<f64>,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let evaluator = self.lit.evaluator()?;
        let (listener, lit) = (Listener::new(progress)?, evaluator.solution());
        let requested = error.unwrap_or(lit.options().error);
        SolveOptions { error: requested, ..SolveOptions::default() }.validate().map_err(Failure::from)?;
        let materials = materials(lit.scene(), reflectance, exitance)?;
        let found = watched(py, &listener, |observer: &dyn Observer| evaluator.with_materials(materials, observer))?;
        let (changed, known) = found.map_err(Failure::from)?.ok_or_else(Failure::cancelled)?;
        if known.estimate > requested {
            let claimed = known.estimate;
            warn_of_limit(py, &format!("solve the scene anew: an error of {claimed} is claimed, {requested} was asked for"))?;
        }
        Ok(Self::of(Lit::new(changed, Known::Estimated(ErrorReport { requested, ..known }))))
    }

    /// The weights of its light groups: a dict from names to a weight for each channel; empty if it was solved without.
    #[getter]
    fn light_groups(&self) -> PyResult<BTreeMap<String, Vec<f64>>> {
        let groups = self.lit.evaluator()?.solution().scene().light_groups();
        let of = |groups: &LightGroups| {
            let weights = |(number, name): (usize, &String)| (name.clone(), groups.weights_of(number).to_vec());
            groups.names().iter().enumerate().map(weights).collect()
        };
        Ok(groups.map_or_else(BTreeMap::new, of))
    }

    /// Writes it, to be read by `patchlight.load` and by the program. A file that is there is replaced by a complete one.
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let (lit, provenance) = (self.lit.evaluator()?.solution(), self.lit.provenance()?);
        py.detach(|| -> Result<(), Failure> {
            Ok(Destination::new(&path)?.write(|file| write_solution(file, lit, &provenance))?)
        })?;
        Ok(())
    }

    /// Writes the elements with their radiosities: .ply, .glb for viewers or .vtp for ParaView.
    fn export(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let (lit, provenance) = (self.lit.evaluator()?.solution(), self.lit.provenance()?);
        let format = ExportFormat::of_path(&path).map_err(Failure::from)?;
        py.detach(|| -> Result<(), Failure> {
            Ok(Destination::new(&path)?.write(|file| export_elements(file, format, lit, &provenance))?)
        })?;
        Ok(())
    }

    /// The elements: surfaces that were not split, and the smallest pieces of the others.
    #[getter]
    fn elements(&self) -> PyResult<Nodes> {
        Nodes::new(self.lit.clone(), Which::Elements)
    }

    /// The surfaces of the scene, in their order.
    #[getter]
    fn surfaces(&self) -> PyResult<Nodes> {
        Nodes::new(self.lit.clone(), Which::Surfaces)
    }

    /// All nodes of the hierarchy by their numbers: clusters, surfaces, elements, and what lies between them.
    #[getter]
    fn nodes(&self) -> PyResult<Nodes> {
        Nodes::new(self.lit.clone(), Which::All)
    }

    /// The links between nodes, as a sparse matrix. From the solver over cells these are of a coarse pass.
    #[getter]
    fn links(&self) -> PyResult<Links> {
        self.lit.evaluator()?;
        Ok(Links::new(self.lit.clone()))
    }

    /// Channels: numbers for each radiosity.
    #[getter]
    fn channels(&self) -> PyResult<usize> {
        Ok(self.lit.evaluator()?.solution().scene().channels())
    }

    /// Which solver found it: "links" or "cells".
    #[getter]
    fn solver(&self) -> PyResult<String> {
        Ok(name_of(&self.lit.evaluator()?.solution().solver()))
    }

    /// Name and version of the visibility backend.
    #[getter]
    fn backend(&self) -> PyResult<String> {
        Ok(self.lit.evaluator()?.backend())
    }

    /// Bytes that hierarchy, links and radiosities take.
    #[getter]
    fn memory_bytes(&self) -> PyResult<u64> {
        Ok(self.lit.evaluator()?.solution().memory_bytes())
    }

    /// The error that is claimed for values: an upper confidence limit; infinite where none was estimated; by energy where light groups
    /// were weighted. None if it was read from a file.
    #[getter]
    fn error(&self) -> Option<f64> {
        match &self.lit.known {
            Known::Solved(report) => Some(report.solve.error.estimate),
            Known::Estimated(error) => Some(error.estimate),
            Known::Weighted(estimate) => Some(*estimate),
            Known::Nothing => None,
        }
    }

    /// Whether the error that was asked for is reached. None if it was read from a file, or follows from another.
    #[getter]
    fn converged(&self) -> Option<bool> {
        Some(self.lit.report()?.solve.converged)
    }

    /// What ended the solve: "error", "max_links", "memory", "time", "cancelled" or "exhausted". None if it was
    /// read from a file, or follows from another.
    #[getter]
    fn stopped_by(&self) -> Option<String> {
        Some(name_of(&self.lit.report()?.solve.stopped_by))
    }

    /// What the solve tells about itself: the dict of the report that the program writes. None if it was read from a file, or follows from
    /// another.
    #[getter]
    fn report<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let loads = py.import("json")?.getattr("loads")?;
        self.lit.report().map(|report| loads.call1((&report.json,))).transpose()
    }

    fn __repr__(&self) -> PyResult<String> {
        let lit = self.lit.evaluator()?.solution();
        let claimed = self.error().map_or(String::new(), |error| format!(", {:.2}% error claimed", 100.0 * error));
        let (surfaces, channels) = (lit.scene().surfaces().len(), lit.scene().channels());
        Ok(format!("<patchlight.Solution: {surfaces} surfaces, {channels} channels, over {}{claimed}>", self.solver()?))
    }
}

impl Solution {
    pub fn of(lit: Lit) -> Self {
        Self { lit: Arc::new(lit) }
    }
}
