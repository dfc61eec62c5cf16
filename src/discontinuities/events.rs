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
use super::edges::Edge;
use super::effect::{Lit, Passing, bound_change};
use super::emitters::{Apex, Rim};
use super::envelope::first_hits;
use super::faces::{Faces, Plane};
use super::fan::{Cut, Fan, Windows, common};
use super::occluders::Occluder;
use super::segments::Degree;
use crate::geometry::{Aabb, Frame};
use crate::scene::SurfaceId;

/// Follows the events of one emitter.
pub(super) struct Tracer<'a> {
    pub faces: &'a Faces<'a>,
    /// The number of the emitter.
    pub number: u32,
    /// The emitter, and the receivers that count.
    pub lit: &'a Lit<'a>,
    pub found: &'a mut Found,
    cuts: Vec<Cut>,
}

/// What a wedge is.
#[derive(Clone, Copy)]
struct Event {
    /// How sharp a curve it leaves.
    degree: Degree,
    /// What passes before the source there.
    passing: Passing,
    /// How far from that it matters, in metres.
    reach: f64,
}

impl<'a> Tracer<'a> {
    pub fn new(faces: &'a Faces<'a>, number: u32, lit: &'a Lit<'a>, found: &'a mut Found) -> Self {
        Self { faces, number, lit, found, cuts: Vec::new() }
    }

    /// All events with an edge or a corner of the scene.
    pub fn occluder(&mut self, occluder: &Occluder) {
        match occluder {
            Occluder::Edge(edge) => self.edge(edge),
            Occluder::Corner(corner) => self.corner(corner),
        }
    }

    fn edge(&mut self, edge: &Edge) {
        let may_matter = |ends: &[DVec3; 2]| self.lit.may_be_shadowed_by(&Aabb::around(*ends));
        let Some(ends) = self.in_front(edge.ends).filter(may_matter) else {
            self.found.counters.weak_edges += 1;
            return;
        };
        let (emitter, length) = (self.lit.emitter, ends[0].distance(ends[1]));
        let (passing, reach) = (Passing::Edge(ends, length), self.lit.reach(&Aabb::around(ends), length));

        // Edges of the source in one plane with it, and chords that see one of its faces edge-on.
        let event = Event { degree: Degree::D1, passing, reach };
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
        let event = Event { degree: Degree::D2, passing, reach };
        for (apex, sectors) in &emitter.corners {
            if done.iter().any(|known| known.distance(apex.place) <= self.faces.on_plane()) {
                continue;
            }
            let [a, b] = ends.map(|end| end - apex.place);
            let Some(plane) = Plane::along(apex.place, a, b) else { continue };
            if ![a, b, a + b].iter().any(|&direction| is_outline(sectors, direction)) {
                continue;
            }
            for plane in edge.free_sides(&plane, self.faces.on_plane()) {
                self.through_edge(&plane, apex, ends, event);
            }
        }
    }

    fn corner(&mut self, corner: &Corner) {
        let (emitter, bounds) = (self.lit.emitter, Aabb::around([corner.place]));
        if emitter.plane.height(corner.place) <= self.faces.on_plane() || !self.lit.may_be_shadowed_by(&bounds) {
            self.found.counters.weak_edges += 1;
            return;
        }
        let (passing, reach) = (Passing::Edge([corner.place; 2], corner.arms), self.lit.reach(&bounds, corner.arms));
        let event = Event { degree: Degree::D2, passing, reach };
        for rim in &emitter.rims {
            let Some(plane) = self.plane_through(rim.ends, corner.place).filter(|plane| !rim.is_inner(plane)) else { continue };
            if !rim.middle.is_open_towards(self.faces, corner.place) {
                continue;
            }
            let windows = outline_windows(corner, rim);
            if !windows.is_empty() {
                let nearest = distance_to_line(corner.place, rim.ends);
                self.through_corner((&plane, corner.place), (rim.ends, &windows), &corner.faces, reach / nearest, event);
            }
        }
    }

    /// Where the source is seen edge-on.
    pub fn horizon(&mut self) {
        let emitter = self.lit.emitter;
        let plane = emitter.plane;
        let frame = Frame::around(plane.normal);
        let event = Event { degree: Degree::D1, passing: Passing::Horizon, reach: self.lit.reach_of_horizon() };
        // A segment between two arms, of length 1, comes as near as the root of a half.
        let farthest = 2.0_f64.sqrt() * (event.reach + emitter.diameter);
        let around = [frame.tangent, frame.bitangent, -frame.tangent, -frame.bitangent];
        for (apex, _) in &emitter.corners {
            for quarter in 0..4 {
                let arms = [around[quarter], around[(quarter + 1) % 4]];
                let Some(fan) = Fan::new(apex.place, arms, plane.normal) else { continue };
                self.faces.cut(&plane, (&fan, [0.0, farthest]), &apex.touching, &mut self.cuts);
                let windows = self.open_windows(apex, &fan);
                self.count_wedge(farthest);
                self.collect(&fan, &windows, [f64::INFINITY, 1.0 / farthest], event);
            }
        }
    }

