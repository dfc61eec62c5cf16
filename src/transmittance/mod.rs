//! How much of the light between two places arrives: visibility of given sample pairs, by rays.
//!
//! The places and the kernel at them are the caller's business; here are only the rays, and the count of them.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use crate::scene::{Scene, Surface};
use crate::visibility::{Hit, Ray, Segment, Visibility};

/// Asks a visibility backend, and counts and times what was asked.
///
/// Where nothing can occlude anything, because every surface has all others in front of it, no segment is asked.
pub(crate) struct Rays<'a> {
    backend: &'a dyn Visibility,
    nothing_occludes: bool,
    spared: AtomicU64,
    segments: Tally,
    first_hits: Tally,
}

impl<'a> Rays<'a> {
    pub fn new(backend: &'a dyn Visibility, scene: &Scene) -> Self {
        Self {
            backend,
            nothing_occludes: nothing_occludes(scene),
            spared: AtomicU64::new(0),
            segments: Tally::default(),
            first_hits: Tally::default(),
        }
    }

    /// The same, but asks even where nothing can occlude anything.
    pub fn asking_always(self) -> Self {
        Self { nothing_occludes: false, ..self }
    }

    /// Sets `occluded[i]` to whether anything lies on `segments[i]`.
    pub fn occluded(&self, segments: &[Segment], occluded: &mut Vec<bool>) {
        occluded.clear();
        occluded.resize(segments.len(), false);
        if self.nothing_occludes {
            self.spared.fetch_add(segments.len() as u64, Ordering::Relaxed);
            return;
        }
        let start = Instant::now();
        self.backend.occluded(segments, occluded);
        self.segments.add(segments.len(), start);
    }

    /// Sets `hits[i]` to the first surface that `rays[i]` meets.
    pub fn first_hits(&self, rays: &[Ray], hits: &mut Vec<Option<Hit>>) {
        hits.clear();
        hits.resize(rays.len(), None);
        let start = Instant::now();
        self.backend.first_hits(rays, hits);
        self.first_hits.add(rays.len(), start);
    }

    /// Segments asked so far.
    pub fn segments(&self) -> &Tally {
        &self.segments
    }

    /// Rays asked so far for their first hits, which cost more than segments.
    pub fn first_hit_rays(&self) -> &Tally {
        &self.first_hits
    }

    /// Segments answered without a ray, because nothing can occlude.
    pub fn spared(&self) -> u64 {
        self.spared.load(Ordering::Relaxed)
    }

    /// Name and version of the backend.
    pub fn description(&self) -> String {
        self.backend.description()
    }
}

/// How many questions of a kind the backend was asked, and how long it took to answer.
#[derive(Default)]
pub(crate) struct Tally {
    count: AtomicU64,
    nanoseconds: AtomicU64,
}

impl Tally {
    fn add(&self, count: usize, start: Instant) {
        self.count.fetch_add(count as u64, Ordering::Relaxed);
        self.nanoseconds.fetch_add(start.elapsed().as_nanos() as u64, Ordering::Relaxed);
    }

    /// Questions so far.
    pub fn count(&self) -> u64 {
        self.count.load(Ordering::Relaxed)
    }

    /// Seconds spent in the backend, added over threads.
    pub fn seconds(&self) -> f64 {
        self.nanoseconds.load(Ordering::Relaxed) as f64 * 1e-9
    }
}

/// Whether every surface has every other in front of its plane or in it: then all see each other (a convex room seen from inside, or
/// polygons that face each other across an empty space).
///
/// O(n^2) where it is so; where it is not, the first pair that fails ends it, and a few pairs of every surface come first.
fn nothing_occludes(scene: &Scene) -> bool {
    let tolerance = 1e-9 * scene.bounds().diagonal();
    let surfaces = scene.surfaces();
    let in_front = |surface: &Surface, other: &Surface| {
        let front = surface.polygon.facet();
        surface.twin.is_none() && other.polygon.facet().vertices.iter().all(|&vertex| front.height(vertex) >= -tolerance)
    };
    let stride = surfaces.len() / (FEW_PAIRS + 1) + 1;
    let few = |index: usize| (1..=FEW_PAIRS).map(move |pair| (index + pair * stride) % surfaces.len());
    (0..surfaces.len()).all(|index| few(index).all(|other| in_front(&surfaces[index], &surfaces[other])))
        && surfaces.iter().all(|surface| surfaces.iter().all(|other| in_front(surface, other)))
}

/// Pairs of each surface that are looked at before all pairs are.
const FEW_PAIRS: usize = 4;
