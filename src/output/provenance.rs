//! What every file states about itself.

use crate::solve::SolveOptions;

/// A quantity that a file holds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Quantity {
    /// L = B / pi, what a camera sees.
    #[default]
    Radiance,
    /// B, what leaves a surface per area.
    Radiosity,
    /// The upper bound of B less the lower one.
    Width,
}

impl Quantity {
    /// All names, as typed on the command line.
    pub const NAMES: [&'static str; 3] = ["radiance", "radiosity", "width"];

    /// Its name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Radiance => "radiance",
            Self::Radiosity => "radiosity",
            Self::Width => "width",
        }
    }

    /// Its unit.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Radiance => "W/m^2/sr",
            Self::Radiosity | Self::Width => "W/m^2",
        }
    }

    /// What a radiance is multiplied by to get this quantity.
    pub(super) const fn per_radiance(self) -> f32 {
        match self {
            Self::Radiance => 1.0,
            Self::Radiosity | Self::Width => std::f32::consts::PI,
        }
    }
}

/// Where a result comes from: the software with its version, and the options that decided the answer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Provenance {
    software: String,
    options: String,
}

impl Provenance {
    /// Of a result that this version of the software found with `options`.
    pub fn new(options: &SolveOptions) -> Self {
        Self {
            software: concat!("patchlight ", env!("CARGO_PKG_VERSION")).to_owned(),
            // Numbers and names only: nothing in it can fail to become JSON.
            options: serde_json::to_string(options).unwrap_or_default(),
        }
    }

    /// Name and version, as in `patchlight 0.1.0`.
    pub fn software(&self) -> &str {
        &self.software
    }

    /// The options as JSON on one line.
    pub fn options(&self) -> &str {
        &self.options
    }

    /// Key and text of all that a file with this quantity states.
    pub(super) fn statements(&self, quantity: Quantity) -> [(&'static str, String); 4] {
        [
            ("software", self.software.clone()),
            ("quantity", quantity.name().to_owned()),
            ("unit", quantity.unit().to_owned()),
            ("options", self.options.clone()),
        ]
    }
}
