//! Triangles of quadratic elements, refined by bisection of the edges along which light bends most, or of the longest where that is not known.
//!
//! To bisect a triangle, the path of ever better edges is followed to an edge that is good for both its triangles; these two are halved, until the
//! triangle itself was (Rivara 1997). No node ever hangs on an edge; by longest edges, no angle becomes smaller than half of the smallest at first. Six
//! nodes belong to a triangle, its corners and the middles of its edges, so bisection makes corners of middles: what was found there stays.

use glam::DVec2;

use super::bends::Bends;

/// No triangle is there.
pub(super) const NONE: u32 = u32::MAX;

/// A triangle, counter-clockwise.
#[derive(Clone, Copy, Debug)]
pub(super) struct Triangle {
    /// Numbers of nodes.
    pub corners: [u32; 3],
    /// The middle of the edge from each corner to the next.
    pub middles: [u32; 3],
    /// The triangle beyond that edge.
    pub neighbours: [u32; 3],
}

impl Triangle {
    /// All nodes: corners, then middles.
    pub fn nodes(&self) -> [u32; 6] {
        let ([a, b, c], [ab, bc, ca]) = (self.corners, self.middles);
        [a, b, c, ab, bc, ca]
    }
}

/// A node.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    pub at: DVec2,
    /// Where its value is taken: at borders a little inside, where it is known on which side of an edge or a step that is.
    pub sampled_at: DVec2,
}

/// The square of an edge is at most so many times the largest area: along a narrow strip light changes as it does on what is wider.
const MOST_STRETCHED: f64 = 4.0;

/// Triangles that are halved first so that one may be, at most, where bends are known: by these a path may come back to where it was.
const MOST_BEFORE: usize = 16;

/// How far inside, as a part of the way to the centroid of the triangle: this, or more where that would be too near; never beyond half of it.
const INSIDE: f64 = 1e-3;
const MOST_INSIDE: f64 = 0.5;

/// A triangle that was halved.
#[derive(Clone, Copy, Debug)]
pub(super) struct Halving {
    /// The half that has its number, to the left of the cut; and the other.
    pub halves: [u32; 2],
    /// From where to where it was cut.
    pub cut: [DVec2; 2],
}

/// Triangles that fit together.
#[derive(Clone, Debug, Default)]
pub(super) struct Triangles {
    pub nodes: Vec<Node>,
    pub triangles: Vec<Triangle>,
    /// What was halved since someone asked, in that order.
    pub halvings: Vec<Halving>,
    /// Light at a border is taken so far inside at least, in metres, where triangles are wide enough.
    clearance: f64,
}

/// Where a border node is taken.
#[derive(Clone, Copy)]
struct Inside {
    /// In the middle of its triangles, in metres.
    towards: DVec2,
    /// The distance of that from the border, at least.
    depth: f64,
}

impl Inside {
    /// The centroid of a triangle, and its distance from the nearest edge: a third of the height over the longest.
    fn of(corners: [DVec2; 3]) -> Self {
        let [a, b, c] = corners;
        let longest_sq = a.distance_squared(b).max(b.distance_squared(c)).max(c.distance_squared(a));
        Self { towards: corners.iter().sum::<DVec2>() / 3.0, depth: (b - a).perp_dot(c - a) / (3.0 * longest_sq.sqrt()) }
    }
}

