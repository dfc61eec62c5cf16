//! Draws lamps from a tree, by what they may bring to a place: the cost of a draw grows with the logarithm of their number.
//!
//! At every node the descent goes to one of up to four children with probabilities in proportion to a bound on what each can bring (box,
//! cone of normals, power; after Conty Estevez and Kulla 2018). A lamp that can bring light at all is drawn with a probability above
//! 0, so what is divided by that probability is without bias.
//!
//! Of a group that is near its bound says little: a lamp in it may be nearer than its size. So descents start below all groups that
//! are near, all together, and of single lamps that are near it is known exactly what they send.
//!
//! The bounds of four children are computed side by side, in f32: it is the probabilities that were drawn by that count, not how
//! exact they are. Lengths are in radii of the tree and powers in parts of its power, so no scene is too large or too dim for that.

use std::f64::consts::PI;

use glam::DVec3;

use crate::geometry::Aabb;
use crate::scene::{Scene, SurfaceId};

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

/// Up to four groups of lamps; places that are left over have no power.
struct Node {
    /// The middle of each group's box, and the square of its radius.
    centre: [Lanes; 3],
    radius_sq: Lanes,
    /// All normals are within an angle of `axis`, the spread, in [0, pi].
    axis: [Lanes; 3],
    cos_spread: Lanes,
    sin_spread: Lanes,
    /// Area times the exitance of the brightest channel.
    power: Lanes,
    below: [Below; WIDTH],
}

/// A group or a lamp, with what it may send, up to a common factor.
pub(super) type Start = (f64, Below);

/// What a child is.
#[derive(Clone, Copy)]
pub(super) enum Below {
    Lamp(SurfaceId),
    Node(u32),
}

impl Node {
    const EMPTY: Self = Self {
        centre: [[0.0; WIDTH]; 3],
        radius_sq: [1.0; WIDTH],
        axis: [[0.0; WIDTH]; 3],
        cos_spread: [1.0; WIDTH],
        sin_spread: [0.0; WIDTH],
        power: [0.0; WIDTH],
        below: [Below::Node(0); WIDTH],
    };
}

/// A tree over lamps.
pub(super) struct LampTree {
    nodes: Vec<Node>,
    /// The frame of the nodes.
    centre: DVec3,
    radius: f64,
    power: f64,
}

/// A lamp that was drawn.
pub(super) struct DrawnLamp {
    pub lamp: SurfaceId,
    pub probability: f64,
    /// What is left of the number that drew it: uniform in [0, 1) again.
    pub rest: f64,
}

/// A place and its normal, in the frame of a tree.
struct Receiver {
    point: [f32; 3],
    normal: [f32; 3],
}

/// What is known of a group of lamps.
struct Group {
    bounds: Aabb,
    /// All normals are within `spread` of `axis`, in radians.
    axis: DVec3,
    spread: f64,
    /// In W.
    power: f64,
}

impl LampTree {
    pub fn new(scene: &Scene, lamps: &[SurfaceId]) -> Self {
        let Group { bounds, power, .. } =
            lamps.iter().map(|&lamp| Group::of_lamp(scene, lamp)).reduce(Group::union).unwrap_or_default();
        let mut tree = Self { nodes: Vec::new(), centre: bounds.centre(), radius: 0.5 * bounds.diagonal(), power };
        tree.add(scene, &mut lamps.to_vec());
        tree
    }

