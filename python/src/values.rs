//! Values at points.

use patchlight::bounds::PointBounds;
use patchlight::scene::SurfacePoint;
use patchlight::values;
use pyo3::intern;
use pyo3::prelude::*;

use crate::arrays::{array, as_asked, vectors};
use crate::errors::Failure;

/// Radiosities at points, from `Solution.values`. `numpy.asarray(values)` is `values.radiosity`.
#[pyclass(frozen, get_all, module = "patchlight")]
pub struct Values {
    /// Radiosities: float32 array (..., C) in W/m^2, with the axes of the points; NaN at points that lie on no surface.
    radiosity: Py<PyAny>,
    /// Their standard errors: float32 array (..., C) in W/m^2; NaN where they are not known.
    standard_error: Py<PyAny>,
    /// No less, proved: float32 array (..., C) in W/m^2; None unless solved with bounds="guaranteed".
    lower: Option<Py<PyAny>>,
    /// No more, proved: as `lower`.
    upper: Option<Py<PyAny>>,
    /// The face in the scene, from 0, that each point lies on: int64 array (...); -1 for points that lie on no surface.
    faces: Py<PyAny>,
    /// How many points lie on no surface.
    missed: usize,
    /// An estimate of the error over these points, relative to the reflected light at each; None where it is not known.
    error: Option<f64>,
}

#[pymethods]
impl Values {
    #[pyo3(signature = (dtype=None, copy=None))]
    fn __array__<'py>(
        &self,
        py: Python<'py>,
        dtype: Option<&Bound<'py, PyAny>>,
        copy: Option<bool>,
    ) -> PyResult<Bound<'py, PyAny>> {
        as_asked(self.radiosity.bind(py), dtype, copy)
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let shape = self.radiosity.bind(py).getattr(intern!(py, "shape"))?;
        Ok(format!("<patchlight.Values: radiosities {shape}, {} points on no surface>", self.missed))
    }
}

impl Values {
    pub fn new(py: Python<'_>, values: values::Values, bounds: Option<PointBounds>, shape: &[usize]) -> PyResult<Self> {
        let numbers = |numbers: Vec<f32>| Ok::<_, PyErr>(array(py, numbers, shape)?.into_any().unbind());
        let faces: Vec<i64> = values.faces.iter().map(|face| face.map_or(-1, i64::from)).collect();
        let point_shape = &shape[..shape.len() - 1];
        let (lower, upper) = bounds.map(|bounds| (bounds.lower, bounds.upper)).unzip();
        Ok(Self {
            radiosity: numbers(values.radiosity)?,
            standard_error: numbers(values.standard_error)?,
            lower: lower.map(numbers).transpose()?,
            upper: upper.map(numbers).transpose()?,
            faces: array(py, faces, point_shape)?.into_any().unbind(),
            missed: values.missed,
            error: values.error.map(|error| error.local),
        })
    }
}

/// Points on surfaces, and the axes that they came in.
pub fn points(positions: &Bound<'_, PyAny>, normals: &Bound<'_, PyAny>) -> PyResult<(Vec<SurfacePoint>, Vec<usize>)> {
    let (positions, shape) = vectors(positions, "points")?;
    let (normals, normal_shape) = vectors(normals, "normals")?;
    if !normal_shape.is_empty() && normal_shape != shape {
        let message =
            format!("points have the axes {shape:?} and normals {normal_shape:?}: give a normal for each, or one for all");
        return Err(Failure::argument(message).into());
    }
    let normals = normals.iter().cycle().take(positions.len());
    let points = positions.iter().zip(normals).enumerate().map(|(number, (&position, &normal))| {
        SurfacePoint::checked(position, normal).map_err(|error| Failure::argument(format_args!("point {number}: {error}")).into())
    });
    Ok((points.collect::<PyResult<_>>()?, shape))
}
