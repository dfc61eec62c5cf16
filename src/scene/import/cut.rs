//! Convex planar pieces of a face.
//!
//! A convex planar face stays whole. A concave one is triangulated by ear clipping, and the triangles are put together again wherever
//! the result is convex (S. Hertel and K. Mehlhorn, Fast triangulation of simple polygons, FCT 1983: at most four times as many
//! pieces as possible). A face whose vertices lie in no plane becomes triangles. The pieces of a face and of the same face seen from
//! behind are the same, if both are given in the same order: see [`super::assemble`].
//!
//! Cost: O(n) for a convex face of n corners; for a concave one that of ear clipping, O(n log n) in practice and O(n^2) at worst, in the
//! corners of this one face.

use glam::DVec3;

use crate::geometry::{Frame, Polygon, PolygonError};

/// What was done to a face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Cut {
    /// Nothing.
    Whole,
    /// It was concave.
    Concave,
    /// It had no plane: its vertices lie up to this far off the mean plane, in metres.
    NonPlanar(f64),
}

/// The pieces of a face.
#[derive(Debug)]
pub(super) struct Pieces {
    /// Convex and planar; none if the face has no area.
    pub polygons: Vec<Polygon>,
    /// What was done.
    pub cut: Cut,
    /// Whether the face crosses itself, so that the pieces may not be what was meant.
    pub crossing: bool,
    /// How far the farthest corner was moved onto the mean plane, in metres; 0 if none was.
    pub flattened: f64,
}

impl Pieces {
    /// Of a face without area.
    pub const NONE: Self = Self { polygons: Vec::new(), cut: Cut::Whole, crossing: false, flattened: 0.0 };
}

/// Areas of pieces and of the whole differ by less than this fraction in a face that does not cross itself.
const AREA_TOLERANCE: f64 = 1e-6;

/// Corners are moved onto the mean plane only if that turns edges by little: this fraction of the face's radius.
const FLATTENED_SLOPE: f64 = 0.02;

/// Cuts the face with these corners into convex planar pieces. Corners that lie off the mean plane by no more than `rounding`, in
/// metres, are moved onto it: a small face in a large scene is never flatter than the digits of the file.
pub(super) fn convex_pieces(corners: &[DVec3], rounding: f64) -> Pieces {
    let whole = Polygon::from_vertices(corners.to_vec());
    let cut = match whole {
        Ok(polygon) if winds_once(corners, DVec3::from(polygon.normal())) => {
            return Pieces { polygons: vec![polygon], cut: Cut::Whole, crossing: false, flattened: 0.0 };
        }
        Ok(_) | Err(PolygonError::NotConvex) => Cut::Concave,
        Err(PolygonError::NotPlanar) => {
            let (distance, flat) = flattened(corners);
            let radius = corners.iter().map(|corner| corner.distance(corners[0])).fold(0.0, f64::max) / 2.0;
            if distance <= rounding.min(FLATTENED_SLOPE * radius) {
                let pieces = convex_pieces(&flat, 0.0);
                return Pieces { flattened: distance, ..pieces };
            }
            Cut::NonPlanar(distance)
        }
        Err(_) => return Pieces::NONE,
    };

    let normal = newell(corners).normalize_or_zero();
    let triangles = match (corners.len(), cut) {
        (4, Cut::NonPlanar(_)) => quad_triangles(corners, normal),
        _ => ear_clipped(corners, normal),
    };
    let polygon = |piece: &[usize]| Polygon::from_vertices(piece.iter().map(|&k| corners[k]).collect());
    let mut polygons = Vec::new();
    if cut == Cut::Concave {
        for loop_ in merged(corners, normal, &triangles) {
            // Where rounding spoils a merged piece its fan is as good.
            match polygon(&loop_) {
                Ok(piece) => polygons.push(piece),
                Err(_) => polygons.extend((1..loop_.len() - 1).filter_map(|k| polygon(&[loop_[0], loop_[k], loop_[k + 1]]).ok())),
            }
        }
    } else {
        polygons.extend(triangles.iter().filter_map(|triangle| polygon(triangle).ok()));
    }

    // Seen along the normal, pieces that do not cover what the corners enclose tell of edges that cross.
    let enclosed = 0.5 * newell(corners).length();
    let covered: f64 = polygons.iter().map(|piece| piece.area() * DVec3::from(piece.normal()).dot(normal)).sum();
    let crossing = (covered - enclosed).abs() > AREA_TOLERANCE * enclosed;
    Pieces { polygons, cut, crossing, flattened: 0.0 }
}

/// Twice the area vector around vertex 0, which keeps large offsets out of the products.
fn newell(corners: &[DVec3]) -> DVec3 {
    let edge = |k: usize| corners[k] - corners[0];
    (1..corners.len() - 1).map(|k| edge(k).cross(edge(k + 1))).sum()
}

