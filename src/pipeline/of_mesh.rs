//! What is read off a lit mesh: values and pictures.

use std::borrow::Cow;
use std::time::Instant;

use glam::DVec3;
use rayon::prelude::*;

use super::{Evaluator, PipelineError};
use crate::mesh::{LEAST_GATHERS, LitMesh, MeshIndex, MeshLimit, MeshReader};
use crate::picture::{self, Camera, Image, Shown};
use crate::progress::{Observer, Progress, Stop};
use crate::scene::{SurfaceId, SurfacePoint};
use crate::solve::{RunOptions, Solution, StoppedBy};
use crate::values::{self, Values};

/// Points that are read between two looks at whether to stop: some milliseconds.
const READ_AT_ONCE: usize = 1024;

/// A mesh of what a camera sees, and why it was refined no further.
#[derive(Clone, Debug, PartialEq)]
pub struct ViewMesh {
    /// The mesh; `None` if the observer cancelled, or a limit was reached before there was one.
    pub mesh: Option<LitMesh>,
    /// Whether it is as good as was asked for, or what ended it before.
    pub stopped_by: StoppedBy,
}

/// Says that an observer cancels once a time is over.
struct Until<'a> {
    observer: &'a dyn Observer,
    deadline: Option<Instant>,
}

impl Observer for Until<'_> {
    fn progress(&self, progress: &Progress) {
        self.observer.progress(progress);
    }

    fn cancelled(&self) -> bool {
        self.observer.cancelled() || self.deadline.is_some_and(|deadline| Instant::now() >= deadline)
    }
}

impl Evaluator {
    /// The lit mesh of the solution, if it was solved with [`SolveOptions::lit_mesh`](crate::solve::SolveOptions::lit_mesh).
    pub fn mesh(&self) -> Option<&LitMesh> {
        self.solution.mesh()
    }

    /// Radiosities at points, in their order, read off the lit mesh of the solution; `None` if it has none. They are kept within the bounds where
    /// there are any. A point takes some microseconds. Standard errors are those of elements, see [`MeshPart::standard_errors`](crate::mesh::MeshPart::standard_errors), shared out by the light
    /// of the channels.
    pub fn mesh_values_at(&self, points: &[SurfacePoint]) -> Option<Values> {
        let (surfaces, numbers) = self.read(self.mesh()?, points, &|| false);
        let mut values = Values::of_numbers(self.solution.scene(), surfaces.into_iter(), numbers);
        if let Some(bounds) = self.bounds_at(points) {
            bounds.confine(&mut values.radiosity);
        }
        Some(values)
    }

    /// Makes a lit mesh from the values at points, whether the solution has one or not. It is refined until no more than `error`, in the norm of the
    /// options, is claimed for what it differs from these, or until only their noise is left. Cancelled by the observer, it returns `None`.
    pub fn lit_mesh(&self, error: f64, observer: &dyn Observer) -> Option<LitMesh> {
        let rays = self.rays();
        self.pool.install(|| self.solution.lit_mesh(&rays, error, observer))
    }

    /// Makes a lit mesh of what a camera sees, for a picture of that: there are elements on surfaces that the pixels show, sized by them, and `error` is
    /// the largest that may be claimed for what the function differs from the values at points, in the norm of the options, over the pixels in place of
    /// the area. Cancelled by the observer, it returns `None`.
    ///
    /// # Errors
    /// As [`Evaluator::render`].
    pub fn view_mesh(&self, camera: &Camera, error: f64, observer: &dyn Observer) -> Result<Option<LitMesh>, PipelineError> {
        Ok(self.view_mesh_within(camera, error, &RunOptions::default(), observer)?.mesh)
    }

    /// The same within the time and the memory of `run`, of which the picture itself is to be taken off beforehand. Where they end, the mesh is as good as
    /// it got, and judged; where they end before that, there is none.
    ///
    /// # Errors
    /// As [`Evaluator::render`]; [`PipelineError::Options`] for a time that is none.
    pub fn view_mesh_within(
        &self,
        camera: &Camera,
        error: f64,
        run: &RunOptions,
        observer: &dyn Observer,
    ) -> Result<ViewMesh, PipelineError> {
        run.validate()?;
        let (through, scene, size) = (camera.rays()?, self.solution.scene(), [camera.width, camera.height]);
        let (rays, deadline) = (self.rays(), run.deadline_from(Instant::now()));
        if !self.solution.has_room_for_view(size[0] as usize * size[1] as usize, run) {
            return Ok(ViewMesh { mesh: None, stopped_by: StoppedBy::Memory });
        }
        let (mesh, limit) = self.pool.install(|| {
            let until = Until { observer, deadline };
            match picture::seen_surfaces(scene, &rays, (&through, size), &until) {
                Some(seen) => self.solution.lit_mesh_of_view((&rays, &seen), error, (run, deadline), observer),
                None => (None, Some(MeshLimit::Time)),
            }
        });
        let is_reached = mesh.as_ref().is_some_and(|mesh| mesh.claimed <= error);
        let stopped_by = match limit {
            _ if observer.cancelled() => StoppedBy::Cancelled,
            _ if is_reached => StoppedBy::Error,
            Some(MeshLimit::Memory) => StoppedBy::Memory,
            Some(MeshLimit::Time) => StoppedBy::Time,
            None => StoppedBy::Exhausted,
        };
        Ok(ViewMesh { mesh: mesh.filter(|_| stopped_by != StoppedBy::Cancelled), stopped_by })
    }

