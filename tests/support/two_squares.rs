//! The exact solution for two facing unit squares, by a method of its own (Nystrom with Gauss points), at any point.
//!
//! `B_i(x) = E_i + rho_i Int k(x, y) V(x, y) B_j(y) dy`. The blocker's shadow, seen from a point x of one square, is the square
//! `2 m - x` for m in the blocker: a rectangle. Breaks in B lie at 0, 1/2 and 1 alone, because `m -> 2 b - m` maps that set to itself. So
//! B is interpolated from 11 x 11 Gauss points on each quarter of a square, and integrated over cells cut at 0, 1/2, 1 and the shadow's edges.
#![allow(dead_code, reason = "each test uses a part")]

use std::f64::consts::PI;

/// Gauss points per panel and direction.
const ORDER: usize = 11;
/// Panels per direction.
const PANELS: usize = 2;
const SIDE: usize = ORDER * PANELS;

const E: [f64; 2] = [1.0, 0.0];
const RHO: [f64; 2] = [0.5, 0.7];

/// A place of a rule, its weight, and the nodes that B there is interpolated from.
type Node = (f64, f64, Vec<(usize, f64)>);

/// The solution, B of both squares at the nodes.
pub struct TwoSquares {
    blocker: bool,
    rule: Vec<(f64, f64)>,
    b: [Vec<f64>; 2],
}

impl TwoSquares {
    pub fn new(blocker: bool) -> Self {
        let rule = gauss_rule();
        let mut solution = Self { blocker, rule, b: E.map(|e| vec![e; SIDE * SIDE]) };

        // The weights of the nodes of one square in the irradiance at a node of the other are the same both ways.
        let rows: Vec<Vec<f64>> =
            (0..SIDE * SIDE).map(|k| solution.weights([solution.node(k % SIDE), solution.node(k / SIDE)])).collect();
        for _ in 0..60 {
            for i in 0..2 {
                let irradiance = |row: &Vec<f64>| row.iter().zip(&solution.b[1 - i]).map(|(w, b)| w * b).sum::<f64>();
                solution.b[i] = rows.iter().map(|row| E[i] + RHO[i] * irradiance(row)).collect();
            }
        }
        solution
    }

    /// B at a point of the lower (0) or upper (1) square.
    pub fn at(&self, square: usize, x: [f64; 2]) -> f64 {
        let irradiance: f64 = self.weights(x).iter().zip(&self.b[1 - square]).map(|(w, b)| w * b).sum();
        E[square] + RHO[square] * irradiance
    }

    /// The mean of B over a square.
    pub fn mean(&self, square: usize) -> f64 {
        let weight = |k: usize| self.rule[k % ORDER].1 / PANELS as f64;
        (0..SIDE * SIDE).map(|k| weight(k % SIDE) * weight(k / SIDE) * self.b[square][k]).sum()
    }

    /// `||B - E||^2` over both squares.
    pub fn reflected_norm_sq(&self) -> f64 {
        let weight = |k: usize| self.rule[k % ORDER].1 / PANELS as f64;
        let over = |square: usize| -> f64 {
            (0..SIDE * SIDE).map(|k| weight(k % SIDE) * weight(k / SIDE) * (self.b[square][k] - E[square]).powi(2)).sum()
        };
        over(0) + over(1)
    }

    fn node(&self, k: usize) -> f64 {
        ((k / ORDER) as f64 + self.rule[k % ORDER].0) / PANELS as f64
    }

    /// What the irradiance at `x` takes of each node of the other square.
    fn weights(&self, x: [f64; 2]) -> Vec<f64> {
        let shadow = x.map(|x| [0.5 - x, 1.5 - x]);
        let cells = |axis: usize| -> Vec<[f64; 2]> {
            let mut cuts = vec![0.0, 0.5, 1.0];
            if self.blocker {
                cuts.extend(shadow[axis].iter().filter(|&&cut| cut > 0.0 && cut < 1.0));
            }
            cuts.sort_by(f64::total_cmp);
            cuts.windows(2).map(|cell| [cell[0], cell[1]]).filter(|cell| cell[1] > cell[0]).collect()
        };
        let dark = |axis: usize, cell: [f64; 2]| {
            let middle = 0.5 * (cell[0] + cell[1]);
            middle > shadow[axis][0] && middle < shadow[axis][1]
        };
        let mut weights = vec![0.0; SIDE * SIDE];
        for cell_y in cells(1) {
            for cell_x in cells(0) {
                if self.blocker && dark(0, cell_x) && dark(1, cell_y) {
                    continue;
                }
                let nodes = |cell: [f64; 2]| -> Vec<Node> {
                    let length = cell[1] - cell[0];
                    let place = |&(t, w): &(f64, f64)| (cell[0] + t * length, w * length, self.interpolation(cell[0] + t * length));
                    self.rule.iter().map(place).collect()
                };
                let along = nodes(cell_x);
                for (y1, w1, from1) in nodes(cell_y) {
                    for (y0, w0, from0) in &along {
                        let distance_sq = 1.0 + (x[0] - y0).powi(2) + (x[1] - y1).powi(2);
                        let weight = w0 * w1 / (PI * distance_sq * distance_sq);
                        for (k1, l1) in &from1 {
                            for (k0, l0) in from0 {
                                weights[k1 * SIDE + k0] += weight * l0 * l1;
                            }
                        }
                    }
                }
            }
        }
        weights
    }

    /// The nodes of the panel of `y`, each with its Lagrange polynomial at `y`.
    fn interpolation(&self, y: f64) -> Vec<(usize, f64)> {
        let panel = ((y * PANELS as f64) as usize).min(PANELS - 1);
        let t = y * PANELS as f64 - panel as f64;
        let polynomial = |k: usize| -> f64 {
            (0..ORDER).filter(|&m| m != k).map(|m| (t - self.rule[m].0) / (self.rule[k].0 - self.rule[m].0)).product()
        };
        (0..ORDER).map(|k| (panel * ORDER + k, polynomial(k))).collect()
    }
}

/// Points and weights of the Gauss rule on [0, 1], by Newton's iteration on the Legendre polynomial.
fn gauss_rule() -> Vec<(f64, f64)> {
    let n = ORDER as f64;
    let point = |k: usize| {
        let mut x = (PI * (k as f64 + 0.75) / (n + 0.5)).cos();
        let mut slope = 0.0;
        for _ in 0..50 {
            let (mut p, mut before) = (1.0, 0.0);
            for m in 0..ORDER {
                let m = m as f64;
                (p, before) = (((2.0 * m + 1.0) * x * p - m * before) / (m + 1.0), p);
            }
            slope = n * (x * p - before) / (x * x - 1.0);
            x -= p / slope;
        }
        (0.5 * (1.0 - x), 1.0 / ((1.0 - x * x) * slope * slope))
    };
    (0..ORDER).map(point).collect()
}
