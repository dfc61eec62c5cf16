//! The gather at a point over links: `B(x) = E + rho * sum over links of F(x -> s) V(x, s) B_s`.
//!
//! The links are those of all nodes above the point. They bring reflected light. Emitters are seen as wholes beside them, whatever links
//! say: their visible parts exactly, or by rays where these are cheaper (`direct`); where there are more emitters than rays, all light
//! comes over the links.
//!
//! Over a link the form factor to the source is exact at the point. Visibility V is sampled anew: a budget of rays is shared out over the
//! sources in proportion to the noise that a ray to each may have, by how uncertain its link's transmittance is and how much the source's
//! radiosity varies. A ray brings the radiosity of the leaf where it ends, so uneven sources make no error. A source with much noise, or a
//! near one, is split: into its children, or its polygon into parts (`link_sources`).
//!
//! A leaf with something standing on it may be bright on one side of that and dark on the other, and a point close by sees little
//! else. So rays that end on such a leaf gather there once more.
//!
//! Cost: one form factor for each source and part, and about as many segments as rays, beside those to emitters. The result is an
//! estimate: its noise falls with the number of rays, its bias is that of the leaves' radiosities.

use std::borrow::Cow;
use std::sync::Arc;

use glam::DVec3;

use super::budget::RayBudget;
use super::link_receiver::{Receiver, WhichLights};
use super::source_piece::SourcePiece;
use super::variation::Variation;
use crate::direct::{self, Blockers, DirectEffort, DirectLight, DirectScratch, Method};
use crate::form_factor::kernel;
use crate::geometry::{sampling, streams};
use crate::hierarchy::{Hierarchy, NodeId};
use crate::links::LinkSet;
use crate::paths::{Place, place_at};
use crate::scene::{Emitter, Scene, SurfaceId};
use crate::sweep::{Exposure, Radiosity};
use crate::team::Share;
use crate::transmittance::Rays;
use crate::visibility::Segment;

/// A piece that is worth more rays than this is split.
pub(super) const MAX_RAYS: f64 = 8.0;

/// Rays that end on a leaf that is exposed only in part gather there if the form factor of the source is above this. Empirical.
const CLOSE: f64 = 0.1;

/// In space a point of a near piece is drawn so often at most until it is above the horizon: there is no control variate that would stand for points below
/// it. Of a piece of which a third or more is above, two in a thousand are missed: (2/3)^16.
const MOST_DRAWS: u32 = 16;

/// Rays to what is undecided of emitters, as a part of those to reflected light: fewer, since their noise falls faster, see `direct`. A choice, not
/// fitted: between 0 and 1 it shifts time from one to the other.
const DIRECT_RAYS: f64 = 0.5;

/// Gathers at points over the links of a solution.
pub(crate) struct LinkGather<'a> {
    pub(super) scene: &'a Scene,
    pub(super) hierarchy: &'a Hierarchy,
    pub(super) links: &'a LinkSet,
    pub(super) radiosity: Cow<'a, Radiosity>,
    pub(super) variation: Arc<Variation>,
    exposure: &'a Exposure,
    rays: &'a Rays<'a>,
    /// Where only reflected light is gathered over links: the gather of all light, for rays that end close by.
    whole: Option<Box<LinkGather<'a>>>,
    /// Emitters whose light is added beside that of links.
    emitters: Vec<Emitter>,
    /// Whether it is so however many there are.
    is_apart: bool,
    /// Which lights are added.
    lights: WhichLights,
}

/// Memory that a gather reuses from point to point.
#[derive(Default)]
pub(crate) struct LinkScratch {
    pub(super) pieces: Vec<SourcePiece>,
    pub(super) strong: Vec<SourcePiece>,
    direct: DirectScratch,
    segments: Vec<Segment>,
    /// By ray: its part of the piece's form factor.
    weights: Vec<f64>,
    /// By ray: the leaf where it ends.
    met: Vec<NodeId>,
    occluded: Vec<bool>,
    /// The radiosity where a ray ends.
    there: Vec<f64>,
    /// What the rays of a piece bring, and the squares of that, by channel.
    of_piece: Vec<[f64; 2]>,
    /// Of the irradiance that was found last, by channel, in W^2/m^4: its variance, and the sum over pieces of the squares of the reflected light
    /// that each brings.
    pub variance: Vec<f64>,
    pub by_sources_sq: Vec<f64>,
    /// What of it came beside the links, by channel, in W/m^2.
    pub straight: Vec<f64>,
    /// Memory for the gather there.
    beyond: Option<Box<LinkScratch>>,
}

