//! The systems alone: square duct and strips in two dimensions, where the bounds of form factors are elementary.

#![allow(clippy::print_stdout, reason = "a test tells what it measured")]

use super::attribution::{Share, attribute};
use super::knapsack::Knapsack;
use super::system::{Entry, Iterate, Leaf, System};

/// Walls of length 1, the first of which emits: s runs counter-clockwise, each wall starts where the one before ends.
const EXITANCE: [[f64; 1]; 4] = [[1.0], [0.0], [0.0], [0.0]];
const REFLECTANCE: [[f64; 1]; 4] = [[0.2], [0.5], [0.8], [0.5]];

/// The form factor from s on one wall to the part from a to b of the wall `ahead` places further.
fn factor(s: f64, ahead: usize, a: f64, b: f64) -> f64 {
    let sine = |along: f64, off: f64| if along == 0.0 { 0.0 } else { along / along.hypot(off) };
    match ahead {
        // Across: the other wall runs the other way.
        2 => 0.5 * (sine(1.0 - a - s, 1.0) - sine(1.0 - b - s, 1.0)),
        // Around the corner where this wall ends, or starts; at the corner itself the limit along the wall.
        1 => corner_factor(1.0 - s, a, b),
        3 => corner_factor(s, 1.0 - b, 1.0 - a),
        _ => 0.0,
    }
}

fn corner_factor(distance: f64, near: f64, far: f64) -> f64 {
    let sine = |height: f64| if height == 0.0 { 1.0 } else { distance / distance.hypot(height) };
    0.5 * (sine(near) - sine(far))
}

/// The range of the form factor over `from` to `to`: the least at an end, the largest at an end or where the derivative vanishes.
fn range(from: f64, to: f64, ahead: usize, a: f64, b: f64) -> [f64; 2] {
    let peak = |near: f64, far: f64| ((near * far).powf(4.0 / 3.0) / (near.powf(2.0 / 3.0) + far.powf(2.0 / 3.0))).sqrt();
    let top = match ahead {
        2 => 1.0 - 0.5 * (a + b),
        1 => 1.0 - peak(a, b),
        _ => peak(1.0 - b, 1.0 - a),
    };
    let at = |s: f64| factor(s, ahead, a, b);
    [at(from).min(at(to)), at(from).max(at(to)).max(at(top.clamp(from, to)))]
}

/// The duct with `n` elements on each wall.
fn duct(n: usize) -> System<'static> {
    let place = |k: usize| k as f64 / n as f64;
    let mut entries = Vec::new();
    for receiver in 0..4 * n {
        for source in 0..4 * n {
            let ahead = (source / n + 4 - receiver / n) % 4;
            if ahead != 0 {
                let (k, l) = (receiver % n, source % n);
                let [lower, upper] = range(place(k), place(k + 1), ahead, place(l), place(l + 1));
                entries.push(Entry { source: source as u32, lower, upper });
            }
        }
    }
    let leaf = |node: usize| Leaf {
        node: node as u32,
        exitance: &EXITANCE[node / n],
        reflectance: &REFLECTANCE[node / n],
        enclosed: true,
    };
    System {
        channels: 1,
        parents: (0..4 * n as u32).collect(),
        starts: (0..=4 * n as u32).map(|node| node * 3 * n as u32).collect(),
        entries,
        leaves: (0..4 * n).map(leaf).collect(),
        plans: None,
    }
}

/// The solution, by collocation at the middles of many cells and one more gather.
struct Reference {
    cells: usize,
    values: Vec<f64>,
}

impl Reference {
    fn new(cells: usize) -> Self {
        let mut reference = Self { cells, values: (0..4 * cells).map(|k| EXITANCE[k / cells][0]).collect() };
        let rows: Vec<Vec<f64>> =
            (0..4 * cells).map(|k| reference.weights(k / cells, ((k % cells) as f64 + 0.5) / cells as f64)).collect();
        for _ in 0..60 {
            reference.values = rows.iter().enumerate().map(|(k, row)| reference.gather(k / cells, row)).collect();
        }
        reference
    }

    /// The form factors from s on a wall to all cells.
    fn weights(&self, wall: usize, s: f64) -> Vec<f64> {
        let place = |k: usize| k as f64 / self.cells as f64;
        let of_cell = |cell: usize| {
            let (ahead, l) = ((cell / self.cells + 4 - wall) % 4, cell % self.cells);
            factor(s, ahead, place(l), place(l + 1))
        };
        (0..4 * self.cells).map(of_cell).collect()
    }

