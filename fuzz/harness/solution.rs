//! The reader of stored solutions, and what may be asked of whatever it lets pass.
#![allow(dead_code, reason = "each target uses a part")]

use std::io::Cursor;
use std::path::Path;
use std::sync::OnceLock;

use patchlight::geometry::Polygon;
use patchlight::output::{
    Provenance, SOLUTION_FORMAT_VERSION, read_solution_from, write_mesh_ply, write_ply, write_quadratic_mesh_ply, write_solution,
};
use patchlight::pipeline::{self, Evaluator};
use patchlight::progress::Silent;
use patchlight::scene::import::Diagnostics;
use patchlight::scene::{LightWeight, Material, Scene, SceneSummary, Sides, SurfacePoint};
use patchlight::solve::{RunOptions, SolveOptions, Solver};

/// Bytes of the header: magic, version, length and checksum of the body.
pub const HEADER: usize = 24;

/// Larger solutions take too long to look at.
const MOST_RAYS: u32 = 4096;
const MOST_BOUNDS_WORK: u64 = 1 << 14;

/// Reads the bytes as a solution, and once more as the body of one whose header is right: a checksum is no defence against anyone who means it.
pub fn read_solution(bytes: &[u8]) {
    look_at(bytes);
    read_body(bytes);
}

/// Reads the bytes as the body of a solution; whether it was taken.
pub fn read_body(body: &[u8]) -> bool {
    look_at(&with_header(body))
}

fn with_header(body: &[u8]) -> Vec<u8> {
    [&header(*b"\x89PLSOL\r\n", SOLUTION_FORMAT_VERSION, body), body].concat()
}

/// What stands before a body in a file of such a kind and version.
pub fn header(kind: [u8; 8], version: u32, body: &[u8]) -> Vec<u8> {
    let checksum = crc32fast::hash(body).to_le_bytes();
    [&kind[..], &version.to_le_bytes(), &(body.len() as u64).to_le_bytes(), &checksum].concat()
}

/// What is read must be good for values, bounds, pictures and exports; whether it is read.
fn look_at(bytes: &[u8]) -> bool {
    let Ok(solution) = read_solution_from(bytes, Path::new("in memory")) else { return false };
    assert_eq!(solution.validate(), Ok(()));
    let options = solution.options();
    let much_to_bound = options.bounds_work.map_or(options.error < 1e-3, |work| work > MOST_BOUNDS_WORK);
    if solution.point_rays() > MOST_RAYS || solution.scene().channels() > 16 || much_to_bound {
        return true;
    }
    let points: Vec<SurfacePoint> = (solution.scene().surfaces().iter())
        .map(|surface| SurfacePoint { position: surface.polygon.centroid(), normal: surface.polygon.normal() })
        .take(8)
        .collect();
    if let Some(groups) = solution.scene().light_groups() {
        let weights = [LightWeight { group: groups.names()[0].clone(), by_band: vec![0.5] }];
        if let Ok(relit) = solution.relit(&weights) {
            assert_eq!(relit.validate(), Ok(()));
        }
        assert!(solution.light_groups_report().is_some());
    }
    if solution.transport().is_some() {
        let mut materials = solution.scene().materials().to_vec();
        materials.iter_mut().for_each(|material| material.reflectance.iter_mut().for_each(|rho| *rho *= 0.5));
        if let Ok(Some((other, error))) = solution.with_materials(materials, &Silent) {
            assert_eq!(other.validate(), Ok(()));
            assert!(!error.estimate.is_nan());
        }
    }
    let summary = SceneSummary::new(solution.scene(), &Diagnostics::default());
    assert!(!summary.to_string().is_empty());
    write_ply(&mut Vec::new(), &solution, &Provenance::new(solution.options())).expect("memory suffices");
    let Ok(evaluator) = Evaluator::new(solution, &RunOptions { threads: 1, ..RunOptions::default() }) else { return true };
    let values = evaluator.values_at(&points, &Silent).expect("nobody cancels");
    assert_eq!(values.channels * points.len(), values.radiosity.len());
    assert!(evaluator.bounds_at(&points).is_none_or(|bounds| bounds.lower.len() == values.radiosity.len()));
    look_at_mesh(&evaluator, &points);
    if let Ok(image) = evaluator.render(&evaluator.default_camera(4, 3), &Silent) {
        assert!(image.is_some());
    }
    true
}

/// A lit mesh must be good for values, pictures and exports.
fn look_at_mesh(evaluator: &Evaluator, points: &[SurfacePoint]) {
    let (solution, Some(mesh)) = (evaluator.solution(), evaluator.mesh()) else { return };
    let values = evaluator.mesh_values_at(points).expect("there is a mesh");
    assert!(values.radiosity.iter().all(|b| b.is_nan() || b.is_finite() && *b >= 0.0), "{:?}", values.radiosity);
    let (provenance, scene) = (Provenance::new(solution.options()), solution.scene());
    write_mesh_ply(&mut Vec::new(), scene, mesh, &provenance).expect("memory suffices");
    write_quadratic_mesh_ply(&mut Vec::new(), scene, mesh, &provenance).expect("memory suffices");
    if let Ok(image) = evaluator.render_mesh(mesh, &evaluator.default_camera(4, 3), &Silent) {
        assert!(image.is_some_and(|image| image.radiance.iter().all(|l| l.is_finite())));
    }
}

/// The body of a small stored solution, over links or over cells, with a lit mesh or without: fuzzers change it.
pub fn small_solution(solver: Solver, lit_mesh: bool) -> &'static [u8] {
    static BODIES: [[OnceLock<Vec<u8>>; 2]; 2] = [const { [const { OnceLock::new() }; 2] }; 2];
    BODIES[usize::from(solver == Solver::Cells)][usize::from(lit_mesh)].get_or_init(|| {
        let wall = Material { name: "wall".to_owned(), reflectance: vec![0.5], exitance: vec![0.0] };
        let lamp = Material { name: "lamp".to_owned(), reflectance: vec![0.0], exitance: vec![1.0] };
        let floor = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        let ceiling = [[0.0, 0.0, 1.0], [0.0, 1.0, 1.0], [1.0, 1.0, 1.0]];
        let faces = vec![(Polygon::new(&floor), 0, 0), (Polygon::new(&ceiling), 1, 1)];
        let faces = faces.into_iter().map(|(polygon, material, face)| (polygon.expect("it has an area"), material, face)).collect();
        let scene = Scene::new(1, vec![wall, lamp], faces, Sides::Front).expect("a scene");
        let (max_links, point_rays) = (Some(8), Some(16));
        let options = SolveOptions { error: 0.5, solver, max_links, point_rays, lit_mesh, ..SolveOptions::default() };
        let (evaluator, _) = pipeline::solve(scene, &options, &RunOptions::default(), &Silent).expect("legal options");
        let mut file = Cursor::new(Vec::new());
        write_solution(&mut file, evaluator.solution(), &Provenance::new(&options)).expect("memory suffices");
        file.into_inner().split_off(HEADER)
    })
}
