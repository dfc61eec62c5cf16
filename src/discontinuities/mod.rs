//! Where irradiance on a surface is not smooth: lines, from the scene and from what is said to send light (Lischinski 1994, sections 2.4 and 4.1.2).
//!
//! - **D0**, irradiance jumps: where surfaces touch or cross (`contacts`).
//! - **D1** and **D2**, its first or second derivative jumps: edge-vertex events of sources with convex or other polygons between (`events`).
//! - D0 or D1 where shadows of lights that are no surfaces end (`lights`).
//!
//! All curves of such events are straight, since the events lie in planes. They are exact but for what counts as touching, a millionth of the scene's
//! size: files round coordinates by as much, so the signs of exact predicates would mean nothing. What is left out stands in `events`.
//!
//! **What of it matters.** Each segment has a bound of how much irradiance it can change (`effect`). Of each receiver the least are left out, as
//! many as together stay below what the receiver tolerates. A source that cannot bring more than that to a receiver at all casts no curve there,
//! so sources may be all surfaces that shine or reflect (section 6.2.2): those that dominate a receiver remain. The bounds are used before the work
//! is done: edges and corners too far from a source for it to bring what any receiver does not tolerate are not looked at, and others are followed
//! only as far behind them as what they hide matters. So a curve that changes no more than is tolerated is left out wherever it alone would be.
//!
//! **Cost.** With `l` source edges and `m` edges there are `O(l m)` wedges; each asks a tree of boxes for what its plane cuts. In large scenes there
//! are too many of them even so: of all sources together `MOST_PAIRS` are followed, of each by its share of the light, those that matter
//! farthest; how many edges and corners are left is counted.

mod contacts;
mod corners;
mod counters;
mod curves;
mod edges;
mod effect;
mod emitters;
mod envelope;
mod events;
mod faces;
mod fan;
mod lights;
mod occluders;
mod outlines;
mod points;
mod segments;
mod svg;
mod weld;

use rayon::prelude::*;

pub use counters::Counters;
pub use segments::{CurveSegment, Degree, Discontinuities, Segment, Source};
pub use svg::svg;

use crate::progress::Stop;
use crate::scene::{Light, LightShape, Scene, SurfaceId};
use curves::{Curve, Found};
use effect::Lit;
use emitters::Emitter;
use events::Tracer;
use faces::Faces;
use lights::LightTracer;
use occluders::{Occluder, Occluders};

/// What pictures and pages tolerate: curves that change irradiance by less than this part of the largest exitance, or of the most that lights bring to an
/// element, are not shown there.
pub const TOLERANCE_SHOWN: f64 = 1e-3;

/// Of all sources together about so many pairs of a side of a source and an edge or corner are followed, of each source by its share of all light: a
/// minute or two of one core in scenes of some hundred thousand surfaces.
const MOST_PAIRS: f64 = 524_288.0;

/// Of each light that is no surface as many edges are followed as make so many of all lights together: some seconds of one core.
const MOST_OF_LIGHTS: usize = 65_536;

/// The discontinuities of the light that emitters send, the sum of their channels: what changes irradiance by less than `tolerance` of the largest
/// exitance is left out.
pub fn of_emitters(scene: &Scene, tolerance: f64) -> Discontinuities {
    of_emitters_until(scene, tolerance, &|| false)
}

/// As [`of_emitters`]; once `stop` says so, what was found by then.
pub(crate) fn of_emitters_until(scene: &Scene, tolerance: f64, stop: Stop<'_>) -> Discontinuities {
    let exitance = |id: SurfaceId| scene.material_of(id).exitance.iter().sum::<f64>();
    let sources: Vec<Source> = ids(scene).map(|surface| Source { surface, radiosity: exitance(surface) }).collect();
    let most = sources.iter().map(|source| source.radiosity).fold(0.0, f64::max);
    find(scene, &sources, &|_| tolerance * most, stop)
}

