//! Subdivision along given segments, such as discontinuities: a BSP tree on each surface (Lischinski 1994, section 4.2, figure 4.3).
//!
//! An element that has segments is cut along the whole line of one of them, and the others are handed on to the parts that they lie on, cut as well where
//! they cross that line. Taken is, of the least rank, the one with the most even parts. An element without segments is cut into halves.
//!
//! **Strips.** Between two lines where a derivative of irradiance jumps it goes from one state to another: in a penumbra from shadow to light. Halves
//! across the longer side would leave all of that in every element until these are as short as the strip is wide; at the tip of a wedge, for ever. So
//! elements that are long and have such lines on both long sides are cut along and across in turn. This is not in the thesis.

use std::collections::BTreeMap;

use glam::DVec3;

use super::node_id::NodeId;
use crate::geometry::{Facet, cut_along, edges, halve};

/// A segment on a surface along which its elements are cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Cut {
    ends: [DVec3; 2],
    /// Across its line, in the plane of the surface; of a part that of the whole, which knows its line better.
    across: DVec3,
    /// Those of the least rank are taken first. Across those of rank 0 irradiance itself jumps, across others its derivatives.
    rank: u8,
}

impl Cut {
    /// A segment on a surface with this unit normal; `None` if it has no length.
    pub fn new(ends: [DVec3; 2], normal: DVec3, rank: u8) -> Option<Self> {
        let across = normal.cross(ends[1] - ends[0]).try_normalize()?;
        Some(Self { ends, across, rank })
    }

    /// Signed distance of a point of the surface from the line, in metres.
    fn height(&self, point: DVec3) -> f64 {
        self.across.dot(point - self.ends[0])
    }

    /// The parts of a segment on either side of this one's line. Nothing is left of what lies on the line, or is not longer than `tolerance`.
    fn divide(&self, other: &Self, tolerance: f64) -> [Option<Self>; 2] {
        let part = |ends: [DVec3; 2]| (ends[0].distance(ends[1]) > tolerance).then_some(Self { ends, ..*other });
        let [from, to] = other.ends;
        let [height_from, height_to] = other.ends.map(|end| self.height(end));
        let (low, high) = (height_from.min(height_to), height_from.max(height_to));
        if low >= -tolerance && high <= tolerance {
            [None, None]
        } else if low >= -tolerance {
            [part(other.ends), None]
        } else if high <= tolerance {
            [None, part(other.ends)]
        } else {
            let crossing = from + (to - from) * (height_from / (height_from - height_to));
            let (first, second) = (part([from, crossing]), part([crossing, to]));
            if height_from > 0.0 { [first, second] } else { [second, first] }
        }
    }
}

/// An element is long if it is so many times as long as wide: the same as in regular subdivision.
const LONG: f64 = 2.0;

/// The corners of the two parts of an element.
type Parts = [Vec<DVec3>; 2];

/// What is known of a leaf.
#[derive(Clone, Debug, Default, PartialEq)]
struct Lines {
    /// The segments that run through it.
    through: Vec<Cut>,
    /// Those that lie on its border, and across which derivatives jump.
    on_border: Vec<Cut>,
    /// Whether it was cut along last, not across.
    is_cut_along: bool,
}

/// The segments of all leaves that have some.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Cuts {
    of_leaves: BTreeMap<NodeId, Lines>,
    /// What is thinner, or nearer to each other, counts as one, in metres.
    tolerance: f64,
}

/// A leaf cut in two.
pub(super) struct Bisection {
    /// Their corners.
    pub parts: Parts,
    lines: [Lines; 2],
}

impl Cuts {
    pub fn new(of_leaves: impl IntoIterator<Item = (NodeId, Vec<Cut>)>, tolerance: f64) -> Self {
        let with_some = of_leaves.into_iter().filter(|(_, cuts)| !cuts.is_empty());
        let of_leaves = with_some.map(|(leaf, through)| (leaf, Lines { through, ..Lines::default() })).collect();
        Self { of_leaves, tolerance }
    }

