//! What many numbers say together, as those of a measuring plane.

/// Mean, extremes and uniformity of some numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Summary {
    /// How many there are.
    pub count: usize,
    /// Their mean.
    pub mean: f64,
    /// The standard error of the mean, as if all were off to the same side: no less than the true one. Not a number where one is not known.
    pub standard_error: f64,
    /// The least.
    pub minimum: f64,
    /// The largest.
    pub maximum: f64,
}

impl Summary {
    /// Of numbers with their standard errors; those that are not a number do not count. `None` if there is none.
    pub fn of(numbers: impl Iterator<Item = [f32; 2]>) -> Option<Self> {
        let mut summary = Self { count: 0, mean: 0.0, standard_error: 0.0, minimum: f64::INFINITY, maximum: f64::NEG_INFINITY };
        for [value, error] in numbers.map(|number| number.map(f64::from)).filter(|[value, _]| !value.is_nan()) {
            summary.count += 1;
            summary.mean += value;
            summary.standard_error += error;
            summary.minimum = summary.minimum.min(value);
            summary.maximum = summary.maximum.max(value);
        }
        let count = summary.count as f64;
        let of_all = Self { mean: summary.mean / count, standard_error: summary.standard_error / count, ..summary };
        (summary.count > 0).then_some(of_all)
    }

    /// The least over the mean, 0 to 1 (EN 12665, `U_0`); 1 where all is dark.
    pub fn uniformity(&self) -> f64 {
        if self.mean > 0.0 { self.minimum / self.mean } else { 1.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_a_number_does_not_count() {
        let numbers = [[1.0, 0.1], [f32::NAN, f32::NAN], [3.0, 0.3], [2.0, 0.2]];
        let summary = Summary::of(numbers.into_iter()).unwrap();
        assert_eq!((summary.count, summary.mean, summary.minimum, summary.maximum), (3, 2.0, 1.0, 3.0));
        assert!((summary.standard_error - 0.2).abs() < 1e-6 && summary.uniformity() == 0.5);
        assert_eq!(Summary::of([[f32::NAN; 2]].into_iter()), None);
        let dark = Summary::of([[0.0, 0.0]].into_iter()).unwrap();
        assert_eq!((dark.uniformity(), dark.mean), (1.0, 0.0));
    }
}
