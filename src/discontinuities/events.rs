//! Edge-vertex events of one source, followed into the scene (Lischinski, Tampieri, Greenberg 1992; Lischinski 1994, section 4.1.2).
//!
//! A wedge is the part of a plane behind an edge as seen from a corner of the source, or behind a corner as seen from an edge of the source. What it
//! meets first carries the curve. It begins only where the edge or the corner is seen from the source, and is on the outline of what casts the
//! shadow there.
//!
//! - Corner of the source, edge: D2. Edge of the source, corner: D2.
//! - Edge of the source and edge in one plane: D1, followed from both ends and the middle of the one and through both ends of the other.
//! - A face that is seen edge-on from a part of the source: D1, since it hides something on either side of its plane. Its far edge and the chord
//!   along which its plane cuts the source are followed like two edges in one plane.
//! - The source's own plane, in which it is seen edge-on: D1.
//!
//! Left out are events of two occluders that a source is seen behind (an edge of one with a corner of another, three edges), which are curves
//! within penumbras.

use glam::DVec3;

use super::corners::{Corner, is_outline};
use super::curves::{Curve, Found};
use super::edges::{Edge, Shadow};
use super::effect::{Lit, Passing, bound_change};
use super::emitters::{Apex, Emitter, Rim};
use super::envelope::first_hits;
use super::faces::{Faces, Plane};
use super::fan::{Cut, Fan, Windows, common, hide};
use super::segments::Degree;
use crate::geometry::Frame;
use crate::scene::SurfaceId;

/// Follows the events of one emitter.
pub(super) struct Tracer<'a> {
    pub faces: &'a Faces<'a>,
    pub emitter: &'a Emitter,
    /// The number of the emitter.
    pub number: u32,
    /// The receivers that count.
    pub lit: &'a Lit,
    pub found: &'a mut Found,
    cuts: Vec<Cut>,
}

/// What a wedge is: how sharp a curve it leaves, and what passes before the source there.
#[derive(Clone, Copy)]
struct Event {
    degree: Degree,
    passing: Passing,
}

impl<'a> Tracer<'a> {
    pub fn new(faces: &'a Faces<'a>, emitter: &'a Emitter, number: u32, lit: &'a Lit, found: &'a mut Found) -> Self {
        Self { faces, emitter, number, lit, found, cuts: Vec::new() }
    }

    /// All events with an edge of the scene.
    pub fn edge(&mut self, edge: &Edge) {
        let Some(ends) = self.in_front(edge.ends).filter(|ends| self.lit.may_be_shadowed_by(ends)) else { return };
        let emitter = self.emitter;
        let passing = Passing::Edge(ends, ends[0].distance(ends[1]));

        // Edges of the source in one plane with it, and chords that see one of its faces edge-on.
        let event = Event { degree: Degree::D1, passing };
        let mut done: Vec<DVec3> = Vec::new();
        for rim in &emitter.rims {
            let Some(plane) = self.common_plane(rim.ends, ends) else { continue };
            done.extend(rim.ends);
            if !rim.is_inner(&plane) && rim.middle.is_open_towards(self.faces, 0.5 * (ends[0] + ends[1])) {
                self.parallel(&plane, rim.ends, edge, ends, event);
            }
        }
        for wing in &edge.wings {
            let normal = wing.inward.cross(ends[1] - ends[0]).normalize_or_zero();
            let plane = Plane { origin: ends[0], normal };
            let Some(chord) = self.chord(&plane) else { continue };
            let is_far = |from: DVec3| wing.inward.dot(from - ends[0]) > self.faces.on_plane();
            if chord.iter().any(|&end| is_far(end)) {
                self.parallel(&plane, chord, edge, ends, event);
            }
        }

        // Corners of the source.
        let event = Event { degree: Degree::D2, passing };
        for (apex, sectors) in &emitter.corners {
            if done.iter().any(|known| known.distance(apex.place) <= self.faces.on_plane()) {
                continue;
            }
            let [a, b] = ends.map(|end| end - apex.place);
            let Some(plane) = Plane::along(apex.place, a, b) else { continue };
            if ![a, b, a + b].iter().any(|&direction| is_outline(sectors, direction)) {
                continue;
            }
            for plane in self.free_sides(edge, &plane) {
                self.through_edge(&plane, apex, ends, event);
            }
        }
    }

