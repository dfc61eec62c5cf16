//! What stands behind a solution and its parts.

use patchlight::output::Provenance;
use patchlight::picture::{Camera, CameraRequest};
use patchlight::pipeline::Evaluator;
use patchlight::solve::{ErrorReport, SolveReport};
use pyo3::prelude::*;

use crate::camera::CameraView;
use crate::errors::Failure;
use crate::workers::Home;

/// A solution with what is needed to look at it.
pub struct Lit {
    /// Always there, but while it is dropped.
    evaluator: Option<Evaluator>,
    pub known: Known,
    home: Home,
}

/// What is known of how it came to be.
pub enum Known {
    /// It was solved.
    Solved(Box<Report>),
    /// Solved again for other materials, with this error.
    Estimated(ErrorReport),
    /// Light groups were weighted, with this error by energy.
    Weighted(f64),
    /// It was read from a file.
    Nothing,
}

/// What the solve told.
pub struct Report {
    pub json: String,
    pub solve: SolveReport,
}

impl Lit {
    pub fn new(evaluator: Evaluator, known: Known) -> Self {
        Self { evaluator: Some(evaluator), known, home: Home::here() }
    }

    /// What the solve told, if it was solved.
    pub fn report(&self) -> Option<&Report> {
        if let Known::Solved(report) = &self.known { Some(report) } else { None }
    }

    /// The evaluator, where its threads are.
    pub fn evaluator(&self) -> Result<&Evaluator, Failure> {
        match &self.evaluator {
            Some(evaluator) if !self.home.is_elsewhere() => Ok(evaluator),
            _ => Err(Failure::resource(
                "this solution belongs to the process that this one was forked from: save it there and load it here, or start processes \
                 with the method 'spawn'",
            )),
        }
    }

    /// What files tell of where they come from.
    pub fn provenance(&self) -> Result<Provenance, Failure> {
        Ok(Provenance::new(self.evaluator()?.solution().options()))
    }

    /// The camera that a caller wants: one that was made, or a view as text or none, put in place of the default view where it is silent.
    pub fn camera(&self, py: Python<'_>, wanted: Option<&Bound<'_, PyAny>>, width: u32, height: u32) -> PyResult<Camera> {
        let Some(wanted) = wanted else { return self.camera_of(py, &CameraRequest::default(), width, height) };
        if let Ok(camera) = wanted.cast::<CameraView>() {
            return Ok(camera.get().0);
        }
        let text: String = wanted.extract().map_err(|_| Failure::argument("camera must be a Camera, a str or None"))?;
        self.camera_of(py, &text.parse().map_err(Failure::from)?, width, height)
    }

    /// The camera of a request, put in place of the default view where that is silent.
    pub fn camera_of(&self, py: Python<'_>, request: &CameraRequest, width: u32, height: u32) -> PyResult<Camera> {
        let evaluator = self.evaluator()?;
        let (target, up) = ([0.0, 0.0, 1.0], [0.0, 1.0, 0.0]);
        Camera { eye: [0.0; 3], target, up, field_of_view_degrees: 45.0, width, height }.validate().map_err(Failure::from)?;
        let default = py.detach(|| evaluator.default_camera(width, height));
        Ok(request.apply_to(default).map_err(Failure::from)?)
    }
}

/// Threads that are not there cannot be waited for.
impl Drop for Lit {
    fn drop(&mut self) {
        if self.home.is_elsewhere() {
            std::mem::forget(self.evaluator.take());
        }
    }
}
