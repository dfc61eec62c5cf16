//! How much light bends along the edges of elements, which says where these are halved: across a shadow, while edges along it stay long (greedy bisection
//! of anisotropic elements: Cohen, Dyn, Hecht, Mirebeau 2012).
//!
//! An edge bends by its hierarchical surplus: what the light in its middle differs by from the mean of its ends. An edge is known by the node in its middle.

use glam::DVec2;

/// A difference is one of the light if its square is so many times its variance.
pub(super) const SIGNIFICANT: f64 = 4.0;

/// Triangles that are this many times longer than high, or more, are halved at their longest edge, however light bends: bends of flat ones would make
/// them flatter. Above 1.
const MOST_ELONGATED: f64 = 8.0;

/// Edges of a triangle that bend by this part of what most does are as good to halve. Above 0, at most 1: with 1 the neighbours of a triangle would be
/// halved elsewhere before it, and theirs before them.
const NEARLY: f64 = 0.5;

/// What the light in the middle of an edge differs by from the mean of its ends, channels added, in W/m^2; and the variance of that.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Bend {
    pub surplus: f64,
    pub variance: f64,
}

/// Bends by node.
#[derive(Clone, Debug, Default)]
pub(super) struct Bends(Vec<Bend>);

impl Bends {
    /// What is known of all edges.
    pub fn new(of_nodes: Vec<Bend>) -> Self {
        Self(of_nodes)
    }

    /// Nothing is known: edges count by their lengths alone.
    pub fn unknown() -> Self {
        Self::default()
    }

    /// Whether anything is known.
    pub fn are_known(&self) -> bool {
        !self.0.is_empty()
    }

    /// The edge of a triangle that is halved; of two alike the one whose middle has the lower number, which is the same seen from both sides.
    pub fn edge_to_halve(&self, corners: [DVec2; 3], middles: [u32; 3]) -> usize {
        let scores = self.scores(corners, middles);
        let better = |a: usize, b: usize| {
            let order = scores[a].total_cmp(&scores[b]).then_with(|| middles[b].cmp(&middles[a]));
            if order.is_ge() { a } else { b }
        };
        better(better(0, 1), 2)
    }

    /// Whether a triangle may be halved at the edge with this middle, since a neighbour is.
    pub fn may_halve(&self, corners: [DVec2; 3], middles: [u32; 3], middle: u32) -> bool {
        let scores = self.scores(corners, middles);
        let least = if self.are_known() { NEARLY * scores.into_iter().fold(0.0, f64::max) } else { f64::INFINITY };
        let is_it = |edge: usize| middles[edge] == middle;
        is_it(self.edge_to_halve(corners, middles)) || (0..3).any(|edge| is_it(edge) && scores[edge] >= least)
    }

    /// How much halving each edge is worth.
    ///
    /// Bends that are clearly more than noise count; else edges count as if light bent alike in all directions, with the square of their length. Across a
    /// jump both halves of an edge bend as it does, so that of two which cross it the longer one counts more.
    fn scores(&self, corners: [DVec2; 3], middles: [u32; 3]) -> [f64; 3] {
        let lengths = [0, 1, 2].map(|edge| corners[edge].distance(corners[(edge + 1) % 3]));
        if !self.are_known() {
            return lengths;
        }
        let longest = lengths.into_iter().fold(0.0, f64::max);
        let height = (corners[1] - corners[0]).perp_dot(corners[2] - corners[0]).abs() / longest;
        if MOST_ELONGATED * height <= longest {
            return lengths.map(|length| if length == longest { 1.0 } else { 0.0 });
        }
        let bends = middles.map(|middle| self.0[middle as usize]);
        let noise_sq = bends.iter().map(|bend| bend.variance).sum::<f64>() / 3.0 + f64::MIN_POSITIVE;
        [0, 1, 2].map(|edge| {
            let (length, Bend { surplus, variance }) = (lengths[edge] / longest, bends[edge]);
            length * ((surplus * surplus - SIGNIFICANT * variance).max(0.0) + length.powi(4) * noise_sq).sqrt()
        })
    }

    /// Foretells the bends of new edges where a triangle is halved, as a quadratic function has them: of the halves of its edge with the middle `ab`, and of
    /// the edge from there to the corner opposite. The others are `bc` and `ca`.
    pub fn halve(&mut self, [ab, bc, ca]: [u32; 3], halves: [u32; 2], across: u32) {
        if !self.are_known() {
            return;
        }
        let most = halves.into_iter().fold(across, u32::max) as usize;
        self.0.resize(self.0.len().max(most + 1), Bend::default());
        let [ab, bc, ca] = [ab, bc, ca].map(|middle| self.0[middle as usize]);
        let quarter = Bend { surplus: 0.25 * ab.surplus, variance: ab.variance / 16.0 };
        halves.iter().for_each(|&half| self.0[half as usize] = quarter);

        // A surplus is a quadratic form of the edge; by the parallelogram law of a median.
        self.0[across as usize] = Bend {
            surplus: 0.25 * (2.0 * (bc.surplus + ca.surplus) - ab.surplus),
            variance: (4.0 * (bc.variance + ca.variance) + ab.variance) / 16.0,
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CORNERS: [DVec2; 3] = [DVec2::ZERO, DVec2::new(2.0, 0.0), DVec2::new(0.0, 1.0)];

    fn bends(surpluses: [f64; 3], variance: f64) -> Bends {
        Bends::new(surpluses.map(|surplus| Bend { surplus, variance }).to_vec())
    }

    #[test]
    fn the_edge_that_bends_most_is_halved_and_without_bends_the_longest() {
        let halved = |bends: Bends| bends.edge_to_halve(CORNERS, [0, 1, 2]);
        assert_eq!(halved(Bends::unknown()), 1);
        assert_eq!(halved(bends([0.01, 0.1, 0.5], 0.0)), 2);
        assert_eq!(halved(bends([0.5, 0.1, 0.5], 0.0)), 0);
        // Noise says nothing.
        assert_eq!(halved(bends([0.01, 0.02, 0.19], 0.01)), 1);
        assert_eq!(halved(bends([0.0; 3], 0.0)), 1);

        // Much longer than high already.
        let thin = [DVec2::ZERO, DVec2::new(1.0, 0.0), DVec2::new(0.4, 0.1)];
        assert_eq!(bends([0.0, 1.0, 1.0], 0.0).edge_to_halve(thin, [0, 1, 2]), 0);
    }

    #[test]
    fn bends_of_quadratic_functions_are_foretold() {
        let function = |at: DVec2| 0.3 + at.x - 2.0 * at.y + 0.7 * at.x * at.x - 1.3 * at.x * at.y + 0.2 * at.y * at.y;
        let surplus = |a: DVec2, b: DVec2| function(0.5 * (a + b)) - 0.5 * (function(a) + function(b));
        let [a, b, c] = CORNERS;
        let mut bends = bends([surplus(a, b), surplus(b, c), surplus(c, a)], 0.0);
        bends.halve([0, 1, 2], [3, 4], 5);
        let middle = 0.5 * (a + b);
        for (node, expected) in [(3, surplus(a, middle)), (4, surplus(middle, b)), (5, surplus(middle, c))] {
            assert!((bends.0[node].surplus - expected).abs() < 1e-12, "{node}");
        }
    }
}
