//! Sources as what casts shadows: coplanar pieces that send alike are one, with its border and the corners of that.

use glam::DVec3;

use super::corners::{Sector, facets, sectors_of};
use super::faces::{Faces, Plane};
use super::points::Welder;
use super::segments::Source;
use crate::geometry::{Aabb, edges as sides_of};
use crate::scene::SurfaceId;

/// So many tolerances beside a place, what touches it is a few off.
const CLEAR: f64 = 16.0;

/// A part of the border of a source.
#[derive(Clone, Debug)]
pub(super) struct Rim {
    pub ends: [DVec3; 2],
    pub middle: Apex,
    /// The unit vector across it into the source.
    pub inward: DVec3,
    /// The same of another source that continues it around a bend and sends alike: where both are seen, nothing happens along the rim.
    pub kin: Option<DVec3>,
}

/// A point of a border from which light is followed: of a source, or at the end of an edge.
#[derive(Clone, Debug)]
pub(super) struct Apex {
    pub place: DVec3,
    /// Beside it, within the source or on the edge.
    inside: DVec3,
    /// The faces that touch it, out of the source's plane.
    pub touching: Vec<SurfaceId>,
}

/// A source: polygons in one plane that send alike and touch along sides.
#[derive(Clone, Debug)]
pub(super) struct Emitter {
    pub pieces: Vec<SurfaceId>,
    /// W/m^2.
    pub radiosity: f64,
    /// Its light goes to the front.
    pub plane: Plane,
    pub rims: Vec<Rim>,
    pub corners: Vec<(Apex, Vec<Sector>)>,
    /// In m^2.
    pub area: f64,
    /// No two of its points are farther apart, in metres.
    pub diameter: f64,
    pub bounds: Aabb,
}

impl Apex {
    /// The point `place` of a border, with the direction from there to its inside; `plane` is the source's.
    pub fn new(faces: &Faces<'_>, plane: &Plane, place: DVec3, inward: DVec3) -> Self {
        let inside = place + CLEAR * faces.tolerance * inward;
        let touches = |id: &SurfaceId| {
            let facet = faces.facet(*id);
            let is_in_plane = facet.vertices.iter().all(|&vertex| plane.height(vertex).abs() <= faces.on_plane());
            !is_in_plane && facet.distance_to(place) <= faces.on_plane()
        };
        let touching = faces.near(&Aabb::around([place])).into_iter().filter(touches).collect();
        Self { place, inside, touching }
    }

    /// Forgets the faces that touch what is beside it as well.
    pub fn leave_what_goes_on(&mut self, faces: &Faces<'_>) {
        let inside = self.inside;
        self.touching.retain(|&id| faces.facet(id).distance_to(inside) > faces.on_plane());
    }

    /// Whether the source beside it is not hidden from `target` by what touches the border there.
    pub fn is_open_towards(&self, faces: &Faces<'_>, target: DVec3) -> bool {
        !self.touching.iter().any(|&id| {
            let facet = faces.facet(id);
            let (here, there) = (facet.height(self.inside), facet.height(target));
            here * there < 0.0 && facet.contains(self.inside + (target - self.inside) * (here / (here - there)))
        })
    }
}

/// The emitters that `sources` make, in the order of their first pieces.
pub(super) fn emitters(faces: &Faces<'_>, sources: &[Source]) -> Vec<Emitter> {
    let mut sources: Vec<Source> = sources.iter().filter(|source| source.radiosity > 0.0).copied().collect();
    sources.sort_by_key(|source| source.surface);
    sources.dedup_by_key(|source| source.surface);
    let mut slot = vec![u32::MAX; faces.scene.surfaces().len()];
    for (index, source) in sources.iter().enumerate() {
        slot[source.surface.index()] = index as u32;
    }
    let near: Vec<Vec<usize>> = sources.iter().map(|source| touching(faces, source.surface, &slot)).collect();
    let alike = |a: usize, b: usize| {
        let [p, q] = [a, b].map(|k| faces.scene.surface(sources[k].surface));
        let is_coplanar = p.plane() == q.plane() && p.polygon.facet().normal.dot(q.polygon.facet().normal) > 0.0;
        (sources[a].radiosity == sources[b].radiosity).then_some(is_coplanar)
    };

    let mut group = vec![usize::MAX; sources.len()];
    let mut emitters = Vec::new();
    for first in 0..sources.len() {
        if group[first] != usize::MAX {
            continue;
        }
        // All pieces that are reached over sides.
        let mut members = vec![first];
        group[first] = emitters.len();
        let mut next = 0;
        while next < members.len() {
            let member = members[next];
            for &other in &near[member] {
                let joins = || alike(member, other) == Some(true);
                if group[other] == usize::MAX && joins() && share_a_side(faces, sources[member].surface, sources[other].surface) {
                    group[other] = emitters.len();
                    members.push(other);
                }
            }
            next += 1;
        }
        members.sort_unstable();
        let around = members.iter().flat_map(|&m| near[m].iter().copied().filter(move |&o| alike(m, o).is_some()));
        let mut kin: Vec<usize> = around.chain(members.iter().copied()).collect();
        kin.sort_unstable();
        kin.dedup();
        let ids = |of: &[usize]| of.iter().map(|&k| sources[k].surface).collect::<Vec<_>>();
        emitters.push(emitter(faces, &ids(&members), &ids(&kin), sources[first].radiosity));
    }
    emitters
}

