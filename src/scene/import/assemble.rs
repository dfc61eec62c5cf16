//! From faces as read to polygons: degenerate and duplicate faces go, concave and non-planar ones are cut.
//!
//! Vertices count as the same where their coordinates are equal; files that repeat vertices for every face write the same digits.
//! Each face is cut by itself, many at once; which of them are duplicates is found in their order. Cost: O(n log n) for n corners.

use std::collections::HashMap;
use std::path::Path;
use std::sync::OnceLock;
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::Duration;

use glam::DVec3;
use rayon::prelude::*;

use super::changed_faces::ChangedFaces;
use super::cut::{Cut, Pieces, convex_pieces};
use super::faces::Face;
use super::{Diagnostic, DiagnosticKind, Diagnostics};
use crate::geometry::{Aabb, Polygon, sampling};
use crate::progress::Stop;
use crate::scene::FaceNames;
use crate::scene::on_threads::on_threads_of_caller;

/// Corners off their plane by no more than this fraction of the scene's diagonal are there by rounding: files give six or seven digits.
const PLANE_TOLERANCE: f64 = 1e-6;

/// Faces of so many corners are cut aside: some take seconds, and the cut itself cannot be interrupted.
const MANY_CORNERS: usize = 1 << 10;

/// Meanwhile it is asked so often whether to stop.
const BETWEEN_QUESTIONS: Duration = Duration::from_millis(20);

/// So many faces are cut at once; what they became waits in memory.
const FACES_AT_ONCE: usize = 1 << 14;

/// Polygons with the index of their material and the 0-based number of their face, and the faces that were dropped here or flattened.
pub(super) struct Assembled {
    pub polygons: Vec<(Polygon, u32, u32)>,
    pub changed: ChangedFaces,
}

/// Faces as they were read.
pub(super) struct Faces<'a> {
    pub faces: &'a [Face],
    /// The corners of all faces.
    pub corners: &'a [DVec3],
    /// The file that they are from, and the line of each face, from 1; `None` for faces from memory.
    pub source: Option<(&'a Path, &'a [u32])>,
    /// The objects that they belong to, where that is known.
    pub objects: &'a FaceNames,
}

impl Faces<'_> {
    /// A diagnostic about a face.
    fn about(&self, kind: DiagnosticKind, text: String, number: u32) -> Diagnostic {
        let mut diagnostic = Diagnostic::new(kind, text).face(number + 1);
        diagnostic.object = self.objects.name_of(number).map(str::to_owned);
        match self.source {
            Some((file, lines)) => diagnostic.at(file, lines[number as usize]),
            None => diagnostic,
        }
    }

    /// What to call a face.
    fn name(&self, number: u32) -> String {
        match self.source.map_or(0, |(_, lines)| lines[number as usize]) {
            0 => format!("face {}", number + 1),
            line => format!("face {} of line {line}", number + 1),
        }
    }
}

/// Makes convex planar polygons of the faces, in their order; `None` if stopped before.
pub(super) fn assemble(read: &Faces<'_>, diagnostics: &mut Diagnostics, stop: Stop<'_>) -> Option<Assembled> {
    on_threads_of_caller(|| assemble_here(read, diagnostics, stop))
}