impl Triangles {
    /// Triangles with these vertices as corners, and neighbours beyond the edges from each. Triangles share nodes where they are joined by
    /// neighbours.
    pub fn new(corners: &[[u32; 3]], neighbours: &[[u32; 3]], at: impl Fn(u32) -> DVec2, clearance: f64) -> Self {
        let mut all = Self { clearance, ..Self::default() };
        let unknown = Triangle { corners: [NONE; 3], middles: [NONE; 3], neighbours: [NONE; 3] };
        all.triangles = neighbours.iter().map(|&neighbours| Triangle { neighbours, ..unknown }).collect();
        let inside = |triangle: usize| Inside::of(corners[triangle].map(&at));
        let edge_back = |triangle: usize, from: usize| neighbours[triangle].iter().position(|&other| other as usize == from);
        for triangle in 0..corners.len() {
            for corner in 0..3 {
                // A node at each corner, for all triangles around it.
                if all.triangles[triangle].corners[corner] == NONE {
                    let vertex = corners[triangle][corner];
                    let around = Self::around(corners, neighbours, triangle, vertex);
                    let is_border = around.iter().any(|&(triangle, corner)| {
                        neighbours[triangle][corner] == NONE || neighbours[triangle][(corner + 2) % 3] == NONE
                    });
                    let of_each = || around.iter().map(|&(triangle, _)| inside(triangle));
                    let towards = of_each().map(|inside| inside.towards).sum::<DVec2>() / around.len() as f64;
                    let depth = of_each().map(|inside| inside.depth).fold(f64::INFINITY, f64::min);
                    let node = all.add_node(at(vertex), is_border.then_some(Inside { towards, depth }));
                    around.iter().for_each(|&(triangle, corner)| all.triangles[triangle].corners[corner] = node);
                }
                // A node in the middle of each edge, for both of its triangles.
                if all.triangles[triangle].middles[corner] == NONE {
                    let middle = 0.5 * (at(corners[triangle][corner]) + at(corners[triangle][(corner + 1) % 3]));
                    let beyond = neighbours[triangle][corner];
                    let node = all.add_node(middle, (beyond == NONE).then(|| inside(triangle)));
                    all.triangles[triangle].middles[corner] = node;
                    if beyond != NONE
                        && let Some(edge) = edge_back(beyond as usize, triangle)
                    {
                        all.triangles[beyond as usize].middles[edge] = node;
                    }
                }
            }
        }
        all
    }

    /// The triangles around a vertex that are joined with `first`, and the number of the corner in each.
    fn around(corners: &[[u32; 3]], neighbours: &[[u32; 3]], first: usize, vertex: u32) -> Vec<(usize, usize)> {
        let corner_of = |triangle: usize| corners[triangle].iter().position(|&other| other == vertex);
        let mut found: Vec<(usize, usize)> = corner_of(first).map(|corner| (first, corner)).into_iter().collect();
        let mut next = 0;
        while let Some(&(triangle, corner)) = found.get(next) {
            for beyond in [neighbours[triangle][corner], neighbours[triangle][(corner + 2) % 3]] {
                let is_new = beyond != NONE && found.iter().all(|&(known, _)| known != beyond as usize);
                if is_new && let Some(corner) = corner_of(beyond as usize) {
                    found.push((beyond as usize, corner));
                }
            }
            next += 1;
        }
        found
    }

    /// Adds a node, sampled a little inside where it lies at a border.
    fn add_node(&mut self, at: DVec2, inside: Option<Inside>) -> u32 {
        let clearance = self.clearance;
        let part = |depth: f64| if clearance > INSIDE * depth { (clearance / depth).min(MOST_INSIDE) } else { INSIDE };
        let sampled_at = inside.map_or(at, |Inside { towards, depth }| at.lerp(towards, part(depth)));
        self.nodes.push(Node { at, sampled_at });
        self.nodes.len() as u32 - 1
    }

    /// The corners of a triangle.
    pub fn corners(&self, triangle: u32) -> [DVec2; 3] {
        self.triangles[triangle as usize].corners.map(|node| self.nodes[node as usize].at)
    }

    /// The area of a triangle in m^2.
    pub fn area(&self, triangle: u32) -> f64 {
        let [a, b, c] = self.corners(triangle);
        0.5 * (b - a).perp_dot(c - a)
    }

    /// Whether a triangle is larger than so many m^2, or much longer than what is.
    pub fn is_large(&self, triangle: u32, largest: f64) -> bool {
        let [a, b, c] = self.corners(triangle);
        let longest_sq = a.distance_squared(b).max(b.distance_squared(c)).max(c.distance_squared(a));
        self.area(triangle) > largest || longest_sq > MOST_STRETCHED * largest
    }

