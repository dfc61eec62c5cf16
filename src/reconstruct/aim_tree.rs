//! Draws from a tree what a ray is aimed at, by what that may bring to a place: the cost of a draw grows with the logarithm of the
//! number of sources.
//!
//! At every node the descent goes to one of up to four children with probabilities in proportion to a bound on what each can bring (box,
//! cone of normals, power; after Conty Estevez and Kulla 2018). A source that can bring light at all is drawn with a probability above
//! 0, so what is divided by that probability is without bias.
//!
//! Of a group that is near its bound says little: a source in it may be nearer than its size. So descents start below all groups that
//! are near, all together, and of single sources that are near it is known exactly what they send.
//!
//! The bounds of four children are computed side by side, in f32: it is the probabilities that were drawn by that count, not how
//! exact they are. Lengths are in radii of the tree and powers in parts of its power, so no scene is too large or too dim for that.

use std::f64::consts::PI;

use glam::DVec3;

use crate::geometry::Aabb;

/// Cosines are widened by this much against rounding: sines of small angles are known to the root of the rounding of f32.
const SLACK: f32 = 1e-3;

/// Angles are widened by this much against rounding.
const ANGLE_SLACK: f64 = 1e-6;

/// Children of a node.
const WIDTH: usize = 4;

/// What has more than this part of its distance as radius, both squared, is near.
const NEAR_SQ: f32 = 0.25;

/// One number for each child, or child and axis.
type Lanes = [f32; WIDTH];

/// Up to four groups of sources; places that are left over have no power.
struct Node {
    /// The middle of each group's box, and its radius.
    centre: [Lanes; 3],
    radius: Lanes,
    /// All normals are within an angle of `axis`, the spread, in [0, pi].
    axis: [Lanes; 3],
    cos_spread: Lanes,
    sin_spread: Lanes,
    /// Area times brightness.
    power: Lanes,
    below: [Below; WIDTH],
}

/// A group or a source, with what it may send, up to a common factor.
pub(super) type Start = (f64, Below);

/// What a child is.
#[derive(Clone, Copy)]
pub(super) enum Below {
    Source(u32),
    Node(u32),
}

impl Node {
    const EMPTY: Self = Self {
        centre: [[0.0; WIDTH]; 3],
        radius: [1.0; WIDTH],
        axis: [[0.0; WIDTH]; 3],
        cos_spread: [1.0; WIDTH],
        sin_spread: [0.0; WIDTH],
        power: [0.0; WIDTH],
        below: [Below::Node(0); WIDTH],
    };
}

/// A tree over sources.
pub(super) struct AimTree {
    nodes: Vec<Node>,
    /// The frame of the nodes.
    centre: DVec3,
    radius: f64,
    power: f64,
}

/// What rays may be aimed at: a lamp, or a part of a reflector.
#[derive(Clone)]
pub(super) struct Source {
    pub number: u32,
    pub bounds: Aabb,
    pub normal: DVec3,
    /// What it sends in all, in W.
    pub power: f64,
}

/// A source that was drawn.
pub(super) struct Drawn {
    /// The number of the source.
    pub number: u32,
    pub probability: f64,
    /// Which number drew it.
    pub ray: u32,
    /// What is left of the number that drew it: uniform in [0, 1) again.
    pub rest: f64,
}

/// Places of one normal, in the frame of a tree: all are within `reach` of `point`.
struct Receiver {
    point: [f32; 3],
    reach: f32,
    normal: [f32; 3],
}

/// What is known of a group of sources.
struct Group {
    bounds: Aabb,
    /// All normals are within `spread` of `axis`, in radians.
    axis: DVec3,
    spread: f64,
    /// In W.
    power: f64,
}

impl AimTree {
    /// A tree over `sources`, of which there must be some.
    pub fn new(mut sources: Vec<Source>) -> Self {
        let Group { bounds, power, .. } = sources.iter().map(Group::of).reduce(Group::union).unwrap_or_default();
        let mut tree = Self { nodes: Vec::new(), centre: bounds.centre(), radius: 0.5 * bounds.diagonal(), power };
        tree.add(&mut sources);
        tree
    }