    fn gather(&self, wall: usize, weights: &[f64]) -> f64 {
        let irradiance: f64 = weights.iter().zip(&self.values).map(|(weight, value)| weight * value).sum();
        EXITANCE[wall][0] + REFLECTANCE[wall][0] * irradiance
    }

    fn at(&self, wall: usize, s: f64) -> f64 {
        self.gather(wall, &self.weights(wall, s))
    }
}

/// Reference values to 12 digits, by Nystroem's method with panels halved towards the corners: wall, place, radiosity.
const PROBES: [(usize, f64, f64); 8] = [
    (0, 0.5, 1.075_391_574_638_1),
    (0, 0.1, 1.075_639_485_228_6),
    (1, 0.1, 0.339_660_938_403_54),
    (1, 0.5, 0.280_987_316_380_8),
    (1, 0.9, 0.249_877_820_072_61),
    (2, 0.5, 0.511_388_233_059_06),
    (2, 0.1, 0.463_425_704_553_36),
    (2, 0.01, 0.438_648_568_705_09),
];
const MEANS: [f64; 4] = [1.075_536_843_474_3, 0.288_151_222_576_35, 0.486_200_723_800_69, 0.288_151_222_576_35];

/// The bounds of the element of `wall` around `s`; of both where two meet.
fn assert_within(n: usize, iterate: &Iterate, wall: usize, s: f64, value: f64, tolerance: f64) {
    let at = s * n as f64;
    for k in [at.floor() as usize, (at - 1e-12).floor() as usize] {
        let node = wall * n + k.min(n - 1);
        let (lower, upper) = (iterate.lower[node], iterate.upper[node]);
        assert!(lower - tolerance <= value && value <= upper + tolerance, "{n}: B{wall}({s}) = {value} not in [{lower}, {upper}]");
    }
}

#[test]
fn bounds_of_the_duct_hold_at_every_probe_after_every_sweep_and_are_tight() {
    let reference = Reference::new(300);
    const REFERENCE_ERROR: f64 = 4e-6;
    for (wall, s, value) in PROBES {
        assert!((reference.at(wall, s) - value).abs() < REFERENCE_ERROR, "B{wall}({s}): {}", reference.at(wall, s));
    }
    let probes: Vec<(usize, f64, f64)> = (0..384)
        .map(|probe| (probe / 96, (probe % 96) as f64 / 95.0))
        .map(|(wall, s)| (wall, s, reference.at(wall, s.clamp(1e-9, 1.0 - 1e-9))))
        .collect();

    for (n, width) in [(8, 0.0315), (16, 0.0161), (32, 0.0082)] {
        let system = duct(n);
        let check = |iterate: &Iterate| {
            PROBES.iter().for_each(|&(wall, s, value)| assert_within(n, iterate, wall, s, value, 0.0));
            probes.iter().for_each(|&(wall, s, value)| assert_within(n, iterate, wall, s, value, REFERENCE_ERROR));
            for (wall, mean) in MEANS.iter().enumerate() {
                let of = |values: &[f64]| values[wall * n..][..n].iter().sum::<f64>() / n as f64;
                assert!(of(&iterate.lower) <= *mean && *mean <= of(&iterate.upper), "{n}: mean of wall {wall}");
            }
        };

        // Every iterate holds, and is within the one before.
        let mut iterate = system.trivial();
        for _ in 0..8 {
            check(&iterate);
            let before = iterate.clone();
            system.sweep(&mut iterate, &mut Knapsack::of_channels(&system), &|| false);
            assert!(iterate.lower.iter().zip(&before.lower).all(|(now, before)| now >= before));
            assert!(iterate.upper.iter().zip(&before.upper).all(|(now, before)| now <= before));
        }
        let (iterate, _) = system.solve(1e-6, 1000, &|| false);
        check(&iterate);
        let found = iterate.upper.iter().zip(&iterate.lower).map(|(upper, lower)| upper - lower).sum::<f64>() / (4 * n) as f64;
        println!("{n} elements a wall: mean width {found:.5}");
        assert!(found <= 1.2 * width, "{n} elements: mean width {found}, not {width}");
        assert!(found >= 0.5 * width, "{n} elements: mean width {found} is too good to be true");
    }
}

