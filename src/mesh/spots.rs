//! Points in elements, at which the function is held against the light.

use rayon::prelude::*;

use super::growing::Growing;
use super::judged::Norm;
use crate::geometry::sampling;

/// A point in an element.
pub(super) struct Spot {
    /// The number of the surface among those that grow.
    pub index: usize,
    pub triangle: u32,
    pub at: [f64; 3],
    /// What it was drawn by.
    pub draw: u64,
}

impl Spot {
    /// A random point of a triangle.
    pub fn new((index, of): (usize, &Growing), triangle: u32, draw: u64) -> Self {
        Self { index, triangle, at: of.sampled_point(triangle, draw), draw }
    }

    /// Points spread over all elements, one in each of as many strata of what these are drawn by, given by surface and triangle; and what each point
    /// stands for, in m^2 or pixels.
    pub fn spread(all: &[Growing], count: usize, seed: u64, drawn_by: &[Vec<f64>]) -> (Vec<Self>, Vec<f64>) {
        let whole: f64 = drawn_by.iter().flatten().sum();
        let wanted = |number: usize| (number as f64 + sampling::unit(sampling::hash(seed, number as u64))) / count as f64;
        let (mut spots, mut parts, mut above) = (Vec::with_capacity(count), Vec::with_capacity(count), 0.0);
        for (index, (of, drawn_by)) in all.iter().zip(drawn_by).enumerate() {
            for (triangle, &drawn_by) in (0..).zip(drawn_by) {
                above += drawn_by;
                while spots.len() < count && wanted(spots.len()) * whole < above {
                    spots.push(Self::new((index, of), triangle, sampling::hash(!seed, spots.len() as u64)));
                    parts.push(of.weight(triangle) * whole / (drawn_by * count as f64));
                }
            }
        }
        (spots, parts)
    }
}

/// What the triangles of all surfaces weigh.
pub(super) fn by_weight(all: &[Growing]) -> Vec<Vec<f64>> {
    all.iter().map(|of| (0..of.triangles.triangles.len() as u32).map(|triangle| of.weight(triangle)).collect()).collect()
}

/// Of triangles to draw, the part of each by what it weighs and by its squared surplus in the norm, half by either: where the function could be far
/// off many points are wanted, and nowhere none.
pub(super) fn by_weight_and_surplus(all: &[Growing], norm: &Norm) -> Vec<Vec<f64>> {
    let of_surface = |of: &Growing| {
        // Where it is darkest it counts most.
        let mut darkest_sq = vec![f64::INFINITY; of.triangles.triangles.len()];
        for test in &of.tests {
            darkest_sq[test.triangle as usize] = test.light_sq.min(darkest_sq[test.triangle as usize]);
        }
        let of_triangle = |(triangle, light_sq): (u32, f64)| {
            let weight = of.weight(triangle);
            if weight > 0.0 { weight * norm.weight(light_sq) * of.surplus_sq(triangle) } else { 0.0 }
        };
        (0..).zip(darkest_sq).map(of_triangle).collect::<Vec<f64>>()
    };
    let (mut mixed, surpluses_sq) = (by_weight(all), all.par_iter().map(of_surface).collect::<Vec<_>>());
    let sum = |of: &[Vec<f64>]| of.iter().flatten().sum::<f64>();
    let (whole, of_surpluses) = (sum(&mixed), sum(&surpluses_sq));
    if of_surpluses > 0.0 {
        let both = mixed.iter_mut().flatten().zip(surpluses_sq.iter().flatten());
        both.for_each(|(part, surplus_sq)| *part = 0.5 * (*part / whole + surplus_sq / of_surpluses));
    }
    mixed
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::error::ErrorNorm;
    use crate::geometry::Polygon;
    use crate::mesh::plane::Plane;
    use crate::mesh::triangulation::triangulate;
    use crate::scene::{Material, Scene, Sides, SurfaceId};

    /// Where the light of a unit square has a step, from what to what.
    const STEP: f64 = 0.43;
    const LIGHT: [f64; 2] = [0.1, 1.0];

    /// That square, with a test in each element.
    fn step() -> Growing {
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        let grey = Material { name: String::new(), reflectance: vec![0.5], exitance: vec![0.0] };
        let scene = Scene::new(1, vec![grey], vec![(Polygon::new(&corners).unwrap(), 0, 0)], Sides::Front).unwrap();
        let plane = Plane::of(&scene, SurfaceId(0));
        let square: Vec<DVec2> = corners.iter().map(|&corner| plane.to_plane(corner.into())).collect();
        let mut of = Growing::new(SurfaceId(0), plane, triangulate(&square, &[], 5e-3, 0.0), None, 1);
        of.begin_gathers(1);
        for node in 0..of.triangles.nodes.len() {
            let is_dark = of.plane.to_space(of.triangles.nodes[node].at).x < STEP;
            of.add_gather(node, &[[LIGHT[usize::from(!is_dark)], 0.0]]);
        }
        for triangle in 0..of.triangles.triangles.len() as u32 {
            of.tests.push(of.test(triangle, [1.0 / 3.0; 3], &[[0.5, 0.0]], 0.25));
        }
        of
    }

    /// Sums over points have the right mean however these are drawn, and by surpluses many lie at the step.
    #[test]
    fn points_stand_for_all_area_and_find_edges_of_light() {
        let all = [step()];
        let norm = Norm::of(ErrorNorm::Local, &all).unwrap();
        let runs = 400_u32;
        let mean = |drawn_by: &[Vec<f64>], of: &dyn Fn(&Spot, f64) -> f64| {
            let of_run = |run: u32| {
                let (spots, parts) = Spot::spread(&all, 100, u64::from(run), drawn_by);
                spots.iter().zip(parts).map(|(spot, part)| of(spot, part)).sum::<f64>()
            };
            (0..runs).map(of_run).sum::<f64>() / f64::from(runs)
        };
        let squared = |spot: &Spot, part: f64| part * all[0].test(spot.triangle, spot.at, &[[0.0; 2]], 0.0).difference_sq;
        let at_step = |spot: &Spot, _: f64| f64::from(u8::from(all[0].surplus_sq(spot.triangle) > 0.0));
        let exact = STEP * LIGHT[0].powi(2) + (1.0 - STEP) * LIGHT[1].powi(2);
        let ways = [by_weight(&all), by_weight_and_surplus(&all, &norm)];
        for drawn_by in &ways {
            let whole = mean(drawn_by, &|_, part| part);
            assert!((whole - 1.0).abs() < 0.01, "{whole}");
            let sum = mean(drawn_by, &squared);
            assert!((sum - exact).abs() < 0.03, "{sum} for {exact}");
        }
        let [few, many] = [0, 1].map(|way| mean(&ways[way], &at_step));
        assert!(few < 25.0 && (many - 50.0 - 0.5 * few).abs() < 1.0, "{few} and {many} of 100");
    }
}
