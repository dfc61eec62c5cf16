//! What the elements of the four polygons exchange, by ways of our own: nothing is sampled.
//!
//! Unoccluded form factors between elements are exact. What the lamp hides of one element from a point of another is a polygon, the
//! part of it in the pyramid of the lamp: its form factor is exact, too, and is integrated over the points by a mid-point rule. The
//! lamp touches nothing, so that the integrand is smooth but for kinks.

use patchlight::form_factor::{exact_area_form_factor, point_form_factor};
use patchlight::geometry::Polygon;
use patchlight::hierarchy::NodeId;
use patchlight::scene::SurfaceId;
use patchlight::solve::Solution;

type Point = [f64; 3];

/// What all pairs of elements exchange, and what follows from it.
pub struct Exact {
    pub elements: Vec<NodeId>,
    pub below: Vec<Vec<u32>>,
    /// `A F` in m^2, element after element.
    exchange: Vec<f64>,
    pub areas: Vec<f64>,
    /// The radiosities of the elements with these form factors, channels in a row.
    pub radiosity: Vec<f64>,
    pub exitance: Vec<f64>,
}

impl Exact {
    /// With the mid-points of `points` by `points` cells on each element. Surface `lamp` is all that hides anything.
    pub fn new(solution: &Solution, lamp: u32, points: usize) -> Self {
        let (elements, below) = super::run::elements_below(solution);
        let hierarchy = solution.hierarchy();
        let polygons: Vec<Polygon> =
            elements.iter().map(|&node| Polygon::new(&hierarchy.polygon(node)).expect("an element")).collect();
        let surface = |index: usize| hierarchy.surface_of(elements[index]).expect("elements are of surfaces").0;
        let blocker: Vec<Point> = solution.scene().surfaces()[lamp as usize].polygon.vertices().collect();
        let count = elements.len();
        let mut exchange = vec![0.0; count * count];
        for a in 0..count {
            for b in (a + 1..count).filter(|&b| surface(a) != surface(b)) {
                let mut value = exact_area_form_factor(&polygons[a], &polygons[b]);
                if value > 0.0 && surface(a) != lamp && surface(b) != lamp {
                    value = (value - hidden(&polygons[a], &polygons[b], &blocker, points)).max(0.0);
                }
                exchange[a * count + b] = value;
                exchange[b * count + a] = value;
            }
        }
        let areas: Vec<f64> = polygons.iter().map(Polygon::area).collect();
        let materials = (0..count).map(|index| solution.scene().material_of(SurfaceId(surface(index))));
        let (exitance, reflectance): (Vec<_>, Vec<_>) =
            materials.map(|material| (material.exitance.clone(), material.reflectance.clone())).unzip();
        let (exitance, reflectance) = (exitance.concat(), reflectance.concat());
        let radiosity = radiosities(&exchange, &areas, &exitance, &reflectance);
        Self { elements, below, exchange, areas, radiosity, exitance }
    }

    /// Between two elements by their numbers.
    pub fn between(&self, a: u32, b: u32) -> f64 {
        self.exchange[a as usize * self.elements.len() + b as usize]
    }

    /// Between two nodes.
    pub fn exchange(&self, first: NodeId, second: NodeId) -> f64 {
        let below = &self.below[second.index()];
        self.below[first.index()].iter().flat_map(|&a| below.iter().map(move |&b| self.between(a, b))).sum()
    }

    /// The largest mean kernel between an element below one and an element below the other, in 1/m^2: the largest kernel is at
    /// least this.
    pub fn least_largest_kernel(&self, first: NodeId, second: NodeId) -> f64 {
        let below = &self.below[second.index()];
        let mean = |a: u32, b: u32| self.between(a, b) / (self.areas[a as usize] * self.areas[b as usize]);
        self.below[first.index()].iter().flat_map(|&a| below.iter().map(move |&b| mean(a, b))).fold(0.0, f64::max)
    }

