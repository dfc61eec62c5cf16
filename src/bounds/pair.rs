//! Bounds on the form factor of a pair of nodes: from every point of the receiver to the source, with what is in the way.

use std::f64::consts::PI;

use glam::DVec3;

use super::blockers::{Blockers, Sight, Views};
use super::{Certainty, Evidence, FormFactorBounds, FormFactorRule};
use crate::form_factor::{Search, bound_unoccluded, centre_and_vertices, point_to_polygon};
use crate::geometry::{Aabb, ClippedFacet, Cone};
use crate::hierarchy::{Hierarchy, NodeId};
use crate::scene::{Scene, SurfaceId};

/// Bounds pairs of nodes of one scene.
pub(crate) struct PairBounds<'a> {
    scene: &'a Scene,
    hierarchy: &'a Hierarchy,
    rule: FormFactorRule,
    search: Search,
    blockers: Blockers<'a>,
    /// Which way the faces of each cluster look.
    cones: Vec<Cone>,
}

impl<'a> PairBounds<'a> {
    pub fn new(scene: &'a Scene, hierarchy: &'a Hierarchy, rule: FormFactorRule) -> Self {
        let (blockers, cones) = (Blockers::new(scene, hierarchy), cones_of_clusters(hierarchy));
        Self { scene, hierarchy, rule, search: Search::CLOSE, blockers, cones }
    }

    /// The same, for so many pairs that each can have little time.
    pub fn fairly(self) -> Self {
        Self { search: Search::FAIR, ..self }
    }

    /// The pair with everything that can be proved about it.
    pub fn bounds(&self, receiver: NodeId, source: NodeId) -> FormFactorBounds {
        if self.hierarchy.is_cluster(receiver) || self.hierarchy.is_cluster(source) {
            return FormFactorBounds::guaranteed(0.0, self.upper_of_boxes(receiver, source), Evidence::Boxes);
        }
        let plane = |node| self.scene.surface(SurfaceId(self.hierarchy.node(node).surface)).plane;
        if plane(receiver) == plane(source) {
            return FormFactorBounds::guaranteed(0.0, 0.0, Evidence::Sight);
        }

        match self.rule {
            FormFactorRule::QuasiConcave => self.proved(receiver, source),
            FormFactorRule::CentreAndVertices => self.estimated(receiver, source),
        }
    }

    /// By theorem and proof.
    fn proved(&self, receiver: NodeId, source: NodeId) -> FormFactorBounds {
        // Unoccluded it is between these; so if nothing can arrive, nothing can be in the way.
        let (receiver_facet, source_facet) = (self.hierarchy.facet(receiver), self.hierarchy.facet(source));
        let [least, most] = bound_unoccluded(&receiver_facet, &source_facet, self.search);
        if most == 0.0 {
            return FormFactorBounds::guaranteed(0.0, 0.0, Evidence::Sight);
        }
        match self.blockers.sight(receiver, source) {
            Sight::Whole => FormFactorBounds::guaranteed(least, most, Evidence::Sight),
            Sight::Partial { certain, possible, shadowed } => {
                let sum = |pieces: &[ClippedFacet], end: usize| {
                    pieces.iter().map(|piece| bound_unoccluded(&receiver_facet, &piece.facet(), self.search)[end]).sum::<f64>()
                };
                let lower = sum(&certain, 0).min(most);
                let upper = sum(&possible, 1).min(most).max(lower);
                let evidence = if shadowed || upper == 0.0 { Evidence::Shadows } else { Evidence::Unproved };
                FormFactorBounds::guaranteed(lower, upper, evidence)
            }
        }
    }

    /// By what the centre and the vertices of the receiver see.
    fn estimated(&self, receiver: NodeId, source: NodeId) -> FormFactorBounds {
        let (factors, evidence) = self.point_factors(receiver, source);
        let [mut lower, upper] =
            factors.iter().fold([f64::INFINITY, 0.0], |[least, most], &factor| [factor.min(least), factor.max(most)]);
        if evidence == Evidence::Unproved {
            lower = 0.0;
        }
        FormFactorBounds { lower, upper, certainty: Certainty::Estimate, evidence }
    }

    /// The form factors from the centre and from near the vertices of `receiver`, both surfaces or elements, with what is in the way as
    /// each point sees it. Where too much is in the way to tell, as if nothing were.
    pub fn point_factors(&self, receiver: NodeId, source: NodeId) -> (Vec<f64>, Evidence) {
        let (facet, source_facet) = (self.hierarchy.facet(receiver), self.hierarchy.facet(source));
        let points: Vec<DVec3> = centre_and_vertices(&facet).collect();
        let factor = |&x: &DVec3| point_to_polygon(x, facet.normal, &source_facet);
        let unoccluded: Vec<f64> = points.iter().map(factor).collect();
        if unoccluded.iter().all(|&factor| factor == 0.0) {
            return (unoccluded, Evidence::Sight);
        }
        match self.blockers.views(receiver, source, &points) {
            Views::Whole => (unoccluded, Evidence::Sight),
            Views::Unknown => (unoccluded, Evidence::Unproved),
            Views::Parts(views) => {
                let of_view = |(&x, view): (&DVec3, &Vec<ClippedFacet>)| {
                    view.iter().map(|part| point_to_polygon(x, facet.normal, &part.facet())).sum::<f64>()
                };
                (points.iter().zip(&views).map(of_view).collect(), Evidence::Shadows)
            }
        }
    }

