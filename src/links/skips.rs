//! What refinement leaves out because it would be in vain, and what that saves.

use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// What a solve leaves out. Each can be turned off, to see what it is worth: the answer stays what it is, up to its error.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Skips {
    /// Pairs of which one is proved to be behind the other, or in its plane.
    pub behind: bool,
    /// Pairs whose receiver reflects nothing.
    pub black: bool,
    /// Pairs whose source is still dark sleep until light comes there.
    pub dark: bool,
    /// A cluster with itself sleeps once it carries little; otherwise it is split down to pairs of surfaces.
    pub within: bool,
    /// Segments where nothing can occlude anything, because every surface has all others in front of it.
    pub rays: bool,
    /// Segments between planes with nothing in between, in small scenes where something else occludes.
    pub clear: bool,
    /// Clusters where surfaces are few.
    pub clusters: bool,
    /// Channels that repeat others, or in which no light is on, by the default strategy.
    pub channels: bool,
}

impl Default for Skips {
    fn default() -> Self {
        Self::ALL
    }
}

impl Skips {
    /// The names of what may be left out, as typed on the command line.
    pub const NAMES: [&'static str; 8] = ["behind", "black", "dark", "within", "rays", "clear", "clusters", "channels"];

    /// Leave out whatever can be.
    pub const ALL: Self =
        Self { behind: true, black: true, dark: true, within: true, rays: true, clear: true, clusters: true, channels: true };

    /// Leave out nothing.
    pub const NONE: Self = Self {
        behind: false,
        black: false,
        dark: false,
        within: false,
        rays: false,
        clear: false,
        clusters: false,
        channels: false,
    };

    fn of_name(&mut self, name: &str) -> Option<&mut bool> {
        match name {
            "behind" => Some(&mut self.behind),
            "black" => Some(&mut self.black),
            "dark" => Some(&mut self.dark),
            "within" => Some(&mut self.within),
            "rays" => Some(&mut self.rays),
            "clear" => Some(&mut self.clear),
            "clusters" => Some(&mut self.clusters),
            "channels" => Some(&mut self.channels),
            _ => None,
        }
    }

    /// The same without one of [`Skips::NAMES`]; `None` if it is none of them.
    pub fn without(mut self, name: &str) -> Option<Self> {
        *self.of_name(name)? = false;
        Some(self)
    }
}

impl FromStr for Skips {
    type Err = ();

    /// `all`, `none`, or names separated by `+`.
    fn from_str(text: &str) -> Result<Self, ()> {
        match text {
            "all" => Ok(Self::ALL),
            "none" => Ok(Self::NONE),
            _ => text.split('+').try_fold(Self::NONE, |mut skips, name| {
                *skips.of_name(name).ok_or(())? = true;
                Ok(skips)
            }),
        }
    }
}

/// Pairs that were not linked, and the visibility rays that one link for each would have taken. They might have been refined further, so
/// more was saved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Spared {
    pub pairs: u64,
    pub rays: u64,
}

impl Spared {
    pub fn add(&mut self, rays: u32) {
        self.pairs += 1;
        self.rays += u64::from(rays);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_add_up_to_all() {
        assert_eq!("all".parse(), Ok(Skips::ALL));
        assert_eq!("none".parse(), Ok(Skips::NONE));
        assert_eq!(Skips::NAMES.join("+").parse(), Ok(Skips::ALL));
        assert_eq!("behind+rays".parse(), Ok(Skips { behind: true, rays: true, ..Skips::NONE }));
        assert_eq!(("".parse::<Skips>(), "dark+".parse::<Skips>(), "light".parse::<Skips>()), (Err(()), Err(()), Err(())));
        let none = Skips::NAMES.iter().try_fold(Skips::ALL, |skips, name| skips.without(name));
        assert_eq!((none, Skips::ALL.without("light")), (Some(Skips::NONE), None));
    }
}
