//! Whole scenes, soups and threads.
#![allow(clippy::print_stderr, reason = "a test tells what it did")]

use std::path::{Path, PathBuf};
use std::time::Instant;

use glam::DVec3;
use patchlight::discontinuities::{Discontinuities, of_emitters};
use patchlight::geometry::Polygon;
use patchlight::scene::import::{ImportOptions, read_scene};
use patchlight::scene::{Scene, Sides, SurfaceId};

use super::lit_by_first;
use super::random::Random;

/// What holds for all discontinuities: segments lie on their surfaces, have a length, and on one surface none lie over each other.
fn check(scene: &Scene, found: &Discontinuities) {
    let bounds = scene.bounds();
    let room = 1e-4 * bounds.diagonal();
    let (mut counted, mut most) = (0, 0);
    for (index, surface) in scene.surfaces().iter().enumerate() {
        let segments = found.of(SurfaceId(index as u32));
        counted += segments.len() as u64;
        most = most.max(segments.len() as u64);
        let (centre, normal) = (DVec3::from(surface.polygon.centroid()), DVec3::from(surface.polygon.normal()));
        let vertices: Vec<DVec3> = surface.polygon.vertices().map(DVec3::from).collect();
        for segment in segments {
            let ends = segment.ends().map(DVec3::from);
            assert!(ends[0] != ends[1] && segment.change > 0.0);
            for end in ends {
                assert!(end.is_finite() && normal.dot(end - centre).abs() <= room, "surface {index}: {segment:?} is off its plane");
                let is_inside = |k: usize| {
                    let (a, b) = (vertices[k], vertices[(k + 1) % vertices.len()]);
                    normal.cross(b - a).normalize_or_zero().dot(end - a) >= -room
                };
                assert!((0..vertices.len()).all(is_inside), "surface {index}: {segment:?} is off it");
            }
        }
    }
    assert_eq!((counted, most), (found.counters().segments(), found.counters().most_per_surface));
}

fn with_threads(threads: usize, scene: &Scene) -> Discontinuities {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(|| of_emitters(scene, 0.0))
}

fn read(file: &Path) -> Scene {
    read_scene(file, &ImportOptions::default()).unwrap_or_else(|error| panic!("{error}")).scene
}

#[test]
fn the_scenes_go_through_and_threads_change_nothing() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut files: Vec<PathBuf> = files.filter(|file| file.extension().is_some_and(|e| e == "obj")).collect();
    files.sort();
    assert!(files.len() > 8);
    for file in files {
        let scene = read(&file);
        let found = with_threads(1, &scene);
        check(&scene, &found);
        assert_eq!(found, with_threads(3, &scene), "{}", file.display());
    }
}

#[test]
#[ignore = "needs ../shared: scenes by others"]
fn scenes_by_others_go_through() {
    let shared = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared");
    let folders = ["scenes", "hard"].map(|folder| std::fs::read_dir(shared.join(folder)).unwrap());
    let mut files: Vec<PathBuf> = folders.into_iter().flatten().map(|entry| entry.unwrap().path().join("scene.obj")).collect();
    files.retain(|file| file.is_file());
    files.sort();
    for file in files {
        let scene = read(&file);
        let start = Instant::now();
        let found = of_emitters(&scene, 1e-3);
        eprintln!("{}: {} surfaces, {:.2?}, {:?}", file.display(), scene.surfaces().len(), start.elapsed(), found.counters());
        check(&scene, &found);
    }
}

/// Polygons with corners on a coarse grid: they touch, cross, repeat, share sides in part and lie in each other.
#[test]
fn soups_of_touching_polygons_go_through() {
    let mut random = Random::new(7);
    for trial in 0..400 {
        let cells = 2 + random.below(3);
        let mut corner = || std::array::from_fn(|_| random.below(cells + 1) as f64 / cells as f64);
        let mut polygons: Vec<Polygon> = Vec::new();
        while polygons.len() < 14 {
            let [a, b, c]: [[f64; 3]; 3] = [corner(), corner(), corner()];
            let fourth: [f64; 3] = std::array::from_fn(|k| a[k] + c[k] - b[k]);
            let corners = if polygons.len().is_multiple_of(2) { vec![a, b, c] } else { vec![a, b, c, fourth] };
            polygons.extend(Polygon::new(&corners));
        }
        // Some again, and some a little off.
        polygons.push(polygons[3].clone());
        let off = polygons[5].vertices().map(|vertex| vertex.map(|x| x + 3e-7)).collect::<Vec<_>>();
        polygons.extend(Polygon::new(&off));
        let one_sided = lit_by_first(&polygons);
        let faces = polygons.iter().zip(0..).map(|(polygon, face)| (polygon.clone(), u32::from(face > 2), face)).collect();
        let both = Scene::new(1, one_sided.materials().to_vec(), faces, Sides::Both).unwrap();
        for scene in [one_sided, both] {
            let found = with_threads(1, &scene);
            check(&scene, &found);
            if trial % 20 == 0 {
                assert_eq!(found, with_threads(2, &scene), "trial {trial}");
            }
        }
    }
}
