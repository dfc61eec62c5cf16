//! Tables 1 and 2, and how far the links of the four polygons are from what is exact.

use patchlight::hierarchy::NodeId;
use patchlight::scene::Scene;
use patchlight::solve::Strategy;

use super::exact::Exact;
use super::paper::{BOTTOM_UP, LINKS_BY_SAMPLES, TOLERANCES, TOP_DOWN};
use super::run::{Run, run, scene};
use super::table::{heading, percent};

/// The lamp, which is all that hides anything.
const LAMP: u32 = 3;
/// Mid-points by direction for what is hidden, and fewer to tell how exact that is.
const POINTS: usize = 8;
const FEWER_POINTS: usize = 4;
/// Runs with other samples; means of all are printed.
const SEEDS: u64 = 8;

/// What is wrong with the links of a run.
#[derive(Clone, Copy, Default)]
struct Errors {
    /// `sum |A F - exact| / sum exact` over links above the smallest elements, and over all.
    upper: f64,
    all: f64,
    /// Root mean square over all pairs of elements of what their link gives them, relative.
    elements: f64,
    /// The part of the links above the smallest elements whose error exceeds the tolerance, as far as is proved.
    missed: f64,
    /// `||B - B_exact|| / ||B_exact - E||` of the elements.
    radiosity: f64,
}

pub fn tables() {
    let scene = scene("four_polygons");
    let first = run(&scene, Strategy::BottomUp98, 0.02, 1, 0);
    let exact = Exact::new(first.solution(), LAMP, POINTS);
    let (largest, all) = exact.difference(&Exact::new(first.solution(), LAMP, FEWER_POINTS));
    let count = exact.elements.len();
    println!(
        "\n{count} elements, {} pairs of them. Reference: half as many points by direction change no exchange by more than {:.1e} \
         of the largest, all by {:.1e} of their sum.",
        count * (count - 1) / 2,
        largest,
        all
    );
    table_1(&scene);
    table_2(&scene, &exact);
    errors_by_level(&scene, &exact);
}

fn table_1(scene: &Scene) {
    let title = "**Table 1.** Links with one to four samples on each smallest element; in brackets the paper's, \
                 on polygons that it does not tell.";
    heading(title, &["F_eps", "1 sample", "2", "3", "4"]);
    for (tolerance, paper) in TOLERANCES.iter().zip(LINKS_BY_SAMPLES) {
        let cells: Vec<String> = (paper.iter().zip(1..))
            .map(|(paper, samples)| format!("{} ({paper})", run(scene, Strategy::BottomUp98, *tolerance, samples, 0).links()))
            .collect();
        println!("| {tolerance:.3} | {} |", cells.join(" | "));
    }
}

/// Runs of one way to link: the first of the seeds, mean errors and mean CPU seconds of refinement.
struct Way {
    first: Run,
    errors: Errors,
    seconds: f64,
}

impl Way {
    fn new(scene: &Scene, exact: &Exact, strategy: Strategy, tolerance: f64, samples: u32) -> Self {
        let runs: Vec<Run> = (0..SEEDS).map(|seed| run(scene, strategy, tolerance, samples, seed)).collect();
        let seconds = runs.iter().map(|run| run.refine_cpu_s).sum::<f64>() / SEEDS as f64;
        let found: Vec<Errors> = runs.iter().map(|run| errors(run, exact, tolerance)).collect();
        let mean = |value: &dyn Fn(&Errors) -> f64| found.iter().map(value).sum::<f64>() / SEEDS as f64;
        let errors = Errors {
            upper: mean(&|e| e.upper),
            all: mean(&|e| e.all),
            elements: mean(&|e| e.elements),
            missed: mean(&|e| e.missed),
            radiosity: mean(&|e| e.radiosity),
        };
        Self { first: runs.into_iter().next().expect("there are seeds"), errors, seconds }
    }
}

fn table_2(scene: &Scene, exact: &Exact) {
    let of = |strategy, tolerance: f64, samples| Way::new(scene, exact, strategy, tolerance, samples);
    let columns = ["F_eps", "links top-down", "bottom-up", "ratio", "CPU-s top-down", "bottom-up"];
    heading("**Table 2.** Four samples, top-down and bottom-up; in brackets the paper's.", &columns);
    let mut rows = Vec::new();
    for ((tolerance, top_down), bottom_up) in TOLERANCES.iter().zip(TOP_DOWN).zip(BOTTOM_UP) {
        let (top, bottom) = (of(Strategy::TopDown98, *tolerance, 4), of(Strategy::BottomUp98, *tolerance, 4));
        let (top_links, bottom_links) = (top.first.links(), bottom.first.links());
        println!(
            "| {tolerance:.3} | {top_links} ({}) | {bottom_links} ({}) | {:.2} ({:.2}) | {:.3} ({}) | {:.3} ({}) |",
            top_down.0,
            bottom_up.0,
            bottom_links as f64 / top_links as f64,
            f64::from(bottom_up.0) / f64::from(top_down.0),
            top.seconds,
            top_down.1,
            bottom.seconds,
            bottom_up.1
        );
        rows.push((*tolerance, "top-down, 4", top));
        rows.push((*tolerance, "top-down, 8", of(Strategy::TopDown98, *tolerance, 8)));
        rows.push((*tolerance, "bottom-up, 1", of(Strategy::BottomUp98, *tolerance, 1)));
        rows.push((*tolerance, "bottom-up, 4", bottom));
    }
    // Top-down with as many links as bottom-up has at the tolerances above.
    rows.extend([0.024, 0.016, 0.008].map(|tolerance| (tolerance, "top-down, 4", of(Strategy::TopDown98, tolerance, 4))));
    how_far_from_exact(&rows);
}

