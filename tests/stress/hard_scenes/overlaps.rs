//! Surfaces that lie in, on or inside one another.

use patchlight::scene::SurfaceId;

use super::furnaces::{MODERATE, Place, furnace, grey};
use super::scene::HardScene;
use crate::rooms::{Room, straight, turned};
use crate::triangles::{dot, sub};

/// A room with a plate that floats so high above the floor.
fn room_with_a_plate(gap: f64) -> Room {
    let mut room = furnace(Place::new(1.0), 0, MODERATE, 9);
    let plate = grey(&mut room, 0.5, 1.0);
    room.cuboid([1.0, 1.0, gap], straight(1.5, 1.0, 0.05), false, |_, _| plate);
    room
}

pub fn overlaps() -> Vec<HardScene> {
    let mut scenes = in_one_plane();
    // Light comes into the gap from its rim alone.
    for gap in [1e-2, 1e-4, 1e-5] {
        scenes.push(HardScene::uniform(format!("a plate {gap:e} above the floor"), room_with_a_plate(gap)));
    }
    scenes.extend([plate_on_the_floor(), sheets(), nested_boxes(), boxes_through_each_other()]);
    scenes
}

fn in_one_plane() -> Vec<HardScene> {
    let mut scenes = Vec::new();
    let sides = straight(1.0, 1.0, 1.0);

    let mut room = Room::default();
    let (wall, rug) = (grey(&mut room, 0.5, 1.0), grey(&mut room, 0.8, 1.0));
    room.cuboid([0.0; 3], sides, true, |_, _| wall);
    room.quad([0.2, 0.3, 0.0], [0.5, 0.0, 0.0], [0.0, 0.4, 0.0], rug);
    scenes.push(HardScene::uniform("a rug in the very plane of the floor", room));

    let mut room = Room::default();
    let materials = [0.3, 0.6].map(|rho| grey(&mut room, rho, 1.0));
    materials.iter().for_each(|&material| room.cuboid([0.0; 3], sides, true, |_, _| material));
    scenes.push(HardScene::uniform("every wall twice", room));
    scenes
}

/// Within a millionth of the scene all is one plane: the plate lies on the floor, and what is between is dark.
fn plate_on_the_floor() -> HardScene {
    let scene = room_with_a_plate(1e-6).scene();
    let exitance = [0, 6].map(|surface| scene.material_of(SurfaceId(surface)).exitance[0]);
    HardScene::new("a plate that lies on the floor but for 1e-6", scene, move |point, surface| {
        let [x, y, _] = point.position;
        match surface {
            0 if (1.0..2.5).contains(&x) && (1.0..2.0).contains(&y) => exitance[0],
            6 => exitance[1],
            _ => 1.0,
        }
    })
}

fn sheets() -> HardScene {
    let mut room = furnace(Place::new(1.0), 0, MODERATE, 10);
    let sheet = grey(&mut room, 0.6, 1.0);
    for k in 0..5 {
        let x = 0.5 + 0.6 * f64::from(k);
        room.sheet(&[[x, 0.3, 0.4], [x + 0.2, 2.0, 0.4], [x + 0.2, 2.0, 2.0], [x, 0.3, 2.0]], sheet);
    }
    HardScene::uniform("sheets without thickness", room)
}

/// A closed box in a closed room, with another light inside.
fn nested_boxes() -> HardScene {
    let mut room = furnace(Place::new(1.0), 0, MODERATE, 11);
    let (outside, inside) = (grey(&mut room, 0.5, 1.0), grey(&mut room, 0.7, 3.0));
    room.cuboid([1.0, 0.8, 0.5], straight(1.0, 1.0, 1.0), false, |_, _| outside);
    let inner = [1.02, 0.82, 0.52];
    room.cuboid(inner, straight(0.96, 0.96, 0.96), true, |_, _| inside);
    HardScene::new("nested closed boxes", room.scene(), |_, surface| if surface < 12 { 1.0 } else { 3.0 })
}

/// Two boxes through each other: what is inside the other sees its backs alone.
fn boxes_through_each_other() -> HardScene {
    let mut room = furnace(Place::new(1.0), 0, MODERATE, 12);
    let material = grey(&mut room, 0.5, 1.0);
    let boxes = [([1.0, 0.8, 0.6], turned(1.2, 0.6, 0.5, 0.2)), ([1.5, 0.6, 0.8], turned(0.5, 1.3, 0.9, 0.1))];
    boxes.iter().for_each(|(corner, sides)| room.cuboid(*corner, *sides, false, |_, _| material));
    let is_inside = move |point: [f64; 3], (corner, sides): &([f64; 3], [[f64; 3]; 3])| {
        let from_corner = sub(point, *corner);
        sides.iter().all(|side| (0.0..1.0).contains(&(dot(from_corner, *side) / dot(*side, *side))))
    };
    HardScene::new("boxes through each other", room.scene(), move |point, surface| {
        let other = match surface {
            0..6 => return 1.0,
            6..12 => boxes[1],
            _ => boxes[0],
        };
        if is_inside(point.position, &other) { 0.5 } else { 1.0 }
    })
}
