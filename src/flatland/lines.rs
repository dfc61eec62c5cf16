//! Integrals over sets of lines, exactly: how much gets through convex bodies that stand one behind another.
//!
//! Lines have the measure `drho dtheta`. Each body multiplies a line by one factor if it meets the body, by another if it does not. Along one
//! direction the product W is constant between the shadows of corners, and 0 far out, so by partial summation
//!
//! ```text
//! Integral W drho = sum over corners v of (W just below v - W just above v) rho_v,        rho_v = v . n(theta).
//! ```
//!
//! What a corner's line meets changes where it passes another corner, and `Integral v . n dtheta` between two such directions is `v` times the
//! difference of their unit vectors: as in Hottel's rule, nothing but distances between corners.
//!
//! Corners that coincide are passed one after the other, by their numbers, so their differences add up to the whole.
//!
//! **Cost.** `m` corners take `O(m^2 log m)`.

use glam::DVec2;

use super::segment::Segment;

/// A convex body, a segment or a box, and what lines are multiplied by.
pub(super) struct Body {
    pub corners: Vec<DVec2>,
    /// The factor of lines that meet it.
    pub met: f64,
    /// The factor of lines that do not.
    pub missed: f64,
}

impl Body {
    /// One that lines have to meet, or they do not count.
    pub fn end(segment: &Segment) -> Self {
        Self { corners: segment.points().into(), met: 1.0, missed: 0.0 }
    }

    /// One that lets a part of the light on lines through it pass, from 0 to 1.
    pub fn occluder(corners: &[DVec2], transmittance: f64) -> Self {
        Self { corners: corners.into(), met: transmittance, missed: 1.0 }
    }

    /// The factor of a line with so many of its corners on the left.
    fn factor(&self, left: usize) -> f64 {
        if left == 0 || left == self.corners.len() { self.missed } else { self.met }
    }
}

/// The integral of the product of all factors over all lines, in metres. Some body must be an end: else it would be infinite.
pub(super) fn integral_over_lines(bodies: &[Body]) -> f64 {
    // Numbers are least around the first corner.
    let Some(&origin) = bodies.first().and_then(|body| body.corners.first()) else { return 0.0 };
    let corners: Vec<(DVec2, usize)> = bodies
        .iter()
        .enumerate()
        .flat_map(|(owner, body)| body.corners.iter().map(move |&corner| (corner - origin, owner)))
        .collect();
    let mut pencil = Pencil { bodies, left: vec![0; bodies.len()], product: Product::default(), passed: Vec::new() };
    (0..corners.len()).map(|at| pencil.integral_at(&corners, at)).sum()
}

/// The lines through one corner, turning by pi, and how many corners of each body are on their left.
struct Pencil<'a> {
    bodies: &'a [Body],
    left: Vec<usize>,
    product: Product,
    passed: Vec<Passed>,
}

/// A corner that the line through another passes.
struct Passed {
    /// Ascends with the direction of the line.
    key: f64,
    /// The direction, with y >= 0.
    direction: DVec2,
    owner: usize,
    was_left: bool,
}

impl Pencil<'_> {
    /// What the corner `at` adds to the integral.
    fn integral_at(&mut self, corners: &[(DVec2, usize)], at: usize) -> f64 {
        let (corner, own) = corners[at];
        self.start(corners, at);
        let (mut total, mut since) = (0.0, DVec2::X);
        let mut jump = self.jump(own);
        let passed = std::mem::take(&mut self.passed);

        // The line turns until it is back where it began, as its own reverse.
        for event in &passed {
            total += jump * corner.dot(event.direction - since);
            since = event.direction;
            let before = self.left[event.owner];
            self.left[event.owner] = if event.was_left { before - 1 } else { before + 1 };
            if event.owner != own {
                let body = &self.bodies[event.owner];
                self.product.replace(body.factor(before), body.factor(self.left[event.owner]));
            }
            jump = self.jump(own);
        }
        self.passed = passed;
        total + jump * corner.dot(DVec2::NEG_X - since)
    }

    /// Takes stock of the line along x, turned a little to the left, and of what it is going to pass.
    fn start(&mut self, corners: &[(DVec2, usize)], at: usize) {
        let (corner, own) = corners[at];
        self.left.fill(0);
        self.passed.clear();
        for (k, &(other, owner)) in corners.iter().enumerate().filter(|&(k, _)| k != at) {
            let away = other - corner;
            let was_left = if away == DVec2::ZERO { k > at } else { away.y > 0.0 || away.y == 0.0 && away.x < 0.0 };
            self.left[owner] += usize::from(was_left);
            if away.y != 0.0 {
                let direction = away / away.x.hypot(away.y).copysign(away.y);
                self.passed.push(Passed { key: -away.x / away.y, direction, owner, was_left });
            }
        }
        self.passed.sort_unstable_by(|a, b| a.key.total_cmp(&b.key));
        self.product = Product::default();
        for (owner, body) in self.bodies.iter().enumerate().filter(|&(owner, _)| owner != own) {
            self.product.replace(1.0, body.factor(self.left[owner]));
        }
    }

    /// By how much W is more on the line just right of the corner, which then is on its left, than on the line just left.
    fn jump(&self, own: usize) -> f64 {
        let (body, left) = (&self.bodies[own], self.left[own]);
        let own_jump = body.factor(left + 1) - body.factor(left);
        if own_jump == 0.0 { 0.0 } else { own_jump * self.product.value() }
    }
}

