//! Books that stand close.

use super::super::rooms::Room;
use super::super::triangles::Random;
use super::made::Made;
use super::parts::{closed_room, matt, panel, solid};

const SHELVES: u32 = 5;
const BOARD: f64 = 0.02;
const SHELF: f64 = 0.36;
/// Where the case stands along the wall, and how deep it is.
const CASE: [f64; 2] = [0.8, 3.2];
const DEPTH: f64 = 0.3;

/// A bookcase of five shelves at the wall of a room of 4 x 3.5 x 2.6 m.
pub fn bookcase() -> Made {
    let mut room = Room::default();
    closed_room(&mut room, [4.0, 3.5, 2.6]);
    panel(&mut room, [2.0, 2.0], [0.6, 0.6], 2.57, 120.0);
    let wood = matt(&mut room, "wood", [0.5, 0.38, 0.24]);
    let bindings = [[0.5, 0.12, 0.1], [0.12, 0.2, 0.45], [0.14, 0.34, 0.2], [0.66, 0.6, 0.48], [0.3, 0.29, 0.28]];
    let bindings: Vec<u32> = bindings.iter().enumerate().map(|(k, &rho)| matt(&mut room, &format!("binding_{k}"), rho)).collect();
    let top = 0.1 + SHELF * f64::from(SHELVES);
    for x in [CASE[0] - BOARD, CASE[1]] {
        solid(&mut room, [x, 0.001, 0.0], [x + BOARD, DEPTH, top + BOARD], wood);
    }
    for k in 0..=SHELVES {
        let z = 0.1 + SHELF * f64::from(k);
        solid(&mut room, [CASE[0], 0.001, z], [CASE[1], DEPTH, z + BOARD], wood);
    }

    let mut random = Random(11);
    for k in 0..SHELVES {
        let z = 0.1 + SHELF * f64::from(k) + BOARD;
        let mut x = CASE[0];
        loop {
            x += millimetres(&mut random, 1.0, 30.0);
            let [thick, tall, deep] = [[18.0, 46.0], [200.0, 310.0], [150.0, 240.0]].map(|[a, b]| millimetres(&mut random, a, b));
            if x + thick >= CASE[1] {
                break;
            }
            let binding = bindings[random.below(bindings.len())];
            solid(&mut room, [x, 0.02, z], [x + thick, 0.02 + deep, z + tall], binding);
            x += thick;
        }
    }
    Made::of(room)
}

/// A length of whole tenths of a millimetre.
fn millimetres(random: &mut Random, low: f64, high: f64) -> f64 {
    1e-4 * (10.0 * random.between(low, high)).round()
}