    /// A leaf cut in two.
    pub fn bisect(&self, leaf: NodeId, polygon: &Facet<'_>) -> Bisection {
        let Some(lines) = self.of_leaves.get(&leaf) else {
            return Bisection { parts: halve(polygon), lines: Default::default() };
        };
        let (lines, taken) = self.most_even(lines, polygon);
        if let Some((taken, parts)) = taken {
            return Bisection { parts, lines: self.divide(&lines, &taken, false) };
        }
        let middle = self.middle_of_strip(&lines, polygon).filter(|_| !lines.is_cut_along);
        if let Some((middle, parts)) = middle.and_then(|middle| Some((middle, self.cut(&middle, polygon)?.0))) {
            return Bisection { parts, lines: self.divide(&lines, &middle, true) };
        }

        // The line of halves, from its end to its beginning, so that the first is above it.
        let [first, second] = halve(polygon);
        let line = Cut::new([first[first.len() - 1], first[0]], polygon.normal, 0);
        let lines = line.map_or_else(Default::default, |line| self.divide(&lines, &line, false));
        Bisection { parts: [first, second], lines }
    }

    /// Of the segments that cut an element, that of the least rank, then with the most even parts, then the first, with these parts. Segments that do
    /// not cut it are counted to its border.
    fn most_even(&self, lines: &Lines, polygon: &Facet<'_>) -> (Lines, Option<(Cut, Parts)>) {
        let mut settled = Lines { through: Vec::new(), ..lines.clone() };
        let mut best: Option<(&Cut, Parts, f64)> = None;
        for cut in &lines.through {
            let Some((parts, least)) = self.cut(cut, polygon) else {
                settled.add_to_border(cut);
                continue;
            };
            settled.through.push(*cut);
            let is_better = |(other, _, other_least): &(&Cut, _, f64)| (cut.rank, -least) < (other.rank, -other_least);
            if best.as_ref().is_none_or(is_better) {
                best = Some((cut, parts, least));
            }
        }
        (settled, best.map(|(cut, parts, _)| (*cut, parts)))
    }

    /// The parts of an element on either side of a line, and the lesser area; `None` if one has none, or is so thin that its sides count as one.
    fn cut(&self, cut: &Cut, polygon: &Facet<'_>) -> Option<(Parts, f64)> {
        let parts = cut_along(polygon.vertices, |vertex| cut.height(vertex), self.tolerance)?;
        let facets = parts.each_ref().map(|part| Facet::of_part(part, polygon.normal));
        let is_thick = |facet: &Facet<'_>| facet.area > self.tolerance * facet.radius;
        let least = facets[0].area.min(facets[1].area);
        facets.iter().all(is_thick).then_some((parts, least))
    }

    /// The lines of the parts on either side of a segment.
    fn divide(&self, lines: &Lines, taken: &Cut, is_cut_along: bool) -> [Lines; 2] {
        let mut divided = [0, 1].map(|_| Lines { is_cut_along, ..Lines::default() });
        for cut in &lines.through {
            match taken.divide(cut, self.tolerance) {
                // On the line.
                [None, None] => divided.iter_mut().for_each(|lines| lines.add_to_border(cut)),
                parts => divided.iter_mut().zip(parts).for_each(|(lines, cut)| lines.through.extend(cut)),
            }
        }
        for cut in &lines.on_border {
            let parts = taken.divide(cut, self.tolerance);
            divided.iter_mut().zip(parts).for_each(|(lines, cut)| lines.on_border.extend(cut));
        }
        if is_cut_along {
            divided.iter_mut().for_each(|lines| lines.add_to_border(taken));
        }
        divided
    }

    /// The middle between the two longest sides of an element, if it is long and derivatives jump along most of both.
    fn middle_of_strip(&self, lines: &Lines, polygon: &Facet<'_>) -> Option<Cut> {
        let mut sides: Vec<(DVec3, DVec3)> = edges(polygon.vertices).collect();
        sides.sort_by(|a, b| b.1.length_squared().total_cmp(&a.1.length_squared()));
        let &[(a, along_a), (b, along_b), ..] = &sides[..] else { return None };
        let is_long = along_a.length_squared() > LONG * polygon.area;
        if !is_long || ![(a, along_a), (b, along_b)].into_iter().all(|side| self.is_lined(side, &lines.on_border)) {
            return None;
        }
        // They run against each other.
        let ends = [0.5 * (a + (b + along_b)), 0.5 * ((a + along_a) + b)];
        Cut::new(ends, polygon.normal, 1)
    }

