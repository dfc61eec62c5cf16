//! Visibility at many resolutions in two dimensions (Soler, Sillion 1996) against exact form factors: no case outside of [F - epsilon, F + epsilon].
#![allow(clippy::print_stdout, reason = "a test tells what it measured")]

#[path = "support/triangles.rs"]
mod triangles;

use patchlight::flatland::{
    ClusterId, Hierarchy, Segment, Sightlines, Work, bound_correlation, bound_visibility_error, exact_form_factor, form_factor,
};
use rayon::prelude::*;
use triangles::Random;

/// What rounding may add: form factors are at most 1, from sums of some hundred lengths.
const ROUNDING: f64 = 1e-12;

fn segment(a: [f64; 2], b: [f64; 2]) -> Segment {
    Segment::new(a, b).unwrap()
}

/// The lower side of the unit square, and the upper one a distance above it; both face inside.
fn facing(distance: f64) -> [Segment; 2] {
    [segment([0.0, 0.0], [1.0, 0.0]), segment([1.0, distance], [0.0, distance])]
}

/// A receiver, a source and what stands around.
struct Case {
    receiver: Segment,
    source: Segment,
    occluders: Vec<Segment>,
}

impl Case {
    /// One of three is wild, the others a cluster between ends that are from small to as large as their distance. Coordinates are from a coarse grid in half of
    /// all cases, so that segments touch, lie in lines, cross, and have no length.
    fn random(seed: u64) -> Self {
        let mut random = Random(seed);
        let is_coarse = seed.is_multiple_of(2);
        let size = if seed.is_multiple_of(3) { 1.0 } else { [0.1, 0.25, 0.5][random.below(3)] };
        let mut within = |low: f64, high: f64| {
            let at = random.between(low, high);
            if is_coarse { (at * 16.0).round() / 16.0 } else { at }
        };
        let [receiver, source] = if seed.is_multiple_of(3) {
            let receiver = segment([within(-1.2, -0.2), within(-1.2, -0.6)], [within(0.2, 1.2), within(-1.2, -0.6)]);
            [receiver, segment([within(-0.2, 1.2), within(0.0, 1.2)], [within(-1.2, 0.2), within(0.0, 1.2)])]
        } else {
            let mut ends = |y: f64| [-size, size].map(|x| [within(0.8 * x, 1.2 * x), within(y - 0.2, y + 0.2)]);
            let ([left, right], [to, from]) = (ends(-1.0), ends(1.0));
            [segment(left, right), segment(from, to)]
        };
        let mut occluder = || {
            let (x, y, reach) = (within(-1.2 * size, 1.2 * size), within(-0.6, 0.6), 0.3 * size);
            segment([x, y], [x + within(-reach, reach), y + within(-reach, reach)])
        };
        let occluders = (0..1 + seed % 13).map(|_| occluder()).collect();
        Self { receiver, source, occluders }
    }

    fn exact(&self) -> f64 {
        exact_form_factor(&self.receiver, &self.source, &self.occluders)
    }
}

/// The segments in a cluster.
fn contents(hierarchy: &Hierarchy, cluster: ClusterId) -> Vec<Segment> {
    match hierarchy.children(cluster) {
        Some(children) => children.iter().flat_map(|&child| contents(hierarchy, child)).collect(),
        None => hierarchy.segment(cluster).copied().into_iter().collect(),
    }
}

#[test]
fn ten_thousand_form_factors_are_within_their_errors_and_these_within_what_was_given() {
    let runs: Vec<(Work, f64, f64)> = (0..10_000_u64)
        .into_par_iter()
        .map(|seed| {
            let case = Case::random(seed);
            let (exact, hierarchy) = (case.exact(), Hierarchy::of(&case.occluders, 16));
            // From a thousandth of what could arrive at all to twice that.
            let unoccluded = exact_form_factor(&case.receiver, &case.source, &[]);
            let tolerance = unoccluded * 2.0 * 2000_f64.powf(-Random(seed).unit());
            let found = form_factor(&case.receiver, &case.source, &hierarchy, tolerance);
            let off = (found.form_factor - exact).abs();
            assert!(off <= found.error + ROUNDING, "case {seed}: {} is not {exact} +- {}", found.form_factor, found.error);
            assert!(found.error <= tolerance, "case {seed}: {} of {tolerance} were used", found.error);
            (found.work, off, found.error)
        })
        .collect();

    // Not all by looking at everything, nor all by luck.
    let wholes = runs.iter().filter(|(work, ..)| work.wholes > 0).count();
    let mixed = runs.iter().filter(|(work, ..)| work.wholes > 0 && work.opened > 0).count();
    let apart = runs.iter().filter(|(work, ..)| work.integrals > 1).count();
    let closest = runs.iter().filter(|run| run.2 > 1e-6).map(|run| run.1 / run.2).fold(0.0, f64::max);
    println!(
        "{wholes} with clusters as wholes, {mixed} with opened ones too, {apart} with clusters apart; error / bound up to {closest:.3}"
    );
    assert!(wholes > 1000 && mixed > 1000 && apart > 1000 && closest > 0.2);
}

