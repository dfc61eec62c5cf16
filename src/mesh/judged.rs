//! How wrong a function on the surfaces is, in either norm.

use serde::{Deserialize, Serialize};

use super::growing::{Growing, Test};
use crate::error::{ErrorNorm, Moments, claim, upper_limit};

/// A norm over the surfaces of a mesh.
#[derive(Clone, Copy, Debug)]
pub(super) enum Norm {
    /// Relative to all light: its square over the area, in W^2/m^2; or over the pixels that show it.
    Energy { light_sq: f64 },
    /// Relative to the light at each place, or to typical light where it is darker: where there is light, in m^2 or pixels, and the median of its square
    /// over that.
    Local { lit: f64, typical_sq: f64 },
}

/// An error with its upper confidence limit.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Judged {
    pub measured: f64,
    pub claimed: f64,
    /// What noise of nodes has of the squared error.
    pub noise_sq: f64,
    /// Of all light and of each light group, if there are any: root mean squares over the area, channels added, in W/m^2.
    pub by_group: Vec<MeshError>,
}

/// What a mesh is off values in the root mean square over its area, channels added, in W/m^2.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct MeshError {
    pub measured: f64,
    pub claimed: f64,
}

impl MeshError {
    /// By squared errors at places, times the part of the area that each stands for.
    fn by(squares: impl Iterator<Item = f64>) -> Self {
        let mut parts = Moments::default();
        parts.extend(squares);
        Self { measured: parts.sum.max(0.0).sqrt(), claimed: upper_limit(parts.sum, parts.scatter_of_sum()) }
    }

    /// Of so many channels for each.
    pub fn of_copies(&self, copies: usize) -> Self {
        let scale = (copies as f64).sqrt();
        Self { measured: scale * self.measured, claimed: scale * self.claimed }
    }

    /// Of two errors that have nothing to do with each other.
    fn with(self, other: &Self) -> Self {
        Self { measured: self.measured.hypot(other.measured), claimed: self.claimed.hypot(other.claimed) }
    }
}

impl Norm {
    /// By the light that tests found; `None` where all is dark.
    pub fn of(norm: ErrorNorm, all: &[Growing]) -> Option<Self> {
        let mut lit = Vec::new();
        for of in all {
            lit.extend(of.tests_with_parts().filter(|(test, _)| test.light_sq > 0.0).map(|(test, part)| (test.light_sq, part)));
        }
        Self::by_light(norm, lit)
    }

    /// By the squared light of places where there is some, each with the part of the area, or of the pixels, that it stands for.
    pub fn by_light(norm: ErrorNorm, mut lit: Vec<(f64, f64)>) -> Option<Self> {
        if norm == ErrorNorm::Energy {
            let light_sq: f64 = lit.iter().map(|(light_sq, area)| light_sq * area).sum();
            return (light_sq > 0.0).then_some(Self::Energy { light_sq });
        }
        lit.sort_by(|a, b| a.0.total_cmp(&b.0));
        let area = lit.iter().map(|(_, area)| area).sum();
        let mut below = 0.0;
        let is_median = |of: &&(f64, f64)| {
            below += of.1;
            below >= 0.5 * area
        };
        lit.iter().find(is_median).map(|&(typical_sq, _)| Self::Local { lit: area, typical_sq })
    }

    /// The squared light where typical light is, in W^2/m^4; 0 where all is dark.
    pub fn typical_light_sq(all: &[Growing]) -> f64 {
        if let Some(Self::Local { typical_sq, .. }) = Self::of(ErrorNorm::Local, all) { typical_sq } else { 0.0 }
    }

    /// What noise of nodes has of the squared error on a surface.
    pub fn noise_sq(&self, of: &Growing) -> f64 {
        of.tests_with_parts().map(|(test, part)| part * self.weight(test.light_sq) * test.of_nodes_sq).sum()
    }

    /// What a squared error counts by m^2, or by pixel, where so much light is.
    pub fn weight(&self, light_sq: f64) -> f64 {
        match *self {
            Self::Energy { light_sq: all } => 1.0 / all,
            Self::Local { lit, typical_sq } => 1.0 / (lit * light_sq.max(typical_sq)),
        }
    }
}

impl Judged {
    /// Where there is no light nothing is wrong.
    pub const DARK: Self = Self { measured: 0.0, claimed: 0.0, noise_sq: 0.0, by_group: Vec::new() };

    /// What is measured without noise, squared; below 0 where noise tells more than was found.
    pub fn followed_sq(&self) -> f64 {
        self.measured.powi(2) - self.noise_sq
    }

    /// By tests with what each stands for of the whole, in m^2 or pixels, and its squared errors, of all light and of each light group.
    pub fn by(tests: &[(Test, f64, Vec<f64>)], whole: f64, norm: &Norm) -> Self {
        let mut parts = Moments::default();
        parts.extend(tests.iter().map(|(test, part, errors_sq)| part * norm.weight(test.light_sq) * errors_sq[0]));
        let noise_sq = tests.iter().map(|(test, part, _)| part * norm.weight(test.light_sq) * test.of_nodes_sq).sum();
        let groups = tests.first().map_or(0, |(.., errors_sq)| errors_sq.len());
        let of_group = |group: usize| MeshError::by(tests.iter().map(move |(_, part, errors_sq)| part / whole * errors_sq[group]));
        let by_group = if groups > 1 { (0..groups).map(of_group).collect() } else { Vec::new() };
        Self { measured: parts.sum.max(0.0).sqrt(), claimed: claim(parts.sum, parts.scatter_of_sum()), noise_sq, by_group }
    }

    /// Of two errors that have nothing to do with each other.
    pub fn with(self, other: Self) -> Self {
        let noise_sq = self.noise_sq + other.noise_sq;
        let (measured, claimed) = (self.measured.hypot(other.measured), self.claimed.hypot(other.claimed));
        // Where one of them is dark, there is nothing of it.
        let by_group = match (self.by_group, other.by_group) {
            (of_one, none) if none.is_empty() => of_one,
            (none, of_other) if none.is_empty() => of_other,
            (of_one, of_other) => of_one.into_iter().zip(&of_other).map(|(one, other)| one.with(other)).collect(),
        };
        Self { measured, claimed, noise_sq, by_group }
    }
}
