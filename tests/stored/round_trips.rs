//! What is written can be read, and gives the same values.

use patchlight::pipeline::Evaluator;
use patchlight::progress::Silent;
use patchlight::scene::import::{ImportOptions, read_scene};
use patchlight::scene::{Material, Sides};
use patchlight::solve::{RunOptions, SolveOptions, Solver};

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

/// The faces of a scene as `(corners, material)`.
type Faces = Vec<(Vec<[f64; 3]>, u32)>;

/// A scene with some faces jittered, reversed, repeated, flattened to nearly nothing, scaled or taken out.
fn mutated(faces: &Faces, random: &mut Random) -> Faces {
    let mut faces = faces.clone();
    for _ in 0..=random.below(8) {
        let at = random.below(faces.len());
        let (corners, material) = faces[at].clone();
        let some = random.below(corners.len());
        match random.below(8) {
            0 => {
                let far = [1e-12, 1e-9, 1e-7, 1e-6, 1e-3, 0.1][random.below(6)];
                let jitter = |x: f64, random: &mut Random| x + far * (2.0 * random.unit() - 1.0);
                faces[at].0.iter_mut().for_each(|corner| *corner = corner.map(|x| jitter(x, random)));
            }
            1 => faces[at].0.reverse(),
            2 => faces.push((corners, material)),
            3 => faces.push((corners.into_iter().rev().collect(), material)),
            4 => faces[at].0[some] = corners[(some + 1) % corners.len()],
            5 => {
                // A sliver: one corner close to the line between its neighbours.
                let (before, after) = (corners[(some + corners.len() - 1) % corners.len()], corners[(some + 1) % corners.len()]);
                let part = 10.0_f64.powi(-(random.below(13) as i32));
                let middle: [f64; 3] = std::array::from_fn(|k| (before[k] + after[k]) / 2.0);
                faces[at].0[some] = std::array::from_fn(|k| middle[k] + part * (corners[some][k] - middle[k]));
            }
            6 => {
                let scale = [0.3, 3.0][random.below(2)];
                faces[at].0.iter_mut().for_each(|corner| *corner = corner.map(|x| scale * x));
            }
            _ if faces.len() > 1 => drop(faces.swap_remove(at)),
            _ => {}
        }
    }
    faces
}

/// The scene as an OBJ file, every face with vertices of its own: so that it is repaired as any other is.
fn obj(faces: &Faces, materials: &[Material]) -> String {
    let mut text = "mtllib scene.mtl\n".to_owned();
    for (corners, material) in faces {
        corners.iter().for_each(|[x, y, z]| text += &format!("v {x:e} {y:e} {z:e}\n"));
        let indices: Vec<String> = (1..=corners.len()).rev().map(|back| format!("-{back}")).collect();
        text += &format!("usemtl {}\nf {}\n", materials[*material as usize].name, indices.join(" "));
    }
    text
}

#[test]
fn spoilt_scenes_are_read_back() {
    let names = ["cornell", "furnace", "four_polygons", "two_rooms"];
    let scenes = names.map(|name| super::scene(&format!("{name}.obj"), Sides::Front));
    let folder = tempfile::tempdir().unwrap();
    let (mut random, mut read_back) = (Random(11), 0);
    for number in 0..500 {
        let chosen = random.below(scenes.len());
        let scene = &scenes[chosen];
        let faces = scene.surfaces().iter().map(|surface| (surface.polygon.vertices().collect(), surface.material)).collect();
        let library = scene_files()[0].with_file_name(format!("{}.mtl", names[chosen]));
        std::fs::copy(library, folder.path().join("scene.mtl")).unwrap();
        let file = folder.path().join("scene.obj");
        std::fs::write(&file, obj(&mutated(&faces, &mut random), scene.materials())).unwrap();

        let sides = if number % 2 == 0 { Sides::Front } else { Sides::Both };
        let Ok(imported) = read_scene(&file, &ImportOptions { sides, ..ImportOptions::default() }) else { continue };
        let solver = [Solver::Auto, Solver::Links, Solver::Cells][number % 3];
        let (point_rays, max_links, lit_mesh) = (Some(4), Some(2000), number % 7 == 0);
        let options = SolveOptions { error: 0.9, solver, point_rays, max_links, lit_mesh, ..SolveOptions::default() };
        assert_reads_back(&solved(imported.scene, &options), 4, &format!("scene {number}"));
        read_back += 1;
    }
    assert!(read_back >= 490, "{read_back}");
}
