//! The first triangles of a surface: convex polygons, and lines that touch, cross, repeat, lie in a row or end a hair's breadth beside something.

use patchlight::mesh::triangulated;

use super::bytes::Bytes;

type Point = [f64; 2];

/// So that one input takes less than a millisecond.
const MOST_LINES: usize = 40;
const MOST_TRIANGLES: f64 = 1000.0;

/// How far ends lie beside something, in sizes of the polygon: more and less than what is welded, and what counts as touching.
const HAIRS: [f64; 10] = [0.0, 0.0, 0.0, 0.0, 1e-10, 6e-10, -6e-10, 3e-9, 1e-6, -1e-6];

/// What borders and lines may be off by, in sizes of the polygon.
const OFF: f64 = 4e-6;

/// Triangulates a polygon as the bytes tell. Triangles are proper, no larger than asked for and cover the polygon once, and none lies across the first
/// line, which no other can keep out.
pub fn triangulate(bytes: &[u8]) {
    let mut bytes = Bytes(bytes);
    let unit = bytes.pick(&[1.0, 1.0, 1e-3, 1e4, 1e-12, 1e30]);
    let polygon = polygon(&mut bytes, unit);
    let count = polygon.len();
    let sides = || (0..count).map(|k| [polygon[k], polygon[(k + 1) % count]]);
    let area = 0.5 * sides().map(|[a, b]| cross(a, b)).sum::<f64>();
    let size = polygon.iter().flatten().map(|x| x.abs()).fold(0.0, f64::max);

    // A long strip is cut into pieces that are not much longer than wide, so a thin one may not ask for small ones.
    let fewest = (2.0 * size).powi(2).max(area) / MOST_TRIANGLES;
    let largest = (area * bytes.pick(&[1.0, 0.1, 0.02])).max(fewest);
    let mut lines = Vec::new();
    while !bytes.is_empty() && lines.len() < MOST_LINES {
        let from = inside(&mut bytes, &polygon, size);
        lines.push(([from, inside(&mut bytes, &polygon, size)], bytes.next() & 1 == 1));
        // The same again, or on from its end.
        if let Some(&(ends, _)) = lines.last()
            && bytes.next() & 7 == 0
        {
            let to = inside(&mut bytes, &polygon, size);
            lines.push((bytes.pick(&[ends, [ends[1], ends[0]], [ends[1], to]]), bytes.next() & 1 == 1));
        }
    }
    let triangles = triangulated(&polygon, &lines, largest);

    // Each is proper, and together they are the polygon.
    let areas: Vec<f64> = triangles.iter().map(|&[a, b, c]| 0.5 * cross(minus(b, a), minus(c, a))).collect();
    assert!(areas.iter().all(|&of| of > 0.0 && of <= largest), "areas from 0 to {largest}: {areas:?}");
    let room = OFF * size * 8.0 * size * (1 + lines.len()) as f64;
    let whole: f64 = areas.iter().sum();
    assert!((whole - area).abs() <= room, "{whole} instead of {area}, {room}");
    for k in 0..16 {
        let at = within(&polygon, f64::from(k % 4) / 4.0 + 0.11, f64::from(k / 4) / 4.0 + 0.13);
        assert!(triangles.iter().any(|triangle| depth(*triangle, at) >= -OFF * size), "{at:?} is in no triangle");
    }

    // The first line lies along edges: what of it is within a triangle is no longer than ends are off.
    if let Some(&([from, to], _)) = lines.first() {
        let points = (0..=64).map(|k| lerp(from, to, f64::from(k) / 64.0));
        for point in points {
            let deepest = triangles.iter().map(|&triangle| depth(triangle, point)).fold(f64::NEG_INFINITY, f64::max);
            assert!(deepest <= OFF * size, "the first line runs {deepest} deep through a triangle, at {point:?}");
        }
    }
}

/// A regular polygon, stretched and turned, or a rectangle; with corners on its sides.
fn polygon(bytes: &mut Bytes, unit: f64) -> Vec<Point> {
    let (count, flat) = (3 + bytes.next() % 6, bytes.pick(&[1.0, 0.7, 0.7, 1e-2, 1e-4]));
    let turn = f64::from(bytes.next()) / 256.0;
    let corner = |k: u8| {
        let (sin, cos) = (std::f64::consts::TAU * f64::from(k) / f64::from(count)).sin_cos();
        [cos, flat * sin]
    };
    let corners: Vec<Point> =
        if count == 4 { vec![[-1.0, -flat], [1.0, -flat], [1.0, flat], [-1.0, flat]] } else { (0..count).map(corner).collect() };
    let turned = |[x, y]: Point| {
        let (sin, cos) = (if bytes.0.len().is_multiple_of(2) { 0.0 } else { turn }).sin_cos();
        [unit * (cos * x - sin * y), unit * (sin * x + cos * y)]
    };
    let corners: Vec<Point> = corners.into_iter().map(turned).collect();
    let with_middles = bytes.next();
    let mut polygon = Vec::new();
    for (k, &corner) in corners.iter().enumerate() {
        polygon.push(corner);
        if with_middles >> k & 1 == 1 {
            polygon.push(lerp(corner, corners[(k + 1) % corners.len()], 0.5));
        }
    }
    polygon
}

/// A point of the polygon: a corner, on a side, of a coarse grid or anywhere, or a hair's breadth beside that.
fn inside(bytes: &mut Bytes, polygon: &[Point], size: f64) -> Point {
    let count = polygon.len();
    let grid = |bytes: &mut Bytes| f64::from(bytes.next() % 9) / 8.0;
    let at = match bytes.next() % 8 {
        0 => polygon[bytes.next() as usize % count],
        1 | 2 => {
            let side = bytes.next() as usize % count;
            lerp(polygon[side], polygon[(side + 1) % count], grid(bytes))
        }
        3..=5 => within(polygon, grid(bytes), grid(bytes)),
        _ => within(polygon, f64::from(bytes.next()) / 255.0, f64::from(bytes.next()) / 255.0),
    };
    let off = [bytes.pick(&HAIRS), bytes.pick(&HAIRS)];
    [at[0] + size * off[0], at[1] + size * off[1]]
}

/// A point of the polygon by two numbers from 0 to 1.
fn within(polygon: &[Point], s: f64, t: f64) -> Point {
    let middle = polygon.len() / 2;
    let along = lerp(polygon[0], polygon[middle], s);
    lerp(along, polygon[if t < 0.5 { 1 } else { polygon.len() - 1 }], (2.0 * t - 1.0).abs())
}

fn minus(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1]]
}

fn cross(a: Point, b: Point) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

fn lerp(a: Point, b: Point, part: f64) -> Point {
    [a[0] + part * (b[0] - a[0]), a[1] + part * (b[1] - a[1])]
}

/// How deep within a triangle a point lies, in metres; outside it is negative.
fn depth([a, b, c]: [Point; 3], point: Point) -> f64 {
    let from = |a: Point, b: Point| cross(minus(b, a), minus(point, a)) / minus(b, a)[0].hypot(minus(b, a)[1]);
    from(a, b).min(from(b, c)).min(from(c, a))
}
