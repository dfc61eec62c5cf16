//! The shell of a room: walls that look inwards, windows in the left one, a door in the back one, a floor of boards.

use super::model::{Model, Place, Point, Side};

use Side::{Back, Bottom, Left, Right, Top};

/// A room from the origin to `width`, `height`, `depth`.
pub struct Interior<'a> {
    pub width: f64,
    pub height: f64,
    pub depth: f64,
    /// Windows in the left wall, each from and to in z.
    pub windows: &'a [[f64; 2]],
    /// The material of the left and of the other walls.
    pub walls: [&'a str; 2],
}

/// How deep the pane of a window lies.
const REVEAL: f64 = 0.16;

impl Interior<'_> {
    /// From where to where windows go in y.
    pub const SILL: f64 = 0.95;
    pub const LINTEL: f64 = 2.2;

    /// Walls and ceiling without the floor, and the sky behind windows: 6 faces, and 7 for every window.
    pub fn shell(&self, model: &mut Model) {
        self.shell_before(model, true);
    }

    /// The same with nothing behind windows: 6 faces, and 6 for every window.
    pub fn shell_with_openings(&self, model: &mut Model) {
        self.shell_before(model, false);
    }

    fn shell_before(&self, model: &mut Model, is_sky: bool) {
        let (sill, lintel) = (Self::SILL, Self::LINTEL);
        let Interior { width, height, depth, .. } = *self;
        let [left, other] = self.walls;
        model.object("shell", Place::WORLD);
        model.face(other, &[[0.0, 0.0, 0.0], [width, 0.0, 0.0], [width, height, 0.0], [0.0, height, 0.0]]);
        model.face(other, &[[width, 0.0, depth], [0.0, 0.0, depth], [0.0, height, depth], [width, height, depth]]);
        model.face(other, &[[width, 0.0, 0.0], [width, 0.0, depth], [width, height, depth], [width, height, 0.0]]);
        model.face("ceiling", &[[0.0, height, 0.0], [width, height, 0.0], [width, height, depth], [0.0, height, depth]]);

        // The left wall: below, above and between the windows.
        let wall = |model: &mut Model, y: [f64; 2], z: [f64; 2]| model.face(left, &across(0.0, y, z));
        if self.windows.is_empty() {
            wall(model, [0.0, height], [0.0, depth]);
            return;
        }
        wall(model, [0.0, sill], [0.0, depth]);
        wall(model, [lintel, height], [0.0, depth]);
        let mut from = 0.0;
        for &[near, far] in self.windows {
            wall(model, [sill, lintel], [from, near]);
            from = far;
        }
        wall(model, [sill, lintel], [from, depth]);

        // Reveals and the sky behind.
        for &[near, far] in self.windows {
            model.object("window", Place::WORLD);
            let x = -REVEAL;
            model.face("white_paint", &[[x, sill, near], [x, sill, far], [0.0, sill, far], [0.0, sill, near]]);
            model.face("white_paint", &[[x, lintel, far], [x, lintel, near], [0.0, lintel, near], [0.0, lintel, far]]);
            model.face("white_paint", &[[x, sill, near], [0.0, sill, near], [0.0, lintel, near], [x, lintel, near]]);
            model.face("white_paint", &[[0.0, sill, far], [x, sill, far], [x, lintel, far], [0.0, lintel, far]]);
            if is_sky {
                model.face("sky", &across(x, [sill, lintel], [near, far]));
            }
        }
    }

    /// A door in the back wall, its left edge at `x`: leaf, two panels, a handle, a frame. 36 faces.
    pub fn door(&self, model: &mut Model, x: f64) {
        model.object("door", Place::at([x, 0.0, 0.0], 0.0));
        let (width, top) = (0.84, 2.05);
        model.cuboid("white_paint", [0.0, 0.0, 0.0], [width, top, 0.025], &[Bottom, Back, Left, Right, Top]);
        for (low, high) in [(0.15, 0.95), (1.1, 1.9)] {
            model.cuboid("white_paint", [0.12, low, 0.025], [width - 0.12, high, 0.037], &[Back]);
        }
        model.cuboid("metal", [0.04, 1.0, 0.025], [0.11, 1.025, 0.075], &[Back]);
        let deep = 0.045;
        model.cuboid("oak", [-0.07, 0.0, 0.0], [0.0, top, deep], &[Bottom, Back, Top]);
        model.cuboid("oak", [width, 0.0, 0.0], [width + 0.07, top, deep], &[Bottom, Back, Top]);
        model.cuboid("oak", [-0.07, top, 0.0], [width + 0.07, top + 0.07, deep], &[Back]);
    }

    /// Curtains beside every window, in folds seen from both sides, and their rail: 34 faces a window.
    pub fn curtains(&self, model: &mut Model) {
        for &[near, far] in self.windows {
            model.object("curtains", Place::WORLD);
            for start in [near - 0.42, far] {
                for fold in 0..7 {
                    let at = |k: i32| (if k % 2 == 0 { 0.05 } else { 0.1 }, start + 0.06 * f64::from(k));
                    let ((x0, z0), (x1, z1)) = (at(fold), at(fold + 1));
                    model.sheet("curtain", &[[x0, 0.12, z0], [x1, 0.12, z1], [x1, 2.37, z1], [x0, 2.37, z0]]);
                }
            }
            model.cuboid("metal", [0.06, 2.375, near - 0.5], [0.09, 2.4, far + 0.5], &[]);
        }
    }

    /// A floor of as many boards as it takes to have `total` faces in all.
    pub fn floor_of(&self, model: &mut Model, total: usize, materials: [&str; 2]) {
        assert!(model.face_count() < total, "{} faces without a floor, {total} in all", model.face_count());
        let boards = total - model.face_count();
        model.object("floor", Place::WORLD);
        for board in 0..boards {
            let edge = |k: usize| self.depth * k as f64 / boards as f64;
            let material = materials[usize::from(board % 3 == 1)];
            let (near, far) = (edge(board), edge(board + 1));
            model.face(material, &[[0.0, 0.0, near], [0.0, 0.0, far], [self.width, 0.0, far], [self.width, 0.0, near]]);
        }
    }
}

/// A rectangle that looks along +x.
fn across(x: f64, y: [f64; 2], z: [f64; 2]) -> [Point; 4] {
    [[x, y[0], z[1]], [x, y[0], z[0]], [x, y[1], z[0]], [x, y[1], z[1]]]
}
