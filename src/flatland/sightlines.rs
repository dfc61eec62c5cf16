//! Sightlines: the lines from the front of a receiver to the front of a source.
//!
//! Lines have the measure `drho dtheta`, and `F_rs = mu(sightlines that nothing blocks) / (2 length of the receiver)` (Soler and Sillion 1996,
//! equation 2, after Santalo; the lines that meet a segment have the measure `2 length`). There is no kernel left.
//!
//! The paper has receiver and source before each other. Here they are cut at each other's lines first, since fronts alone receive and send.
//! Of what stands in between the part behind either line is cut off too, so that whatever a sightline meets does lie between its ends.

use std::f64::consts::PI;

use glam::DVec2;

use super::segment::Segment;

/// The lines from a receiver to a source.
#[derive(Clone, Debug)]
pub struct Sightlines {
    /// Receiver and source as they were given, and the parts that lie in front of each other.
    given: [Segment; 2],
    parts: [Segment; 2],
    unoccluded: f64,
}

/// The sightlines that meet some convex bodies.
#[derive(Clone, Copy, Debug)]
pub(super) struct Beam {
    /// In metres.
    pub measure: f64,
    /// The middle of the normals' angles, and how far they go to either side (`theta_12` and `delta_theta`).
    pub middle: f64,
    pub spread: f64,
    /// The largest extent along rho in any direction (`Delta_rho`), in metres.
    pub width: f64,
}

impl Sightlines {
    /// The sightlines between the fronts of a receiver and a source. Nothing, if these do not see each other: then their form factor is 0.
    pub fn between(receiver: &Segment, source: &Segment) -> Option<Self> {
        let parts = [receiver.in_front_of(source)?, source.in_front_of(receiver)?];
        let mut sightlines = Self { given: [*receiver, *source], parts, unoccluded: 0.0 };
        sightlines.unoccluded = sightlines.part_of_all(sightlines.beam(&[])?.measure);
        Some(sightlines)
    }

    /// F_0: the form factor if nothing stood in between.
    pub fn unoccluded(&self) -> f64 {
        self.unoccluded
    }

    /// The parts of receiver and source that lie in front of each other.
    pub(super) fn parts(&self) -> &[Segment; 2] {
        &self.parts
    }

    /// A measure of lines as the fraction of all that leave the receiver.
    pub(super) fn part_of_all(&self, measure: f64) -> f64 {
        0.5 * measure / self.given[0].length()
    }

    /// The part of an occluder that lies between receiver and source.
    pub(super) fn cut(&self, occluder: &Segment) -> Option<Segment> {
        self.given.iter().try_fold(*occluder, |rest, end| rest.in_front_of(end))
    }

    /// Whether a body lies between the lines of receiver and source as a whole.
    pub(super) fn enclose(&self, corners: &[DVec2]) -> bool {
        corners.iter().all(|&corner| self.given.iter().all(|end| end.height(corner) >= 0.0))
    }

    /// The sightlines that meet all of some convex bodies, given by their corners. Nothing, if there are none.
    pub(super) fn beam(&self, bodies: &[&[DVec2]]) -> Option<Beam> {
        let ends = self.parts.each_ref().map(Segment::points);
        let all: Vec<&[DVec2]> = ends.iter().map(|points| &points[..]).chain(bodies.iter().copied()).collect();

        // Between directions in which one corner hides another, the same corners limit the beam. In the receiver's frame no sightline
        // turns past its ends: directions are from 0 to pi.
        let [a, b] = self.given[0].points();
        let along = (b - a) / a.distance(b);
        let mut angles = crossing_angles(&all, along);
        angles.sort_unstable_by(f64::total_cmp);
        let normal = |angle: f64| DVec2::from_angle(angle).rotate(along).perp();

        let mut beam = Beam { measure: 0.0, middle: 0.0, spread: 0.0, width: 0.0 };
        let mut reach = [f64::INFINITY, f64::NEG_INFINITY];
        for piece in angles.windows(2).filter(|piece| piece[0] < piece[1]) {
            let [low, high] = limits(&all, normal(0.5 * (piece[0] + piece[1])));
            let (across, normals) = (high - low, [piece[0], piece[1]].map(normal));
            if across.dot(normals[0] + normals[1]) <= 0.0 {
                continue;
            }
            // The integral of the normal turns it back by a right angle.
            beam.measure += across.dot(normals[0].perp() - normals[1].perp()).max(0.0);
            beam.width = beam.width.max(widest(across, normals));
            reach = [reach[0].min(piece[0]), reach[1].max(piece[1])];
        }
        beam.middle = 0.5 * (reach[0] + reach[1]) + normal(0.0).to_angle();
        beam.spread = 0.5 * (reach[1] - reach[0]);
        (beam.measure > 0.0).then_some(beam)
    }
}

/// The angles from `along`, 0 to pi, of all lines through two corners, and both ends.
fn crossing_angles(bodies: &[&[DVec2]], along: DVec2) -> Vec<f64> {
    let corners: Vec<DVec2> = bodies.iter().flat_map(|body| body.iter().copied()).collect();
    let mut angles = vec![0.0, PI];
    for (k, &corner) in corners.iter().enumerate() {
        for &other in &corners[k + 1..] {
            let away = other - corner;
            let up = along.perp_dot(away);
            angles.push(up.abs().atan2(along.dot(away) * if up < 0.0 { -1.0 } else { 1.0 }));
        }
    }
    angles
}

