//! Where the error is estimated: random points; by energy, more of them where much is reflected.
//!
//! Locally, all area counts alike; where light is on so small a part of it that hardly a point would fall there, as in a room over a wide
//! ground, half of the points do. By energy, much of the error may lie on a small bright area, so leaves are drawn in proportion to area times [`density`]. Cells may show
//! small areas that are much brighter than their leaf: where there are cells, more candidates are drawn than are needed, and some
//! are kept, those on such areas with a higher probability.

use super::norm::ErrorNorm;
use crate::geometry::{sampling, streams};
use crate::hierarchy::{Hierarchy, NodeId};
use crate::paths::Place;
use crate::scene::{Scene, SurfaceId};
use crate::sweep::Radiosity;

/// Candidates for each point that is kept, where there are cells.
const CANDIDATES: usize = 16;

/// A candidate counts as brighter than its leaf from so many times the leaf's density on; less may be noise of the cells.
const MUCH_BRIGHTER: f64 = 4.0;

/// Of the lit part of the area less than this is rare: of the first points hardly some would lie there.
const RARE: f64 = 1.0 / 64.0;

/// A leaf that reflects less than this part of the radiosity where light is, in W/m^2, counts as dark for that.
const DARK: f64 = 1e-3;

/// A point that was drawn.
#[derive(Clone, Copy)]
pub(super) struct ErrorPoint {
    pub place: Place,
    /// The area in m^2 that it stands for if it is the only point.
    pub stands_for: f64,
    /// The density on the leaf where it lies.
    density: f64,
}

/// Where points may lie, and how bright it is there.
pub(super) struct Surroundings<'a> {
    pub scene: &'a Scene,
    pub hierarchy: &'a Hierarchy,
    /// Radiosities of the leaves.
    pub radiosity: &'a Radiosity,
}

impl Surroundings<'_> {
    /// Points on leaves that reflect, in the order of the leaves in the tree. `reflected`, where there are cells, gives what is
    /// reflected at a place by the cells, in W/m^2 in the brightest channel.
    pub fn sampled_points(
        &self,
        norm: ErrorNorm,
        count: usize,
        seed: u64,
        reflected: Option<&dyn Fn(&Place) -> f64>,
    ) -> Vec<ErrorPoint> {
        let reflected = reflected.filter(|_| norm == ErrorNorm::Energy);
        let Some(reflected) = reflected else { return self.sampled_on_leaves(norm, count, seed) };

        // Candidates, and how often each should be kept relative to others.
        let candidates = self.sampled_on_leaves(norm, CANDIDATES * count, seed);
        let mean = self.radiosity.reflected_rms(self.scene, self.hierarchy);
        let brighter = |of: &ErrorPoint| density(reflected(&of.place), mean) / of.density;
        let chances: Vec<f64> = candidates.iter().map(|of| (brighter(of) / MUCH_BRIGHTER).max(1.0)).collect();
        let all: f64 = chances.iter().sum();

        // Systematic sampling among them.
        let drawn = candidates.len() as f64;
        let mut strata = SystematicSampling { count, seed, total: all, ..SystematicSampling::default() };
        let mut points = Vec::with_capacity(count);
        for (of, chance) in candidates.into_iter().zip(chances) {
            strata.step(chance, |draw| {
                let stands_for = of.stands_for * all / drawn / chance;
                points.push(ErrorPoint { place: Place { seed: draw, ..of.place }, stands_for, ..of });
            });
        }
        points
    }

    /// Points drawn by the radiosities of the leaves alone.
    fn sampled_on_leaves(&self, norm: ErrorNorm, count: usize, seed: u64) -> Vec<ErrorPoint> {
        let Self { scene, hierarchy, radiosity } = *self;
        let surface_of = |leaf: NodeId| SurfaceId(hierarchy.node(leaf).surface);
        let mean = radiosity.reflected_rms(scene, hierarchy);
        let reflects = |leaf: NodeId| scene.material_of(surface_of(leaf)).reflectance.iter().any(|&rho| rho > 0.0);
        let leaves: Vec<NodeId> = hierarchy.leaves_in_order().into_iter().filter(|&leaf| reflects(leaf)).collect();
        let reflected = |leaf: NodeId| {
            let exitance = &scene.material_of(surface_of(leaf)).exitance[..scene.deciding()];
            radiosity.of(leaf).iter().zip(exitance).map(|(b, e)| b - e).fold(0.0, f64::max)
        };

        // Where light is on next to nothing, as many points lie there as elsewhere.
        let area = |is_counted: &dyn Fn(NodeId) -> bool| {
            leaves.iter().filter(|&&leaf| is_counted(leaf)).map(|&leaf| hierarchy.area(leaf)).sum::<f64>()
        };
        let power = |exponent: i32| leaves.iter().map(|&leaf| hierarchy.area(leaf) * reflected(leaf).powi(exponent)).sum::<f64>();
        let typical = power(2) / power(1).max(f64::MIN_POSITIVE);
        let is_lit = |leaf: NodeId| typical > 0.0 && reflected(leaf) > DARK * typical;
        let part = area(&is_lit) / area(&|_| true);
        let of_lit = if part > 0.0 && part < RARE { (1.0 - part) / part } else { 1.0 };
        let density = |leaf: NodeId| match norm {
            ErrorNorm::Energy => density(reflected(leaf), mean),
            ErrorNorm::Local if is_lit(leaf) => of_lit,
            ErrorNorm::Local => 1.0,
        };
        let total: f64 = leaves.iter().map(|&leaf| hierarchy.area(leaf) * density(leaf)).sum();

        let mut strata = SystematicSampling { count, seed, total, ..SystematicSampling::default() };
        let mut points = Vec::with_capacity(count);
        for leaf in leaves {
            let density = density(leaf);
            strata.step(hierarchy.area(leaf) * density, |draw| {
                let [u, v] = [streams::SECOND, streams::THIRD].map(|number| sampling::unit(sampling::hash(draw, number)));
                let place = Place { point: hierarchy.facet(leaf).point_at(u, v), surface: surface_of(leaf), seed: draw };
                points.push(ErrorPoint { place, stands_for: total / density, density });
            });
        }
        points
    }
}

