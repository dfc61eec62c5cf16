//! The curves of one receiver, welded: what lies on one line becomes one chain of segments, ends that are one within the tolerance meet, and curves of
//! little effect are left out.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use glam::{DVec2, DVec3};

use super::counters::Counters;
use super::curves::Curve;
use super::faces::Faces;
use super::points::Welder;
use super::segments::{Degree, NO_EMITTER, Segment};
use crate::geometry::Frame;
use crate::scene::SurfaceId;

/// A segment of a line, by its coordinates along it.
#[derive(Clone, Copy)]
struct Stretch {
    from: f64,
    to: f64,
    degree: Degree,
    emitter: u32,
    change: f64,
}

/// A line in the plane of a receiver, with what lies on it.
struct Line {
    origin: DVec2,
    along: DVec2,
    stretches: Vec<Stretch>,
}

/// The lines so far, by their directions from 0 to pi.
#[derive(Default)]
struct Lines {
    lines: Vec<Line>,
    by_angle: BTreeMap<(u64, usize), ()>,
}

/// The segments of a receiver, and what became of its curves. `name` tells which surface an emitter is,
/// if it is one.
pub(super) fn weld(
    faces: &Faces<'_>,
    mut curves: Vec<Curve>,
    tolerance: f64,
    name: impl Fn(u32) -> Option<SurfaceId>,
) -> (Vec<Segment>, Counters) {
    let Some(first) = curves.first() else { return Default::default() };
    let facet = faces.facet(first.receiver);
    let frame = Frame::around(facet.normal);
    let flat = |point: DVec3| DVec2::new(frame.tangent.dot(point - facet.centroid), frame.bitangent.dot(point - facet.centroid));
    let lift = |point: DVec2| facet.centroid + point.x * frame.tangent + point.y * frame.bitangent;

    // The longest first: a long one knows its line best.
    curves.sort_by(|a, b| length_sq(b).total_cmp(&length_sq(a)));
    let mut lines = Lines::default();
    for curve in &curves {
        lines.add(curve.ends.map(flat), curve, faces.on_plane());
    }

    // Ends that are one meet.
    let mut welder = Welder::new(faces.on_plane());
    let mut segments = Vec::new();
    for line in &lines.lines {
        for stretch in line.overlaid(faces.on_plane()) {
            let ends = [stretch.from, stretch.to].map(|t| welder.weld(lift(line.origin + t * line.along)).0);
            if ends[0] != ends[1] {
                segments.push(Segment { ends, degree: stretch.degree, source: name(stretch.emitter), change: stretch.change });
            }
        }
    }

    // What changes least is left out, as much as the tolerance allows in all.
    segments.sort_by(|a, b| a.change.total_cmp(&b.change).then_with(|| by_place(a, b)));
    let mut spent = 0.0;
    let is_small = |segment: &&Segment| {
        spent += segment.change;
        spent <= tolerance
    };
    let left_out = segments.iter().take_while(is_small).count();
    segments.drain(..left_out);
    segments.sort_by(|a, b| a.degree.cmp(&b.degree).then(b.change.total_cmp(&a.change)).then_with(|| by_place(a, b)));

    let count = |degree| segments.iter().filter(|segment| segment.degree == degree).count() as u64;
    let counters = Counters {
        left_out: left_out as u64,
        d0: count(Degree::D0),
        d1: count(Degree::D1),
        d2: count(Degree::D2),
        most_per_surface: segments.len() as u64,
        ..Counters::default()
    };
    (segments, counters)
}

fn length_sq(curve: &Curve) -> f64 {
    curve.ends[0].distance_squared(curve.ends[1])
}

/// By the coordinates of the ends.
fn by_place(a: &Segment, b: &Segment) -> std::cmp::Ordering {
    let coordinates = |segment: &Segment| segment.ends.map(|end| end.to_array());
    let (a, b) = (coordinates(a), coordinates(b));
    a.as_flattened()
        .iter()
        .zip(b.as_flattened())
        .map(|(a, b)| a.total_cmp(b))
        .find(|order| order.is_ne())
        .unwrap_or(std::cmp::Ordering::Equal)
}

impl Lines {
    /// Puts a segment on the line that holds it within the tolerance, or on a new one.
    fn add(&mut self, [a, b]: [DVec2; 2], curve: &Curve, tolerance: f64) {
        let Some(along) = (b - a).try_normalize() else { return };
        let along = if along.y < 0.0 || (along.y == 0.0 && along.x < 0.0) { -along } else { along };
        let angle = along.to_angle().rem_euclid(PI);

        // Both ends off by the tolerance turn it by so much.
        let turn = 2.0 * tolerance / a.distance(b) + 1e-12;
        let key = |angle: f64| angle.max(0.0).to_bits();
        let around = [[angle - turn, angle + turn], [angle - turn + PI, PI], [0.0, angle + turn - PI]];
        let known = around
            .into_iter()
            .filter(|[low, high]| low <= high)
            .flat_map(|[low, high]| self.by_angle.range((key(low), 0)..=(key(high), usize::MAX)).map(|(&(_, index), ())| index));
        let holds = |line: &Line| [a, b].iter().all(|&end| line.along.perp_dot(end - line.origin).abs() <= tolerance);
        let index = known.filter(|&index| holds(&self.lines[index])).min().unwrap_or_else(|| {
            self.by_angle.insert((key(angle), self.lines.len()), ());
            self.lines.push(Line { origin: a, along, stretches: Vec::new() });
            self.lines.len() - 1
        });

        let line = &mut self.lines[index];
        let [s, t] = [a, b].map(|end| line.along.dot(end - line.origin));
        let Curve { degree, emitter, change, .. } = *curve;
        line.stretches.push(Stretch { from: s.min(t), to: s.max(t), degree, emitter, change });
    }
}

impl Line {
    /// The stretches laid over each other: none overlap any more, each with the least degree, and with the changes of all sources together.
    fn overlaid(&self, tolerance: f64) -> Vec<Stretch> {
        let mut places: Vec<f64> = self.stretches.iter().flat_map(|stretch| [stretch.from, stretch.to]).collect();
        places.sort_by(f64::total_cmp);
        places.dedup_by(|b, a| *b - *a <= tolerance);

        let mut laid: Vec<Stretch> = Vec::new();
        for pair in places.windows(2) {
            let middle = 0.5 * (pair[0] + pair[1]);
            let here = || self.stretches.iter().filter(|stretch| stretch.from < middle && stretch.to > middle);
            let Some(degree) = here().map(|stretch| stretch.degree).min() else { continue };

            // Of each emitter the largest, and of all the sum; the one that changes most gives its name.
            let mut changes: BTreeMap<u32, f64> = BTreeMap::new();
            for stretch in here() {
                let largest = changes.entry(stretch.emitter).or_insert(0.0);
                *largest = largest.max(stretch.change);
            }
            let change = changes.values().sum();
            let most =
                changes.iter().max_by(|a, b| a.1.total_cmp(b.1).then(b.0.cmp(a.0))).map_or(NO_EMITTER, |(&emitter, _)| emitter);
            let next = Stretch { from: pair[0], to: pair[1], degree, emitter: most, change };
            match laid.last_mut().filter(|last| last.to == next.from && last.degree == degree && last.emitter == most) {
                Some(last) => {
                    last.to = next.to;
                    last.change = last.change.max(change);
                }
                None => laid.push(next),
            }
        }
        laid
    }
}
