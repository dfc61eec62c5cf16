//! Borders of the shadows of lights that are no surfaces.
//!
//! - A light at a point, and parallel light: behind each edge that is a silhouette from there, the plane through both carries the border of a shadow. Across
//!   it irradiance jumps by all that the light brings: D0.
//! - A sun that is a disc: of the planes through an edge two touch the disc, and the penumbra lies between what they carry; D1. Where it is so narrow that a
//!   step in its middle would do, one plane through the middle of the disc carries that: D0.
//!
//! Around a corner the penumbra of a disc ends in a piece of an ellipse, which is left out, and so are the cones of spots: these are curved.
//!
//! **What of it matters.** A border changes as much as the light brings there. Edges where that is no more than any receiver tolerates are not looked
//! at; of too many the ones are followed whose length and light make most, and the others are counted.

use glam::DVec3;
use rayon::prelude::*;

use super::curves::{Curve, Found};
use super::edges::Edge;
use super::effect::distance_to_segment;
use super::envelope::first_hits;
use super::faces::{Faces, Plane};
use super::fan::{Cut, Fan};
use super::segments::Degree;
use crate::geometry::Aabb;
use crate::progress::Stop;
use crate::scene::{Light, LightShape, SurfaceId};

/// Rays of parallel light begin so many times as far away as the scene is wide.
const AFAR: f64 = 4.0;

/// The part of the squared error that each receiver tolerates that all penumbras together may have which are taken as steps.
const STEPS_PART: f64 = 0.1;

/// The mean square by which a step is off a ramp of the same width, for a height of 1.
const OFF_A_RAMP: f64 = 1.0 / 12.0;

/// Edges that a thread takes at a time.
const AT_ONCE: usize = 32;

/// What all borders are followed with.
pub(super) struct LightTracer<'a> {
    pub faces: &'a Faces<'a>,
    pub bounds: Aabb,
    /// In W/m^2, by receiver.
    pub tolerance: &'a (dyn Fn(SurfaceId) -> f64 + Sync),
    pub stop: Stop<'a>,
}

/// Light is looked at along a border in pieces of this part of its distance from the light, or less; but no more than so many.
const PIECE: f64 = 0.1;
const MOST_PIECES: f64 = 64.0;

/// A light with a number among all that send something.
#[derive(Clone, Copy)]
struct Lamp<'a> {
    number: u32,
    light: &'a Light,
}

/// What an edge leaves on receivers.
#[derive(Default)]
struct Borders {
    found: Found,
    /// If they are steps in the middle of penumbras: what these are off, as a part of the squared error that their receivers tolerate.
    off: f64,
}

/// A part of a light.
#[derive(Clone, Copy)]
enum Part {
    /// From a place.
    Place(DVec3),
    /// From afar: the unit vector to it.
    Afar(DVec3),
}