#[test]
fn no_error_gives_the_exact_form_factor() {
    (0..2000_u64).into_par_iter().for_each(|seed| {
        let case = Case::random(seed);
        let found = form_factor(&case.receiver, &case.source, &Hierarchy::of(&case.occluders, 8), 0.0);
        let exact = case.exact();
        assert!((found.form_factor - exact).abs() <= ROUNDING && found.error == 0.0, "case {seed}: {found:?}, {exact}");
    });
}

#[test]
fn each_cluster_keeps_its_bounds() {
    (0..2000_u64).into_par_iter().for_each(|seed| {
        let case = Case::random(seed);
        let Some(sightlines) = Sightlines::between(&case.receiver, &case.source) else { return };
        let (unoccluded, hierarchy) = (sightlines.unoccluded(), Hierarchy::of(&case.occluders, 16));
        let exact = |cluster| exact_form_factor(&case.receiver, &case.source, &contents(&hierarchy, cluster));
        let mut waiting: Vec<ClusterId> = hierarchy.root().into_iter().collect();
        while let Some(cluster) = waiting.pop() {
            let alone = exact(cluster);
            let Some(seen) = bound_visibility_error(&sightlines, &hierarchy, cluster) else {
                assert!((alone - unoccluded).abs() <= ROUNDING, "case {seed}: no sightline meets it");
                continue;
            };
            assert!(unoccluded - alone <= seen.through_box + ROUNDING);
            if let Some(whole) = seen.as_whole {
                let estimate = unoccluded - (1.0 - whole.transmittance) * seen.through_box;
                assert!((estimate - alone).abs() <= whole.error + ROUNDING, "case {seed}: {estimate}, {alone}, {}", whole.error);
            }
            if let Some(children) = hierarchy.children(cluster) {
                let [first, second] = children.map(exact);
                let chi = alone - (first + second - unoccluded);
                let most = bound_correlation(&sightlines, &hierarchy, children);
                assert!(chi >= -ROUNDING && chi <= most + ROUNDING, "case {seed}: chi is {chi}, at most {most}");
                waiting.extend(children);
            }
        }
    });
}

/// With odd numbers of directions one is sampled exactly along x. Many leave little between samples that `rho_1` has to bound.
const ODD: usize = 17;
const FINE: usize = 1025;

#[test]
fn clusters_that_are_all_one_term_come_near_their_bound() {
    // Receiver and source on either side, light along x.
    let ends = |x: f64, half: f64| [segment([-x, half], [-x, -half]), segment([x, -half], [x, half])];
    let uneven = vec![segment([0.0, -0.25], [0.0, 0.25]), segment([0.0, 0.749], [0.0, 0.75])];
    let blind: Vec<Segment> = (0..101).map(|k| f64::from(k - 50) / 100.0).map(|y| segment([-0.1, y], [0.1, y])).collect();
    let gate = vec![segment([-1.0, 0.0], [-1.0, 1e-4]), segment([1.0, 0.0], [1.0, 1e-4])];
    let cases = [
        // Light along one direction meets the opaque half alone: rho_2.
        ("uneven", ends(100.0, 0.25), uneven, FINE, 0.3),
        // Open along x, all but closed beside it: rho_1.
        ("a blind", ends(10.0, 3.0), blind, ODD, 0.6),
        // Closed along x, and open beside it, where the sampled lines miss the box: rho_2 over the widest shadow.
        ("a gate", ends(3.0, 0.5), gate, FINE, 0.2),
    ];
    for (name, [receiver, source], occluders, directions, least) in cases {
        let sightlines = Sightlines::between(&receiver, &source).unwrap();
        let hierarchy = Hierarchy::of(&occluders, directions);
        let seen = bound_visibility_error(&sightlines, &hierarchy, hierarchy.root().unwrap()).unwrap();
        let whole = seen.as_whole.unwrap();
        let estimate = sightlines.unoccluded() - (1.0 - whole.transmittance) * seen.through_box;
        let off = (estimate - exact_form_factor(&receiver, &source, &occluders)).abs();
        println!("{name}: {off:.2e} off, bound {:.2e}", whole.error);
        assert!(off <= whole.error + ROUNDING && off > least * whole.error, "{name}: {off} off, bound {}", whole.error);
    }
}

