//! Rooms made at random, to look for faults where no one has looked.

use super::super::path_tracer::Portal;
use super::super::rooms::Room;
use super::super::triangles::Random;
use super::made::Made;
use super::parts::{Rectangle, matt, sides, solid};

/// Furniture keeps so far from walls and from each other, in metres.
const APART: f64 = 0.12;

/// Two rooms, light or dark, with furniture of many kinds; the wall between them has a door, a slit, a hole, or slats in it; one of them or both are lit, directly
/// or from a cove, out of a shade or a housing. The same number gives the same room.
pub fn random_room(number: u64) -> Made {
    let random = &mut Random(number);
    let mut room = Room::default();
    let [length, depth, height] = [[4.0, 8.0], [2.5, 5.0], [2.3, 3.2]].map(|[low, high]| random.between(low, high));
    let (wall, thickness) = (length * random.between(0.35, 0.65), random.between(0.02, 0.25));
    let holes = openings(random, wall, [depth, height]);
    let halves = [([0.0; 3], [wall, depth, height]), ([wall + thickness, 0.0, 0.0], [length + thickness, depth, height])];

    let brightness = random.between(0.15, 0.95);
    let [floor, plaster, wood] = [("floor", 0.3, 0.8), ("plaster", 0.6, 1.0), ("wood", 0.2, 1.0)].map(|(name, low, high)| {
        let rho = random.between(low, high) * brightness;
        matt(&mut room, name, [rho, 0.97 * rho, 0.92 * rho])
    });
    for (k, (low, high)) in halves.into_iter().enumerate() {
        for (side, is_far) in sides(low, high) {
            let material = if side.axis == 2 && !is_far { floor } else { plaster };
            let pieces = if side.axis == 0 && is_far == (k == 0) { around_all(side, &holes) } else { vec![side] };
            pieces.into_iter().for_each(|piece| piece.add_to(&mut room, !is_far, material));
        }
        furnish(&mut room, random, (low, high), wood);
    }
    holes.iter().for_each(|hole| hole.reveals(&mut room, wall + thickness, plaster));

    for (half, name, exitance) in [(halves[0], "lamp", 100.0), (halves[1], "other_lamp", random.between(1.0, 100.0))] {
        if name == "lamp" || random.below(2) == 0 {
            let lamp = room.named_material(name, &[0.0; 3], &[exitance, 0.92 * exitance, 0.8 * exitance]);
            hang(&mut room, random, half, [lamp, plaster]);
        }
    }
    let [first, last] = [&holes[0], &holes[holes.len() - 1]];
    let [width, height] = [0, 1].map(|k| last.high[k] - first.low[k]);
    let corner = [wall + thickness, first.low[0], first.low[1]];
    Made::of(room).through(Portal { corner, u: [0.0, width, 0.0], v: [0.0, 0.0, height] })
}

/// What is open in a wall of a depth and a height: side by side, from y = 0 on.
fn openings(random: &mut Random, at: f64, [depth, height]: [f64; 2]) -> Vec<Rectangle> {
    let opening = |low: [f64; 2], high: [f64; 2]| Rectangle { axis: 0, at, low, high };
    let middle = depth * random.between(0.3, 0.7);
    let [half_door, half_slit, half_hole] = [[0.35, 0.5], [0.01, 0.06], [0.04, 0.3]].map(|[low, high]| random.between(low, high));
    match random.below(4) {
        0 => vec![opening([middle - half_door, 0.01], [middle + half_door, 2.0])],
        1 => vec![opening([middle - half_slit, 0.02], [middle + half_slit, height - 0.02])],
        2 => vec![opening([middle - half_hole, 1.0 - half_hole], [middle + half_hole, 1.0 + half_hole])],
        _ => {
            let spacing = random.between(0.05, 0.25);
            let width = spacing * random.between(0.1, 0.7);
            let count = (0.6 * depth / spacing).floor().min(9.0);
            let first = 0.5 * (depth - spacing * count);
            let slot = |k: u32| first + spacing * f64::from(k);
            (0..count as u32).map(|k| opening([slot(k), 0.3], [slot(k) + width, height - 0.3])).collect()
        }
    }
}

