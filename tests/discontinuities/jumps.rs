//! Irradiance itself as the witness: it is computed exactly below a convex occluder, by clipping the source to what the occluder leaves.
//!
//! Along lines over the floor it must be smooth between the curves that were found, and across each of these it must not be. Differences tell:
//! where a function is smooth, its third difference falls by 512 when the step is an eighth, at a jump of the second derivative by 64, at one
//! of the first by 8.

use glam::{DMat3, DQuat, DVec2, DVec3};
use patchlight::discontinuities::{Degree, Segment, of_emitters};
use patchlight::form_factor::point_form_factor;
use patchlight::geometry::{Polygon, PolygonError};
use patchlight::scene::SurfaceId;

use super::random::Random;
use super::{box_faces, lit_by_first, rectangle};

const FLOOR: SurfaceId = SurfaceId(1);

/// Half the side of the floor, in metres.
const HALF: f64 = 6.0;

/// A source over the floor, and the corners of a convex occluder between.
struct Shadow {
    source: Polygon,
    occluder: Vec<DVec3>,
}

impl Shadow {
    /// The form factor from a point of the floor to what it sees of the source: all, less what the occluder hides. It depends on directions alone, so
    /// both are taken by where their rays cross the height 1 above the point.
    fn irradiance(&self, at: DVec2) -> f64 {
        let eye = DVec3::new(at.x, at.y, 0.0);
        let (origin, normal) = (DVec3::from(self.source.centroid()), DVec3::from(self.source.normal()));
        let height = |point: DVec3| normal.dot(point - origin);
        if height(eye) <= 0.0 {
            return 0.0;
        }
        let image = |point: DVec3| (point - eye).truncate() / point.z;
        let factor = |polygon: &[DVec2]| {
            let area: f64 = (0..polygon.len()).map(|k| polygon[k].perp_dot(polygon[(k + 1) % polygon.len()])).sum();
            let mut lifted: Vec<[f64; 3]> = polygon.iter().map(|p| (eye + p.extend(1.0)).to_array()).collect();
            // Its front looks down.
            if area > 0.0 {
                lifted.reverse();
            }
            match Polygon::new(&lifted) {
                Ok(polygon) => point_form_factor(eye.to_array(), [0.0, 0.0, 1.0], &polygon),
                Err(PolygonError::TooFewVertices(_) | PolygonError::NoArea) => 0.0,
                Err(error) => panic!("{error}: {lifted:?}"),
            }
        };

        // What of the occluder is in front of the source's plane: its corners there, and where lines between corners cross the plane.
        let (front, behind): (Vec<DVec3>, Vec<DVec3>) = self.occluder.iter().partition(|&&corner| height(corner) > 0.0);
        let crossing = |a: DVec3, b: DVec3| a.lerp(b, height(a) / (height(a) - height(b)));
        let crossings = front.iter().flat_map(|&a| behind.iter().map(move |&b| crossing(a, b)));
        let hull = convex_hull(front.iter().copied().chain(crossings).map(image).collect());

        let source: Vec<DVec2> = self.source.vertices().map(|vertex| image(vertex.into())).collect();
        let mut hidden = if hull.len() < 3 { Vec::new() } else { source.clone() };
        for (k, &a) in hull.iter().enumerate() {
            let along = hull[(k + 1) % hull.len()] - a;
            // A line through two that differ by rounding has any direction.
            if along.length() > 1e-12 {
                hidden = clipped(&hidden, |point| along.perp_dot(point - a));
            }
        }
        factor(&source) - factor(&hidden)
    }
}

/// The part of a convex polygon where `height` is not negative.
fn clipped(polygon: &[DVec2], height: impl Fn(DVec2) -> f64) -> Vec<DVec2> {
    let mut kept = Vec::new();
    for (k, &a) in polygon.iter().enumerate() {
        let b = polygon[(k + 1) % polygon.len()];
        let (at_a, at_b) = (height(a), height(b));
        if at_a >= 0.0 {
            kept.push(a);
        }
        if (at_a > 0.0 && at_b < 0.0) || (at_a < 0.0 && at_b > 0.0) {
            kept.push(a.lerp(b, at_a / (at_a - at_b)));
        }
    }
    kept
}

