//! How much noise there is on each surface, for what the batches of gathers tell.
//!
//! Directions that are spread evenly over what varies smoothly make less noise than batches of them tell; where few rays find most of the light they make
//! as much. So the two are far apart in one place and not in another, and two gathers at the same points tell by how much.

/// A surface counts by its own points, and by what all surfaces have in common as if that were so many points.
const COMMON: f64 = 16.0;

/// By surface, of so many: true variances for those that batches tell, by two gathers at points. Each has the number of its surface, half the squared
/// difference of the two, and the mean of what their batches tell, in the norm and times what it stands for.
pub(super) fn noise_scales(points: &[(usize, [f64; 2])], surfaces: usize) -> Vec<f64> {
    let mut sums = vec![[0.0; 2]; surfaces];
    let mut all = [0.0; 2];
    for &(surface, of) in points {
        for (number, of) in of.into_iter().enumerate() {
            sums[surface][number] += of;
            all[number] += of;
        }
    }
    if all[0] <= 0.0 || all[1] <= 0.0 {
        return vec![1.0; surfaces];
    }
    let common = COMMON / points.len() as f64;
    sums.into_iter().map(|[found, told]| (found + common * all[0]) / (told + common * all[1])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn surfaces_have_scales_of_their_own_as_far_as_points_tell() {
        // A third of what is told on the first, all of it on the second, none on the third, and nothing is known of the last.
        let points: Vec<(usize, [f64; 2])> =
            (0..3000).map(|number| (number % 3, [[1.0 / 3.0, 1.0, 0.0][number % 3], 1.0])).collect();
        let [first, second, third, last] = noise_scales(&points, 4)[..] else { panic!("one for each") };
        let common = 4.0 / 9.0;
        assert!((first - 1.0 / 3.0).abs() < 0.01 && (second - 1.0).abs() < 0.01 && third < 0.01, "{first} {second} {third}");
        assert!((last - common).abs() < 1e-9, "{last}");
        assert_eq!(noise_scales(&[(0, [0.0; 2])], 1), [1.0]);
        assert_eq!(noise_scales(&[], 2), [1.0; 2]);
    }
}
