//! The gather at a point over links: `B(x) = E + rho * sum over links of F(x -> s) V(x, s) B_s`.
//!
//! The links are those of all nodes above the point. The form factor to each source is exact at the point. Visibility V is sampled
//! anew: a budget of rays is shared out over the sources in proportion to the noise that a ray to each may have, by how uncertain
//! its link's transmittance is and how much the source's radiosity varies. A ray brings the radiosity of the leaf where it ends, so
//! uneven sources make no error. A source with much noise, or a near one, is split: into its children, or its polygon into parts.
//!
//! A leaf with something standing on it may be bright on one side of that and dark on the other, and a point close by sees little
//! else. So rays that end on such a leaf gather there once more.
//!
//! Cost: one form factor for each source and part, and about as many segments as rays. The result is an estimate: its noise falls
//! with the number of rays, its bias is that of the leaves' radiosities.

use std::f64::consts::PI;

use glam::DVec3;

use super::budget::RayBudget;
use super::source_piece::{Expected, SourcePiece};
use super::variation::Variation;
use crate::form_factor::{kernel, point_to_polygon};
use crate::geometry::{Facet, Part, for_each_piece, sampling, streams};
use crate::hierarchy::{Hierarchy, NodeId};
use crate::links::LinkSet;
use crate::paths::{Place, place_at};
use crate::scene::{Scene, SurfaceId};
use crate::sweep::{Exposure, Radiosity};
use crate::transmittance::Rays;
use crate::visibility::Segment;

/// A piece that is worth more rays than this is split.
const MAX_RAYS: f64 = 8.0;

/// A near piece that is worth more rays than this is split: over it the kernel varies.
const NEAR_RAYS: f64 = 2.0;

/// A piece is near if its radius exceeds this part of its distance: the kernel varies by more than some tenths over it.
const NEAR: f64 = 0.75;

/// Rays that end on a leaf that is exposed only in part gather there if the form factor of the source is above this. Empirical.
const CLOSE: f64 = 0.1;

/// A cluster shows at least this part of its area: what it shows is an estimate.
const LEAST_SHOWN: f64 = 0.05;

/// A leaf's polygon is split so many times at most.
const MAX_SPLITS: u32 = 8;

/// Gathers at points over the links of a solution.
pub(crate) struct LinkGather<'a> {
    scene: &'a Scene,
    hierarchy: &'a Hierarchy,
    links: &'a LinkSet,
    radiosity: &'a Radiosity,
    variation: Variation,
    exposure: &'a Exposure,
    rays: &'a Rays<'a>,
    /// Where only reflected light is gathered: the gather of all light, for rays that end close by.
    whole: Option<&'a LinkGather<'a>>,
}

/// Memory that a gather reuses from point to point.
#[derive(Default)]
pub(crate) struct LinkScratch {
    pieces: Vec<SourcePiece>,
    strong: Vec<SourcePiece>,
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
    /// Memory for the gather there.
    beyond: Option<Box<LinkScratch>>,
}

/// A point on a surface, with what the gather reads often.
struct Receiver<'a> {
    point: DVec3,
    normal: DVec3,
    plane: u32,
    reflectance: &'a [f64],
    leaf: NodeId,
    seed: u64,
}

impl<'a> LinkGather<'a> {
    /// Prepares the gather over all links; finds how radiosities vary over elements.
    pub fn new(
        scene: &'a Scene,
        hierarchy: &'a Hierarchy,
        links: &'a LinkSet,
        radiosity: &'a Radiosity,
        exposure: &'a Exposure,
        rays: &'a Rays<'a>,
    ) -> Self {
        Self { scene, hierarchy, links, radiosity, variation: Variation::new(hierarchy, radiosity), exposure, rays, whole: None }
    }

    /// The same of reflected light alone: `reflected` is [`Radiosity::without_exitance`] of what `whole` gathers.
    pub fn of_reflected(whole: &'a LinkGather<'a>, reflected: &'a Radiosity) -> Self {
        let &Self { scene, hierarchy, links, exposure, rays, .. } = whole;
        Self { whole: Some(whole), ..Self::new(scene, hierarchy, links, reflected, exposure, rays) }
    }

    /// The irradiance H at a place, by channel, in W/m^2; `scratch` tells then what its error may be.
    pub fn irradiance_at(&self, place: &Place, budget: RayBudget, scratch: &mut LinkScratch, irradiance: &mut [f64]) {
        scratch.beyond.get_or_insert_default();
        let receiver = self.receiver(self.hierarchy.leaf_at(place.surface, place.point), place);
        self.irradiance(&receiver, budget, scratch, irradiance);
    }