/// The lines where surfaces touch or cross, alone.
pub fn of_contacts(scene: &Scene) -> Discontinuities {
    find(scene, &[], &|_| 0.0, &|| false)
}

/// What the shape of a scene tells, whatever lights it: contacts, and the feet of edges that stand close over a surface, as D1 without a source.
///
/// The same for any number of threads. Once `stop` says so, what was found by then is returned.
pub(crate) fn of_shape(scene: &Scene, stop: Stop<'_>) -> Discontinuities {
    let faces = Faces::of(scene);
    let found = shape(&faces, stop);
    gather(&faces, found, &[], &|_| 0.0, stop)
}

/// The same; and together with it where shadows of lights that are no surfaces end, as far as each receiver does not tolerate that, which is told in
/// W/m^2.
pub(crate) fn of_shape_and_lights(
    scene: &Scene,
    tolerance: &(dyn Fn(SurfaceId) -> f64 + Sync),
    stop: Stop<'_>,
) -> [Discontinuities; 2] {
    let faces = Faces::of(scene);
    let found = shape(&faces, stop);
    let mut with_lights = shadows(&faces, tolerance, stop);
    with_lights.append(found.clone());
    [gather(&faces, found, &[], &|_| 0.0, stop), gather(&faces, with_lights, &[], tolerance, stop)]
}

/// Where shadows of lights that are no surfaces end: what changes irradiance by less than `tolerance`, in W/m^2, is left out.
pub fn of_lights(scene: &Scene, tolerance: f64) -> Discontinuities {
    of_lights_until(scene, tolerance, &|| false)
}

/// As [`of_lights`]; once `stop` says so, what was found by then.
pub(crate) fn of_lights_until(scene: &Scene, tolerance: f64, stop: Stop<'_>) -> Discontinuities {
    let (faces, tolerance) = (Faces::of(scene), |_: SurfaceId| tolerance);
    let found = shadows(&faces, &tolerance, stop);
    gather(&faces, found, &[], &tolerance, stop)
}

/// Contacts, and the feet of what stands close.
fn shape(faces: &Faces<'_>, stop: Stop<'_>) -> Found {
    let mut found = find_on_each(faces, contacts::find, stop);
    let find_outlines = |faces: &Faces<'_>, id: SurfaceId, found: &mut Found| {
        if !faces.is_second_side(id) {
            outlines::find(faces, id, found);
        }
    };
    found.append(find_on_each(faces, find_outlines, stop));
    found
}

/// The borders of shadows of lights.
fn shadows(faces: &Faces<'_>, tolerance: &(dyn Fn(SurfaceId) -> f64 + Sync), stop: Stop<'_>) -> Found {
    let mut found = Found::default();
    let casts = |light: &&Light| light.is_on() && !matches!(light.shape, LightShape::Sky(_));
    let lights: Vec<&Light> = faces.scene.lights().iter().filter(casts).collect();
    if lights.is_empty() || stop() {
        return found;
    }
    let edges = edges::welded(faces);
    found.counters.edges = edges.len() as u64;
    let tracer = LightTracer { faces, bounds: faces.scene.bounds(), tolerance, stop };
    for (light, number) in lights.iter().zip(0..) {
        found.append(tracer.follow(&edges, light, number, MOST_OF_LIGHTS.div_ceil(lights.len())));
    }
    found
}

fn ids(scene: &Scene) -> impl Iterator<Item = SurfaceId> {
    (0..scene.surfaces().len() as u32).map(SurfaceId)
}

