//! Pictures of irradiance, and lines over pictures.

use std::time::Instant;

use glam::DVec3;

use super::{Evaluator, PipelineError};
use crate::discontinuities::{self, CurveSegment};
use crate::mesh::LitMesh;
use crate::picture::{self, Camera, Image, Line, Marks, Shown};
use crate::progress::Observer;
use crate::scene::SurfaceId;
use crate::solve::RunOptions;

impl Evaluator {
    /// A picture of irradiance over pi, 0 where nothing is reflected: from the values, or of a lit mesh. Cancelled by the observer, it returns `None`.
    ///
    /// # Errors
    /// As [`Evaluator::render`].
    pub fn render_irradiance(
        &self,
        mesh: Option<&LitMesh>,
        camera: &Camera,
        observer: &dyn Observer,
    ) -> Result<Option<Image>, PipelineError> {
        match mesh {
            Some(mesh) => self.render_mesh_shown(mesh, Shown::Irradiance, camera, observer),
            None => Ok(self.render_shown(Shown::Irradiance, camera, None, observer)?.map(|(image, _)| image)),
        }
    }

    /// Like [`Evaluator::render`], within the time of `run`: once that is over, pixels that were not taken show one beside them, and their errors are
    /// not known. With the part of the pixels that were taken. A thousand pixels are taken whatever the time.
    ///
    /// # Errors
    /// As [`Evaluator::render`].
    pub fn render_within(
        &self,
        camera: &Camera,
        run: &RunOptions,
        observer: &dyn Observer,
    ) -> Result<Option<(Image, f64)>, PipelineError> {
        self.render_shown_within(Shown::Radiance, camera, run, observer)
    }

    /// The same of irradiance over pi.
    ///
    /// # Errors
    /// As [`Evaluator::render`].
    pub fn render_irradiance_within(
        &self,
        camera: &Camera,
        run: &RunOptions,
        observer: &dyn Observer,
    ) -> Result<Option<(Image, f64)>, PipelineError> {
        self.render_shown_within(Shown::Irradiance, camera, run, observer)
    }

    fn render_shown_within(
        &self,
        shown: Shown,
        camera: &Camera,
        run: &RunOptions,
        observer: &dyn Observer,
    ) -> Result<Option<(Image, f64)>, PipelineError> {
        run.validate()?;
        self.render_shown(shown, camera, run.deadline_from(Instant::now()), observer)
    }

    /// A picture from the values at what its pixels see, and the part of the pixels that were taken by a deadline.
    pub(super) fn render_shown(
        &self,
        shown: Shown,
        camera: &Camera,
        deadline: Option<Instant>,
        observer: &dyn Observer,
    ) -> Result<Option<(Image, f64)>, PipelineError> {
        let through = camera.rays()?;
        let rays = self.rays();
        let size = [camera.width, camera.height];
        Ok(self.pool.install(|| {
            let paths = self.solution.light_paths(&rays, &|| observer.cancelled());
            let gather = self.solution.gather_at_points(&rays, paths.as_ref());
            picture::render((&gather, self.solution.error_bars), &rays, (&through, size), shown, deadline, observer)
        }))
    }

    /// The edges of the elements of a lit mesh, where a camera sees them. Cancelled by the observer, it returns `None`.
    ///
    /// # Errors
    /// As [`Evaluator::render`].
    pub fn mark_mesh(&self, mesh: &LitMesh, camera: &Camera, observer: &dyn Observer) -> Result<Option<Marks>, PipelineError> {
        /// Orange is seen on bright and on dark surfaces.
        const COLOUR: [u8; 3] = [255, 120, 0];
        let mut lines = Vec::new();
        mesh.for_each_element(self.solution.scene(), |surface, [a, b, c, ..], _| {
            let edges = [[a, b], [b, c], [c, a]].map(|ends| ends.map(DVec3::from));
            lines.extend(edges.map(|ends| Line { ends, surface: SurfaceId(surface), colour: COLOUR }));
        });
        self.draw(&lines, camera, observer)
    }

    /// The discontinuities of the light of emitters, and where shadows of lights that are no surfaces end, the sharpest last; what changes irradiance by less
    /// than `tolerance` of the largest exitance, or of the most that lights bring to an element, is left out. Cancelled by the observer, it returns `None`.
    pub fn curves(&self, tolerance: f64, observer: &dyn Observer) -> Option<Vec<CurveSegment>> {
        let (scene, brought, stop) = (self.solution.scene(), tolerance * self.solution.most_by_lights(), || observer.cancelled());
        let [of_emitters, of_lights] = self.pool.install(|| {
            let of_emitters = discontinuities::of_emitters_until(scene, tolerance, &stop);
            [of_emitters, discontinuities::of_lights_until(scene, brought, &stop)]
        });
        let mut curves = Vec::new();
        for surface in 0..scene.surfaces().len() as u32 {
            let segments = [&of_emitters, &of_lights].into_iter().flat_map(|found| found.of(SurfaceId(surface)));
            curves.extend(segments.map(|segment| CurveSegment { surface, degree: segment.degree, ends: segment.ends() }));
        }
        curves.sort_by_key(|curve| std::cmp::Reverse(curve.degree));
        (!stop()).then_some(curves)
    }

    /// The [`Evaluator::curves`] that a camera sees, the sharpest over others, each degree in [its colour](crate::discontinuities::Degree::colour). Cancelled by the observer, it
    /// returns `None`.
    ///
    /// # Errors
    /// As [`Evaluator::render`].
    pub fn mark_curves(&self, tolerance: f64, camera: &Camera, observer: &dyn Observer) -> Result<Option<Marks>, PipelineError> {
        camera.validate()?;
        let Some(curves) = self.curves(tolerance, observer) else { return Ok(None) };
        let line = |curve: CurveSegment| Line {
            ends: curve.ends.map(DVec3::from),
            surface: SurfaceId(curve.surface),
            colour: curve.degree.colour(),
        };
        self.draw(&curves.into_iter().map(line).collect::<Vec<Line>>(), camera, observer)
    }

    fn draw(&self, lines: &[Line], camera: &Camera, observer: &dyn Observer) -> Result<Option<Marks>, PipelineError> {
        let (through, scene) = (camera.rays()?, self.solution.scene());
        let rays = self.rays();
        let (seen, stop) = ((&through, [camera.width, camera.height]), || observer.cancelled());
        Ok(self.pool.install(|| picture::draw_lines(scene, lines, &rays, seen, &stop)))
    }
}
