//! Which surfaces have cells: those where paths end so often that it pays to know the radiosity.
//!
//! A cell takes rays of its own. Where a surface has none, every path that arrives goes on, and takes as many rays as it needs to come to a
//! surface that has, or to be absorbed. Paths arrive in proportion to areas. So surfaces are gone through from the largest on, and get cells as
//! long as that saves more rays than it takes: what the smallest ones take then does not grow with their number.

use rayon::prelude::*;

use crate::scene::{Scene, SurfaceId};

/// What a path that goes on takes at each bounce: a ray of its own, and one to an emitter.
const BOUNCE_WORK: f64 = 2.0;

/// A cell must save so many times the rays that it takes, since it makes values wrong besides, which others must make up for. Above 1;
/// measured over eight scenes, from 1 to 100 times all do about as well.
const WORTH: f64 = 10.0;

/// Areas of the surfaces that reflect, in m^2.
pub(super) struct Areas {
    falling: Vec<f64>,
}

/// What paths and cells take.
pub(super) struct Traffic {
    /// The area that light meets, in m^2.
    pub lit_area: f64,
    /// Of what arrives on surfaces, so much is reflected, 0 to 1.
    pub albedo: f64,
    /// How many paths end in cells.
    pub paths: f64,
    /// The work of a cell, in rays.
    pub cell_work: f64,
}

impl Areas {
    pub fn of_scene(scene: &Scene) -> Self {
        let reflects = |id: &SurfaceId| scene.material_of(*id).reflectance.iter().any(|&rho| rho > 0.0);
        let ids = (0..scene.surfaces().len() as u32).into_par_iter().map(SurfaceId);
        let mut falling: Vec<f64> = ids.filter(reflects).map(|id| scene.surface(id).polygon.area()).collect();
        falling.par_sort_unstable_by(|a, b| b.total_cmp(a));
        Self { falling }
    }

    /// For how many surfaces cells pay, the largest ones.
    pub fn worthwhile(&self, traffic: &Traffic) -> usize {
        let Traffic { lit_area, albedo, paths, cell_work } = *traffic;
        let mut with_cells = 0.0;
        let pays = |area: &&f64| {
            let share = (with_cells / lit_area).min(1.0);
            let bounces = 1.0 / (share + (1.0 - share) * (1.0 - albedo));
            with_cells += **area;
            paths * **area / lit_area * bounces * BOUNCE_WORK >= WORTH * cell_work
        };
        self.falling.iter().take_while(pays).count()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// How many of these areas get cells that take 50 rays each.
    fn count(areas: &[f64], albedo: f64, paths: f64) -> usize {
        let falling = areas.to_vec();
        let lit_area = falling.iter().sum();
        Areas { falling }.worthwhile(&Traffic { lit_area, albedo, paths, cell_work: 50.0 })
    }

    #[test]
    fn large_surfaces_have_cells_and_small_ones_where_paths_are_many() {
        // Six walls, and as much area again in a hundred thousand leaves.
        let areas = [vec![1.0; 6], vec![6e-5; 100_000]].concat();
        assert_eq!(count(&areas, 0.5, 1e5), 6);
        // With so many paths every leaf pays: 1e9 * 5e-6 of them arrive there.
        assert_eq!(count(&areas, 0.5, 1e9), areas.len());
        // Leaves alone: where nearly all light is reflected paths would go on for long, so some have cells, but not all.
        let leaves = vec![1e-5; 100_000];
        assert_eq!(count(&leaves, 0.5, 1e6), 0);
        let some = count(&leaves, 0.99, 1e6);
        assert!(some > 1000 && some < 10_000, "{some}");
        assert_eq!(count(&[], 0.5, 1e6), 0);
    }
}