    /// Halves a triangle, and others first where that is needed. Halves take the place of a triangle, and the next number.
    pub fn bisect(&mut self, triangle: u32, bends: &mut Bends) {
        let mut path = vec![triangle];
        while let Some(&last) = path.last() {
            let Triangle { middles, neighbours, .. } = self.triangles[last as usize];
            let edge = bends.edge_to_halve(self.corners(last), middles);
            let beyond = neighbours[edge];
            let is_long = bends.are_known() && path.len() > MOST_BEFORE;
            let may_halve =
                |beyond: u32| bends.may_halve(self.corners(beyond), self.triangles[beyond as usize].middles, middles[edge]);
            if beyond == NONE || is_long || may_halve(beyond) {
                self.split(last, edge, bends);
                path.pop();
            } else {
                path.push(beyond);
            }
        }
    }

    /// Halves the two triangles at an edge.
    fn split(&mut self, triangle: u32, edge: usize, bends: &mut Bends) {
        let Triangle { corners, middles, neighbours } = self.triangles[triangle as usize];
        let beyond = neighbours[edge];
        let [a, b] = [corners[edge], corners[(edge + 1) % 3]].map(|node| self.nodes[node as usize].at);
        let middle = self.nodes[middles[edge] as usize].at;
        let inside = (beyond == NONE).then(|| Inside::of(self.corners(triangle)));
        let quarters = [a, b].map(|corner| self.add_node(0.5 * (corner + middle), inside));
        let second = self.halve(triangle, edge, quarters, bends);
        if beyond == NONE {
            return;
        }
        let Some(back) = self.triangles[beyond as usize].middles.iter().position(|&other| other == middles[edge]) else { return };
        let opposite = self.halve(beyond, back, [quarters[1], quarters[0]], bends);
        for (a, b) in [(triangle, opposite), (beyond, second)] {
            self.triangles[a as usize].neighbours[0] = b;
            self.triangles[b as usize].neighbours[0] = a;
        }
    }