/// The density of points where so much is reflected, in W/m^2: in proportion to the squared error if the error is a fixed part of
/// what is reflected, and nowhere less than `mean`.
fn density(reflected: f64, mean: f64) -> f64 {
    if mean > 0.0 { mean + reflected * reflected / mean } else { 1.0 }
}

/// Systematic sampling: draws from a sequence by weight, one random draw in each of `count` strata of the sum of weights.
#[derive(Default)]
struct SystematicSampling {
    count: usize,
    seed: u64,
    /// The sum of all weights.
    total: f64,
    /// The sum of the weights so far.
    above: f64,
    /// Draws so far.
    drawn: u64,
}

impl SystematicSampling {
    /// Goes on to the next item, of this weight, and calls `draw` as often as it is drawn, each time with a random number.
    fn step(&mut self, weight: f64, mut draw: impl FnMut(u64)) {
        self.above += weight;
        while (self.drawn as usize) < self.count {
            let random = sampling::hash(self.seed, self.drawn);
            if (self.drawn as f64 + sampling::unit(random)) / self.count as f64 * self.total >= self.above {
                break;
            }
            self.drawn += 1;
            draw(random);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::cells::CellRadiosities;
    use crate::error::ResidualGather;
    use crate::paths::{Brightness, CellSize, LightPaths, Resolution};
    use crate::scene::import::{ImportOptions, read_scene};
    use crate::sweep::Exposure;
    use crate::transmittance::Rays;
    use crate::visibility::{Backend, OccluderMesh, build};

    /// However unevenly points lie, they stand for all of the area that reflects; and more lie where only cells know that it is
    /// bright.
    #[test]
    fn points_stand_for_all_area_and_more_lie_where_cells_are_bright() {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/cornell.obj");
        let scene = read_scene(&file, &ImportOptions::default()).unwrap().scene;
        let hierarchy = Hierarchy::new(&scene);
        let visibility = build(Backend::default(), &OccluderMesh::of_scene(&scene)).unwrap();
        let rays = Rays::new(&*visibility, &scene);
        let mut exposure = Exposure::default();
        exposure.grow(&scene, &hierarchy, &rays, 0, &|| false);

        // Leaves are all as dim as each other; cells know the light.
        let mut radiosity = Radiosity::emitted(&scene, &hierarchy, &exposure);
        let surfaces = || (0..scene.surfaces().len() as u32).map(SurfaceId);
        let reflects = |surface: &SurfaceId| scene.material_of(*surface).reflectance.iter().any(|&rho| rho > 0.0);
        for surface in surfaces() {
            let exitance = &scene.material_of(surface).exitance;
            radiosity.of_mut(hierarchy.node_of(surface)).iter_mut().zip(exitance).for_each(|(b, exitance)| *b = exitance + 0.02);
        }
        let resolution = Resolution { size: CellSize { side: 0.03, past_unresolved: false, most_surfaces: usize::MAX }, rays: 16 };
        let paths = LightPaths::new(&scene, &rays, &Brightness::even(&scene), resolution.size, &|| false);
        let [of_values, onward] = [1, 2].map(|seed| CellRadiosities::solve(&paths, &resolution, seed, &|| false).unwrap());
        let gather = ResidualGather { paths: &paths, of_values: &of_values, onward: &onward, vertex_rays: 1 };
        let reflected = |place: &Place| gather.estimate_reflected(place);
        let around = Surroundings { scene: &scene, hierarchy: &hierarchy, radiosity: &radiosity };

        let area: f64 = surfaces().filter(reflects).map(|surface| scene.surface(surface).polygon.area()).sum();
        let (count, seeds) = (4096, 16);
        let mean_over = |drawn: &[Vec<ErrorPoint>], of: &dyn Fn(&ErrorPoint) -> f64| {
            drawn.iter().flatten().map(of).sum::<f64>() / (count * seeds as usize) as f64
        };
        let by_leaves: Vec<_> = (0..seeds).map(|seed| around.sampled_points(ErrorNorm::Energy, count, seed, None)).collect();
        let by_cells: Vec<_> =
            (0..seeds).map(|seed| around.sampled_points(ErrorNorm::Energy, count, seed, Some(&reflected))).collect();
        // By cells it scatters by 3% from seed to seed, so the mean of 16 seeds by less than 1%.
        for (drawn, tolerance) in [(&by_leaves, 1e-12), (&by_cells, 0.02)] {
            let found = mean_over(drawn, &|of| of.stands_for);
            assert!((found / area - 1.0).abs() < tolerance, "{found} for {area}");
        }
        let [dim, bright] = [&by_leaves, &by_cells].map(|drawn| mean_over(drawn, &|of| reflected(&of.place)));
        assert!(bright > 1.5 * dim, "{bright} and {dim}");
    }
}