/// The same on the threads of this pool.
fn assemble_here(read: &Faces<'_>, diagnostics: &mut Diagnostics, stop: Stop<'_>) -> Option<Assembled> {
    let mut polygons = Vec::with_capacity(read.faces.len());
    let mut changed = ChangedFaces::default();
    let mut most_flattened = 0.0_f64;
    let rounding = PLANE_TOLERANCE * Aabb::around(read.corners.iter().copied()).diagonal();

    // Each face by itself, many at once.
    let may_repeat = faces_that_may_repeat(read);
    let order = FileOrder { corners: read.corners, numbers: OnceLock::new() };
    let alone = |(face, &may_repeat): (&Face, &bool)| {
        FaceAlone::cut(&read.corners[face.start..face.end], may_repeat, &order, rounding, stop)
    };

    // What they became, in their order.
    let mut seen = Seen::default();
    for (first, faces) in (0..).step_by(FACES_AT_ONCE).zip(read.faces.chunks(FACES_AT_ONCE)) {
        let alone: Option<Vec<FaceAlone>> = faces.par_iter().zip(&may_repeat[first..][..faces.len()]).map(alone).collect();
        for ((index, face), FaceAlone { corners, pieces, winding }) in (first..).zip(faces).zip(alone?) {
            let mut note = |kind, text: String| diagnostics.push(read.about(kind, text, face.number));
            if pieces.polygons.is_empty() {
                changed.drop(face.number, &read.corners[face.start..face.end], None);
                let why = if corners < 3 { "it has fewer than three different corners" } else { "it has no area" };
                note(DiagnosticKind::DegenerateFace, format!("dropped: {why}"));
                continue;
            }

            let same = winding.and_then(|winding| seen.add(index, winding));
            match same.map(|(earlier, same)| (&read.faces[earlier], same)) {
                Some((earlier, Same::Side)) => {
                    let but = if earlier.material == face.material { "" } else { " with another material" };
                    changed.drop(face.number, &read.corners[face.start..face.end], Some(earlier.number));
                    note(DiagnosticKind::DuplicateFace, format!("dropped: it repeats {}{but}", read.name(earlier.number)));
                    continue;
                }
                // A face that its file calls double-sided comes as two of one number.
                Some((front, Same::Sheet)) if front.number != face.number => {
                    let text = format!("is the back of face {}: both together are a sheet with two sides", front.number + 1);
                    note(DiagnosticKind::Sheet, text);
                }
                _ => {}
            }

            if pieces.flattened > 0.0 {
                changed.flattened.push(face.number);
                most_flattened = most_flattened.max(pieces.flattened);
            }
            note_cuts(&pieces, note);
            polygons.extend(pieces.polygons.into_iter().map(|polygon| (polygon, face.material, face.number)));
        }
    }

    note_flattened((changed.flattened.len(), most_flattened), read, diagnostics);
    Some(Assembled { polygons, changed })
}

/// The faces so far by their corners, of those that may have some in common: one for each of the two windings, as an index into the faces.
#[derive(Default)]
struct Seen(HashMap<Vec<[u64; 3]>, [Option<usize>; 2]>);

/// What a face has in common with an earlier one, beside its corners.
enum Same {
    /// The winding: a duplicate.
    Side,
    /// Not that: they are the sides of a sheet.
    Sheet,
}

impl Seen {
    /// The earlier face with the same corners, if there is one; a face that has no duplicate is kept in mind.
    fn add(&mut self, index: usize, (corners, side): (Vec<[u64; 3]>, usize)) -> Option<(usize, Same)> {
        let sides = self.0.entry(corners).or_default();
        if let Some(earlier) = sides[side] {
            return Some((earlier, Same::Side));
        }
        sides[side] = Some(index);
        sides[1 - side].map(|front| (front, Same::Sheet))
    }
}

/// A face as it is without the others.
struct FaceAlone {
    /// How many different corners it has.
    corners: usize,
    /// None if it has no area.
    pieces: Pieces,
    /// Its corners, as [`unwound`], if others may have the same.
    winding: Option<(Vec<[u64; 3]>, usize)>,
}

impl FaceAlone {
    /// Cuts a face; `None` if stopped before.
    fn cut(corners: &[DVec3], may_repeat: bool, order: &FileOrder<'_>, rounding: f64, stop: Stop<'_>) -> Option<Self> {
        let corners = distinct_corners(corners);
        let pieces = match corners.len() {
            0..3 => Pieces::NONE,
            _ => pieces_or_stop(&corners, order, rounding, stop)?,
        };
        let winding = may_repeat.then(|| unwound(&corners.iter().map(|&corner| position_key(corner)).collect::<Vec<_>>()));
        Some(Self { corners: corners.len(), pieces, winding })
    }
}