/// The other sources whose boxes touch.
fn touching(faces: &Faces<'_>, surface: SurfaceId, slot: &[u32]) -> Vec<usize> {
    // Second sides of sheets are sources of their own, and not among the faces.
    let near = faces.near(&faces.scene.surface(surface).polygon.bounds());
    let both = near.into_iter().flat_map(|id| [Some(id), faces.scene.surface(id).twin()]).flatten();
    let mut found: Vec<usize> =
        both.filter(|&id| id != surface && slot[id.index()] != u32::MAX).map(|id| slot[id.index()] as usize).collect();
    found.sort_unstable();
    found
}

/// The part of a side from `start` along `edge`, from 0 to 1, that a side of `other` lies on.
fn overlap(faces: &Faces<'_>, (start, edge): (DVec3, DVec3), other: SurfaceId) -> Option<[f64; 2]> {
    let (length_sq, tolerance) = (edge.length_squared(), faces.tolerance);
    sides_of(faces.facet(other).vertices).find_map(|(a, along)| {
        let [a, b] = [a, a + along];
        let on_line = |point: DVec3| (point - start).cross(edge).length_squared() <= tolerance * tolerance * length_sq;
        let [s, t] = [a, b].map(|point| (point - start).dot(edge) / length_sq);
        let [low, high] = [s.min(t).max(0.0), s.max(t).min(1.0)];
        (on_line(a) && on_line(b) && (high - low) * length_sq.sqrt() > tolerance).then_some([low, high])
    })
}

fn share_a_side(faces: &Faces<'_>, a: SurfaceId, b: SurfaceId) -> bool {
    sides_of(faces.facet(a).vertices).any(|side| overlap(faces, side, b).is_some())
}

fn emitter(faces: &Faces<'_>, pieces: &[SurfaceId], kin: &[SurfaceId], radiosity: f64) -> Emitter {
    let first = faces.facet(pieces[0]);
    let plane = Plane { origin: first.centroid, normal: first.normal };

    // Sides, less what other pieces lie along.
    let mut rims = Vec::new();
    for &piece in pieces {
        for (start, edge) in sides_of(faces.facet(piece).vertices) {
            let mut left = vec![[0.0, 1.0]];
            for &other in pieces.iter().filter(|&&other| other != piece) {
                if let Some(shared) = overlap(faces, (start, edge), other) {
                    super::fan::take_out(&mut left, shared);
                }
            }
            let Some(inward) = plane.normal.cross(edge).try_normalize() else { continue };
            let bends = kin.iter().filter(|id| !pieces.contains(id));
            let around = bends.filter_map(|&id| Some((overlap(faces, (start, edge), id)?, id)));
            let whole = around.filter(|([from, to], _)| *from <= 0.0 && *to >= 1.0);
            // Into the other source, across the same line.
            let into = |id: SurfaceId| {
                let across = faces.facet(id).normal.cross(edge).normalize_or_zero();
                if across.dot(faces.facet(id).centroid - start) < 0.0 { -across } else { across }
            };
            let kin = whole.map(|(_, id)| into(id)).next();
            let long = left.into_iter().filter(|[from, to]| (to - from) * edge.length() > faces.tolerance);
            rims.extend(long.map(|[from, to]| {
                let ends = [start + from * edge, start + to * edge];
                Rim { ends, middle: Apex::new(faces, &plane, 0.5 * (ends[0] + ends[1]), inward), inward, kin }
            }));
        }
    }

    // Corners are where rims end and all that sends alike is not seen to go on straight.
    let mut welder = Welder::new(faces.on_plane());
    let ends = rims.iter().flat_map(|rim| rim.ends).filter(|&end| welder.weld(end).1);
    let inward = |end: DVec3| {
        let meets = |rim: &&Rim| rim.ends.iter().any(|other| other.distance(end) <= faces.on_plane());
        rims.iter().filter(meets).map(|rim| rim.inward).sum::<DVec3>().normalize_or_zero()
    };
    let corner = |end| (Apex::new(faces, &plane, end, inward(end)), sectors_of(facets(faces, kin), end, faces.on_plane()));
    let corners = ends.map(corner).collect();
    let points = || pieces.iter().flat_map(|&id| faces.facet(id).vertices.iter().copied());
    let bounds = Aabb::around(points());
    let area = pieces.iter().map(|&id| faces.facet(id).area).sum();
    Emitter { pieces: pieces.to_vec(), radiosity, plane, rims, corners, area, diameter: bounds.diagonal(), bounds }
}
