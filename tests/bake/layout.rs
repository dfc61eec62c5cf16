//! Where charts lie, and which are baked.

use std::collections::BTreeMap;

use patchlight::bake::{Atlas, BakeError, BakeOptions, Only};
use patchlight::pipeline::Evaluator;
use patchlight::progress::Silent;
use patchlight::scene::SurfacePoint;
use patchlight::solve::{RunOptions, SolveOptions};

use super::rooms::{crowded, cube, solve};
use super::{apart, middles, options, room_with_box, texel};

#[test]
fn charts_lie_apart_on_as_many_pages_as_it_takes_and_hold_their_faces() {
    let scene = crowded(12, 3);
    for size in [4096, 128] {
        let options = BakeOptions { size, ..options(0.05) };
        let atlas = Atlas::new(&scene, &options).unwrap();
        assert_eq!(atlas.pages().len() > 1, size == 128);
        assert!(atlas.pages().iter().flatten().all(|&side| side <= size));
        assert_eq!(atlas.faces(&scene).count(), scene.surfaces().len());

        // The box of each chart in texels, which all of its faces lie in, keeps the padding of both from others.
        let mut boxes: BTreeMap<usize, (usize, [[f64; 2]; 2])> = BTreeMap::new();
        for face in atlas.faces(&scene) {
            let page = atlas.pages()[face.page].map(f64::from);
            let of_chart = boxes.entry(face.chart).or_insert((face.page, [[f64::INFINITY; 2], [0.0; 2]]));
            for uv in &face.uv {
                assert!(uv.iter().all(|part| (0.0..=1.0).contains(part)));
                for axis in 0..2 {
                    of_chart.1[0][axis] = of_chart.1[0][axis].min(uv[axis] * page[axis]);
                    of_chart.1[1][axis] = of_chart.1[1][axis].max(uv[axis] * page[axis]);
                }
            }
        }
        let boxes: Vec<_> = boxes.into_values().collect();
        for (number, (page, [from, to])) in boxes.iter().enumerate() {
            for (other_page, [other_from, other_to]) in &boxes[..number] {
                let gap =
                    (0..2).map(|axis| (from[axis] - other_to[axis]).max(other_from[axis] - to[axis])).fold(f64::MIN, f64::max);
                assert!(page != other_page || gap >= 4.0 - 1e-9, "{gap}");
            }
        }
    }
}

#[test]
fn a_lightmap_is_the_same_for_any_number_of_threads_and_reads_a_mesh_as_it_is() {
    let options = SolveOptions { error: 0.1, lit_mesh: true, ..SolveOptions::default() };
    let solution = solve(room_with_box(), &options).0.solution().clone();
    let scene = solution.scene().clone();
    let atlas = Atlas::new(&scene, &super::options(0.05)).unwrap();
    let evaluator = |threads: usize| Evaluator::new(solution.clone(), &RunOptions { threads, ..RunOptions::default() }).unwrap();
    let (one, two) = (evaluator(1), evaluator(2));
    let lightmap = |of: &Evaluator, mesh: bool| of.bake(&atlas, of.mesh().filter(|_| mesh), &Silent).unwrap().unwrap();
    assert!(lightmap(&one, false) == lightmap(&two, false));
    let read = lightmap(&one, true);
    assert!(read == lightmap(&two, true) && read.report.gathered == [0; 2]);

    // Walls that nothing stands on: every texel is the mesh at its middle.
    let face = atlas.faces(&scene).find(|face| scene.surfaces()[face.surface as usize].polygon.normal()[0] > 0.5).unwrap();
    let texels = middles(&scene, &read, &face);
    let points: Vec<SurfacePoint> = texels.iter().map(|(_, point)| *point).collect();
    let of_mesh = one.mesh_values_at(&points).unwrap().radiosity;
    let (_, most) = apart(texels.iter().zip(&of_mesh).map(|((at, _), &b)| (texel(&read, face.page, *at)[0], f64::from(b))));
    assert!(most < 1e-4, "{most}");
}

#[test]
fn parts_are_baked_by_name_and_what_cannot_be_is_refused() {
    let scene = room_with_box();
    let only = |name: &str| BakeOptions { only: Some(Only::Material(name.to_owned())), ..options(0.05) };
    let wood = Atlas::new(&scene, &only("m1")).unwrap();
    assert!(wood.faces(&scene).all(|face| scene.surfaces()[face.surface as usize].material == 1));
    assert_eq!(wood.faces(&scene).count(), 6);
    assert!(matches!(Atlas::new(&scene, &only("stone")), Err(BakeError::Nothing { kind: "material", .. })));
    assert!(matches!(Atlas::new(&scene, &options(1e-6)), Err(BakeError::TooMany { .. })));
    assert!(matches!(Atlas::new(&scene, &options(f64::NAN)), Err(BakeError::BadTexel(_))));
    let small = BakeOptions { size: 16, ..options(0.05) };
    assert!(matches!(Atlas::new(&scene, &small), Err(BakeError::ChartTooLarge { size: 16, .. })));

    // An atlas of another scene.
    let evaluator = solve(cube(&[0.5], &[1.0]), &SolveOptions { error: 0.5, ..SolveOptions::default() }).0;
    assert_eq!(evaluator.bake(&wood, None, &Silent), Err(BakeError::OtherScene));
}
