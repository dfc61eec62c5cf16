//! The light tree (Conty Estevez, Kulla 2018): draws a source by the light that it may send to a place. The cost of a draw grows
//! with the logarithm of the number of sources.
//!
//! A descent goes from each node to one of up to four children, with probabilities in proportion to a bound of the light that each
//! can send (from its box, cone of normals and power). Each source that can send light has a probability above 0, so dividing by it
//! leaves no bias.
//!
//! The bound of a near group says little: a source in it may be much nearer than the group's centre. So all descents start below
//! the near groups, and near single sources count with their exact unoccluded irradiance.
//!
//! Lengths are in radii of the tree and powers in parts of its power, so no scene is too large or too dim for f32.

use std::f64::consts::PI;

use glam::DVec3;
use rayon::prelude::*;

use super::light_node::{Below, Node, Receiver, WIDTH};
use super::source_group::{Group, Source, halves};
use crate::progress::Stop;

/// A group or source is near if the square of its radius over its distance is above this.
const NEAR_SQ: f32 = 0.25;

/// Trees over fewer sources are made on one thread, and to their end: some milliseconds.
const PARALLEL: usize = 4096;

/// What a descent starts from: a bound of the light that it sends, up to a common factor, and the group or source.
type Start = (f64, Below);

/// A light tree.
pub(super) struct LightTree {
    nodes: Vec<Node>,
    /// By source, the node that it is a child of.
    node_of: Vec<u32>,
    /// The units of the nodes: the origin, the length and the power.
    centre: DVec3,
    radius: f64,
    power: f64,
}

/// A source that was drawn.
pub(super) struct Drawn {
    /// The number of the source.
    pub number: u32,
    pub probability: f64,
    /// The index of the random number that drew it.
    pub ray: u32,
    /// What is left of that number: uniform in [0, 1) again.
    pub rest: f64,
}

/// Sources that were drawn; memory that is reused.
#[derive(Default)]
pub(super) struct Draws {
    starts: Vec<Start>,
    pub drawn: Vec<Drawn>,
}

/// The units of the nodes of a tree: the origin, the length and the power.
struct Units {
    centre: DVec3,
    radius: f64,
    power: f64,
}

impl Units {
    /// Appends the tree over `sources`, a node before those below it; returns its root and the group of all. `None` if stopped before.
    fn add(&self, nodes: &mut Vec<Node>, sources: &mut [Source], stop: Stop<'_>) -> Option<(Below, Group)> {
        let (index, is_large) = (nodes.len(), sources.len() >= PARALLEL);
        if is_large && stop() {
            return None;
        }
        nodes.push(Node::EMPTY);
        let (left, right) = halves(sources);
        let quarters = [left, right].into_iter().flat_map(|half| match half.len() {
            0 | 1 => [half, &mut []],
            _ => halves(half).into(),
        });
        let quarters = quarters.filter(|sources| !sources.is_empty());

        // A child for each quarter that has sources; large ones side by side, then in their order.
        let mut whole: Option<Group> = None;
        let mut set = |nodes: &mut [Node], child: usize, (below, group): (Below, Group)| {
            self.set_child(&mut nodes[index], child, below, &group);
            whole = Some(match whole.take() {
                Some(whole) => whole.union(group),
                None => group,
            });
        };
        if is_large {
            let of_quarter = |sources| {
                let mut nodes = Vec::new();
                self.add_child(&mut nodes, sources, stop).map(|child| (nodes, child))
            };
            let children: Vec<Option<_>> = quarters.collect::<Vec<_>>().into_par_iter().map(of_quarter).collect();
            for (number, child) in children.into_iter().enumerate() {
                let (mut below, (root, group)) = child?;
                let before = nodes.len() as u32;
                below.iter_mut().flat_map(|node| &mut node.below).for_each(|below| *below = below.behind(before));
                nodes.append(&mut below);
                set(nodes, number, (root.behind(before), group));
            }
        } else {
            for (number, sources) in quarters.enumerate() {
                let child = self.add_child(nodes, sources, stop)?;
                set(nodes, number, child);
            }
        }
        Some((Below::Node(index as u32), whole.unwrap_or_default()))
    }