    /// The largest difference to another table, and the sum of all, as parts of the largest exchange and of all.
    pub fn difference(&self, other: &Self) -> (f64, f64) {
        let differences = || self.exchange.iter().zip(&other.exchange).map(|(a, b)| (a - b).abs());
        let largest = self.exchange.iter().copied().fold(0.0, f64::max);
        (differences().fold(0.0, f64::max) / largest, differences().sum::<f64>() / self.exchange.iter().sum::<f64>())
    }
}

/// `B_r = E_r + rho_r sum over s of F_rs B_s`, iterated to the end.
fn radiosities(exchange: &[f64], areas: &[f64], exitance: &[f64], reflectance: &[f64]) -> Vec<f64> {
    let (count, channels) = (areas.len(), exitance.len() / areas.len());
    let mut radiosity = exitance.to_vec();
    for _ in 0..60 {
        let next = (0..count * channels).map(|place| {
            let (element, channel) = (place / channels, place % channels);
            let row = &exchange[element * count..][..count];
            let arriving: f64 = row.iter().enumerate().map(|(other, f)| f * radiosity[other * channels + channel]).sum();
            exitance[place] + reflectance[place] * arriving / areas[element]
        });
        radiosity = next.collect();
    }
    radiosity
}

/// The part of `A F` in m^2 between two elements that a polygon hides.
fn hidden(receiver: &Polygon, source: &Polygon, blocker: &[Point], points: usize) -> f64 {
    let corners: Vec<Point> = receiver.vertices().collect();
    let [origin, u, v] = [corners[0], sub(corners[1], corners[0]), sub(corners[3], corners[0])];
    let source: Vec<Point> = source.vertices().collect();
    let place = |k: usize| (k as f64 + 0.5) / points as f64;
    let mut sum = 0.0;
    for i in 0..points {
        for j in 0..points {
            let x = std::array::from_fn(|axis| origin[axis] + place(i) * u[axis] + place(j) * v[axis]);
            let behind = behind_blocker(x, &source, blocker);
            // What is left of an edge has no area.
            if let Ok(part) = Polygon::new(&behind) {
                sum += point_form_factor(x, receiver.normal(), &part);
            }
        }
    }
    receiver.area() * sum / (points * points) as f64
}

/// The part of a polygon that a point sees through another one, on the far side of it.
fn behind_blocker(x: Point, polygon: &[Point], blocker: &[Point]) -> Vec<Point> {
    let centre: Point = std::array::from_fn(|axis| blocker.iter().map(|corner| corner[axis]).sum::<f64>() / blocker.len() as f64);
    let plane = cross(sub(blocker[1], blocker[0]), sub(blocker[2], blocker[0]));
    let side = dot(plane, sub(x, blocker[0]));
    let mut part = clip(polygon, times(plane, -side.signum()), blocker[0]);
    for (k, &corner) in blocker.iter().enumerate() {
        let normal = cross(sub(corner, x), sub(blocker[(k + 1) % blocker.len()], x));
        part = clip(&part, times(normal, dot(normal, sub(centre, x)).signum()), x);
    }
    part
}

/// The part of a convex polygon on the side of a plane that its normal looks to (Sutherland, Hodgman 1974).
fn clip(polygon: &[Point], normal: Point, origin: Point) -> Vec<Point> {
    let mut part = Vec::with_capacity(polygon.len() + 1);
    for (k, &a) in polygon.iter().enumerate() {
        let b = polygon[(k + 1) % polygon.len()];
        let (height_a, height_b) = (dot(normal, sub(a, origin)), dot(normal, sub(b, origin)));
        if height_a >= 0.0 {
            part.push(a);
        }
        if (height_a > 0.0) != (height_b > 0.0) && height_a != height_b {
            let t = height_a / (height_a - height_b);
            part.push(std::array::from_fn(|axis| a[axis] + t * (b[axis] - a[axis])));
        }
    }
    part
}

fn sub(a: Point, b: Point) -> Point {
    std::array::from_fn(|axis| a[axis] - b[axis])
}

fn times(a: Point, factor: f64) -> Point {
    a.map(|x| factor * x)
}

fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Point, b: Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