/// How far the farthest corner lies off the mean plane, and the corners moved onto it.
fn flattened(corners: &[DVec3]) -> (f64, Vec<DVec3>) {
    let normal = newell(corners).normalize_or_zero();
    let centre = corners[0] + corners.iter().map(|corner| *corner - corners[0]).sum::<DVec3>() / corners.len() as f64;
    let height = |corner: DVec3| (corner - centre).dot(normal);
    let distance = corners.iter().map(|&corner| height(corner).abs()).fold(0.0, f64::max);
    (distance, corners.iter().map(|&corner| corner - height(corner) * normal).collect())
}

/// Whether the boundary of a polygon that turns left at every corner goes round once, as that of a pentagram does not.
fn winds_once(corners: &[DVec3], normal: DVec3) -> bool {
    let axis = Frame::around(normal).tangent;
    let mut changes = 0;
    let mut last = 0.0;
    let mut first = 0.0;
    for k in 0..corners.len() {
        let along = (corners[(k + 1) % corners.len()] - corners[k]).dot(axis);
        if along == 0.0 {
            continue;
        }
        if last == 0.0 {
            first = along;
        } else if (along > 0.0) != (last > 0.0) {
            changes += 1;
        }
        last = along;
    }
    changes + usize::from((first > 0.0) != (last > 0.0)) <= 2
}

/// Two triangles of a quad: across the corner that points inwards, if there is one, else along the shorter diagonal.
fn quad_triangles(corners: &[DVec3], normal: DVec3) -> Vec<[usize; 3]> {
    let turn = |k: usize| {
        let (a, b, c) = (corners[(k + 3) % 4], corners[k], corners[(k + 1) % 4]);
        (b - a).cross(c - b).dot(normal)
    };
    let start = match (0..4).find(|&k| turn(k) < 0.0) {
        Some(inwards) => inwards % 2,
        None => usize::from(corners[1].distance_squared(corners[3]) < corners[0].distance_squared(corners[2])),
    };
    vec![[start, start + 1, start + 2], [start, start + 2, (start + 3) % 4]]
}

/// Triangles of a simple polygon, seen along `normal`.
fn ear_clipped(corners: &[DVec3], normal: DVec3) -> Vec<[usize; 3]> {
    // Relative to a corner and to the size, so that neither offset nor unit matter.
    let frame = Frame::around(normal);
    let size = corners.iter().map(|corner| corner.distance(corners[0])).fold(0.0, f64::max).max(f64::MIN_POSITIVE);
    let flat = corners.iter().map(|corner| {
        let local = (*corner - corners[0]) / size;
        [local.dot(frame.tangent), local.dot(frame.bitangent)]
    });
    let mut indices: Vec<u32> = Vec::new();
    earcut::Earcut::new().earcut(flat, &[], &mut indices);

    indices
        .chunks_exact(3)
        .map(|triangle| {
            // Counter-clockwise as the face, whatever the order they come in.
            let [a, b, c] = [triangle[0] as usize, triangle[1] as usize, triangle[2] as usize];
            let turn = (corners[b] - corners[a]).cross(corners[c] - corners[a]).dot(normal);
            if turn < 0.0 { [a, c, b] } else { [a, b, c] }
        })
        .collect()
}

