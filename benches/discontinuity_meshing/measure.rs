//! Solutions with elements of the floor, and how far off these are.

use patchlight::pipeline::solve;
use patchlight::progress::Silent;
use patchlight::scene::Scene;
use patchlight::solve::{LinkOptions, RunOptions, SolveOptions, Strategy, Subdivision, UniformOptions};

use super::exact::{Exact, SIDE};

/// Visibility rays of a link, so many that what they leave open is far below what constant elements do.
const RAYS: u32 = 64;

/// An element of the floor: corners in x and z, and radiosity, the brightest of the exact solution being 1.
pub struct Element {
    pub corners: Vec<[f64; 2]>,
    pub radiosity: f64,
}

/// Errors in units of the brightest radiosity.
#[derive(Clone, Copy, Debug, Default)]
pub struct Errors {
    /// The root mean square.
    pub rms: f64,
    /// The largest, L-infinity.
    pub largest: f64,
}

/// How far off a solution is.
#[derive(Clone, Copy, Debug)]
pub struct Measured {
    pub elements: usize,
    /// At all vertices.
    pub all: Errors,
    /// Where nothing stands.
    pub open: Errors,
    /// Of the best constants that these elements could have: means of the exact solution at their vertices.
    pub best: Errors,
}

/// Options of strategy uniform with elements of at most this area, in m^2.
pub fn uniform(subdivision: Subdivision, element_area: f64) -> SolveOptions {
    SolveOptions { uniform: UniformOptions { element_area: Some(element_area) }, ..options(Strategy::Uniform, subdivision, 1.0) }
}

/// Options that link to a tolerance once, and leave elements what links make them.
pub fn options(strategy: Strategy, subdivision: Subdivision, tolerance: f64) -> SolveOptions {
    let links = LinkOptions {
        tolerance: Some(tolerance),
        leaf_rays: Some(0),
        rays_per_link: RAYS,
        rays_per_light_link: RAYS,
        subdivision,
        discontinuity_tolerance: Some(0.0),
        ..LinkOptions::default()
    };
    SolveOptions { strategy, links, error: 0.5, point_rays: Some(1), ..SolveOptions::default() }
}

/// The elements of the floor.
pub fn elements(scene: &Scene, exact: &Exact, options: &SolveOptions) -> Vec<Element> {
    let (evaluator, _) = solve(scene.clone(), options, &RunOptions::default(), &Silent).expect("legal options");
    let mut elements = Vec::new();
    evaluator.solution().for_each_leaf(|corners, surface, radiosity| {
        if surface == exact.floor.0 {
            let corners = corners.iter().map(|corner| [corner[0], corner[2]]).collect();
            elements.push(Element { corners, radiosity: f64::from(radiosity[0]) / exact.brightest });
        }
    });
    elements
}

/// Compares elements with the exact solution.
pub fn measure(elements: &[Element], exact: &Exact) -> Measured {
    let element_at = elements_at_vertices(elements, exact);
    let (mut sums, mut counts) = (vec![0.0; elements.len()], vec![0.0; elements.len()]);
    for (&element, value) in element_at.iter().zip(&exact.radiosity) {
        sums[element] += value;
        counts[element] += 1.0;
    }
    let errors = |value: &dyn Fn(usize) -> f64, counts_at: &dyn Fn(usize) -> bool| {
        let (mut sum, mut count, mut largest) = (0.0, 0.0, 0.0_f64);
        for vertex in (0..element_at.len()).filter(|&vertex| counts_at(vertex)) {
            let off = (value(element_at[vertex]) - exact.radiosity[vertex]).abs();
            sum += off * off;
            count += 1.0;
            largest = largest.max(off);
        }
        Errors { rms: f64::sqrt(sum / count), largest }
    };
    let radiosity = |element: usize| elements[element].radiosity;
    Measured {
        elements: elements.len(),
        all: errors(&radiosity, &|_| true),
        open: errors(&radiosity, &|vertex| !exact.is_covered[vertex]),
        best: errors(&|element| sums[element] / counts[element], &|_| true),
    }
}

/// The number of the element at every vertex, of several the first.
fn elements_at_vertices(elements: &[Element], exact: &Exact) -> Vec<usize> {
    let mut element_at = vec![usize::MAX; SIDE * SIDE];
    for (number, element) in elements.iter().enumerate() {
        let range = |axis: usize| {
            let coordinates = || element.corners.iter().map(|corner| exact.coordinate(axis, corner[axis]));
            let low = coordinates().fold(f64::INFINITY, f64::min).floor().max(0.0) as usize;
            let high = coordinates().fold(0.0, f64::max).ceil() as usize;
            low..=high.min(SIDE - 1)
        };
        for row in range(1) {
            for column in range(0) {
                let own = &mut element_at[row * SIDE + column];
                if *own == usize::MAX && contains(&element.corners, exact.place([column, row])) {
                    *own = number;
                }
            }
        }
    }
    assert!(element_at.iter().all(|&element| element < elements.len()), "the elements leave a hole");
    element_at
}

/// Whether a convex polygon that turns either way contains a point; its border counts, and what rounding leaves of that.
fn contains(corners: &[[f64; 2]], [x, z]: [f64; 2]) -> bool {
    const ROUNDING: f64 = 1e-12;
    let turn = |k: usize| {
        let ([ax, az], [bx, bz]) = (corners[k], corners[(k + 1) % corners.len()]);
        (bx - ax) * (z - az) - (bz - az) * (x - ax)
    };
    (0..corners.len()).all(|k| turn(k) >= -ROUNDING) || (0..corners.len()).all(|k| turn(k) <= ROUNDING)
}
