//! How true maps are: what they say of pairs of squares, through random clouds and through a tree, against many rays.

use patchlight::hierarchy::Hierarchy;
use patchlight::scene::Scene;
use patchlight::transmittance::maps::{MapOptions, Maps};
use patchlight::visibility::{Backend, OccluderMesh, Visibility, build};
use rayon::prelude::*;

use crate::clouds::{Cloud, Ends, all_ends, passing};
use crate::links;
use crate::triangles::Random;

/// Of either place.
const PAIRS: usize = 5000;

/// Lines of either half of a reference; how much the halves differ tells its noise.
const HALF_REFERENCE: usize = 1 << 15;

/// The error that a pair may have, and so many independent lines, whose mean by rays is off by no more.
const LADDER: [(f64, usize); 4] = [(0.2, 7), (0.1, 25), (0.05, 100), (0.02, 625)];

/// Lines whose bounds are held against rays in f64, with so many clusters opened at most.
const BOUNDED_LINES: usize = 16;
const MOST_OPENED: [usize; 3] = [0, 12, 1000];

/// Confidence bounds: how sure, and by so many lines, each with so many clusters opened.
const CONFIDENCE: f64 = 0.9;
const CONFIDENCE_LINES: usize = 64;

/// What is found at one place.
#[derive(Default)]
struct Found {
    name: &'static str,
    pairs: Vec<OfPair>,
}

/// What is found of a pair.
struct OfPair {
    /// What the halves of the reference say.
    truth: [f64; 2],
    /// By rung of the ladder: what is found and claimed by maps if they answer, and what is found by rays.
    answers: Vec<(Option<(f64, f64)>, f64)>,
    /// By how many are opened: lines that are decided, and lines of which an exact ray says otherwise.
    decided: [usize; 3],
    contradicted: [usize; 3],
    confidence: [f64; 2],
}

impl OfPair {
    fn passes(&self) -> f64 {
        0.5 * (self.truth[0] + self.truth[1])
    }
}

pub fn print(tree: &Scene) {
    let found = [of_clouds(), of_tree(tree)];
    println!(
        "| pairs through | of them | pass | noise of the reference | asked for, lines | answered | off | claimed | within one, two of what is claimed | with rays for the rest, off |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|");
    for found in &found {
        (0..LADDER.len()).for_each(|rung| found.print_rung(rung));
    }
    println!(
        "\n| pairs through | lines | opened at most | decided | contradicted by exact rays | pairs with {CONFIDENCE} confidence | hold | mean width |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    for found in &found {
        (0..MOST_OPENED.len()).for_each(|rung| found.print_bounds(rung));
    }
}

/// Clouds of all kinds, until there are enough pairs.
fn of_clouds() -> Found {
    let mut found = Found { name: "random clouds", ..Found::default() };
    for seed in 0.. {
        let mut random = Random(9000 + seed);
        let mut log_between = |low: f64, high: f64| low * (high / low).powf(random.unit());
        let leaves = log_between(500.0, 20_000.0) as usize;
        let half = [0; 3].map(|_| log_between(0.3, 1.2));
        let end = log_between(0.1, 0.5);
        // So that half a leaf to four leaves are one behind another, in the mean.
        let behind = log_between(0.5, 4.0);
        let leaf = (behind * 8.0 * half[0] * half[1] / leaves as f64).sqrt();
        let scene = Cloud { leaves, leaf, half, end, seed }.scene();
        let hierarchy = Hierarchy::new(&scene);
        found.look_at(&scene, &hierarchy, &all_ends(&hierarchy), seed);
        if found.pairs.len() == PAIRS {
            return found;
        }
    }
    found
}

/// A tree between tiles of lawn and of sky.
fn of_tree(tree: &Scene) -> Found {
    let mut found = Found { name: "a tree of 20,000 leaves", ..Found::default() };
    let scene = links::tiled(tree);
    let hierarchy = Hierarchy::new(&scene);
    let ends: Vec<Ends> = links::of_lawn_and_sky(&scene).into_iter().map(|pair| Ends::of(&hierarchy, pair)).collect();
    found.look_at(&scene, &hierarchy, &ends, 1);
    found
}

impl Found {
    /// Looks at the pairs with something between them, as far as there is room for more.
    fn look_at(&mut self, scene: &Scene, hierarchy: &Hierarchy, ends: &[Ends], seed: u64) {
        let by = |backend| build(backend, &OccluderMesh::of_scene(scene)).expect("a backend");
        let (visibility, exact) = (by(Backend::default()), by(Backend::BruteForce));
        let maps = Maps::new(scene, hierarchy, &MapOptions { seed, ..MapOptions::default() });
        let place = Place { scene, hierarchy, visibility: visibility.as_ref(), exact: exact.as_ref(), maps: &maps };
        let found: Vec<OfPair> = ends
            .par_iter()
            .enumerate()
            .filter_map(|(index, ends)| place.look_at(ends, &mut Random(seed << 32 | index as u64)))
            .collect();
        let room = PAIRS - self.pairs.len();
        self.pairs.extend(found.into_iter().take(room));
    }