    /// The same, or a single source.
    fn add_child(&self, nodes: &mut Vec<Node>, sources: &mut [Source], stop: Stop<'_>) -> Option<(Below, Group)> {
        match sources {
            [source] => Some((Below::Source(source.number), Group::of(source))),
            _ => self.add(nodes, sources, stop),
        }
    }

    fn set_child(&self, node: &mut Node, child: usize, below: Below, group: &Group) {
        let centre = (group.bounds.centre() - self.centre) / self.radius;
        let radius = 0.5 * group.bounds.diagonal() / self.radius;
        let (sin, cos) = group.half_angle.min(PI).sin_cos();
        for axis in 0..3 {
            node.centre[axis][child] = centre[axis] as f32;
            node.axis[axis][child] = group.axis[axis] as f32;
        }
        node.radius[child] = (radius as f32).max(f32::MIN_POSITIVE.sqrt());
        (node.cos_half_angle[child], node.sin_half_angle[child]) = (cos as f32, sin as f32);
        node.power[child] = ((group.power / self.power) as f32).max(f32::MIN_POSITIVE);
        node.below[child] = below;
    }
}

impl LightTree {
    /// A tree over `sources`, at least one, with numbers from 0 on; `None` if stopped before it is whole.
    pub fn new(mut sources: Vec<Source>, stop: Stop<'_>) -> Option<Self> {
        let Group { bounds, power, .. } = sources.iter().map(Group::of).reduce(Group::union).unwrap_or_default();
        let (centre, radius) = (bounds.centre(), 0.5 * bounds.diagonal());
        let (units, mut nodes) = (Units { centre, radius, power }, Vec::new());
        units.add(&mut nodes, &mut sources, stop)?;

        // Nodes stand before those below them.
        let mut node_of = vec![0; sources.len()];
        for index in (0..nodes.len()).rev() {
            let mut end = index as u32 + 1;
            for child in (0..WIDTH).filter(|&child| nodes[index].power[child] > 0.0) {
                match nodes[index].below[child] {
                    Below::Source(number) => node_of[number as usize] = index as u32,
                    Below::Node(child) => end = end.max(nodes[child as usize].end),
                }
            }
            nodes[index].end = end;
        }
        Some(Self { nodes, node_of, centre, radius, power })
    }

    /// Draws a source by each of `numbers`, rising in [0, 1), for points that share a normal, into `draws`. A number draws nothing
    /// where its descent finds no source that can send light to any of the points. Each node is visited once, however many numbers
    /// pass through it.
    ///
    /// `unoccluded` gives the mean irradiance at the points from a source if nothing is in between, in W/m^2 in its brightest
    /// channel.
    pub fn draw(
        &self,
        points: impl ExactSizeIterator<Item = DVec3> + Clone,
        normal: DVec3,
        unoccluded: impl Fn(u32) -> f64,
        numbers: impl Iterator<Item = f64>,
        draws: &mut Draws,
    ) {
        let Draws { starts, drawn } = draws;
        let middle = points.clone().sum::<DVec3>() / points.len() as f64;
        let reach = points.map(|point| point.distance(middle)).fold(0.0, f64::max);
        let receiver = self.receiver(middle, reach, normal);

        // What descents start from.
        starts.clear();
        self.visit_starts(0, &receiver, &|number| self.in_units_of_bounds() * unoccluded(number), &mut |start| starts.push(start));

        // All descents together.
        drawn.clear();
        drawn.extend((0..).zip(numbers).map(|(ray, rest)| Drawn { number: 0, probability: 1.0, ray, rest }));
        let kept = self.share_out(starts, &receiver, drawn);
        drawn.truncate(kept);
    }

    /// The probability with which [`Self::draw`] draws a source for a single point.
    pub fn probability(&self, source: u32, point: DVec3, normal: DVec3, unoccluded: impl Fn(u32) -> f64) -> f64 {
        let receiver = self.receiver(point, 0.0, normal);
        let (mut sum, mut own) = (0.0, None);
        let sent = |number| self.in_units_of_bounds() * unoccluded(number);
        self.visit_starts(0, &receiver, &sent, &mut |(bound, below)| {
            sum += bound;
            if self.is_in(source, below) {
                own = Some((bound, below));
            }
        });

        // Down to the source.
        let Some((bound, mut below)) = own.filter(|(bound, _)| *bound > 0.0) else { return 0.0 };
        let mut probability = bound / sum;
        while let Below::Node(index) = below {
            let node = &self.nodes[index as usize];
            let bounds = node.bound_sent(&receiver).0.map(f64::from);
            let is_on_way = |&child: &usize| bounds[child] > 0.0 && self.is_in(source, node.below[child]);
            let Some(child) = (0..WIDTH).find(is_on_way) else { return 0.0 };
            probability *= bounds[child] / bounds.iter().sum::<f64>();
            below = node.below[child];
        }
        probability
    }

