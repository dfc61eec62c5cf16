//! The two norms of errors, at points that are uniform by area.
//!
//! ```text
//! energy:  ||B - R|| / ||R - E||
//! local:   root mean square over lit points of |B - R| / max(|R - E|, m), m the median of |R - E| over lit points
//! ```
//!
//! channels pooled, R the reference. The square of its own noise is taken off that of what is measured.

use std::str::FromStr;

use super::reference::Reference;

/// In which norm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Norm {
    Local,
    Energy,
}

impl Norm {
    pub const ALL: [Self; 2] = [Self::Local, Self::Energy];

    pub fn name(self) -> &'static str {
        match self {
            Self::Local => "local",
            Self::Energy => "energy",
        }
    }

    /// By what squares at points of this light count.
    pub fn weights(self, light: &[f64]) -> Vec<f64> {
        let mut lit: Vec<f64> = light.iter().copied().filter(|&light| light > 0.0).collect();
        lit.sort_by(f64::total_cmp);
        let count = lit.len();
        let of_all = 1.0 / light.iter().map(|light| light * light).sum::<f64>();
        let weight = |light: f64| match self {
            Self::Energy => of_all,
            Self::Local if light <= 0.0 => 0.0,
            Self::Local => 1.0 / (count as f64 * light.max(0.5 * (lit[(count - 1) / 2] + lit[count / 2])).powi(2)),
        };
        light.iter().map(|&light| weight(light)).collect()
    }

    /// The noise of a reference, one standard deviation.
    pub fn noise(self, reference: &Reference) -> f64 {
        let weights = self.weights(&reference.light());
        weights.iter().zip(&reference.noise).map(|(weight, &noise)| weight * square(noise)).sum::<f64>().sqrt()
    }

    /// How wrong values are. Points without a value count as right, unless there is none at all.
    pub fn error(self, values: &[[f64; 3]], reference: &Reference) -> Measured {
        if values.iter().all(|value| value.iter().all(|x| x.is_nan())) {
            return Measured { error: f64::INFINITY, least: f64::INFINITY };
        }
        let (mut error_sq, mut variance) = (0.0, 0.0);
        for (k, weight) in self.weights(&reference.light()).into_iter().enumerate() {
            if values[k].iter().all(|x| x.is_finite()) {
                let off = [0, 1, 2].map(|channel| values[k][channel] - reference.radiosity[k][channel]);
                for (off, noise) in off.iter().zip(reference.noise[k]) {
                    let true_sq = off * off - noise * noise;
                    error_sq += weight * true_sq;
                    variance += (weight * noise).powi(2) * (4.0 * true_sq.max(0.0) + 2.0 * noise * noise);
                }
            }
        }
        let least_sq = error_sq - SURE * variance.sqrt();
        Measured { error: error_sq.max(0.0).sqrt(), least: least_sq.max(0.0).sqrt() }
    }
}

impl FromStr for Norm {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        Self::ALL.into_iter().find(|norm| norm.name() == name).ok_or_else(|| format!("no norm is named '{name}'"))
    }
}

/// Standard deviations of the square of an error, by the noise of the reference, within which it is not known.
const SURE: f64 = 2.0;

/// An error as a reference shows it.
#[derive(Clone, Copy, Debug)]
pub struct Measured {
    pub error: f64,
    /// It is hardly less than this, whatever the noise of the reference is.
    pub least: f64,
}

/// The square of a vector of channels.
pub fn square(vector: [f64; 3]) -> f64 {
    vector.iter().map(|x| x * x).sum()
}
