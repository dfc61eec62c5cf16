//! The hierarchy: clusters are axis-aligned boxes of segments, each with two clusters in it, down to single segments.
//!
//! Soler and Sillion 1996, section 8, with binary clusters since chi is known of two alone (section 5). A box is halved at the median along
//! its longer side. What a cluster lets through is stored with it, once for all pairs of segments that light passes between (section 7).

use glam::DVec2;

use super::segment::Segment;
use super::transmittance::DirectionalTransmittance;

/// The fewest and the most directions of stored functions.
const DIRECTIONS: [usize; 2] = [4, 4096];

/// A cluster of a hierarchy.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ClusterId(u32);

/// Clusters of segments in a binary tree.
#[derive(Clone, Debug)]
pub struct Hierarchy {
    clusters: Vec<Cluster>,
}

/// A box and what is in it.
#[derive(Clone, Debug)]
struct Cluster {
    low: DVec2,
    high: DVec2,
    contents: Contents,
}

/// What is in a cluster.
#[derive(Clone, Debug)]
enum Contents {
    One(Segment),
    Two([ClusterId; 2], DirectionalTransmittance),
}

impl Hierarchy {
    /// The hierarchy over segments, with stored functions at so many directions within pi: 4 to 4096, others are taken as the nearest of these.
    ///
    /// Time grows with their square, memory in proportion.
    pub fn of(segments: &[Segment], directions: usize) -> Self {
        let mut hierarchy = Self { clusters: Vec::new() };
        if !segments.is_empty() {
            hierarchy.add(&mut segments.to_vec(), directions.clamp(DIRECTIONS[0], DIRECTIONS[1]));
        }
        hierarchy
    }

    /// Adds the cluster of these segments, after all that are in it.
    fn add(&mut self, segments: &mut [Segment], directions: usize) -> ClusterId {
        let corners = segments.iter().flat_map(Segment::points);
        let (low, high) =
            corners.fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), corner| (low.min(corner), high.max(corner)));
        let contents = if let [only] = segments {
            Contents::One(*only)
        } else {
            let middle = 0.5 * (low + high);
            let ends: Vec<[DVec2; 2]> = segments.iter().map(|segment| segment.points().map(|end| end - middle)).collect();
            let stored = DirectionalTransmittance::of(&ends, 0.5 * (high - low), directions);
            let axis = usize::from((high - low).y > (high - low).x);
            let place = |segment: &Segment| segment.points().iter().map(|end| end[axis]).sum::<f64>();
            segments.sort_by(|a, b| place(a).total_cmp(&place(b)));
            let (first, second) = segments.split_at_mut(segments.len() / 2);
            Contents::Two([self.add(first, directions), self.add(second, directions)], stored)
        };
        self.clusters.push(Cluster { low, high, contents });
        ClusterId(self.clusters.len() as u32 - 1)
    }

    /// The cluster of all segments. Nothing, if there are none.
    pub fn root(&self) -> Option<ClusterId> {
        self.clusters.len().checked_sub(1).map(|last| ClusterId(last as u32))
    }

    /// How many clusters there are, single segments too.
    pub fn clusters(&self) -> usize {
        self.clusters.len()
    }

    /// The two clusters in a cluster. Nothing, if it is a segment.
    pub fn children(&self, cluster: ClusterId) -> Option<[ClusterId; 2]> {
        match self.cluster(cluster).contents {
            Contents::One(_) => None,
            Contents::Two(children, _) => Some(children),
        }
    }

    /// The segment that a cluster without clusters is.
    pub fn segment(&self, cluster: ClusterId) -> Option<&Segment> {
        match &self.cluster(cluster).contents {
            Contents::One(segment) => Some(segment),
            Contents::Two(..) => None,
        }
    }

    /// The directional functions that are stored with a cluster; a segment has none.
    pub fn directional(&self, cluster: ClusterId) -> Option<&DirectionalTransmittance> {
        match &self.cluster(cluster).contents {
            Contents::One(_) => None,
            Contents::Two(_, stored) => Some(stored),
        }
    }

    /// Lower left and upper right corner of a cluster's box, x and y in metres.
    pub fn bounding_box(&self, cluster: ClusterId) -> [[f64; 2]; 2] {
        let Cluster { low, high, .. } = self.cluster(cluster);
        [(*low).into(), (*high).into()]
    }

    /// tau(rho, theta): 0 where a segment of the cluster meets the line `x cos theta + y sin theta = rho`, else 1.
    ///
    /// Here rho is in metres from the middle of the cluster's box.
    pub fn transmittance(&self, cluster: ClusterId, rho: f64, theta: f64) -> f64 {
        let Cluster { low, high, .. } = self.cluster(cluster);
        let normal = DVec2::from_angle(theta);
        let rho = rho + normal.dot(0.5 * (*low + *high));
        if self.meets(cluster, rho, normal) { 0.0 } else { 1.0 }
    }

    /// Whether a line meets a segment of a cluster.
    fn meets(&self, cluster: ClusterId, rho: f64, normal: DVec2) -> bool {
        let meets = |corners: &[DVec2]| {
            let is_below = |corner: &&DVec2| corner.dot(normal) < rho;
            let below = corners.iter().filter(is_below).count();
            below > 0 && below < corners.len()
        };
        match &self.cluster(cluster).contents {
            Contents::One(segment) => meets(&segment.points()),
            Contents::Two(children, _) => {
                meets(&self.corners(cluster)) && children.iter().any(|&child| self.meets(child, rho, normal))
            }
        }
    }

    /// The corners of a cluster's box, or the ends of its segment.
    pub(super) fn corners(&self, cluster: ClusterId) -> Vec<DVec2> {
        let Cluster { low, high, contents } = self.cluster(cluster);
        match contents {
            Contents::One(segment) => segment.points().into(),
            Contents::Two(..) => [*low, DVec2::new(high.x, low.y), *high, DVec2::new(low.x, high.y)].into(),
        }
    }

    fn cluster(&self, ClusterId(index): ClusterId) -> &Cluster {
        &self.clusters[index as usize]
    }
}