impl<'a> LinkGather<'a> {
    /// Which batches of what is gathered this process does.
    pub fn share(&self) -> Share<'a> {
        self.rays.share()
    }

    /// Prepares the gather over all links; finds how radiosities vary over elements.
    pub fn new(
        scene: &'a Scene,
        hierarchy: &'a Hierarchy,
        links: &'a LinkSet,
        radiosity: &'a Radiosity,
        exposure: &'a Exposure,
        rays: &'a Rays<'a>,
    ) -> Self {
        let variation = Arc::new(Variation::new(hierarchy, radiosity));
        let (radiosity, emitters) = (Cow::Borrowed(radiosity), Vec::new());
        Self {
            scene,
            hierarchy,
            links,
            radiosity,
            variation,
            exposure,
            rays,
            whole: None,
            emitters,
            is_apart: false,
            lights: WhichLights::All,
        }
    }

    /// The same of reflected light alone.
    pub fn of_reflected(whole: Self) -> Self {
        let Self { scene, hierarchy, links, exposure, rays, .. } = whole;
        // Exitance is the same all over a surface, so reflected light varies as all light does.
        let variation = whole.variation.clone();
        let radiosity = Cow::Owned(whole.radiosity.without_exitance(scene, hierarchy, exposure));
        let (whole, emitters) = (Some(Box::new(whole)), Vec::new());
        Self {
            scene,
            hierarchy,
            links,
            radiosity,
            variation,
            exposure,
            rays,
            whole,
            emitters,
            is_apart: false,
            lights: WhichLights::Skies,
        }
    }

    /// The same of all light, that of emitters beside the links.
    pub fn with_direct_light(whole: Self) -> Self {
        let emitters = Emitter::all(whole.scene);
        if emitters.is_empty() { whole } else { Self { emitters, lights: WhichLights::All, ..Self::of_reflected(whole) } }
    }

    /// The same without lights and skies.
    pub fn without_lights(self) -> Self {
        Self { lights: WhichLights::None, ..self }
    }

    /// The same, which looks at all emitters even where links would cost less, so that it is known what these send straight.
    pub fn keeping_apart(self) -> Self {
        Self { is_apart: true, ..self }
    }

    /// The irradiance H at a place, by channel, in W/m^2; `scratch` tells then what its error may be.
    pub fn irradiance_at(&self, place: &Place, budget: RayBudget, scratch: &mut LinkScratch, irradiance: &mut [f64]) {
        scratch.beyond.get_or_insert_default();
        let receiver = self.receiver(self.hierarchy.leaf_at(place.surface, place.point), place, self.lights);
        self.irradiance(&receiver, budget, scratch, irradiance);
    }

    /// A place on `leaf` as receiver.
    fn receiver(&self, leaf: NodeId, place: &Place, lights: WhichLights) -> Receiver<'a> {
        let surface = self.scene.surface(place.surface);
        let (normal, reflectance) = (surface.polygon.facet().normal, &self.scene.material_of(place.surface).reflectance);
        let &Place { point, seed, .. } = place;
        Receiver { point, normal, plane: surface.plane, reflectance, leaf: Some(leaf), seed, lights }
    }

    /// The irradiance H at a sensor, by channel, in W/m^2; `scratch` tells then what its error may be. There are no links above it, so all surfaces are
    /// sources, and rays alone tell what is seen of them.
    pub fn irradiance_in_space(
        &self,
        sensor: &direct::Receiver,
        budget: RayBudget,
        scratch: &mut LinkScratch,
        irradiance: &mut [f64],
    ) {
        scratch.beyond.get_or_insert_default();
        let &direct::Receiver { point, normal, plane, seed } = sensor;
        let all_of_it = vec![1.0; irradiance.len()];
        let receiver = Receiver { point, normal, plane, reflectance: &all_of_it, leaf: None, seed, lights: self.lights };
        self.irradiance(&receiver, budget, scratch, irradiance);
        irradiance.iter_mut().for_each(|h| *h = h.max(0.0));
    }

    /// The radiosity at a place, by channel, in W/m^2; `scratch` tells then what its error may be.
    pub fn radiosity_at(&self, place: &Place, budget: RayBudget, scratch: &mut LinkScratch, radiosity: &mut [f64]) {
        scratch.beyond.get_or_insert_default();
        let receiver = self.receiver(self.hierarchy.leaf_at(place.surface, place.point), place, self.lights);
        self.radiosity_of(place.surface, &receiver, budget, scratch, radiosity);
    }

    /// The radiosity at a receiver on a surface, by channel, in W/m^2. Rays that end close by on leaves exposed only in part gather once
    /// more, if `scratch` has memory for that.
    fn radiosity_of(
        &self,
        surface: SurfaceId,
        receiver: &Receiver<'_>,
        budget: RayBudget,
        scratch: &mut LinkScratch,
        radiosity: &mut [f64],
    ) {
        let material = self.scene.material_of(surface);
        self.irradiance(receiver, budget, scratch, radiosity);
        // Noise may take the irradiance below zero where all is dark.
        self.scene.clear_dark(radiosity);
        for (channel, value) in radiosity.iter_mut().enumerate() {
            *value = material.exitance[channel] + material.reflectance[channel] * *value;
        }
    }

    /// The irradiance H at a receiver, by channel, in W/m^2; `scratch` tells then what its error may be.
    fn irradiance(&self, receiver: &Receiver<'_>, budget: RayBudget, scratch: &mut LinkScratch, irradiance: &mut [f64]) {
        // To look at all emitters costs less than the rays where there are as many of these.
        let is_dear = !self.is_apart && self.emitters.len() > budget.rays as usize;
        if let Some(whole) = self.whole.as_ref().filter(|_| is_dear) {
            return whole.irradiance(receiver, budget, scratch, irradiance);
        }
        irradiance.fill(0.0);
        for squares in [&mut scratch.variance, &mut scratch.by_sources_sq] {
            squares.clear();
            squares.resize(irradiance.len(), 0.0);
        }
        self.add_direct(receiver, budget, scratch, irradiance);
        scratch.straight.clear();
        scratch.straight.extend_from_slice(irradiance);
        self.collect_sources(receiver, scratch);
        let total: f64 = scratch.pieces.iter().map(|piece| piece.worth).sum();
        if total <= 0.0 {
            return;
        }
        let share = total / f64::from(budget.rays.max(1));
        self.split_strong_sources(receiver, share, scratch);
        self.place_rays(receiver, share, budget, scratch);
        self.rays.occluded(&scratch.segments, &mut scratch.occluded);
        self.add_brought(budget, scratch, irradiance);
    }

    /// Adds the light that does not come over the links: of emitters, where these are left out there, of lights and the sky.
    fn add_direct(&self, receiver: &Receiver<'_>, budget: RayBudget, scratch: &mut LinkScratch, irradiance: &mut [f64]) {
        let has_lights = receiver.lights != WhichLights::None && !self.scene.lights().is_empty();
        if self.emitters.is_empty() && !has_lights {
            return;
        }
        let blockers = Blockers::of(self.scene, self.rays);
        let light = DirectLight { scene: self.scene, rays: self.rays, blockers, emitters: &self.emitters };
        let rays = (DIRECT_RAYS * f64::from(budget.rays)).ceil() as u32;
        let &Receiver { point, normal, plane, seed, lights, .. } = receiver;
        let receiver = direct::Receiver { point, normal, plane, seed };
        let effort = DirectEffort { rays, method: Method::Cheaper };
        let LinkScratch { direct, variance, .. } = scratch;
        light.add_irradiance(&receiver, effort, direct, irradiance, variance);
        if lights == WhichLights::All {
            light.add_lights(&receiver, rays, direct, irradiance, variance);
        }
        if lights != WhichLights::None {
            light.add_sky(&receiver, rays, direct, irradiance, variance);
        }
    }

    /// Adds what the pieces bring.
    ///
    /// A piece brings what its rays find, and as control variate the part of its form factor that the link expects to see, less what the
    /// rays sampled of that: so what is seen is exact, and what is hidden dark. A piece whose ray was cast by chance brings what is
    /// expected of it, corrected if the ray was cast: no bias in either case. The form factor of a cluster is too rough for a control
    /// variate: a cluster brings what its rays find.
    fn add_brought(&self, budget: RayBudget, scratch: &mut LinkScratch, irradiance: &mut [f64]) {
        let LinkScratch { pieces, segments, weights, met, occluded, there, of_piece, variance, by_sources_sq, beyond, .. } =
            scratch;
        there.resize(irradiance.len(), 0.0);
        let mut rays = segments.iter().zip(weights).zip(met).zip(occluded);
        for piece in pieces {
            let mean = self.radiosity.of(piece.node);
            let control = if self.hierarchy.is_cluster(piece.node) { 0.0 } else { piece.expected.control };
            of_piece.clear();
            of_piece.resize(irradiance.len(), [0.0; 2]);
            for (((segment, &mut weight), &mut met), &mut occluded) in rays.by_ref().take(piece.rays as usize) {
                there.fill(0.0);
                let y = DVec3::from(segment.to);
                match beyond.as_deref_mut().filter(|_| piece.of_whole > CLOSE && self.exposure.of(met) < 1.0) {
                    _ if occluded => {}
                    Some(beyond) => {
                        let surface = SurfaceId(self.hierarchy.node(met).surface);
                        let place = place_at(y, surface, budget.seed);
                        let gather = self.whole.as_deref().unwrap_or(self);
                        let receiver = gather.receiver(met, &place, WhichLights::All);
                        gather.radiosity_of(surface, &receiver, budget.beyond(), beyond, there);
                        if self.whole.is_some() {
                            let exitance = &self.scene.material_of(surface).exitance;
                            there.iter_mut().zip(exitance).for_each(|(b, e)| *b -= e);
                        }
                    }
                    None => self.leaf_radiosity_at(met, y, there),
                }
                for ((there, mean), [sum, sum_sq]) in there.iter().zip(mean).zip(&mut *of_piece) {
                    let brought = weight * (there - control * mean);
                    *sum += brought;
                    *sum_sq += brought * brought;
                }
            }
            for (channel, &[sum, sum_sq]) in of_piece.iter().enumerate() {
                let brought = sum + piece.form_factor * control * mean[channel];
                irradiance[channel] += brought;
                variance[channel] += piece.sampled_variance(brought, sum, sum_sq, mean[channel]);
                by_sources_sq[channel] += (brought * self.reflected_part(piece.node, channel)).powi(2);
            }
        }
    }

    /// The part of a node's radiosity that it reflects; of a cluster all counts.
    fn reflected_part(&self, node: NodeId, channel: usize) -> f64 {
        let radiosity = self.radiosity.of(node)[channel];
        if self.hierarchy.is_cluster(node) || radiosity <= 0.0 {
            return 1.0;
        }
        let exitance = self.scene.material_of(SurfaceId(self.hierarchy.node(node).surface)).exitance[channel];
        (1.0 - exitance / radiosity).max(0.0)
    }

    /// The radiosity at a point of a leaf by the leaf's own and its slope, by channel.
    fn leaf_radiosity_at(&self, leaf: NodeId, point: DVec3, radiosity: &mut [f64]) {
        let rise = self.variation.rise(leaf, point - self.hierarchy.node(leaf).centroid);
        radiosity.iter_mut().zip(self.radiosity.of(leaf)).zip(rise).for_each(|((there, b), rise)| *there = b + rise);
        self.scene.clear_dark(radiosity);
    }

    /// Places the rays to every piece, as many as it is worth; a piece worth less than one ray gets one by chance.
    fn place_rays(&self, receiver: &Receiver<'_>, share: f64, budget: RayBudget, scratch: &mut LinkScratch) {
        let LinkScratch { pieces, segments, weights, met, .. } = scratch;
        segments.clear();
        weights.clear();
        met.clear();
        for (index, piece) in pieces.iter_mut().enumerate() {
            // How many.
            let seed = sampling::hash(receiver.seed, index as u64);
            piece.rays = (piece.worth / share).ceil().clamp(1.0, MAX_RAYS) as u32;
            piece.chance = (piece.worth / share).clamp(budget.least_chance, 1.0);
            if sampling::unit(sampling::hash(seed, streams::SECOND)) >= piece.chance {
                piece.rays = 0;
                continue;
            }

            // Where they end.
            let part = piece.part.as_ref().map(|part| part.facet(self.hierarchy.normal(piece.node)));
            let area = part.map_or_else(|| self.hierarchy.area(piece.node), |part| part.area);
            let sobol = sampling::shifted_sobol_2d(seed);
            let first = weights.len();
            let point = |draw: u32| {
                let [u, v] = sobol(draw);
                let (leaf, y) = match part {
                    None => self.hierarchy.point_in_leaf(piece.node, u, v),
                    Some(part) => (piece.node, part.point_at(u, v)),
                };
                (leaf, y, kernel(receiver.point, receiver.normal, y, self.hierarchy.normal(leaf)))
            };
            let draws = if piece.near && receiver.leaf.is_none() { MOST_DRAWS } else { 1 };
            for ray in 0..piece.rays {
                let mut drawn = (0..draws).map(|again| point(ray + again * piece.rays));
                let (leaf, y, kernel) = drawn.find(|(.., kernel)| *kernel > 0.0).unwrap_or_else(|| point(ray));
                let to_plane = self.scene.surface(SurfaceId(self.hierarchy.node(leaf).surface)).plane;
                let (from, to) = (receiver.point.to_array(), y.to_array());
                segments.push(Segment { from, to, from_plane: receiver.plane, to_plane });
                weights.push(kernel);
                met.push(leaf);
            }

            // A ray to a far piece weighs its share of the area times the kernel: no bias. Near by, the kernel of a single ray may
            // be huge, so the rays share the exact form factor; the bias is small, because near pieces are split until they are
            // small.
            let own = &mut weights[first..];
            let sum: f64 = own.iter().sum();
            let scale = if piece.near && sum > 0.0 { piece.form_factor / sum } else { area / f64::from(piece.rays) };
            own.iter_mut().for_each(|weight| *weight *= scale / piece.chance);
        }
    }
}