    /// The part of an edge in front of the source's plane.
    fn in_front(&self, [a, b]: [DVec3; 2]) -> Option<[DVec3; 2]> {
        let [height_a, height_b] = [a, b].map(|end| self.lit.emitter.plane.height(end) - 2.0 * self.faces.on_plane());
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
        let along = self.lit.emitter.plane.normal.cross(plane.normal).try_normalize()?;
        let is_off = |side: f64| {
            let mut corners = self.lit.emitter.corners.iter();
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
        let rims = || self.lit.emitter.rims.iter();
        let points: Vec<DVec3> = rims().filter_map(crossing).chain(rims().flat_map(|rim| rim.ends).filter(in_plane)).collect();
        let by_place = |a: &&DVec3, b: &&DVec3| along.dot(**a).total_cmp(&along.dot(**b));
        let chord = [*points.iter().min_by(by_place)?, *points.iter().max_by(by_place)?];
        (chord[0].distance(chord[1]) > self.faces.on_plane()).then_some(chord)
    }

    /// A segment of the source and an edge in one plane: all lines through both.
    fn parallel(&mut self, plane: &Plane, source: [DVec3; 2], edge: &Edge, ends: [DVec3; 2], event: Event) {
        let middle = 0.5 * (source[0] + source[1]);
        let apexes = [source[0], source[1], middle]
            .map(|place| Apex::new(self.faces, &self.lit.emitter.plane, place, (middle - place).normalize_or_zero()));
        let mut corners = [(ends[0], ends[1] - ends[0]), (ends[1], ends[0] - ends[1])]
            .map(|(end, along)| Apex::new(self.faces, &self.lit.emitter.plane, end, along.normalize_or_zero()));
        let around = corners.each_ref().map(|corner| corner.touching.clone());
        for corner in &mut corners {
            corner.leave_what_goes_on(self.faces);
        }
        // Beyond a corner of the edge, how far from the edge's line a point lies is to the way from the corner as it is on the source's side.
        let off_line = source.map(|end| plane.normal.cross(ends[1] - ends[0]).normalize_or_zero().dot(end - ends[0]));
        let nearest = if off_line[0] * off_line[1] > 0.0 { off_line[0].abs().min(off_line[1].abs()) } else { 0.0 };
        for plane in edge.free_sides(plane, self.faces.on_plane()) {
            for apex in &apexes {
                self.through_edge(&plane, apex, ends, event);
            }
            for (corner, around) in corners.iter().zip(&around) {
                let Some(fan) = Fan::new(corner.place, source.map(|end| end - corner.place), plane.normal) else { continue };
                let windows = common(&self.open_windows(corner, &fan), &self.open_windows(corner, &fan.opposite()));
                self.through_corner((&plane, corner.place), (source, &windows), around, event.reach / nearest, event);
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
        let farthest = 1.0 + event.reach / distance;
        self.count_wedge(farthest);

        // What is nearer hides the edge.
        let margin = self.faces.on_plane() / distance;
        let mut windows = self.open_windows(apex, &fan);
        self.faces.hide(plane, (&fan, 1.0 + margin), &apex.touching, &mut windows);
        if windows.is_empty() {
            self.found.counters.hidden_wedges += 1;
            return;
        }

        // What is farther is lit beside it.
        self.faces.cut(plane, (&fan, [1.0 - margin, farthest]), &apex.touching, &mut self.cuts);
        self.collect(&fan, &windows, [1.0 - margin, 1.0 / farthest], event);
    }

    /// Follows the wedge from parts of a segment of the source through a corner, until it is `farthest` times as far behind it as the source is before
    /// it; `but` are the faces around the corner.
    fn through_corner(
        &mut self,
        (plane, corner): (&Plane, DVec3),
        (ends, parts): ([DVec3; 2], &[[f64; 2]]),
        but: &[SurfaceId],
        farthest: f64,
        event: Event,
    ) {
        let distance = distance_to_line(corner, ends);
        let Some(fan) = Fan::new(corner, ends.map(|end| end - corner), plane.normal).filter(|_| distance > self.faces.on_plane())
        else {
            return;
        };
        let behind = fan.opposite();
        for plane in [*plane, plane.reversed()] {
            self.count_wedge(farthest);
            let mut windows: Windows = parts.to_vec();
            let nearness = 1.0 + self.faces.on_plane() / distance;
            let mut is_touched = self.faces.hide(&plane, (&fan, nearness), but, &mut windows);
            if windows.is_empty() {
                self.found.counters.hidden_wedges += 1;
            } else {
                is_touched |= self.faces.cut(&plane, (&behind, [0.0, farthest]), but, &mut self.cuts);
                self.collect(&behind, &windows, [f64::INFINITY, 1.0 / farthest], event);
            }
            // Where nothing touches the plane both its sides are alike.
            if !is_touched {
                break;
            }
        }
    }

    /// Counts a wedge that is followed to `farthest` times the segment that spans it.
    fn count_wedge(&mut self, farthest: f64) {
        self.found.counters.wedges += 1;
        self.found.counters.short_wedges += u64::from(farthest < f64::INFINITY);
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

    /// Takes what the rays of `windows` hit first between two nearnesses as curves.
    fn collect(&mut self, fan: &Fan, windows: &[[f64; 2]], nearness: [f64; 2], event: Event) {
        let Self { faces, number, lit, found, cuts } = self;
        first_hits(cuts, windows, nearness, |cut, rays| {
            let ends = rays.map(|u| cut.point(u));
            let direction = fan.direction(0.5 * (rays[0] + rays[1]));
            let Some(receiver) = faces.scene.side_towards(cut.surface, -direction).filter(|&id| lit.has(id)) else { return };
            if found.admit(faces, receiver, ends) {
                let change = bound_change(faces, lit.emitter, receiver, ends, event.passing);
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

/// The distance of a point from the line through two others.
fn distance_to_line(point: DVec3, [a, b]: [DVec3; 2]) -> f64 {
    (a - point).cross((b - a).normalize_or_zero()).length()
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
