//! What the rays of a fan hit first: the upper envelope of nearness.
//!
//! The envelopes of either half of the cuts are found, and laid over each other ray by ray (Hershberger 1989 has the bound): `O(n log n)` for `n` cuts,
//! which may cross.

use std::ops::Range;

use super::fan::{Cut, SAME_RAY};

/// Rays on which one cut is the first, by its index.
#[derive(Clone, Copy)]
struct Piece {
    u: [f64; 2],
    cut: usize,
}

/// Calls `visit` with each cut and rays of `windows` on which it is the first that is farther than `nearness[0]`, and nearer than `nearness[1]`. Surfaces
/// of one plane hide nothing of each other: where they lie over each other, both are hit.
pub(super) fn first_hits(cuts: &[Cut], windows: &[[f64; 2]], nearness: [f64; 2], mut visit: impl FnMut(&Cut, [f64; 2])) {
    let between = |cut: &Cut| {
        let [low, high] = cut.between(nearness)?;
        let at_both = [low, high].map(|u| (cut.nearness(u), cut.point(u)));
        Some(Cut { u: [low, high], w: at_both.map(|(w, _)| w), ends: at_both.map(|(_, point)| point), ..*cut })
    };
    let targets: Vec<Cut> = cuts.iter().filter_map(between).collect();
    let mut by_plane: Vec<(u32, usize)> = targets.iter().zip(0..).map(|(target, k)| (target.plane, k)).collect();
    by_plane.sort_unstable();

    for piece in envelope(&targets, 0..targets.len()) {
        let plane = targets[piece.cut].plane;
        let from = by_plane.partition_point(|&(other, _)| other < plane);
        for &(_, k) in by_plane[from..].iter().take_while(|&&(other, _)| other == plane) {
            let target = &targets[k];
            let here = if k == piece.cut { piece.u } else { [piece.u[0].max(target.u[0]), piece.u[1].min(target.u[1])] };
            for window in windows {
                let rays = [here[0].max(window[0]), here[1].min(window[1])];
                if rays[1] - rays[0] > SAME_RAY {
                    visit(target, rays);
                }
            }
        }
    }
}

/// The upper envelope of all cuts, of which those from `range.start` to `range.end` count, ascending.
fn envelope(cuts: &[Cut], range: Range<usize>) -> Vec<Piece> {
    match range.len() {
        0 => Vec::new(),
        1 => vec![Piece { u: cuts[range.start].u, cut: range.start }],
        count => {
            let middle = range.start + count / 2;
            laid_over(cuts, &envelope(cuts, range.start..middle), &envelope(cuts, middle..range.end))
        }
    }
}

/// The upper envelope of two.
fn laid_over(cuts: &[Cut], some: &[Piece], others: &[Piece]) -> Vec<Piece> {
    let mut stops: Vec<f64> = some.iter().chain(others).flat_map(|piece| piece.u).collect();
    stops.sort_unstable_by(f64::total_cmp);
    let mut laid: Vec<Piece> = Vec::with_capacity(some.len() + others.len());
    let mut add = |[from, to]: [f64; 2], cut: usize| {
        if to - from <= SAME_RAY {
            return;
        }
        match laid.last_mut().filter(|last| last.cut == cut && from - last.u[1] <= SAME_RAY) {
            Some(last) => last.u[1] = to,
            None => laid.push(Piece { u: [from, to], cut }),
        }
    };

    // Between two stops each has one piece or none.
    let (mut a, mut b) = (0, 0);
    for stop in stops.windows(2) {
        let range = [stop[0], stop[1]];
        let middle = 0.5 * (range[0] + range[1]);
        let at = |pieces: &[Piece], next: &mut usize| {
            while *next < pieces.len() && pieces[*next].u[1] <= middle {
                *next += 1;
            }
            pieces.get(*next).filter(|piece| piece.u[0] < middle).map(|piece| piece.cut)
        };
        match (at(some, &mut a), at(others, &mut b)) {
            (Some(p), Some(q)) => match overtakes(&cuts[q], &cuts[p], range) {
                Some(over) => {
                    add([range[0], over[0]], p);
                    add(over, q);
                    add([over[1], range[1]], p);
                }
                None => add(range, p),
            },
            (Some(only), None) | (None, Some(only)) => add(range, only),
            (None, None) => {}
        }
    }
    laid
}

