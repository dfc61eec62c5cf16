//! What finding discontinuities took and gave.

use std::ops::AddAssign;

/// Counts, after table 4.4 of the thesis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Sides of sources, once where pieces of a source meet.
    pub source_edges: u64,
    /// Edges of the scene that can be silhouettes, welded.
    pub edges: u64,
    /// Corners of the scene that can be corners of outlines, welded.
    pub corners: u64,
    /// Pairs of source and receiver of which the source brings no more than the receiver's tolerance.
    pub weak_pairs: u64,
    /// Pairs of source and edge or corner beyond which the source brings nothing, or no more than every receiver tolerates.
    pub weak_edges: u64,
    /// Pairs of source and edge or corner that were left because there are too many of more effect.
    pub unfollowed_edges: u64,
    /// Wedges that were followed into the scene.
    pub wedges: u64,
    /// Of these: so many are hidden before they reach the edge or the corner that casts the shadow.
    pub hidden_wedges: u64,
    /// Of these: followed only as far as what is hidden by the edge or the corner matters.
    pub short_wedges: u64,
    /// Segments that wedges and contacts left on receivers, before they were welded.
    pub found: u64,
    /// Of these: shorter than what counts as touching.
    pub too_short: u64,
    /// Of these: along the border of their receiver, where nothing has to be told apart.
    pub on_borders: u64,
    /// Welded segments whose sources cannot change the irradiance by more than the receiver's tolerance, all that were left out there together.
    pub left_out: u64,
    /// Welded segments across which irradiance itself jumps.
    pub d0: u64,
    /// Its first derivative jumps.
    pub d1: u64,
    /// Its second derivative jumps.
    pub d2: u64,
    /// The most welded segments of a surface.
    pub most_per_surface: u64,
}

impl Counters {
    /// Welded segments of all surfaces.
    pub fn segments(&self) -> u64 {
        self.d0 + self.d1 + self.d2
    }

    /// How many segments a surface could have at worst: each pair of a source edge and an edge, from either.
    pub fn worst_case_per_surface(&self) -> u64 {
        2 * self.source_edges * self.edges
    }
}

impl AddAssign for Counters {
    fn add_assign(&mut self, other: Self) {
        self.source_edges += other.source_edges;
        self.edges += other.edges;
        self.corners += other.corners;
        self.weak_pairs += other.weak_pairs;
        self.weak_edges += other.weak_edges;
        self.unfollowed_edges += other.unfollowed_edges;
        self.wedges += other.wedges;
        self.short_wedges += other.short_wedges;
        self.hidden_wedges += other.hidden_wedges;
        self.found += other.found;
        self.too_short += other.too_short;
        self.on_borders += other.on_borders;
        self.left_out += other.left_out;
        self.d0 += other.d0;
        self.d1 += other.d1;
        self.d2 += other.d2;
        self.most_per_surface = self.most_per_surface.max(other.most_per_surface);
    }
}
