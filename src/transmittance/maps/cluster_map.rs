//! The map of a cluster: its beams, one for each direction cell, made when a line asks for it first.

use std::sync::OnceLock;

use glam::DVec3;

use super::beam::{Beam, Part};
use super::contents::Contents;
use super::frame::frame_of;
use super::line::Line;
use crate::geometry::{Aabb, sampling};
use crate::hierarchy::{Hierarchy, NodeId};

/// How finely maps know lines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MapResolution {
    /// Direction cells along either side of one of the three faces of a half cube of directions, 1 to 64.
    pub directions: usize,
    /// Offset cells along either side at the finest resolution, a power of two from 1 to 256.
    pub offsets: usize,
}

impl Default for MapResolution {
    /// Across a cluster lines of a direction cell part by an eighth of its width, and as wide are the offset cells of steep lines.
    fn default() -> Self {
        Self { directions: 8, offsets: 16 }
    }
}

/// The map of one cluster.
pub(super) struct ClusterMap {
    centre: DVec3,
    half_sides: DVec3,
    resolution: MapResolution,
    /// The area of a patch that is blocked as a whole or not at all, in m^2.
    pub patch: f64,
    /// Lines through two points this far apart in the cluster, in metres, are told apart.
    pub grain: f64,
    /// The width of an offset cell where the cluster is longest, in metres.
    pub pitch: f64,
    beams: Box<[OnceLock<Beam>]>,
}

impl ClusterMap {
    pub fn new(bounds: &Aabb, patch: f64, resolution: MapResolution) -> Self {
        let half_sides = 0.5 * bounds.extent();
        let beams = (0..3 * resolution.directions.pow(2)).map(|_| OnceLock::new()).collect();
        let (grain, pitch) = (grain_of(half_sides, resolution), pitch_of(half_sides, resolution));
        Self { centre: bounds.centre(), half_sides, resolution, patch, grain, pitch, beams }
    }

    /// What is blocked of the lines about a line.
    pub fn part(&self, line: &Line, level: u32, make: impl FnOnce(BeamPlace) -> Beam) -> Part {
        let turns = self.resolution.directions;
        let place = line.slopes.map(|slope| ((0.5 * (slope + 1.0) * turns as f64) as usize).min(turns - 1));
        let index = (line.axis * turns + place[1]) * turns + place[0];
        let beam = self.beams[index].get_or_init(|| make(BeamPlace { axis: line.axis, place, index }));
        beam.part(line.offsets(self.centre), level)
    }

    /// Makes a beam of a cluster's surfaces.
    pub fn beam(&self, contents: &Contents, hierarchy: &Hierarchy, cluster: NodeId, place: BeamPlace, seed: u64) -> Beam {
        let MapResolution { directions, offsets } = self.resolution;
        // A cluster that is flat has a width as well, so that offsets have places.
        let half_sides = self.half_sides.max(DVec3::splat(1e-6 * self.half_sides.max_element()));
        let frame = frame_of(place.axis, place.place, directions, half_sides, offsets);
        Beam::of(contents.polygons(hierarchy, cluster), self.centre, frame, sampling::hash(seed, place.index as u64))
    }

    /// Bytes of the memory that one takes once all of its beams are made.
    pub fn bytes(resolution: MapResolution) -> u64 {
        let beams = 3 * resolution.directions.pow(2) as u64;
        beams * (size_of::<OnceLock<Beam>>() as u64 + Beam::bytes(resolution.offsets)) + size_of::<Self>() as u64
    }

    /// Bytes that it takes without its beams.
    pub fn empty_bytes(&self) -> u64 {
        (size_of_val(&self.beams[..]) + size_of::<Self>()) as u64
    }

    /// Bytes that each beam takes.
    pub fn bytes_of_beam(&self) -> u64 {
        Beam::bytes(self.resolution.offsets)
    }
}

/// Which direction cell a beam is of.
#[derive(Clone, Copy)]
pub(super) struct BeamPlace {
    axis: usize,
    place: [usize; 2],
    index: usize,
}

/// How far apart lines in a box must be to fall into different cells, about: the diagonal of what offset cells and the turn of a direction cell
/// blur, where the box is longest.
pub(super) fn grain_of(half_sides: DVec3, resolution: MapResolution) -> f64 {
    let turn = half_sides.max_element() / resolution.directions as f64;
    pitch_of(half_sides, resolution).hypot(turn)
}

/// The width of an offset cell where the box is longest, of lines along an axis.
fn pitch_of(half_sides: DVec3, resolution: MapResolution) -> f64 {
    2.0 * half_sides.max_element() / resolution.offsets as f64
}