#[test]
fn transmittance_along_a_line_is_what_its_shadow_says() {
    let case = Case::random(25);
    let hierarchy = Hierarchy::of(&case.occluders, 32);
    let root = hierarchy.root().unwrap();
    let ([low, high], stored) = (hierarchy.bounding_box(root), hierarchy.directional(root).unwrap());
    for k in 0..32 {
        let theta = (f64::from(k) + 0.5) * std::f64::consts::PI / 32.0;
        let width = (high[0] - low[0]) * theta.cos().abs() + (high[1] - low[1]) * theta.sin().abs();
        let count = 20_000;
        let rho = |k: i32| width * ((f64::from(k) + 0.5) / f64::from(count) - 0.5);
        let mean = (0..count).map(|k| hierarchy.transmittance(root, rho(k), theta)).sum::<f64>() / f64::from(count);
        let found = stored.around(theta, 0.0);
        assert!((found.mean - mean).abs() < 1e-3, "{}, {mean}", found.mean);
        assert!((found.rho_2 - (width * mean * (1.0 - mean)).sqrt()).abs() < 2e-3);
    }
}

#[test]
fn strings_give_known_form_factors() {
    let ([receiver, source], edge) = (facing(1.0), 2_f64.sqrt());
    let exact = |occluders: &[Segment]| exact_form_factor(&receiver, &source, occluders);
    let close = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-14, "{found}, {expected}");
    close(exact(&[]), edge - 1.0);
    // A half-plane midway hides half, from either side.
    close(exact(&[segment([-5.0, 0.5], [0.5, 0.5])]), 0.5 * (edge - 1.0));
    close(exact(&[segment([7.0, 0.5], [0.5, 0.5])]), 0.5 * (edge - 1.0));
    close(exact(&[segment([-5.0, 0.5], [5.0, 0.5])]), 0.0);
    // A slit midway: both diagonals cross in it, the uncrossed strings bend around its ends.
    for width in [0.01, 0.2, 0.9] {
        let [left, right] = [0.5 - 0.5 * width, 0.5 + 0.5 * width];
        let slit = [segment([-1.0, 0.5], [left, 0.5]), segment([right, 0.5], [2.0, 0.5])];
        let bent = 4.0 * (left * left + 0.25).sqrt();
        close(exact(&slit), 0.5 * (2.0 * edge - bent));
        // What goes through the slit is what a bar in its place takes away.
        close(exact(&[segment([left, 0.5], [right, 0.5])]), edge - 1.0 - 0.5 * (2.0 * edge - bent));
    }
    // Behind either, and in the receiver's line.
    close(
        exact(&[segment([-1.0, -0.1], [2.0, -0.1]), segment([0.0, 1.2], [1.0, 1.2]), segment([-1.0, 0.0], [2.0, 0.0])]),
        edge - 1.0,
    );
}

#[test]
fn what_leaves_a_wall_of_a_closed_room_arrives_somewhere() {
    let mut random = Random(3);
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let walls: Vec<Segment> = (0..4).map(|k| segment(corners[k], corners[(k + 1) % 4])).collect();
    for count in [1, 4, 12] {
        let mut place = || [0.1 + 0.8 * random.unit(), 0.1 + 0.8 * random.unit()];
        let inside: Vec<Segment> = (0..count).map(|_| segment(place(), place())).collect();
        // Segments cross: what is hidden by the other half of a front is hidden.
        let fronts = inside.iter().flat_map(|part| {
            let [a, b] = part.ends();
            [segment(a, b), segment(b, a)]
        });
        let sum: f64 = walls[1..].iter().copied().chain(fronts).map(|to| exact_form_factor(&walls[0], &to, &inside)).sum();
        assert!((sum - 1.0).abs() < 1e-12, "{sum}");
    }
}