    /// Appends the tree over `sources`; returns its root and what is known of it.
    fn add(&mut self, sources: &mut [Source]) -> (Below, Group) {
        let index = self.nodes.len();
        self.nodes.push(Node::EMPTY);
        let (left, right) = halves(sources);
        let quarters = [left, right].into_iter().flat_map(|half| match half.len() {
            0 | 1 => [half, &mut []],
            _ => halves(half).into(),
        });
        let mut whole: Option<Group> = None;
        for (child, sources) in quarters.filter(|sources| !sources.is_empty()).enumerate() {
            let (below, group) = match sources {
                [source] => (Below::Source(source.number), Group::of(source)),
                _ => self.add(sources),
            };
            self.set_child(index, child, below, &group);
            whole = Some(match whole {
                Some(whole) => whole.union(group),
                None => group,
            });
        }
        (Below::Node(index as u32), whole.unwrap_or_default())
    }

    fn set_child(&mut self, index: usize, child: usize, below: Below, group: &Group) {
        let centre = (group.bounds.centre() - self.centre) / self.radius;
        let radius = 0.5 * group.bounds.diagonal() / self.radius;
        let (sin, cos) = group.spread.min(PI).sin_cos();
        let node = &mut self.nodes[index];
        for axis in 0..3 {
            node.centre[axis][child] = centre[axis] as f32;
            node.axis[axis][child] = group.axis[axis] as f32;
        }
        node.radius[child] = (radius as f32).max(f32::MIN_POSITIVE.sqrt());
        (node.cos_spread[child], node.sin_spread[child]) = (cos as f32, sin as f32);
        node.power[child] = ((group.power / self.power) as f32).max(f32::MIN_POSITIVE);
        node.below[child] = below;
    }

    /// Draws a source for points with a normal by each of `numbers`, rising in [0, 1), and appends them to `drawn`; none where no
    /// source on the way can bring anything to any of them. Every node on the way is looked at once, however many numbers pass through it.
    /// `unoccluded` is the mean irradiance that a source would bring to the points if nothing were in between, in W/m^2 in its brightest
    /// channel.
    pub fn draw(
        &self,
        points: impl ExactSizeIterator<Item = DVec3> + Clone,
        normal: DVec3,
        unoccluded: impl Fn(u32) -> f64,
        numbers: impl Iterator<Item = f64>,
        starts: &mut Vec<Start>,
        drawn: &mut Vec<Drawn>,
    ) {
        let middle = points.clone().sum::<DVec3>() / points.len() as f64;
        let reach = points.map(|point| point.distance(middle)).fold(0.0, f64::max);
        let receiver = Receiver {
            point: ((middle - self.centre) / self.radius).as_vec3().to_array(),
            reach: (reach / self.radius) as f32,
            normal: normal.as_vec3().to_array(),
        };
        let in_units_of_bounds = PI * self.radius * self.radius / self.power;
        starts.clear();
        self.collect_starts(0, &receiver, &|number| in_units_of_bounds * unoccluded(number), starts);

        let first = drawn.len();
        drawn.extend((0..).zip(numbers).map(|(ray, rest)| Drawn { number: 0, probability: 1.0, ray, rest }));
        let kept = self.share_out(starts, &receiver, &mut drawn[first..]);
        drawn.truncate(first + kept);
    }

    /// Appends what descents start from: the children of a node, or theirs where they are near.
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

    /// Brings those that are drawn at a node down to the sources; those for which there is none go behind the others. Returns how many
    /// have a source.
    fn descend(&self, index: u32, receiver: &Receiver, drawn: &mut [Drawn]) -> usize {
        let node = &self.nodes[index as usize];
        let (bounds, _) = node.bound_sent(receiver);
        let children: [Start; WIDTH] = std::array::from_fn(|child| (f64::from(bounds[child]), node.below[child]));
        self.share_out(&children, receiver, drawn)
    }

