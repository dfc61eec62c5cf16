//! Where no path can bring light, none arrives; and what no light meets changes nothing.

#[path = "support/rooms.rs"]
mod rooms;
#[path = "support/triangles.rs"]
mod triangles;

use patchlight::scene::{Scene, SurfacePoint};
use patchlight::solve::{CellOptions, SolveOptions, Solver, StoppedBy};
use rooms::{Room, solve, straight, values};

/// Points just inside the edges of a box, and in the middles of its faces, on all six faces seen from inside.
fn inside(corner: [f64; 3], sides: [f64; 3]) -> Vec<SurfacePoint> {
    let mut points = Vec::new();
    for axis in 0..3 {
        for (end, sign) in [(0.0, 1.0), (1.0, -1.0)] {
            for (s, t) in [(0.5, 0.5), (0.001, 0.3), (0.7, 0.999), (0.01, 0.99)] {
                let mut at = [s; 3];
                (at[axis], at[(axis + 1) % 3]) = (end, t);
                let mut normal = [0.0; 3];
                normal[axis] = sign;
                points.push(SurfacePoint { position: std::array::from_fn(|k| corner[k] + at[k] * sides[k]), normal });
            }
        }
    }
    points
}

fn options(solver: Solver, error: f64, seed: u64) -> SolveOptions {
    SolveOptions { error, solver, seed, ..SolveOptions::default() }
}

#[test]
fn a_sealed_box_of_thin_walls_is_dark_inside() {
    // Cells are as large as the box, and its walls stand across them.
    let (corner, sides) = ([1.37, 1.21, 0.0], [0.31, 0.23, 0.2]);
    let room = || {
        let mut room = Room::default();
        let (grey, lamp) = (room.material(&[0.7], &[0.0]), room.material(&[0.0], &[10.0]));
        room.cuboid([0.0; 3], straight(4.0, 4.0, 2.5), true, |_, face| if face == 1 { lamp } else { grey });
        let [x, y, z] = sides;
        room.cuboid(corner, straight(x, y, z), false, |_, _| grey);
        room.cuboid(corner, straight(x, y, z), true, |_, _| grey);
        room.scene()
    };
    for (error, seed) in [(0.1, 0), (0.05, 1), (0.02, 2)] {
        let (evaluator, _) = solve(room(), &options(Solver::Cells, error, seed));
        let found = values(&evaluator, &inside(corner, sides));
        assert!(found.iter().all(|&value| value == 0.0), "at {error}: {found:?}");
    }
}

#[test]
fn a_room_behind_double_walls_is_dark_over_links_and_over_cells() {
    let room = || {
        let mut room = Room::default();
        let (grey, lamp) = (room.material(&[0.7], &[0.0]), room.material(&[0.5], &[10.0]));
        room.cuboid([0.0; 3], straight(4.0, 4.0, 3.0), true, |_, _| grey);
        room.cuboid([4.1, 0.0, 0.0], straight(3.9, 4.0, 3.0), true, |_, _| grey);
        room.quad([1.5, 1.5, 2.9], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], lamp);
        room.scene()
    };
    for solver in [Solver::Links, Solver::Cells] {
        for (error, seed) in [(0.05, 0), (0.02, 1)] {
            let (evaluator, _) = solve(room(), &options(solver, error, seed));
            let found = values(&evaluator, &inside([4.1, 0.0, 0.0], [3.9, 4.0, 3.0]));
            assert!(found.iter().all(|&value| value == 0.0), "{solver:?} at {error}: {found:?}");
        }
    }
}

