//! Scenes that are hard in one way each. Nearly all have a known solution, and one channel.
//!
//! Two tricks give solutions. In a closed room whose surfaces emit `(1 - rho) B0` all light is `B0`, whatever stands in it (Kirchhoff). And
//! where nothing reflects but one plane, with nothing in front of its lamps, `B = rho * sum of E F` with exact form factors.

use patchlight::form_factor::point_form_factor;
use patchlight::geometry::Polygon;
use patchlight::reconstruct::SurfacePoint;
use patchlight::scene::{Scene, SurfaceId};

use crate::rooms::{Room, straight, turned};
use crate::triangles::{Random, add, cross, dot, sub, times, unit};

/// B at a point of a surface.
type Truth = Box<dyn Fn(&SurfacePoint, usize) -> f64>;

/// A scene and what is known about it.
pub struct HardScene {
    pub name: String,
    pub scene: Scene,
    pub truth: Option<Truth>,
}

impl HardScene {
    fn new(name: impl Into<String>, scene: Scene, truth: impl Fn(&SurfacePoint, usize) -> f64 + 'static) -> Self {
        Self { name: name.into(), scene, truth: Some(Box::new(truth)) }
    }

    /// Everything has radiosity 1.
    fn uniform(name: impl Into<String>, room: Room) -> Self {
        Self::new(name, room.scene(), |_, _| 1.0)
    }

    /// Nothing reflects any light that arrives.
    fn emitted_alone(name: impl Into<String>, room: Room) -> Self {
        let scene = room.scene();
        let exitances: Vec<f64> = exitances(&scene).collect();
        Self::new(name, scene, move |_, surface| exitances[surface])
    }

    /// Light comes from lamps alone, and nothing is in front of them.
    fn direct(name: impl Into<String>, room: Room) -> Self {
        let scene = room.scene();
        let exitances = exitances(&scene);
        let lamps: Vec<(f64, Polygon)> =
            exitances.zip(scene.surfaces()).map(|(e, surface)| (e, surface.polygon.clone())).filter(|(e, _)| *e > 0.0).collect();
        let materials: Vec<[f64; 2]> = (0..scene.surfaces().len() as u32)
            .map(|id| scene.material_of(SurfaceId(id)))
            .map(|material| [material.reflectance[0], material.exitance[0]])
            .collect();
        Self::new(name, scene, move |point, surface| {
            let irradiance = |(e, lamp): &(f64, Polygon)| e * point_form_factor(point.position, point.normal, lamp);
            let [rho, exitance] = materials[surface];
            exitance + if rho > 0.0 { rho * lamps.iter().map(irradiance).sum::<f64>() } else { 0.0 }
        })
    }
}

fn exitances(scene: &Scene) -> impl Iterator<Item = f64> {
    (0..scene.surfaces().len() as u32).map(|id| scene.material_of(SurfaceId(id)).exitance[0])
}

/// All of them.
pub fn all() -> Vec<HardScene> {
    let mut scenes = Vec::new();
    scenes.extend(places());
    scenes.extend(shapes());
    scenes.extend(overlaps());
    scenes.extend(lamps());
    scenes.extend(next_to_nothing());
    scenes
}

/// Where a room stands, how large it is and how it is turned.
#[derive(Clone, Copy)]
struct Place {
    corner: [f64; 3],
    axes: [[f64; 3]; 3],
}

impl Place {
    fn new(unit: f64) -> Self {
        Self { corner: [0.0; 3], axes: straight(unit, unit, unit) }
    }

    fn at(self, corner: [f64; 3]) -> Self {
        Self { corner, ..self }
    }

    fn vector(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        add(add(times(self.axes[0], x), times(self.axes[1], y)), times(self.axes[2], z))
    }

    fn point(&self, point: [f64; 3]) -> [f64; 3] {
        add(self.corner, self.vector(point))
    }

    fn sides(&self, sides: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
        sides.map(|side| self.vector(side))
    }
}

/// A material in whose presence all light is `b0`.
fn grey(room: &mut Room, rho: f64, b0: f64) -> u32 {
    room.material(&[rho], &[(1.0 - rho) * b0])
}