    fn print_rung(&self, rung: usize) {
        let (tolerance, lines) = LADDER[rung];
        let count = self.pairs.len() as f64;
        let noise = root_mean(self.pairs.iter().map(|pair| 0.5 * (pair.truth[0] - pair.truth[1])));
        let answered: Vec<(f64, f64)> = self
            .pairs
            .iter()
            .filter_map(|pair| pair.answers[rung].0.map(|(passes, claimed)| (passes - pair.passes(), claimed)))
            .collect();
        let within = |times: f64| {
            let held = answered.iter().filter(|(off, claimed)| off.abs() <= times * claimed + noise).count();
            100.0 * held as f64 / answered.len() as f64
        };
        let with_rays = self.pairs.iter().map(|pair| {
            let (by_maps, by_rays) = pair.answers[rung];
            by_maps.map_or(by_rays, |(passes, _)| passes) - pair.passes()
        });
        println!(
            "| {} | {count} | {:.2} | {noise:.4} | {tolerance}, {lines} | {:.0}% | {:.4} | {:.4} | {:.0}%, {:.0}% | {:.4} |",
            self.name,
            self.pairs.iter().map(OfPair::passes).sum::<f64>() / count,
            100.0 * answered.len() as f64 / count,
            root_mean(answered.iter().map(|answer| answer.0)),
            root_mean(answered.iter().map(|answer| answer.1)),
            within(1.0),
            within(2.0),
            root_mean(with_rays),
        );
    }

    fn print_bounds(&self, rung: usize) {
        let count = self.pairs.len() as f64;
        let sum = |of: fn(&OfPair) -> [usize; 3]| self.pairs.iter().map(|pair| of(pair)[rung]).sum::<usize>();
        let holds = |pair: &&OfPair| (pair.confidence[0]..=pair.confidence[1]).contains(&pair.passes());
        let width = self.pairs.iter().map(|pair| pair.confidence[1] - pair.confidence[0]).sum::<f64>() / count;
        let lines = self.pairs.len() * BOUNDED_LINES;
        println!(
            "| {} | {lines} | {} | {:.0}% | {} | {count} | {:.1}% | {width:.2} |",
            self.name,
            MOST_OPENED[rung],
            100.0 * sum(|pair| pair.decided) as f64 / lines as f64,
            sum(|pair| pair.contradicted),
            100.0 * self.pairs.iter().filter(holds).count() as f64 / count,
        );
    }
}

/// A scene, and who is asked.
struct Place<'a> {
    scene: &'a Scene,
    hierarchy: &'a Hierarchy,
    visibility: &'a dyn Visibility,
    /// Knows no distance below which it does not see, as bounds do.
    exact: &'a dyn Visibility,
    maps: &'a Maps<'a>,
}

impl Place<'_> {
    /// Nothing of a pair between which few rays meet nothing.
    fn look_at(&self, ends: &Ends, random: &mut Random) -> Option<OfPair> {
        if passing(&ends.lines(self.scene, 64, random), self.visibility) == 1.0 {
            return None;
        }
        let mut half = || passing(&ends.spread_lines(self.scene, HALF_REFERENCE, random), self.visibility);
        let truth = [half(), half()];
        let mut answer = |(tolerance, lines): (f64, usize)| {
            let lines = ends.lines(self.scene, lines, random);
            let by_maps = self.maps.estimate(self.hierarchy, ends.pair, &lines, tolerance);
            let mean = |passes: Vec<f64>| passes.iter().sum::<f64>() / passes.len() as f64;
            (by_maps.map(|(passes, claimed)| (mean(passes), claimed)), passing(&lines, self.visibility))
        };
        let answers = LADDER.into_iter().map(&mut answer).collect();

        let lines = ends.lines(self.scene, BOUNDED_LINES, random);
        let mut occluded = vec![false; lines.len()];
        self.exact.occluded(&lines, &mut occluded);
        let bounds = MOST_OPENED.map(|most_opened| {
            let of_lines = lines.iter().zip(&occluded).map(|(line, &occluded)| {
                let [least, most] = self.maps.bound_passing(self.hierarchy, line, most_opened);
                let passes = f64::from(u8::from(!occluded));
                [usize::from(least == most), usize::from(passes < least || passes > most)]
            });
            of_lines.fold([0, 0], |sums, of_line| [0, 1].map(|k| sums[k] + of_line[k]))
        });
        let lines = ends.lines(self.scene, CONFIDENCE_LINES, random);
        let confidence = self.maps.sampled_bounds(self.hierarchy, &lines, 1000, CONFIDENCE);
        Some(OfPair { truth, answers, decided: bounds.map(|of| of[0]), contradicted: bounds.map(|of| of[1]), confidence })
    }
}

fn root_mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0), |(sum, count), value| (sum + value * value, count + 1));
    (sum / f64::from(count.max(1))).sqrt()
}
