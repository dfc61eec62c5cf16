//! Convex pieces of a source as seen from a point, and what an outline in front of them leaves.
//!
//! All planes pass through the point, so pieces are cones, given by unit directions to their corners. A convex outline is taken out of
//! a piece plane by plane: what lies outside of the plane through the point and an edge stays, as a piece of its own; what lies inside of all
//! is hidden (Nishita, Nakamae 1983; Lischinski 1994, chapter 4).
//!
//! # How exact
//! A corner within [`SLIVER`] of a plane lies on it, so that outlines which share an edge leave nothing between them. A cut may thus be off
//! by that angle, and the form factor of what is left by as much for each cut: the cosine-weighted solid angle over pi of a strip of
//! width w is at most w.

use glam::{DVec2, DVec3};

use super::outline::{Outline, SLIVER};
use crate::form_factor::from_directions;
use crate::geometry::Frame;

/// Pieces of a source, each a range of corners; memory that is reused.
#[derive(Default)]
pub(super) struct Pieces {
    corners: Vec<DVec3>,
    ranges: Vec<[u32; 2]>,
    /// The ranges after the next cut.
    left: Vec<[u32; 2]>,
    /// A piece under work, and what lies inside of the last plane.
    rest: Vec<DVec3>,
    inside: Vec<DVec3>,
    heights: Vec<f64>,
    /// Corners that were held against planes so far.
    pub steps: u64,
}

impl Pieces {
    /// One piece with these corners, counter-clockwise seen from its front, at any distance.
    pub fn restart(&mut self, corners: impl Iterator<Item = DVec3>) {
        self.corners.clear();
        self.corners.extend(corners.map(|corner| corner.normalize_or_zero()));
        self.ranges.clear();
        self.ranges.push([0, self.corners.len() as u32]);
        self.steps = 0;
    }

