//! What a lightmap shall be.

use std::str::FromStr;

use thiserror::Error;

use crate::scene::Scene;

/// A lightmap has at most so many texels: 16 GiB of floats for three channels, with what it takes to find them, are what large machines have.
pub(super) const MOST_TEXELS: f64 = (1_u64 << 28) as f64;

/// The range of [`BakeOptions::size`]: what graphics cards take as a texture.
const SIZES: std::ops::RangeInclusive<u32> = 16..=32768;

/// The largest [`BakeOptions::padding`]: beyond that even the coarsest mip levels in use do not mix charts.
const MOST_PADDING: u32 = 256;

/// How a lightmap is laid out.
#[derive(Clone, Debug, PartialEq)]
pub struct BakeOptions {
    /// The side of a texel in metres.
    pub texel: f64,
    /// Texels around each chart that are filled with its own light: 0 to 256. Two charts are twice as far apart.
    pub padding: u32,
    /// The largest side of a page in texels: 16 to 32768.
    pub size: u32,
    /// What is baked; all if not given.
    pub only: Option<Only>,
    /// Whether direct and indirect light are kept apart as well.
    pub separate: bool,
    /// Whether the lightmap comes with what a later bake of the scene, changed here and there, can take from it.
    pub keep: bool,
}

/// A part of a scene by name, typed as `material X` or `object X`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Only {
    /// The faces of a material.
    Material(String),
    /// The faces of an object.
    Object(String),
}

/// Why a file's own coordinates make no lightmap. Faces count from 1, coordinates are those of the file from the top left.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum UvProblem {
    /// There are none.
    #[error("the file has none for what is baked")]
    None,
    /// A face has none.
    #[error("face {face} has none")]
    Without {
        /// The first one.
        face: u32,
    },
    /// A face cannot be taken apart into triangles as it is written.
    #[error("face {face} is concave: triangulate it")]
    Concave {
        /// The first one.
        face: u32,
    },
    /// A face leaves the page.
    #[error("face {face} has a corner at {:.4}, {:.4}, outside of 0 to 1", uv[0], uv[1])]
    Outside {
        /// The first one.
        face: u32,
        /// Where.
        uv: [f64; 2],
    },
    /// A face has no area on the page.
    #[error("face {face} has no area on the page")]
    NoArea {
        /// The first one.
        face: u32,
    },
    /// Two faces, or two places of one, lie on the same texel.
    #[error("faces {} and {} overlap at {:.4}, {:.4}", faces[0], faces[1], uv[0], uv[1])]
    Overlap {
        /// Two that do, of perhaps more.
        faces: [u32; 2],
        /// Where.
        uv: [f64; 2],
    },
}

/// Why nothing can be taken from an earlier bake.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum EarlierProblem {
    /// Texels are of another size.
    #[error("its texels are of {earlier} m, these of {now} m")]
    Texel {
        /// In metres.
        earlier: f64,
        /// In metres.
        now: f64,
    },
    /// Light has other channels.
    #[error("it has {earlier} channels, the scene {now}")]
    Channels {
        /// How many it has.
        earlier: u32,
        /// How many there are.
        now: u32,
    },
    /// One of them keeps direct and indirect light apart.
    #[error("direct and indirect light are kept apart in one of them alone")]
    Parts,
    /// Errors are in another norm.
    #[error("its error was asked for in the other norm")]
    Norm,
    /// It was less exact.
    #[error("it was made for an error of {earlier}, and {now} is asked for")]
    Error {
        /// Relative.
        earlier: f64,
        /// Relative.
        now: f64,
    },
    /// It is of something else.
    #[error("none of its charts lies in the scene where it lay")]
    Nothing,
}

