//! Options that are one of a few names.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use super::error::OptionsError;
use super::kinds::{Choice, OneName, read};
use crate::error::ErrorNorm;

/// Declares an enum from `Variant = "name"`, one line for each: it is read, shown and stored as JSON by these names. `for "key"` names the
/// option in messages.
macro_rules! choice {
    (
        $(#[$about:meta])*
        $Choice:ident for $key:literal {
            $( $(#[$variant_about:meta])* $Variant:ident = $name:literal, )+
        }
    ) => {
        $(#[$about])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
        pub enum $Choice {
            $( $(#[$variant_about])* #[serde(rename = $name)] $Variant, )+
        }

        impl $Choice {
            /// All names, as typed on the command line.
            pub const NAMES: &'static [&'static str] = &[$($name),+];
        }

        impl Choice for $Choice {
            const NAMES: &'static [&'static str] = Self::NAMES;

            fn name(self) -> &'static str {
                match self { $( Self::$Variant => $name, )+ }
            }

            fn of_name(name: &str) -> Option<Self> {
                match name { $( $name => Some(Self::$Variant), )+ _ => None }
            }
        }

        impl fmt::Display for $Choice {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(self.name())
            }
        }

        impl FromStr for $Choice {
            type Err = OptionsError;

            fn from_str(name: &str) -> Result<Self, OptionsError> {
                read($key, OneName, name)
            }
        }
    };
}

choice! {
    /// How pairs of nodes are refined.
    Strategy for "strategy" {
        /// Brightness-weighted refinement in which the receiver's area counts: what the measurements say is best.
        #[default]
        Default = "default",
        /// BF refinement with multigridding as in Hanrahan, Salzman, Aupperle 1991.
        Hanrahan91 = "hanrahan91",
        /// Every surface split to the same depth, every pair of elements linked.
        Uniform = "uniform",
        /// All pairs of surfaces linked at first, BF refinement, a bounce of light an iteration: the original algorithm of Holzschuch,
        /// Sillion, Drettakis 1994. This and the next three take 16 rays a link.
        Original94 = "original94",
        /// The same with link culling: pairs of reflecting surfaces with little form factor are forgotten (Lischinski 1994, section
        /// 4.1.1).
        Culling94 = "culling94",
        /// Lazy linking: pairs of surfaces are linked once they carry enough (Holzschuch, Sillion, Drettakis 1994, section 3).
        Lazy94 = "lazy94",
        /// Lazy linking and link reduction (section 4).
        Lazy94Reduction = "lazy94+reduction",
        /// Links by the error of their form factors alone, found bottom-up from samples on the smallest elements (Chang, Shih 1998).
        BottomUp98 = "bottom-up98",
        /// The same top-down, from samples on each node that is visited: what that paper compares with.
        TopDown98 = "top-down98",
        /// Links are split that add most to the error, by their form-factor bounds and by importance (Lischinski 1994, section 5.3).
        ErrorDriven = "error-driven",
        /// BF refinement with visibility through dense clusters at many resolutions: transmittance maps before rays (Soler, Sillion 1996).
        Multiresolution96 = "multiresolution96",
    }
}

impl Strategy {
    /// Whether links start from pairs of surfaces, and are what the options make them, whatever error they lead to.
    pub fn links_surfaces(self) -> bool {
        self.forgets_pairs() || self.links_once()
    }

    /// Whether all links are made at once, without regard to light.
    pub fn links_once(self) -> bool {
        matches!(self, Self::BottomUp98 | Self::TopDown98)
    }

    /// Whether pairs of which no ray arrived are dropped.
    pub fn forgets_pairs(self) -> bool {
        matches!(self, Self::Original94 | Self::Culling94 | Self::Lazy94 | Self::Lazy94Reduction)
    }
}

choice! {
    /// Which solver finds the values at points.
    Solver for "solver" {
        /// The one that promises the requested error for less: cells where many surfaces reflect, or few reflect nearly all.
        #[default]
        Auto = "auto",
        /// Over links: values are gathered over the links above the point. For few sources.
        Links = "links",
        /// Over cells: radiosities of small cells from random light paths, and a final gather at the point. For many sources.
        Cells = "cells",
    }
}

choice! {
    /// In which norm the error is asked for; either is told.
    Norm for "norm" {
        /// Relative to the light at each place, or to typical light where it is darker: the root mean square, over the lit area, of
        /// `|B - B_true| / max(|B_true - E|, m)`, m the median of `|B_true - E|` over the lit area.
        #[default]
        Local = "local",
        /// Relative to all light: `||B - B_true|| / ||B_true - E||`, so that bright places count most.
        Energy = "energy",
    }
}

impl From<Norm> for ErrorNorm {
    fn from(norm: Norm) -> Self {
        match norm {
            Norm::Energy => Self::Energy,
            Norm::Local => Self::Local,
        }
    }
}

choice! {
    /// How radiosities are iterated over the links.
    Sweep for "sweep" {
        /// Every node gathers from the sweep before: parallel.
        #[default]
        Jacobi = "jacobi",
        /// Every node gathers from what was just reflected (Gauss-Seidel): fewer sweeps, one thread.
        InPlace = "in-place",
    }
}

choice! {
    /// What is to be known about how wrong the answer can be.
    Bounds for "bounds" {
        /// An estimate with its confidence.
        #[default]
        Estimate = "estimate",
        /// Lower and upper radiosities as well that hold at every point. Surfaces are linked then, and values are gathered over links.
        Guaranteed = "guaranteed",
    }
}

choice! {
    /// How elements are split, where refinement wants them to be.
    Subdivision for "subdivision" {
        /// Into similar pieces, four for triangles and quads.
        #[default]
        Regular = "regular",
        /// In two, along lines where irradiance by emitters jumps or is not smooth, while there are any; then into halves (Lischinski 1994, section 4.2).
        Discontinuities = "discontinuities",
    }
}
