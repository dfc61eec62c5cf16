//! Pictures.

use std::path::PathBuf;

use numpy::{PyArray3, PyArrayMethods};
use patchlight::output::{Destination, ImageFormat, PngExposure, Provenance, Quantity, write_exr, write_hdr, write_png};
use patchlight::picture::{Camera, Image};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::arrays::{array, as_asked};
use crate::camera::CameraView;
use crate::errors::Failure;

/// A picture, from `Solution.render`. It shows itself in a notebook, and `numpy.asarray(picture)` is `picture.radiance`.
#[pyclass(frozen, module = "patchlight")]
pub struct Picture {
    camera: Camera,
    provenance: Provenance,
    /// Radiances: float32 array (height, width, C) in W/m^2/sr, from the top left; 0 where nothing is hit. What is changed in it is changed
    /// in the picture.
    #[pyo3(get)]
    radiance: Py<PyArray3<f32>>,
    /// Their standard errors: float32 array (height, width, C) in W/m^2/sr; None where they are not known.
    #[pyo3(get)]
    standard_error: Option<Py<PyArray3<f32>>>,
}

#[pymethods]
impl Picture {
    /// The camera that took it.
    #[getter]
    fn camera(&self) -> CameraView {
        CameraView(self.camera)
    }

    /// As PNG, tone-mapped, in sRGB; grey if it has other than three channels.
    ///
    /// exposure: radiances are multiplied by 2^exposure; None finds one.
    #[pyo3(signature = (exposure=None))]
    fn png<'py>(&self, py: Python<'py>, exposure: Option<f64>) -> PyResult<Bound<'py, PyBytes>> {
        let (image, exposure) = (self.image(py)?, exposure_of(exposure)?);
        let mut bytes = Vec::new();
        py.detach(|| write_png(&mut bytes, &image, exposure, &self.provenance)).map_err(Failure::internal)?;
        Ok(PyBytes::new(py, &bytes))
    }

    fn _repr_png_<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        self.png(py, None)
    }

    /// Writes it: .png to look at, .exr with linear radiances and their standard errors, or .hdr with radiances.
    ///
    /// exposure: as in `png`, which alone has one.
    #[pyo3(signature = (path, exposure=None))]
    fn save(&self, py: Python<'_>, path: PathBuf, exposure: Option<f64>) -> PyResult<()> {
        let (image, ev) = (self.image(py)?, exposure_of(exposure)?);
        let format = ImageFormat::of_path(&path).map_err(Failure::from)?;
        if format != ImageFormat::Png && exposure.is_some() {
            return Err(Failure::argument("exposure is for .png files; others hold radiances as they are").into());
        }
        let write = || -> Result<(), Failure> {
            Ok(Destination::new(&path)?.write(|file| match format {
                ImageFormat::Png => write_png(file, &image, ev, &self.provenance).map(drop),
                ImageFormat::Exr => write_exr(file, &image, Quantity::Radiance, &self.provenance),
                ImageFormat::Hdr => write_hdr(file, &image, Quantity::Radiance, &self.provenance),
            })?)
        };
        py.detach(write)?;
        Ok(())
    }

    #[pyo3(signature = (dtype=None, copy=None))]
    fn __array__<'py>(
        &self,
        py: Python<'py>,
        dtype: Option<&Bound<'py, PyAny>>,
        copy: Option<bool>,
    ) -> PyResult<Bound<'py, PyAny>> {
        as_asked(self.radiance.bind(py), dtype, copy)
    }

    fn __repr__(&self) -> String {
        format!("<patchlight.Picture {}x{}: {}>", self.camera.width, self.camera.height, self.camera)
    }
}

impl Picture {
    pub fn new(py: Python<'_>, image: Image, camera: Camera, provenance: Provenance) -> PyResult<Self> {
        let shape = [image.height as usize, image.width as usize, image.channels];
        let pixels = |numbers: Vec<f32>| Ok::<_, PyErr>(array(py, numbers, &shape)?.cast_into::<PyArray3<f32>>()?.unbind());
        let standard_error = image.standard_error.map(pixels).transpose()?;
        Ok(Self { camera, provenance, radiance: pixels(image.radiance)?, standard_error })
    }

    /// A copy of what the arrays hold now.
    fn image(&self, py: Python<'_>) -> PyResult<Image> {
        let numbers =
            |pixels: &Py<PyArray3<f32>>| Ok::<_, PyErr>(pixels.bind(py).try_readonly()?.as_array().iter().copied().collect());
        let channels = self.radiance.bind(py).getattr(intern!(py, "shape"))?.get_item(2)?.extract()?;
        let standard_error = self.standard_error.as_ref().map(numbers).transpose()?;
        let Camera { width, height, .. } = self.camera;
        Ok(Image { width, height, channels, radiance: numbers(&self.radiance)?, standard_error })
    }
}

fn exposure_of(exposure: Option<f64>) -> Result<PngExposure, Failure> {
    match exposure {
        None => Ok(PngExposure::Auto),
        Some(ev) if ev.is_finite() => Ok(PngExposure::Ev(ev)),
        Some(ev) => Err(Failure::argument(format_args!("exposure is {ev}, it must be finite"))),
    }
}
