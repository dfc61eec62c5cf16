//! Sums over points, and how they scatter from one draw of the points to another.

/// How a sum over random points lies around its mean.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Scatter {
    /// Its standard deviation.
    pub deviation: f64,
    /// Its third central moment over the cube of its deviation: above 0 where few points hold much of the sum.
    pub skewness: f64,
}

impl Scatter {
    /// The same beside something independent that scatters normally, with this standard deviation.
    pub fn beside(self, deviation: f64) -> Self {
        self.of_deviation(self.deviation.hypot(deviation))
    }

    /// The same third moment where the deviation is known to be at least so large.
    pub fn at_least(self, deviation: f64) -> Self {
        self.of_deviation(self.deviation.max(deviation))
    }

    fn of_deviation(self, deviation: f64) -> Self {
        let skewness = if deviation > 0.0 { self.skewness * (self.deviation / deviation).powi(3) } else { 0.0 };
        Self { deviation, skewness }
    }
}

/// Sums of the powers of what points found.
#[derive(Clone, Copy, Default)]
pub(crate) struct Moments {
    count: f64,
    pub sum: f64,
    sum_sq: f64,
    sum_cube: f64,
}

impl Moments {
    pub fn add(&mut self, value: f64) {
        self.count += 1.0;
        self.sum += value;
        self.sum_sq += value * value;
        self.sum_cube += value * value * value;
    }

    /// The standard deviation of the sum, by the scatter of what was added.
    pub fn deviation_of_sum(&self) -> f64 {
        let scatter = (self.sum_sq - self.sum * self.sum / self.count).max(0.0);
        (scatter / (self.count - 1.0).max(1.0) * self.count).sqrt()
    }

    /// How the sum scatters, by its second and third moments.
    pub fn scatter_of_sum(&self) -> Scatter {
        let (deviation, mean) = (self.deviation_of_sum(), self.sum / self.count);
        if deviation == 0.0 || self.count < 3.0 {
            return Scatter { deviation, skewness: 0.0 };
        }
        let cubes = self.sum_cube - 3.0 * mean * self.sum_sq + 2.0 * mean * mean * self.sum;
        let third = cubes * self.count * self.count / ((self.count - 1.0) * (self.count - 2.0));
        Scatter { deviation, skewness: third / deviation.powi(3) }
    }
}

impl Extend<f64> for Moments {
    fn extend<T: IntoIterator<Item = f64>>(&mut self, values: T) {
        values.into_iter().for_each(|value| self.add(value));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(values: &[f64]) -> Moments {
        let mut moments = Moments::default();
        moments.extend(values.iter().copied());
        moments
    }

    #[test]
    fn one_value_among_zeros_has_the_skewness_that_is_computed_by_hand() {
        // Of n values all but one 0: deviation of the sum 1, third moment n^2 / ((n-1)(n-2)) times (1 - 1/n)(1 - 2/n) = 1.
        let mut values = vec![0.0; 100];
        values[7] = 3.0;
        let Scatter { deviation, skewness } = of(&values).scatter_of_sum();
        assert!((deviation - 3.0).abs() < 1e-12 && (skewness - 1.0).abs() < 1e-12, "{deviation}, {skewness}");
        let even = of(&[1.0, 2.0, 3.0, 4.0]).scatter_of_sum();
        assert!(even.skewness.abs() < 1e-12 && (even.deviation.powi(2) - 4.0 * 5.0 / 3.0).abs() < 1e-12);
        assert_eq!(of(&[2.0; 5]).scatter_of_sum(), Scatter::default());
    }

    #[test]
    fn what_scatters_normally_adds_to_the_deviation_alone() {
        let skewed = Scatter { deviation: 3.0, skewness: 1.0 };
        let Scatter { deviation, skewness } = skewed.beside(4.0);
        assert_eq!((deviation, skewness), (5.0, 27.0 / 125.0));
        assert_eq!(skewed.at_least(6.0), Scatter { deviation: 6.0, skewness: 0.125 });
        assert_eq!(skewed.at_least(1.0), skewed);
        assert_eq!(Scatter::default().beside(0.0), Scatter::default());
    }
}
