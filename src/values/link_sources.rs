//! The sources of a point over links: collected from all links above it, and strong ones split.

use std::f64::consts::PI;

use super::link_receiver::Receiver;
use super::over_links::{LinkGather, LinkScratch, MAX_RAYS};
use super::source_piece::{Expected, SourcePiece};
use crate::form_factor::point_to_polygon;
use crate::geometry::{Facet, Part, for_each_piece};
use crate::hierarchy::NodeId;
use crate::scene::SurfaceId;

/// A near piece that is worth more rays than this is split: over it the kernel varies.
const NEAR_RAYS: f64 = 2.0;

/// A piece is near if its radius exceeds this part of its distance: the kernel varies by more than some tenths over it.
const NEAR: f64 = 0.75;

/// A cluster shows at least this part of its area: what it shows is an estimate.
const LEAST_SHOWN: f64 = 0.05;

/// A leaf's polygon is split so many times at most.
const MAX_SPLITS: u32 = 8;

impl LinkGather<'_> {
    /// Collects the sources of all links above the point; in space, where there are none, the whole scene is the source.
    pub(super) fn collect_sources(&self, receiver: &Receiver<'_>, scratch: &mut LinkScratch) {
        scratch.pieces.clear();
        if receiver.leaf.is_none() {
            self.collect(receiver, NodeId::ROOT, Expected::UNKNOWN, &mut scratch.pieces);
        }
        let mut node = receiver.leaf;
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
        let brightest = receiver
            .reflectance
            .iter()
            .zip(&self.radiosity.of(node)[..self.scene.deciding()])
            .map(|(rho, b)| rho * b)
            .fold(0.0, f64::max);
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
        let scatters = self.radiosity.of(node)[..self.scene.deciding()].iter().zip(self.variation.deviation(node)).map(scatter);
        let worth = form_factor * receiver.reflectance.iter().zip(scatters).map(|(rho, scatter)| rho * scatter).fold(0.0, f64::max);
        let near = facet.radius * facet.radius > NEAR * NEAR * receiver.point.distance_squared(facet.centroid);
        SourcePiece::new(node, part, form_factor, worth, near, expected)
    }

    /// Splits pieces that are worth more rays than one may get, until none is.
    pub(super) fn split_strong_sources(&self, receiver: &Receiver<'_>, share: f64, scratch: &mut LinkScratch) {
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
}