    /// All events with a corner of the scene.
    pub fn corner(&mut self, corner: &Corner) {
        if self.emitter.plane.height(corner.place) <= self.faces.on_plane() || !self.lit.may_be_shadowed_by(&[corner.place]) {
            return;
        }
        let emitter = self.emitter;
        let event = Event { degree: Degree::D2, passing: Passing::Edge([corner.place; 2], corner.arms) };
        for rim in &emitter.rims {
            let Some(plane) = self.plane_through(rim.ends, corner.place).filter(|plane| !rim.is_inner(plane)) else { continue };
            if !rim.middle.is_open_towards(self.faces, corner.place) {
                continue;
            }
            let windows = outline_windows(corner, rim);
            if !windows.is_empty() {
                self.through_corner(&plane, corner.place, (rim.ends, &windows), &corner.faces, event);
            }
        }
    }

    /// Where the source is seen edge-on.
    pub fn horizon(&mut self) {
        let emitter = self.emitter;
        let plane = emitter.plane;
        let frame = Frame::around(plane.normal);
        let event = Event { degree: Degree::D1, passing: Passing::Horizon };
        let around = [frame.tangent, frame.bitangent, -frame.tangent, -frame.bitangent];
        for (apex, _) in &emitter.corners {
            for quarter in 0..4 {
                let arms = [around[quarter], around[(quarter + 1) % 4]];
                let Some(fan) = Fan::new(apex.place, arms, plane.normal) else { continue };
                self.faces.cut(&plane, (&fan, f64::INFINITY), &apex.touching, &mut self.cuts);
                let windows = self.open_windows(apex, &fan);
                self.found.counters.wedges += 1;
                self.collect(&fan, &windows, f64::INFINITY, event);
            }
        }
    }

    /// The part of an edge in front of the source's plane.
    fn in_front(&self, [a, b]: [DVec3; 2]) -> Option<[DVec3; 2]> {
        let [height_a, height_b] = [a, b].map(|end| self.emitter.plane.height(end) - 2.0 * self.faces.on_plane());
        let crossing = a.lerp(b, height_a / (height_a - height_b));
        let ends = match (height_a > 0.0, height_b > 0.0) {
            (true, true) => [a, b],
            (true, false) => [a, crossing],
            (false, true) => [crossing, b],
            (false, false) => return None,
        };
        (ends[0].distance(ends[1]) > self.faces.on_plane()).then_some(ends)
    }

    /// The plane through a segment and a point; `None` where the point is on its line.
    fn plane_through(&self, [a, b]: [DVec3; 2], point: DVec3) -> Option<Plane> {
        let plane = Plane::along(a, b - a, point - a)?;
        let distance = (point - a).cross((b - a).normalize()).length();
        (distance > self.faces.on_plane()).then_some(plane)
    }

    /// The plane that holds two segments, if one does: through the longer, and the end of the other that knows it best.
    fn common_plane(&self, one: [DVec3; 2], other: [DVec3; 2]) -> Option<Plane> {
        let length_sq = |[a, b]: [DVec3; 2]| a.distance_squared(b);
        let (long, short) = if length_sq(one) >= length_sq(other) { (one, other) } else { (other, one) };
        let off_line = |point: DVec3| (point - long[0]).cross(long[1] - long[0]).length_squared();
        let (far, near) = if off_line(short[0]) > off_line(short[1]) { (short[0], short[1]) } else { (short[1], short[0]) };
        self.plane_through(long, far).filter(|plane| plane.height(near).abs() <= self.faces.on_plane())
    }