    /// The same for those that are drawn at any of some groups and sources, in proportion to what each may send.
    fn share_out(&self, children: &[Start], receiver: &Receiver, drawn: &mut [Drawn]) -> usize {
        let sum: f64 = children.iter().map(|(bound, _)| bound).sum();
        let Some(last) = children.iter().rposition(|(bound, _)| *bound > 0.0) else { return 0 };
        let (mut first, mut kept, mut before) = (0, 0, 0.0);
        for (child, &(bound, below)) in children.iter().enumerate().filter(|(_, (bound, _))| *bound > 0.0) {
            if first == drawn.len() {
                break;
            }
            // Those whose number falls in the share of this child.
            let share = bound / sum;
            let is_here = |drawn: &Drawn| drawn.rest < before + share || child == last;
            let count = drawn[first..].iter().take_while(|drawn| is_here(drawn)).count();
            let here = &mut drawn[first..first + count];
            for drawn in here.iter_mut() {
                drawn.probability *= share;
                drawn.rest = ((drawn.rest - before) / share).clamp(0.0, 1.0 - f64::EPSILON);
            }
            before += share;

            // Down to their sources; those without one stay behind.
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
    /// What each child can send to places, up to a common factor: power, cosines at most, distance squared at least, but not below
    /// the size of the child and the reach of the places. And the square of how near it is: that size over its distance.
    fn bound_sent(&self, receiver: &Receiver) -> (Lanes, Lanes) {
        // One array a quantity and selections instead of branches, so that the children go through the arithmetic side by side.
        let (mut distance_sq, mut to_receiver, mut to_axis) = ([0.0; WIDTH], [0.0; WIDTH], [0.0; WIDTH]);
        for axis in 0..3 {
            for k in 0..WIDTH {
                let towards = self.centre[axis][k] - receiver.point[axis];
                distance_sq[k] += towards * towards;
                to_receiver[k] += towards * receiver.normal[axis];
                to_axis[k] -= towards * self.axis[axis][k];
            }
        }

        // The cosines at both ends, to the direction that suits best among those that differ by the child's radius as seen from the
        // point, and at the sources by the spread too.
        let (mut sent, mut nearness_sq) = ([0.0; WIDTH], [0.0; WIDTH]);
        for k in 0..WIDTH {
            let radius = self.radius[k] + receiver.reach;
            let radius_sq = radius * radius;
            let far_sq = largest(distance_sq[k], radius_sq);
            let sin_sq_half = radius_sq / far_sq;
            let half = (sin_sq_half.sqrt(), (1.0 - sin_sq_half).sqrt());
            let per_distance = 1.0 / far_sq.sqrt();
            let at_receiver = less(angle(to_receiver[k] * per_distance), half);
            let at_sources = less(less(angle(to_axis[k] * per_distance), half), (self.sin_spread[k], self.cos_spread[k]));
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

/// Sine and cosine of the angle in [0, pi] with a cosine that rounding may have left out of [-1, 1].
fn angle(cos: f32) -> (f32, f32) {
    (largest(1.0 - cos * cos, 0.0).sqrt(), cos)
}

/// The sine and cosine of `a - b`, or of 0 if that is negative, for angles in [0, pi] with known sines and cosines.
fn less(a: (f32, f32), b: (f32, f32)) -> (f32, f32) {
    let is_less = a.1 >= b.1;
    let (sin, cos) = (a.0 * b.1 - a.1 * b.0, a.1 * b.1 + a.0 * b.0);
    (if is_less { 0.0 } else { sin }, if is_less { 1.0 } else { cos })
}

/// Two halves along the longest axis of the centres.
fn halves(sources: &mut [Source]) -> (&mut [Source], &mut [Source]) {
    let extent = Aabb::around(sources.iter().map(|source| source.bounds.centre())).extent();
    let axis = (0..3).max_by(|&a, &b| extent[a].total_cmp(&extent[b])).unwrap_or(0);
    let place = |source: &Source| source.bounds.centre()[axis];
    sources.sort_unstable_by(|a, b| place(a).total_cmp(&place(b)).then(a.number.cmp(&b.number)));
    sources.split_at_mut(sources.len().div_ceil(2))
}

impl Default for Group {
    fn default() -> Self {
        Self { bounds: Aabb::EMPTY, axis: DVec3::Z, spread: PI, power: 0.0 }
    }
}

impl Group {
    fn of(source: &Source) -> Self {
        Self { bounds: source.bounds, axis: source.normal, spread: 0.0, power: source.power }
    }

    fn union(self, other: Self) -> Self {
        let (axis, spread) = cone_around(&self, &other);
        Self { bounds: self.bounds.union(other.bounds), axis, spread, power: self.power + other.power }
    }
}

/// A cone around the normals of two groups.
fn cone_around(a: &Group, b: &Group) -> (DVec3, f64) {
    let (wide, narrow) = if a.spread >= b.spread { (a, b) } else { (b, a) };
    let between = wide.axis.dot(narrow.axis).clamp(-1.0, 1.0).acos();
    if between + narrow.spread <= wide.spread {
        return (wide.axis, wide.spread);
    }
    let spread = 0.5 * (between + wide.spread + narrow.spread);
    let aside = (narrow.axis - wide.axis.dot(narrow.axis) * wide.axis).try_normalize();
    match aside.filter(|_| spread < PI) {
        Some(aside) => {
            let turn = spread - wide.spread;
            (turn.cos() * wide.axis + turn.sin() * aside, spread + ANGLE_SLACK)
        }
        None => {
            let around = between + narrow.spread;
            (wide.axis, if around < PI { around.max(wide.spread) } else { PI })
        }
    }
}
