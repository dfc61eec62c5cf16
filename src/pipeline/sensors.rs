//! What sensors in space measure.

use glam::DVec3;

use super::Evaluator;
use crate::picture::{MeasuringPlane, PlaneError, PlaneRequest};
use crate::progress::Observer;
use crate::scene::{SurfaceId, SurfacePoint};
use crate::values::{self, Irradiances};
use crate::visibility::{Hit, NO_PLANE, Ray};

impl Evaluator {
    /// The irradiance at sensors, in their order: points anywhere, on surfaces or off them, each with the normal of the side that light arrives at.
    /// Once the observer cancels, no more are measured.
    ///
    /// A polygon that a sensor touches hides nothing from it, as for all rays (`visibility`).
    pub fn irradiances_at(&self, sensors: &[SurfacePoint], observer: &dyn Observer) -> Irradiances {
        // What is proved to hide nothing is so between surfaces: a sensor may stand behind them.
        let rays = self.rays().asking_in_clear_scenes();
        self.pool.install(|| {
            let paths = self.solution.light_paths(&rays, &|| observer.cancelled());
            let gather = self.solution.gather_at_points(&rays, paths.as_ref());
            values::irradiances_at(&gather, self.solution.error_bars, sensors, observer)
        })
    }
    /// A measuring plane, and which of its sensors hang in a room: of one that is given in full all, of a horizontal one those that see a front below,
    /// and none but fronts above. The others are inside of something, or outside of everything.
    ///
    /// # Errors
    /// See [`PlaneError`].
    pub fn measuring_plane(&self, request: &PlaneRequest) -> Result<(MeasuringPlane, Vec<bool>), PlaneError> {
        let scene = self.solution.scene();
        let plane = request.in_scene(scene)?;
        let sensors = plane.sensors();
        if matches!(request, PlaneRequest::Given(_)) {
            return Ok((plane, vec![true; sensors.len()]));
        }

        let rays = self.rays();
        let look = |sign: f64| {
            let ray = |sensor: &SurfacePoint| {
                let direction = (sign * DVec3::from(sensor.normal)).to_array();
                Ray { origin: sensor.position, direction, origin_plane: NO_PLANE }
            };
            let mut hits = Vec::new();
            rays.first_hits(&sensors.iter().map(ray).collect::<Vec<Ray>>(), &mut hits);
            hits
        };
        let (above, below) = (look(1.0), look(-1.0));
        let is_inside = |(number, sensor): (usize, &SurfacePoint)| {
            let up = DVec3::from(sensor.normal);
            let is_front = |hit: Hit, towards: DVec3| scene.side_towards(SurfaceId(hit.surface), towards).is_some();
            below[number].is_some_and(|hit| is_front(hit, up)) && above[number].is_none_or(|hit| is_front(hit, -up))
        };
        let is_inside = sensors.iter().enumerate().map(is_inside).collect();
        Ok((plane, is_inside))
    }
}