/// Two strips that face each other, open at the sides, by the same method: strip (0 or 1), place, radiosity; and the means.
const STRIP_PROBES: [(usize, f64, f64); 6] = [
    (0, 0.5, 1.069_486_410_838_9),
    (0, 0.25, 1.065_339_316_365_9),
    (0, 0.0, 1.054_619_181_195_5),
    (1, 0.5, 0.333_295_714_423_12),
    (1, 0.25, 0.313_924_541_070_09),
    (1, 0.0, 0.263_399_581_034_84),
];
const STRIP_MEANS: [f64; 2] = [1.064_229_115_649_8, 0.308_662_992_991_33];

#[test]
fn bounds_of_open_strips_hold_at_every_probe_and_close_in() {
    let (exitance, reflectance) = ([[1.0], [0.0]], [[0.5], [0.7]]);
    let mut widths = Vec::new();
    for n in [4, 8, 16, 32] {
        let place = |k: usize| k as f64 / n as f64;
        let mut entries = Vec::new();
        for receiver in 0..2 * n {
            for l in 0..n {
                // The other strip runs the same way here, and the walls of the duct run opposite ways.
                let (k, source) = (receiver % n, (1 - receiver / n) * n + l);
                let [lower, upper] = range(place(k), place(k + 1), 2, 1.0 - place(l + 1), 1.0 - place(l));
                entries.push(Entry { source: source as u32, lower, upper });
            }
        }
        let leaf = |node: usize| Leaf {
            node: node as u32,
            exitance: &exitance[node / n],
            reflectance: &reflectance[node / n],
            enclosed: false,
        };
        let system = System {
            channels: 1,
            parents: (0..2 * n as u32).collect(),
            starts: (0..=2 * n as u32).map(|node| node * n as u32).collect(),
            entries,
            leaves: (0..2 * n).map(leaf).collect(),
            plans: None,
        };
        let (iterate, _) = system.solve(1e-9, 200, &|| false);
        STRIP_PROBES.iter().for_each(|&(strip, s, value)| assert_within(n, &iterate, strip, s, value, 0.0));
        for (strip, mean) in STRIP_MEANS.iter().enumerate() {
            let of = |values: &[f64]| values[strip * n..][..n].iter().sum::<f64>() / n as f64;
            assert!(of(&iterate.lower) <= *mean && *mean <= of(&iterate.upper), "{n}: mean of strip {strip}");
        }
        widths.push(iterate.upper.iter().zip(&iterate.lower).map(|(upper, lower)| upper - lower).sum::<f64>() / (2 * n) as f64);
    }
    assert!(widths.windows(2).all(|pair| pair[1] < 0.6 * pair[0]), "{widths:?}");
}

#[test]
fn starting_the_upper_system_from_below_would_not_do() {
    // Why the sweeps start from outside: begun from B = E, as the thesis has it, three of them are no bound.
    let system = duct(16);
    let mut from_below = system.trivial();
    from_below.upper.clone_from(&from_below.lower);
    let mut violated = 0;
    for _ in 0..3 {
        let before = from_below.clone();
        let mut knapsack = Knapsack::new(&system, 0);
        knapsack.sort(&before);
        let mut next = Iterate { lower: before.lower.clone(), upper: vec![f64::INFINITY; before.upper.len()] };
        for leaf in &system.leaves {
            let [_, most] = knapsack.irradiance(leaf.node, true, &before, |_, _, _| {});
            next.upper[leaf.node as usize] = leaf.exitance[0] + leaf.reflectance[0] * most;
        }
        from_below.upper = next.upper;
    }
    for (wall, s, value) in PROBES {
        violated += u32::from(from_below.upper[wall * 16 + (s * 16.0) as usize] < value);
    }
    assert!(violated > 0);
}

#[test]
fn infinite_plates_are_solved_exactly() {
    // Each sees nothing but the other: the bounds close in on B1 = (E1 + rho1 E2) / (1 - rho1 rho2).
    let (exitance, reflectance) = ([[1.0], [0.25]], [[0.5], [0.7]]);
    let leaf = |node: usize| Leaf { node: node as u32, exitance: &exitance[node], reflectance: &reflectance[node], enclosed: true };
    let entry = |source| Entry { source, lower: 1.0, upper: 1.0 };
    let system = System {
        channels: 1,
        parents: vec![0, 1],
        starts: vec![0, 1, 2],
        entries: vec![entry(1), entry(0)],
        leaves: vec![leaf(0), leaf(1)],
        plans: None,
    };
    let (iterate, _) = system.solve(1e-16, 200, &|| false);
    let exact = 1.730_769_230_769_230_8;
    assert!(iterate.lower[0] <= exact && exact <= iterate.upper[0] && iterate.upper[0] - iterate.lower[0] < 1e-13, "{iterate:?}");
}

