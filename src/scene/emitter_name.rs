//! Emitters and lights by name, as they are put into light groups.

use std::fmt;
use std::str::FromStr;

/// Emitters or lights of one name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum EmitterName {
    /// Those of a material.
    Material(String),
    /// Those of an object.
    Object(String),
    /// Lights that are no surfaces.
    Light(String),
}

impl EmitterName {
    /// How it is written.
    pub const FORM: &'static str = "'material NAME', 'object NAME' or 'light NAME'";
}

impl FromStr for EmitterName {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text.split_once(' ').map(|(kind, name)| (kind, name.trim())) {
            Some(("material", name)) if !name.is_empty() => Ok(Self::Material(name.to_owned())),
            Some(("object", name)) if !name.is_empty() => Ok(Self::Object(name.to_owned())),
            Some(("light", name)) if !name.is_empty() => Ok(Self::Light(name.to_owned())),
            _ => Err(format!("'{text}' names no lights, write {}", Self::FORM)),
        }
    }
}

impl fmt::Display for EmitterName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Material(name) => write!(f, "material {name}"),
            Self::Object(name) => write!(f, "object {name}"),
            Self::Light(name) => write!(f, "light {name}"),
        }
    }
}
