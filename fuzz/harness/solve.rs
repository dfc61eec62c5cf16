//! The solver on small scenes that are made of bytes.

use std::time::{Duration, Instant};

use patchlight::geometry::Polygon;
use patchlight::pipeline;
use patchlight::progress::{Observer, Silent};
use patchlight::scene::SurfacePoint;
use patchlight::scene::{Material, Scene, Sides};
use patchlight::solve::{
    ChangShih98Options, Holzschuch94Options, LinkOptions, RunOptions, SolveOptions, Solver, Strategy, Subdivision, Sweep,
};
use patchlight::visibility::Backend;

use super::bytes::Bytes;

/// So that one input takes milliseconds.
const MOST_FACES: usize = 12;
const MOST_LINKS: u64 = 300;

/// Cancels when it is time to: most of a time limit passes between two looks at it.
struct Impatient(Instant);

impl Observer for Impatient {
    fn cancelled(&self) -> bool {
        Instant::now() >= self.0
    }
}

/// Solves a scene of a few polygons as the bytes tell; nothing in the result may be negative or not finite.
pub fn solve_scene(bytes: &[u8]) {
    let mut bytes = Bytes(bytes);
    let options = options(&mut bytes);
    let backend = bytes.pick(&[Backend::Auto, Backend::Obvhs, Backend::ObvhsBvh2, Backend::BruteForce]);
    let Some(scene) = scene(&mut bytes) else { return };
    assert_eq!(options.validate(), Ok(()));

    let run = RunOptions { threads: 1, backend, memory_bytes: Some(1 << 26), time_s: Some(0.1), ..RunOptions::default() };
    let impatient = Impatient(Instant::now() + Duration::from_millis(300));
    let (evaluator, report) = pipeline::solve(scene, &options, &run, &impatient).expect("legal options");
    let solution = evaluator.solution();
    assert_eq!(solution.validate(), Ok(()));
    assert!(report.error.estimate >= 0.0 && report.error.measured >= 0.0, "{:?}", report.error);
    assert!(report.energy.emitted.is_finite() && report.energy.absorbed.is_finite(), "{:?}", report.energy);
    solution.for_each_leaf(|_, _, radiosity| assert!(radiosity.iter().all(|b| b.is_finite() && *b >= 0.0), "{radiosity:?}"));

    let points: Vec<SurfacePoint> = (solution.scene().surfaces().iter())
        .map(|surface| SurfacePoint { position: surface.polygon.centroid(), normal: surface.polygon.normal() })
        .collect();
    let values = evaluator.values_at(&points, &Silent).expect("nobody cancels");
    assert_eq!(values.missed, 0);
    let of_mesh = evaluator.mesh_values_at(&points).map_or(Vec::new(), |values| values.radiosity);
    assert!(of_mesh.iter().all(|b| b.is_finite() && *b >= 0.0), "{of_mesh:?}");
    assert!(values.radiosity.iter().all(|b| b.is_finite() && *b >= 0.0), "{:?}", values.radiosity);
}

fn options(bytes: &mut Bytes) -> SolveOptions {
    let mut options = SolveOptions {
        error: bytes.pick(&[0.5, 0.2, 0.9]),
        strategy: bytes.pick(&[
            Strategy::Default,
            Strategy::Default,
            Strategy::Hanrahan91,
            Strategy::Uniform,
            Strategy::Original94,
            Strategy::Culling94,
            Strategy::Lazy94,
            Strategy::Lazy94Reduction,
            Strategy::BottomUp98,
            Strategy::TopDown98,
            Strategy::Multiresolution96,
        ]),
        solver: bytes.pick(&[Solver::Auto, Solver::Links, Solver::Cells]),
        links: LinkOptions {
            sweep: bytes.pick(&[Sweep::Jacobi, Sweep::InPlace]),
            form_factor_accuracy: bytes.pick(&[0.02, 0.0, 1.0]),
            ..LinkOptions::default()
        },
        max_links: Some(MOST_LINKS),
        holzschuch94: Holzschuch94Options { iterations: 3, ..Holzschuch94Options::default() },
        chang_shih98: ChangShih98Options { bottom_area: 1.0 / 16.0, bottom_samples: 2, ..ChangShih98Options::default() },
        ..SolveOptions::default()
    };
    let along = if options.strategy.links_once() { Subdivision::Regular } else { Subdivision::Discontinuities };
    let regular = Subdivision::Regular;
    (options.links.leaf_rays, options.links.subdivision) =
        bytes.pick(&[(None, regular), (Some(0), regular), (None, along), (Some(0), along)]);
    options.point_rays = bytes.pick(&[Some(8), Some(1)]);
    options.lit_mesh = bytes.pick(&[false, false, false, true]);
    options.seed = u64::from(bytes.next());
    options
}

fn scene(bytes: &mut Bytes) -> Option<Scene> {
    let channels = bytes.pick(&[1, 3]);
    let (unit, far) = (bytes.pick(&[1.0, 1.0, 1e-6, 1e6]), bytes.pick(&[0.0, 0.0, 1e3, 1e6]));
    let sides = bytes.pick(&[Sides::Front, Sides::Both]);
    let materials: Vec<Material> = (0..3)
        .map(|k| {
            let reflectance = (0..channels).map(|_| bytes.pick(&[0.0, 0.5, 0.9, 0.999, 1e-9])).collect();
            let exitance = (0..channels).map(|_| bytes.pick(&[0.0, 0.0, 1.0, 1e6, 1e-6])).collect();
            Material { name: format!("m{k}"), reflectance, exitance }
        })
        .collect();

    let mut faces = Vec::new();
    while !bytes.is_empty() && faces.len() < MOST_FACES {
        let shape = bytes.next();
        let material = u32::from(shape >> 4) % 3;
        let point = |bytes: &mut Bytes| -> [f64; 3] { std::array::from_fn(|_| unit * (coordinate(bytes) + far)) };
        let corners = if shape & 1 == 0 {
            // A rectangle across one axis.
            let (axis, [a, b]) = ((shape as usize >> 1) % 3, [point(bytes), point(bytes)]);
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            let corner = |at_u: f64, at_v: f64| {
                let mut corner = a;
                (corner[u], corner[v]) = (at_u, at_v);
                corner
            };
            vec![corner(a[u], a[v]), corner(b[u], a[v]), corner(b[u], b[v]), corner(a[u], b[v])]
        } else {
            vec![point(bytes), point(bytes), point(bytes)]
        };
        if let Ok(polygon) = Polygon::new(&corners) {
            faces.push((polygon, material, faces.len() as u32));
        }
    }
    Scene::new(channels, materials, faces, sides).ok()
}

/// A coordinate: of a coarse grid, so that corners, edges and planes meet, or a hair's breadth beside it.
fn coordinate(bytes: &mut Bytes) -> f64 {
    let byte = bytes.next();
    f64::from(byte & 7) + bytes.pick(&[0.0, 0.0, 0.0, 0.0, 0.5, 1e-3, 1e-6, -1e-9])
}
