//! Draws lamps from a tree, by what they may bring to a place: the cost of a draw grows with the logarithm of their number.
//!
//! At every node the descent goes left or right with probabilities in proportion to a bound on what each side can bring (box, cone
//! of normals, power; after Conty Estevez and Kulla 2018). A lamp that can bring light at all is drawn with a probability above 0,
//! so what is divided by that probability is without bias.

use std::f64::consts::PI;

use glam::DVec3;

use crate::geometry::Aabb;
use crate::scene::{Scene, SurfaceId};

/// Angles and cosines are widened by this much against rounding.
const SLACK: f64 = 1e-6;

/// A lamp or several.
struct Node {
    centre: DVec3,
    radius: f64,
    /// All normals are within an angle of `axis`, the spread.
    axis: DVec3,
    spread: Spread,
    /// Area times the exitance of the brightest channel, in W.
    power: f64,
    /// The lamp, or the second child; the first child of a node follows it.
    below: Below,
}

/// An angle in [0, pi], in radians, with what is asked of it at every draw.
#[derive(Clone, Copy)]
struct Spread {
    angle: f64,
    cos: f64,
    sin: f64,
}

enum Below {
    Lamp(SurfaceId),
    Second(usize),
}

/// A binary tree over lamps.
pub(super) struct LampTree {
    nodes: Vec<Node>,
}

/// A lamp that was drawn.
pub(super) struct DrawnLamp {
    pub lamp: SurfaceId,
    pub probability: f64,
    /// What is left of the number that drew it: uniform in [0, 1) again.
    pub rest: f64,
}

impl Spread {
    fn new(angle: f64) -> Self {
        let (sin, cos) = angle.min(PI).sin_cos();
        Self { angle, cos, sin }
    }
}

impl LampTree {
    pub fn new(scene: &Scene, lamps: &[SurfaceId]) -> Self {
        let mut tree = Self { nodes: Vec::with_capacity(2 * lamps.len()) };
        let mut order = lamps.to_vec();
        tree.add(scene, &mut order);
        tree
    }

    /// Appends the tree over `lamps`; returns its root and box.
    fn add(&mut self, scene: &Scene, lamps: &mut [SurfaceId]) -> (usize, Aabb) {
        let index = self.nodes.len();
        if let [lamp] = *lamps {
            let (polygon, exitance) = (&scene.surface(lamp).polygon, &scene.material_of(lamp).exitance);
            let (facet, bounds) = (polygon.facet(), polygon.bounds());
            let power = facet.area * exitance.iter().copied().fold(0.0, f64::max);
            let (centre, radius) = (bounds.centre(), 0.5 * bounds.diagonal());
            self.nodes.push(Node { centre, radius, axis: facet.normal, spread: Spread::new(0.0), power, below: Below::Lamp(lamp) });
            return (index, bounds);
        }

        // Halve along the longest axis of the centres.
        let centre = |lamp: SurfaceId| scene.surface(lamp).polygon.bounds().centre();
        let extent = Aabb::around(lamps.iter().map(|&lamp| centre(lamp))).extent();
        let axis = (0..3).max_by(|&a, &b| extent[a].total_cmp(&extent[b])).unwrap_or(0);
        lamps.sort_unstable_by(|&a, &b| centre(a)[axis].total_cmp(&centre(b)[axis]).then(a.cmp(&b)));
        let (left, right) = lamps.split_at_mut(lamps.len() / 2);

        // The node comes before its children, but is known only after them.
        self.nodes.push(Node {
            centre: DVec3::ZERO,
            radius: 0.0,
            axis: DVec3::Z,
            spread: Spread::new(PI),
            power: 0.0,
            below: Below::Second(0),
        });
        let ((first, left), (second, right)) = (self.add(scene, left), self.add(scene, right));
        let bounds = left.union(right);
        let (axis, spread) = cone_around(&self.nodes[first], &self.nodes[second]);
        let power = self.nodes[first].power + self.nodes[second].power;
        let (centre, radius) = (bounds.centre(), 0.5 * bounds.diagonal());
        self.nodes[index] = Node { centre, radius, axis, spread, power, below: Below::Second(second) };
        (index, bounds)
    }

    /// Draws a lamp for a point with a normal by each of `numbers`, rising in [0, 1), and appends them to `drawn`; none where no
    /// lamp on the way can bring anything. Every node on the way is looked at once, however many numbers pass through it.
    pub fn draw(&self, point: DVec3, normal: DVec3, numbers: impl Iterator<Item = f64>, drawn: &mut Vec<DrawnLamp>) {
        let first = drawn.len();
        drawn.extend(numbers.map(|rest| DrawnLamp { lamp: SurfaceId(0), probability: 1.0, rest }));
        let kept = self.descend(0, point, normal, &mut drawn[first..]);
        drawn.truncate(first + kept);
    }

