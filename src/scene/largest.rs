//! The largest surfaces, for work that not all of them are worth.

use super::Scene;
use crate::geometry::sampling;

/// So many of the surfaces with these numbers, the largest ones, in any order; of those as large as each other any, all over the scene.
pub(crate) fn largest(scene: &Scene, mut numbers: Vec<usize>, most: usize) -> Vec<usize> {
    if numbers.len() > most {
        let area = |number: usize| scene.surfaces()[number].polygon.area();
        let any = |number: usize| sampling::hash(number as u64, 0);
        numbers.select_nth_unstable_by(most, |&a, &b| area(b).total_cmp(&area(a)).then_with(|| any(a).cmp(&any(b))));
        numbers.truncate(most);
    }
    numbers
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::geometry::Polygon;
    use crate::scene::{Material, Sides};

    #[test]
    fn the_largest_are_taken_and_of_equal_ones_some_everywhere() {
        // A thousand tiles in a row, and a larger one at the end.
        let tile = |number: u32| {
            let side = if number == 1000 { 2.0 } else { 1.0 };
            let corner = 3.0 * f64::from(number) * DVec3::X;
            let (u, v) = (side * DVec3::X, side * DVec3::Y);
            (Polygon::from_vertices(vec![corner, corner + u, corner + u + v, corner + v]).unwrap(), 0, number)
        };
        let material = Material { name: String::new(), reflectance: vec![0.5], exitance: vec![0.0] };
        let scene = Scene::new(1, vec![material], (0..=1000).map(tile).collect(), Sides::Front).unwrap();
        let found = largest(&scene, (0..=1000).collect(), 101);
        assert_eq!(found.len(), 101);
        assert!(found.contains(&1000));
        // A hundred of a thousand by chance: 25 in each quarter, give or take five standard deviations.
        for quarter in 0..4 {
            let within = found.iter().filter(|&&number| number / 250 == quarter).count();
            assert!((3..=47).contains(&within), "{within} in quarter {quarter}");
        }
        assert_eq!(largest(&scene, vec![7, 5], 2), [7, 5]);
        assert!(largest(&scene, vec![7, 5], 0).is_empty());
    }
}