    /// Whether a source is this one, or in this group.
    fn is_in(&self, source: u32, below: Below) -> bool {
        match below {
            Below::Source(number) => number == source,
            Below::Node(index) => (index..self.nodes[index as usize].end).contains(&self.node_of[source as usize]),
        }
    }

    /// Points with a normal in the units of the tree.
    fn receiver(&self, point: DVec3, reach: f64, normal: DVec3) -> Receiver {
        Receiver {
            point: ((point - self.centre) / self.radius).as_vec3().to_array(),
            reach: (reach / self.radius) as f32,
            normal: normal.as_vec3().to_array(),
        }
    }

    /// So many times an irradiance is what bounds are compared with.
    fn in_units_of_bounds(&self) -> f64 {
        PI * self.radius * self.radius / self.power
    }

    /// Visits what descents start from: the children of a node, or those below where a child is a near group.
    fn visit_starts(&self, index: u32, receiver: &Receiver, sent: &impl Fn(u32) -> f64, visit: &mut impl FnMut(Start)) {
        let node = &self.nodes[index as usize];
        let (bounds, nearness_sq) = node.bound_sent(receiver);
        for child in (0..WIDTH).filter(|&child| bounds[child] > 0.0) {
            match node.below[child] {
                Below::Node(index) if nearness_sq[child] > NEAR_SQ => self.visit_starts(index, receiver, sent, visit),
                Below::Source(number) if nearness_sq[child] > NEAR_SQ => visit((sent(number), node.below[child])),
                below => visit((f64::from(bounds[child]), below)),
            }
        }
    }

    /// Takes the draws at a node down to sources. Draws that find none are moved behind the others. Returns how many have a source.
    fn descend(&self, index: u32, receiver: &Receiver, drawn: &mut [Drawn]) -> usize {
        let node = &self.nodes[index as usize];
        let (bounds, _) = node.bound_sent(receiver);
        let children: [Start; WIDTH] = std::array::from_fn(|child| (f64::from(bounds[child]), node.below[child]));
        self.share_out(&children, receiver, drawn)
    }

    /// The same at several groups and sources, which draws choose in proportion to their bounds.
    fn share_out(&self, children: &[Start], receiver: &Receiver, drawn: &mut [Drawn]) -> usize {
        let sum: f64 = children.iter().map(|(bound, _)| bound).sum();
        let Some(last) = children.iter().rposition(|(bound, _)| *bound > 0.0) else { return 0 };
        let (mut first, mut kept, mut before) = (0, 0, 0.0);
        for (child, &(bound, below)) in children.iter().enumerate().filter(|(_, (bound, _))| *bound > 0.0) {
            if first == drawn.len() {
                break;
            }
            // The draws whose numbers fall in the share of this child.
            let share = bound / sum;
            let is_here = |drawn: &Drawn| drawn.rest < before + share || child == last;
            let count = drawn[first..].iter().take_while(|drawn| is_here(drawn)).count();
            let here = &mut drawn[first..first + count];
            for drawn in here.iter_mut() {
                drawn.probability *= share;
                drawn.rest = ((drawn.rest - before) / share).clamp(0.0, 1.0 - f64::EPSILON);
            }
            before += share;

            // Take them down to sources; move those with a source in front.
            let found = match below {
                _ if count == 0 => continue,
                Below::Source(number) => {
                    here.iter_mut().for_each(|drawn| drawn.number = number);
                    count
                }
                Below::Node(index) => self.descend(index, receiver, here),
            };
            if kept < first {
                drawn[kept..first + found].rotate_left(first - kept);
            }
            kept += found;
            first += count;
        }
        kept
    }
}