    /// Brings those that are drawn at a node down to the lamps; those for which there is none go behind the others. Returns how many
    /// have a lamp.
    fn descend(&self, index: usize, point: DVec3, normal: DVec3, drawn: &mut [DrawnLamp]) -> usize {
        let second = match self.nodes[index].below {
            _ if drawn.is_empty() => return 0,
            Below::Lamp(lamp) => {
                drawn.iter_mut().for_each(|drawn| drawn.lamp = lamp);
                return drawn.len();
            }
            Below::Second(second) => second,
        };
        let [first_bound, second_bound] = [index + 1, second].map(|child| self.nodes[child].bound_sent(point, normal));
        let sum = first_bound + second_bound;
        if sum <= 0.0 {
            return 0;
        }
        let share = first_bound / sum;
        let to_first = drawn.partition_point(|drawn| drawn.rest < share);
        let (to_first, to_second) = drawn.split_at_mut(to_first);
        for drawn in to_first.iter_mut() {
            drawn.probability *= share;
            drawn.rest = (drawn.rest / share).clamp(0.0, 1.0 - f64::EPSILON);
        }
        for drawn in to_second.iter_mut() {
            drawn.probability *= 1.0 - share;
            drawn.rest = ((drawn.rest - share) / (1.0 - share)).clamp(0.0, 1.0 - f64::EPSILON);
        }
        let kept_of_first = self.descend(index + 1, point, normal, to_first);
        let kept_of_second = self.descend(second, point, normal, to_second);
        if kept_of_first < to_first.len() {
            let behind_first = to_first.len();
            drawn[kept_of_first..behind_first + kept_of_second].rotate_left(behind_first - kept_of_first);
        }
        kept_of_first + kept_of_second
    }
}

impl Node {
    /// What the lamps can send to a point, up to a common factor: power, cosines at most, distance squared at least, but not below
    /// the size of the node.
    fn bound_sent(&self, point: DVec3, normal: DVec3) -> f64 {
        let towards = self.centre - point;
        let distance_sq = towards.length_squared();
        if distance_sq <= self.radius * self.radius {
            return self.power / (self.radius * self.radius);
        }

        // The cosines at both ends, to the direction that suits best among those that differ by the node's radius as seen from the
        // point, and at the lamps by the spread too.
        let distance = distance_sq.sqrt();
        let sin_half = self.radius / distance;
        let half = (sin_half, (1.0 - sin_half * sin_half).sqrt());
        let angle_to = |axis: DVec3, direction: DVec3| {
            let cos = (axis.dot(direction) / distance).clamp(-1.0, 1.0);
            ((1.0 - cos * cos).sqrt(), cos)
        };
        let at_receiver = less(angle_to(normal, towards), half);
        let at_lamps = less(less(angle_to(self.axis, -towards), half), (self.spread.sin, self.spread.cos));
        self.power * (at_receiver.1 + SLACK).max(0.0) * (at_lamps.1 + SLACK).max(0.0) / distance_sq
    }
}

/// The sine and cosine of `a - b`, or of 0 if that is negative, for angles in [0, pi] with known sines and cosines.
fn less(a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
    if a.1 >= b.1 { (0.0, 1.0) } else { (a.0 * b.1 - a.1 * b.0, a.1 * b.1 + a.0 * b.0) }
}

/// A cone around the normals of two nodes.
fn cone_around(a: &Node, b: &Node) -> (DVec3, Spread) {
    let (wide, narrow) = if a.spread.angle >= b.spread.angle { (a, b) } else { (b, a) };
    let between = wide.axis.dot(narrow.axis).clamp(-1.0, 1.0).acos();
    if between + narrow.spread.angle <= wide.spread.angle {
        return (wide.axis, wide.spread);
    }
    let spread = 0.5 * (between + wide.spread.angle + narrow.spread.angle);
    let aside = (narrow.axis - wide.axis.dot(narrow.axis) * wide.axis).try_normalize();
    match aside.filter(|_| spread < PI) {
        Some(aside) => {
            let turn = spread - wide.spread.angle;
            (turn.cos() * wide.axis + turn.sin() * aside, Spread::new(spread + SLACK))
        }
        None => {
            let around = between + narrow.spread.angle;
            (wide.axis, Spread::new(if around < PI { around.max(wide.spread.angle) } else { PI }))
        }
    }
}