    /// Where a plane cuts the source in two.
    fn chord(&self, plane: &Plane) -> Option<[DVec3; 2]> {
        let along = self.emitter.plane.normal.cross(plane.normal).try_normalize()?;
        let is_off = |side: f64| {
            let mut corners = self.emitter.corners.iter();
            corners.any(|(apex, _)| side * plane.height(apex.place) > self.faces.on_plane())
        };
        if !is_off(1.0) || !is_off(-1.0) {
            return None;
        }
        let crossing = |rim: &Rim| {
            let [a, b] = rim.ends.map(|end| plane.height(end));
            (a * b < 0.0).then(|| rim.ends[0].lerp(rim.ends[1], a / (a - b)))
        };
        let in_plane = |&end: &DVec3| plane.height(end) == 0.0;
        let rims = || self.emitter.rims.iter();
        let points: Vec<DVec3> = rims().filter_map(crossing).chain(rims().flat_map(|rim| rim.ends).filter(in_plane)).collect();
        let by_place = |a: &&DVec3, b: &&DVec3| along.dot(**a).total_cmp(&along.dot(**b));
        let chord = [*points.iter().min_by(by_place)?, *points.iter().max_by(by_place)?];
        (chord[0].distance(chord[1]) > self.faces.on_plane()).then_some(chord)
    }

    /// The plane, seen from each side on which the edge leaves the source free.
    fn free_sides(&self, edge: &Edge, plane: &Plane) -> impl Iterator<Item = Plane> + use<> {
        let (front, back) = (Some(*plane), Some(plane.reversed()));
        let sides = match edge.shadow(plane.normal, self.faces.on_plane()) {
            Shadow::Behind => [front, None],
            Shadow::InFront => [None, back],
            Shadow::Nowhere => [front, back],
            Shadow::Both => [None, None],
        };
        sides.into_iter().flatten()
    }

    /// A segment of the source and an edge in one plane: all lines through both.
    fn parallel(&mut self, plane: &Plane, source: [DVec3; 2], edge: &Edge, ends: [DVec3; 2], event: Event) {
        let middle = 0.5 * (source[0] + source[1]);
        let apexes = [source[0], source[1], middle]
            .map(|place| Apex::new(self.faces, &self.emitter.plane, place, (middle - place).normalize_or_zero()));
        let mut corners = [(ends[0], ends[1] - ends[0]), (ends[1], ends[0] - ends[1])]
            .map(|(end, along)| Apex::new(self.faces, &self.emitter.plane, end, along.normalize_or_zero()));
        let around = corners.each_ref().map(|corner| corner.touching.clone());
        for corner in &mut corners {
            corner.leave_what_goes_on(self.faces);
        }
        for plane in self.free_sides(edge, plane) {
            for apex in &apexes {
                self.through_edge(&plane, apex, ends, event);
            }
            for (corner, around) in corners.iter().zip(&around) {
                let Some(fan) = Fan::new(corner.place, source.map(|end| end - corner.place), plane.normal) else { continue };
                let windows = common(&self.open_windows(corner, &fan), &self.open_windows(corner, &fan.opposite()));
                self.through_corner(&plane, corner.place, (source, &windows), around, event);
            }
        }
    }

    /// Follows the wedge from a point of the source through an edge.
    fn through_edge(&mut self, plane: &Plane, apex: &Apex, ends: [DVec3; 2], event: Event) {
        let [a, b] = ends.map(|end| end - apex.place);
        let distance = a.cross((b - a).normalize_or_zero()).length();
        if distance <= self.faces.on_plane() {
            return;
        }
        let Some(fan) = Fan::new(apex.place, [a, b], plane.normal) else { return };
        self.found.counters.wedges += 1;

        // What is nearer hides the edge.
        let margin = self.faces.on_plane() / distance;
        let mut windows = self.open_windows(apex, &fan);
        self.faces.cut(plane, (&fan, 1.0), &apex.touching, &mut self.cuts);
        hide(&mut windows, &self.cuts, 1.0 + margin);
        if windows.is_empty() {
            self.found.counters.hidden_wedges += 1;
            return;
        }

        // What is farther is lit beside it.
        self.faces.cut(plane, (&fan, f64::INFINITY), &apex.touching, &mut self.cuts);
        self.collect(&fan, &windows, 1.0 - margin, event);
    }