/// A closed room of 4 x 3 x 2.5 with floating boxes, all with reflectances of their own, in which all light is 1.
fn furnace(place: Place, boxes: usize, reflectances: [f64; 2], seed: u64) -> Room {
    let mut random = Random(seed);
    let mut room = Room::default();
    let mut material = |room: &mut Room, _| {
        let rho = random.between(reflectances[0], reflectances[1]);
        grey(room, rho, 1.0)
    };
    room.cuboid(place.corner, place.sides(straight(4.0, 3.0, 2.5)), true, &mut material);

    // On a grid, so that none meets another.
    let mut shape = Random(seed + 1);
    let each_way = [4, 3, 2];
    for k in 0..boxes.min(24) {
        let cell = [k % each_way[0], k / each_way[0] % each_way[1], k / (each_way[0] * each_way[1])];
        let corner: [f64; 3] = std::array::from_fn(|axis| cell[axis] as f64 + 0.35 + shape.between(0.0, 0.2));
        let sides = turned(shape.between(0.1, 0.35), shape.between(0.1, 0.3), shape.between(0.05, 0.4), shape.between(0.0, 0.7));
        room.cuboid(place.point(corner), place.sides(sides), false, &mut material);
    }
    room
}

/// A closed room with `side` cubed floating boxes, their reflectances from 0.1 to 0.99.
pub fn furnace_of_small_boxes(side: usize) -> HardScene {
    let mut random = Random(21);
    let mut room = Room::default();
    let mut material = |room: &mut Room, _| {
        let rho = random.between(0.1, 0.99);
        grey(room, rho, 1.0)
    };
    room.cuboid([0.0; 3], straight(side as f64, side as f64, side as f64), true, &mut material);
    let mut shape = Random(22);
    for cell in 0..side.pow(3) {
        let corner = [cell % side, cell / side % side, cell / (side * side)];
        let corner = corner.map(|at| at as f64 + 0.35 + shape.between(0.0, 0.2));
        let sides = turned(shape.between(0.1, 0.35), shape.between(0.1, 0.3), shape.between(0.05, 0.4), shape.between(0.0, 0.7));
        room.cuboid(corner, sides, false, &mut material);
    }
    HardScene::uniform(format!("{} boxes", side.pow(3)), room)
}

/// Every face of a scene in four, all in random order.
pub fn cut_and_shuffled(scene: &Scene, random: &mut Random) -> Scene {
    let mut pieces = Vec::new();
    for surface in scene.surfaces() {
        let corners: Vec<[f64; 3]> = surface.polygon.vertices().collect();
        let count = corners.len();
        let middle = |a: [f64; 3], b: [f64; 3]| times(add(a, b), 0.5);
        for (k, &corner) in corners.iter().enumerate() {
            let (before, after) = (corners[(k + count - 1) % count], corners[(k + 1) % count]);
            let piece = [corner, middle(corner, after), surface.polygon.centroid(), middle(before, corner)];
            pieces.insert(random.below(pieces.len() + 1), (Polygon::new(&piece).unwrap(), surface.material, surface.face));
        }
    }
    Scene::new(scene.channels(), scene.materials().to_vec(), pieces, scene.sides()).unwrap()
}

const MODERATE: [f64; 2] = [0.2, 0.8];

/// Units of length, distance from the origin, rotation: of few surfaces, and of so many that clusters are made.
fn places() -> Vec<HardScene> {
    let mut random = Random(1);
    let w = random.direction();
    let u = unit(cross(w, random.direction()));
    let turned = Place { axes: [u, cross(w, u), w], ..Place::new(1.0) };
    let far = |unit: f64| Place::new(unit).at(times([1.0, -0.7, 0.4], 1e6 * unit));
    let named = [
        ("in units of 1e-6", Place::new(1e-6)),
        ("in units of 1e6", Place::new(1e6)),
        ("a million sizes away", far(1.0)),
        ("in units of 1e-6, a million away", far(1e-6)),
        ("turned", turned),
    ];
    let furnaces = named.into_iter().flat_map(|(name, place)| {
        [(2, "few"), (20, "many")]
            .map(|(boxes, count)| HardScene::uniform(format!("{count} boxes {name}"), furnace(place, boxes, MODERATE, 3)))
    });
    furnaces.collect()
}

/// The closed room of unit sides with a floor of its own.
fn room_without_floor(room: &mut Room, material: u32) {
    let [x, y, z] = straight(1.0, 1.0, 1.0);
    room.quad([0.0; 3], y, z, material);
    room.quad(x, z, y, material);
    room.quad([0.0; 3], z, x, material);
    room.quad(y, x, z, material);
    room.quad(z, y, x, material);
}