/// The rays on which `cut` hides `other`.
fn overtakes(cut: &Cut, other: &Cut, range: [f64; 2]) -> Option<[f64; 2]> {
    /// What rounding may do to a nearness, as a part of it.
    const SAME_PLACE: f64 = 1e-10;
    Cut::where_positive(range, |u| cut.nearness(u) - other.nearness(u) * (1.0 + SAME_PLACE))
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::super::fan::{Fan, take_out};
    use super::*;
    use crate::geometry::sampling;
    use crate::scene::SurfaceId;

    /// The distance along a ray to a segment of the xy plane, in lengths of the ray's direction.
    fn distance(from: DVec3, direction: DVec3, [a, b]: [DVec3; 2]) -> Option<f64> {
        let cross = |p: DVec3, q: DVec3| p.x * q.y - p.y * q.x;
        let span = cross(direction, b - a);
        let (t, s) = (cross(a - from, b - a) / span, cross(a - from, direction) / span);
        (t > 0.0 && (0.0..=1.0).contains(&s)).then_some(t)
    }

    /// Segments that do not cross: within parallel strips.
    fn segments(seed: u64) -> Vec<[DVec3; 2]> {
        let unit = |k: u64| sampling::unit(sampling::hash(seed, k));
        let end = |k: u64, strip: u64| DVec3::new(4.0 * unit(k) - 2.0, 0.1 + 0.25 * (strip as f64 + unit(k + 1)), 0.0);
        (0..12).map(|strip| [end(4 * strip, strip), end(4 * strip + 2, strip)]).collect()
    }

    #[test]
    fn rays_hit_first_what_is_nearest_behind_the_segment() {
        let apex = DVec3::new(0.1, -0.3, 0.0);
        let [a, b] = [DVec3::new(-0.4, 1.3, 0.0), DVec3::new(0.6, 1.1, 0.0)];
        let fan = Fan::new(apex, [a - apex, b - apex], DVec3::Z).unwrap();
        let (mut hits, mut misses) = (0, 0);
        for seed in 0..200 {
            let segments = segments(seed);
            let cuts: Vec<Cut> = (0..).zip(&segments).filter_map(|(k, s)| fan.project(s[0], s[1], SurfaceId(k), k)).collect();
            let mut found = Vec::new();
            first_hits(&cuts, &[[0.0, 1.0]], [1.0, 0.0], |cut, rays| found.push((*cut, rays)));
            let mut open = vec![[0.0, 1.0]];
            cuts.iter().filter_map(|cut| cut.nearer_than(1.0)).for_each(|hidden| take_out(&mut open, hidden));
            for k in 0..50 {
                let u = (f64::from(k) + 0.5) / 50.0;
                let at = |k: usize| distance(apex, fan.direction(u), segments[k]);
                let nearest = (0..12).filter_map(|k| Some((at(k).filter(|&t| t > 1.0)?, k))).min_by(|a, b| a.0.total_cmp(&b.0));
                let hit: Vec<_> = found.iter().filter(|(_, rays)| (rays[0]..rays[1]).contains(&u)).collect();
                assert!(hit.len() <= 1, "seed {seed}: {hit:?}");
                assert_eq!(hit.first().map(|(cut, _)| cut.surface.index()), nearest.map(|(_, k)| k), "seed {seed} ray {u}");
                if let (Some((cut, _)), Some((t, _))) = (hit.first(), nearest) {
                    assert!(cut.point(u).distance(apex + t * fan.direction(u)) < 1e-9);
                }
                let is_hidden = (0..12).filter_map(at).any(|t| t < 1.0);
                assert_eq!(open.iter().any(|window| (window[0]..window[1]).contains(&u)), !is_hidden);
                hits += u32::from(nearest.is_some());
                misses += u32::from(is_hidden);
            }
        }
        assert!(hits > 1000 && misses > 1000, "{hits} {misses}");
    }
}