#[test]
fn a_black_box_around_changes_nothing() {
    // The open side of the room looks at the back of a black face, from a tenth of its depth: more than half of the rays from walls beside
    // it meet that.
    let room = |boxed: bool| {
        let mut room = Room::default();
        let (grey, lamp, black) = (room.material(&[0.6], &[0.0]), room.material(&[0.0], &[10.0]), room.material(&[0.0], &[0.0]));
        for (corner, u, v) in [
            ([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]),
            ([0.0; 3], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]),
            ([0.0; 3], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]),
            ([1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]),
            ([0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]),
        ] {
            room.quad(corner, u, v, grey);
        }
        room.quad([0.3, 0.3, 0.99], [0.0, 0.4, 0.0], [0.4, 0.0, 0.0], lamp);
        if boxed {
            room.cuboid([-0.1; 3], straight(1.2, 1.2, 1.2), false, |_, _| black);
        }
        room.scene()
    };
    let points: Vec<SurfacePoint> = (0..64)
        .map(|k| [f64::from(k % 8), f64::from(k / 8)].map(|along| (along + 0.5) / 8.0))
        .map(|[x, y]| SurfacePoint { position: [x, y, 0.0], normal: [0.0, 0.0, 1.0] })
        .collect();
    for solver in [Solver::Links, Solver::Cells] {
        let [(alone, report), (boxed, report_boxed)] =
            [false, true].map(|is_boxed| solve(room(is_boxed), &options(solver, 0.01, 0)));
        let [alone, boxed] = [alone, boxed].map(|evaluator| values(&evaluator, &points));
        let norm: f64 = alone.iter().map(|value| value * value).sum();
        let apart: f64 = alone.iter().zip(&boxed).map(|(a, b)| (a - b).powi(2)).sum();
        // Either is claimed to be within 1%.
        assert!((apart / norm).sqrt() < 0.02, "{solver:?}: {}", (apart / norm).sqrt());
        let links = [report, report_boxed].map(|report| report.counts.links);
        assert!(links[1] < 2 * links[0], "{solver:?}: {links:?}");
    }
}

#[test]
fn the_foot_of_a_box_that_hovers_sees_the_lit_floor() {
    // The floor under the box is dark, though no back stands over it; elements reach from there into the light.
    let room = || {
        let mut room = Room::default();
        let (grey, lamp) = (room.material(&[0.7], &[0.0]), room.material(&[0.0], &[10.0]));
        room.cuboid([0.0; 3], straight(10.0, 10.0, 5.0), true, |_, _| grey);
        room.cuboid([3.0, 3.0, 0.001], straight(3.0, 3.0, 1.0), false, |_, _| grey);
        room.quad([4.0, 6.0, 4.9], [0.0, 2.0, 0.0], [2.0, 0.0, 0.0], lamp);
        room.scene()
    };
    let points: Vec<SurfacePoint> = (0..24)
        .map(|k| SurfacePoint {
            position: [3.06 + 0.125 * f64::from(k), 6.0, 0.01 + 0.003 * f64::from(k)],
            normal: [0.0, 1.0, 0.0],
        })
        .collect();
    let mean = |solver, error, seed| {
        let (evaluator, _) = solve(room(), &options(solver, error, seed));
        values(&evaluator, &points).iter().sum::<f64>() / points.len() as f64
    };
    let expected = mean(Solver::Cells, 0.01, 7);
    for seed in 0..4 {
        // Asked for 5% over all surfaces; here it may be twice that.
        let found = mean(Solver::Links, 0.05, seed);
        assert!((found / expected - 1.0).abs() < 0.1, "seed {seed}: {found} instead of {expected}");
    }
}

/// A room of 6 x 2 x 2 m that a thin wall divides: a lamp in the smaller part, 62% of the area beyond, and a square hole of this side.
fn divided_room(hole: f64) -> Scene {
    let mut room = Room::default();
    let (grey, lamp) = (room.material(&[0.7], &[0.0]), room.material(&[0.0], &[10.0]));
    room.cuboid([0.0; 3], straight(6.0, 2.0, 2.0), true, |_, _| grey);
    room.quad([0.5, 0.5, 1.9], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], lamp);
    let (low, high) = (1.0 - 0.5 * hole, 1.0 + 0.5 * hole);
    let pieces = if hole > 0.0 {
        vec![([0.0, 0.0], [low, 2.0]), ([high, 0.0], [2.0, 2.0]), ([low, 0.0], [high, low]), ([low, high], [high, 2.0])]
    } else {
        vec![([0.0, 0.0], [2.0, 2.0])]
    };
    for ([y, z], [far_y, far_z]) in pieces {
        room.sheet(&[[2.0, y, z], [2.0, far_y, z], [2.0, far_y, far_z], [2.0, y, far_z]], grey);
    }
    room.scene()
}