/// Notes how many faces were flattened, and by how much at most.
fn note_flattened((count, most): (usize, f64), read: &Faces<'_>, diagnostics: &mut Diagnostics) {
    if count > 0 {
        let text = format!("{count} faces were flattened, by at most {most:.1e}: rounded digits");
        let note = Diagnostic::new(DiagnosticKind::Flattened, text);
        diagnostics.push(match read.source {
            Some((file, _)) => note.at(file, 0),
            None => note,
        });
    }
}

/// Which faces may have all their corners in common with another one. Some that have not are among them, by chance.
fn faces_that_may_repeat(read: &Faces<'_>) -> Vec<bool> {
    // The sum of the hashes of a face's corners does not depend on their order.
    let hash_of = |face: &Face| {
        let corners = &read.corners[face.start..face.end];
        let before = corners.iter().cycle().skip(corners.len().saturating_sub(1));
        let distinct = corners.iter().zip(before).filter(|(corner, before)| corner != before);
        distinct.map(|(corner, _)| sampling::seed_at(corner + DVec3::ZERO, 0)).fold(0, u64::wrapping_add)
    };
    let faces = read.faces.par_iter().enumerate();
    let mut by_hash: Vec<(u64, u32)> = faces.map(|(index, face)| (hash_of(face), index as u32)).collect();
    by_hash.par_sort_unstable();
    let mut may_repeat = vec![false; read.faces.len()];
    for same in by_hash.chunk_by(|a, b| a.0 == b.0).filter(|same| same.len() > 1) {
        same.iter().for_each(|&(_, index)| may_repeat[index as usize] = true);
    }
    may_repeat
}

/// Positions in the order in which the file comes to them.
struct FileOrder<'a> {
    corners: &'a [DVec3],
    /// Counted once they are wanted.
    numbers: OnceLock<HashMap<[u64; 3], u32>>,
}

impl FileOrder<'_> {
    /// The corners of a face in an order that does not depend on where it starts nor on its winding, the first in the file first; and 1 if
    /// that is the reverse, else 0.
    fn unwound(&self, corners: &[DVec3]) -> (Vec<DVec3>, usize) {
        let numbers = self.numbers.get_or_init(|| {
            let mut numbers = HashMap::new();
            for &corner in self.corners {
                let next = numbers.len() as u32;
                numbers.entry(position_key(corner)).or_insert(next);
            }
            numbers
        });
        let own: HashMap<u32, DVec3> = corners.iter().map(|&corner| (numbers[&position_key(corner)], corner)).collect();
        let (order, side) = unwound(&corners.iter().map(|&corner| numbers[&position_key(corner)]).collect::<Vec<_>>());
        (order.iter().map(|number| own[number]).collect(), side)
    }
}

/// The pieces of a face; `None` if stopped before.
fn pieces_or_stop(corners: &[DVec3], order: &FileOrder<'_>, rounding: f64, stop: Stop<'_>) -> Option<Pieces> {
    if stop() {
        return None;
    }
    if corners.len() < MANY_CORNERS {
        return Some(pieces_of(corners, || order.unwound(corners), rounding));
    }
    let (corners, unwound) = (corners.to_vec(), order.unwound(corners));
    aside(move || pieces_of(&corners, || unwound.clone(), rounding), stop)
}

/// What `work` finds on a thread of its own; `None` if stopped before: the thread is left alone and ends by itself. On this thread where no
/// other can be started.
fn aside<T: Send + 'static>(work: impl FnOnce() -> T + Clone + Send + 'static, stop: Stop<'_>) -> Option<T> {
    let (sender, receiver) = mpsc::channel();
    let on_thread = work.clone();
    let started = std::thread::Builder::new().spawn(move || sender.send(on_thread()));
    if started.is_err() {
        return Some(work());
    }
    loop {
        match receiver.recv_timeout(BETWEEN_QUESTIONS) {
            Ok(found) => return Some(found),
            Err(RecvTimeoutError::Timeout) if stop() => return None,
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return Some(work()),
        }
    }
}

