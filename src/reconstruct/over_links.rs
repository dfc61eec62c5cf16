//! The gather at a point: `B(x) = E + rho * sum over links of F(x -> s) V(x, s) B_s`.
//!
//! The links are those of all nodes above the point. The form factor to each source is taken at the point, exactly; visibility is asked
//! again, with a budget of rays shared over the sources by how far what a ray finds may scatter: by how little the links know of what gets
//! through, and how much the source varies. A ray brings the radiosity of the leaf where it ends, so a source that is not equally bright
//! is no error. A source where much scatters or that is near is split, into its children or, where it has none, its polygon.
//!
//! A leaf on which something stands may be bright before it and dark behind, and a point close by sees little else: rays that end there
//! gather once more. (Cornell box at 1%, points spread over all surfaces: without it half of the squared error lies at the feet of the
//! boxes.)
//!
//! Cost: one form factor a link and piece, and about `budget` segments. The result is an estimate; its noise falls with the number of
//! rays, its bias is that of the leaves' radiosities.

use std::f64::consts::PI;

use glam::DVec3;

use super::Effort;
use super::variation::Variation;
use crate::form_factor::{kernel, point_to_polygon};
use crate::geometry::{Facet, Part, sampling};
use crate::hierarchy::{Hierarchy, NodeId, for_each_piece};
use crate::links::LinkSet;
use crate::scene::{Scene, SurfaceId};
use crate::sweep::{Exposure, Radiosity};
use crate::transmittance::Rays;
use crate::visibility::Segment;

/// A piece gets so many rays at most; what is worth more is split.
const MAX_RAYS: f64 = 8.0;

/// A near piece is split down to so many rays: few enough to bind the place where a ray is cast to what it is worth.
const NEAR_RAYS: f64 = 2.0;

/// A piece is near if its radius exceeds this part of its distance: over it the kernel varies by more than a few tenths.
const NEAR: f64 = 0.75;

/// Rays that end on a leaf that is covered in part gather there if its form factor is at least this. In a room over links, at 4.5%, a
/// twentieth took a third more time and a fifth left the same error.
const CLOSE: f64 = 0.1;

/// A cluster counts as if it showed at least this part of its area.
const LEAST_SHOWN: f64 = 0.05;

/// What is left in doubt where all of a link's rays got through, or none, beside what is half seen: what sends nothing is linked more coarsely.
const DOUBT_OF_SEEN: f64 = 0.1;
const DOUBT_OF_HIDDEN: f64 = 0.4;

/// A polygon is split so many times at most, below the elements that it has.
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
}

/// Memory that a gather reuses from point to point.
#[derive(Default)]
pub(crate) struct LinkScratch {
    pieces: Vec<Piece>,
    strong: Vec<Piece>,
    segments: Vec<Segment>,
    /// What each ray weighs: a form factor, all of a piece's together about the piece's.
    weights: Vec<f64>,
    /// The leaf where each ray ends.
    met: Vec<NodeId>,
    occluded: Vec<bool>,
    /// The radiosity where a ray ends.
    there: Vec<f64>,
    /// Memory for the gather there.
    beyond: Option<Box<LinkScratch>>,
}

/// A piece of a source as it is seen from the point.
#[derive(Clone, Copy)]
struct Piece {
    /// Whose radiosity it has.
    node: NodeId,
    /// The part of the node's polygon, where it was split below the elements.
    part: Option<Part>,
    form_factor: f64,
    /// The form factor of the node of which it is a part.
    of_whole: f64,
    /// What rays to it are worth: for polygons how far what they find may scatter, as a part of `F max_c rho_c B_c`; for clusters all.
    worth: f64,
    near: bool,
    /// The part that gets through by what the link has seen, 0 to 1.
    expected: f64,
    rays: u32,
    /// The probability with which the rays are cast.
    chance: f64,
}

impl Piece {
    /// A piece to which no rays are laid yet; `None` if none are worth anything.
    fn new(node: NodeId, part: Option<Part>, form_factor: f64, worth: f64, near: bool, expected: f64) -> Option<Self> {
        let piece = Self { node, part, form_factor, of_whole: form_factor, worth, near, expected, rays: 0, chance: 1.0 };
        (worth > 0.0).then_some(piece)
    }
}

/// A point on a surface, with what is asked of it again and again.
struct Receiver<'a> {
    point: DVec3,
    normal: DVec3,
    plane: u32,
    reflectance: &'a [f64],
}

/// How little is known of what gets through, if so much is expected: as far as an answer yes or no may scatter, in halves.
fn doubt(expected: f64) -> f64 {
    let least = DOUBT_OF_HIDDEN + (DOUBT_OF_SEEN - DOUBT_OF_HIDDEN) * expected;
    least + (1.0 - least) * 2.0 * (expected * (1.0 - expected)).sqrt()
}

