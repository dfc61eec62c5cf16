//! Bakes that take from an earlier one: held against gathers with sixty times the rays in the scene as it is now, and against a bake without.
#![allow(clippy::print_stdout, reason = "a test tells what it measured")]

use std::io::Cursor;

use patchlight::bake::{Atlas, BakeError, BakeOptions, BakeRecord, EarlierProblem, Lightmap};
use patchlight::output::{Provenance, read_bake_record, write_bake_record};
use patchlight::pipeline::Evaluator;
use patchlight::progress::Silent;
use patchlight::scene::{Scene, SurfacePoint};
use patchlight::solve::{RunOptions, SolveOptions};

use super::rooms::{Room, cube, regathered, solve, straight, values};
use super::triangles::Random;
use super::{middles, options, texel};

/// What changes in the room: the reflectance of the box, where it stands, and how bright the lamp is.
#[derive(Clone, Copy)]
struct Furnished {
    wood: f64,
    x: f64,
    lamp: f64,
}

const BEFORE: Furnished = Furnished { wood: 0.4, x: 0.813, lamp: 20.0 };

impl Furnished {
    fn scene(self) -> Scene {
        let mut room = Room::default();
        let (wall, wood) = (room.material(&[0.7], &[0.0]), room.material(&[self.wood], &[0.0]));
        let lamp = room.material(&[0.0], &[self.lamp]);
        room.cuboid([0.0; 3], straight(2.0, 2.0, 2.0), true, |_, _| wall);
        room.quad([0.2, 0.2, 1.9], [0.0, 0.6, 0.0], [0.6, 0.0, 0.0], lamp);
        room.cuboid([self.x, 0.927, 0.0], straight(0.5, 0.4, 0.3), false, |_, _| wood);
        room.scene()
    }
}

/// Values take as many rays before a change as after it: with other numbers of rays their noise is another, and less can be kept.
fn solved(scene: Scene) -> Evaluator {
    solve(scene, &SolveOptions { error: 0.02, point_rays: Some(512), ..SolveOptions::default() }).0
}

fn kept() -> BakeOptions {
    BakeOptions { keep: true, ..options(0.04) }
}

fn atlas(evaluator: &Evaluator, options: &BakeOptions) -> Atlas {
    Atlas::new(evaluator.solution().scene(), options).unwrap()
}

fn fresh(evaluator: &Evaluator) -> Lightmap {
    evaluator.bake(&atlas(evaluator, &kept()), None, &Silent).unwrap().unwrap()
}

fn since(evaluator: &Evaluator, earlier: &BakeRecord) -> Lightmap {
    evaluator.bake_since(&atlas(evaluator, &kept()), earlier, None, &Silent).unwrap().unwrap()
}

/// How far a lightmap is off at random texels that are covered whole, by the measure of the claim.
fn off(evaluator: &Evaluator, lightmap: &Lightmap, now: Furnished) -> f64 {
    let scene = evaluator.solution().scene();
    let mut random = Random(7);
    let mut drawn: Vec<(usize, [f64; 2], SurfacePoint)> = Vec::new();
    // Where the box stands on a part of a texel, its value is taken elsewhere in it.
    let is_at_foot = |[x, y, z]: [f64; 3]| z < 0.05 && (now.x - 0.05..now.x + 0.55).contains(&x) && (0.87..1.38).contains(&y);
    for face in lightmap.atlas.faces(scene) {
        let is_lit = scene.materials()[scene.surfaces()[face.surface as usize].material as usize].reflectance[0] > 0.0;
        let texels = middles(scene, lightmap, &face).into_iter().filter(|(_, point)| is_lit && !is_at_foot(point.position));
        drawn.extend(texels.filter(|_| random.unit() < 0.1).map(|(at, point)| (face.page, at, point)));
    }
    let points: Vec<SurfacePoint> = drawn.iter().map(|(_, _, point)| *point).collect();
    let exact = values(&regathered(evaluator, 16384, 3), &points);
    let mut light = exact.clone();
    light.sort_by(f64::total_cmp);
    let typical = light[light.len() / 2];
    let off_sq = |((page, at, _), exact): (&(usize, [f64; 2], SurfacePoint), &f64)| {
        ((texel(lightmap, *page, *at)[0] - exact) / exact.max(typical)).powi(2)
    };
    (drawn.iter().zip(&exact).map(off_sq).sum::<f64>() / exact.len() as f64).sqrt()
}

