//! Light groups: one solve, whose emitters are weighted afterwards. Held against solves without groups, solves of one group alone, and what is known
//! exactly.
#![allow(clippy::print_stdout, reason = "a test tells what it measured")]

#[path = "support/rooms.rs"]
mod rooms;
#[path = "support/triangles.rs"]
mod triangles;

use std::io::Cursor;
use std::path::Path;

use patchlight::output::{Provenance, read_solution_from, write_solution};
use patchlight::pipeline::{Evaluator, PipelineError, solve};
use patchlight::progress::Silent;
use patchlight::scene::{EmitterName, LightGroupError, LightGrouping, LightWeight, Scene, SurfacePoint};
use patchlight::solve::{Bounds, Norm, RunOptions, Solution, SolveOptions, SolveReport, Solver, Strategy};
use rooms::{Room, points_of, straight};
use triangles::Random;

fn room() -> Scene {
    let (mut room, block) = Room::with_lamps();
    room.cuboid([1.2, 0.0, 1.0], straight(0.8, 1.1, 0.9), false, |_, _| block);
    room.scene()
}

fn options(solver: Solver, error: f64) -> SolveOptions {
    SolveOptions { solver, error, norm: Norm::Energy, ..SolveOptions::default() }
}

fn solved(scene: Scene, options: &SolveOptions, threads: usize) -> (Evaluator, SolveReport) {
    solve(scene, options, &RunOptions { threads, ..RunOptions::default() }, &Silent).unwrap()
}

fn evaluator(solution: Solution) -> Evaluator {
    Evaluator::new(solution, &RunOptions::default()).unwrap()
}

fn by_material(scene: &Scene) -> Scene {
    scene.with_light_groups(&LightGrouping::Materials).unwrap()
}

fn weight(group: &str, by_band: &[f64]) -> LightWeight {
    LightWeight { group: group.to_owned(), by_band: by_band.to_vec() }
}

fn points(scene: &Scene, count: usize) -> Vec<SurfacePoint> {
    points_of(scene, count, &mut Random(11)).into_iter().map(|(point, _)| point).collect()
}

/// Values at points of surfaces, by rays and off the lit mesh if there is one.
fn values(evaluator: &Evaluator, points: &[SurfacePoint]) -> Vec<Vec<f32>> {
    let gathered = evaluator.values_at(points, &Silent).unwrap().radiosity;
    let of_mesh = evaluator.mesh_values_at(points).map(|values| values.radiosity);
    std::iter::once(gathered).chain(of_mesh).collect()
}

#[test]
fn all_groups_together_are_a_solve_without_groups_to_the_bit() {
    let points = points(&room(), 200);
    for (solver, lit_mesh) in [(Solver::Links, false), (Solver::Cells, false), (Solver::Links, true), (Solver::Cells, true)] {
        let options = SolveOptions { lit_mesh, ..options(solver, 0.1) };
        let (plain, of_plain) = solved(room(), &options, 2);
        let (grouped, of_grouped) = solved(by_material(&room()), &options, 2);
        assert_eq!(values(&plain, &points), values(&grouped, &points), "{solver:?}, mesh: {lit_mesh}");
        assert!(plain.solution().radiosity() == grouped.solution().radiosity(), "{solver:?}, mesh: {lit_mesh}");
        assert_eq!(of_plain.error, of_grouped.error);
        assert_eq!((of_plain.lit_mesh, of_plain.counts.rays), (of_grouped.lit_mesh, of_grouped.counts.rays));

        // What is told of all groups is what is told of the solve, by energy.
        let groups = of_grouped.light_groups.unwrap();
        let is_about = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-9;
        assert!(is_about(groups.error.estimate, of_plain.error.energy.estimate), "{groups:?}");
        assert!(is_about(groups.error.measured, of_plain.error.energy.measured), "{groups:?}");
        assert!(of_plain.light_groups.is_none() && groups.groups.len() == 2);
    }
}

