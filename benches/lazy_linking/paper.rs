//! What Holzschuch, Sillion, Drettakis 1994 measured: tables 1 to 3.

/// A room of the paper.
pub struct PaperRoom {
    /// Its file in scenes/, without the ending.
    pub file: &'static str,
    pub name: &'static str,
    pub polygons: usize,
    pub description: &'static str,
    /// Seconds of the original algorithm for ten iterations, and of its initial linking (table 2).
    pub original_s: f64,
    pub initial_linking_s: f64,
    /// Seconds of the original algorithm for the first picture (table 3).
    pub original_first_s: f64,
    /// The same two with lazy linking and reduction.
    pub reduced_s: [f64; 2],
}

/// The five rooms.
pub const ROOMS: [PaperRoom; 5] = [
    PaperRoom {
        file: "full_office",
        name: "Full office",
        polygons: 170,
        description: "desk, chair, shelf, one lamp, a window",
        original_s: 301.0,
        initial_linking_s: 5.13,
        original_first_s: 242.0,
        reduced_s: [43.0, 30.0],
    },
    PaperRoom {
        file: "dining_room",
        name: "Dining room",
        polygons: 402,
        description: "a laid table and four chairs",
        original_s: 4824.0,
        initial_linking_s: 436.0,
        original_first_s: 4191.0,
        reduced_s: [657.0, 552.0],
    },
    PaperRoom {
        file: "east_room",
        name: "East room",
        polygons: 1006,
        description: "two desks, six chairs, shelves",
        original_s: 587.0,
        initial_linking_s: 194.0,
        original_first_s: 378.0,
        reduced_s: [193.0, 59.0],
    },
    PaperRoom {
        file: "west_room",
        name: "West room",
        polygons: 1647,
        description: "four desks, ten chairs, shelves",
        original_s: 1017.0,
        initial_linking_s: 476.0,
        original_first_s: 752.0,
        reduced_s: [270.0, 101.0],
    },
    PaperRoom {
        file: "hevea",
        name: "Hevea",
        polygons: 2355,
        description: "a rubber tree with three light sources",
        original_s: 4253.0,
        initial_linking_s: 1597.0,
        original_first_s: 2331.0,
        reduced_s: [543.0, 122.0],
    },
];

impl PaperRoom {
    /// How many times faster lazy linking with reduction was: ten iterations, first picture.
    pub fn ratios(&self) -> [f64; 2] {
        [self.original_s / self.reduced_s[0], self.original_first_s / self.reduced_s[1]]
    }
}