/// A wall without its openings: cut between these, each piece lies around one.
fn around_all(wall: Rectangle, holes: &[Rectangle]) -> Vec<Rectangle> {
    let cut = |k: usize| match (k.checked_sub(1).and_then(|before| holes.get(before)), holes.get(k)) {
        (None, _) => wall.low[0],
        (_, None) => wall.high[0],
        (Some(before), Some(after)) => 0.5 * (before.high[0] + after.low[0]),
    };
    let piece = |(k, hole): (usize, &Rectangle)| {
        let [low, high] = [(cut(k), wall.low[1]), (cut(k + 1), wall.high[1])].map(|(y, z)| [y, z]);
        Rectangle { low, high, ..wall }.around(*hole)
    };
    holes.iter().enumerate().flat_map(piece).collect()
}

/// In each quarter of the floor a table, a block, a stack of boards, or nothing.
fn furnish(room: &mut Room, random: &mut Random, (low, high): ([f64; 3], [f64; 3]), wood: u32) {
    for quarter in 0..4 {
        let [x, y] = [0, 1].map(|axis| {
            let half = 0.5 * (high[axis] - low[axis]);
            let start = low[axis] + f64::from(quarter >> axis & 1) * half + APART;
            let room_for = half - 2.0 * APART;
            let size = room_for * random.between(0.4, 0.95);
            let from = start + (room_for - size) * random.unit();
            [from, from + size]
        });
        let mut block = |from: f64, to: f64| solid(room, [x[0], y[0], from], [x[1], y[1], to], wood);
        match random.below(4) {
            0 => block(0.7, 0.74),
            1 => block(0.0, random.between(0.2, 1.2)),
            2 => {
                let gap = random.between(0.02, 0.4);
                let boards = random.below(5) + 2;
                (0..boards).for_each(|k| {
                    let from = 0.1 + (gap + 0.02) * k as f64;
                    block(from, from + 0.02);
                });
            }
            _ => {}
        }
    }
}

/// A lamp: its material, and that of what is around it.
fn hang(room: &mut Room, random: &mut Random, (low, high): ([f64; 3], [f64; 3]), [lamp, plaster]: [u32; 2]) {
    let [x, y] = [0, 1].map(|axis| low[axis] + (high[axis] - low[axis]) * random.between(0.35, 0.65));
    let (half, top) = ([random.between(0.05, 0.3), random.between(0.1, 0.5)], high[2]);
    let around = |grown: f64, from: f64, to: f64| {
        let corner = |sign: f64, z: f64| [x + sign * (half[0] + grown), y + sign * (half[1] + grown), z];
        sides(corner(-1.0, from), corner(1.0, to))
    };
    let kind = random.below(4);
    match kind {
        // Under the ceiling it shines down; on a board, up.
        0 | 1 => {
            let (from, to) = if kind == 0 { (top - 0.05, top - 0.02) } else { (top - 0.35, top - random.between(0.1, 0.3)) };
            for (side, is_far) in around(0.0, from, to) {
                side.add_to(room, is_far, if side.axis == 2 && is_far == (kind == 1) { lamp } else { plaster });
            }
        }
        // A block in a shade that is open above and below.
        2 => {
            around(0.0, top - 0.65, top - 0.6).into_iter().for_each(|(side, is_far)| side.add_to(room, is_far, lamp));
            let shade = around(random.between(0.05, 0.2), top - 0.75, top - 0.45);
            shade.into_iter().filter(|(side, _)| side.axis < 2).for_each(|(side, _)| side.add_sheet_to(room, plaster));
        }
        // Deep in a housing that is open below.
        _ => {
            let (mouth, depth) = (top - 0.45, random.between(0.05, 0.4));
            let [(floor, _), (lid, _)] = [around(0.0, mouth, mouth + depth)[4], around(0.0, mouth, mouth + depth)[5]];
            lid.add_to(room, false, lamp);
            floor.reveals(room, lid.at, plaster);
            for (side, is_far) in around(0.01, mouth, mouth + depth + 0.01) {
                let pieces = if side.axis == 2 && !is_far { side.around(floor).to_vec() } else { vec![side] };
                pieces.into_iter().for_each(|piece| piece.add_to(room, is_far, plaster));
            }
        }
    }
}
