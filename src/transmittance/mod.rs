//! Transmittance: how much light between two places arrives. Callers choose the pairs of points; here are rays, and counts of them, and [`maps`] of what
//! clusters let through.

mod clear_pairs;
pub mod maps;

use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use clear_pairs::ClearPairs;
use glam::DVec3;

use crate::scene::{Scene, Surface};
use crate::team::Share;
use crate::visibility::{Hit, NO_PLANE, Ray, Segment, SurfaceBoxes, Visibility};

/// Work on a visible part, in corners held against planes, that takes as long as a segment: some 2 ns each, and 0.12 us. What both cost is told by
/// `cargo bench --bench direct`; a wrong figure costs time, not light.
pub(crate) const STEPS_PER_RAY: u64 = 60;

/// Casts rays through a visibility backend, and counts and times them. Segments of which it is proved that nothing occludes them
/// are not cast.
pub(crate) struct Rays<'a> {
    backend: &'a dyn Visibility,
    proof: Proof,
    /// A ball around the scene, in metres.
    centre: DVec3,
    radius: f64,
    spared: AtomicU64,
    segments: Tally,
    first_hits: Tally,
    /// Exact parts of what is seen, in steps.
    steps: AtomicU64,
    share: Share<'a>,
    /// Found when somebody asks for them.
    sheets: OnceLock<SurfaceBoxes>,
}

/// Where nothing can occlude anything.
enum Proof {
    /// Everywhere: every surface has all others in front of it.
    Everywhere,
    /// Between some planes.
    Between(ClearPairs),
    /// Nothing is proved.
    Nowhere,
}

impl<'a> Rays<'a> {
    pub fn new(backend: &'a dyn Visibility, scene: &Scene) -> Self {
        let proof = match nothing_occludes(scene) {
            true => Proof::Everywhere,
            false => ClearPairs::of(scene).map_or(Proof::Nowhere, Proof::Between),
        };
        let bounds = scene.bounds();
        let (centre, radius) = (bounds.centre(), 0.5 * bounds.diagonal());
        let (segments, first_hits) = (Tally::default(), Tally::default());
        let ([spared, steps], share, sheets) = ([0, 0].map(AtomicU64::new), Share::WHOLE, OnceLock::new());
        Self { backend, proof, centre, radius, spared, segments, first_hits, steps, share, sheets }
    }

    /// The same for a process that casts its share of them.
    pub fn shared(self, share: Share<'a>) -> Self {
        Self { share, ..self }
    }

