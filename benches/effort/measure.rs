//! How each part of the error falls in one scene.

use patchlight::pipeline::Evaluator;
use patchlight::scene::{Scene, SurfaceId, SurfacePoint};
use patchlight::solve::{SolveOptions, Solver};

use super::rooms::{self, points_of, regathered};
use super::triangles::Random;

/// Where values are compared.
const POINTS: usize = 512;

/// What is tried: rays to a point, positions of cells, tolerances of links.
const RAYS: [u32; 4] = [16, 64, 256, 1024];
const POSITIONS: [u64; 3] = [1024, 4096, 16_384];
const POSITION_RAYS: [u32; 3] = [4, 16, 64];
const TOLERANCES: [f64; 5] = [16.0, 4.0, 1.0, 0.25, 0.0625];

/// Rays to a point where their noise must not show.
const MANY_RAYS: u32 = 2048;

/// Scenes that would take more links are measured at fewer tolerances.
const MOST_LINKS: u64 = 400_000;

/// The square of a part of the error, or a number of links, against what is spent.
pub type Curve = Vec<(f64, f64)>;

/// All curves of a scene.
pub struct Measured {
    /// The square of the noise of values against rays to a point.
    pub noise_over_links: Curve,
    pub noise_over_cells: Curve,
    /// The square of what cells make wrong against positions, and against paths from each.
    pub positions: Curve,
    pub position_rays: Curve,
    /// The square of what links leave wrong against the tolerance: leaves as swept, and gathered anew.
    pub as_swept: Curve,
    pub links: Curve,
    /// Links against the tolerance.
    pub link_counts: Curve,
}

impl Measured {
    pub fn of(scene: &Scene) -> Self {
        let with = Points::of(scene);
        let coarse = SolveOptions { error: 0.9, ..SolveOptions::default() };
        let over_cells = |positions, rays, seed| {
            let mut options = SolveOptions { solver: Solver::Cells, seed, ..coarse.clone() };
            options.cells.positions = Some(positions);
            options.cells.position_rays = Some(rays);
            rooms::solve(scene.clone(), &options).0
        };

        // Cells, held against ones from other positions along the same paths.
        let (positions, rays) = (POSITIONS[1], POSITION_RAYS[1]);
        let reference = over_cells(4 * POSITIONS[2], POSITION_RAYS[2], 977);
        let truth = with.values(&reference, MANY_RAYS, 1);
        let wrong = |solved: &Evaluator| {
            let values = with.values(solved, MANY_RAYS, 1);
            with.product(&values, &values, [&truth, &truth])
        };
        let by_positions = POSITIONS.map(|positions| (positions as f64, wrong(&over_cells(positions, rays, 1))));
        let by_rays = POSITION_RAYS.map(|rays| (f64::from(rays), wrong(&over_cells(positions, rays, 1))));
        let noise_over_cells = with.noise(&over_cells(positions, rays, 1));

        // Links, free of noise: each pair of values and references has rays of its own.
        let truths = [truth, with.values(&reference, MANY_RAYS, 2)];
        let over_links = |tolerance, leaf_rays| {
            let mut options = SolveOptions { solver: Solver::Links, max_links: Some(MOST_LINKS), ..coarse.clone() };
            options.links.tolerance = Some(tolerance);
            options.links.leaf_rays = Some(leaf_rays);
            rooms::solve(scene.clone(), &options)
        };
        let mut measured = Self {
            noise_over_links: Curve::new(),
            noise_over_cells,
            positions: by_positions.to_vec(),
            position_rays: by_rays.to_vec(),
            as_swept: Curve::new(),
            links: Curve::new(),
            link_counts: Curve::new(),
        };
        for tolerance in TOLERANCES {
            let (solved, report) = over_links(tolerance, 16);
            if report.counts.links >= MOST_LINKS {
                break;
            }
            let left = |solved: &Evaluator| {
                let values = [3, 4].map(|seed| with.values(solved, MANY_RAYS, seed));
                with.product(&values[0], &values[1], [&truths[0], &truths[1]])
            };
            measured.links.push((tolerance, left(&solved)));
            measured.as_swept.push((tolerance, left(&over_links(tolerance, 0).0)));
            measured.link_counts.push((tolerance, report.counts.links as f64));
            if tolerance == TOLERANCES[2] {
                measured.noise_over_links = with.noise(&solved);
            }
        }
        measured
    }
}

/// Where values are compared, with what each emits.
pub struct Points {
    pub places: Vec<SurfacePoint>,
    exitance: Vec<f64>,
}

impl Points {
    pub fn of(scene: &Scene) -> Self {
        let points = points_of(scene, POINTS, &mut Random(5));
        let exitance = points.iter().flat_map(|(_, surface)| scene.material_of(SurfaceId(*surface as u32)).exitance.clone());
        Self { exitance: exitance.collect(), places: points.into_iter().map(|(place, _)| place).collect() }
    }

    /// Values of a solution with so many rays of this seed.
    pub fn values(&self, solved: &Evaluator, rays: u32, seed: u64) -> Vec<f64> {
        rooms::values(&regathered(solved, rays, seed), &self.places)
    }

    /// The product of what two sets of values are off by, each from its own truth, relative to the square of the reflected light.
    pub fn product(&self, a: &[f64], b: &[f64], truths: [&[f64]; 2]) -> f64 {
        let sums = (0..a.len()).map(|k| {
            let [of_a, of_b] = truths.map(|truth| truth[k]);
            ((a[k] - of_a) * (b[k] - of_b), (of_a - self.exitance[k]) * (of_b - self.exitance[k]))
        });
        let (product, reflected) = sums.fold((0.0, 0.0), |sum, (product, sq)| (sum.0 + product, sum.1 + sq));
        product / reflected
    }

    /// The square of the noise of values against the rays to each point.
    fn noise(&self, solved: &Evaluator) -> Curve {
        let noise_sq = |rays| {
            let [a, b] = [11, 12].map(|seed| self.values(solved, rays, seed));
            0.5 * self.product(&a, &a, [&b, &b])
        };
        RAYS.iter().map(|&rays| (f64::from(rays), noise_sq(rays))).collect()
    }
}
