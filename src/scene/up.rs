//! Which axis points up.

use std::str::FromStr;

use glam::DVec3;
use serde::{Deserialize, Serialize};

/// The axis that points up. Coordinates are what they are: this tells how a scene is looked at, where it is level, and where its sky is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Up {
    /// x.
    X,
    /// y.
    Y,
    /// z.
    Z,
}

impl Up {
    const ALL: [Self; 3] = [Self::X, Self::Y, Self::Z];

    /// 0, 1 or 2.
    pub fn index(self) -> usize {
        self as usize
    }

    pub(crate) fn vector(self) -> DVec3 {
        DVec3::AXES[self.index()]
    }
}

impl FromStr for Up {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let index = ["x", "y", "z"].iter().position(|&axis| axis == text).ok_or("must be x, y or z")?;
        Ok(Self::ALL[index])
    }
}