    /// Follows the wedge from parts of a segment of the source through a corner; `but` are the faces around that.
    fn through_corner(&mut self, plane: &Plane, corner: DVec3, source: ([DVec3; 2], &[[f64; 2]]), but: &[SurfaceId], event: Event) {
        let (ends, parts) = source;
        let [a, b] = ends.map(|end| end - corner);
        let distance = a.cross((b - a).normalize_or_zero()).length();
        let Some(fan) = Fan::new(corner, [a, b], plane.normal).filter(|_| distance > self.faces.on_plane()) else { return };
        let behind = fan.opposite();
        for plane in [*plane, plane.reversed()] {
            self.found.counters.wedges += 1;
            let mut is_touched = self.faces.cut(&plane, (&fan, 1.0), but, &mut self.cuts);
            let mut windows: Windows = parts.to_vec();
            hide(&mut windows, &self.cuts, 1.0 + self.faces.on_plane() / distance);
            if windows.is_empty() {
                self.found.counters.hidden_wedges += 1;
            } else {
                is_touched |= self.faces.cut(&plane, (&behind, f64::INFINITY), but, &mut self.cuts);
                self.collect(&behind, &windows, f64::INFINITY, event);
            }
            // Where nothing touches the plane both its sides are alike.
            if !is_touched {
                break;
            }
        }
    }

    /// The rays of a fan that leave the source freely.
    fn open_windows(&self, apex: &Apex, fan: &Fan) -> Windows {
        let mut stops = vec![0.0, 1.0];
        for &id in &apex.touching {
            let normal = self.faces.facet(id).normal;
            let [a, b] = [0.0, 1.0].map(|u| normal.dot(fan.direction(u)));
            stops.extend((a * b < 0.0).then(|| a / (a - b)));
        }
        stops.sort_by(f64::total_cmp);
        let parts = stops.windows(2).map(|stop| [stop[0], stop[1]]);
        let is_open = |part: &[f64; 2]| {
            let direction = fan.direction(0.5 * (part[0] + part[1]));
            apex.is_open_towards(self.faces, fan.apex + direction)
        };
        parts.filter(is_open).collect()
    }

    /// Takes what the rays of `windows` hit first beyond nearness `w` as curves.
    fn collect(&mut self, fan: &Fan, windows: &[[f64; 2]], w: f64, event: Event) {
        let Self { faces, emitter, number, lit, found, cuts } = self;
        first_hits(cuts, windows, w, |cut, rays| {
            let ends = rays.map(|u| cut.point(u));
            let direction = fan.direction(0.5 * (rays[0] + rays[1]));
            let Some(receiver) = faces.scene.side_towards(cut.surface, -direction).filter(|&id| lit.has(id)) else { return };
            if found.admit(faces, receiver, ends) {
                let change = bound_change(faces, emitter, receiver, ends, event.passing);
                found.curves.push(Curve { receiver, ends, degree: event.degree, emitter: *number, change });
            }
        });
    }
}

impl Rim {
    /// Whether a plane through it has the source and another that sends alike on different sides: both are seen, as one.
    fn is_inner(&self, plane: &Plane) -> bool {
        self.kin.is_some_and(|kin| plane.normal.dot(self.inward) * plane.normal.dot(kin) < 0.0)
    }
}

/// The parts of a rim from which a corner is a corner of an outline.
fn outline_windows(corner: &Corner, rim: &Rim) -> Windows {
    let mut stops = vec![0.0, 1.0];
    for plane in &corner.planes {
        let [a, b] = rim.ends.map(|end| plane.height(end));
        stops.extend((a * b < 0.0).then(|| a / (a - b)));
    }
    stops.sort_by(f64::total_cmp);
    let parts = stops.windows(2).map(|stop| [stop[0], stop[1]]);
    let is_seen = |part: &[f64; 2]| {
        let from = rim.ends[0].lerp(rim.ends[1], 0.5 * (part[0] + part[1]));
        part[1] > part[0] && is_outline(&corner.sectors, corner.place - from)
    };
    parts.filter(is_seen).collect()
}