/// The corners of a face; those that follow themselves add nothing.
fn distinct_corners(corners: &[DVec3]) -> Vec<DVec3> {
    let mut distinct: Vec<DVec3> = corners.to_vec();
    distinct.dedup();
    while distinct.len() > 1 && distinct[0] == distinct[distinct.len() - 1] {
        distinct.pop();
    }
    distinct
}

/// The convex pieces of a face with these corners, which [`FileOrder`] may have unwound.
///
/// A convex face keeps its corners in the order of the file. What is changed is changed in an order that does not depend on the
/// winding, so that the two sides of a sheet stay the same.
fn pieces_of(corners: &[DVec3], unwound: impl FnOnce() -> (Vec<DVec3>, usize), rounding: f64) -> Pieces {
    let pieces = convex_pieces(corners, rounding);
    if pieces.cut == Cut::Whole && pieces.flattened == 0.0 {
        return pieces;
    }
    let (unwound, side) = unwound();
    let mut pieces = convex_pieces(&unwound, rounding);
    if side == 1 {
        pieces.polygons = pieces.polygons.iter().map(Polygon::reversed).collect();
    }
    pieces
}

/// Notes into what a face was cut.
fn note_cuts(pieces: &Pieces, mut note: impl FnMut(DiagnosticKind, String)) {
    let count = pieces.polygons.len();
    match pieces.cut {
        Cut::Whole => {}
        Cut::Concave => note(DiagnosticKind::ConcaveFace, format!("is concave: cut into {count} convex pieces")),
        Cut::NonPlanar(distance) => {
            let text = format!("is not planar (its corners lie up to {distance:.2e} off): cut into {count} triangles");
            note(DiagnosticKind::NonPlanarFace, text);
        }
    }
    if pieces.crossing {
        note(DiagnosticKind::CrossingFace, "crosses itself: its pieces may not be what was meant".to_owned());
    }
}

/// Equal for equal positions; adding 0 makes -0 and 0 the same.
fn position_key(position: DVec3) -> [u64; 3] {
    position.to_array().map(|x| (x + 0.0).to_bits())
}

/// A cycle in an order that does not depend on where it starts nor on its direction, and 1 if that is the reverse, else 0.
fn unwound<T: Copy + Ord>(cycle: &[T]) -> (Vec<T>, usize) {
    let backwards: Vec<T> = cycle.iter().rev().copied().collect();
    let (forwards, backwards) = (smallest_rotation(cycle), smallest_rotation(&backwards));
    if forwards <= backwards { (forwards, 0) } else { (backwards, 1) }
}

/// The rotation of a cycle that comes first in lexicographic order, in O(n) (Y. Shiloach, J. Algorithms 2, 1981).
fn smallest_rotation<T: Copy + Ord>(cycle: &[T]) -> Vec<T> {
    let count = cycle.len();
    let (mut one, mut other, mut same) = (0, 1, 0);
    while one < count && other < count && same < count {
        let (a, b) = (cycle[(one + same) % count], cycle[(other + same) % count]);
        if a == b {
            same += 1;
            continue;
        }
        // No rotation that starts inside of the longer run can be the smallest.
        if a > b {
            one += same + 1
        } else {
            other += same + 1
        }
        if one == other {
            other += 1;
        }
        same = 0;
    }
    let start = one.min(other);
    [&cycle[start..], &cycle[..start]].concat()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rotations_match_the_obvious_search() {
        for seed in 0..2000_u32 {
            let count = 1 + seed as usize % 9;
            let cycle: Vec<u32> = (0..count as u32).map(|k| (seed.wrapping_mul(2_654_435_761) >> (3 * k % 29)) % 3).collect();
            let obvious = (0..count).map(|k| [&cycle[k..], &cycle[..k]].concat()).min().unwrap();
            assert_eq!(smallest_rotation(&cycle), obvious, "{cycle:?}");
        }
    }
}