/// Counter-clockwise (Andrew 1979).
fn convex_hull(mut points: Vec<DVec2>) -> Vec<DVec2> {
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let chain = |points: &mut dyn Iterator<Item = DVec2>| {
        let mut chain: Vec<DVec2> = Vec::new();
        for point in points {
            while let [.., a, b] = chain[..] {
                if (b - a).perp_dot(point - a) > 0.0 {
                    break;
                }
                chain.pop();
            }
            chain.push(point);
        }
        chain.pop();
        chain
    };
    let mut hull = chain(&mut points.iter().copied());
    hull.extend(chain(&mut points.iter().rev().copied()));
    hull
}

/// A random convex polygon around a centre: corners in the order of their angles on an ellipse; `is_aligned` makes it a rectangle along the axes of
/// its frame.
fn convex(random: &mut Random, centre: DVec3, frame: DMat3, size: f64, is_aligned: bool) -> Polygon {
    loop {
        let stretch = DVec2::new(size * (0.5 + random.unit()), size * (0.5 + random.unit()));
        let mut angles: Vec<f64> = (0..3 + random.below(4)).map(|_| random.unit() * std::f64::consts::TAU).collect();
        angles.sort_by(f64::total_cmp);
        if is_aligned {
            angles = (0..4).map(|k| (f64::from(k) + 0.5) * std::f64::consts::FRAC_PI_2).collect();
        }
        let corner = |angle: &f64| (centre + frame * (stretch * DVec2::from_angle(*angle)).extend(0.0)).to_array();
        if let Ok(polygon) = Polygon::new(&angles.iter().map(corner).collect::<Vec<_>>()) {
            return polygon;
        }
    }
}

/// A random source, a random occluder, and all faces of the scene, the source first and the floor second. Half of the scenes are aligned, so that
/// edges are parallel.
fn random_shadow(random: &mut Random) -> (Shadow, Vec<Polygon>) {
    let is_aligned = random.below(2) == 0;
    let tilt = |random: &mut Random, most: f64| {
        DMat3::from_quat(DQuat::from_axis_angle(random.direction().into(), if is_aligned { 0.0 } else { most * random.signed() }))
    };
    let down = DMat3::from_cols(DVec3::Y, DVec3::X, -DVec3::Z);
    let frame = tilt(random, 2.0) * down;
    let source = convex(random, DVec3::new(0.0, 0.0, 2.5), frame, 0.5, is_aligned);

    // Clear of the source and of the floor, else anywhere: before the source, beside it, across its plane.
    let centre = loop {
        let centre = DVec3::new(random.signed(), random.signed(), 0.6 + 2.4 * random.unit());
        if centre.distance(DVec3::new(0.0, 0.0, 2.5)) > 1.25 {
            break centre;
        }
    };
    let turn = tilt(random, 3.0);
    let faces = if random.below(2) == 0 {
        vec![convex(random, centre, turn, 0.3, is_aligned)]
    } else {
        let edges = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| turn * axis * (0.1 + 0.4 * random.unit()));
        box_faces((centre - 0.5 * edges.iter().sum::<DVec3>()).to_array(), edges.map(|edge| edge.to_array()))
    };
    // Each corner once: a line through two that differ by rounding has any direction.
    let mut occluder: Vec<DVec3> = Vec::new();
    for corner in faces.iter().flat_map(|face| face.vertices().map(DVec3::from).collect::<Vec<_>>()) {
        if occluder.iter().all(|known| known.distance(corner) > 1e-9) {
            occluder.push(corner);
        }
    }
    let floor = rectangle([-HALF, -HALF, 0.0], [2.0 * HALF, 0.0, 0.0], [0.0, 2.0 * HALF, 0.0]);
    let polygons = [source.clone(), floor].into_iter().chain(faces).collect();
    (Shadow { source, occluder }, polygons)
}

/// Where curves cross the way from `from` to `to`, from 0 to 1, ascending.
fn crossings(segments: &[Segment], from: DVec2, to: DVec2) -> Vec<f64> {
    let way = to - from;
    let crossing = |segment: &Segment| {
        let [a, b] = segment.ends().map(|end| DVec2::new(end[0], end[1]));
        let across = b - a;
        let span = way.perp_dot(across);
        let (on_way, on_curve) = ((a - from).perp_dot(across) / span, (a - from).perp_dot(way) / span);
        let room = 1e-4 / across.length();
        ((0.0..=1.0).contains(&on_way) && (-room..=1.0 + room).contains(&on_curve)).then_some(on_way)
    };
    let mut found: Vec<f64> = segments.iter().filter_map(crossing).chain([0.0, 1.0]).collect();
    found.sort_by(f64::total_cmp);
    found
}