    /// What a pair transfers at most, whatever is in the way, by what takes little time.
    pub fn upper_quickly(&self, receiver: NodeId, source: NodeId) -> f64 {
        let by_boxes = self.upper_of_boxes(receiver, source);
        if by_boxes == 0.0 || self.hierarchy.is_cluster(receiver) || self.hierarchy.is_cluster(source) {
            return by_boxes;
        }
        by_boxes.min(bound_unoccluded(&self.hierarchy.facet(receiver), &self.hierarchy.facet(source), Search::QUICK)[1])
    }

    /// The pair with what is known of it whatever is in the way: cheap.
    pub fn bounds_unoccluded(&self, receiver: NodeId, source: NodeId) -> FormFactorBounds {
        let has_cluster = self.hierarchy.is_cluster(receiver) || self.hierarchy.is_cluster(source);
        let evidence = if has_cluster { Evidence::Boxes } else { Evidence::Unproved };
        FormFactorBounds::guaranteed(0.0, self.upper_quickly(receiver, source), evidence)
    }

    /// What a pair transfers at most, whatever is in the way: cheap, for pairs without a link.
    pub fn upper_unlinked(&self, receiver: NodeId, source: NodeId) -> f64 {
        let plane = |surface| self.scene.surface(surface).plane;
        let planes = [receiver, source].map(|node| self.hierarchy.surface_of(node).map(plane));
        if planes[0].is_some() && planes[0] == planes[1] {
            0.0
        } else if self.hierarchy.is_cluster(receiver) || self.hierarchy.is_cluster(source) {
            self.upper_of_boxes(receiver, source)
        } else {
            bound_unoccluded(&self.hierarchy.facet(receiver), &self.hierarchy.facet(source), self.search)[1]
        }
    }

    /// The most that nodes in two boxes can exchange, as seen from any point with any normal of the receiver.
    ///
    /// A sphere of radius R at distance d is seen under the solid angle `2 pi (1 - sqrt(1 - (R / d)^2))`, and takes at most `(R / d)^2` of the
    /// view, whichever way one looks; faces of area A at least at distance d take at most `A cos cos / (pi d^2)`. Cosines are bounded by the
    /// cones of normals, and that of a polygon by its greatest height over d. Within one box, everything.
    pub fn upper_of_boxes(&self, receiver: NodeId, source: NodeId) -> f64 {
        let (from, to) = (self.box_of(receiver), self.box_of(source));
        let gap = (from.min - to.max).max(to.min - from.max).max(DVec3::ZERO);
        let distance = gap.length() * (1.0 - 1e-12);

        // Which way does each look, seen from the other?
        let towards = Cone::between(to.centre() - from.centre(), 0.5 * (from.diagonal() + to.diagonal()) * (1.0 + 1e-12));
        let cosine = |node: NodeId, other: &Aabb, direction: &Cone| {
            if self.hierarchy.is_cluster(node) {
                return self.cones[node.index()].bound_cosine(direction);
            }
            let facet = self.hierarchy.facet(node);
            let highest = facet.height(DVec3::select(facet.normal.cmpgt(DVec3::ZERO), other.max, other.min)) * (1.0 + 1e-12);
            let by_height = if distance > 0.0 { (highest / distance).clamp(0.0, 1.0) } else { 1.0 };
            by_height.min(Cone::of(facet.normal).bound_cosine(direction))
        };
        let (of_receiver, of_source) = (cosine(receiver, &to, &towards), cosine(source, &from, &towards.reversed()));
        if of_receiver == 0.0 || of_source == 0.0 {
            return 0.0;
        }

        let (centre, radius) = (to.centre(), 0.5 * to.diagonal() * (1.0 + 1e-12));
        let to_centre = (from.min - centre).max(centre - from.max).max(DVec3::ZERO).length();
        let by_sphere = if to_centre > radius {
            let sine_sq = (radius / to_centre).powi(2);
            sine_sq.min(2.0 * of_receiver * sine_sq / (1.0 + (1.0 - sine_sq).sqrt()))
        } else {
            1.0
        };
        if distance == 0.0 {
            return by_sphere;
        }
        let by_area = self.hierarchy.area(source) * of_receiver * of_source / (PI * distance * distance);
        by_area.min(by_sphere) * (1.0 + 1e-12)
    }

    fn box_of(&self, node: NodeId) -> Aabb {
        if self.hierarchy.is_cluster(node) {
            *self.hierarchy.bounds(node)
        } else {
            Aabb::around(self.hierarchy.facet(node).vertices.iter().copied())
        }
    }
}

/// Which way the faces of each cluster look, by node id: clusters come first, children after their parents.
fn cones_of_clusters(hierarchy: &Hierarchy) -> Vec<Cone> {
    let mut cones = vec![Cone::ALL; hierarchy.cluster_count()];
    for cluster in (0..cones.len() as u32).rev().map(NodeId) {
        let of = |child: NodeId| if hierarchy.is_cluster(child) { cones[child.index()] } else { Cone::of(hierarchy.normal(child)) };
        let around = hierarchy.children(cluster).map(of).reduce(Cone::union);
        cones[cluster.index()] = around.unwrap_or(Cone::ALL);
    }
    cones
}