    /// Whether a mesh of what a camera sees takes less than to gather values for each of its pixels: it is judged at some thousand points, whatever the
    /// picture is.
    pub fn is_view_mesh_cheaper(&self, camera: &Camera) -> bool {
        let pixels = u64::from(camera.width) * u64::from(camera.height);
        pixels > LEAST_GATHERS as u64
    }

    /// The radiosities of a lit mesh of this solution at points, by point and channel; NaN where a point lies on no surface.
    pub fn values_of_mesh(&self, mesh: &LitMesh, points: &[SurfacePoint]) -> Vec<f32> {
        self.read(mesh, points, &|| false).1.into_iter().map(|[radiosity, _]| radiosity).collect()
    }

    /// The same; cancelled by the observer, it returns `None`.
    pub fn values_of_mesh_observed(&self, mesh: &LitMesh, points: &[SurfacePoint], observer: &dyn Observer) -> Option<Vec<f32>> {
        let (_, numbers) = self.read(mesh, points, &|| observer.cancelled());
        (!observer.cancelled()).then(|| numbers.into_iter().map(|[radiosity, _]| radiosity).collect())
    }

    /// Reads a mesh at points: the surface that each lies on, and radiosities with their standard errors by point and channel. Once it is stopped,
    /// nothing more.
    fn read(&self, mesh: &LitMesh, points: &[SurfacePoint], stop: Stop<'_>) -> (Vec<Option<SurfaceId>>, Vec<[f32; 2]>) {
        let Solution { scene, hierarchy, .. } = &self.solution;
        let (reader, tolerance) = (self.reader(mesh), values::tolerance(scene));
        let of_some = |some: &[SurfacePoint]| {
            let (mut surfaces, mut numbers) = (Vec::new(), Vec::new());
            let (mut radiosity, mut errors) = (vec![f64::NAN; scene.channels()], vec![f64::NAN; scene.channels()]);
            for point in if stop() { &[] } else { some } {
                let (position, normal) = (DVec3::from(point.position), DVec3::from(point.normal));
                let surface = hierarchy.surface_at(position, normal, tolerance);
                match surface {
                    Some(surface) => {
                        reader.radiosity_at(position, surface, &mut radiosity);
                        reader.standard_errors_at(position, surface, &radiosity, &mut errors);
                    }
                    None => [&mut radiosity, &mut errors].into_iter().for_each(|of| of.fill(f64::NAN)),
                }
                surfaces.push(surface);
                numbers.extend(radiosity.iter().zip(&errors).map(|(&b, &error)| [b as f32, error as f32]));
            }
            (surfaces, numbers)
        };
        let parts: Vec<_> = self.pool.install(|| points.par_chunks(READ_AT_ONCE).map(of_some).collect());
        let (mut surfaces, mut numbers) = (Vec::with_capacity(points.len()), Vec::with_capacity(points.len() * scene.channels()));
        for (of_some, numbers_of_some) in parts {
            surfaces.extend(of_some);
            numbers.extend(numbers_of_some);
        }
        (surfaces, numbers)
    }

    /// A picture of a lit mesh of this solution, in linear radiance, with the standard errors of its elements where these are known. Cancelled by the observer, it returns `None`.
    ///
    /// # Errors
    /// As [`Evaluator::render`].
    pub fn render_mesh(&self, mesh: &LitMesh, camera: &Camera, observer: &dyn Observer) -> Result<Option<Image>, PipelineError> {
        self.render_mesh_shown(mesh, Shown::Radiance, camera, observer)
    }

    /// A picture of something that a mesh tells.
    pub(super) fn render_mesh_shown(
        &self,
        mesh: &LitMesh,
        shown: Shown,
        camera: &Camera,
        observer: &dyn Observer,
    ) -> Result<Option<Image>, PipelineError> {
        let (through, scene) = (camera.rays()?, self.solution.scene());
        let (rays, reader) = (self.rays(), self.reader(mesh));
        let size = [camera.width, camera.height];
        Ok(self.pool.install(|| picture::render_mesh(scene, &reader, &rays, (&through, size), shown, observer)))
    }

    /// Reads a mesh; of the solution's own the index is made once.
    pub(super) fn reader<'a>(&'a self, mesh: &'a LitMesh) -> MeshReader<'a> {
        let scene = self.solution.scene();
        let is_own = self.mesh().is_some_and(|own| std::ptr::eq(own, mesh));
        let index = if is_own {
            Cow::Borrowed(self.mesh_index.get_or_init(|| MeshIndex::new(scene, mesh)))
        } else {
            Cow::Owned(MeshIndex::new(scene, mesh))
        };
        MeshReader::new(scene, mesh, index)
    }
}