/// The part of the texels that a bake of the room, changed from what it was, kept of direct and of indirect light.
fn kept_after(change: &str, now: Furnished) -> [f64; 2] {
    let earlier = fresh(&solved(BEFORE.scene())).record.unwrap();
    let evaluator = solved(now.scene());
    let (lightmap, without) = (since(&evaluator, &earlier), fresh(&evaluator));
    let (found, found_without) = (off(&evaluator, &lightmap, now), off(&evaluator, &without, now));
    let report = &lightmap.report;
    let told = report.whole.unwrap();
    println!("{change}: {found:.4} off, {told:.4} told; without {found_without:.4}, {:?}; {report:?}", without.report.gathered);
    assert!(found < told, "{change}: {found} off, {told} told");
    // Both errors of all texels, each as asked for, and twice the noise of the scene's values.
    assert!(told < 0.05, "{change}: {told}");
    report.kept.map(|kept| kept.texels as f64 / report.texels as f64)
}

#[test]
fn where_nothing_changed_most_light_is_kept() {
    let [direct, indirect] = kept_after("nothing", BEFORE);
    assert!(direct > 0.7 && indirect > 0.7, "{direct} {indirect}");
}

#[test]
fn light_of_a_changed_reflectance_is_the_earlier_light_with_the_change() {
    let [direct, indirect] = kept_after("reflectance", Furnished { wood: 0.1, ..BEFORE });
    assert!(direct > 0.7 && indirect > 0.7, "{direct} {indirect}");
}

#[test]
fn a_box_takes_its_shadow_along() {
    let now = Furnished { x: 1.213, ..BEFORE };
    let [direct, indirect] = kept_after("place", now);
    // Walls and ceiling are as they were; floor and box are not.
    assert!((0.3..0.95).contains(&direct) && (0.3..0.95).contains(&indirect), "{direct} {indirect}");
}

#[test]
fn twice_the_light_is_found_whatever_was_kept() {
    kept_after("lamp", Furnished { lamp: 40.0, ..BEFORE });
}

#[test]
fn an_earlier_bake_that_does_not_fit_is_refused() {
    let evaluator = solved(BEFORE.scene());
    let earlier = fresh(&evaluator).record.unwrap();
    let refused = |evaluator: &Evaluator, options: &BakeOptions| match evaluator.bake_since(
        &atlas(evaluator, options),
        &earlier,
        None,
        &Silent,
    ) {
        Err(BakeError::Earlier(problem)) => problem,
        other => panic!("{:?}", other.map(|lightmap| lightmap.map(|lightmap| lightmap.report))),
    };
    assert_eq!(refused(&evaluator, &options(0.05)), EarlierProblem::Texel { earlier: 0.04, now: 0.05 });
    assert_eq!(refused(&evaluator, &BakeOptions { separate: true, ..kept() }), EarlierProblem::Parts);
    let finer = solve(BEFORE.scene(), &SolveOptions { error: 0.01, ..SolveOptions::default() }).0;
    assert_eq!(refused(&finer, &kept()), EarlierProblem::Error { earlier: 0.02, now: 0.01 });
    assert_eq!(refused(&solved(cube(&[0.5], &[1.0])), &kept()), EarlierProblem::Nothing);
    let coloured = solved(cube(&[0.5; 3], &[1.0; 3]));
    assert_eq!(refused(&coloured, &kept()), EarlierProblem::Channels { earlier: 1, now: 3 });
}

#[test]
fn a_record_is_written_and_read_and_threads_change_nothing() {
    let evaluator = solved(BEFORE.scene());
    let record = fresh(&evaluator).record.unwrap();
    let mut bytes = Cursor::new(Vec::new());
    write_bake_record(&mut bytes, &record, &Provenance::new(evaluator.solution().options())).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("room.bake");
    std::fs::write(&path, bytes.get_ref()).unwrap();
    let read = read_bake_record(&path).unwrap();

    let now = solved(Furnished { wood: 0.1, ..BEFORE }.scene());
    let on = |threads: usize| {
        let evaluator = Evaluator::new(now.solution().clone(), &RunOptions { threads, ..RunOptions::default() }).unwrap();
        since(&evaluator, &read)
    };
    assert!(on(1) == on(2) && on(1) == since(&now, &record));

    // Damage is told, whatever it is.
    for at in [0, 9, 15, 22, 60, bytes.get_ref().len() - 1] {
        let mut damaged = bytes.get_ref().clone();
        damaged[at] ^= 1;
        std::fs::write(&path, damaged).unwrap();
        assert!(read_bake_record(&path).unwrap_err().to_string().ends_with("bake the scene again with --keep"), "{at}");
    }
}
