//! Reflectances near 1, slivers, fans, T-junctions.

use super::furnaces::{Place, furnace, grey};
use super::scene::HardScene;
use crate::rooms::{Room, straight};
use crate::triangles::{add, times};

/// The closed room of unit sides with a floor of its own.
fn room_without_floor(room: &mut Room, material: u32) {
    let [x, y, z] = straight(1.0, 1.0, 1.0);
    room.quad([0.0; 3], y, z, material);
    room.quad(x, z, y, material);
    room.quad([0.0; 3], z, x, material);
    room.quad(y, x, z, material);
    room.quad(z, y, x, material);
}

pub fn shapes() -> Vec<HardScene> {
    let mut scenes = nearly_white();
    scenes.extend([1e4, 1e6].map(floor_of_strips));
    scenes.extend([floor_that_is_a_fan(), t_junctions()]);
    scenes
}

/// Reflectances near 1.
fn nearly_white() -> Vec<HardScene> {
    let mut scenes = Vec::new();
    for rho in [0.9, 0.999] {
        let mut room = Room::default();
        let white = grey(&mut room, rho, 1.0);
        room.cuboid([0.0; 3], straight(1.0, 1.0, 1.0), true, |_, _| white);
        scenes.push(HardScene::uniform(format!("a cube that reflects {rho}"), room));
    }
    scenes.push(HardScene::uniform("boxes that reflect up to 0.999", furnace(Place::new(1.0), 3, [0.9, 0.999], 5)));
    scenes
}

/// Strips of a floor: each next one is thinner, to the aspect; the last is what remains.
fn floor_of_strips(aspect: f64) -> HardScene {
    let mut room = Room::default();
    let (wall, odd, even) = (grey(&mut room, 0.5, 1.0), grey(&mut room, 0.3, 1.0), grey(&mut room, 0.8, 1.0));
    room_without_floor(&mut room, wall);
    let mut at = 0.0;
    for k in 0..=10 {
        let width = if k < 10 { f64::powf(aspect, -f64::from(k + 1) / 10.0) } else { 1.0 - at };
        room.quad([at, 0.0, 0.0], [width, 0.0, 0.0], [0.0, 1.0, 0.0], if k % 2 == 0 { even } else { odd });
        at += width;
    }
    HardScene::uniform(format!("a floor of strips, aspect {aspect:e}"), room)
}

/// A fan around a corner of the floor, its blades ever thinner towards both ends.
fn floor_that_is_a_fan() -> HardScene {
    let mut room = Room::default();
    let (wall, floor) = (grey(&mut room, 0.6, 1.0), grey(&mut room, 0.4, 1.0));
    room_without_floor(&mut room, wall);
    let rim = |k: i32| {
        let angle = 0.25 * std::f64::consts::PI * (1.0 + (f64::from(k) / 30.0).powi(3));
        if k < 0 { [1.0, angle.tan(), 0.0] } else { [angle.tan().recip(), 1.0, 0.0] }
    };
    let rim = |k: i32| match k {
        -30 => [1.0, 0.0, 0.0],
        30 => [0.0, 1.0, 0.0],
        0 => [1.0, 1.0, 0.0],
        _ => rim(k),
    };
    (-30..30).for_each(|k| room.face(&[[0.0; 3], rim(k), rim(k + 1)], floor));
    HardScene::uniform("a floor that is a fan", room)
}

/// Walls in halves, the floor in thirds, the ceiling in one piece: no edge meets its like.
fn t_junctions() -> HardScene {
    let mut room = Room::default();
    let (wall, floor) = (grey(&mut room, 0.7, 1.0), grey(&mut room, 0.3, 1.0));
    for k in 0..3 {
        room.quad([f64::from(k) / 3.0, 0.0, 0.0], [1.0 / 3.0, 0.0, 0.0], [0.0, 1.0, 0.0], floor);
    }
    room.quad([0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], floor);
    for (corner, along) in [
        ([0.0; 3], [0.0, 1.0, 0.0]),
        ([1.0, 1.0, 0.0], [0.0, -1.0, 0.0]),
        ([1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]),
        ([0.0, 1.0, 0.0], [1.0, 0.0, 0.0]),
    ] {
        let half = times(along, 0.5);
        room.quad(corner, half, [0.0, 0.0, 1.0], wall);
        room.quad(add(corner, half), half, [0.0, 0.0, 1.0], wall);
    }
    HardScene::uniform("T-junctions", room)
}
