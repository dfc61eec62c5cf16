//! Bounds at a point, by what arrives there: narrower than those of the element that it lies on.
//!
//! Over an element form factors have a range. At a point x they are known but for rounding, with everything that is in the way: the parts
//! of a polygon that x sees follow from the shadows that x sees (`form_factors::blockers`), and Lambert's sum is exact. So
//!
//! ```text
//! E + rho sum_j F_j(x) L_j  <=  B(x)  <=  E + rho sum_j F_j(x) U_j
//! ```
//!
//! over the elements j of all surfaces leaves open what the bounds of these do, once more reflected, and nothing else. Elements are followed
//! down from the surfaces as far as they differ in what they send. Where too much is in the way, or x touches what it sees, form factors
//! have ranges here as well, and they add up to at most 1 (`system`).

use glam::DVec3;

use super::element_bounds::ElementBounds;
use super::enclosure::Enclosure;
use super::form_factors::{Blockers, PointSight};
use super::rounding::rounding;
use crate::geometry::Facet;
use crate::hierarchy::NodeId;
use crate::scene::{Scene, SurfaceId};

/// Elements are followed down while their bounds are farther apart than so many times those of their leaves are in the mean.
const WIDER: f64 = 1.25;

/// But no farther than to where that adds this part of what the point may reflect at most.
const NEGLIGIBLE: f64 = 1.0 / (1 << 13) as f64;

/// Gathers bounds at points.
pub(super) struct PointGather<'a> {
    scene: &'a Scene,
    elements: &'a ElementBounds,
    blockers: Blockers<'a>,
    enclosure: Option<Enclosure<'a>>,
    /// See [`ElementBounds::mean_widths`].
    mean_widths: Vec<f64>,
}

/// An element that a point sees, with the range of its form factor.
struct Seen {
    node: NodeId,
    lower: f64,
    upper: f64,
}

impl<'a> PointGather<'a> {
    pub fn new(scene: &'a Scene, elements: &'a ElementBounds) -> Self {
        let blockers = Blockers::new(scene, elements.hierarchy());
        Self { scene, elements, blockers, enclosure: Enclosure::find(scene), mean_widths: elements.mean_widths() }
    }

    /// Lower and upper radiosities, by channel, at the point of a surface that is nearest to `near` in its plane.
    pub fn at(&self, surface: SurfaceId, near: DVec3) -> Vec<[f64; 2]> {
        // The bounds of the element, which hold whatever is found here.
        let leaf = self.elements.leaf_at(surface, near);
        let (lower, upper) = (self.elements.lower(leaf), self.elements.upper(leaf));
        let of_leaf = lower.iter().zip(upper).map(|(&lower, &upper)| [lower, upper]);
        let material = self.scene.material_of(surface);
        if material.reflectance.iter().all(|&rho| rho == 0.0) {
            return of_leaf.collect();
        }

        // All that it sees.
        let own = self.scene.surface(surface).polygon.facet();
        let x = near - own.height(near) * own.normal;
        let mut seen = Vec::new();
        for source in (0..self.scene.surfaces().len() as u32).map(SurfaceId) {
            if source != surface && !self.add_seen(x, surface, source, leaf, &mut seen) {
                return of_leaf.collect();
            }
        }

        // What arrives, by channel.
        let point = Facet { vertices: &[x], normal: own.normal, area: 0.0, centroid: x, radius: 0.0 };
        let enclosed = self.enclosure.as_ref().is_some_and(|enclosure| enclosure.holds(surface, &point));
        let bounds = of_leaf.enumerate().map(|(channel, [lower, upper])| {
            let [least, most] = self.irradiance(&mut seen, channel, enclosed);
            let (exitance, rho) = (material.exitance[channel], material.reflectance[channel]);
            let widened = rounding(0);
            let lower = lower.max((exitance + rho * least) * (1.0 - widened));
            [lower, upper.min((exitance + rho * most) * (1.0 + widened)).max(lower)]
        });
        bounds.collect()
    }

    /// Appends the elements of a surface that x sees; `false` if x touches it, where form factors have limits alone.
    fn add_seen(&self, x: DVec3, on: SurfaceId, source: SurfaceId, leaf: NodeId, seen: &mut Vec<Seen>) -> bool {
        let sight = match self.blockers.sight_at(x, on, source) {
            PointSight::Nothing => return true,
            PointSight::Touching => return false,
            PointSight::Some(sight) => sight,
        };
        let (hierarchy, exitance) = (self.elements.hierarchy(), &self.scene.material_of(on).exitance);
        let mut waiting = vec![(hierarchy.node_of(source), false)];
        while let Some((node, is_clear)) = waiting.pop() {
            let is_clear = is_clear || sight.is_clear(&hierarchy.facet(node));
            let [lower, upper] = sight.form_factor(&hierarchy.facet(node), is_clear);
            if upper == 0.0 {
                continue;
            }
            let differs = |channel: usize| {
                let width = self.elements.upper(node)[channel] - self.elements.lower(node)[channel];
                let of_leaves = self.mean_widths[node.index() * self.elements.channels() + channel];
                let most = self.elements.upper(leaf)[channel] - exitance[channel];
                width > WIDER * of_leaves && upper * (width - of_leaves) > NEGLIGIBLE * most
            };
            if !hierarchy.is_leaf(node) && (0..self.scene.channels()).any(differs) {
                waiting.extend(hierarchy.children(node).map(|child| (child, is_clear)));
            } else {
                seen.push(Seen { node, lower, upper });
            }
        }
        true
    }

    /// The least and the most that arrives in a channel.
    fn irradiance(&self, seen: &mut [Seen], channel: usize, enclosed: bool) -> [f64; 2] {
        let (dim, bright) = (|node| self.elements.lower(node)[channel], |node| self.elements.upper(node)[channel]);
        let widened = rounding(seen.len());
        let certain: f64 = seen.iter().map(|seen| seen.lower).sum();
        let mut least: f64 = seen.iter().map(|seen| seen.lower * dim(seen.node)).sum();
        let mut most: f64 = seen.iter().map(|seen| seen.lower * bright(seen.node)).sum();

        // What is left of 1 goes to the brightest, or where fronts alone are seen, to the dimmest.
        let mut fill = |left: f64, radiosity: &dyn Fn(NodeId) -> f64, brightest_first: bool| -> f64 {
            seen.sort_by(|a, b| {
                let order = radiosity(a.node).total_cmp(&radiosity(b.node)).then(a.node.cmp(&b.node));
                if brightest_first { order.reverse() } else { order }
            });
            let (mut left, mut sum) = (left, 0.0);
            for Seen { node, lower, upper } in seen.iter() {
                let more = (upper - lower).min(left).max(0.0);
                left -= more;
                sum += more * radiosity(*node);
            }
            sum
        };
        most += fill((1.0 - certain).max(0.0) + widened, &bright, true);
        if enclosed {
            least += fill((1.0 - certain - widened).max(0.0), &dim, false);
        }
        [least * (1.0 - widened), most * (1.0 + widened)]
    }
}
