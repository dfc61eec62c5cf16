//! Sites on which something stands: no light arrives there, and none may be taken from there.

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::charts::Chart;
use super::coverage::Site;
use super::texels::Texels;
use crate::geometry::{sampling, streams};
use crate::progress::Stop;
use crate::scene::{Scene, SurfaceId};
use crate::sweep::HiddenPoints;
use crate::transmittance::Rays;

/// Points along each side of a texel whose middle is hidden, to look for another place of its value.
const TRIES: usize = 4;

/// Sites that are looked at together.
const BATCH: usize = 1024;

/// Moves sites that are hidden to where the texel is open, and leaves texels without a value that are hidden everywhere. Returns how many these are.
pub(crate) fn hide(scene: &Scene, texels: &mut [Texels<'_>], rays: &Rays<'_>, seed: u64, stop: Stop<'_>) -> u64 {
    let hidden = HiddenPoints::of(scene, rays);
    let of_chart = |(texels, number): (&mut Texels<'_>, u64)| {
        let seed = sampling::hash(seed, streams::BAKE_HIDDEN + number);
        let is_hidden = hidden_sites(scene, texels, &hidden, seed, stop);

        // Texels beside open ones may be open in part.
        let (chart, columns) = (texels.chart, texels.columns());
        let is_beside = |index: usize| {
            let beside = [index.wrapping_sub(1), index + 1, index.wrapping_sub(columns), index + columns];
            beside.into_iter().any(|other| texels.sites.get(other).is_some_and(Site::is_covered) && !is_hidden[other])
        };
        let place = |index: usize| {
            let (surface, seed) = (SurfaceId(texels.sites[index].surface), sampling::hash(seed, index as u64));
            let at = [index % columns, index / columns];
            (is_beside(index) && !stop()).then(|| open_place(scene, chart, (surface, at), &hidden, seed)).flatten()
        };
        let all: Vec<usize> = (0..is_hidden.len()).filter(|&index| is_hidden[index]).collect();
        let places: Vec<Option<DVec2>> = all.par_iter().map(|&index| place(index)).collect();
        for (&index, place) in all.iter().zip(&places) {
            match place {
                Some(place) => texels.sites[index].move_to(*place),
                None => texels.sites[index].hide(),
            }
        }
        places.iter().filter(|place| place.is_none()).count() as u64
    };
    texels.iter_mut().zip(0..).map(of_chart).sum()
}

/// Whether each site of a chart is hidden.
fn hidden_sites(scene: &Scene, texels: &Texels<'_>, hidden: &HiddenPoints<'_>, seed: u64, stop: Stop<'_>) -> Vec<bool> {
    let of_batch = |(batch, sites): (usize, &[Site])| {
        let mut is_hidden = vec![false; sites.len()];
        if stop() {
            return is_hidden;
        }

        // The sites of each surface together.
        let covered = (0..sites.len()).filter(|&index| sites[index].is_covered());
        let mut order: Vec<(u32, usize)> = covered.map(|index| (sites[index].surface, index)).collect();
        order.sort_unstable();
        for group in order.chunk_by(|a, b| a.0 == b.0) {
            let surface = SurfaceId(group[0].0);
            let seed = sampling::hash(seed, (batch as u64) << 32 | u64::from(surface.0));
            let points: Vec<DVec3> = group.iter().map(|&(_, index)| texels.point(scene, batch * BATCH + index)).collect();
            let found = hidden.among(surface, &points, seed);
            group.iter().zip(found).for_each(|(&(_, index), found)| is_hidden[index] = found);
        }
        is_hidden
    };
    texels.sites.par_chunks(BATCH).enumerate().flat_map_iter(of_batch).collect()
}

/// A place of a texel on a surface that nothing stands on, from the middle of the texel: the one nearest to the mean of all that were found.
fn open_place(
    scene: &Scene,
    chart: &Chart,
    (surface, [column, row]): (SurfaceId, [usize; 2]),
    hidden: &HiddenPoints<'_>,
    seed: u64,
) -> Option<DVec2> {
    let facet = scene.surface(surface).polygon.facet();
    let middle = DVec2::new(column as f64, row as f64) + 0.5;
    let along = |k: usize| (k as f64 + 0.5) / TRIES as f64 - 0.5;
    let places = (0..TRIES * TRIES).map(|k| DVec2::new(along(k % TRIES), along(k / TRIES)));
    let on_surface = |place: DVec2| {
        let point = chart.to_space(middle + place);
        let point = point - facet.height(point) * facet.normal;
        facet.contains(point).then_some((place, point))
    };
    let (places, points): (Vec<DVec2>, Vec<DVec3>) = places.filter_map(on_surface).unzip();
    let are_hidden = hidden.among(surface, &points, seed);
    let open: Vec<DVec2> = places.into_iter().zip(are_hidden).filter(|(_, is_hidden)| !is_hidden).map(|(place, _)| place).collect();
    let mean = open.iter().sum::<DVec2>() / open.len() as f64;
    open.into_iter().min_by(|a, b| a.distance_squared(mean).total_cmp(&b.distance_squared(mean)))
}
