//! How much passes along segments, down the clusters, each taken as a whole where its map is good enough.

use std::sync::atomic::{AtomicU64, Ordering};

use glam::DVec3;

use super::beam::Part;
use super::cluster_map::{ClusterMap, MapResolution, grain_of};
use super::contents::{Contents, is_first_side};
use super::line::Line;
use crate::geometry::sampling::hash;
use crate::geometry::{Aabb, Facet};
use crate::hierarchy::{Hierarchy, NodeId};
use crate::scene::{Scene, SurfaceId};
use crate::visibility::Segment;

/// A cluster of fewer surfaces is opened sooner than looked up.
const FEWEST_SURFACES: usize = 256;

/// Where so many boxes are met, rays cost less, and answer.
const MOST_STEPS: u32 = 96;

/// What maps are made with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MapOptions {
    /// How finely they know lines.
    pub resolution: MapResolution,
    /// Bytes that all maps may take once they are complete. The largest clusters come first.
    pub memory_bytes: u64,
    /// Of their random numbers.
    pub seed: u64,
}

impl Default for MapOptions {
    fn default() -> Self {
        Self { resolution: MapResolution::default(), memory_bytes: 256 << 20, seed: 0 }
    }
}

/// The maps of the clusters of a hierarchy.
pub struct Maps<'a> {
    pub(super) scene: &'a Scene,
    contents: Contents,
    /// By cluster.
    maps: Vec<Option<ClusterMap>>,
    is_empty: bool,
    seed: u64,
    beams: AtomicU64,
    answered: AtomicU64,
    refused: AtomicU64,
}

impl<'a> Maps<'a> {
    /// Maps for the clusters of small surfaces, as many as fit into the memory; none is filled yet.
    ///
    /// O(n). The hierarchy may grow later, as elements are split.
    pub fn new(scene: &'a Scene, hierarchy: &Hierarchy, options: &MapOptions) -> Self {
        let contents = Contents::of(scene, hierarchy);
        let resolution = options.resolution;
        let mut left = options.memory_bytes / ClusterMap::bytes(resolution);
        let map_of = |cluster: NodeId| {
            let (bounds, patch) = (hierarchy.bounds(cluster), contents.patch(cluster));
            let is_fine = contents.largest(cluster).sqrt() <= grain_of(0.5 * bounds.extent(), resolution);
            let is_dense = contents.count(cluster) >= FEWEST_SURFACES && is_fine;
            (is_dense && left > 0).then(|| {
                left -= 1;
                ClusterMap::new(bounds, patch, resolution)
            })
        };
        let maps: Vec<_> = hierarchy.ids().take(hierarchy.cluster_count()).map(map_of).collect();
        let is_empty = maps.iter().all(Option::is_none);
        let [beams, answered, refused] = [0; 3].map(AtomicU64::new);
        Self { scene, contents, maps, is_empty, seed: options.seed, beams, answered, refused }
    }

    /// The part of the light that passes along each segment between two nodes, 0 to 1, and an estimate of the standard error of their mean.
    /// Segments are independent samples of the lines between the nodes, at least one, from the first to the second.
    ///
    /// Nothing, if maps would add more than `tolerance` to that error, or if rays take less time. What lines differ by adds to it too, as it
    /// does with rays along them.
    pub fn estimate(
        &self,
        hierarchy: &Hierarchy,
        [receiver, source]: [NodeId; 2],
        segments: &[Segment],
        tolerance: f64,
    ) -> Option<(Vec<f64>, f64)> {
        if self.is_empty {
            return None;
        }
        let direction = hierarchy.direction(receiver, source);
        let widths = [receiver, source].map(|node| width(hierarchy, node, direction));
        let lines = segments.iter().map(Traveller::along).collect();
        let mut packet = Packet { maps: self, hierarchy, widths, lines, variance: 0.0 };
        let is_answered = packet.follow(tolerance * tolerance);
        let count = if is_answered { &self.answered } else { &self.refused };
        count.fetch_add(segments.len() as u64, Ordering::Relaxed);
        is_answered.then(|| {
            let passed: Vec<f64> = packet.lines.iter().map(|line| line.passed).collect();
            let error = (packet.variance + variance_of_mean(&passed)).sqrt();
            (passed, error)
        })
    }

    /// What a cluster blocks of the lines about one, by its map.
    pub(super) fn part(&self, hierarchy: &Hierarchy, cluster: NodeId, map: &ClusterMap, line: &Line, level: u32) -> Part {
        map.part(line, level, |place| {
            self.beams.fetch_add(1, Ordering::Relaxed);
            map.beam(&self.contents, hierarchy, cluster, place, hash(self.seed, u64::from(cluster.0)))
        })
    }