    /// Which batches of work that casts many rays this process does.
    pub fn share(&self) -> Share<'a> {
        self.share
    }

    /// The boxes of the sheets of the scene, whose surfaces are those that rays go through.
    pub fn sheets(&self, scene: &Scene) -> &SurfaceBoxes {
        self.sheets.get_or_init(|| SurfaceBoxes::of_sheets(scene))
    }

    /// The same, but casts rays even in a scene where nothing can occlude anything.
    pub fn asking_in_clear_scenes(self) -> Self {
        match self.proof {
            Proof::Everywhere => Self { proof: Proof::Nowhere, ..self },
            _ => self,
        }
    }

    /// The same, but casts rays even between clear pairs of planes.
    pub fn asking_between_clear_planes(self) -> Self {
        match self.proof {
            Proof::Between(_) => Self { proof: Proof::Nowhere, ..self },
            _ => self,
        }
    }

    /// Sets `occluded[i]` to whether anything lies on `segments[i]`.
    pub fn occluded(&self, segments: &[Segment], occluded: &mut Vec<bool>) {
        occluded.clear();
        occluded.resize(segments.len(), false);
        match &self.proof {
            // Of points in space nothing is proved.
            Proof::Everywhere => {
                let is_between_surfaces = |segment: &Segment| segment.from_plane != NO_PLANE && segment.to_plane != NO_PLANE;
                self.ask_but_clear(segments, is_between_surfaces, occluded);
            }
            Proof::Between(pairs) => self.ask_but_clear(segments, |segment| pairs.is_clear(segment), occluded),
            Proof::Nowhere => self.ask(segments, occluded),
        }
    }

    /// Asks about the segments that are not clear by proof.
    fn ask_but_clear(&self, segments: &[Segment], is_clear: impl Fn(&Segment) -> bool, occluded: &mut [bool]) {
        let (places, open): (Vec<usize>, Vec<Segment>) =
            segments.iter().copied().enumerate().filter(|(_, segment)| !is_clear(segment)).unzip();
        self.spared.fetch_add((segments.len() - open.len()) as u64, Ordering::Relaxed);
        let mut answers = vec![false; open.len()];
        self.ask(&open, &mut answers);
        places.into_iter().zip(answers).for_each(|(place, answer)| occluded[place] = answer);
    }

    /// A ball around the scene: its centre, and its radius in metres.
    pub fn ball(&self) -> (DVec3, f64) {
        (self.centre, self.radius)
    }

    /// How far from a point nothing of the scene lies any more, in metres.
    pub fn beyond(&self, point: DVec3) -> f64 {
        // Beyond the ball around the scene, by its radius.
        point.distance(self.centre) + 2.0 * self.radius
    }

    /// Asks the backend, and counts.
    fn ask(&self, segments: &[Segment], occluded: &mut [bool]) {
        let start = Instant::now();
        self.backend.occluded(segments, occluded);
        self.segments.add(segments.len(), start);
    }

    /// Whether it is proved that nothing occludes anything between surfaces of two planes.
    pub fn is_clear_between(&self, planes: [u32; 2]) -> bool {
        match &self.proof {
            Proof::Everywhere => true,
            Proof::Between(pairs) => pairs.is_clear_between(planes),
            Proof::Nowhere => false,
        }
    }

    /// Whether it is proved that nothing occludes anything in the whole scene.
    pub fn is_clear_everywhere(&self) -> bool {
        matches!(self.proof, Proof::Everywhere)
    }

    /// Sets `hits[i]` to the first surface that `rays[i]` meets.
    pub fn first_hits(&self, rays: &[Ray], hits: &mut Vec<Option<Hit>>) {
        self.ask_first_hits(|hits| self.backend.first_hits(rays, hits), rays.len(), hits);
    }

    /// The same for rays from one point of which each goes almost the same way as the next.
    pub fn coherent_first_hits(&self, rays: &[Ray], hits: &mut Vec<Option<Hit>>) {
        self.ask_first_hits(|hits| self.backend.coherent_first_hits(rays, hits), rays.len(), hits);
    }

    /// Asks the backend for so many first hits, and counts.
    fn ask_first_hits(&self, ask: impl FnOnce(&mut [Option<Hit>]), count: usize, hits: &mut Vec<Option<Hit>>) {
        hits.clear();
        hits.resize(count, None);
        let start = Instant::now();
        ask(hits);
        self.first_hits.add(count, start);
    }

    /// The first surface that a ray meets.
    pub fn first_hit(&self, ray: Ray) -> Option<Hit> {
        let mut hit = [None];
        let start = Instant::now();
        self.backend.first_hits(&[ray], &mut hit);
        self.first_hits.add(1, start);
        hit[0]
    }

    /// Segments and first hits that all processes have asked for so far.
    pub fn cast_by_all(&self) -> [u64; 2] {
        [&self.segments, &self.first_hits].map(|of| self.share.sum(of.count()))
    }

    /// Notes work on what is seen exactly, in [`STEPS_PER_RAY`].
    pub fn note_exact(&self, steps: u64) {
        self.steps.fetch_add(steps, Ordering::Relaxed);
    }

    /// What all processes have done for what is seen exactly, in segments that take as long.
    pub fn exact_parts_by_all(&self) -> f64 {
        self.share.sum(self.steps.load(Ordering::Relaxed)) as f64 / STEPS_PER_RAY as f64
    }

    /// Segments cast so far.
    pub fn segments(&self) -> &Tally {
        &self.segments
    }

    /// Rays cast so far for their first hits; they cost more than segments.
    pub fn first_hit_rays(&self) -> &Tally {
        &self.first_hits
    }

    /// Segments that were not cast, because nothing can occlude them.
    pub fn spared(&self) -> u64 {
        self.spared.load(Ordering::Relaxed)
    }

    /// Name and version of the backend.
    pub fn description(&self) -> String {
        self.backend.description()
    }
}

/// How many queries of a kind the backend answered, and how long it took.
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

    /// Queries so far.
    pub fn count(&self) -> u64 {
        self.count.load(Ordering::Relaxed)
    }

    /// Seconds spent in the backend, added over threads.
    pub fn seconds(&self) -> f64 {
        self.nanoseconds.load(Ordering::Relaxed) as f64 * 1e-9
    }
}

/// Whether every surface has every other in front of its plane or in it. Then all see each other: a convex room seen from inside,
/// or polygons that face each other across an empty space.
///
/// O(n^2) if it is so. If not, the first pair that fails ends the test, and [`FEW_PAIRS`] of each surface are tested first to find
/// one. Of more surfaces than [`MOST_SURFACES`] it is not known: rays tell.
fn nothing_occludes(scene: &Scene) -> bool {
    let tolerance = 1e-9 * scene.bounds().diagonal();
    let surfaces = scene.surfaces();
    if surfaces.len() > MOST_SURFACES {
        return false;
    }
    let in_front = |surface: &Surface, other: &Surface| {
        let front = surface.polygon.facet();
        surface.twin.is_none() && other.polygon.facet().vertices.iter().all(|&vertex| front.height(vertex) >= -tolerance)
    };
    let stride = surfaces.len() / (FEW_PAIRS + 1) + 1;
    let few = |index: usize| (1..=FEW_PAIRS).map(move |pair| (index + pair * stride) % surfaces.len());
    (0..surfaces.len()).all(|index| few(index).all(|other| in_front(&surfaces[index], &surfaces[other])))
        && surfaces.iter().all(|surface| surfaces.iter().all(|other| in_front(surface, other)))
}

/// With so many surfaces all pairs take some tenths of a second, in which nothing could be cancelled.
const MOST_SURFACES: usize = 8192;

/// Pairs of each surface that are tested before all others.
const FEW_PAIRS: usize = 4;
