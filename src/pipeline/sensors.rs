//! What sensors in space measure.

use super::Evaluator;
use crate::progress::Observer;
use crate::scene::SurfacePoint;
use crate::transmittance::Rays;
use crate::values::{self, Irradiances};

impl Evaluator {
    /// The irradiance at sensors, in their order: points anywhere, on surfaces or off them, each with the normal of the side that light arrives at.
    /// Cancelled by the observer, it returns `None`.
    ///
    /// A polygon that a sensor touches hides nothing from it, as for all rays (`visibility`).
    pub fn irradiances_at(&self, sensors: &[SurfacePoint], observer: &dyn Observer) -> Option<Irradiances> {
        // What is proved to hide nothing is so between surfaces: a sensor may stand behind them.
        let rays = Rays::new(&*self.visibility, self.solution.scene()).asking_in_clear_scenes();
        self.pool.install(|| {
            let paths = self.solution.light_paths(&rays, &|| observer.cancelled());
            let gather = self.solution.gather_at_points(&rays, paths.as_ref());
            values::irradiances_at(&gather, self.solution.error_bars, sensors, observer)
        })
    }
}