#[test]
fn light_through_a_small_hole_is_not_taken_for_none() {
    // So little light comes through that most paths find none: values are as good as 0 on most of the area, or noise. `max_links` ends the solve
    // at its first estimate.
    let solved = |hole: f64, solver, error, seed| {
        solve(divided_room(hole), &SolveOptions { max_links: Some(1), ..options(solver, error, seed) }).1
    };
    for hole in [0.02, 0.03, 0.05] {
        for (error, seed) in [(0.1, 0), (0.05, 1), (0.05, 2), (0.02, 3)] {
            let report = solved(hole, Solver::Cells, error, seed);
            assert!(report.error.estimate > 0.5 && !report.converged, "{hole} m, {error}, seed {seed}: {:?}", report.error);
        }
    }
    // Where there is no hole, the dark part does not count.
    for (error, seed) in [(0.1, 0), (0.05, 1)] {
        let (_, report) = solve(divided_room(0.0), &options(Solver::Cells, error, seed));
        assert!(report.converged && (0.3..0.45).contains(&report.error.lit), "{:?}", report.error);
    }
}

#[test]
fn where_light_is_too_rare_to_tell_the_rest_is_right_all_the_same() {
    // A hole of 4 mm takes a few millionths of the light. Of a hundred thousand paths that search for light beyond some find it, or none does; of
    // the few that cells have here hardly ever any. The error is one over all that is lit: it is judged all over the lit part, and not beside the hole.
    let middles = || (0..100).map(|k| [k % 10, k / 10].map(|at| (f64::from(at) + 0.5) / 5.0));
    let of_face = |axis: usize, end: f64, sign: f64| {
        middles().map(move |[s, t]| {
            let (mut position, mut normal) = ([s; 3], [0.0; 3]);
            (position[axis], position[(axis + 1) % 3], normal[axis]) = (end, t, sign);
            SurfacePoint { position, normal }
        })
    };
    let points: Vec<SurfacePoint> = (0..3).flat_map(|axis| of_face(axis, 0.0, 1.0).chain(of_face(axis, 2.0, -1.0))).collect();
    let truth = values(&solve(divided_room(0.0), &options(Solver::Cells, 0.01, 9)).0, &points);
    let cells = CellOptions { positions: Some(1024), position_rays: Some(4) };
    let (error, mut left_out) = (0.1, 0);
    for seed in 0..8 {
        let (evaluator, report) = solve(divided_room(0.004), &SolveOptions { cells, ..options(Solver::Cells, error, seed) });
        let told = report.error;
        let claimed = match told.where_found {
            Some(found) => {
                assert!(!report.converged && report.stopped_by == StoppedBy::Exhausted && told.estimate.is_infinite());
                left_out += 1;
                found.estimate
            }
            None => told.estimate,
        };
        assert!(claimed <= error && (0.3..0.45).contains(&told.lit), "seed {seed}: {told:?}, {:?}", report.stopped_by);

        let found = values(&evaluator, &points);
        let squares = |of: &mut dyn Iterator<Item = f64>| of.map(|x| x * x).sum::<f64>();
        let off = squares(&mut found.iter().zip(&truth).map(|(found, truth)| found - truth)) / squares(&mut truth.iter().copied());
        assert!(off.sqrt() < error, "seed {seed}: {} for {error}", off.sqrt());
    }
    assert!(left_out > 0);
}

#[test]
fn light_that_few_rays_meet_takes_more_of_them() {
    // Finer cells leave the error as it is: what is missing is light through a hole that a ray in a thousand meets.
    for seed in [1, 2] {
        let (_, report) = solve(divided_room(0.12), &options(Solver::Cells, 0.2, seed));
        assert!(report.converged, "seed {seed}: {:?}, {:?}", report.error, report.stopped_by);
    }
}
