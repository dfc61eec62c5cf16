//! Bounds on the form factor of a pair of nodes: from every point of the receiver to the source, with what is in the way.
//!
//! Clusters are bounded by their boxes and normals (`boxes`). Polygons are bounded unoccluded first (`form_factor::bounds`), then by the
//! parts of the source that all of the receiver sees, and by those that some of it may see (`blockers`).

use std::sync::OnceLock;

use glam::DVec3;

use super::blockers::{Blockers, Sight, Views};
use super::boxes::Boxes;
use super::interval::{FormFactorBounds, FormFactorRule};
use crate::bounds::evidence::{Certainty, Evidence};
use crate::form_factor::{Search, bound_unoccluded, centre_and_vertices, point_to_polygon};
use crate::geometry::ClippedFacet;
use crate::hierarchy::{Hierarchy, NodeId};
use crate::scene::{Scene, SurfaceId};

/// Sums of a few form factors are widened by this part of themselves: they round by some 1e-15.
const WIDENED: f64 = 1e-14;

/// Bounds on the form factor from every point of `receiver` to `source`, nodes of a hierarchy over `scene`.
pub fn bound_pair(
    scene: &Scene,
    hierarchy: &Hierarchy,
    receiver: NodeId,
    source: NodeId,
    rule: FormFactorRule,
) -> FormFactorBounds {
    PairBounds::new(scene, hierarchy, rule).bounds(receiver, source)
}

/// Bounds pairs of nodes of one scene.
pub(in crate::bounds) struct PairBounds<'a> {
    hierarchy: &'a Hierarchy,
    rule: FormFactorRule,
    search: Search,
    scene: &'a Scene,
    /// Found once somebody asks what is in the way.
    blockers: OnceLock<Blockers<'a>>,
    boxes: Boxes<'a>,
}

impl<'a> PairBounds<'a> {
    pub fn new(scene: &'a Scene, hierarchy: &'a Hierarchy, rule: FormFactorRule) -> Self {
        let (blockers, boxes) = (OnceLock::new(), Boxes::new(hierarchy));
        Self { hierarchy, rule, search: Search::CLOSE, scene, blockers, boxes }
    }

    /// The same, for so many pairs that each can have little time.
    pub fn fairly(self) -> Self {
        Self { search: Search::FAIR, ..self }
    }

    /// The pair with everything that can be proved about it.
    pub fn bounds(&self, receiver: NodeId, source: NodeId) -> FormFactorBounds {
        if self.has_cluster(receiver, source) {
            return FormFactorBounds::guaranteed(0.0, self.upper_of_boxes(receiver, source), Evidence::Boxes);
        }
        if self.share_a_plane(receiver, source) {
            return FormFactorBounds::guaranteed(0.0, 0.0, Evidence::Sight);
        }

        match self.rule {
            FormFactorRule::QuasiConcave => self.proved(receiver, source),
            FormFactorRule::CentreAndVertices => self.estimated(receiver, source),
        }
    }

    /// Two polygons by theorem and proof.
    fn proved(&self, receiver: NodeId, source: NodeId) -> FormFactorBounds {
        // Unoccluded; if nothing can arrive then, nothing can be in the way.
        let (receiver_facet, source_facet) = (self.hierarchy.facet(receiver), self.hierarchy.facet(source));
        let [least, most] = bound_unoccluded(&receiver_facet, &source_facet, self.search);
        if most == 0.0 {
            return FormFactorBounds::guaranteed(0.0, 0.0, Evidence::Sight);
        }

        let shadows = match self.blockers().sight(receiver, source) {
            Sight::Whole => return FormFactorBounds::guaranteed(least, most, Evidence::Sight),
            Sight::Shadowed(shadows) => shadows,
        };
        let bounds_of = |part: &ClippedFacet| bound_unoccluded(&receiver_facet, &part.facet(), self.search);
        let sum = |parts: &[ClippedFacet], end: usize| parts.iter().map(|part| bounds_of(part)[end]).sum::<f64>() + 0.0;

        // At least what is certainly visible; or all, less what any blocker hides from any point.
        let lit = shadows.lit(&source_facet);
        let without_shaded = lit.shaded.as_ref().map_or(0.0, |shaded| least - sum(shaded, 1));
        let lower = sum(&lit.certain, 0).max(without_shaded).min(most);

        // At most what is possibly visible; or all, less what one blocker hides from all points.
        let most_hidden = shadows.umbras().iter().map(|umbra| bounds_of(umbra)[0]).fold(0.0, f64::max);
        let upper = sum(&lit.possible, 1).min(most - most_hidden).max(lower);
        let evidence = if shadows.is_complete() || upper == 0.0 { Evidence::Shadows } else { Evidence::Unproved };
        FormFactorBounds::guaranteed(lower * (1.0 - WIDENED), upper * (1.0 + WIDENED), evidence)
    }

    /// Two polygons by what the centre and the vertices of the receiver see.
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
        match self.blockers().views(receiver, source, &points) {
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

    /// The pair with what is known of it whatever is in the way, by what takes little time.
    pub fn bounds_unoccluded(&self, receiver: NodeId, source: NodeId) -> FormFactorBounds {
        let evidence = if self.has_cluster(receiver, source) { Evidence::Boxes } else { Evidence::Unproved };
        FormFactorBounds::guaranteed(0.0, self.upper_quickly(receiver, source), evidence)
    }

    /// No point of the receiver has a larger form factor, whatever is in the way: by what takes little time.
    pub fn upper_quickly(&self, receiver: NodeId, source: NodeId) -> f64 {
        let by_boxes = self.upper_of_boxes(receiver, source);
        if by_boxes == 0.0 || self.has_cluster(receiver, source) {
            return by_boxes;
        }
        by_boxes.min(bound_unoccluded(&self.hierarchy.facet(receiver), &self.hierarchy.facet(source), Search::QUICK)[1])
    }

    /// The same, of two polygons by the theorem as closely as the search goes.
    pub fn upper_unlinked(&self, receiver: NodeId, source: NodeId) -> f64 {
        if self.has_cluster(receiver, source) {
            self.upper_of_boxes(receiver, source)
        } else if self.share_a_plane(receiver, source) {
            0.0
        } else {
            bound_unoccluded(&self.hierarchy.facet(receiver), &self.hierarchy.facet(source), self.search)[1]
        }
    }

    /// The same, by the boxes around both alone.
    pub fn upper_of_boxes(&self, receiver: NodeId, source: NodeId) -> f64 {
        self.boxes.upper(receiver, source)
    }

    /// Whether no light travels between two polygons because they lie side by side in one plane.
    fn share_a_plane(&self, receiver: NodeId, source: NodeId) -> bool {
        let [receiver, source] = [receiver, source].map(|node| SurfaceId(self.hierarchy.node(node).surface));
        self.blockers().share_a_plane(receiver, source)
    }

    fn blockers(&self) -> &Blockers<'a> {
        self.blockers.get_or_init(|| Blockers::new(self.scene, self.hierarchy))
    }

    fn has_cluster(&self, receiver: NodeId, source: NodeId) -> bool {
        self.hierarchy.is_cluster(receiver) || self.hierarchy.is_cluster(source)
    }
}