#[test]
fn exact_form_factors_are_reciprocal_and_add_up() {
    for seed in 0..300 {
        let Case { receiver, source, occluders } = Case::random(seed);
        let [there, back] = [(receiver, source), (source, receiver)].map(|(r, s)| exact_form_factor(&r, &s, &occluders));
        assert!((receiver.length() * there - source.length() * back).abs() < 1e-12, "case {seed}");
        let [a, b] = source.ends();
        let middle = [0.3 * a[0] + 0.7 * b[0], 0.3 * a[1] + 0.7 * b[1]];
        let parts = [segment(a, middle), segment(middle, b)].map(|part| exact_form_factor(&receiver, &part, &occluders));
        assert!((parts[0] + parts[1] - there).abs() < 1e-12, "case {seed}: {parts:?}, {there}");
    }
}

#[test]
fn degenerate_input_stays_within_its_errors() {
    let [receiver, source] = facing(1.0);
    let point = segment([0.5, 0.5], [0.5, 0.5]);
    let corner = segment([0.0, 0.0], [0.0, 1.0]);
    let cluster: Vec<Segment> = (0..8).map(|k| 0.1 + 0.1 * f64::from(k)).map(|x| segment([x, 0.4], [x + 0.03, 0.7])).collect();
    let with = |more: &[Segment]| cluster.iter().chain(more).copied().collect::<Vec<_>>();
    let cases: Vec<(&str, Segment, Segment, Vec<Segment>)> = vec![
        ("nothing in between", receiver, source, vec![]),
        ("ends that touch", receiver, segment([1.0, 0.0], [1.0, 1.0]), cluster.clone()),
        ("a receiver of no length", point, source, cluster.clone()),
        ("a source of no length", receiver, point, cluster.clone()),
        ("a receiver in the cluster", segment([0.3, 0.5], [0.6, 0.55]), source, cluster.clone()),
        ("a source in the cluster", receiver, segment([0.8, 0.55], [0.3, 0.5]), cluster.clone()),
        ("a source across the receiver's line", receiver, segment([1.5, -1.0], [0.8, 1.5]), cluster.clone()),
        ("ends that cross", segment([0.0, 0.3], [1.0, 0.6]), segment([0.5, 1.0], [0.4, 0.0]), cluster.clone()),
        ("ends in one line", receiver, segment([2.0, 0.0], [1.0, 0.0]), cluster.clone()),
        ("the same segment twice", receiver, receiver, cluster.clone()),
        ("an occluder across the receiver's line", receiver, source, with(&[segment([0.2, -0.5], [0.3, 0.5])])),
        ("an occluder across both lines", receiver, source, with(&[segment([0.2, -0.5], [0.3, 1.5])])),
        ("an occluder on the receiver", receiver, source, with(&[receiver])),
        ("an occluder that touches both", receiver, source, with(&[corner])),
        ("an occluder that is a point", receiver, source, with(&[point, point])),
        ("only points", receiver, source, vec![point; 5]),
        ("all at one place", receiver, source, vec![cluster[3]; 9]),
        (
            "all in one line along an axis",
            receiver,
            source,
            (0..6).map(|k| f64::from(k) / 6.0).map(|x| segment([x, 0.5], [x + 0.05, 0.5])).collect(),
        ),
        (
            "all in one line along light",
            receiver,
            source,
            (0..6).map(|k| f64::from(k) / 7.0).map(|y| segment([0.5, y], [0.5, y + 0.1])).collect(),
        ),
        ("far away", receiver, source, with(&[segment([1e99, 1e99], [-1e99, 1e99])])),
        ("tiny", receiver, source, with(&[segment([0.5, 0.5], [0.5 + 1e-300, 0.5])])),
    ];
    for (name, receiver, source, occluders) in cases {
        let exact = exact_form_factor(&receiver, &source, &occluders);
        assert!((0.0..=1.0).contains(&exact), "{name}: {exact}");
        for tolerance in [0.0, 1e-3, 0.03, 0.2, 2.0, f64::INFINITY] {
            let found = form_factor(&receiver, &source, &Hierarchy::of(&occluders, 16), tolerance);
            let off = (found.form_factor - exact).abs();
            assert!(off <= found.error + ROUNDING && found.error <= tolerance, "{name}, {tolerance}: {found:?}, {exact}");
        }
    }
}