/// The discontinuities of the light of `sources`. Each receiver may be wrong by its `tolerance` in W/m^2 for each curve that is not followed, and for all
/// together of those that were found and are left out on it.
///
/// The same for any number of threads. Once `stop` says so, what was found by then is returned.
pub(crate) fn find(
    scene: &Scene,
    sources: &[Source],
    tolerance: &(dyn Fn(SurfaceId) -> f64 + Sync),
    stop: Stop<'_>,
) -> Discontinuities {
    let faces = Faces::of(scene);
    let mut found = find_on_each(&faces, contacts::find, stop);

    // Events of each emitter.
    let emitters = emitters::emitters(&faces, sources);
    if !emitters.is_empty() {
        let occluders = Occluders::of(&faces, &mut found.counters);
        let least = ids(scene).map(tolerance).fold(f64::INFINITY, f64::min);
        let power = |emitter: &Emitter| emitter.radiosity * emitter.area;
        let whole: f64 = emitters.iter().map(power).sum();
        for (emitter, number) in emitters.iter().zip(0..) {
            let lit = Lit::by(&faces, emitter, tolerance, least);
            let pairs = MOST_PAIRS * power(emitter) / whole;
            found.append(follow(&faces, &occluders, &lit, (number, pairs), stop));
        }
    }
    gather(&faces, found, &emitters, tolerance, stop)
}

/// What is found surface by surface, in parallel.
fn find_on_each(faces: &Faces<'_>, find: impl Fn(&Faces<'_>, SurfaceId, &mut Found) + Sync, stop: Stop<'_>) -> Found {
    let of = |id: u32| {
        let mut found = Found::default();
        if !stop() {
            find(faces, SurfaceId(id), &mut found);
        }
        found
    };
    let parts: Vec<Found> = (0..faces.scene.surfaces().len() as u32).into_par_iter().map(of).collect();
    let mut found = Found::default();
    parts.into_iter().for_each(|part| found.append(part));
    found
}

/// The events of an emitter, which has a number, with about this many pairs at most.
fn follow(faces: &Faces<'_>, occluders: &Occluders, lit: &Lit<'_>, (number, pairs): (u32, f64), stop: Stop<'_>) -> Found {
    /// Edges and corners that a thread takes at a time.
    const AT_ONCE: usize = 32;
    let mut found = Found::default();
    let rims = lit.emitter.rims.len();
    found.counters.source_edges = rims as u64;
    found.counters.weak_pairs = (faces.scene.surfaces().len() - lit.count()) as u64;
    if lit.count() == 0 {
        return found;
    }
    let before = occluders.before(lit, (pairs / rims as f64).ceil() as usize, &mut found.counters);
    let follow = |body: &dyn Fn(&mut Tracer<'_>)| {
        let mut found = Found::default();
        if !stop() {
            body(&mut Tracer::new(faces, number, lit, &mut found));
        }
        found
    };
    let of_some = |some: &[&Occluder]| follow(&|tracer| some.iter().for_each(|occluder| tracer.occluder(occluder)));
    let parts: Vec<Found> = before.par_chunks(AT_ONCE).map(of_some).collect();
    parts.into_iter().for_each(|part| found.append(part));
    found.append(follow(&|tracer| tracer.horizon()));
    found
}

/// Welds the curves of each receiver; once stopped, of no more.
fn gather(
    faces: &Faces<'_>,
    found: Found,
    emitters: &[Emitter],
    tolerance: &(dyn Fn(SurfaceId) -> f64 + Sync),
    stop: Stop<'_>,
) -> Discontinuities {
    let Found { curves, mut counters } = found;
    let mut per_receiver: Vec<Vec<Curve>> = vec![Vec::new(); faces.scene.surfaces().len()];
    for curve in curves.into_iter().take_while(|_| !stop()) {
        per_receiver[curve.receiver.index()].push(curve);
    }
    let name = |emitter: u32| emitters.get(emitter as usize).map(|emitter| emitter.pieces[0]);
    let of = |(id, curves): (usize, Vec<Curve>)| {
        let curves = if stop() { Vec::new() } else { curves };
        weld::weld(faces, curves, tolerance(SurfaceId(id as u32)), name)
    };
    let welded: Vec<_> = per_receiver.into_par_iter().enumerate().map(of).collect();

    let (mut segments, mut first) = (Vec::new(), vec![0]);
    for (own, counted) in welded {
        segments.extend(own);
        first.push(segments.len() as u32);
        counters += counted;
    }
    Discontinuities::new(segments, first, counters)
}