    /// The map of a cluster, if it has one.
    pub(super) fn map_of(&self, cluster: NodeId) -> Option<&ClusterMap> {
        self.maps[cluster.index()].as_ref()
    }

    /// Whether no cluster has a map: then nothing is ever answered.
    pub fn is_empty(&self) -> bool {
        self.is_empty
    }

    /// Segments that were answered so far.
    pub fn answered(&self) -> u64 {
        self.answered.load(Ordering::Relaxed)
    }

    /// Segments that were left to rays so far.
    pub fn refused(&self) -> u64 {
        self.refused.load(Ordering::Relaxed)
    }

    /// Bytes of the memory that is taken by now.
    pub fn memory_bytes(&self) -> u64 {
        let maps = self.maps.iter().flatten().map(ClusterMap::empty_bytes).sum::<u64>();
        let beams = self.maps.iter().flatten().map(ClusterMap::bytes_of_beam).next().unwrap_or(0);
        self.contents.memory_bytes() + maps + self.beams.load(Ordering::Relaxed) * beams
    }
}

/// The lines between two nodes, a few of which stand for all, on their way down the clusters.
struct Packet<'a> {
    maps: &'a Maps<'a>,
    hierarchy: &'a Hierarchy,
    /// How wide the beam is at the receiver and at the source, in metres.
    widths: [f64; 2],
    lines: Vec<Traveller>,
    /// Of the mean of what passes.
    variance: f64,
}

/// One of the lines.
pub(super) struct Traveller {
    segment: Segment,
    from: DVec3,
    to: DVec3,
    /// One over the way from end to end.
    inverse: DVec3,
    pub line: Line,
    /// What passes of it, so far.
    passed: f64,
}

impl Packet<'_> {
    /// Follows the lines; `false` if the variance would be more than `allowed`, or if rays are cheaper.
    fn follow(&mut self, allowed: f64) -> bool {
        let (mut waiting, mut steps) = (vec![NodeId::ROOT], 0);
        let mut met = Vec::with_capacity(self.lines.len());
        while let Some(node) = waiting.pop() {
            if !self.hierarchy.is_cluster(node) {
                self.block(node);
                continue;
            }
            steps += 1;
            if steps > MOST_STEPS {
                return false;
            }

            // The lines that meet its box, and where.
            let bounds = self.hierarchy.bounds(node);
            met.clear();
            met.extend(self.lines.iter().enumerate().filter(|(_, line)| line.passed > 0.0).filter_map(|(index, line)| {
                let [enters, leaves] = line.part_in_box(bounds)?;
                Some(Meeting { index, enters, leaves, blocked: 0.0 })
            }));
            if met.is_empty() {
                continue;
            }
            match self.whole(node, &mut met) {
                Some(whole) if self.variance + whole.variance <= allowed => {
                    self.variance += whole.variance;
                    met.iter().for_each(|meeting| self.lines[meeting.index].passed *= 1.0 - meeting.blocked);
                }
                Some(whole) if self.variance + whole.variance_of_patches > allowed => return false,
                _ => waiting.extend(self.hierarchy.children(node)),
            }
        }
        true
    }

    /// A cluster as its map tells what it blocks of the lines about those that meet it, which is written there. Nothing if it has no map, or
    /// holds an end of a line.
    fn whole(&self, cluster: NodeId, met: &mut [Meeting]) -> Option<Whole> {
        let map = self.maps.map_of(cluster)?;
        if met.iter().any(|meeting| meeting.enters <= 0.0 || meeting.leaves >= 1.0) {
            return None;
        }

        // Each line stands for its part of the beam's section here.
        let (count, all) = (met.len() as f64, self.lines.len() as f64);
        let middle = met.iter().map(|meeting| 0.5 * (meeting.enters + meeting.leaves)).sum::<f64>() / count;
        let width = (1.0 - middle) * self.widths[0] + middle * self.widths[1];
        let patches = (map.patch / (width * width)).min(1.0);
        let level = (width / (map.grain * all.sqrt())).log2().max(0.0) as u32;
        // Cells blur the edges of a wide beam: grain / width of its section, where width / grain cells vary each on its own.
        let edges = (map.grain / width).powi(3).min(1.0);
        // Lines in one cell have its noise in common.
        let told_apart = all.min((width / map.pitch).powi(2)).max(1.0);
        let mut whole = Whole::default();
        for meeting in met {
            let line = &self.lines[meeting.index];
            let part = self.maps.part(self.hierarchy, cluster, map, &line.line, level);
            let of_patches = part.mean * (1.0 - part.mean) * patches;
            let within = edges * (part.range[1] - part.range[0]).powi(2) / 12.0;
            let surely_some = (part.mean * part.samples + 1.0) / (part.samples + 2.0);
            let unproved = part.proved[1] - part.proved[0];
            let noise = unproved * surely_some * (1.0 - surely_some) / (part.samples * told_apart);
            let weight = line.passed * line.passed / all;
            whole.variance += weight * (of_patches + within + noise);
            whole.variance_of_patches += weight * of_patches;
            meeting.blocked = part.mean;
        }
        Some(whole)
    }

    /// Takes away the lines that a surface blocks, by the contract of [`visibility`](crate::visibility).
    fn block(&mut self, node: NodeId) {
        let Some(blocker) = Blocker::of(self.maps.scene, self.hierarchy, node) else { return };
        for line in self.lines.iter_mut().filter(|line| line.passed > 0.0 && blocker.blocks(line)) {
            line.passed = 0.0;
        }
    }
}

