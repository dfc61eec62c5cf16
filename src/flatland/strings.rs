//! The exact form factor by lengths of strings, every occluder taken as it is: what approximations are judged by.
//!
//! Hottel's rule (Hottel 1954; Hottel and Sarofim 1967, section 2.5) has the form factor from the lengths of strings that are stretched between
//! the ends. With many occluders it is applied piece by piece: where the line through two ends of segments meets the receiver, what is seen
//! past what may change there. Between two such points x, x' each gap that the source is seen through lies between the same two
//! points v and w, and the sightlines through it measure `(|w - x| + |v - x'|) - (|v - x| + |w - x'|)`, crossed strings less uncrossed.
//!
//! It shares with the rest of this layer only how segments are cut at the lines of receiver and source.
//!
//! **Cost.** With n occluders `O(n^3 log n)`.

use glam::DVec2;

use super::segment::Segment;
use super::sightlines::Sightlines;

/// The form factor from the front of a receiver to that of a source past segments that block: exact, up to rounding.
///
/// It is 0 for a receiver or a source with no length, and for fronts that do not see each other. What lies in the line of receiver or source blocks nothing.
pub fn exact_form_factor(receiver: &Segment, source: &Segment, occluders: &[Segment]) -> f64 {
    let Some(sightlines) = Sightlines::between(receiver, source) else { return 0.0 };
    let [receiver, source] = sightlines.parts();
    let [a, b] = receiver.points();
    let along = (b - a) / a.distance(b);
    // What was cut at the receiver's line may lie behind it by rounding.
    let in_frame = |point: DVec2| DVec2::new(along.dot(point - a), along.perp_dot(point - a).abs());
    let occluders: Vec<[DVec2; 2]> =
        occluders.iter().filter_map(|occluder| sightlines.cut(occluder)).map(|part| part.points().map(in_frame)).collect();
    let source = source.points().map(in_frame);

    let mut all = occluders.clone();
    all.push(source);
    let places = events(all.as_flattened(), receiver.length());
    let piece = |ends: &[f64]| visible_between([ends[0], ends[1]], source, &occluders);
    sightlines.part_of_all(places.windows(2).filter(|ends| ends[0] < ends[1]).map(piece).sum())
}

/// Where lines through two points meet the receiver, from 0 to `length`: in order, with both ends.
fn events(points: &[DVec2], length: f64) -> Vec<f64> {
    let mut places = vec![0.0, length];
    for (k, p) in points.iter().enumerate() {
        let through = points[k + 1..].iter().map(|q| p.x + (q.x - p.x) * (p.y / (p.y - q.y)));
        // A point on the receiver's line hides from one side of it what it shows to the other.
        let own = (p.y == 0.0).then_some(p.x);
        places.extend(through.chain(own).filter(|&place| place > 0.0 && place < length));
    }
    places.sort_unstable_by(f64::total_cmp);
    places
}

/// The measure of visible sightlines that leave the receiver between two places, past which nothing that is seen changes its order.
fn visible_between(ends: [f64; 2], source: [DVec2; 2], occluders: &[[DVec2; 2]]) -> f64 {
    // From the middle: each segment from right to left, as angles ascend.
    let x = DVec2::new(0.5 * (ends[0] + ends[1]), 0.0);
    let seen = |segment: &[DVec2; 2]| {
        let [a, b] = segment.map(|end| ((end - x).to_angle(), end));
        if a.0 <= b.0 { [a, b] } else { [b, a] }
    };
    let [first, last] = seen(&source);
    let mut hidden: Vec<_> = occluders.iter().map(seen).filter(|[low, high]| low.0 < last.0 && high.0 > first.0).collect();
    hidden.sort_unstable_by(|a, b| a[0].0.total_cmp(&b[0].0));

    // Gaps between what is hidden so far and the next.
    let (mut sum, mut open) = (0.0, first);
    for [low, high] in hidden {
        if low.0 > open.0 {
            sum += strings(ends, [open.1, low.1]);
        }
        if high.0 > open.0 {
            open = high;
        }
    }
    if last.0 > open.0 { sum + strings(ends, [open.1, last.1]) } else { sum }
}

/// Crossed strings less uncrossed between two places of the receiver and a gap, whose right side is `gap[0]`.
fn strings(ends: [f64; 2], gap: [DVec2; 2]) -> f64 {
    // How much nearer a point is to the second place: the difference of the squares over the sum, without cancellation.
    let nearer = |point: DVec2| {
        let [from, to] = ends.map(|x| DVec2::new(point.x - x, point.y));
        let sum = from.length() + to.length();
        if sum > 0.0 { (ends[1] - ends[0]) * (from.x + to.x) / sum } else { 0.0 }
    };
    nearer(gap[0]) - nearer(gap[1])
}