    /// Appends the tree over `lamps`; returns its root and what is known of it.
    fn add(&mut self, scene: &Scene, lamps: &mut [SurfaceId]) -> (Below, Group) {
        let index = self.nodes.len();
        self.nodes.push(Node::EMPTY);
        let (left, right) = halves(scene, lamps);
        let quarters = [left, right].into_iter().flat_map(|half| match half.len() {
            0 | 1 => [half, &mut []],
            _ => halves(scene, half).into(),
        });
        let mut whole: Option<Group> = None;
        for (child, lamps) in quarters.filter(|lamps| !lamps.is_empty()).enumerate() {
            let (below, group) = match *lamps {
                [lamp] => (Below::Lamp(lamp), Group::of_lamp(scene, lamp)),
                _ => self.add(scene, lamps),
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
        node.radius_sq[child] = ((radius * radius) as f32).max(f32::MIN_POSITIVE);
        (node.cos_spread[child], node.sin_spread[child]) = (cos as f32, sin as f32);
        node.power[child] = ((group.power / self.power) as f32).max(f32::MIN_POSITIVE);
        node.below[child] = below;
    }

    /// Draws a lamp for a point with a normal by each of `numbers`, rising in [0, 1), and appends them to `drawn`; none where no
    /// lamp on the way can bring anything. Every node on the way is looked at once, however many numbers pass through it.
    /// `unoccluded` is the irradiance that a lamp would bring if nothing were in between, in W/m^2 in its brightest channel.
    pub fn draw(
        &self,
        point: DVec3,
        normal: DVec3,
        unoccluded: impl Fn(SurfaceId) -> f64,
        numbers: impl Iterator<Item = f64>,
        starts: &mut Vec<Start>,
        drawn: &mut Vec<DrawnLamp>,
    ) {
        let receiver =
            Receiver { point: ((point - self.centre) / self.radius).as_vec3().to_array(), normal: normal.as_vec3().to_array() };
        let in_units_of_bounds = PI * self.radius * self.radius / self.power;
        starts.clear();
        self.collect_starts(0, &receiver, &|lamp| in_units_of_bounds * unoccluded(lamp), starts);

        let first = drawn.len();
        drawn.extend(numbers.map(|rest| DrawnLamp { lamp: SurfaceId(0), probability: 1.0, rest }));
        let kept = self.share_out(starts, &receiver, &mut drawn[first..]);
        drawn.truncate(first + kept);
    }

    /// Appends what descents start from: the children of a node, or theirs where they are near.
    fn collect_starts(&self, index: u32, receiver: &Receiver, sent: &impl Fn(SurfaceId) -> f64, starts: &mut Vec<Start>) {
        let node = &self.nodes[index as usize];
        let (bounds, nearness_sq) = node.bound_sent(receiver);
        for child in (0..WIDTH).filter(|&child| bounds[child] > 0.0) {
            match node.below[child] {
                Below::Node(index) if nearness_sq[child] > NEAR_SQ => self.collect_starts(index, receiver, sent, starts),
                Below::Lamp(lamp) if nearness_sq[child] > NEAR_SQ => starts.push((sent(lamp), node.below[child])),
                below => starts.push((f64::from(bounds[child]), below)),
            }
        }
    }

    /// Brings those that are drawn at a node down to the lamps; those for which there is none go behind the others. Returns how many
    /// have a lamp.
    fn descend(&self, index: u32, receiver: &Receiver, drawn: &mut [DrawnLamp]) -> usize {
        let node = &self.nodes[index as usize];
        let (bounds, _) = node.bound_sent(receiver);
        let children: [Start; WIDTH] = std::array::from_fn(|child| (f64::from(bounds[child]), node.below[child]));
        self.share_out(&children, receiver, drawn)
    }

    /// The same for those that are drawn at any of some groups and lamps, in proportion to what each may send.
    fn share_out(&self, children: &[Start], receiver: &Receiver, drawn: &mut [DrawnLamp]) -> usize {
        let sum: f64 = children.iter().map(|(bound, _)| bound).sum();
        let Some(last) = children.iter().rposition(|(bound, _)| *bound > 0.0) else { return 0 };
        let (mut first, mut kept, mut before) = (0, 0, 0.0);
        for (child, &(bound, below)) in children.iter().enumerate().filter(|(_, (bound, _))| *bound > 0.0) {
            // Those whose number falls in the share of this child.
            let share = bound / sum;
            let is_here = |drawn: &DrawnLamp| drawn.rest < before + share || child == last;
            let count = drawn[first..].iter().take_while(|drawn| is_here(drawn)).count();
            let here = &mut drawn[first..first + count];
            for drawn in here.iter_mut() {
                drawn.probability *= share;
                drawn.rest = ((drawn.rest - before) / share).clamp(0.0, 1.0 - f64::EPSILON);
            }
            before += share;

            // Down to their lamps; those without one stay behind.
            let found = match below {
                _ if count == 0 => continue,
                Below::Lamp(lamp) => {
                    here.iter_mut().for_each(|drawn| drawn.lamp = lamp);
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
    /// What each child can send to a place, up to a common factor: power, cosines at most, distance squared at least, but not below
    /// the size of the child. And the square of how near it is: its radius over its distance.
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
        // point, and at the lamps by the spread too.
        let (mut sent, mut nearness_sq) = ([0.0; WIDTH], [0.0; WIDTH]);
        for k in 0..WIDTH {
            let far_sq = largest(distance_sq[k], self.radius_sq[k]);
            let sin_sq_half = self.radius_sq[k] / far_sq;
            let half = (sin_sq_half.sqrt(), (1.0 - sin_sq_half).sqrt());
            let per_distance = 1.0 / far_sq.sqrt();
            let at_receiver = less(angle(to_receiver[k] * per_distance), half);
            let at_lamps = less(less(angle(to_axis[k] * per_distance), half), (self.sin_spread[k], self.cos_spread[k]));
            let cosines = largest(at_receiver.1 + SLACK, 0.0) * largest(at_lamps.1 + SLACK, 0.0);
            let is_inside = distance_sq[k] <= self.radius_sq[k];
            sent[k] = self.power[k] * if is_inside { 1.0 } else { cosines } / far_sq;
            nearness_sq[k] = self.radius_sq[k] / largest(distance_sq[k], f32::MIN_POSITIVE);
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
fn halves<'a>(scene: &Scene, lamps: &'a mut [SurfaceId]) -> (&'a mut [SurfaceId], &'a mut [SurfaceId]) {
    let centre = |lamp: SurfaceId| scene.surface(lamp).polygon.bounds().centre();
    let extent = Aabb::around(lamps.iter().map(|&lamp| centre(lamp))).extent();
    let axis = (0..3).max_by(|&a, &b| extent[a].total_cmp(&extent[b])).unwrap_or(0);
    lamps.sort_unstable_by(|&a, &b| centre(a)[axis].total_cmp(&centre(b)[axis]).then(a.cmp(&b)));
    lamps.split_at_mut(lamps.len().div_ceil(2))
}

impl Default for Group {
    fn default() -> Self {
        Self { bounds: Aabb::EMPTY, axis: DVec3::Z, spread: PI, power: 0.0 }
    }
}

impl Group {
    fn of_lamp(scene: &Scene, lamp: SurfaceId) -> Self {
        let polygon = &scene.surface(lamp).polygon;
        let brightest = scene.material_of(lamp).exitance.iter().copied().fold(0.0, f64::max);
        let facet = polygon.facet();
        Self { bounds: polygon.bounds(), axis: facet.normal, spread: 0.0, power: facet.area * brightest }
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