#[test]
fn sums_are_linear_in_the_weights() {
    let (scene, points) = (room(), points(&room(), 200));
    for solver in [Solver::Links, Solver::Cells] {
        let options = SolveOptions { lit_mesh: true, ..options(solver, 0.1) };
        let (evaluator_of_all, _) = solved(by_material(&scene), &options, 0);
        let all = evaluator_of_all.solution();
        let relit = |lamp: &[f64], tube: &[f64]| all.relit(&[weight("lamp", lamp), weight("tube", tube)]).unwrap();

        // Twice all and back: the sum of groups is what was solved, to rounding of f64 where that is kept, of f32 elsewhere.
        let twice = relit(&[2.0], &[2.0]);
        let back = twice.relit(&[weight("lamp", &[1.0]), weight("tube", &[1.0])]).unwrap();
        let pairs = back.radiosity().values().iter().zip(all.radiosity().values());
        let off = pairs.map(|(sum, all)| (sum - all).abs() / all.max(1e-6)).fold(0.0, f64::max);
        println!("{solver:?}: sums are off by {off:e}");
        assert!(off < 1e-12, "{off}");
        for (sum, all) in values(&evaluator(back), &points).concat().iter().zip(values(&evaluator_of_all, &points).concat()) {
            assert!((sum - all).abs() <= 2e-6 * all.max(0.1), "{sum} for {all}");
        }

        // A weighted sum is the sum of weighted groups, by band.
        let (lamp, tube) = (relit(&[1.0], &[0.0]), relit(&[0.0], &[1.0]));
        let both = relit(&[0.5], &[0.0, 3.0, 1.0]);
        for (index, sum) in both.radiosity().values().iter().enumerate() {
            let [lamp, tube] = [&lamp, &tube].map(|of| of.radiosity().values()[index]);
            let expected = 0.5 * lamp + [0.0, 3.0, 1.0][index % 3] * tube;
            assert!((sum - expected).abs() <= 1e-12 * expected.max(1e-3), "{sum} for {expected}");
        }
        assert_eq!(both.scene().materials().iter().find(|of| of.name == "tube").unwrap().exitance, [0.0, 15.0, 40.0]);
        assert_eq!(both.validate(), Ok(()));

        // Weights that stay leave everything as it is; in the dark nothing is wrong.
        assert!(all.relit(&[weight("tube", &[1.0, 1.0, 1.0])]).unwrap() == *all);
        let dark = relit(&[0.0], &[0.0]);
        assert!(dark.radiosity().values().iter().all(|&b| b == 0.0));
        assert_eq!(dark.light_groups_report().unwrap().error.estimate, 0.0);
        assert!(values(&evaluator(dark), &points).concat().iter().all(|&b| b == 0.0));
    }
}

/// The root mean square difference of values at points, relative to what is reflected by the second ones.
fn off(found: &[f32], truth: &[f32], scene: &Scene, points: &[SurfacePoint]) -> f64 {
    let lit = evaluator_of_surfaces(scene, points);
    let (mut difference_sq, mut light_sq) = (0.0, 0.0);
    for ((found, truth), exitance) in found.iter().zip(truth).zip(lit) {
        difference_sq += f64::from(found - truth).powi(2);
        light_sq += (f64::from(*truth) - exitance).powi(2);
    }
    (difference_sq / light_sq).sqrt()
}

/// The exitance at points, by point and channel.
fn evaluator_of_surfaces(scene: &Scene, points: &[SurfacePoint]) -> Vec<f64> {
    let at = |point: &SurfacePoint| {
        let distance = |surface: &&patchlight::scene::Surface| {
            let (centroid, normal) = (surface.polygon.centroid(), surface.polygon.normal());
            let apart: f64 = (0..3).map(|k| (point.position[k] - centroid[k]) * normal[k]).sum();
            let turned: f64 = (0..3).map(|k| (point.normal[k] - normal[k]).abs()).sum();
            apart.abs() + turned
        };
        let surface = scene.surfaces().iter().min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap();
        scene.materials()[surface.material as usize].exitance.clone()
    };
    points.iter().flat_map(at).collect()
}

#[test]
fn a_group_alone_is_a_solve_of_its_emitters_within_both_claims() {
    let scene = room();
    // Where nothing emits: there reflected light is all light.
    let is_dark = |point: &SurfacePoint| point.position[1] < 2.97;
    let points: Vec<SurfacePoint> = points(&scene, 1500).into_iter().filter(is_dark).collect();
    for solver in [Solver::Links, Solver::Cells] {
        let (grouped, _) = solved(by_material(&scene), &SolveOptions { lit_mesh: true, ..options(solver, 0.05) }, 0);
        for (group, other) in [("lamp", "tube"), ("tube", "lamp")] {
            let mut materials = scene.materials().to_vec();
            materials.iter_mut().filter(|material| material.name == other).for_each(|material| material.exitance.fill(0.0));
            let alone = SolveOptions { seed: 77, ..options(Solver::Auto, 0.01) };
            let (alone, of_alone) = solved(scene.with_materials(materials).unwrap(), &alone, 0);
            let truth = alone.values_at(&points, &Silent).unwrap().radiosity;

            // By other weights than 1, since an error is relative.
            let relit = grouped.solution().relit(&[weight(group, &[2.0]), weight(other, &[0.0])]).unwrap();
            let known = relit.light_groups_report().unwrap();
            let truth: Vec<f32> = truth.iter().map(|b| 2.0 * b).collect();
            let relit = evaluator(relit);
            let [gathered, of_mesh] = &values(&relit, &points)[..] else { panic!("there is a mesh") };
            let claims = [known.error.estimate, known.lit_mesh.unwrap().estimate];
            for (found, claim) in [gathered, of_mesh].into_iter().zip(claims) {
                let off = off(found, &truth, alone.solution().scene(), &points);
                println!("{solver:?}, {group}: off by {off:.4}, claimed {claim:.4}, beside {:.4}", of_alone.error.estimate);
                assert!(claim < 0.3 && off <= claim + of_alone.error.estimate, "{solver:?}, {group}: {off} for {claim}");
            }
            // Alone with any weight a group is what it is with the weight 1.
            let own = known.groups.iter().find(|known| known.name == group).unwrap();
            assert!((own.error.estimate / known.error.estimate - 1.0).abs() < 1e-9 && own.weights == [2.0; 3]);
        }
    }
}