/// Reflectances near 1, slivers, fans, T-junctions.
fn shapes() -> Vec<HardScene> {
    let mut scenes = Vec::new();
    for rho in [0.9, 0.999] {
        let mut room = Room::default();
        let white = grey(&mut room, rho, 1.0);
        room.cuboid([0.0; 3], straight(1.0, 1.0, 1.0), true, |_, _| white);
        scenes.push(HardScene::uniform(format!("a cube that reflects {rho}"), room));
    }
    scenes.push(HardScene::uniform("boxes that reflect up to 0.999", furnace(Place::new(1.0), 3, [0.9, 0.999], 5)));

    // Strips of a floor: each next one is thinner, to the aspect; the last is what remains.
    for aspect in [1e4, 1e6] {
        let mut room = Room::default();
        let (wall, odd, even) = (grey(&mut room, 0.5, 1.0), grey(&mut room, 0.3, 1.0), grey(&mut room, 0.8, 1.0));
        room_without_floor(&mut room, wall);
        let mut at = 0.0;
        for k in 0..=10 {
            let width = if k < 10 { f64::powf(aspect, -f64::from(k + 1) / 10.0) } else { 1.0 - at };
            room.quad([at, 0.0, 0.0], [width, 0.0, 0.0], [0.0, 1.0, 0.0], if k % 2 == 0 { even } else { odd });
            at += width;
        }
        scenes.push(HardScene::uniform(format!("a floor of strips, aspect {aspect:e}"), room));
    }

    // A fan around a corner of the floor, its blades ever thinner towards both ends.
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
    scenes.push(HardScene::uniform("a floor that is a fan", room));

    // Walls in halves, the floor in thirds, the ceiling in one piece: no edge meets its like.
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
    scenes.push(HardScene::uniform("T-junctions", room));
    scenes
}

/// A room with a plate that floats so high above the floor.
fn room_with_a_plate(gap: f64) -> Room {
    let mut room = furnace(Place::new(1.0), 0, MODERATE, 9);
    let plate = grey(&mut room, 0.5, 1.0);
    room.cuboid([1.0, 1.0, gap], straight(1.5, 1.0, 0.05), false, |_, _| plate);
    room
}

/// Where surfaces lie in, on or inside one another.
fn overlaps() -> Vec<HardScene> {
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

    // Light comes into the gap from its rim alone.
    for gap in [1e-2, 1e-4, 1e-5] {
        scenes.push(HardScene::uniform(format!("a plate {gap:e} above the floor"), room_with_a_plate(gap)));
    }

    // Within a millionth of the scene all is one plane: the plate lies on the floor, and what is between is dark.
    let scene = room_with_a_plate(1e-6).scene();
    let exitance = [0, 6].map(|surface| scene.material_of(SurfaceId(surface)).exitance[0]);
    scenes.push(HardScene::new("a plate that lies on the floor but for 1e-6", scene, move |point, surface| {
        let [x, y, _] = point.position;
        match surface {
            0 if (1.0..2.5).contains(&x) && (1.0..2.0).contains(&y) => exitance[0],
            6 => exitance[1],
            _ => 1.0,
        }
    }));

    let mut room = furnace(Place::new(1.0), 0, MODERATE, 10);
    let sheet = grey(&mut room, 0.6, 1.0);
    for k in 0..5 {
        let x = 0.5 + 0.6 * f64::from(k);
        room.sheet(&[[x, 0.3, 0.4], [x + 0.2, 2.0, 0.4], [x + 0.2, 2.0, 2.0], [x, 0.3, 2.0]], sheet);
    }
    scenes.push(HardScene::uniform("sheets without thickness", room));

    // A closed box in a closed room, with another light inside.
    let mut room = furnace(Place::new(1.0), 0, MODERATE, 11);
    let (outside, inside) = (grey(&mut room, 0.5, 1.0), grey(&mut room, 0.7, 3.0));
    room.cuboid([1.0, 0.8, 0.5], sides, false, |_, _| outside);
    let inner = [1.02, 0.82, 0.52];
    room.cuboid(inner, straight(0.96, 0.96, 0.96), true, |_, _| inside);
    scenes.push(HardScene::new("nested closed boxes", room.scene(), |_, surface| if surface < 12 { 1.0 } else { 3.0 }));

    // Two boxes through each other: what is inside the other sees its backs alone.
    let mut room = furnace(Place::new(1.0), 0, MODERATE, 12);
    let material = grey(&mut room, 0.5, 1.0);
    let boxes = [([1.0, 0.8, 0.6], turned(1.2, 0.6, 0.5, 0.2)), ([1.5, 0.6, 0.8], turned(0.5, 1.3, 0.9, 0.1))];
    boxes.iter().for_each(|(corner, sides)| room.cuboid(*corner, *sides, false, |_, _| material));
    let is_inside = move |point: [f64; 3], (corner, sides): &([f64; 3], [[f64; 3]; 3])| {
        let from_corner = sub(point, *corner);
        sides.iter().all(|side| (0.0..1.0).contains(&(dot(from_corner, *side) / dot(*side, *side))))
    };
    scenes.push(HardScene::new("boxes through each other", room.scene(), move |point, surface| {
        let other = match surface {
            0..6 => return 1.0,
            6..12 => boxes[1],
            _ => boxes[0],
        };
        if is_inside(point.position, &other) { 0.5 } else { 1.0 }
    }));
    scenes
}

