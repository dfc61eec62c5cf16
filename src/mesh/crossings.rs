//! Lines that cross are split there, so that elements can follow all of them.

use glam::DVec2;

use super::line::Line;

/// The pieces of lines between their crossings with others, in the order of the lines. What crosses within `tolerance` of an end meets there.
pub(super) fn split(lines: &[Line], tolerance: f64) -> Vec<Line> {
    // By their least x: only those can meet whose ranges overlap.
    let range = |line: &Line, axis: usize| {
        let [a, b] = line.ends.map(|end| end[axis]);
        [a.min(b), a.max(b)]
    };
    let mut order: Vec<usize> = (0..lines.len()).collect();
    order.sort_by(|&a, &b| range(&lines[a], 0)[0].total_cmp(&range(&lines[b], 0)[0]).then(a.cmp(&b)));
    let mut crossings: Vec<Vec<f64>> = vec![Vec::new(); lines.len()];
    for (place, &one) in order.iter().enumerate() {
        let [[_, right], [low, high]] = [0, 1].map(|axis| range(&lines[one], axis));
        let next = order[place + 1..].iter().take_while(|&&other| range(&lines[other], 0)[0] <= right);
        for &other in next {
            let [from, to] = range(&lines[other], 1);
            if from <= high
                && to >= low
                && let Some([s, t]) = crossing(&lines[one], &lines[other], tolerance)
            {
                crossings[one].extend(s);
                crossings[other].extend(t);
            }
        }
    }
    lines.iter().zip(crossings).flat_map(|(line, crossings)| pieces(*line, crossings)).collect()
}

/// Where two lines cross, as parts of each; of each that does not end there.
fn crossing(one: &Line, other: &Line, tolerance: f64) -> Option<[Option<f64>; 2]> {
    let ([a, b], [c, d]) = (one.ends, other.ends);
    let (along, across) = (b - a, d - c);
    let area = along.perp_dot(across);
    let (s, t) = ((c - a).perp_dot(across) / area, (c - a).perp_dot(along) / area);
    let within = |part: f64, length: f64| {
        let room = tolerance / length;
        (-room..=1.0 + room).contains(&part).then(|| (room..1.0 - room).contains(&part).then_some(part))
    };
    Some([within(s, along.length())?, within(t, across.length())?])
}

fn pieces(line: Line, mut crossings: Vec<f64>) -> impl Iterator<Item = Line> {
    crossings.sort_by(f64::total_cmp);
    let [a, b] = line.ends;
    let mut places: Vec<DVec2> = crossings.into_iter().map(|part| a.lerp(b, part)).collect();
    places.insert(0, a);
    places.push(b);
    (1..places.len()).map(move |k| Line { ends: [places[k - 1], places[k]], ..line })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(from: [f64; 2], to: [f64; 2]) -> Line {
        Line { ends: [from.into(), to.into()], is_step: true }
    }

    #[test]
    fn lines_are_split_where_they_cross_and_where_another_ends_on_them() {
        let lines = [line([0.0, 0.0], [4.0, 0.0]), line([1.0, -1.0], [1.0, 1.0]), line([3.0, 0.0], [3.0, 2.0])];
        let found: Vec<[DVec2; 2]> = split(&lines, 1e-9).iter().map(|line| line.ends).collect();
        let expected = [
            [[0.0, 0.0], [1.0, 0.0]],
            [[1.0, 0.0], [3.0, 0.0]],
            [[3.0, 0.0], [4.0, 0.0]],
            [[1.0, -1.0], [1.0, 0.0]],
            [[1.0, 0.0], [1.0, 1.0]],
            [[3.0, 0.0], [3.0, 2.0]],
        ];
        assert_eq!(found, expected.map(|ends| ends.map(DVec2::from)));
    }

    #[test]
    fn lines_that_are_apart_parallel_or_meet_at_ends_stay_whole() {
        let apart = [line([0.0, 0.0], [1.0, 0.0]), line([2.0, -1.0], [2.0, 1.0]), line([0.0, 1.0], [1.0, 1.0])];
        assert_eq!(split(&apart, 1e-9).len(), 3);
        let on_one_line = [line([0.0, 0.0], [2.0, 0.0]), line([1.0, 0.0], [3.0, 0.0]), line([0.0, 0.0], [0.0, 1.0])];
        assert_eq!(split(&on_one_line, 1e-9).len(), 3);
    }
}