/// Every face of a closed cube emits 1 and reflects a half, so that `B = 2` everywhere; three faces are one group and three another.
#[test]
fn a_furnace_of_two_groups_keeps_what_is_known_exactly() {
    let mut cube = Room::default();
    let (one, other) = (cube.named_material("one", &[0.5], &[1.0]), cube.named_material("other", &[0.5], &[1.0]));
    cube.cuboid([0.0; 3], straight(1.0, 1.0, 1.0), true, |_, face| if face % 2 == 0 { one } else { other });
    let scene = cube.scene();
    let points = points(&scene, 300);
    for solver in [Solver::Links, Solver::Cells] {
        let (evaluator_of_all, _) = solved(by_material(&scene), &options(solver, 0.02), 0);
        let thrice = evaluator_of_all.solution().relit(&[weight("one", &[3.0]), weight("other", &[3.0])]).unwrap();
        let claim = thrice.light_groups_report().unwrap().error.estimate;
        let thrice = evaluator(thrice).values_at(&points, &Silent).unwrap().radiosity;
        let off = thrice.iter().map(|b| f64::from(b / 6.0 - 1.0).powi(2)).sum::<f64>() / thrice.len() as f64;
        println!("{solver:?}: off by {:.5}, claimed {claim:.5}", off.sqrt());
        // B is twice what is reflected, and that is what the claim is relative to.
        assert!(2.0 * off.sqrt() <= claim && claim <= 0.02);

        // With the weights 1 and 0 half of the walls emit. What they emit is absorbed: the mean of B over all walls is 1.
        let half = evaluator_of_all.solution().relit(&[weight("other", &[0.0])]).unwrap();
        let root = half.hierarchy().ids().next().unwrap();
        let mean = half.radiosity().of(root)[0];
        println!("{solver:?}: the mean over half a furnace is {mean}");
        assert!((mean - 1.0).abs() < 0.01, "{mean}");
    }
}