    /// Halves one triangle at an edge, given the middles of its halves; returns the second half.
    fn halve(&mut self, triangle: u32, edge: usize, quarters: [u32; 2], bends: &mut Bends) -> u32 {
        let Triangle { corners, middles, neighbours } = self.triangles[triangle as usize];
        let turned = |of: [u32; 3]| [of[edge], of[(edge + 1) % 3], of[(edge + 2) % 3]];
        let ([a, b, c], [ab, bc, ca], [_, beyond_bc, beyond_ca]) = (turned(corners), turned(middles), turned(neighbours));
        let cut = [ab, c].map(|node| self.nodes[node as usize].at);
        let across = self.add_node(0.5 * (cut[0] + cut[1]), None);
        bends.halve([ab, bc, ca], quarters, across);
        let second = self.triangles.len() as u32;
        self.halvings.push(Halving { halves: [triangle, second], cut });
        self.triangles[triangle as usize] =
            Triangle { corners: [a, ab, c], middles: [quarters[0], across, ca], neighbours: [NONE, second, beyond_ca] };
        self.triangles.push(Triangle {
            corners: [ab, b, c],
            middles: [quarters[1], bc, across],
            neighbours: [NONE, beyond_bc, triangle],
        });
        if beyond_bc != NONE {
            let beyond = &mut self.triangles[beyond_bc as usize];
            if let Some(back) = beyond.middles.iter().position(|&other| other == bc) {
                beyond.neighbours[back] = second;
            }
        }
        second
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::sampling;
    use crate::mesh::bends::Bend;

    /// A square of two triangles.
    fn square() -> Triangles {
        let at = |vertex: u32| DVec2::new(f64::from(vertex % 2), f64::from(vertex / 2));
        Triangles::new(&[[0, 1, 3], [0, 3, 2]], &[[NONE, NONE, 1], [0, NONE, NONE]], at, 0.0)
    }

    /// Halves triangles two thousand times at random, by bends or by lengths.
    fn bisected(mut bends: Bends) -> Triangles {
        let mut all = square();
        for step in 0..2000 {
            let draw = (sampling::unit(sampling::hash(step, 0)).powi(2) * all.triangles.len() as f64) as u32;
            all.bisect(draw, &mut bends);
        }
        all
    }

    #[test]
    fn bisection_leaves_no_hanging_node_and_no_gap() {
        let random = |number: u64| sampling::unit(sampling::hash(7, number)) - 0.5;
        let bends = Bends::new((0..9).map(|node| Bend { surplus: random(node), variance: 1e-3 * random(node).powi(2) }).collect());
        for all in [bisected(Bends::unknown()), bisected(bends)] {
            let area: f64 = (0..all.triangles.len() as u32).map(|triangle| all.area(triangle)).sum();
            assert!((area - 1.0).abs() < 1e-12, "{area}");
            for (number, triangle) in all.triangles.iter().enumerate() {
                let corners = all.corners(number as u32);
                for edge in 0..3 {
                    let next = (edge + 1) % 3;
                    assert_eq!(all.nodes[triangle.middles[edge] as usize].at, 0.5 * (corners[edge] + corners[next]));

                    // Neighbours share the two corners and the middle.
                    if triangle.neighbours[edge] == NONE {
                        let on_border = |at: DVec2| [at.x, at.y, 1.0 - at.x, 1.0 - at.y].contains(&0.0);
                        assert!(on_border(corners[edge]) && on_border(corners[next]));
                    } else {
                        let beyond = &all.triangles[triangle.neighbours[edge] as usize];
                        let back = beyond.middles.iter().position(|&other| other == triangle.middles[edge]).unwrap();
                        assert_eq!(beyond.neighbours[back], number as u32);
                        assert_eq!(
                            [beyond.corners[back], beyond.corners[(back + 1) % 3]],
                            [triangle.corners[next], triangle.corners[edge]]
                        );
                    }
                }
            }
        }
    }

    /// However light seems to bend, as by noise: files with flatter ones are refused.
    #[test]
    fn by_bends_no_triangle_becomes_flat() {
        for seed in 0..10 {
            let surplus = |node: u64| sampling::unit(sampling::hash(seed, node)) - 0.5;
            let bends = Bends::new((0..9).map(|node| Bend { surplus: surplus(node), variance: 0.0 }).collect());
            let all = bisected(bends);
            for number in 0..all.triangles.len() as u32 {
                let [a, b, c] = all.corners(number);
                let longest_sq = a.distance_squared(b).max(b.distance_squared(c)).max(c.distance_squared(a));
                assert!(2.0 * all.area(number) > longest_sq / 64.0, "seed {seed}: {a} {b} {c}");
            }
        }
    }

    #[test]
    fn by_longest_edges_no_triangle_becomes_thin() {
        let all = bisected(Bends::unknown());
        for number in 0..all.triangles.len() as u32 {
            // Half of the smallest angle at first, which is 45 degrees.
            let [a, b, c] = all.corners(number);
            let angle = |a: DVec2, b: DVec2, c: DVec2| (b - a).angle_to(c - a).abs().to_degrees();
            assert!(angle(a, b, c).min(angle(b, c, a)).min(angle(c, a, b)) > 22.4);
        }
    }

    #[test]
    fn nodes_at_a_border_keep_clear_of_it_where_there_is_room() {
        const CLEARANCE: f64 = 1e-3;
        for (height, least) in [(1.0, CLEARANCE), (0.02, CLEARANCE), (1e-3, 5e-5)] {
            let at = |vertex: u32| DVec2::new(f64::from(vertex % 2), height * f64::from(vertex / 2));
            let mut all = Triangles::new(&[[0, 1, 3], [0, 3, 2]], &[[NONE, NONE, 1], [0, NONE, NONE]], at, CLEARANCE);
            (0..4).for_each(|number| all.bisect(number, &mut Bends::unknown()));
            for node in &all.nodes {
                let [x, y] = node.sampled_at.to_array();
                let from_border = x.min(1.0 - x).min(y).min(height - y);
                assert!(from_border > 0.999 * least && from_border < height, "{} at {from_border} of {height}", node.at);
            }
        }
    }

    #[test]
    fn nodes_at_a_border_are_sampled_inside() {
        let mut all = square();
        (0..200).for_each(|step| all.bisect(step % all.triangles.len() as u32, &mut Bends::unknown()));
        for node in &all.nodes {
            let is_inside = |at: DVec2| at.min_element() > 0.0 && at.max_element() < 1.0;
            assert!(is_inside(node.sampled_at));
            assert_eq!(is_inside(node.at), node.sampled_at == node.at);
            assert!(node.sampled_at.distance(node.at) <= 2.0 * INSIDE);
        }
    }
}
