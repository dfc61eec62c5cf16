//! What is written can be read, and gives the same values.

use patchlight::pipeline::Evaluator;
use patchlight::progress::Silent;
use patchlight::scene::Sides;
use patchlight::scene::import::{ImportOptions, read_scene};
use patchlight::solve::{RunOptions, SolveOptions, Solver};

use super::spoilt::{faces_of, obj, spoilt};
use super::triangles::Random;
use super::{points, read, scene_files, solved, stored};

/// Values and their bounds, as bits.
fn values(evaluator: &Evaluator, most: usize) -> Vec<u32> {
    let points = points(evaluator.solution().scene(), most);
    let values = evaluator.values_at(&points, &Silent).unwrap();
    let bounds = evaluator.bounds_at(&points).map(|bounds| [bounds.lower, bounds.upper].concat()).unwrap_or_default();
    let of_mesh = evaluator.mesh_values_at(&points).map(|values| values.radiosity).unwrap_or_default();
    values.radiosity.iter().chain(&bounds).chain(&of_mesh).map(|value| value.to_bits()).collect()
}

/// Writes and reads a solution; all must be as before.
fn assert_reads_back(evaluator: &Evaluator, most: usize, what: &str) {
    let solution = evaluator.solution();
    let bytes = stored(solution);
    let again = read(&bytes).unwrap_or_else(|error| panic!("{what}: {error}"));
    assert!(again == *solution && stored(&again) == bytes, "{what}");
    let again = Evaluator::new(again, &RunOptions::default()).unwrap();
    assert_eq!(values(&again, most), values(evaluator, most), "{what}");
}

#[test]
fn every_scene_is_read_back_with_one_side_or_two() {
    for file in scene_files() {
        for sides in [Sides::Front, Sides::Both] {
            let scene = read_scene(&file, &ImportOptions { sides, ..ImportOptions::default() }).unwrap().scene;
            let options = SolveOptions { error: 0.9, point_rays: Some(16), max_links: Some(100_000), ..SolveOptions::default() };
            assert_reads_back(&solved(scene, &options), 20, &format!("{}, {sides:?}", file.display()));
        }
    }
}

/// The meshes of all scenes are read back, those with slivers and narrow strips as well.
#[test]
fn lit_meshes_are_read_back() {
    for file in scene_files() {
        let scene = read_scene(&file, &ImportOptions::default()).unwrap().scene;
        let (max_links, point_rays) = (Some(100_000), Some(16));
        let options = SolveOptions { error: 0.9, lit_mesh: true, max_links, point_rays, ..SolveOptions::default() };
        let evaluator = solved(scene, &options);
        assert!(evaluator.mesh().is_some_and(|mesh| mesh.elements() > 0), "{}", file.display());
        assert_reads_back(&evaluator, 20, &format!("{} with a mesh", file.display()));
    }
}

#[test]
fn spoilt_scenes_are_read_back() {
    // Three times each way with one side and two, with a mesh and without.
    assert_spoilt_scenes_are_read_back(126);
}

#[test]
#[ignore = "takes ten minutes"]
fn five_hundred_spoilt_scenes_are_read_back() {
    assert_spoilt_scenes_are_read_back(500);
}

fn assert_spoilt_scenes_are_read_back(count: usize) {
    let names = ["cornell", "furnace", "four_polygons", "two_rooms"];
    let scenes = names.map(|name| super::scene(&format!("{name}.obj"), Sides::Front));
    let folder = tempfile::tempdir().unwrap();
    let (mut random, mut read_back) = (Random(11), 0);
    for number in 0..count {
        let chosen = random.below(scenes.len());
        let scene = &scenes[chosen];
        let library = scene_files()[0].with_file_name(format!("{}.mtl", names[chosen]));
        std::fs::copy(library, folder.path().join("scene.mtl")).unwrap();
        let file = folder.path().join("scene.obj");
        std::fs::write(&file, obj(&spoilt(&faces_of(scene), &mut random), scene.materials())).unwrap();

        let sides = if number % 2 == 0 { Sides::Front } else { Sides::Both };
        let Ok(imported) = read_scene(&file, &ImportOptions { sides, ..ImportOptions::default() }) else { continue };
        let solver = [Solver::Auto, Solver::Links, Solver::Cells][number % 3];
        let (point_rays, max_links, lit_mesh) = (Some(4), Some(2000), number % 7 == 0);
        let options = SolveOptions { error: 0.9, solver, point_rays, max_links, lit_mesh, ..SolveOptions::default() };
        assert_reads_back(&solved(imported.scene, &options), 4, &format!("scene {number}"));
        read_back += 1;
    }
    assert!(read_back as f64 >= 0.98 * count as f64, "{read_back} of {count}");
}
