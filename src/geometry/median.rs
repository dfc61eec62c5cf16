//! Medians: where most of a set lies, whatever a few of it do.

use glam::DVec3;

/// The median; 0 of nothing.
pub(crate) fn median(mut numbers: Vec<f64>) -> f64 {
    let middle = numbers.len() / 2;
    if numbers.is_empty() { 0.0 } else { *numbers.select_nth_unstable_by(middle, f64::total_cmp).1 }
}

/// The median of each coordinate; 0 where there is no point.
pub(crate) fn median_point(points: impl Iterator<Item = DVec3> + Clone) -> DVec3 {
    DVec3::from_array([0, 1, 2].map(|axis| median(points.clone().map(|point| point[axis]).collect())))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn far_points_do_not_move_the_median() {
        let near = [DVec3::new(1.0, 2.0, 3.0), DVec3::new(2.0, 1.0, 3.5), DVec3::new(1.5, 1.5, 2.5)];
        let far = [DVec3::splat(1e9), DVec3::splat(-1e9)];
        assert_eq!(median_point(near.into_iter().chain(far)), DVec3::new(1.5, 1.5, 3.0));
        assert_eq!(median_point([].into_iter()), DVec3::ZERO);
    }
}
