//! On what a proof rests besides arithmetic: what the scene is taken for where its vertices say something a little different.

use std::collections::HashMap;
use std::fmt;

use glam::DVec3;
use serde::Serialize;

use super::enclosure::closed_gap;
use super::form_factors::CONTACT_OF_SIZE;
use super::stacks::for_each_overlap;
use crate::geometry::{Polygon, plane_noise};
use crate::scene::{Light, Scene, Surface, SurfaceId};

/// What is taken for granted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ConditionKind {
    /// Surfaces side by side, a little off one plane, are in it: they hide nothing from each other and exchange no light.
    MergedPlanes,
    /// Surfaces lie over each other in one plane but for a gap. Where bounds have elements of their own the gap is treated as it is; over
    /// links nothing travels in it.
    Gaps,
    /// Surfaces of one plane with the same front overlap: form factors may add up to more than 1.
    Overlaps,
    /// Vertices lie off the plane of their polygon.
    Bent,
    /// Faces without a plane were cut into pieces that have one.
    CutFaces,
    /// Edges are taken for joined that nearly are, so that a room is closed.
    ClosedGaps,
    /// What is nearer than this to what it would hide does not hide it.
    Contacts,
    /// Lights that are no surfaces send nothing.
    Lights,
}

impl fmt::Display for ConditionKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::MergedPlanes => "surfaces a little off one plane",
            Self::Gaps => "narrow gaps between surfaces",
            Self::Overlaps => "surfaces that overlap in one plane",
            Self::Bent => "vertices off their polygon's plane",
            Self::CutFaces => "faces without a plane",
            Self::ClosedGaps => "edges that nearly join",
            Self::Contacts => "surfaces that touch",
            Self::Lights => "lights that are no surfaces",
        })
    }
}

/// Something that is taken for granted, with its extent and the place where it is largest.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Condition {
    /// What it is.
    pub kind: ConditionKind,
    /// How many surfaces it is about.
    pub surfaces: u32,
    /// The largest distance that is neglected, in metres.
    pub size: f64,
    /// The number in the input, from 1, of the face where that is; `None` if it holds everywhere.
    pub face: Option<u32>,
    /// The middle of that face, in metres.
    pub place: Option<[f64; 3]>,
    /// Whether bounds could be wrong by it by more than rounding of the input may change them: then nothing is guaranteed.
    pub could_matter: bool,
}

/// Collects conditions of one kind.
struct Found<'a> {
    scene: &'a Scene,
    kind: ConditionKind,
    surfaces: Vec<SurfaceId>,
    worst: Option<(f64, SurfaceId)>,
    could_matter: bool,
}

/// All conditions, by kind; `over_links` if bounds are over links.
pub(super) fn conditions(scene: &Scene, over_links: bool) -> Vec<Condition> {
    let mut found = vec![merged_planes(scene)];
    let [mut gaps, mut overlaps] = [ConditionKind::Gaps, ConditionKind::Overlaps].map(|kind| Found::new(scene, kind));
    for_each_overlap(scene, |a, b, gap| {
        let [normal_a, normal_b] = [a, b].map(|id| scene.surface(id).polygon.facet().normal);
        if gap > 0.0 {
            gaps.add(b, gap, over_links);
        } else if normal_a.dot(normal_b) > 0.0 {
            overlaps.add(b, 0.0, true);
        }
    });
    found.extend([gaps, overlaps, bent(scene), cut_faces(scene)]);
    let mut conditions: Vec<Condition> = found.into_iter().filter_map(Found::into_condition).collect();

    // What holds everywhere.
    let size = scene.bounds().diagonal();
    let everywhere = |kind, size| Condition {
        kind,
        surfaces: scene.surfaces().len() as u32,
        size,
        face: None,
        place: None,
        could_matter: false,
    };
    conditions.extend(closed_gap(scene).filter(|&gap| gap > 0.0).map(|gap| everywhere(ConditionKind::ClosedGaps, gap)));
    conditions.push(everywhere(ConditionKind::Contacts, CONTACT_OF_SIZE * size));
    if scene.lights().iter().any(Light::is_on) {
        conditions.push(Condition { could_matter: true, ..everywhere(ConditionKind::Lights, 0.0) });
    }
    conditions
}