/// A product of factors from 0 to 1 that come and go.
#[derive(Default)]
struct Product {
    zeros: usize,
    /// The logarithm of the others' product.
    log: f64,
}

impl Product {
    fn replace(&mut self, old: f64, new: f64) {
        if old == 0.0 {
            self.zeros -= 1;
        } else if old != 1.0 {
            self.log -= old.ln();
        }
        if new == 0.0 {
            self.zeros += 1;
        } else if new != 1.0 {
            self.log += new.ln();
        }
    }

    fn value(&self) -> f64 {
        if self.zeros > 0 { 0.0 } else { self.log.exp() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ends() -> [Body; 2] {
        [[(0.0, 0.0), (1.0, 0.0)], [(0.1, 2.0), (1.2, 2.1)]].map(|ends| Body {
            corners: ends.map(DVec2::from).into(),
            met: 1.0,
            missed: 0.0,
        })
    }

    fn through(bodies: [Body; 3]) -> f64 {
        integral_over_lines(&ends().into_iter().chain(bodies).collect::<Vec<_>>())
    }

    /// A bar, a box that it sticks in, and a box that shares a corner with the first.
    fn bodies(factors: [f64; 3]) -> [Body; 3] {
        let corners = [
            vec![(0.2, 0.8), (0.55, 0.9)],
            vec![(0.3, 0.7), (0.6, 0.7), (0.6, 1.1), (0.3, 1.1)],
            vec![(0.6, 1.1), (0.9, 1.1), (0.9, 1.5), (0.6, 1.5)],
        ];
        let mut of = corners.into_iter().zip(factors).map(|(corners, factor)| {
            let corners: Vec<DVec2> = corners.into_iter().map(DVec2::from).collect();
            Body::occluder(&corners, factor)
        });
        std::array::from_fn(|_| of.next().unwrap())
    }

    /// Receiver and source by so many points each, with `drho dtheta = cos cos / r dx dy`.
    fn by_points(factors: [f64; 3], count: i32) -> f64 {
        let ends = ends();
        let point = |end: &Body, k: i32| end.corners[0].lerp(end.corners[1], (f64::from(k) + 0.5) / f64::from(count));
        let pairs = (0..count * count).map(|k| (point(&ends[0], k / count), point(&ends[1], k % count)));
        let cos_cos = |line: DVec2| ends.iter().map(|end| (end.corners[1] - end.corners[0]).perp_dot(line).abs()).product::<f64>();
        let weight = |p: DVec2, q: DVec2| {
            let factor =
                |body: &Body| body.factor(body.corners.iter().filter(|&&corner| (q - p).perp_dot(corner - p) > 0.0).count());
            cos_cos(q - p) / (q - p).length().powi(3) * bodies(factors).iter().map(factor).product::<f64>()
        };
        pairs.map(|(p, q)| weight(p, q)).sum::<f64>() / f64::from(count).powi(2)
    }

    #[test]
    fn integrals_are_those_over_all_pairs_of_points() {
        for factors in [[1.0, 1.0, 1.0], [0.0, 1.0, 1.0], [0.0, 0.5, 0.0], [0.3, 0.5, 0.7]] {
            let (exact, counted) = (through(bodies(factors)), by_points(factors, 400));
            assert!((exact - counted).abs() < 2e-3 * exact, "{factors:?}: {exact}, {counted}");
        }
    }

    #[test]
    fn integrals_are_linear_in_each_factor() {
        for k in 0..3 {
            let with = |factor: f64| {
                let mut factors = [0.2, 0.4, 0.6];
                factors[k] = factor;
                through(bodies(factors))
            };
            assert!((with(0.25) - (0.75 * with(0.0) + 0.25 * with(1.0))).abs() < 1e-14);
        }
    }

    #[test]
    fn bodies_twice_or_with_all_corners_in_one_place_are_no_harm() {
        let [bar, first, second] = bodies([0.0, 1.0, 1.0]);
        let once = through([bar, first, second]);
        let [[bar, ..], [same, _, second]] = [bodies([0.0, 1.0, 1.0]), bodies([0.0, 1.0, 1.0])];
        assert!((through([bar, same, second]) - once).abs() < 1e-14);
        let [bar, first, _] = bodies([0.0, 1.0, 1.0]);
        let point = Body::occluder(&[DVec2::new(0.5, 1.0); 2], 0.0);
        assert!((through([bar, first, point]) - once).abs() < 1e-14);
        assert_eq!(integral_over_lines(&[]), 0.0);
    }
}