    /// A place on `leaf` as receiver.
    fn receiver(&self, leaf: NodeId, place: &Place) -> Receiver<'a> {
        let surface = self.scene.surface(place.surface);
        let (normal, reflectance) = (surface.polygon.facet().normal, &self.scene.material_of(place.surface).reflectance);
        Receiver { point: place.point, normal, plane: surface.plane, reflectance, leaf, seed: place.seed }
    }

    /// The radiosity at a place, by channel, in W/m^2; `scratch` tells then what its error may be.
    pub fn radiosity_at(&self, place: &Place, budget: RayBudget, scratch: &mut LinkScratch, radiosity: &mut [f64]) {
        scratch.beyond.get_or_insert_default();
        self.radiosity_of(self.hierarchy.leaf_at(place.surface, place.point), place, budget, scratch, radiosity);
    }

    /// The radiosity at a place on `leaf`, by channel, in W/m^2. Rays that end close by on leaves exposed only in part gather once
    /// more, if `scratch` has memory for that.
    fn radiosity_of(&self, leaf: NodeId, place: &Place, budget: RayBudget, scratch: &mut LinkScratch, radiosity: &mut [f64]) {
        let material = self.scene.material_of(place.surface);
        let receiver = self.receiver(leaf, place);
        self.irradiance(&receiver, budget, scratch, radiosity);
        for (channel, value) in radiosity.iter_mut().enumerate() {
            // Noise may take the irradiance below zero where all is dark.
            *value = material.exitance[channel] + material.reflectance[channel] * value.max(0.0);
        }
    }

    /// The irradiance H at a receiver, by channel, in W/m^2; `scratch` tells then what its error may be.
    fn irradiance(&self, receiver: &Receiver<'_>, budget: RayBudget, scratch: &mut LinkScratch, irradiance: &mut [f64]) {
        // Share the rays out over the sources, and cast them.
        irradiance.fill(0.0);
        for squares in [&mut scratch.variance, &mut scratch.by_sources_sq] {
            squares.clear();
            squares.resize(irradiance.len(), 0.0);
        }
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
                        self.whole.unwrap_or(self).radiosity_of(met, &place, budget.beyond(), beyond, there);
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
        radiosity.iter_mut().zip(self.radiosity.of(leaf)).zip(rise).for_each(|((there, b), rise)| *there = (b + rise).max(0.0));
    }

    /// Collects the sources of all links above the point.
    fn collect_sources(&self, receiver: &Receiver<'_>, scratch: &mut LinkScratch) {
        scratch.pieces.clear();
        let mut node = Some(receiver.leaf);
        while let Some(above) = node {
            for link in self.links.of(above) {
                let transmittance = f64::from(0.5 * (link.seen + link.transmittance)).clamp(0.0, 1.0);
                let has_cluster = self.hierarchy.is_cluster(above) || self.hierarchy.is_cluster(link.source);
                let expected = Expected { transmittance, control: if has_cluster { 0.0 } else { transmittance } };
                self.collect(receiver, link.source, expected, &mut scratch.pieces);
            }
            node = self.hierarchy.parent(above);
        }
    }

    /// Appends a source as seen from the point; for a near cluster its children instead.
    fn collect(&self, receiver: &Receiver<'_>, source: NodeId, expected: Expected, pieces: &mut Vec<SourcePiece>) {
        if !self.hierarchy.is_cluster(source) {
            pieces.extend(self.piece(receiver, source, None, &self.hierarchy.facet(source), expected));
            return;
        }
        match self.cluster_piece(receiver, source, expected) {
            Some(piece) if piece.near => {
                self.hierarchy.children(source).for_each(|child| self.collect(receiver, child, expected, pieces));
            }
            piece => pieces.extend(piece),
        }
    }

    /// A cluster as seen from the point, by the area that it shows; `None` if it lies behind or is dark.
    fn cluster_piece(&self, receiver: &Receiver<'_>, node: NodeId, expected: Expected) -> Option<SourcePiece> {
        let cluster = self.hierarchy.node(node);
        let to_cluster = cluster.centroid - receiver.point;
        let distance_sq = to_cluster.length_squared();
        let near = cluster.radius * cluster.radius > NEAR * NEAR * distance_sq;
        let direction = to_cluster.normalize_or(receiver.normal);

        // A cluster partly below the horizon brings the part above it.
        let cosine = receiver.normal.dot(direction) + if near { 1.0 } else { cluster.radius / distance_sq.sqrt() };
        let shown = self.hierarchy.shown_area(node, -direction).max(LEAST_SHOWN * cluster.area);
        let form_factor = cosine.clamp(0.0, 1.0) * shown / (PI * distance_sq.max(cluster.radius * cluster.radius));
        let brightest = receiver.reflectance.iter().zip(self.radiosity.of(node)).map(|(rho, b)| rho * b).fold(0.0, f64::max);
        let worth = form_factor.min(1.0) * brightest;
        SourcePiece::new(node, None, form_factor, worth, near, expected)
    }

    /// A polygon, or a part of one, as seen from the point; `None` if it brings nothing.
    fn piece(
        &self,
        receiver: &Receiver<'_>,
        node: NodeId,
        part: Option<Part>,
        facet: &Facet<'_>,
        expected: Expected,
    ) -> Option<SourcePiece> {
        // None comes from the receiver's own plane, though by rounding the point may lie in front of the back of the same sheet.
        let is_coplanar = self.scene.surface(SurfaceId(self.hierarchy.node(node).surface)).plane == receiver.plane;
        let form_factor = if is_coplanar { 0.0 } else { point_to_polygon(receiver.point, receiver.normal, facet) };

        // The noise of a ray: by visibility, and by radiosity that varies over the polygon.
        let doubt = expected.doubt();
        let shrunk = if part.is_some() { facet.radius / self.hierarchy.node(node).radius } else { 1.0 };
        let scatter = |(b, deviation): (&f64, &f64)| ((b * doubt).powi(2) + (2.0 * deviation * shrunk).powi(2)).sqrt();
        let scatters = self.radiosity.of(node).iter().zip(self.variation.deviation(node)).map(scatter);
        let worth = form_factor * receiver.reflectance.iter().zip(scatters).map(|(rho, scatter)| rho * scatter).fold(0.0, f64::max);
        let near = facet.radius * facet.radius > NEAR * NEAR * receiver.point.distance_squared(facet.centroid);
        SourcePiece::new(node, part, form_factor, worth, near, expected)
    }

    /// Splits pieces that are worth more rays than one may get, until none is.
    fn split_strong_sources(&self, receiver: &Receiver<'_>, share: f64, scratch: &mut LinkScratch) {
        let is_strong = |piece: &SourcePiece| {
            let splits = piece.part.map_or(0, |part| u32::from(part.splits));
            piece.worth > share * if piece.near { NEAR_RAYS } else { MAX_RAYS } && splits < MAX_SPLITS
        };
        let LinkScratch { pieces, strong, .. } = scratch;
        strong.clear();
        pieces.retain(|piece| {
            let keep = !is_strong(piece);
            if !keep {
                strong.push(*piece);
            }
            keep
        });
        while let Some(piece) = strong.pop() {
            let mut place = |part: Option<SourcePiece>| match part {
                Some(part) if is_strong(&part) => strong.push(part),
                Some(part) => pieces.push(part),
                None => {}
            };
            if piece.part.is_none() && !self.hierarchy.is_leaf(piece.node) {
                let mut children = Vec::new();
                for child in self.hierarchy.children(piece.node) {
                    self.collect(receiver, child, piece.expected, &mut children);
                }
                children.into_iter().for_each(|child| place(Some(child)));
            } else {
                let whole = self.hierarchy.facet(piece.node);
                let splits = piece.part.map_or(1, |part| part.splits + 1);
                let facet = piece.part.as_ref().map_or(whole, |part| part.facet(whole.normal));
                for_each_piece(&facet, |corners| {
                    let part = Part::new(corners, splits);
                    let part = self.piece(receiver, piece.node, Some(part), &part.facet(whole.normal), piece.expected);
                    place(part.map(|part| SourcePiece { of_whole: piece.of_whole, ..part }));
                });
            }
        }
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
            for ray in 0..piece.rays {
                let [u, v] = sobol(ray);
                let (leaf, y) = match part {
                    None => self.hierarchy.point_in_leaf(piece.node, u, v),
                    Some(part) => (piece.node, part.point_at(u, v)),
                };
                let to_plane = self.scene.surface(SurfaceId(self.hierarchy.node(leaf).surface)).plane;
                let (from, to) = (receiver.point.to_array(), y.to_array());
                segments.push(Segment { from, to, from_plane: receiver.plane, to_plane });
                weights.push(kernel(receiver.point, receiver.normal, y, self.hierarchy.normal(leaf)));
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
