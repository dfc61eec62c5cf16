//! What Chang, Shih 1998 measured: tables 1 to 3.

/// The tolerances of all tables.
pub const TOLERANCES: [f64; 5] = [0.030, 0.025, 0.020, 0.015, 0.010];

/// Table 1: links with one to four samples on each smallest element, by tolerance.
pub const LINKS_BY_SAMPLES: [[u32; 4]; 5] = [
    [5_512, 27_457, 28_312, 29_122],
    [5_632, 31_222, 31_912, 33_832],
    [7_762, 36_652, 37_027, 40_402],
    [17_572, 55_012, 55_912, 60_832],
    [24_202, 87_922, 88_777, 93_907],
];

/// Table 2: links and seconds of refinement, top-down and bottom-up, by tolerance.
pub const TOP_DOWN: [(u32, f64); 5] = [(21_532, 32.25), (26_287, 33.17), (31_627, 34.58), (46_552, 36.74), (78_487, 42.07)];
pub const BOTTOM_UP: [(u32, f64); 5] = [(29_122, 51.02), (33_832, 51.07), (40_402, 51.19), (60_832, 51.36), (93_907, 51.76)];

/// Table 3: links, seconds of refinement, seconds of gathering in the living room, by tolerance.
pub const LIVING_ROOM: [(u32, f64, f64); 5] =
    [(82_287, 1136.0, 5.4), (89_184, 1137.0, 5.4), (101_658, 1138.1, 5.5), (128_682, 1139.8, 5.5), (178_215, 1143.2, 5.6)];
