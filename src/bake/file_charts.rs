//! Charts that a file lays out: its second texture coordinates say where on the page each of its triangles lies.
//!
//! Faces are triangles joined, cut where they are concave; so what a triangle covers are its parts on the surfaces that its face became. Triangles of a face
//! that one affine map brings to the page are a chart; a face that is unfolded in several pieces makes several. Of a face with two sides the front has
//! the texels.

use std::collections::HashMap;

use glam::{DVec2, DVec3};

use super::charts::{Chart, FileParts, TexelGrid};
use super::coverage::{cut, sites};
use super::options::{BakeError, UvProblem};
use crate::scene::{FileUv, Scene, SurfaceId, UvTriangle};

/// One map brings two triangles to the page if it brings the corners of either within so many texels of where they lie.
const SAME_MAP: f64 = 0.01;

/// Coordinates may leave the page by this much: rounding.
const BEYOND: f64 = 1e-6;

/// Triangles whose doubled area is no more than this part of the square of their longest edge have none.
const NO_AREA: f64 = 1e-9;

/// Charts overlap if together they cover more of a texel than all of it by this: rounding makes less.
const OVERLAP: f64 = 1e-3;

/// A chart on a page, and its first texel there.
pub(super) type OnPage = (Chart, [u32; 2]);

/// The area of the triangles that are `chosen`, by what they have in the scene over what they have of the page: a texel of a side of t metres needs
/// a page of so many metres over t.
///
/// # Errors
/// [`BakeError::Uv`] if coordinates are missing, leave the page, or have no area.
pub(super) fn side_in_metres(uv: &FileUv, is_chosen: &dyn Fn(u32) -> bool) -> Result<f64, BakeError> {
    if let Some(face) = uv.without.filter(|&face| is_chosen(face)) {
        return Err(BakeError::Uv(UvProblem::Without { face: face + 1 }));
    }
    if let Some(face) = uv.concave.filter(|&face| is_chosen(face)) {
        return Err(BakeError::Uv(UvProblem::Concave { face: face + 1 }));
    }
    let (mut area, mut area_on_page) = (0.0, 0.0);
    for triangle in uv.triangles.iter().filter(|triangle| is_chosen(triangle.face)) {
        let face = triangle.face + 1;
        if let Some(&uv) = triangle.uv.iter().find(|uv| !uv.iter().all(|x| (-BEYOND..=1.0 + BEYOND).contains(x))) {
            return Err(BakeError::Uv(UvProblem::Outside { face, uv }));
        }
        let (corners, at) = (triangle.corners.map(DVec3::from), triangle.uv.map(DVec2::from));
        let doubled = (corners[1] - corners[0]).cross(corners[2] - corners[0]).length();
        let longest = |sides: [f64; 3]| sides.into_iter().fold(0.0, f64::max);
        let has_area = doubled > NO_AREA * longest([0, 1, 2].map(|k| corners[k].distance_squared(corners[(k + 1) % 3])));
        let doubled_on_page = (at[1] - at[0]).perp_dot(at[2] - at[0]).abs();
        if has_area && doubled_on_page <= NO_AREA * longest([0, 1, 2].map(|k| at[k].distance_squared(at[(k + 1) % 3]))) {
            return Err(BakeError::Uv(UvProblem::NoArea { face }));
        }
        area += doubled;
        area_on_page += doubled_on_page;
    }
    if area_on_page > 0.0 { Ok((area / area_on_page).sqrt()) } else { Err(BakeError::Uv(UvProblem::None)) }
}

/// The charts of the triangles that are `chosen`, on a page of `side` texels.
///
/// # Errors
/// [`BakeError::Uv`] if they overlap.
pub(super) fn charts(scene: &Scene, uv: &FileUv, chosen: &[bool], side: u32) -> Result<Vec<OnPage>, BakeError> {
    let mut surfaces_of: HashMap<u32, Vec<SurfaceId>> = HashMap::new();
    for (number, surface) in scene.surfaces().iter().enumerate().filter(|(number, _)| chosen[*number]) {
        surfaces_of.entry(surface.face).or_default().push(SurfaceId(number as u32));
    }

    // Triangles of a face by the maps that bring them to the page.
    let mut maps: Vec<(u32, TexelGrid, Vec<u32>)> = Vec::new();
    let mut of_face: HashMap<u32, Vec<usize>> = HashMap::new();
    for (number, triangle) in (0..).zip(&uv.triangles).filter(|(_, triangle)| surfaces_of.contains_key(&triangle.face)) {
        let known = of_face.entry(triangle.face).or_default();
        match known.iter().find(|&&map| brings(&maps[map].1, triangle, side)) {
            Some(&map) => maps[map].2.push(number),
            None => {
                let Some(grid) = grid_of(triangle, side) else { continue };
                known.push(maps.len());
                maps.push((triangle.face, grid, vec![number]));
            }
        }
    }
    let chart = |(face, grid, triangles)| chart(scene, uv, (grid, triangles), &surfaces_of[&face]);
    let charts: Vec<OnPage> = maps.into_iter().filter_map(chart).collect();
    if charts.is_empty() {
        return Err(BakeError::Uv(UvProblem::None));
    }
    check_overlaps(scene, &charts, side)?;
    Ok(charts)
}

