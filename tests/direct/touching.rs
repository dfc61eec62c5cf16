//! Points, sources and blockers that touch: no wrong light, no failure.

use patchlight::direct::{DirectEffort, Method, direct_irradiance};
use patchlight::scene::{Scene, SurfaceId};
use patchlight::visibility::Backend;

use crate::rooms::{Room, crowded, straight, turned};
use crate::{backend, direct, exact};

/// A box on the floor of a closed room, and one that hangs from the lamp, which is the ceiling.
fn furnished(angle: f64) -> Scene {
    let mut room = Room::default();
    let (grey, lamp) = (room.material(&[0.5], &[0.0]), room.material(&[0.0], &[1.0]));
    room.cuboid([0.0; 3], straight(2.0, 2.0, 1.0), true, |_, face| if face == 1 { lamp } else { grey });
    room.cuboid([1.0, 1.0, 0.0], turned(0.5, 0.5, 0.5, angle), false, |_, _| grey);
    room.cuboid([0.3, 0.3, 0.75], turned(0.25, 0.25, 0.25, angle), false, |_, _| grey);
    room.scene()
}

/// Corners, middles of edges and points within a rounding of them.
fn delicate_points(scene: &Scene) -> Vec<(SurfaceId, [f64; 3])> {
    let mut points = Vec::new();
    for (id, surface) in scene.surfaces().iter().enumerate() {
        let corners: Vec<[f64; 3]> = surface.polygon.vertices().collect();
        let middle = surface.polygon.centroid();
        for k in 0..corners.len() {
            let next = corners[(k + 1) % corners.len()];
            let edge: [f64; 3] = std::array::from_fn(|axis| 0.5 * (corners[k][axis] + next[axis]));
            for near in [0.0, 1e-15, 1e-12, 1e-9, 1e-6] {
                for of in [corners[k], edge] {
                    points.push((SurfaceId(id as u32), std::array::from_fn(|axis| of[axis] + near * (middle[axis] - of[axis]))));
                }
            }
        }
    }
    points
}

#[test]
fn values_at_corners_and_edges_are_between_nothing_and_everything() {
    for angle in [0.0, 0.3] {
        let scene = furnished(angle);
        let points = delicate_points(&scene);
        for method in [Method::Exact, Method::Cheaper] {
            let found = direct(&scene, &points, method, 16);
            for (point, h) in points.iter().zip(&found.irradiance) {
                assert!((-1e-12..=1.0 + 1e-12).contains(h) || method == Method::Cheaper && h.is_finite(), "{h} at {point:?}");
            }
        }
    }
}

/// Near an edge, light is what it is a little further in: it hardly changes over a millionth of a metre where nothing else begins.
#[test]
fn points_near_an_edge_get_what_points_beside_them_get() {
    let scene = furnished(0.3);
    for (surface, corner) in [(0, [1.3, 0.0, 0.0]), (0, [0.0, 1.7, 0.0])] {
        let middle = [1.0, 0.9, 0.0];
        let at = |part: f64| (SurfaceId(surface), std::array::from_fn(|k| corner[k] + part * (middle[k] - corner[k])));
        let found = exact(&scene, &[at(1e-5), at(1e-7), at(1e-9), at(1e-11)]);
        for h in &found[1..] {
            assert!((h - found[0]).abs() < 1e-4, "{found:?}");
        }
    }
}

#[test]
fn the_foot_of_a_box_is_dark_on_its_far_side_alone() {
    // A lamp of one wall: the floor right behind a high box gets nothing, and in front of it the box hides nothing.
    let mut room = Room::default();
    let (grey, lamp) = (room.material(&[0.5], &[0.0]), room.material(&[0.0], &[1.0]));
    room.quad([0.0; 3], [4.0, 0.0, 0.0], [0.0, 1.0, 0.0], grey);
    room.quad([0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], lamp);
    let empty_room = |room: Room| room.scene();
    room.cuboid([2.0, 0.0, 0.0], straight(0.5, 1.0, 1.0), false, |_, _| grey);
    let scene = empty_room(room);
    let points = [2.0 - 1e-9, 2.5, 2.5 + 1e-9].map(|x| (SurfaceId(0), [x, 0.5, 0.0]));
    let found = exact(&scene, &points);
    assert!(found[0] > 0.01 && found[1] == 0.0 && found[2] == 0.0, "{found:?}");
}

#[test]
fn what_lies_on_a_source_or_in_its_plane_hides_nothing_but_what_stands_on_it_does() {
    let with = |blocker: Option<[[f64; 3]; 4]>| {
        let mut room = Room::default();
        let (grey, lamp) = (room.material(&[0.5], &[0.0]), room.material(&[0.0], &[1.0]));
        room.quad([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], grey);
        room.quad([0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], lamp);
        blocker.iter().for_each(|blocker| room.sheet(blocker, grey));
        exact(&room.scene(), &[(SurfaceId(0), [0.2, 0.5, 0.0])])[0]
    };
    let bare = with(None);
    assert_eq!(with(Some([[0.2, 0.2, 1.0], [0.8, 0.2, 1.0], [0.8, 0.8, 1.0], [0.2, 0.8, 1.0]])), bare);
    assert_eq!(with(Some([[0.2, 0.2, 0.0], [0.8, 0.2, 0.0], [0.8, 0.8, 0.0], [0.2, 0.8, 0.0]])), bare);
    // A fin below the source, and the same fin with most of it above.
    let fin = |top: f64| [[0.6, 0.0, 0.9], [0.6, 1.0, 0.9], [0.6, 1.0, top], [0.6, 0.0, top]];
    let standing = with(Some(fin(1.0)));
    assert!(standing < bare - 1e-3);
    assert!((with(Some(fin(5.0))) - standing).abs() < 1e-14);
}

#[test]
fn threads_and_company_change_nothing() {
    let scene = crowded(30, 7);
    let points: Vec<_> = delicate_points(&scene).into_iter().step_by(7).collect();
    let visibility = backend(&scene, Backend::Auto);
    let effort = DirectEffort { rays: 12, method: Method::Cheaper };
    let with = |threads: usize, points: &[(SurfaceId, [f64; 3])]| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| direct_irradiance(&scene, &*visibility, points, effort, 3))
    };
    let all = with(3, &points);
    assert!(all.rays > 0);
    assert_eq!(with(1, &points), all);
    let single: Vec<f64> = points.iter().flat_map(|&point| with(1, &[point]).irradiance).collect();
    assert_eq!(single, all.irradiance);
}
