//! Draws lamps from a tree, by what they may bring to a place: the cost of a draw grows with the logarithm of their number.
//!
//! At every node the descent goes left or right with probabilities in proportion to a bound on what each side can bring (box, cone
//! of normals, power; after Conty Estevez and Kulla 2018). A lamp that can bring light at all is drawn with a probability above 0,
//! so what is divided by that probability is without bias.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec3;

use crate::geometry::Aabb;
use crate::scene::{Scene, SurfaceId};

/// Angles are widened by this much against rounding.
const SLACK: f64 = 1e-6;

/// A lamp or several.
struct Node {
    centre: DVec3,
    radius: f64,
    /// All normals are within `spread` of `axis`.
    axis: DVec3,
    spread: f64,
    /// Area times the exitance of the brightest channel, in W.
    power: f64,
    /// The lamp, or the second child; the first child of a node follows it.
    below: Below,
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
            self.nodes.push(Node { centre, radius, axis: facet.normal, spread: 0.0, power, below: Below::Lamp(lamp) });
            return (index, bounds);
        }

        // Halve along the longest axis of the centres.
        let centre = |lamp: SurfaceId| scene.surface(lamp).polygon.bounds().centre();
        let extent = Aabb::around(lamps.iter().map(|&lamp| centre(lamp))).extent();
        let axis = (0..3).max_by(|&a, &b| extent[a].total_cmp(&extent[b])).unwrap_or(0);
        lamps.sort_unstable_by(|&a, &b| centre(a)[axis].total_cmp(&centre(b)[axis]).then(a.cmp(&b)));
        let (left, right) = lamps.split_at_mut(lamps.len() / 2);

        // The node comes before its children, but is known only after them.
        self.nodes.push(Node { centre: DVec3::ZERO, radius: 0.0, axis: DVec3::Z, spread: PI, power: 0.0, below: Below::Second(0) });
        let ((first, left), (second, right)) = (self.add(scene, left), self.add(scene, right));
        let bounds = left.union(right);
        let (axis, spread) = cone_around(&self.nodes[first], &self.nodes[second]);
        let power = self.nodes[first].power + self.nodes[second].power;
        let (centre, radius) = (bounds.centre(), 0.5 * bounds.diagonal());
        self.nodes[index] = Node { centre, radius, axis, spread, power, below: Below::Second(second) };
        (index, bounds)
    }

    /// Draws a lamp for a point with a normal by the number `u`, uniform in [0, 1); `None` if no lamp on the way can bring
    /// anything.
    pub fn draw(&self, point: DVec3, normal: DVec3, u: f64) -> Option<DrawnLamp> {
        let (mut index, mut probability, mut rest) = (0, 1.0, u);
        loop {
            let second = match self.nodes[index].below {
                Below::Lamp(lamp) => return Some(DrawnLamp { lamp, probability, rest }),
                Below::Second(second) => second,
            };
            let [first_bound, second_bound] = [index + 1, second].map(|child| self.nodes[child].bound_sent(point, normal));
            let sum = first_bound + second_bound;
            if sum <= 0.0 {
                return None;
            }
            let share = first_bound / sum;
            (index, rest, probability) = if rest < share {
                (index + 1, rest / share, probability * share)
            } else {
                (second, (rest - share) / (1.0 - share), probability * (1.0 - share))
            };
            rest = rest.clamp(0.0, 1.0 - f64::EPSILON);
        }
    }
}

impl Node {
    /// What the lamps can send to a point, up to a common factor: power, cosines at most, distance squared at least, but not below
    /// the size of the node.
    fn bound_sent(&self, point: DVec3, normal: DVec3) -> f64 {
        let towards = self.centre - point;
        let distance = towards.length();
        let (at_receiver, at_lamps) = if distance <= self.radius {
            (0.0, 0.0)
        } else {
            let half = (self.radius / distance).asin() + SLACK;
            let angle = |a: DVec3, b: DVec3| (a.dot(b) / distance).clamp(-1.0, 1.0).acos();
            (angle(normal, towards) - half, angle(self.axis, -towards) - half - self.spread)
        };
        let cosine = |angle: f64| if angle < FRAC_PI_2 { angle.max(0.0).cos() } else { 0.0 };
        self.power * cosine(at_receiver) * cosine(at_lamps) / distance.max(self.radius).powi(2)
    }
}

/// A cone around the normals of two nodes.
fn cone_around(a: &Node, b: &Node) -> (DVec3, f64) {
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
            (turn.cos() * wide.axis + turn.sin() * aside, spread + SLACK)
        }
        None => (wide.axis, if between + narrow.spread < PI { (between + narrow.spread).max(wide.spread) } else { PI }),
    }
}