/// Coordinates on the page in texels.
fn on_page(triangle: &UvTriangle, side: u32) -> [DVec2; 3] {
    triangle.uv.map(|uv| DVec2::from(uv).clamp(DVec2::ZERO, DVec2::ONE) * f64::from(side))
}

/// The map that brings a triangle to the page; `None` if it has no area on either.
fn grid_of(triangle: &UvTriangle, side: u32) -> Option<TexelGrid> {
    let (corners, at) = (triangle.corners.map(DVec3::from), on_page(triangle, side));
    let (a, b) = (at[1] - at[0], at[2] - at[0]);
    let (c, d) = (corners[1] - corners[0], corners[2] - corners[0]);
    let area = a.perp_dot(b);
    let steps = [(b.y * c - a.y * d) / area, (a.x * d - b.x * c) / area];
    let grid = TexelGrid::new(corners[0] - at[0].x * steps[0] - at[0].y * steps[1], steps);
    let is_finite = grid.origin.is_finite() && grid.duals.iter().chain(&grid.steps).all(|step| step.is_finite());
    is_finite.then_some(grid)
}

fn brings(grid: &TexelGrid, triangle: &UvTriangle, side: u32) -> bool {
    let at = on_page(triangle, side);
    triangle.corners.iter().zip(at).all(|(&corner, at)| grid.to_texels(DVec3::from(corner)).distance(at) <= SAME_MAP)
}

/// The chart of some triangles that one map brings to the page, on these surfaces; `None` if they cover nothing of those.
fn chart(scene: &Scene, uv: &FileUv, (grid, triangles): (TexelGrid, Vec<u32>), surfaces: &[SurfaceId]) -> Option<OnPage> {
    let mut polygons: Vec<(SurfaceId, Vec<DVec2>)> = Vec::new();
    let mut of_triangles = Vec::new();
    for number in triangles {
        let corners = uv.triangles[number as usize].corners.map(DVec3::from);
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        let triangle = counter_clockwise(corners.map(|corner| grid.to_texels(corner)).to_vec());
        let is_front = |surface: &&SurfaceId| scene.surface(**surface).polygon.facet().normal.dot(normal) > 0.0;
        let mut first = None;
        for &surface in surfaces.iter().filter(is_front) {
            let whole = scene.surface(surface).polygon.vertices().map(|vertex| grid.to_texels(DVec3::from(vertex))).collect();
            let part = common(&triangle, &counter_clockwise(whole));
            if doubled_area(&part) > 0.0 {
                first.get_or_insert(surface);
                polygons.push((surface, part));
            }
        }
        of_triangles.extend(first.map(|surface| (number, surface)));
    }

    // Counted from the first texel that they touch.
    let all = || polygons.iter().flat_map(|(_, corners)| corners);
    let first = all().copied().reduce(DVec2::min)?.floor().max(DVec2::ZERO);
    let extent = (all().copied().reduce(DVec2::max)?.ceil() - first).max(DVec2::ONE).to_array();
    polygons.iter_mut().flat_map(|(_, corners)| corners).for_each(|corner| *corner -= first);
    let at = first.to_array().map(|x| x as u32);
    let mut surfaces: Vec<SurfaceId> = polygons.iter().map(|(surface, _)| *surface).collect();
    surfaces.sort_unstable();
    surfaces.dedup();
    let material = scene.surface(surfaces[0]).material;
    let of_file = Some(FileParts { polygons, triangles: of_triangles });
    Some((Chart { surfaces, material, grid: grid.counted_from(at), of_file, extent }, at))
}

fn doubled_area(polygon: &[DVec2]) -> f64 {
    let Some((&first, rest)) = polygon.split_first() else { return 0.0 };
    rest.windows(2).map(|pair| (pair[0] - first).perp_dot(pair[1] - first)).sum()
}

/// A polygon turned so that it runs counter-clockwise: coordinates may mirror it.
fn counter_clockwise(mut polygon: Vec<DVec2>) -> Vec<DVec2> {
    if doubled_area(&polygon) < 0.0 {
        polygon.reverse();
    }
    polygon
}

/// What two convex polygons have in common.
fn common(one: &[DVec2], other: &[DVec2]) -> Vec<DVec2> {
    let mut part = one.to_vec();
    for (k, &from) in other.iter().enumerate() {
        let edge = other[(k + 1) % other.len()] - from;
        part = cut(&part, |corner| edge.perp_dot(corner - from));
    }
    part
}

/// Refuses charts that cover the same.
fn check_overlaps(scene: &Scene, charts: &[OnPage], side: u32) -> Result<(), BakeError> {
    let mut covered: Vec<(f32, u32)> = vec![(0.0, 0); side as usize * side as usize];
    for (chart, [left, top]) in charts {
        let columns = chart.size()[0];
        for (index, site) in sites(scene, chart).iter().enumerate().filter(|(_, site)| site.is_covered()) {
            let (column, row) = (*left as usize + index % columns, *top as usize + index / columns);
            let Some((sum, by)) = covered.get_mut(row * side as usize + column) else { continue };
            let face = scene.surface(SurfaceId(site.surface)).face;
            *sum += site.covered;
            if f64::from(*sum) > 1.0 + OVERLAP {
                let uv = [column, row].map(|at| (at as f64 + 0.5) / f64::from(side));
                return Err(BakeError::Uv(UvProblem::Overlap { faces: [*by + 1, face + 1], uv }));
            }
            *by = face;
        }
    }
    Ok(())
}