/// The corners between whose shadows all bodies cast theirs.
fn limits(bodies: &[&[DVec2]], normal: DVec2) -> [DVec2; 2] {
    let above = |a: &&DVec2, b: &&DVec2| a.dot(normal).total_cmp(&b.dot(normal));
    let lowest = bodies.iter().filter_map(|body| body.iter().min_by(above));
    let highest = bodies.iter().filter_map(|body| body.iter().max_by(above));
    let [low, high] = [lowest.max_by(above), highest.min_by(above)];
    [low, high].map(|corner| corner.copied().unwrap_or_default())
}

/// The largest extent along a normal that turns from the first to the second.
fn widest(across: DVec2, normals: [DVec2; 2]) -> f64 {
    let [first, last] = normals.map(|normal| across.dot(normal));
    let turns = normals[0].perp().dot(across) > 0.0 && normals[1].perp().dot(across) < 0.0;
    if turns { across.length() } else { first.max(last) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn segment(a: [f64; 2], b: [f64; 2]) -> Segment {
        Segment::new(a, b).unwrap()
    }

    fn form_factor(receiver: ([f64; 2], [f64; 2]), source: ([f64; 2], [f64; 2])) -> f64 {
        let sightlines = Sightlines::between(&segment(receiver.0, receiver.1), &segment(source.0, source.1));
        sightlines.map_or(0.0, |sightlines| sightlines.unoccluded())
    }

    #[test]
    fn unoccluded_form_factors_are_those_of_crossed_strings() {
        // Facing segments of length 1 at distance 1: sqrt(2) - 1.
        let facing = form_factor(([0.0, 0.0], [1.0, 0.0]), ([1.0, 1.0], [0.0, 1.0]));
        assert!((facing - (2.0_f64.sqrt() - 1.0)).abs() < 1e-15);
        // Two sides of a right angle: (1 + 1 - sqrt(2)) / 2.
        let corner = form_factor(([0.0, 0.0], [1.0, 0.0]), ([0.0, 1.0], [0.0, 0.0]));
        assert!((corner - (1.0 - 0.5 * 2.0_f64.sqrt())).abs() < 1e-15);
        // Turned away, and of no length.
        assert_eq!(form_factor(([0.0, 0.0], [1.0, 0.0]), ([0.0, 1.0], [1.0, 1.0])), 0.0);
        assert_eq!(form_factor(([0.0, 0.0], [0.0, 0.0]), ([1.0, 1.0], [0.0, 1.0])), 0.0);
        assert_eq!(form_factor(([0.0, 0.0], [1.0, 0.0]), ([1.0, 1.0], [1.0, 1.0])), 0.0);
    }

    #[test]
    fn a_source_below_the_horizon_counts_with_what_is_above() {
        let whole = form_factor(([0.0, 0.0], [1.0, 0.0]), ([2.0, 1.0], [2.0, -3.0]));
        let turned = form_factor(([0.0, 0.0], [1.0, 0.0]), ([2.0, -3.0], [2.0, 1.0]));
        let above = form_factor(([0.0, 0.0], [1.0, 0.0]), ([2.0, 0.0], [2.0, 1.0]));
        assert!(whole == 0.0 && turned > 0.0 && (turned - above).abs() < 1e-15);
    }

    #[test]
    fn a_beam_holds_all_sightlines_through_a_box() {
        let sightlines = Sightlines::between(&segment([0.0, 0.0], [1.0, 0.0]), &segment([1.0, 2.0], [0.0, 2.0])).unwrap();
        let (low, high) = (DVec2::new(0.2, 0.8), DVec2::new(0.5, 1.3));
        let corners = [low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)];
        let beam = sightlines.beam(&[&corners]).unwrap();
        // Lines of a grid of both ends, weighted with cos cos / r.
        let (mut measure, count) = (0.0, 400);
        for (i, j) in (0..count * count).map(|k| (k / count, k % count)) {
            let [p, q] = [(i, 0.0), (j, 2.0)].map(|(k, y)| DVec2::new((f64::from(k) + 0.5) / f64::from(count), y));
            let normal = (q - p).normalize().perp();
            let shadow = corners.map(|corner| corner.dot(normal) - p.dot(normal));
            if shadow.iter().any(|&rho| rho > 0.0) && shadow.iter().any(|&rho| rho < 0.0) {
                measure += 4.0 / (q - p).length().powi(3) / f64::from(count).powi(2);
                let aside = (normal.to_angle() - beam.middle + 0.5 * PI).rem_euclid(PI) - 0.5 * PI;
                assert!(aside.abs() <= beam.spread);
            }
        }
        assert!((measure - beam.measure).abs() < 2e-3 * measure, "{measure}, {}", beam.measure);
        assert!(beam.width <= (high - low).length() && sightlines.enclose(&corners));
    }
}
