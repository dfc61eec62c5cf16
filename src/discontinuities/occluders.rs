//! The edges and corners of a scene, and which of them are followed for a source: those whose shadows may matter, the ones of most effect if there
//! are too many.

use super::corners::{self, Corner};
use super::counters::Counters;
use super::edges::{self, Edge};
use super::effect::Lit;
use super::faces::Faces;
use crate::geometry::Aabb;
use crate::visibility::BoxTree;

/// What may cast a shadow with a sharp border.
pub(super) enum Occluder {
    Edge(Edge),
    Corner(Corner),
}

/// All edges and corners of a scene.
pub(super) struct Occluders {
    all: Vec<Occluder>,
    boxes: BoxTree,
}

impl Occluder {
    fn bounds(&self) -> Aabb {
        match self {
            Self::Edge(edge) => Aabb::around(edge.ends),
            Self::Corner(corner) => Aabb::around([corner.place]),
        }
    }

    /// The length of what hides the source there, in metres.
    fn length(&self) -> f64 {
        match self {
            Self::Edge(edge) => edge.ends[0].distance(edge.ends[1]),
            Self::Corner(corner) => corner.arms,
        }
    }
}

impl Occluders {
    /// Finds them, and counts them.
    pub fn of(faces: &Faces<'_>, counters: &mut Counters) -> Self {
        let (edges, corners) = rayon::join(|| edges::welded(faces), || corners::welded(faces));
        counters.edges = edges.len() as u64;
        counters.corners = corners.len() as u64;
        let all: Vec<Occluder> = edges.into_iter().map(Occluder::Edge).chain(corners.into_iter().map(Occluder::Corner)).collect();
        let boxes = BoxTree::of(all.iter().map(Occluder::bounds));
        Self { all, boxes }
    }

    /// Those that may cast shadows that matter on what is lit, in order; of more than `most` the ones whose shadows matter farthest. The others
    /// are counted.
    pub fn before(&self, lit: &Lit<'_>, most: usize, counters: &mut Counters) -> Vec<&Occluder> {
        let mut numbers = Vec::new();
        let may_meet = |centre, half| lit.may_be_shadowed_by(&Aabb { min: centre - half, max: centre + half });
        self.boxes.until_enough_where(may_meet, |number| {
            numbers.push(number);
            false
        });
        counters.weak_edges += (self.all.len() - numbers.len()) as u64;

        if numbers.len() > most {
            let reach = |number: u32| {
                let occluder = &self.all[number as usize];
                lit.reach(&occluder.bounds(), occluder.length())
            };
            let mut by_reach: Vec<(f64, u32)> = numbers.iter().map(|&number| (reach(number), number)).collect();
            by_reach.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
            counters.unfollowed_edges += (numbers.len() - most) as u64;
            numbers = by_reach[..most].iter().map(|&(_, number)| number).collect();
        }
        numbers.sort_unstable();
        numbers.into_iter().map(|number| &self.all[number as usize]).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::emitters::emitters;
    use super::super::segments::Source;
    use super::*;
    use crate::geometry::Polygon;
    use crate::scene::{Material, Scene, Sides, SurfaceId};

    #[test]
    fn of_too_many_the_ones_that_matter_farthest_are_followed_and_the_others_counted() {
        let square = |at: [f64; 3], size: f64, turn: f64| {
            let corner = |x: f64, y: f64| [at[0] + size * x, at[1] + turn * size * y, at[2]];
            Polygon::new(&[corner(0.0, 0.0), corner(1.0, 0.0), corner(1.0, 1.0), corner(0.0, 1.0)]).unwrap()
        };
        // A lamp that shines down on a floor, and sheets of several sizes between.
        let mut polygons = vec![square([0.0, 1.0, 2.0], 1.0, -1.0), square([-4.0, -4.0, 0.0], 9.0, 1.0)];
        polygons.extend((1..8).map(|k| square([f64::from(k) * 0.3 - 1.0, 0.2, 1.0], 0.03 * f64::from(k), 1.0)));
        let grey = Material { name: "grey".to_owned(), reflectance: vec![0.5], exitance: vec![0.0] };
        let faces = polygons.into_iter().zip(0..).map(|(polygon, face)| (polygon, 0, face)).collect();
        let scene = Scene::new(1, vec![grey], faces, Sides::Front).unwrap();
        let faces = Faces::of(&scene);
        let emitters = emitters(&faces, &[Source { surface: SurfaceId(0), radiosity: 1.0 }]);
        let lit = Lit::by(&faces, &emitters[0], &|_| 1e-3, 1e-3);

        let reach = |occluder: &Occluder| lit.reach(&occluder.bounds(), occluder.length());
        let mut counters = Counters::default();
        let occluders = Occluders::of(&faces, &mut counters);
        let all = occluders.before(&lit, usize::MAX, &mut counters);
        assert!(all.len() > 40 && counters.unfollowed_edges == 0);
        let some = occluders.before(&lit, 10, &mut counters);
        assert_eq!((some.len(), counters.unfollowed_edges), (10, all.len() as u64 - 10));
        let least = some.iter().map(|occluder| reach(occluder)).fold(f64::INFINITY, f64::min);
        assert!(all.iter().filter(|occluder| reach(occluder) > least).count() < 10);
    }
}
