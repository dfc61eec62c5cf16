//! Power by surface: what is emitted, arrives and is absorbed.

use super::report::Powers;
use super::solution::Solution;
use crate::scene::SurfaceId;
use crate::sweep::Closure;

/// The power of one or several surfaces, by channel, in W.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Flux {
    /// Their area in m^2, with what something stands on.
    pub area: f64,
    /// What they emit.
    pub emitted: Vec<f64>,
    /// What arrives.
    pub incident: Vec<f64>,
    /// What of that is not reflected.
    pub absorbed: Vec<f64>,
}

impl Flux {
    /// None at all.
    pub fn none(channels: usize) -> Self {
        Self { area: 0.0, emitted: vec![0.0; channels], incident: vec![0.0; channels], absorbed: vec![0.0; channels] }
    }

    /// Adds that of other surfaces.
    pub fn add(&mut self, other: &Self) {
        self.area += other.area;
        let pairs =
            [(&mut self.emitted, &other.emitted), (&mut self.incident, &other.incident), (&mut self.absorbed, &other.absorbed)];
        for (sum, of_other) in pairs {
            sum.iter_mut().zip(of_other).for_each(|(sum, power)| *sum += power);
        }
    }

    /// What is absorbed less what is emitted, by channel: what heats, if positive.
    pub fn net(&self) -> impl Iterator<Item = f64> {
        self.absorbed.iter().zip(&self.emitted).map(|(absorbed, emitted)| absorbed - emitted)
    }
}

impl Solution {
    /// The power of each surface. Where the solution has a lit mesh it is the integral of that, with the mesh's error; of channels that a surface does
    /// not reflect, of which no radiosity tells, and without a mesh it is what arrives over the links at the exposed parts of elements, which add up to
    /// the energy that the [report](super::SolveReport::energy) tells. The links of the solver over cells are coarse.
    pub fn fluxes(&self) -> Vec<Flux> {
        let mut fluxes = self.fluxes_over_links();
        for part in self.mesh.iter().flat_map(|mesh| mesh.parts(&self.scene)) {
            let channels = self.scene.channels();
            let material = self.scene.material_of(SurfaceId(part.surface));
            let flux = &mut fluxes[part.surface as usize];

            // The integral of a quadratic element is its area times the mean of the middles of its edges.
            let mut sent = vec![0.0; channels];
            let mut area = 0.0;
            for element in part.elements {
                let [a, b, c] = [0, 1, 2].map(|corner| glam::DVec3::from(part.nodes[element[corner] as usize]));
                let of_element = 0.5 * (b - a).cross(c - a).length();
                area += of_element;
                for &node in &element[3..] {
                    let radiosity = &part.radiosity[node as usize * channels..][..channels];
                    sent.iter_mut().zip(radiosity).for_each(|(sent, &b)| *sent += of_element / 3.0 * f64::from(b));
                }
            }
            for (channel, &rho) in material.reflectance.iter().enumerate().filter(|(_, rho)| **rho > 0.0) {
                flux.incident[channel] = (sent[channel] - area * material.exitance[channel]).max(0.0) / rho;
                flux.absorbed[channel] = (1.0 - rho) * flux.incident[channel];
            }
        }
        fluxes
    }

    fn fluxes_over_links(&self) -> Vec<Flux> {
        let Self { scene, hierarchy, links, exposure, lights, radiosity, .. } = self;
        let clusters = links.iter().any(|(receiver, link)| hierarchy.is_cluster(receiver) || hierarchy.is_cluster(link.source));
        let closure = Closure::needed(scene, hierarchy, links, exposure, clusters);
        let none = Flux::none(scene.channels());
        let mut fluxes = vec![none; scene.surfaces().len()];
        fluxes.iter_mut().zip(scene.surfaces()).for_each(|(flux, surface)| flux.area = surface.polygon.area());
        let powers = Powers { scene, hierarchy, links, exposure, closure: closure.as_ref(), lights, radiosity };
        powers.for_each_leaf(|leaf, exposed, arriving| {
            let surface = SurfaceId(hierarchy.node(leaf).surface);
            let (material, flux) = (scene.material_of(surface), &mut fluxes[surface.index()]);
            let of_lights = lights.of(leaf, scene.channels());
            for (channel, arriving) in arriving.iter().enumerate() {
                let arriving = arriving + of_lights.map_or(0.0, |lights| lights[channel]);
                flux.emitted[channel] += exposed * material.exitance[channel];
                flux.incident[channel] += exposed * arriving;
                flux.absorbed[channel] += (1.0 - material.reflectance[channel]) * exposed * arriving;
            }
        });
        fluxes
    }
}