impl LightTracer<'_> {
    /// The borders behind some edges that a light casts, which has this number; of at most so many edges.
    pub fn follow(&self, edges: &[Edge], light: &Light, number: u32, most: usize) -> Found {
        let lamp = Lamp { number, light };
        let mut found = Found::default();
        let edges = self.that_matter(edges, light, most, &mut found);
        let follow = |trace: &(dyn Fn(&Edge) -> Borders + Sync), edges: &[&Edge]| -> Vec<Borders> {
            let of_some = |some: &[&Edge]| some.iter().map(|edge| trace(edge)).collect::<Vec<_>>();
            edges.par_chunks(AT_ONCE).flat_map_iter(of_some).collect()
        };
        let (part, radius) = match &light.shape {
            LightShape::Point(light) => (Part::Place(light.position), 0.0),
            LightShape::Sun(sun) => (Part::Afar(sun.towards), 0.5 * sun.diameter),
            LightShape::Sky(_) => return found,
        };
        let mut borders = follow(&|edge| self.middle(lamp, (part, radius), edge), &edges);
        let (Part::Afar(towards), true) = (part, radius > 0.0) else {
            borders.into_iter().for_each(|borders| found.append(borders.found));
            return found;
        };

        // The narrowest penumbras are steps, as many as may be; of the others both borders count.
        let mut order: Vec<usize> = (0..edges.len()).filter(|&k| !borders[k].found.curves.is_empty()).collect();
        order.sort_by(|&a, &b| borders[a].off.total_cmp(&borders[b].off).then(a.cmp(&b)));
        let mut off = 0.0;
        let steps = order.iter().take_while(|&&k| {
            off += borders[k].off;
            off <= STEPS_PART
        });
        let mut is_step = vec![false; edges.len()];
        steps.for_each(|&k| is_step[k] = true);
        let wide: Vec<&Edge> = edges.iter().zip(&is_step).filter(|(_, is_step)| !**is_step).map(|(edge, _)| *edge).collect();
        borders.iter_mut().zip(is_step).filter(|(_, is_step)| !is_step).for_each(|(of, _)| of.found.curves.clear());
        let both = follow(&|edge| self.penumbra(lamp, (towards, radius), edge), &wide);
        borders.into_iter().chain(both).for_each(|borders| found.append(borders.found));
        found
    }

    /// The edges whose shadows may matter, in order; of more than `most` those that make most. The others are counted.
    fn that_matter<'e>(&self, edges: &'e [Edge], light: &Light, most: usize, found: &mut Found) -> Vec<&'e Edge> {
        let least = self.faces.ids().map(self.tolerance).fold(f64::INFINITY, f64::min);
        // At most, for the nearest place of an edge.
        let (peak, place) = match &light.shape {
            LightShape::Point(point) => (point.peak() * light.brightest(), Some(point.position)),
            _ => (light.brightest(), None),
        };
        let brings = |edge: &Edge| place.map_or(peak, |place| peak / distance_to_segment(place, edge.ends).powi(2));
        let weigh = |edge: &'e Edge| {
            let brings = brings(edge);
            (brings > least).then(|| (brings * edge.ends[0].distance(edge.ends[1]), edge))
        };
        let mut left: Vec<(usize, (f64, &Edge))> =
            edges.par_iter().enumerate().filter_map(|(number, edge)| Some((number, weigh(edge)?))).collect();
        found.counters.weak_edges += (edges.len() - left.len()) as u64;
        if left.len() > most {
            found.counters.unfollowed_edges += (left.len() - most) as u64;
            left.sort_by(|a, b| b.1.0.total_cmp(&a.1.0).then(a.0.cmp(&b.0)));
            left.truncate(most);
            left.sort_by_key(|of| of.0);
        }
        left.into_iter().map(|(_, (_, edge))| edge).collect()
    }

    /// What light at a point or from the middle of a sun of some radius leaves behind an edge.
    fn middle(&self, lamp: Lamp<'_>, (part, radius): (Part, f64), edge: &Edge) -> Borders {
        let mut borders = Borders::default();
        if !(self.stop)() {
            self.behind(lamp, part, edge, (Degree::D0, radius), &mut borders);
        }
        borders
    }

    /// What the two planes through an edge that touch a sun leave behind it.
    fn penumbra(&self, lamp: Lamp<'_>, (towards, radius): (DVec3, f64), edge: &Edge) -> Borders {
        let mut borders = Borders::default();
        let along = (edge.ends[1] - edge.ends[0]).normalize_or_zero();
        let across = towards - towards.dot(along) * along;
        let sin = radius.sin() / across.length();
        // Seen nearly end-on it has no such planes.
        if (self.stop)() || sin.is_nan() || sin >= 1.0 {
            return borders;
        }
        let (across, beside) = (across.normalize(), along.cross(across.normalize()));
        for sin in [sin, -sin] {
            // The unit normal of a plane along the edge, and the place where that touches the disc.
            let normal = (1.0 - sin * sin).sqrt() * beside + sin * across;
            let touched = (towards - normal.dot(towards) * normal).normalize_or_zero();
            self.behind(lamp, Part::Afar(touched), edge, (Degree::D1, 0.0), &mut borders);
        }
        borders
    }

    /// Follows a part of the light behind an edge: it begins where that sees the edge.
    fn behind(&self, lamp: Lamp<'_>, part: Part, edge: &Edge, (degree, radius): (Degree, f64), borders: &mut Borders) {
        let [a, b] = edge.ends;
        let (way, apex) = match part {
            Part::Place(apex) => (a - apex, Some(apex)),
            Part::Afar(towards) => (-AFAR * self.bounds.diagonal() * towards, None),
        };
        let along = (b - a).normalize_or_zero();
        let distance = way.cross(along).length();
        let Some(plane) = Plane::along(a, way, along).filter(|_| distance > self.faces.on_plane()) else { return };
        // Faces that touch the light hide nothing.
        let touching = apex.map_or_else(Vec::new, |apex| self.touching(apex));
        let margin = self.faces.on_plane() / distance;
        let mut cuts: Vec<Cut> = Vec::new();
        for plane in edge.free_sides(&plane, self.faces.on_plane()) {
            let fan = match apex {
                Some(apex) => Fan::new(apex, edge.ends.map(|end| end - apex), plane.normal),
                None => Fan::parallel(way, edge.ends, plane.normal),
            };
            let Some(fan) = fan else { continue };
            borders.found.counters.wedges += 1;
            let mut windows = vec![[0.0, 1.0]];
            self.faces.hide(&plane, (&fan, 1.0 + margin), &touching, &mut windows);
            if windows.is_empty() {
                borders.found.counters.hidden_wedges += 1;
                continue;
            }
            self.faces.cut(&plane, (&fan, [1.0 - margin, f64::INFINITY]), &touching, &mut cuts);
            first_hits(&cuts, &windows, [1.0 - margin, 0.0], |cut, rays| {
                let direction = fan.direction(0.5 * (rays[0] + rays[1]));
                let Some(receiver) = self.faces.scene.side_towards(cut.surface, -direction) else { return };
                let ends = rays.map(|u| cut.point(u));
                if borders.found.admit(self.faces, receiver, ends) {
                    let change = self.brings(lamp.light, receiver, ends);
                    let width = ends.map(|end| 2.0 * radius.sin() * (end - a).cross(along).length());
                    borders.off += self.off((receiver, ends), change, width[0].midpoint(width[1]), &plane);
                    borders.found.curves.push(Curve { receiver, ends, degree, emitter: lamp.number, change });
                }
            });
        }
    }

    /// The faces that touch a place.
    fn touching(&self, place: DVec3) -> Vec<SurfaceId> {
        let near = self.faces.near(&Aabb::around([place]));
        near.into_iter().filter(|&id| self.faces.facet(id).distance_to(place) <= self.faces.on_plane()).collect()
    }

    /// The most that a light brings to some places along a segment on a receiver, in its brightest channel in W/m^2.
    fn brings(&self, light: &Light, receiver: SurfaceId, ends: [DVec3; 2]) -> f64 {
        let normal = self.faces.facet(receiver).normal;
        let (radius, distance) = match &light.shape {
            LightShape::Sun(sun) => ((0.5 * sun.diameter).sin(), f64::INFINITY),
            LightShape::Point(point) => (0.0, distance_to_segment(point.position, ends)),
            LightShape::Sky(_) => return 0.0,
        };
        let pieces = (ends[0].distance(ends[1]) / (PIECE * distance)).ceil().clamp(2.0, MOST_PIECES) as u32;
        let at = |piece: u32| {
            let seen = light.shape.seen_from(ends[0].lerp(ends[1], f64::from(piece) / f64::from(pieces)), [0.0; 2])?;
            Some((normal.dot(seen.towards) + radius).max(0.0) * seen.irradiance)
        };
        (0..=pieces).filter_map(at).fold(0.0, f64::max) * light.brightest()
    }

    /// How much a step is off in the middle of a penumbra, which is so wide across the plane of the step and changes so much, as a part of the
    /// squared error that the receiver tolerates.
    fn off(&self, (receiver, ends): (SurfaceId, [DVec3; 2]), change: f64, width: f64, plane: &Plane) -> f64 {
        let facet = self.faces.facet(receiver);
        let area = ends[0].distance(ends[1]) * width / plane.normal.cross(facet.normal).length();
        let off = OFF_A_RAMP * change * change * area / ((self.tolerance)(receiver).powi(2) * facet.area);
        if off.is_nan() { 0.0 } else { off }
    }
}
