//! Importance: how much a unit of exitance anywhere adds to what the answer is wanted for.
//!
//! That is a linear functional of the radiosities, `<R, B> = sum R_i B_i`. R is the initial importance: the exposed areas for the
//! power of all surfaces, the part that a camera sees of each leaf for a picture. With `B = E + T B`, T being a sweep over the
//! links, importance solves the adjoint equation
//!
//! ```text
//! Z = R + T' Z       so that      <R, B> = <Z, E>
//! ```
//!
//! (Smits, Arvo, Salesin 1992; Lischinski 1994, equation 5.9.) T pulls radiosities up, gathers over links, pushes irradiance down
//! and reflects. T' applies the transpose of each step in the opposite order, clusters, exposure and noisy transmittances included;
//! so both sides agree to rounding, whatever the links say.
//!
//! With a [`Closure`] B has another exitance, `E + rho (1 - f) H_E`: f is the closure's factor, and H_E the irradiance by emitted
//! light, which it leaves alone.

use super::{Closure, Exposure, Radiosity};
use crate::geometry::Lobes;
use crate::hierarchy::{Hierarchy, NodeId};
use crate::links::LinkSet;
use crate::scene::{Scene, SurfaceId};

/// The importance Z of every node, in units of R: by how much `<R, B>` rises if each point of the node emits 1 W/m^2 more. That of
/// an inner node is the sum over its leaves.
#[derive(Clone, Debug, PartialEq)]
pub struct Importance {
    channels: usize,
    values: Vec<f64>,
}

impl Importance {
    /// The importance of a node, by channel.
    pub fn of(&self, node: NodeId) -> &[f64] {
        &self.values[node.index() * self.channels..][..self.channels]
    }

    /// How many channels each node has.
    pub fn channels(&self) -> usize {
        self.channels
    }
}

/// The adjoint of sweeps: what light travels over, followed against its direction.
pub(crate) struct Adjoint<'a> {
    pub scene: &'a Scene,
    pub hierarchy: &'a Hierarchy,
    pub links: &'a LinkSet,
    pub exposure: &'a Exposure,
    pub closure: Option<&'a Closure>,
    /// Radiosities over the same hierarchy, for the exposed areas of clusters.
    pub radiosity: &'a Radiosity,
}

/// The iteration ends once a sweep adds less than this part of all importance. All later sweeps together would add at most
/// `1 / (1 - rho)` times as much.
const SWEEP_TOLERANCE: f64 = 1e-14;

/// No more sweeps than this, as for radiosities.
const MOST_SWEEPS: u32 = 20_000;