impl<'a> LinkGather<'a> {
    /// Radiosities vary over elements as those of their siblings do.
    pub fn new(
        scene: &'a Scene,
        hierarchy: &'a Hierarchy,
        links: &'a LinkSet,
        radiosity: &'a Radiosity,
        exposure: &'a Exposure,
        rays: &'a Rays<'a>,
    ) -> Self {
        Self { scene, hierarchy, links, radiosity, variation: Variation::new(hierarchy, radiosity), exposure, rays }
    }

    /// The radiosity at `point` of `surface`, by channel, in W/m^2.
    pub fn radiosity_at(&self, point: DVec3, surface: SurfaceId, effort: Effort, scratch: &mut LinkScratch, radiosity: &mut [f64]) {
        let mut beyond = scratch.beyond.take().unwrap_or_default();
        self.radiosity_of(self.hierarchy.leaf_at(surface, point), point, effort, scratch, Some(&mut beyond), radiosity);
        scratch.beyond = Some(beyond);
    }

    /// The radiosity at a point of `leaf`, by channel, in W/m^2. Where rays end close by on leaves that are covered in part it is gathered,
    /// if there is memory for it `beyond`.
    fn radiosity_of(
        &self,
        leaf: NodeId,
        point: DVec3,
        effort: Effort,
        scratch: &mut LinkScratch,
        beyond: Option<&mut LinkScratch>,
        radiosity: &mut [f64],
    ) {
        let surface = SurfaceId(self.hierarchy.node(leaf).surface);
        let material = self.scene.material_of(surface);
        let place = self.scene.surface(surface);
        let normal = place.polygon.facet().normal;
        let receiver = Receiver { point, normal, plane: place.plane, reflectance: &material.reflectance };
        self.irradiance(&receiver, leaf, effort, scratch, beyond, radiosity);
        for (channel, value) in radiosity.iter_mut().enumerate() {
            // Noise may take the irradiance below zero where all is dark.
            *value = material.exitance[channel] + material.reflectance[channel] * value.max(0.0);
        }
    }

    /// The irradiance H at a point of `leaf`, by channel, in W/m^2.
    fn irradiance(
        &self,
        receiver: &Receiver<'_>,
        leaf: NodeId,
        effort: Effort,
        scratch: &mut LinkScratch,
        mut beyond: Option<&mut LinkScratch>,
        irradiance: &mut [f64],
    ) {
        irradiance.fill(0.0);
        self.collect_sources(receiver, leaf, scratch);
        let total: f64 = scratch.pieces.iter().map(|piece| piece.worth).sum();
        if total <= 0.0 {
            return;
        }
        let share = total / f64::from(effort.rays.max(1));
        self.split_strong_sources(receiver, share, scratch);
        self.aim(receiver, share, effort, scratch);
        self.rays.occluded(&scratch.segments, &mut scratch.occluded);

        // Each piece brings its form factor times its mean radiosity, corrected by what each ray finds in its place. A piece to which a ray
        // was not certain brings what was expected of it, corrected by what the ray found if it was cast: no bias either way. The form factor
        // of a cluster is too rough for that: it brings what its rays find.
        let LinkScratch { pieces, segments, weights, met, occluded, there, .. } = scratch;
        there.resize(irradiance.len(), 0.0);
        let mut rays = segments.iter().zip(weights).zip(met).zip(occluded);
        for piece in pieces {
            let mean = self.radiosity.of(piece.node);
            let cluster = self.hierarchy.is_cluster(piece.node);
            let seen = if piece.rays == 0 { piece.expected } else { piece.expected + (1.0 - piece.expected) / piece.chance };
            let mut brought = if cluster { 0.0 } else { piece.form_factor * seen };
            for (((segment, &mut weight), &mut met), &mut occluded) in rays.by_ref().take(piece.rays as usize) {
                brought -= if cluster { 0.0 } else { weight };
                if occluded {
                    continue;
                }
                let y = DVec3::from(segment.to);
                match beyond.as_deref_mut().filter(|_| piece.of_whole > CLOSE && self.exposure.of(met) < 1.0) {
                    Some(beyond) => self.radiosity_of(met, y, effort.beyond(), beyond, None, there),
                    None => self.believe(met, y, there),
                }
                irradiance.iter_mut().zip(&*there).for_each(|(h, there)| *h += weight * there);
            }
            irradiance.iter_mut().zip(mean).for_each(|(h, b)| *h += brought * b);
        }
    }

    /// The radiosity at a point of a leaf by that of the leaf, by channel.
    fn believe(&self, leaf: NodeId, point: DVec3, radiosity: &mut [f64]) {
        let rise = self.variation.rise(leaf, point - self.hierarchy.node(leaf).centroid);
        radiosity.iter_mut().zip(self.radiosity.of(leaf)).zip(rise).for_each(|((there, b), rise)| *there = (b + rise).max(0.0));
    }

    /// The sources of all links above the point that the point can see.
    fn collect_sources(&self, receiver: &Receiver<'_>, leaf: NodeId, scratch: &mut LinkScratch) {
        scratch.pieces.clear();
        let mut node = Some(leaf);
        while let Some(above) = node {
            for link in self.links.of(above) {
                let expected = f64::from(0.5 * (link.seen + link.transmittance)).clamp(0.0, 1.0);
                self.collect(receiver, link.source, expected, &mut scratch.pieces);
            }
            node = self.hierarchy.parent(above);
        }
    }