#[test]
fn groups_by_name_hold_objects_and_materials() {
    let text = "o left\nusemtl lamp\nf 1 2 3\no right\nusemtl lamp\nf 4 5 6\nusemtl tube\nf 7 8 9\n";
    let corners: String = (0..3).map(|k| format!("v {k} 0 0\nv {k} 1 0\nv {k} 0 1\n")).collect();
    let folder = std::env::temp_dir().join(format!("patchlight-light-groups-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("s.obj"), format!("mtllib s.mtl\n{corners}{text}")).unwrap();
    std::fs::write(folder.join("s.mtl"), "newmtl lamp\nKd 0.5 0.5 0.5\nKe 1 1 1\nnewmtl tube\nKd 0 0 0\nKe 2 2 2\n").unwrap();
    let scene = patchlight::scene::import::read_scene(&folder.join("s.obj"), &Default::default()).unwrap().scene;
    std::fs::remove_dir_all(&folder).unwrap();

    let names =
        |grouping: &LightGrouping| scene.with_light_groups(grouping).map(|scene| scene.light_groups().unwrap().names().to_vec());
    assert_eq!(names(&LightGrouping::Materials).unwrap(), ["lamp", "tube"]);
    assert_eq!(names(&LightGrouping::Objects).unwrap(), ["left", "right"]);
    let named = |groups: &[(&str, &[&str])]| {
        let lights = |lights: &&[&str]| lights.iter().map(|lights| lights.parse::<EmitterName>().unwrap()).collect();
        LightGrouping::Named(groups.iter().map(|(name, members)| ((*name).to_owned(), lights(members))).collect())
    };
    // A material in two groups becomes two of one name.
    let by_object = scene.with_light_groups(&LightGrouping::Objects).unwrap();
    assert_eq!(by_object.materials().iter().filter(|material| material.name == "lamp").count(), 2);
    assert_eq!(names(&named(&[("b", &["object right"]), ("a", &["object left"])])).unwrap(), ["b", "a"]);

    // What is in no group, in two, or is no light.
    let error = |groups: &[(&str, &[&str])]| names(&named(groups)).unwrap_err();
    assert!(matches!(error(&[("a", &["material lamp"])]), LightGroupError::InNoGroup { face: 3, .. }));
    let twice = error(&[("a", &["material lamp", "material tube"]), ("b", &["object left"])]);
    assert!(matches!(&twice, LightGroupError::InTwoGroups { face: 1, groups, .. } if *groups == ["a", "b"]), "{twice}");
    assert!(matches!(error(&[("a", &["material floor"])]), LightGroupError::NothingEmits { .. }));
    assert!(matches!(error(&[("a", &["material lamp"]), ("a", &["material tube"])]), LightGroupError::BadName(_)));
    assert!("lamp".parse::<EmitterName>().is_err() && "material ".parse::<EmitterName>().is_err());
}

#[test]
fn groups_and_weights_that_are_none_are_refused() {
    let scene = room();
    assert!(matches!(scene.with_light_groups(&LightGrouping::Objects), Err(LightGroupError::NoObject { .. })));
    let dark = scene.with_materials(
        scene.materials().iter().map(|of| patchlight::scene::Material { exitance: vec![0.0; 3], ..of.clone() }).collect(),
    );
    assert_eq!(dark.unwrap().with_light_groups(&LightGrouping::Materials), Err(LightGroupError::NoLight));

    // More channels than there may be.
    let mut many = Room::default();
    for lamp in 0..400 {
        let material = many.named_material(&format!("lamp {lamp}"), &[0.5; 3], &[1.0; 3]);
        many.quad([2.0 * f64::from(lamp), 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], material);
    }
    let many = many.scene().with_light_groups(&LightGrouping::Materials);
    assert_eq!(many, Err(LightGroupError::TooMany { groups: 400, bands: 3, most: 1024 }));

    // Options that know no groups.
    for options in [
        SolveOptions { strategy: Strategy::Hanrahan91, ..SolveOptions::default() },
        SolveOptions { bounds: Bounds::Guaranteed, ..SolveOptions::default() },
    ] {
        let refused = solve(by_material(&scene), &options, &RunOptions::default(), &Silent);
        assert!(matches!(refused.err(), Some(PipelineError::LightGroups(LightGroupError::Options))));
    }

    // Weights.
    let (grouped, _) = solved(by_material(&scene), &options(Solver::Cells, 0.3), 0);
    let relit = |group: &str, by_band: &[f64]| grouped.solution().relit(&[weight(group, by_band)]).err();
    assert!(matches!(relit("sun", &[1.0]), Some(LightGroupError::UnknownGroup { known, .. }) if known == ["lamp", "tube"]));
    for bad in [-0.5, f64::NAN, f64::INFINITY] {
        assert!(matches!(relit("lamp", &[bad]), Some(LightGroupError::BadWeight { .. })));
    }
    assert_eq!(relit("lamp", &[1.0, 2.0]), Some(LightGroupError::Bands { name: "lamp".to_owned(), given: 2, needed: 3 }));
    assert!(matches!(relit("lamp", &[1e40]), Some(LightGroupError::Scene(_))));
    let (plain, _) = solved(scene, &options(Solver::Cells, 0.3), 0);
    assert_eq!(plain.solution().relit(&[weight("lamp", &[1.0])]).err(), Some(LightGroupError::NoGroups));
}

#[test]
fn groups_are_the_same_bytes_for_any_threads_and_are_stored() {
    let points = points(&room(), 100);
    for solver in [Solver::Links, Solver::Cells] {
        let options = SolveOptions { lit_mesh: true, ..options(solver, 0.2) };
        let stored = |solution: &Solution| {
            let mut file = Cursor::new(Vec::new());
            write_solution(&mut file, solution, &Provenance::new(solution.options())).unwrap();
            file.into_inner()
        };
        let [one, two] = [1, 2].map(|threads| stored(solved(by_material(&room()), &options, threads).0.solution()));
        assert!(one == two, "{solver:?}");

        // What is read is relit to the same, again and again.
        let read = |bytes: &[u8]| read_solution_from(bytes, Path::new("in memory")).unwrap();
        let solution = read(&one);
        let at_once = solution.relit(&[weight("lamp", &[0.25]), weight("tube", &[0.0, 2.0, 0.0])]).unwrap();
        let step = read(&stored(&solution.relit(&[weight("lamp", &[0.25]), weight("tube", &[7.0])]).unwrap()));
        let in_steps = step.relit(&[weight("tube", &[0.0, 2.0, 0.0])]).unwrap();
        assert!(at_once == in_steps && stored(&at_once) == stored(&in_steps));
        assert_eq!(values(&evaluator(at_once), &points), values(&evaluator(in_steps), &points));
    }
}