/// The largest third difference of `f` with step `h` from `low` to `high`, and where it is.
fn third_difference(f: &dyn Fn(f64) -> f64, [low, high]: [f64; 2], h: f64) -> (f64, f64) {
    let count = ((high - low) / h) as usize;
    let values: Vec<f64> = (0..=count).map(|k| f(low + k as f64 * h)).collect();
    let third = |w: &[f64]| (w[3] - 3.0 * w[2] + 3.0 * w[1] - w[0]).abs();
    let at = |k: usize| low + k as f64 * h;
    values.windows(4).map(third).enumerate().fold((0.0, low), |best, (k, value)| if value > best.0 { (value, at(k)) } else { best })
}

/// Scenes of each test.
const TRIALS: u32 = 600;

/// Below this a difference is rounding: sums of a few numbers of at most 1.
const NOISE: f64 = 1e-13;

#[test]
fn between_curves_irradiance_is_smooth() {
    let mut random = Random::new(1);
    let (mut pieces, mut shadowed) = (0, 0);
    for trial in 0..TRIALS {
        let (shadow, polygons) = random_shadow(&mut random);
        let found = of_emitters(&lit_by_first(&polygons), 0.0);
        for _ in 0..3 {
            let [from, to] = [0, 1].map(|_| DVec2::new(2.5 * random.signed(), 2.5 * random.signed()));
            let f = |t: f64| shadow.irradiance(from.lerp(to, t));
            let h = 1e-3;
            for pair in crossings(found.of(FLOOR), from, to).windows(2) {
                // In pieces of some steps, clear of the curves.
                let mut low = pair[0] + 2.0 * h;
                while low + 8.0 * h < pair[1] - 2.0 * h {
                    let high = (low + 40.0 * h).min(pair[1] - 2.0 * h);
                    let (coarse, at) = third_difference(&f, [low, high], h);
                    let (fine, _) = third_difference(&f, [(at - 2.0 * h).max(low), (at + 5.0 * h).min(high)], h / 8.0);
                    assert!(fine < NOISE || fine < coarse / 200.0, "trial {trial}: a curve is missing at {} of {from} {to}", at);
                    pieces += 1;
                    shadowed += u32::from(coarse > 1e3 * NOISE);
                    low = high - 4.0 * h;
                    if high >= pair[1] - 2.0 * h {
                        break;
                    }
                }
            }
        }
    }
    assert!(pieces > 20_000 && shadowed > 10_000, "{pieces} pieces, {shadowed} of them where differences are far above rounding");
}

#[test]
fn across_each_curve_irradiance_is_not_smooth() {
    let mut random = Random::new(2);
    let mut counts = [0; 3];
    for trial in 0..TRIALS {
        let (shadow, polygons) = random_shadow(&mut random);
        let found = of_emitters(&lit_by_first(&polygons), 0.0);
        let segments = found.of(FLOOR);
        for (own, segment) in segments.iter().enumerate() {
            let [a, b] = segment.ends().map(|end| DVec2::new(end[0], end[1]));
            let (middle, across) = (a.lerp(b, 0.4), (b - a).perp().normalize());

            // Clear of all others.
            let h = 4e-3;
            let clear =
                |(k, other): (usize, &Segment)| k == own || super::distance([middle.x, middle.y, 0.0], other.ends()) > 4.0 * h;
            if !segments.iter().enumerate().all(clear) || a.distance(b) < 0.05 {
                continue;
            }
            let f = |t: f64| shadow.irradiance(middle + t * across);
            let gradient = |h: f64| (f(h) - 2.0 * f(0.0) + f(-h)).abs();
            let bend = |h: f64| (f(2.0 * h) - 2.0 * f(h) + 2.0 * f(-h) - f(-2.0 * h)).abs();
            // Steps are as short as rounding lets them be; the limit lies between what a jump and what none gives.
            let (jump, smooth, scale) = match segment.degree {
                Degree::D0 => panic!("trial {trial}: nothing touches"),
                Degree::D1 => (gradient(h / 64.0), gradient(h / 8.0), f64::sqrt(8.0 * 64.0)),
                Degree::D2 => (bend(h / 8.0), bend(h), f64::sqrt(64.0 * 512.0)),
            };
            // Where all that can be told is that light changes, it must.
            let is_weak = smooth < 1e3 * NOISE;
            assert!(smooth > 0.0 && (is_weak || jump > smooth / scale), "trial {trial}: {segment:?}: {smooth:e} {jump:e}");
            counts[segment.degree as usize] += u32::from(!is_weak);
        }
    }
    assert!(counts[1] > 100 && counts[2] > 500, "{counts:?}");
}