#[test]
fn ancestors_and_inner_sources_count() {
    // A wall in two halves that gathers as a whole from the halves of another as one: nodes 0 (of 2, 3) and 1 (of 4, 5).
    let (dark, bright, dim) = ([0.0], [2.0], [1.0]);
    let leaf = |node, exitance| Leaf { node, exitance, reflectance: &[0.5], enclosed: false };
    let system = System {
        channels: 1,
        parents: vec![0, 1, 0, 0, 1, 1],
        starts: vec![0, 1, 1, 1, 2, 2, 2],
        entries: vec![Entry { source: 1, lower: 0.2, upper: 0.4 }, Entry { source: 4, lower: 0.1, upper: 0.1 }],
        leaves: vec![leaf(2, &dark), leaf(3, &dark), leaf(4, &bright), leaf(5, &dim)],
        plans: None,
    };
    let (iterate, _) = system.solve(1e-12, 50, &|| false);
    let near = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-12, "{found} instead of {expected}");
    near(iterate.lower[2], 0.5 * 0.2 * 1.0);
    near(iterate.upper[2], 0.5 * 0.4 * 2.0);
    near(iterate.lower[3], 0.5 * (0.2 * 1.0 + 0.1 * 2.0));
    near(iterate.upper[3], 0.5 * 0.5 * 2.0);
    near(iterate.lower[0], iterate.lower[2]);
    near(iterate.upper[1], 2.0);
}

/// What entries add to `<R, U - L>`, and that number itself.
fn attributed(system: &System<'_>, iterate: &Iterate, initial: &[f64]) -> (f64, f64) {
    let found: f64 = attribute(system, iterate, initial, &|| false).iter().map(Share::total).sum();
    let gap = |leaf: &Leaf<'_>| {
        let at = leaf.node as usize;
        initial[at] * (iterate.upper[at] - iterate.lower[at])
    };
    (found, system.leaves.iter().map(gap).sum())
}

#[test]
fn what_entries_add_is_the_gap() {
    // The duct, where rows add up to 1, and as if it were open; all of it, and one wall alone.
    for enclosed in [true, false] {
        let mut system = duct(8);
        system.leaves.iter_mut().for_each(|leaf| leaf.enclosed = enclosed);
        let (iterate, _) = system.solve(1e-15, 10_000, &|| false);
        for of_wall in [None, Some(2)] {
            let initial: Vec<f64> = (0..32).map(|node| f64::from(u8::from(of_wall.is_none_or(|wall| node / 8 == wall)))).collect();
            let (found, gap) = attributed(&system, &iterate, &initial);
            assert!(gap > 0.05 && (found / gap - 1.0).abs() < 1e-10, "enclosed {enclosed}, {of_wall:?}: {found}, not {gap}");
        }
        if !enclosed {
            let parts = attribute(&system, &iterate, &[1.0; 32], &|| false);
            assert!(
                parts.iter().all(|part| part.by_form_factor >= 0.0 && part.by_source >= 0.0),
                "each entry gets at least its lower bound"
            );
        }
    }
}

#[test]
fn what_entries_add_counts_through_ancestors_and_inner_sources() {
    // Two walls, each in two halves that gather as one from the halves of the other as one, and a lamp that both see.
    let reflectance = [[0.5], [0.7]];
    let exitance = [[0.0], [0.3], [2.0]];
    let leaf =
        |node, wall: usize, lit: usize| Leaf { node, exitance: &exitance[lit], reflectance: &reflectance[wall], enclosed: false };
    let entry = |source, lower, upper| Entry { source, lower, upper };
    let system = System {
        channels: 1,
        parents: vec![0, 1, 0, 0, 1, 1, 6],
        starts: vec![0, 2, 4, 4, 5, 5, 5, 5],
        entries: vec![entry(1, 0.2, 0.4), entry(6, 0.0, 0.1), entry(0, 0.1, 0.5), entry(6, 0.1, 0.9), entry(4, 0.05, 0.1)],
        leaves: vec![leaf(2, 0, 0), leaf(3, 0, 1), leaf(4, 1, 0), leaf(5, 1, 1), Leaf { reflectance: &[0.0], ..leaf(6, 0, 2) }],
        plans: None,
    };
    let (iterate, _) = system.solve(1e-15, 10_000, &|| false);
    let (found, gap) = attributed(&system, &iterate, &[9.0, 9.0, 1.0, 2.0, 3.0, 0.0, 1.0]);
    assert!(gap > 1.0 && (found / gap - 1.0).abs() < 1e-12, "{found}, not {gap}");
}
