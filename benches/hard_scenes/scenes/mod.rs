//! The scenes, each hard in one way. In metres and W/m^2; reflectances differ a little by channel.

mod around;
mod blinds;
mod bookcase;
mod comb;
mod furnace;
mod gaps;
mod lamps;
mod leaves;
mod louvres;
mod made;
mod nested;
mod parts;
mod pinhole;
mod random_room;
mod sconce;
mod slit;
mod snoot;
mod spheres;

pub use made::Made;
pub use random_room::random_room;

/// A scene and why it is here.
pub struct HardScene {
    pub name: &'static str,
    pub what: &'static str,
    pub why: &'static str,
    made: fn() -> Made,
}

impl HardScene {
    const fn new(name: &'static str, made: fn() -> Made, what: &'static str, why: &'static str) -> Self {
        Self { name, what, why, made }
    }

    pub fn make(&self) -> Made {
        (self.made)()
    }
}

/// All of them.
pub fn all() -> Vec<HardScene> {
    with_gaps().into_iter().chain(with_rare_light()).chain(with_lamps()).collect()
}

/// Those in which things stand close, or black things around.
fn with_gaps() -> Vec<HardScene> {
    let new = HardScene::new;
    vec![
        new("comb_5mm", || comb::comb(0.005), "100 plates 5 mm apart below a lamp", "nearly all light is at the upper edges"),
        new("comb_20mm", || comb::comb(0.02), "the same, 20 mm apart", "light falls off steeply along every plate"),
        new("comb_50mm", || comb::comb(0.05), "the same, 50 mm apart", "light reaches the feet of the plates, hardly"),
        new("louvres", louvres::louvres, "a room behind a window with 41 slats 5 cm apart", "a room full of stripes of light"),
        new(
            "blinds",
            blinds::blinds,
            "a room behind 35 vertical slats, 8.5 cm apart",
            "cells as wide as a slat are brighter than what the room sees of it",
        ),
        new(
            "white_blinds",
            blinds::white_blinds,
            "the same, all of it reflecting 0.9",
            "what cells are off at one bounce grows tenfold by all others",
        ),
        new("bookcase", bookcase::bookcase, "250 books 1 to 30 mm apart", "much area lies in narrow gaps"),
        new("black_shell", around::black_shell, "two rooms in a closed black box", "half of the area is black"),
        new(
            "black_ground",
            around::black_ground,
            "a room above a black plane of 20 km",
            "all area but a millionth is black, sizes differ by 1e7",
        ),
        new(
            "gap_1mm",
            || gaps::gaps(1e-3),
            "a hall: a box 1 mm above the floor, a lamp 1 mm under the ceiling",
            "dark beside bright, with nothing between",
        ),
        new("gap_30um", || gaps::gaps(3e-5), "the same with gaps of 30 um", "gaps as narrow as planes are told apart"),
        new("gap_1um", || gaps::gaps(1e-6), "the same with gaps of 1 um", "gaps narrower than f32 resolves in the hall"),
    ]
}

/// Those whose lamps are hidden, small, or close to what they light.
fn with_lamps() -> Vec<HardScene> {
    let new = HardScene::new;
    vec![
        new(
            "snoot",
            snoot::snoot,
            "a lamp at the inner end of a tube of 10 x 10 x 40 cm",
            "all light comes through a small mouth, much of it off the tube",
        ),
        new(
            "sconce",
            sconce::sconce,
            "a lamp that shines on the wall it hangs on, 5 cm away",
            "all light comes off a patch of wall behind the lamp",
        ),
        new("tiny_lamps", lamps::many, "10,000 lamps of 5 mm behind grids", "from every point most lamps are hidden"),
        new("one_lamp", lamps::one, "one lamp of a millionth of the area, and boxes", "shadows without penumbra, a huge exitance"),
    ]
}

/// Those in which light is rare, many times reflected or on many small things.
fn with_rare_light() -> Vec<HardScene> {
    let new = HardScene::new;
    vec![
        new(
            "pinhole",
            || pinhole::pinhole(0.05),
            "a dark room that a white, lit chamber lights through a hole of 5 cm",
            "a ten-thousandth of the light, on more than half of the area",
        ),
        new(
            "pinhole_20mm",
            || pinhole::pinhole(0.02),
            "the same with a hole of 2 cm",
            "a path in fifty thousand finds the light of more than half of the area",
        ),
        new(
            "pinhole_150mm",
            || pinhole::pinhole(0.15),
            "the same with a hole of 15 cm",
            "some paths find the light of more than half of the area, most do not",
        ),
        new(
            "slit",
            slit::slit,
            "a room of shelves that a slit of 5 cm lights",
            "half of the area has a few thousandths of the light of the other half, by the jambs of the slit in good part",
        ),
        new(
            "leaves",
            leaves::leaves,
            "2000 leaves with two sides that reflect one channel well",
            "no two alike, partly hidden everywhere; channels differ",
        ),
        new(
            "nested_boxes",
            nested::nested_boxes,
            "six open boxes one in another, the lamp outside",
            "light gets in by many bounces through openings",
        ),
        new("white_furnace", furnace::furnace, "an empty box that reflects 99%, one wall shines", "a hundred bounces"),
        new("spheres", spheres::spheres, "three spheres of 1280 triangles", "many small surfaces that should be seen as one"),
    ]
}
