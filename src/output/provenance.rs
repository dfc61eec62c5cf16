//! What every file states about itself.

pub use crate::scene::LUMENS_PER_WATT;
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
    /// H, what arrives at a surface per area.
    Irradiance,
    /// What of the irradiance an eye sees: its luminance by Rec. 709, 0.2126 R + 0.7152 G + 0.0722 B, times [`LUMENS_PER_WATT`].
    Illuminance,
}

impl Quantity {
    /// All names, as typed on the command line.
    pub const NAMES: [&'static str; 5] = ["radiance", "radiosity", "width", "irradiance", "illuminance"];

    /// Its name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Radiance => "radiance",
            Self::Radiosity => "radiosity",
            Self::Width => "width",
            Self::Irradiance => "irradiance",
            Self::Illuminance => "illuminance",
        }
    }

    /// Its unit.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Radiance => "W/m^2/sr",
            Self::Radiosity | Self::Width | Self::Irradiance => "W/m^2",
            Self::Illuminance => "lx",
        }
    }

    /// What the number of a picture is multiplied by to get this quantity: it holds a radiosity, a width or an irradiance over pi, of illuminance its
    /// luminance.
    pub const fn per_radiance(self) -> f32 {
        match self {
            Self::Radiance => 1.0,
            Self::Radiosity | Self::Width | Self::Irradiance => std::f32::consts::PI,
            Self::Illuminance => std::f32::consts::PI * LUMENS_PER_WATT as f32,
        }
    }
}

/// Where a result comes from: the software with its version, and the options that decided the answer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Provenance {
    software: String,
    options: String,
    /// What is claimed of the error, beside what the options ask for.
    error: Option<String>,
}

impl Provenance {
    /// Of a result that this version of the software found with `options`.
    pub fn new(options: &SolveOptions) -> Self {
        Self {
            software: concat!("patchlight ", env!("CARGO_PKG_VERSION")).to_owned(),
            // Numbers and names only: nothing in it can fail to become JSON.
            options: serde_json::to_string(options).unwrap_or_default(),
            error: None,
        }
    }

    /// The same of a result of whose error this is claimed.
    #[must_use]
    pub fn with_error(&self, claim: impl Into<String>) -> Self {
        Self { error: Some(claim.into()), ..self.clone() }
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
    pub(super) fn statements(&self, quantity: Quantity) -> Vec<(&'static str, String)> {
        let mut statements = vec![
            ("software", self.software.clone()),
            ("quantity", quantity.name().to_owned()),
            ("unit", quantity.unit().to_owned()),
            ("options", self.options.clone()),
        ];
        statements.extend(self.error.clone().map(|claim| ("error", claim)));
        statements
    }

    /// The same for people who open a binary file in a text viewer: one on each line.
    pub(super) fn lines(&self, quantity: Quantity) -> String {
        self.statements(quantity).iter().map(|(key, text)| format!("{key}: {text}\n")).collect()
    }
}
