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
//! The bounds of four children are computed side by side in f32: rounding changes the probabilities, but they remain those that are
//! divided by. Lengths are in radii of the tree and powers in parts of its power, so no scene is too large or too dim for f32.

use std::f64::consts::PI;

use glam::DVec3;
use rayon::prelude::*;

use super::source_group::{Group, Source, halves};
use crate::progress::Stop;

/// Cosines are widened by this much against rounding: sines of small angles are known to the root of the rounding of f32.
const SLACK: f32 = 1e-3;

/// Children of a node.
const WIDTH: usize = 4;

/// A group or source is near if the square of its radius over its distance is above this.
const NEAR_SQ: f32 = 0.25;

/// Trees over fewer sources are made on one thread, and to their end: some milliseconds.
const PARALLEL: usize = 4096;

/// One number for each child, or child and axis.
type Lanes = [f32; WIDTH];

/// Up to four children; unused lanes have no power.
struct Node {
    /// The centre of each child's box, and half of its diagonal.
    centre: [Lanes; 3],
    radius: Lanes,
    /// All normals are within the half-angle of a cone around `axis`, in [0, pi].
    axis: [Lanes; 3],
    cos_half_angle: Lanes,
    sin_half_angle: Lanes,
    /// Area times brightness.
    power: Lanes,
    below: [Below; WIDTH],
}

/// What a descent starts from: a bound of the light that it sends, up to a common factor, and the group or source.
type Start = (f64, Below);

/// What a child is.
#[derive(Clone, Copy)]
enum Below {
    Source(u32),
    Node(u32),
}

impl Node {
    const EMPTY: Self = Self {
        centre: [[0.0; WIDTH]; 3],
        radius: [1.0; WIDTH],
        axis: [[0.0; WIDTH]; 3],
        cos_half_angle: [1.0; WIDTH],
        sin_half_angle: [0.0; WIDTH],
        power: [0.0; WIDTH],
        below: [Below::Node(0); WIDTH],
    };
}

/// A light tree.
pub(super) struct LightTree {
    nodes: Vec<Node>,
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

/// Points of one normal, in the units of a tree: all within `reach` of `point`.
struct Receiver {
    point: [f32; 3],
    reach: f32,
    normal: [f32; 3],
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

impl Below {
    /// The same where so many nodes stand before those of its tree.
    fn behind(self, before: u32) -> Self {
        match self {
            Self::Source(_) => self,
            Self::Node(index) => Self::Node(before + index),
        }
    }
}

impl LightTree {
    /// A tree over `sources`, at least one; `None` if stopped before it is whole.
    pub fn new(mut sources: Vec<Source>, stop: Stop<'_>) -> Option<Self> {
        let Group { bounds, power, .. } = sources.iter().map(Group::of).reduce(Group::union).unwrap_or_default();
        let (centre, radius) = (bounds.centre(), 0.5 * bounds.diagonal());
        let (units, mut nodes) = (Units { centre, radius, power }, Vec::new());
        units.add(&mut nodes, &mut sources, stop)?;
        Some(Self { nodes, centre, radius, power })
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
        let receiver = Receiver {
            point: ((middle - self.centre) / self.radius).as_vec3().to_array(),
            reach: (reach / self.radius) as f32,
            normal: normal.as_vec3().to_array(),
        };

        // What descents start from.
        let in_units_of_bounds = PI * self.radius * self.radius / self.power;
        starts.clear();
        self.collect_starts(0, &receiver, &|number| in_units_of_bounds * unoccluded(number), starts);

        // All descents together.
        drawn.clear();
        drawn.extend((0..).zip(numbers).map(|(ray, rest)| Drawn { number: 0, probability: 1.0, ray, rest }));
        let kept = self.share_out(starts, &receiver, drawn);
        drawn.truncate(kept);
    }

    /// Appends what descents start from: the children of a node, or those below where a child is a near group.
    fn collect_starts(&self, index: u32, receiver: &Receiver, sent: &impl Fn(u32) -> f64, starts: &mut Vec<Start>) {
        let node = &self.nodes[index as usize];
        let (bounds, nearness_sq) = node.bound_sent(receiver);
        for child in (0..WIDTH).filter(|&child| bounds[child] > 0.0) {
            match node.below[child] {
                Below::Node(index) if nearness_sq[child] > NEAR_SQ => self.collect_starts(index, receiver, sent, starts),
                Below::Source(number) if nearness_sq[child] > NEAR_SQ => starts.push((sent(number), node.below[child])),
                below => starts.push((f64::from(bounds[child]), below)),
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

impl Node {
    /// By child: a bound of the light that it sends to the receiver, up to a common factor, and its nearness, the square of radius
    /// over distance. The bound is power times the largest cosines over the square of the distance. The radius is that of the
    /// child's box plus the reach of the receiver; the distance counts as no less than that.
    fn bound_sent(&self, receiver: &Receiver) -> (Lanes, Lanes) {
        // Distances and projections, in arrays and without branches, so that the compiler computes four children side by side.
        let (mut distance_sq, mut to_receiver, mut to_axis) = ([0.0; WIDTH], [0.0; WIDTH], [0.0; WIDTH]);
        for axis in 0..3 {
            for k in 0..WIDTH {
                let towards = self.centre[axis][k] - receiver.point[axis];
                distance_sq[k] += towards * towards;
                to_receiver[k] += towards * receiver.normal[axis];
                to_axis[k] -= towards * self.axis[axis][k];
            }
        }

        // The largest cosines at both ends: directions vary by the angle under which the radius is seen, at the sources by the cone
        // of normals too.
        let (mut sent, mut nearness_sq) = ([0.0; WIDTH], [0.0; WIDTH]);
        for k in 0..WIDTH {
            let radius = self.radius[k] + receiver.reach;
            let radius_sq = radius * radius;
            let far_sq = largest(distance_sq[k], radius_sq);
            let sin_sq = radius_sq / far_sq;
            let seen_angle = (sin_sq.sqrt(), (1.0 - sin_sq).sqrt());
            let per_distance = 1.0 / far_sq.sqrt();
            let at_receiver = less(angle(to_receiver[k] * per_distance), seen_angle);
            let at_sources =
                less(less(angle(to_axis[k] * per_distance), seen_angle), (self.sin_half_angle[k], self.cos_half_angle[k]));
            let cosines = largest(at_receiver.1 + SLACK, 0.0) * largest(at_sources.1 + SLACK, 0.0);
            let is_inside = distance_sq[k] <= radius_sq;
            sent[k] = self.power[k] * if is_inside { 1.0 } else { cosines } / far_sq;
            nearness_sq[k] = radius_sq / largest(distance_sq[k], f32::MIN_POSITIVE);
        }
        (sent, nearness_sq)
    }
}

/// The larger of two numbers that are not NaN.
fn largest(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// Sine and cosine of an angle in [0, pi] by its cosine, which rounding may have left a little outside [-1, 1].
fn angle(cos: f32) -> (f32, f32) {
    (largest(1.0 - cos * cos, 0.0).sqrt(), cos)
}

/// Sine and cosine of `a - b`, or of 0 if that is negative; angles in [0, pi], given by their sines and cosines.
fn less(a: (f32, f32), b: (f32, f32)) -> (f32, f32) {
    let is_less = a.1 >= b.1;
    let (sin, cos) = (a.0 * b.1 - a.1 * b.0, a.1 * b.1 + a.0 * b.0);
    (if is_less { 0.0 } else { sin }, if is_less { 1.0 } else { cos })
}