    /// Whether derivatives jump along most of a side.
    fn is_lined(&self, (start, along): (DVec3, DVec3), on_border: &[Cut]) -> bool {
        let length = along.length();
        let (along, mut lined) = (along / length, 0.0);
        for cut in on_border {
            // The line and the corners are each off by the tolerance.
            let is_on_side =
                cut.ends.iter().all(|&end| (end - start).reject_from_normalized(along).length() <= 4.0 * self.tolerance);
            if is_on_side {
                let [from, to] = cut.ends.map(|end| along.dot(end - start).clamp(0.0, length));
                lined += (to - from).abs();
            }
        }
        lined > 0.5 * length
    }

    /// Hands what is known of a leaf on to its children.
    pub fn hand_on(&mut self, leaf: NodeId, first_child: NodeId, bisection: Bisection) {
        self.of_leaves.remove(&leaf);
        for (child, lines) in (first_child.0..).map(NodeId).zip(bisection.lines) {
            if lines.is_worth_keeping() {
                self.of_leaves.insert(child, lines);
            }
        }
    }

    /// Bytes that segments take, at most, where a leaf is bisected: each may become two, and there is a new one.
    pub fn bytes_of_split(&self, leaf: NodeId) -> usize {
        let known = self.of_leaves.get(&leaf).map_or(0, |lines| lines.through.len() + lines.on_border.len());
        (2 * known + 2) * size_of::<Cut>() + 2 * size_of::<(NodeId, Lines)>()
    }

    pub fn memory_bytes(&self) -> usize {
        self.of_leaves.values().map(Lines::memory_bytes).sum()
    }
}

impl Lines {
    /// Adds a segment that lies on the border, if it may bound a strip.
    fn add_to_border(&mut self, cut: &Cut) {
        if cut.rank > 0 {
            self.on_border.push(*cut);
        }
    }

    /// Whether anything hangs on it: a strip has two sides.
    fn is_worth_keeping(&self) -> bool {
        !self.through.is_empty() || self.on_border.len() > 1
    }

    fn memory_bytes(&self) -> usize {
        size_of::<(NodeId, Self)>() + size_of_val(&self.through[..]) + size_of_val(&self.on_border[..])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Polygon, sampling};

    const TOLERANCE: f64 = 1e-6;

    fn random(seed: u64, k: u64) -> f64 {
        sampling::unit(sampling::hash(seed, k))
    }

    fn cut(ends: [[f64; 2]; 2], rank: u8) -> Cut {
        Cut::new(ends.map(|[x, y]| DVec3::new(x, y, 0.0)), DVec3::Z, rank).unwrap()
    }

    fn square() -> Vec<DVec3> {
        [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| DVec3::new(x, y, 0.0)).to_vec()
    }

    /// Bisects while there are segments that cut; the leaves.
    fn exhaust(vertices: Vec<DVec3>, cuts: Vec<Cut>, leaves: &mut Vec<Vec<DVec3>>) {
        let facet = Facet::of_part(&vertices, DVec3::Z);
        let mut all = Cuts::new([(NodeId(1), cuts)], TOLERANCE);
        let cuts_it = |lines: &Lines| all.most_even(lines, &facet).1.is_some();
        if !all.of_leaves.get(&NodeId(1)).is_some_and(cuts_it) {
            leaves.push(vertices);
            return;
        }
        let bisection = all.bisect(NodeId(1), &facet);
        let parts = bisection.parts.clone();
        all.hand_on(NodeId(1), NodeId(2), bisection);
        for (part, child) in parts.into_iter().zip([NodeId(2), NodeId(3)]) {
            exhaust(part, all.of_leaves.get(&child).map_or(Vec::new(), |lines| lines.through.clone()), leaves);
        }
    }