    /// The corners of each piece: unit directions, counter-clockwise seen from the front.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &[DVec3]> + Clone {
        self.ranges.iter().map(|&range| corners_of(&self.corners, range))
    }

    /// Whether nothing is left.
    pub fn is_empty(&self) -> bool {
        self.ranges.is_empty()
    }

    /// The form factor of all pieces, none of which reaches below the horizon.
    pub fn form_factor(&self, normal: DVec3) -> f64 {
        self.iter().map(|corners| from_directions(corners, normal)).sum::<f64>().min(1.0)
    }

    /// A unit direction through the middle of the piece that takes most of the view.
    pub fn middle_of_largest(&self) -> Option<DVec3> {
        let size = |corners: &[DVec3]| {
            let fan = corners[1..].windows(2).map(|pair| (pair[0] - corners[0]).cross(pair[1] - corners[0]));
            fan.sum::<DVec3>().length_squared()
        };
        let largest = self.iter().max_by(|a, b| size(a).total_cmp(&size(b)))?;
        Some(largest.iter().sum::<DVec3>().normalize_or_zero())
    }

    /// The least convex cone around all pieces of a source with this normal, by its edges: directions, counter-clockwise seen from the source's front.
    /// `None` if nothing is left.
    pub fn cone(&self, normal: DVec3) -> Option<Vec<DVec3>> {
        // Where the edges meet a plane in front of the source, sorted; then both chains around these points (Andrew 1979).
        let frame = Frame::around(normal);
        let on_plane = |corner: &DVec3| {
            let depth = -normal.dot(*corner);
            (DVec2::new(frame.tangent.dot(*corner), frame.bitangent.dot(*corner)) / depth, *corner)
        };
        let mut points: Vec<(DVec2, DVec3)> = self.iter().flatten().map(on_plane).collect();
        points.sort_unstable_by(|(a, _), (b, _)| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
        points.dedup_by(|(a, _), (b, _)| a == b);
        let chain = |points: &mut dyn Iterator<Item = &(DVec2, DVec3)>| {
            let mut chain: Vec<(DVec2, DVec3)> = Vec::new();
            for &(point, corner) in points {
                while let [.., (a, _), (b, _)] = chain[..]
                    && (b - a).perp_dot(point - b) <= 0.0
                {
                    chain.pop();
                }
                chain.push((point, corner));
            }
            chain.pop();
            chain
        };
        let (lower, upper) = (chain(&mut points.iter()), chain(&mut points.iter().rev()));
        let cone: Vec<DVec3> = lower.into_iter().chain(upper).map(|(_, corner)| corner).collect();
        (cone.len() > 2).then_some(cone)
    }

    /// Keeps what lies on the side of a plane that its unit normal points to.
    pub fn keep_inside(&mut self, plane: DVec3) {
        let mut ranges = std::mem::take(&mut self.ranges);
        for range in ranges.drain(..) {
            self.take_up(range);
            self.cut(plane, false);
            self.put_down();
        }
        (self.ranges, self.left) = (std::mem::take(&mut self.left), ranges);
    }

    /// Takes an outline out of all pieces.
    pub fn subtract(&mut self, outline: &Outline) {
        let mut ranges = std::mem::take(&mut self.ranges);
        for range in ranges.drain(..) {
            let corners = corners_of(&self.corners, range);
            self.steps += 2 * (corners.len() * outline.planes.len()) as u64;
            if outline.is_apart_from(corners) {
                self.left.push(range);
                continue;
            }

            // What is outside of a plane is left; what is inside of all is hidden.
            self.take_up(range);
            for &plane in &outline.planes {
                self.cut(plane, true);
            }
        }
        (self.ranges, self.left) = (std::mem::take(&mut self.left), ranges);
    }

    /// Makes a piece the one under work.
    fn take_up(&mut self, range: [u32; 2]) {
        self.rest.clear();
        self.rest.extend_from_slice(corners_of(&self.corners, range));
    }

    /// Adds the piece under work to those that are left.
    fn put_down(&mut self) {
        if self.rest.len() > 2 {
            let first = self.corners.len() as u32;
            self.corners.extend_from_slice(&self.rest);
            self.left.push([first, self.corners.len() as u32]);
        }
    }

    /// Cuts the piece under work to what is inside of a plane; what is outside is left where that is wanted.
    fn cut(&mut self, plane: DVec3, keeps_outside: bool) {
        let (mut lowest, mut highest) = (0.0_f64, 0.0_f64);
        self.heights.clear();
        for corner in &self.rest {
            let height = plane.dot(*corner);
            let height = if height.abs() <= SLIVER { 0.0 } else { height };
            (lowest, highest) = (lowest.min(height), highest.max(height));
            self.heights.push(height);
        }
        self.steps += self.rest.len() as u64;
        if lowest == 0.0 {
            return;
        }
        if highest == 0.0 {
            if keeps_outside {
                self.put_down();
            }
            self.rest.clear();
            return;
        }

        // Both sides in one pass; corners on the plane, and the two crossings, belong to both.
        let first = self.corners.len();
        self.inside.clear();
        for k in 0..self.rest.len() {
            let next = if k + 1 == self.rest.len() { 0 } else { k + 1 };
            let (corner, height, height_next) = (self.rest[k], self.heights[k], self.heights[next]);
            if height >= 0.0 {
                self.inside.push(corner);
            }
            if height <= 0.0 {
                self.corners.push(corner);
            }
            if (height > 0.0 && height_next < 0.0) || (height < 0.0 && height_next > 0.0) {
                let crossing = (corner * height_next - self.rest[next] * height) * (height_next - height).signum();
                let crossing = crossing.normalize_or_zero();
                self.inside.push(crossing);
                self.corners.push(crossing);
            }
        }
        if keeps_outside && self.corners.len() > first + 2 {
            self.left.push([first as u32, self.corners.len() as u32]);
        } else {
            self.corners.truncate(first);
        }
        std::mem::swap(&mut self.rest, &mut self.inside);
        if self.rest.len() < 3 {
            self.rest.clear();
        }
    }
}

fn corners_of(corners: &[DVec3], [first, end]: [u32; 2]) -> &[DVec3] {
    &corners[first as usize..end as usize]
}