impl Adjoint<'_> {
    /// The importance Z for `initial`, the initial importance R by node and channel, of which only that of leaves counts.
    pub fn importance(&self, initial: &[f64]) -> Importance {
        let channels = self.radiosity.channels();
        let is_leaf = |at: usize| self.hierarchy.is_leaf(NodeId((at / channels) as u32));
        let initial: Vec<f64> = initial.iter().enumerate().map(|(at, r)| if is_leaf(at) { *r } else { 0.0 }).collect();

        // Z = R + T' R + T' T' R + ...: each term is one bounce more.
        let (mut values, mut term) = (initial.clone(), initial);
        for _ in 0..MOST_SWEEPS {
            term = self.sweep(&term);
            values.iter_mut().zip(&term).for_each(|(value, term)| *value += term);
            let sum = |values: &[f64]| values.iter().map(|value| value.abs()).sum::<f64>();
            if sum(&term) <= SWEEP_TOLERANCE * sum(&values) {
                break;
            }
        }

        // Inner nodes have the sums of their leaves.
        for node in self.hierarchy.ids().rev().filter(|&node| node != NodeId::ROOT) {
            let parent = self.hierarchy.node(node).parent;
            for channel in 0..channels {
                values[parent.index() * channels + channel] += values[node.index() * channels + channel];
            }
        }
        Importance { channels, values }
    }

    /// `T' z`: the worth of a unit of radiosity of each leaf, if a unit of radiosity of the leaves that it lights is worth `z`.
    fn sweep(&self, z: &[f64]) -> Vec<f64> {
        let irradiance = self.worth_of_irradiance(z);
        let radiosity = self.worth_of_radiosity(&irradiance);
        self.worth_of_leaves(radiosity)
    }

    /// Transposed reflection and push: the worth of a unit of irradiance of each node.
    fn worth_of_irradiance(&self, z: &[f64]) -> Worth {
        let (hierarchy, channels) = (self.hierarchy, self.radiosity.channels());
        let mut worth = self.nothing();
        for node in hierarchy.ids().rev() {
            // A leaf reflects.
            let own = node.index() * channels..(node.index() + 1) * channels;
            if hierarchy.is_leaf(node) {
                let reflectance = &self.scene.material_of(SurfaceId(hierarchy.node(node).surface)).reflectance;
                let factor = self.closure.map_or(1.0, |closure| closure.factor(node));
                for (at, rho) in own.clone().zip(reflectance) {
                    worth.values[at] = factor * rho * z[at];
                }
            }

            // What arrives at a node arrives at all its children.
            let Some(parent) = hierarchy.parent(node) else { continue };
            for (channel, at) in own.enumerate() {
                let above = parent.index() * channels + channel;
                if hierarchy.is_cluster(node) {
                    let of_node = worth.lobes[at];
                    worth.lobes[above] += of_node;
                } else if hierarchy.is_cluster(parent) {
                    worth.lobes[above].add(worth.values[at], hierarchy.normal(node));
                } else {
                    worth.values[above] += worth.values[at];
                }
            }
        }
        worth
    }

    /// Transposed gather: the worth of a unit of radiosity of each node to the receivers of its links; of a cluster by the
    /// direction in which the light leaves.
    fn worth_of_radiosity(&self, irradiance: &Worth) -> Worth {
        let Self { hierarchy, exposure, .. } = *self;
        let channels = self.radiosity.channels();
        let mut worth = self.nothing();
        let mut arriving = vec![0.0; channels];
        for (receiver, link) in self.links.iter() {
            // The worth of a unit that arrives.
            let own = receiver.index() * channels..(receiver.index() + 1) * channels;
            if hierarchy.is_cluster(receiver) {
                let direction = hierarchy.direction(receiver, link.source);
                let Some(exposed) = self.radiosity.exposed_area(receiver, direction) else { continue };
                let concentration = hierarchy.area(receiver) / exposed;
                arriving.iter_mut().zip(&irradiance.lobes[own]).for_each(|(worth, of)| *worth = concentration * of.at(direction));
            } else {
                arriving.copy_from_slice(&irradiance.values[own]);
                exposure.concentrate(receiver, &mut arriving);
            }

            // The worth of a unit that leaves the source.
            let form_factor = link.occluded_form_factor();
            let at_source = link.source.index() * channels;
            if hierarchy.is_cluster(link.source) {
                let direction = hierarchy.direction(link.source, receiver);
                let Some(area) = self.radiosity.exposed_area(link.source, direction) else { continue };
                for (shown, worth) in worth.lobes[at_source..].iter_mut().zip(&arriving) {
                    shown.add(form_factor * worth / area, direction);
                }
            } else {
                worth.values[at_source..].iter_mut().zip(&arriving).for_each(|(shown, worth)| *shown += form_factor * worth);
            }
        }
        worth
    }

    /// Transposed pull: hands the worth of nodes down to their leaves, to children by exposed area.
    fn worth_of_leaves(&self, radiosity: Worth) -> Vec<f64> {
        let Self { hierarchy, exposure, .. } = *self;
        let channels = self.radiosity.channels();
        let Worth { mut values, mut lobes } = radiosity;
        for node in hierarchy.ids().filter(|&node| !hierarchy.is_leaf(node)) {
            let exposed_area = |child: NodeId| hierarchy.area(child) * exposure.of(child);
            let whole: f64 = hierarchy.children(node).map(exposed_area).sum();
            for child in hierarchy.children(node).filter(|_| whole > 0.0) {
                for channel in 0..channels {
                    let (above, own) = (node.index() * channels + channel, child.index() * channels + channel);
                    if hierarchy.is_cluster(child) {
                        let from_above = lobes[above];
                        lobes[own] += from_above;
                    } else if hierarchy.is_cluster(node) {
                        values[own] += exposed_area(child) * lobes[above].at(hierarchy.normal(child));
                    } else {
                        values[own] += values[above] * exposed_area(child) / whole;
                    }
                }
            }
        }
        for node in hierarchy.ids().filter(|&node| !hierarchy.is_leaf(node)) {
            values[node.index() * channels..][..channels].fill(0.0);
        }
        values
    }

    fn nothing(&self) -> Worth {
        let channels = self.radiosity.channels();
        let (nodes, clusters) = (self.hierarchy.len(), self.hierarchy.cluster_count());
        Worth { values: vec![0.0; channels * nodes], lobes: vec![Lobes::default(); channels * clusters] }
    }
}

