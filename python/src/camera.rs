//! Cameras.

use patchlight::picture::{Camera, CameraRequest};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::vector;
use crate::errors::Failure;

/// A pinhole camera.
///
/// eye, target, up: three coordinates each, in metres; up is not parallel to the view.
/// field_of_view: vertical, in degrees, above 0 and below 180. width, height: in pixels.
#[pyclass(frozen, eq, module = "patchlight", name = "Camera")]
#[derive(PartialEq)]
pub struct CameraView(pub Camera);

#[pymethods]
impl CameraView {
    #[new]
    #[pyo3(signature = (eye, target, up, field_of_view=45.0, *, width=640, height=480))]
    fn new(
        eye: &Bound<'_, PyAny>,
        target: &Bound<'_, PyAny>,
        up: &Bound<'_, PyAny>,
        field_of_view: f64,
        width: u32,
        height: u32,
    ) -> PyResult<Self> {
        let (eye, target, up) = (vector(eye, "eye")?, vector(target, "target")?, vector(up, "up")?);
        let camera = Camera { eye, target, up, field_of_view_degrees: field_of_view, width, height };
        camera.validate().map_err(Failure::from)?;
        Ok(Self(camera))
    }

    /// Where it stands, in metres.
    #[getter]
    fn eye(&self) -> [f64; 3] {
        self.0.eye
    }

    /// What is at the centre of the picture.
    #[getter]
    fn target(&self) -> [f64; 3] {
        self.0.target
    }

    /// What points up in the picture.
    #[getter]
    fn up(&self) -> [f64; 3] {
        self.0.up
    }

    /// Vertical field of view in degrees.
    #[getter]
    fn field_of_view(&self) -> f64 {
        self.0.field_of_view_degrees
    }

    /// Width of the picture in pixels.
    #[getter]
    fn width(&self) -> u32 {
        self.0.width
    }

    /// Height of the picture in pixels.
    #[getter]
    fn height(&self) -> u32 {
        self.0.height
    }

    /// The view as text, which `patchlight render --camera` and `Solution.render` take.
    fn __str__(&self) -> String {
        self.0.to_string()
    }

    fn __repr__(&self) -> String {
        let Camera { eye, target, up, field_of_view_degrees, width, height } = self.0;
        format!("patchlight.Camera({eye:?}, {target:?}, {up:?}, {field_of_view_degrees:?}, width={width}, height={height})")
    }
}

impl CameraView {
    /// What a caller says of a view.
    pub fn request(view: Option<&Bound<'_, PyDict>>) -> PyResult<CameraRequest> {
        let mut request = CameraRequest::default();
        for (key, value) in view.into_iter().flatten().filter(|(_, value)| !value.is_none()) {
            match key.extract::<String>()?.as_str() {
                "eye" => request.eye = Some(vector(&value, "eye")?),
                "target" => request.target = Some(vector(&value, "target")?),
                "up" => request.up = Some(vector(&value, "up")?),
                "field_of_view" => request.field_of_view_degrees = Some(value.extract()?),
                other => {
                    let message = format!("camera has no '{other}', but eye, target, up, field_of_view, width and height");
                    return Err(Failure::argument(message).into());
                }
            }
        }
        Ok(request)
    }
}