    /// A source as seen from the point; instead of a cluster that is near, its children.
    fn collect(&self, receiver: &Receiver<'_>, source: NodeId, expected: f64, pieces: &mut Vec<Piece>) {
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

    /// A cluster as seen from the point, by the area that it shows; `None` if it is behind or dark.
    fn cluster_piece(&self, receiver: &Receiver<'_>, node: NodeId, expected: f64) -> Option<Piece> {
        let cluster = self.hierarchy.node(node);
        let to_cluster = cluster.centroid - receiver.point;
        let distance_sq = to_cluster.length_squared();
        let near = cluster.radius * cluster.radius > NEAR * NEAR * distance_sq;
        let direction = to_cluster.normalize_or(receiver.normal);

        // What is partly below the horizon shows what rises above it.
        let cosine = receiver.normal.dot(direction) + if near { 1.0 } else { cluster.radius / distance_sq.sqrt() };
        let shown = self.hierarchy.shown_area(node, -direction).max(LEAST_SHOWN * cluster.area);
        let form_factor = cosine.clamp(0.0, 1.0) * shown / (PI * distance_sq.max(cluster.radius * cluster.radius));
        let brightest = receiver.reflectance.iter().zip(self.radiosity.of(node)).map(|(rho, b)| rho * b).fold(0.0, f64::max);
        let worth = form_factor.min(1.0) * brightest;
        Piece::new(node, None, form_factor, worth, near, expected)
    }

    /// A source, or a part of one, as seen from the point; `None` if nothing of it can arrive.
    fn piece(&self, receiver: &Receiver<'_>, node: NodeId, part: Option<Part>, facet: &Facet<'_>, expected: f64) -> Option<Piece> {
        let form_factor = point_to_polygon(receiver.point, receiver.normal, facet);
        let doubt = doubt(expected);
        let shrunk = if part.is_some() { facet.radius / self.hierarchy.node(node).radius } else { 1.0 };
        let scatter = |(b, deviation): (&f64, &f64)| ((b * doubt).powi(2) + (2.0 * deviation * shrunk).powi(2)).sqrt();
        let scatters = self.radiosity.of(node).iter().zip(self.variation.deviation(node)).map(scatter);
        let worth = form_factor * receiver.reflectance.iter().zip(scatters).map(|(rho, scatter)| rho * scatter).fold(0.0, f64::max);
        let near = facet.radius * facet.radius > NEAR * NEAR * receiver.point.distance_squared(facet.centroid);
        Piece::new(node, part, form_factor, worth, near, expected)
    }

    /// Splits what is worth more than its share, until no piece is.
    fn split_strong_sources(&self, receiver: &Receiver<'_>, share: f64, scratch: &mut LinkScratch) {
        let is_strong = |piece: &Piece| {
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
            let mut place = |part: Option<Piece>| match part {
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
                    place(part.map(|part| Piece { of_whole: piece.of_whole, ..part }));
                });
            }
        }
    }

    /// Lays the rays to every piece: as many as it is worth shares; where it is worth less than one, a single ray by chance.
    fn aim(&self, receiver: &Receiver<'_>, share: f64, effort: Effort, scratch: &mut LinkScratch) {
        let LinkScratch { pieces, segments, weights, met, .. } = scratch;
        segments.clear();
        weights.clear();
        met.clear();
        let at_point =
            receiver.point.to_array().iter().fold(effort.seed, |seed, coordinate| sampling::hash(seed, coordinate.to_bits()));
        for (index, piece) in pieces.iter_mut().enumerate() {
            let seed = sampling::hash(at_point, index as u64);
            piece.rays = (piece.worth / share).ceil().clamp(1.0, MAX_RAYS) as u32;
            piece.chance = (piece.worth / share).clamp(effort.least_chance, 1.0);
            if sampling::unit(sampling::hash(seed, 1)) >= piece.chance {
                piece.rays = 0;
                continue;
            }
            let part = piece.part.as_ref().map(|part| part.facet(self.hierarchy.normal(piece.node)));
            let area = part.map_or_else(|| self.hierarchy.area(piece.node), |part| part.area);
            let spread = sampling::shifted_sobol_2d(seed);
            let first = weights.len();
            for ray in 0..piece.rays {
                let [u, v] = spread(ray);
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

            // Far away a ray weighs the area that it stands for times the kernel: no bias for any number of rays. Near by the kernel may
            // be huge at a single ray; there the rays share the exact form factor, for a bias that is small because near pieces are.
            let own = &mut weights[first..];
            let sum: f64 = own.iter().sum();
            let scale = if piece.near && sum > 0.0 { piece.form_factor / sum } else { area / f64::from(piece.rays) };
            own.iter_mut().for_each(|weight| *weight *= scale / piece.chance);
        }
    }
}