/// The worth of a unit of irradiance, or of radiosity, of every node, by channel.
struct Worth {
    /// Of each surface and element; clusters have none.
    values: Vec<f64>,
    /// Of each cluster, by direction.
    lobes: Vec<Lobes>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Polygon, sampling};
    use crate::links::Link;
    use crate::scene::{Material, Sides};
    use crate::sweep::{LightIrradiance, Reflection, gather, push_pull};
    use crate::transmittance::Rays;
    use crate::visibility::{Backend, OccluderMesh, build};

    /// Numbers in [0, 1) that only depend on the seed.
    struct Random(u64);

    impl Random {
        fn unit(&mut self) -> f64 {
            self.0 += 1;
            sampling::unit(sampling::hash(self.0, 7))
        }

        fn below(&mut self, count: usize) -> usize {
            (self.unit() * count as f64) as usize
        }
    }

    /// Squares anywhere, one of which stands on another, in two channels; some are split.
    fn scene(random: &mut Random) -> (Scene, Hierarchy) {
        let mut faces = vec![[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]];
        faces.push([[0.2, 0.2, 0.0], [0.2, 0.8, 0.0], [0.8, 0.8, 0.0], [0.8, 0.2, 0.0]]);
        for _ in 0..12 {
            let [x, y, z] = [random.unit(), random.unit(), 0.2 + random.unit()];
            let lift = random.unit();
            faces.push([[x, y, z], [x + 0.3, y, z], [x + 0.3, y + 0.2, z + lift], [x, y + 0.2, z + lift]]);
        }
        let materials: Vec<Material> = (0..faces.len())
            .map(|k| Material {
                name: format!("m{k}"),
                reflectance: if k == 0 { vec![0.0, 0.0] } else { vec![random.unit(), 0.5 * random.unit()] },
                exitance: if k == 0 { vec![9.0, 7.0] } else { vec![random.unit(), 3.0 * random.unit()] },
            })
            .collect();
        let polygons = faces.iter().zip(0..).map(|(corners, k)| (Polygon::new(corners).unwrap(), k, k)).collect();
        let scene = Scene::new(2, materials, polygons, Sides::Front).unwrap();
        let mut hierarchy = Hierarchy::new(&scene);
        for _ in 0..10 {
            let node = NodeId(random.below(hierarchy.len()) as u32);
            if hierarchy.is_leaf(node) {
                hierarchy.split(node);
            }
        }
        (scene, hierarchy)
    }

    /// Links between any nodes with any numbers on them, below what would make sweeps diverge.
    fn any_links(random: &mut Random, hierarchy: &Hierarchy) -> LinkSet {
        let mut links = Vec::new();
        let emitter = hierarchy.node_of(SurfaceId(0));
        for receiver in hierarchy.ids() {
            // Lobes are negative in some directions, and sweeps keep radiosity at 0 or above: so every surface sees the emitter.
            if hierarchy.surface_of(receiver).is_some_and(|surface| hierarchy.node_of(surface) == receiver && receiver != emitter) {
                links.push((receiver, Link { form_factor: 0.1, source: emitter, transmittance: 1.0, seen: 0.0 }));
            }
            for _ in 0..random.below(5) {
                let source = NodeId(random.below(hierarchy.len()) as u32);
                let (form_factor, transmittance) = (0.03 * random.unit(), (1.5 * random.unit()) as f32);
                if source != receiver {
                    links.push((receiver, Link { form_factor, source, transmittance, seen: 0.0 }));
                }
            }
        }
        LinkSet::new(hierarchy.len(), &links, Vec::new())
    }

    #[test]
    fn importance_of_exitance_is_importance_of_radiosity_over_any_links() {
        for seed in 0..20 {
            let mut random = Random(1000 * seed);
            let (scene, hierarchy) = scene(&mut random);
            let visibility = build(Backend::BruteForce, &OccluderMesh::of_scene(&scene)).unwrap();
            let mut exposure = Exposure::default();
            exposure.grow(&scene, &hierarchy, &Rays::new(&*visibility, &scene), seed, &|| false);
            let links = any_links(&mut random, &hierarchy);
            let with_closure = Closure::of_estimates(&scene, &hierarchy, &links, &exposure);
            let initial: Vec<f64> = (0..2 * hierarchy.len()).map(|_| random.unit()).collect();

            for closure in [None, Some(&with_closure)] {
                // <R, B>, B by sweeps.
                let mut radiosity = Radiosity::emitted(&scene, &hierarchy, &exposure);
                for _ in 0..400 {
                    let mut irradiance = gather(&hierarchy, &links, &exposure, &radiosity);
                    let reflection = Reflection { scene: &scene, closure, lights: &LightIrradiance::default() };
                    push_pull(&reflection, &hierarchy, &exposure, &mut irradiance, &mut radiosity);
                }
                let leaves = || hierarchy.ids().filter(|&node| hierarchy.is_leaf(node));
                let of_leaf = |leaf: NodeId| &initial[2 * leaf.index()..][..2];
                let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
                let by_radiosity: f64 = leaves().map(|leaf| product(of_leaf(leaf), radiosity.of(leaf))).sum();

                // <Z, E>.
                let (scene, hierarchy, links, exposure) = (&scene, &hierarchy, &links, &exposure);
                let adjoint = Adjoint { scene, hierarchy, links, exposure, closure, radiosity: &radiosity };
                let importance = adjoint.importance(&initial);
                let exitance = |leaf: NodeId| {
                    let material = scene.material_of(SurfaceId(hierarchy.node(leaf).surface));
                    closure.map_or(material.exitance.clone(), |closure| closure.effective_exitance(leaf, material))
                };
                let by_importance: f64 = leaves().map(|leaf| product(importance.of(leaf), &exitance(leaf))).sum();
                let off = (by_importance / by_radiosity - 1.0).abs();
                assert!(off < 1e-12, "seed {seed}, closure {}: {by_importance}, not {by_radiosity}", closure.is_some());
                let emitted: f64 = leaves().map(|leaf| product(of_leaf(leaf), &exitance(leaf))).sum();
                assert!(by_radiosity > 1.01 * emitted, "seed {seed}: hardly anything is reflected");

                // Inner nodes have the sums of their leaves.
                let whole = leaves().map(|leaf| importance.of(leaf)[1]).sum::<f64>();
                assert!((importance.of(NodeId::ROOT)[1] / whole - 1.0).abs() < 1e-12);
            }
        }
    }
}