/// Surfaces that are off the plane of the largest of their plane number. Light at grazing angles alone can tell, and from a distance of the
/// size of the surface by as much as the surface itself may be bent, unless it is farther off than that.
fn merged_planes(scene: &Scene) -> Found<'_> {
    let mut largest: HashMap<u32, &Surface> = HashMap::new();
    for surface in scene.surfaces() {
        let largest = largest.entry(surface.plane()).or_insert(surface);
        if surface.polygon.area() > largest.polygon.area() {
            *largest = surface;
        }
    }
    let mut found = Found::new(scene, ConditionKind::MergedPlanes);
    for (index, surface) in scene.surfaces().iter().enumerate() {
        let (plane, own) = (largest[&surface.plane()].polygon.facet(), surface.polygon.facet());
        let off = off_plane(own.vertices, plane.vertices[0], plane.normal);
        if off > 0.0 && !std::ptr::eq(largest[&surface.plane()], surface) {
            found.add(SurfaceId(index as u32), off, off > 2.0 * Polygon::PLANARITY_TOLERANCE * own.radius);
        }
    }
    found
}

/// Polygons with vertices off their plane.
fn bent(scene: &Scene) -> Found<'_> {
    let mut found = Found::new(scene, ConditionKind::Bent);
    for (index, surface) in scene.surfaces().iter().enumerate() {
        let facet = surface.polygon.facet();
        let off = off_plane(facet.vertices, facet.vertices[0], facet.normal);
        if off > 0.0 {
            found.add(SurfaceId(index as u32), off, false);
        }
    }
    found
}

/// Faces whose pieces lie in different planes.
fn cut_faces(scene: &Scene) -> Found<'_> {
    let mut first: HashMap<u32, &Surface> = HashMap::new();
    let mut found = Found::new(scene, ConditionKind::CutFaces);
    for (index, surface) in scene.surfaces().iter().enumerate() {
        let first = *first.entry(surface.face).or_insert(surface);
        if first.plane() != surface.plane() {
            let (plane, own) = (first.polygon.facet(), surface.polygon.facet());
            found.add(SurfaceId(index as u32), off_plane(own.vertices, plane.vertices[0], plane.normal), false);
        }
    }
    found
}

/// The largest distance of a vertex from a plane; 0 if it is what rounding leaves.
fn off_plane(vertices: &[DVec3], origin: DVec3, normal: DVec3) -> f64 {
    let off = |&vertex: &DVec3| {
        let height = normal.dot(vertex - origin).abs();
        if height <= plane_noise(vertex, origin) { 0.0 } else { height }
    };
    vertices.iter().map(off).fold(0.0, f64::max)
}

impl<'a> Found<'a> {
    fn new(scene: &'a Scene, kind: ConditionKind) -> Self {
        Self { scene, kind, surfaces: Vec::new(), worst: None, could_matter: false }
    }

    fn add(&mut self, surface: SurfaceId, size: f64, could_matter: bool) {
        self.surfaces.push(surface);
        self.could_matter |= could_matter;
        if self.worst.is_none_or(|(worst, other)| (size, other) > (worst, surface)) {
            self.worst = Some((size, surface));
        }
    }

    fn into_condition(mut self) -> Option<Condition> {
        let (size, surface) = self.worst?;
        self.surfaces.sort_unstable();
        self.surfaces.dedup();
        let worst = self.scene.surface(surface);
        Some(Condition {
            kind: self.kind,
            surfaces: self.surfaces.len() as u32,
            size,
            face: Some(worst.face + 1),
            place: Some(worst.polygon.facet().centroid.to_array()),
            could_matter: self.could_matter,
        })
    }
}
