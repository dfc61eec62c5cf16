//! What an answer is wanted for, as it is typed.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use super::error::OptionsError;
use crate::picture::CameraRequest;

/// What an answer is wanted for.
///
/// ```
/// use patchlight::solve::Interest;
///
/// assert_eq!("total".parse(), Ok(Interest::Total));
/// assert_eq!("material floor".parse(), Ok(Interest::Material("floor".to_owned())));
/// assert!("view fov=40".parse::<Interest>().is_ok());
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub enum Interest {
    /// All surfaces, by area.
    #[default]
    Total,
    /// What a camera sees, each surface by its part of the picture; text that [`CameraRequest`] reads, which may leave out what a camera
    /// that shows the scene takes by itself.
    View(String),
    /// Surfaces of the material with this name, by area.
    Material(String),
}

impl Interest {
    /// What is legal.
    pub(super) const RANGE: &'static str = "total, view (with a camera behind it, as in 'view eye=0,1,5'), or material NAME";
}

impl FromStr for Interest {
    type Err = OptionsError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let (kind, rest) = text.trim().split_once(char::is_whitespace).unwrap_or((text.trim(), ""));
        match (kind, rest.trim()) {
            ("total", "") => Ok(Self::Total),
            ("view", camera) if camera.parse::<CameraRequest>().is_ok() => Ok(Self::View(camera.to_owned())),
            ("material", name) if !name.is_empty() => Ok(Self::Material(name.to_owned())),
            _ => Err(OptionsError::OutOfRange { option: "importance", value: text.to_owned(), range: Self::RANGE.to_owned() }),
        }
    }
}

impl fmt::Display for Interest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Total => write!(f, "total"),
            Self::View(camera) if camera.is_empty() => write!(f, "view"),
            Self::View(camera) => write!(f, "view {camera}"),
            Self::Material(name) => write!(f, "material {name}"),
        }
    }
}

impl From<Interest> for String {
    fn from(interest: Interest) -> Self {
        interest.to_string()
    }
}

impl TryFrom<String> for Interest {
    type Error = OptionsError;

    fn try_from(text: String) -> Result<Self, Self::Error> {
        text.parse()
    }
}