/// A surface that may be in the way.
pub(super) struct Blocker<'a> {
    facet: Facet<'a>,
    plane: u32,
}

impl<'a> Blocker<'a> {
    /// Nothing for the second side of a sheet, whose first is in the way already.
    pub fn of(scene: &Scene, hierarchy: &'a Hierarchy, node: NodeId) -> Option<Self> {
        let plane = scene.surface(SurfaceId(hierarchy.node(node).surface)).plane;
        is_first_side(scene, hierarchy, node).then(|| Self { facet: hierarchy.facet(node), plane })
    }

    /// Whether it blocks a line between its ends.
    pub fn blocks(&self, line: &Traveller) -> bool {
        let (above, below) = (self.facet.height(line.from), self.facet.height(line.to));
        above * below < 0.0
            && self.plane != line.segment.from_plane
            && self.plane != line.segment.to_plane
            && self.facet.contains(line.from + above / (above - below) * (line.to - line.from))
    }
}

impl Traveller {
    pub fn along(segment: &Segment) -> Self {
        let (from, to) = (DVec3::from(segment.from), DVec3::from(segment.to));
        Self { segment: *segment, from, to, inverse: (to - from).recip(), line: Line::through(from, to), passed: 1.0 }
    }

    /// The part of the segment in a box, from 0 at its start to 1 at its end; nothing if it passes beside.
    pub fn part_in_box(&self, bounds: &Aabb) -> Option<[f64; 2]> {
        let (a, b) = ((bounds.min - self.from) * self.inverse, (bounds.max - self.from) * self.inverse);
        // A segment along a side of the box has 0 times infinity there, which min and max leave out.
        let (enters, leaves) = (a.min(b).max_element(), a.max(b).min_element());
        (enters <= leaves && leaves >= 0.0 && enters <= 1.0).then_some([enters, leaves])
    }
}

/// Where a line passes a cluster, as parts of its way, and what the cluster blocks of the lines about it.
struct Meeting {
    index: usize,
    enters: f64,
    leaves: f64,
    blocked: f64,
}

/// The variance of what passes in the mean that comes from taking a cluster as a whole.
#[derive(Default)]
struct Whole {
    variance: f64,
    /// The part of it that no finer map lessens.
    variance_of_patches: f64,
}

/// The variance of the mean of independent samples, by what they differ by; 0 of a single one, which tells nothing.
fn variance_of_mean(samples: &[f64]) -> f64 {
    let count = samples.len() as f64;
    let mean = samples.iter().sum::<f64>() / count;
    samples.iter().map(|sample| (sample - mean).powi(2)).sum::<f64>() / (count * (count - 1.0)).max(1.0)
}

/// How wide a node looks in a direction, in metres: the side of a square as large as what it shows.
fn width(hierarchy: &Hierarchy, node: NodeId, direction: DVec3) -> f64 {
    if hierarchy.is_cluster(node) {
        let size = hierarchy.bounds(node).extent();
        let shown = DVec3::new(size.y * size.z, size.z * size.x, size.x * size.y).dot(direction.abs());
        shown.sqrt()
    } else {
        (hierarchy.area(node) * hierarchy.normal(node).dot(direction).abs()).sqrt()
    }
}