/// A floor of 4 x 4 that reflects, and nothing else.
fn floor() -> Room {
    let mut room = Room::default();
    let floor = room.material(&[0.6], &[0.0]);
    room.quad([-2.0, -2.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0], floor);
    room
}

/// A rectangle above the floor that shines down.
fn ceiling_lamp(room: &mut Room, [x, y, z]: [f64; 3], [width, depth]: [f64; 2], exitance: f64) {
    let lamp = room.material(&[0.0], &[exitance]);
    room.quad([x, y, z], [0.0, depth, 0.0], [width, 0.0, 0.0], lamp);
}

/// Lamps from a speck to a whole wall, next to what they light, in large numbers.
fn lamps() -> Vec<HardScene> {
    let mut scenes = Vec::new();
    for (name, size) in [
        ("a lamp of a millimetre", [1e-3, 1e-3]),
        ("a lamp of a thousandth of a millimetre", [1e-6, 1e-6]),
        ("a lamp that is a line, aspect 1e6", [1.0, 1e-6]),
        ("a lamp as large as the floor", [4.0, 4.0]),
    ] {
        let mut room = floor();
        ceiling_lamp(&mut room, [-0.5 * size[0], -0.5 * size[1], 1.0], size, 1.0 / (size[0] * size[1]));
        scenes.push(HardScene::direct(name, room));
    }

    let mut room = floor();
    ceiling_lamp(&mut room, [-0.1, -0.1, 1e-3], [0.2, 0.2], 1.0);
    scenes.push(HardScene::direct("a lamp a millimetre from the floor that it shines on", room));

    let mut room = floor();
    let lamp = room.material(&[0.0], &[1.0]);
    room.quad([0.0, -0.1, 1e-3], [0.0, 0.2, 0.0], [0.0, 0.0, 0.3], lamp);
    scenes.push(HardScene::direct("a lamp at right angles, a millimetre from the floor", room));

    let mut random = Random(13);
    let mut room = floor();
    for k in 0..200 {
        let corner = [0.25 * f64::from(k % 16) - 1.95, 0.3 * f64::from(k / 16) - 1.95, 1.5];
        ceiling_lamp(&mut room, corner, [0.1, 0.1], random.between(0.0, 10.0).powi(3));
    }
    scenes.push(HardScene::direct("two hundred lamps", room));

    // One bright lamp in a room that has light of its own.
    let mut room = Room::default();
    let (wall, lamp) = (grey(&mut room, 0.9, 1.0), grey(&mut room, 0.0, 1.0));
    room.cuboid([0.0; 3], straight(2.0, 2.0, 2.0), true, |_, face| if face == 5 { lamp } else { wall });
    scenes.push(HardScene::uniform("a wall that is a lamp", room));
    scenes
}

/// Scenes with nothing to do.
fn next_to_nothing() -> Vec<HardScene> {
    let triangle = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let mut scenes = Vec::new();
    for (name, rho, exitance) in
        [("one triangle that shines", 0.5, 1.0), ("one dark triangle", 0.5, 0.0), ("one black triangle", 0.0, 0.0)]
    {
        let mut room = Room::default();
        let material = room.material(&[rho], &[exitance]);
        room.face(&triangle, material);
        scenes.push(HardScene::emitted_alone(name, room));
    }

    let mut room = Room::default();
    let grey = room.material(&[0.5], &[0.0]);
    room.cuboid([0.0; 3], straight(1.0, 1.0, 1.0), true, |_, _| grey);
    scenes.push(HardScene::emitted_alone("a room without light", room));

    let mut room = Room::default();
    let black = room.material(&[0.0], &[2.0]);
    room.cuboid([0.0; 3], straight(1.0, 1.0, 1.0), true, |_, _| black);
    scenes.push(HardScene::emitted_alone("a room that reflects nothing", room));

    // Convex and seen from outside: nothing sees anything.
    let mut room = Room::default();
    let grey = room.material(&[0.5], &[1.0]);
    room.cuboid([0.0; 3], straight(1.0, 1.0, 1.0), false, |_, _| grey);
    scenes.push(HardScene::emitted_alone("a room turned inside out", room));
    scenes
}