fn how_far_from_exact(rows: &[(f64, &str, Way)]) {
    let columns = [
        "F_eps",
        "samples",
        "links",
        "CPU-s",
        "upper links off",
        "all links off",
        "elements off",
        "links above F_eps",
        "radiosity off",
    ];
    heading("**How far from exact**, means of 8 seeds (links: of the first).", &columns);
    for (tolerance, name, Way { first, errors, seconds }) in rows {
        println!(
            "| {tolerance:.3} | {name} | {} | {seconds:.3} | {} | {} | {} | {} | {} |",
            first.links(),
            percent(errors.upper),
            percent(errors.all),
            percent(errors.elements),
            percent(errors.missed),
            percent(errors.radiosity)
        );
    }
}

/// The links of a run, each pair of nodes once, with what they exchange.
fn links(run: &Run) -> impl Iterator<Item = (NodeId, NodeId, f64)> {
    let hierarchy = run.solution().hierarchy();
    run.solution()
        .links()
        .iter()
        .filter(|(receiver, link)| *receiver < link.source)
        .map(|(receiver, link)| (receiver, link.source, hierarchy.area(receiver) * link.occluded_form_factor()))
}

fn errors(run: &Run, exact: &Exact, tolerance: f64) -> Errors {
    let hierarchy = run.solution().hierarchy();
    let (mut upper, mut all) = ([0.0; 2], [0.0; 2]);
    let (mut missed, mut upper_links) = (0, 0);
    let mut covered_sq = 0.0;
    let mut error_sq = 0.0;
    for (first, second, found) in links(run) {
        let truth = exact.exchange(first, second);
        all = [all[0] + (found - truth).abs(), all[1] + truth];
        if !(hierarchy.is_leaf(first) && hierarchy.is_leaf(second)) {
            upper = [upper[0] + (found - truth).abs(), upper[1] + truth];
            let error = exact.least_largest_kernel(first, second) * hierarchy.area(first).max(hierarchy.area(second));
            missed += usize::from(error >= tolerance);
            upper_links += 1;
        }
        let kernel = found / (hierarchy.area(first) * hierarchy.area(second));
        for &a in &exact.below[first.index()] {
            for &b in &exact.below[second.index()] {
                let truth = exact.between(a, b);
                error_sq += (kernel * exact.areas[a as usize] * exact.areas[b as usize] - truth).powi(2);
                covered_sq += truth * truth;
            }
        }
    }
    let channels = run.solution().scene().channels();
    let (mut off_sq, mut reflected_sq) = (0.0, 0.0);
    for (number, &element) in exact.elements.iter().enumerate() {
        let places = number * channels..(number + 1) * channels;
        for (found, place) in run.solution().radiosity().of(element).iter().zip(places) {
            off_sq += exact.areas[number] * (found - exact.radiosity[place]).powi(2);
            reflected_sq += exact.areas[number] * (exact.radiosity[place] - exact.exitance[place]).powi(2);
        }
    }
    Errors {
        upper: upper[0] / upper[1],
        all: all[0] / all[1],
        elements: (error_sq / covered_sq).sqrt(),
        missed: f64::from(missed as u32) / f64::from(upper_links),
        radiosity: (off_sq / reflected_sq).sqrt(),
    }
}

/// On the very links that top-down makes: its own samples, and the sums of those on the smallest elements.
fn errors_by_level(scene: &Scene, exact: &Exact) {
    const TOLERANCE: f64 = 0.02;
    let columns = ["level of the larger node", "links", "off by samples on the nodes", "off by sums from below"];
    heading(
        "**Form factors of the same pairs of nodes**, those that top-down links at 0.020 (4 samples, means of 8 seeds; \
         level 1: smallest elements).",
        &columns,
    );
    let mut sums = [[0.0; 4]; 6];
    for seed in 0..SEEDS {
        // With next to no tolerance all smallest elements that exchange anything are linked: their samples, pair by pair.
        let bottom = run(scene, Strategy::BottomUp98, 1e-12, 4, seed);
        let hierarchy = bottom.solution().hierarchy();
        let count = exact.elements.len();
        let mut number = vec![0; hierarchy.len()];
        exact.elements.iter().enumerate().for_each(|(index, element)| number[element.index()] = index);
        let mut sampled = vec![0.0; count * count];
        for (first, second, found) in links(&bottom) {
            // A pair behind one another carries nothing at any level.
            for &a in &exact.below[first.index()] {
                for &b in &exact.below[second.index()] {
                    let share =
                        exact.areas[a as usize] * exact.areas[b as usize] / (hierarchy.area(first) * hierarchy.area(second));
                    sampled[a as usize * count + b as usize] = found * share;
                    sampled[b as usize * count + a as usize] = found * share;
                }
            }
        }
        let top = run(scene, Strategy::TopDown98, TOLERANCE, 4, seed);
        for (first, second, found) in links(&top) {
            let level = |node: NodeId| (exact.below[node.index()].len() as f64).log(4.0).round() as usize + 1;
            let row = &mut sums[level(first).max(level(second))];
            let truth = exact.exchange(first, second);
            let from_below: f64 = (exact.below[first.index()].iter())
                .flat_map(|&a| exact.below[second.index()].iter().map(move |&b| (a, b)))
                .map(|(a, b)| sampled[a as usize * count + b as usize])
                .sum();
            *row = [row[0] + 1.0, row[1] + truth, row[2] + (found - truth).abs(), row[3] + (from_below - truth).abs()];
        }
    }
    for (level, [links, truth, own, below]) in sums.into_iter().enumerate().filter(|(_, row)| row[0] > 0.0) {
        println!("| {level} | {:.0} | {} | {} |", links / SEEDS as f64, percent(own / truth), percent(below / truth));
    }
}