    /// Segments on a grid, so that many meet, touch corners, lie on one line or on sides; and some anywhere.
    #[test]
    fn leaves_cover_the_square_and_no_segment_runs_through_one() {
        for seed in 0..60 {
            let at = |k: u64| if seed % 2 == 0 { (8.0 * random(seed, k)).round() / 8.0 } else { random(seed, k) };
            let ends = |k: u64| [[at(4 * k), at(4 * k + 1)], [at(4 * k + 2), at(4 * k + 3)]];
            let cuts: Vec<Cut> = (0..25).filter(|&k| ends(k)[0] != ends(k)[1]).map(|k| cut(ends(k), (k % 3) as u8)).collect();
            let mut leaves = Vec::new();
            exhaust(square(), cuts.clone(), &mut leaves);

            let polygons: Vec<Polygon> = leaves.into_iter().map(|leaf| Polygon::from_vertices(leaf).expect("convex")).collect();
            let area: f64 = polygons.iter().map(Polygon::area).sum();
            assert!((area - 1.0).abs() < 1e-12, "seed {seed}: {area}");
            assert!(polygons.iter().all(|polygon| polygon.normal()[2] > 0.999));
            for cut in &cuts {
                for step in 1..200 {
                    let point = cut.ends[0].lerp(cut.ends[1], f64::from(step) / 200.0);
                    let inside = polygons.iter().find(|polygon| {
                        let facet = polygon.facet();
                        let mut sides = edges(facet.vertices);
                        sides.all(|(from, side)| DVec3::Z.cross(side).normalize().dot(point - from) > 4.0 * TOLERANCE)
                    });
                    assert!(inside.is_none(), "seed {seed}: {cut:?} runs through {inside:?}");
                }
            }
        }
    }

    #[test]
    fn the_least_rank_is_taken_first_and_of_these_the_most_even() {
        let facet = square();
        let facet = Facet::of_part(&facet, DVec3::Z);
        let cuts = [
            cut([[0.5, 0.2], [0.5, 0.8]], 1),
            cut([[0.1, 0.2], [0.1, 0.4]], 0),
            cut([[0.2, 0.3], [0.8, 0.3]], 0),
            // On a side, and along one that was taken: these cut nothing.
            cut([[0.0, 0.2], [0.0, 0.8]], 0),
        ];
        let all = Cuts::new([(NodeId(1), cuts.to_vec())], TOLERANCE);
        let Bisection { parts, lines } = all.bisect(NodeId(1), &facet);
        let areas = parts.map(|part| Facet::of_part(&part, DVec3::Z).area);
        assert!((areas[0] - 0.7).abs() < 1e-15 && (areas[1] - 0.3).abs() < 1e-15, "{areas:?}");
        assert_eq!(lines.map(|lines| lines.through.len()), [2, 2]);
    }

    #[test]
    fn without_segments_it_is_halved() {
        let facet = square();
        let all = Cuts::new([], TOLERANCE);
        let Bisection { parts, lines } = all.bisect(NodeId(1), &Facet::of_part(&facet, DVec3::Z));
        assert!(
            parts.iter().all(|part| Facet::of_part(part, DVec3::Z).area == 0.5)
                && lines.iter().all(|lines| lines.through.is_empty())
        );
    }

    /// A wedge between two lines is cut through its tip, then across, in turn: its elements become as narrow as short. Without the lines, or where
    /// irradiance itself jumps, it keeps its angle.
    #[test]
    fn strips_are_cut_along_and_across_in_turn() {
        let wedge: Vec<DVec3> = [[0.0, 0.0], [4.0, 0.0], [4.0, 0.5]].map(|[x, y]| DVec3::new(x, y, 0.0)).to_vec();
        let tip_angle = |rank: u8, splits: u32| {
            let lines = [[[0.0, 0.0], [4.0, 0.0]], [[0.0, 0.0], [4.0, 0.5]]].map(|ends| cut(ends, rank));
            let mut all = Cuts::new([(NodeId(1), lines.to_vec())], TOLERANCE);
            let (mut tip, mut node) = (wedge.clone(), NodeId(1));
            for split in 1..=splits {
                let bisection = all.bisect(node, &Facet::of_part(&tip, DVec3::Z));
                let is_tip = |part: &Vec<DVec3>| part.contains(&wedge[0]);
                let child = bisection.parts.iter().position(is_tip).unwrap();
                tip = bisection.parts[child].clone();
                let first = NodeId(2 * split);
                all.hand_on(node, first, bisection);
                node = NodeId(first.0 + child as u32);
            }
            let arms: Vec<DVec3> = tip.iter().filter(|&&corner| corner != wedge[0]).copied().collect();
            (arms[0].angle_between(arms[1]), arms[0].length())
        };
        let (angle, length) = tip_angle(1, 8);
        let (whole, _) = tip_angle(1, 0);
        assert!(angle < whole / 7.5 && length < 4.0 / 4.0, "{angle} of {whole}, {length}");
        assert!((tip_angle(0, 8).0 - whole).abs() < 1e-9);
    }
}
