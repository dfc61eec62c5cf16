//! Seams: edges that two charts share, where a texture filter may show a step.
//!
//! Charts of one material that meet at a flat angle, such as the facets of a column, ought to have about the same light along their edge. Around a
//! sharper edge light truly differs.

use glam::DVec3;
use rayon::prelude::*;
use serde::Serialize;

use super::atlas::{Atlas, Placed};
use super::lattice::bilinear;
use crate::geometry::Aabb;
use crate::picture::Image;
use crate::scene::{Scene, SurfaceId};
use crate::visibility::SurfaceBoxes;

/// Faces whose normals have at least this cosine meet at a flat angle: 30 degrees, from which on modelling programs call edges sharp by default.
const FLAT: f64 = 0.866;

/// Edges touch if they are so many times nearer than what counts as touching.
const TOUCHING: f64 = 4.0;

/// Places on the page nearer than this, in texels, are one.
const CONTINUOUS: f64 = 0.1;

/// What is seen along the seams: differences of the two sides as a texture filter shows them, relative to the larger light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Seams {
    /// Edges.
    pub edges: u64,
    /// The mean over places a texel apart.
    pub mean: f64,
    /// The largest.
    pub largest: f64,
}

/// Compares both sides of all seams on pages of light.
pub(super) fn compare(scene: &Scene, atlas: &Atlas, pages: &[Image]) -> Seams {
    let mut chart_of: Vec<Option<usize>> = vec![None; scene.surfaces().len()];
    for (number, placed) in atlas.charts.iter().enumerate() {
        placed.chart.surfaces.iter().for_each(|surface| chart_of[surface.index()] = Some(number));
    }
    if atlas.is_of_file() {
        // Surfaces that are unfolded in several pieces are left out.
        let mut pieces = vec![0; scene.surfaces().len()];
        atlas.charts.iter().flat_map(|placed| &placed.chart.surfaces).for_each(|surface| pieces[surface.index()] += 1);
        chart_of.iter_mut().zip(pieces).filter(|(_, pieces)| *pieces > 1).for_each(|(chart, _)| *chart = None);
    }
    let (boxes, near) = (SurfaceBoxes::of(scene), TOUCHING * scene.contact_tolerance());
    let of_surface = |surface: u32| {
        let Some(own) = chart_of[surface as usize] else { return Vec::new() };
        let facet = scene.surface(SurfaceId(surface)).polygon.facet();
        let mut seams = Vec::new();
        for (k, &a) in facet.vertices.iter().enumerate() {
            let ends = [a, facet.vertices[(k + 1) % facet.vertices.len()]];
            let middle = 0.5 * (ends[0] + ends[1]);
            boxes.for_each_near(&Aabb::around([middle - near, middle + near]), |other| {
                let Some(theirs) = chart_of[other.index()].filter(|&theirs| theirs != own && surface < other.0) else { return };
                let is_seam = !is_continuous(atlas, [own, theirs], middle);
                if is_seam && may_be_one(scene, SurfaceId(surface), other) && touches(scene, other, middle, near) {
                    seams.push(differences(atlas, pages, [own, theirs], ends));
                }
            });
        }
        seams
    };
    let all: Vec<Vec<f64>> = (0..scene.surfaces().len() as u32).into_par_iter().flat_map_iter(of_surface).collect();
    let count = all.iter().map(Vec::len).sum::<usize>().max(1);
    let mean = all.iter().flatten().fold(0.0, |sum, apart| sum + apart) / count as f64;
    Seams { edges: all.len() as u64, mean, largest: all.iter().flatten().copied().fold(0.0, f64::max) }
}

/// Whether two surfaces look like one that is bent a little.
fn may_be_one(scene: &Scene, one: SurfaceId, other: SurfaceId) -> bool {
    let (a, b) = (scene.surface(one), scene.surface(other));
    a.material == b.material && a.polygon.facet().normal.dot(b.polygon.facet().normal) >= FLAT
}

/// Whether two charts lie side by side on the page as they do in the scene.
fn is_continuous(atlas: &Atlas, charts: [usize; 2], point: DVec3) -> bool {
    let [a, b] = charts.map(|chart| &atlas.charts[chart]);
    let at = |placed: &Placed| placed.chart.to_texels(point) + glam::DVec2::from(placed.at.map(f64::from));
    atlas.is_of_file() && a.page == b.page && at(a).distance(at(b)) < CONTINUOUS
}

fn touches(scene: &Scene, surface: SurfaceId, point: DVec3, near: f64) -> bool {
    scene.surface(surface).polygon.facet().distance_to(point) <= near
}

/// The differences of two charts at places a texel apart along an edge.
fn differences(atlas: &Atlas, pages: &[Image], charts: [usize; 2], [from, to]: [DVec3; 2]) -> Vec<f64> {
    let count = (from.distance(to) / atlas.options.texel).ceil().max(1.0) as usize;
    let at = |k: usize| {
        let point = from.lerp(to, (k as f64 + 0.5) / count as f64);
        let [a, b] = charts.map(|chart| seen(atlas, pages, chart, point));
        let norm = |numbers: &[f64]| numbers.iter().map(|x| x * x).sum::<f64>().sqrt();
        let apart: Vec<f64> = a.iter().zip(&b).map(|(a, b)| a - b).collect();
        let larger = norm(&a).max(norm(&b));
        if larger > 0.0 { norm(&apart) / larger } else { 0.0 }
    };
    (0..count).map(at).collect()
}

/// What a bilinear filter shows of a chart at a point of its plane, by channel.
fn seen(atlas: &Atlas, pages: &[Image], chart: usize, point: DVec3) -> Vec<f64> {
    let placed = &atlas.charts[chart];
    let page = &pages[placed.page];
    let at = placed.chart.to_texels(point) + glam::DVec2::new(f64::from(placed.at[0]), f64::from(placed.at[1])) - 0.5;
    let (base, part) = (at.floor(), at - at.floor());
    let texel = |x: f64, y: f64| {
        let clamped = |x: f64, count: u32| x.clamp(0.0, f64::from(count - 1)) as usize;
        (clamped(y, page.height) * page.width as usize + clamped(x, page.width)) * page.channels
    };
    let corners = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)].map(|(x, y)| texel(base.x + x, base.y + y));
    let weights = bilinear(part.x, part.y);
    let channel = |channel: usize| corners.iter().zip(weights).map(|(&c, w)| w * f64::from(page.radiance[c + channel])).sum();
    (0..page.channels).map(channel).collect()
}