/// Why there can be no lightmap.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum BakeError {
    /// The side of a texel is no length.
    #[error("texel is {0}, it must be a number of metres above 0, as in 0.05")]
    BadTexel(f64),
    /// The padding is too large.
    #[error("padding is {0}, it must be from 0 to {MOST_PADDING} texels")]
    BadPadding(u32),
    /// The size of pages is out of range.
    #[error("size is {0}, it must be from {least} to {most} texels", least = SIZES.start(), most = SIZES.end())]
    BadSize(u32),
    /// The text names no part of a scene.
    #[error("only: '{0}' names nothing, write 'material NAME' or 'object NAME'")]
    BadOnly(String),
    /// The scene has no such part.
    #[error("only: no face has the {kind} '{name}'; 'patchlight info' lists what there is")]
    Nothing {
        /// `material` or `object`.
        kind: &'static str,
        /// Its name.
        name: String,
    },
    /// There would be too many texels.
    #[error(
        "texels of {texel} m make {count:.1e} texels, more than {MOST_TEXELS:.1e}: choose larger ones, or bake a part of the scene"
    )]
    TooMany {
        /// The side of a texel in metres.
        texel: f64,
        /// How many there would be.
        count: f64,
    },
    /// A chart does not fit into a page.
    #[error(
        "the chart of face {face} has {width:.0} x {height:.0} texels with its padding, more than a page of {size} x {size}: choose larger \
         texels or larger pages"
    )]
    ChartTooLarge {
        /// Its largest face, counted from 1.
        face: u32,
        /// In texels.
        width: f64,
        /// In texels.
        height: f64,
        /// The largest side of a page.
        size: u32,
    },
    /// The file's own coordinates cannot be used.
    #[error("the lightmap coordinates of the file cannot be used: {0}")]
    Uv(UvProblem),
    /// The page that a file lays out would be too large.
    #[error(
        "texels of {texel} m make a page of {side} x {side} of what the file lays out, more than {size} x {size}: choose larger texels or larger pages"
    )]
    PageTooLarge {
        /// In metres.
        texel: f64,
        /// In texels.
        side: f64,
        /// The largest side of a page.
        size: u32,
    },
    /// The lightmap is of another scene.
    #[error("this atlas was made of another scene")]
    OtherScene,
    /// An earlier bake does not fit.
    #[error("nothing can be taken from the earlier bake: {0}; bake without it")]
    Earlier(EarlierProblem),
    /// Direct and indirect light are asked for apart, of a mesh.
    #[error("a lit mesh holds all light as one: direct and indirect light are apart only where texels are gathered")]
    MeshIsWhole,
}

impl Default for BakeOptions {
    fn default() -> Self {
        Self { texel: 0.05, padding: 2, size: 4096, only: None, separate: false, keep: false }
    }
}

impl BakeOptions {
    /// Checks the ranges.
    ///
    /// # Errors
    /// See [`BakeError`].
    pub fn validate(&self) -> Result<(), BakeError> {
        // What is not a number is not above 0 either.
        if !(self.texel > 0.0 && self.texel.is_finite()) {
            return Err(BakeError::BadTexel(self.texel));
        }
        if self.padding > MOST_PADDING {
            return Err(BakeError::BadPadding(self.padding));
        }
        if !SIZES.contains(&self.size) {
            return Err(BakeError::BadSize(self.size));
        }
        Ok(())
    }

    /// Which surfaces are baked.
    pub(super) fn chosen(&self, scene: &Scene) -> Result<Vec<bool>, BakeError> {
        let Some(only) = &self.only else { return Ok(vec![true; scene.surfaces().len()]) };
        let (kind, name) = match only {
            Only::Material(name) => ("material", name),
            Only::Object(name) => ("object", name),
        };
        let is_chosen = |surface: &crate::scene::Surface| match only {
            Only::Material(name) => scene.materials()[surface.material as usize].name == *name,
            Only::Object(name) => scene.objects().name_of(surface.face) == Some(name),
        };
        let chosen: Vec<bool> = scene.surfaces().iter().map(is_chosen).collect();
        if chosen.contains(&true) { Ok(chosen) } else { Err(BakeError::Nothing { kind, name: name.clone() }) }
    }
}

impl FromStr for Only {
    type Err = BakeError;

    fn from_str(text: &str) -> Result<Self, BakeError> {
        let named = |(kind, name): (&str, &str)| match (kind, name.trim()) {
            (_, "") => None,
            ("material", name) => Some(Self::Material(name.to_owned())),
            ("object", name) => Some(Self::Object(name.to_owned())),
            _ => None,
        };
        text.trim().split_once(' ').and_then(named).ok_or_else(|| BakeError::BadOnly(text.to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_out_of_range_is_refused() {
        let refused = |options: BakeOptions| options.validate().unwrap_err().to_string();
        for texel in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(refused(BakeOptions { texel, ..BakeOptions::default() }).starts_with("texel is"));
        }
        assert!(refused(BakeOptions { padding: 257, ..BakeOptions::default() }).starts_with("padding is 257"));
        for size in [0, 15, 32769] {
            assert!(refused(BakeOptions { size, ..BakeOptions::default() }).starts_with("size is"));
        }
        assert_eq!(BakeOptions::default().validate(), Ok(()));
    }

    #[test]
    fn parts_of_a_scene_are_typed_by_kind_and_name() {
        assert_eq!("material dark wood".parse(), Ok(Only::Material("dark wood".to_owned())));
        assert_eq!(" object desk ".parse(), Ok(Only::Object("desk".to_owned())));
        for bad in ["", "material", "material ", "group x", "desk"] {
            assert_eq!(bad.parse::<Only>(), Err(BakeError::BadOnly(bad.to_owned())));
        }
    }
}
