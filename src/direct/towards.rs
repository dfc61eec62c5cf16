//! Directions in which direct light comes: drawn by what it brings, or where none comes, by what would with nothing in between.

use glam::DVec3;

use crate::geometry::{Facet, sampling, streams};

/// A random direction towards an emitter.
#[derive(Clone, Copy)]
pub(crate) struct Towards {
    /// Of unit length.
    pub direction: DVec3,
    /// Of the part of the emitter that it was drawn from, in sr, about.
    pub solid_angle: f64,
}

/// As many directions as are wanted, each drawn by itself; memory that is reused.
#[derive(Default)]
pub(crate) struct DrawnTowards {
    wanted: usize,
    seed: u64,
    seen: Reservoir,
    hidden: Reservoir,
}

/// Draws in one pass over what there is to draw from (Chao, Biometrika 69, 1982).
#[derive(Default)]
struct Reservoir {
    /// The weight and the number of what was offered.
    weight: f64,
    offered: u64,
    drawn: Vec<Towards>,
}

impl DrawnTowards {
    /// How many directions are drawn at the points to come.
    pub fn want(&mut self, count: usize) {
        self.wanted = count;
    }

    /// Begins at another point.
    pub(super) fn restart(&mut self, seed: u64) {
        self.seed = sampling::hash(seed, streams::TOWARDS);
        self.seen.clear();
        self.hidden.clear();
    }

    /// What is seen of an emitter, by unit directions to the corners of convex pieces, and what it brings.
    pub(super) fn offer_seen<'p>(&mut self, brings: f64, pieces: impl Iterator<Item = &'p [DVec3]> + Clone) {
        if self.wanted > 0 {
            self.seen.offer(brings, pieces, self.wanted, self.seed);
        }
    }

    /// An emitter that is seen as a whole, by directions to its corners, and what it brings.
    pub(super) fn offer_whole(&mut self, brings: f64, corners: impl Iterator<Item = DVec3>) {
        if self.wanted > 0 {
            self.seen.offer(brings, std::iter::once(&unit_directions(corners)[..]), self.wanted, self.seed);
        }
    }

    /// An emitter of which nothing may be seen, and what it would bring, likewise.
    pub(super) fn offer_hidden(&mut self, would_bring: f64, corners: impl Iterator<Item = DVec3>) {
        if self.wanted > 0 {
            self.hidden.offer(would_bring, std::iter::once(&unit_directions(corners)[..]), self.wanted, !self.seed);
        }
    }

    /// The directions at this point; none if there are no emitters before it.
    pub fn drawn(&self) -> &[Towards] {
        if self.seen.drawn.is_empty() { &self.hidden.drawn } else { &self.seen.drawn }
    }
}

impl Reservoir {
    fn clear(&mut self) {
        (self.weight, self.offered) = (0.0, 0);
        self.drawn.clear();
    }

    fn offer<'p>(&mut self, weight: f64, pieces: impl Iterator<Item = &'p [DVec3]> + Clone, wanted: usize, seed: u64) {
        let solid_angle: f64 = pieces.clone().map(|corners| vector_area(corners).length()).sum();
        if weight <= 0.0 || solid_angle <= 0.0 {
            return;
        }
        self.weight += weight;
        self.offered += 1;
        for slot in 0..wanted {
            let draw = sampling::hash(sampling::hash(seed, slot as u64), self.offered);
            if sampling::unit(draw) * self.weight > weight && slot < self.drawn.len() {
                continue;
            }
            let towards = Towards { direction: direction_in(pieces.clone(), solid_angle, draw), solid_angle };
            match self.drawn.get_mut(slot) {
                Some(drawn) => *drawn = towards,
                None => self.drawn.push(towards),
            }
        }
    }
}

fn unit_directions(corners: impl Iterator<Item = DVec3>) -> Vec<DVec3> {
    corners.map(DVec3::normalize_or_zero).collect()
}

/// Of a convex piece, by unit directions to its corners: of the length of its solid angle if that is small, else less.
fn vector_area(corners: &[DVec3]) -> DVec3 {
    let fan = corners[1..].windows(2).map(|pair| (pair[0] - corners[0]).cross(pair[1] - corners[0]));
    0.5 * fan.sum::<DVec3>()
}

/// A random direction in some pieces of this solid angle, about uniform.
fn direction_in<'p>(pieces: impl Iterator<Item = &'p [DVec3]>, solid_angle: f64, draw: u64) -> DVec3 {
    let random = |number: u64| sampling::unit(sampling::hash(draw, number));
    let (wanted, mut below, mut direction) = (random(0) * solid_angle, 0.0, DVec3::ZERO);
    for corners in pieces {
        let area = vector_area(corners);
        if area == DVec3::ZERO {
            continue;
        }
        below += area.length();
        if direction == DVec3::ZERO || below > wanted {
            direction = Facet::of_part(corners, area.normalize()).point_at(random(streams::SECOND), random(streams::THIRD));
        }
        if below > wanted {
            break;
        }
    }
    direction.normalize_or_zero()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(middle: DVec3, side: f64) -> Vec<DVec3> {
        let corner = |x: f64, y: f64| (middle + 0.5 * side * DVec3::new(x, y, 0.0)).normalize();
        vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)]
    }

    /// Of two emitters one brings three times as much; a third is hidden.
    #[test]
    fn directions_go_where_light_comes_from_by_what_it_brings() {
        let [few, many, hidden] = [-1.0, 1.0, 0.0].map(|x| square(DVec3::new(x, 0.0, 1.0), 0.1));
        let mut drawn = DrawnTowards::default();
        drawn.want(4000);
        drawn.restart(1);
        drawn.offer_hidden(100.0, hidden.iter().copied());
        assert!(drawn.drawn().iter().all(|of| of.direction.z > 0.99) && drawn.drawn().len() == 4000);
        drawn.offer_seen(1.0, std::iter::once(&few[..]));
        drawn.offer_seen(3.0, std::iter::once(&many[..]));
        let to_many = drawn.drawn().iter().filter(|of| of.direction.x > 0.0).count();
        assert!((to_many as f64 / 4000.0 - 0.75).abs() < 0.03, "{to_many}");
        for of in drawn.drawn() {
            let off = of.direction / of.direction.z - DVec3::new(of.direction.x.signum(), 0.0, 1.0);
            assert!(off.abs().max_element() < 0.051 && (of.direction.length() - 1.0).abs() < 1e-12, "{off}");
            // 0.01 m^2 at a distance of sqrt 2, seen at 45 degrees.
            assert!((of.solid_angle / 0.003536 - 1.0).abs() < 0.01, "{}", of.solid_angle);
        }
        drawn.restart(2);
        assert!(drawn.drawn().is_empty());
    }
}