/// Convex loops: triangles joined across every diagonal that is not needed.
fn merged(corners: &[DVec3], normal: DVec3, triangles: &[[usize; 3]]) -> Vec<Vec<usize>> {
    // Half-edges 3t, 3t+1, 3t+2 run around triangle t, each from its `origin`.
    let origin: Vec<usize> = triangles.iter().flatten().copied().collect();
    let count = origin.len();
    let mut next: Vec<usize> = (0..count).map(|h| if h % 3 == 2 { h - 2 } else { h + 1 }).collect();
    let mut previous: Vec<usize> = (0..count).map(|h| if h % 3 == 0 { h + 2 } else { h - 1 }).collect();
    let mut removed = vec![false; count];

    // Pair the half-edges that run along the same diagonal in opposite directions.
    let mut along: std::collections::HashMap<(usize, usize), usize> = std::collections::HashMap::new();
    let mut diagonals = Vec::new();
    for half in 0..count {
        let ends = (origin[half], origin[next[half]]);
        if let Some(other) = along.remove(&(ends.1, ends.0)) {
            diagonals.push((other, half));
        } else {
            along.insert(ends, half);
        }
    }

    // A diagonal is not needed if both of its ends stay convex without it. A corner of a polygon may be straight, not more.
    for (one, other) in diagonals {
        let convex = |a: usize, b: usize, c: usize| {
            let (a, b, c) = (corners[origin[a]], corners[origin[b]], corners[origin[c]]);
            (b - a).cross(c - b).dot(normal) >= 0.0
        };
        let at_start = convex(previous[one], one, next[next[other]]);
        let at_end = convex(previous[other], other, next[next[one]]);
        if !(at_start && at_end) {
            continue;
        }
        (removed[one], removed[other]) = (true, true);
        for (half, twin) in [(one, other), (other, one)] {
            let (before, after) = (previous[half], next[twin]);
            next[before] = after;
            previous[after] = before;
        }
    }

    // Walk around each loop once.
    let mut loops = Vec::new();
    let mut walked = removed;
    for start in 0..count {
        let mut half = start;
        let mut piece = Vec::new();
        while !walked[half] {
            walked[half] = true;
            piece.push(origin[half]);
            half = next[half];
        }
        if piece.len() >= 3 {
            loops.push(piece);
        }
    }
    loops
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flat(points: &[(f64, f64)]) -> Vec<DVec3> {
        points.iter().map(|&(x, y)| DVec3::new(x, y, 0.0)).collect()
    }

    fn area(pieces: &Pieces) -> f64 {
        pieces.polygons.iter().map(Polygon::area).sum()
    }

    #[test]
    fn convex_faces_stay_whole() {
        let octagon: Vec<DVec3> = (0..8)
            .map(|k| {
                let (y, x) = (f64::from(k) * std::f64::consts::FRAC_PI_4).sin_cos();
                DVec3::new(x, y, x + y)
            })
            .collect();
        let pieces = convex_pieces(&octagon, 0.0);
        assert_eq!((pieces.polygons.len(), pieces.cut, pieces.crossing), (1, Cut::Whole, false));
    }

    #[test]
    fn an_l_becomes_two_quads_and_a_comb_few_pieces() {
        let l = convex_pieces(&flat(&[(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 1.0), (1.0, 2.0), (0.0, 2.0)]), 0.0);
        assert_eq!((l.polygons.len(), l.cut, l.crossing), (2, Cut::Concave, false));
        assert!((area(&l) - 3.0).abs() < 1e-14);

        // A comb of 50 teeth has 98 inward corners.
        let mut comb = vec![(0.0, -1.0), (100.0, -1.0)];
        for tooth in (0..50).rev() {
            let x = 2.0 * f64::from(tooth);
            comb.extend([(x + 2.0, 0.0), (x + 1.5, 1.0), (x + 0.5, 1.0), (x, 0.0)]);
            comb.dedup();
        }
        let pieces = convex_pieces(&flat(&comb), 0.0);
        assert_eq!((pieces.cut, pieces.crossing), (Cut::Concave, false));
        assert!((area(&pieces) - (100.0 + 50.0 * 1.5)).abs() < 1e-10, "{}", area(&pieces));
        assert!(pieces.polygons.len() <= 100, "{}", pieces.polygons.len());
    }

    #[test]
    fn quads_without_a_plane_become_two_triangles() {
        let bent = [DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.2), DVec3::Y];
        let pieces = convex_pieces(&bent, 0.0);
        assert_eq!(pieces.polygons.len(), 2);
        let Cut::NonPlanar(distance) = pieces.cut else { panic!("{pieces:?}") };
        assert!((0.04..0.06).contains(&distance), "{distance}");
        // The shorter diagonal is the flat one.
        assert!(pieces.polygons[0].normal()[2] > 0.9 && (area(&pieces) - 0.5 - 0.5 * (1.0_f64 + 0.04 + 0.04).sqrt()).abs() < 1e-2);

        // An arrow head is cut across its inward corner.
        let arrow = [DVec3::ZERO, DVec3::new(4.0, 1.0, 0.0), DVec3::new(0.0, 2.0, 0.3), DVec3::new(1.0, 1.0, 0.0)];
        let pieces = convex_pieces(&arrow, 0.0);
        assert_eq!(pieces.polygons.len(), 2);
        assert!(pieces.polygons.iter().all(|piece| piece.normal()[2] > 0.0), "{pieces:?}");
    }

    #[test]
    fn rounded_faces_are_flattened() {
        let rounded = [DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 1e-5), DVec3::Y];
        let pieces = convex_pieces(&rounded, 1e-5);
        assert_eq!((pieces.polygons.len(), pieces.cut), (1, Cut::Whole));
        assert!((2.4e-6..2.6e-6).contains(&pieces.flattened), "{}", pieces.flattened);
        assert_eq!(convex_pieces(&rounded, 2e-6).polygons.len(), 2);

        // A small face may be bent by no more than the tolerance and yet be bent.
        assert_eq!(convex_pieces(&rounded.map(|corner| DVec3::new(1e-4, 1e-4, 1.0) * corner), 1e-5).polygons.len(), 2);
    }

    #[test]
    fn crossing_faces_are_told() {
        let pentagram: Vec<DVec3> = (0..5)
            .map(|k| {
                let (y, x) = (f64::from(2 * k) * std::f64::consts::TAU / 5.0).sin_cos();
                DVec3::new(x, y, 0.0)
            })
            .collect();
        assert!(convex_pieces(&pentagram, 0.0).crossing);
        // The areas of a bow tie cancel.
        assert!(convex_pieces(&flat(&[(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)]), 0.0).polygons.is_empty());
    }

    #[test]
    fn a_keyhole_is_cut_around_its_hole() {
        let points = [
            (0.0, 0.0),
            (4.0, 0.0),
            (4.0, 4.0),
            (0.0, 4.0),
            (0.0, 0.0),
            (1.0, 1.0),
            (1.0, 3.0),
            (3.0, 3.0),
            (3.0, 1.0),
            (1.0, 1.0),
        ];
        let pieces = convex_pieces(&flat(&points), 0.0);
        assert!((area(&pieces) - 12.0).abs() < 1e-12 && !pieces.crossing, "{pieces:?}");
    }
}
