//! Groups of arguments that several commands take.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use patchlight::scene::import::{ImportOptions, Textures};
use patchlight::scene::{Sides, Up};

use super::option_help;

/// Options of a solve: flags for those that are used most, `--set` for all.
#[derive(Debug, Default, Args)]
pub struct SettingArguments {
    #[arg(long, value_name = "E", help = option_help::of_flag("error"))]
    pub error: Option<String>,
    #[arg(long, value_name = "NORM", help = option_help::of_flag("norm"))]
    pub norm: Option<String>,
    #[arg(long, value_name = "NAME", help = option_help::of_flag("strategy"))]
    pub strategy: Option<String>,
    #[arg(long, value_name = "WHAT", help = option_help::of_flag("importance"))]
    pub importance: Option<String>,
    #[arg(long, value_name = "KIND", help = option_help::of_flag("bounds"))]
    pub bounds: Option<String>,
    #[arg(long, help = option_help::of_flag("lit_mesh"))]
    pub lit_mesh: bool,
    #[arg(long, help = option_help::of_flag("keep_transport"))]
    pub keep_transport: bool,
    #[arg(long, value_name = "N", help = option_help::of_flag("seed"))]
    pub seed: Option<String>,
    #[arg(long, value_name = "N", help = option_help::of_flag("max_links"))]
    pub max_links: Option<String>,
    /// Which sides of a face emit and receive: front or both [default: front]
    #[arg(long, value_name = "SIDES")]
    pub sides: Option<String>,
    /// Stop when the program would take more than this many GB (1e9 bytes), by its own count: the same on every machine; bake begins with no lightmap
    /// that would not fit
    /// [default: no budget; a run that takes nearly all memory ends with an error]
    #[arg(long, value_name = "GB")]
    pub memory: Option<String>,
    /// Stop after this many seconds, those of reading included; results are written after that. What bake has not gathered by then is filled from what it
    /// has
    #[arg(long, value_name = "S")]
    pub time: Option<String>,
    /// Set any option by its key, as in --set error=0.01; may be repeated; --help lists the keys
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
}

impl SettingArguments {
    /// The flags that were typed, by their keys.
    pub fn flags(&self) -> impl Iterator<Item = (&'static str, &str)> {
        let flags = [
            ("error", self.error.as_deref()),
            ("norm", self.norm.as_deref()),
            ("strategy", self.strategy.as_deref()),
            ("importance", self.importance.as_deref()),
            ("bounds", self.bounds.as_deref()),
            ("lit_mesh", self.lit_mesh.then_some("true")),
            ("keep_transport", self.keep_transport.then_some("true")),
            ("seed", self.seed.as_deref()),
            ("max_links", self.max_links.as_deref()),
            ("sides", self.sides.as_deref()),
            ("memory", self.memory.as_deref()),
            ("time", self.time.as_deref()),
        ];
        flags.into_iter().filter_map(|(key, value)| Some((key, value?)))
    }
}

/// What a scene may reach, and how it is read.
#[derive(Clone, Copy, Debug, Args)]
pub struct TrustArguments {
    /// Read material libraries, buffers, images and photometric files wherever the scene or its lights say they lie, not only beside it and below
    #[arg(long)]
    pub allow_any_path: bool,
    /// What becomes of textures: each face has their mean over it (face), or a scene with textures is not read (reject)
    #[arg(long, value_name = "HOW", value_enum, default_value_t = Texture::Face)]
    pub texture: Texture,
    /// What a unit of the coordinates of an OBJ, PLY or STL file is: m, cm, mm, inch, ft, or a number of metres; the scene is turned into metres as it is
    /// read, and all other lengths, in results too, are metres [default: m]
    #[arg(long, value_name = "UNIT", value_parser = metres)]
    pub unit: Option<f64>,
    /// The axis that points up in such a file, x, y or z: where views look from, planes are level and the sky is; coordinates stay as they are [default: y,
    /// and for views y or z by floors and lamps]
    #[arg(long, value_name = "AXIS", value_parser = str::parse::<Up>)]
    pub up: Option<Up>,
}

/// The metres of a unit.
fn metres(text: &str) -> Result<f64, String> {
    const NAMED: [(&str, f64); 5] = [("m", 1.0), ("cm", 0.01), ("mm", 0.001), ("inch", 0.0254), ("ft", 0.3048)];
    let named = NAMED.iter().find(|(name, _)| *name == text).map(|(_, metres)| *metres);
    let metres = named.or_else(|| text.parse().ok().filter(|metres| ImportOptions::UNITS.contains(metres)));
    metres.ok_or_else(|| "it must be m, cm, mm, inch, ft, or a number of metres from 1e-9 to 1e9".to_owned())
}

impl TrustArguments {
    /// What is for scenes alone, if it was typed: of a solution coordinates are what they are.
    pub fn of_scenes(&self) -> Option<&'static str> {
        match self {
            Self { unit: Some(_), .. } => Some("--unit"),
            Self { up: Some(_), .. } => Some("--up"),
            _ => None,
        }
    }

    /// How a scene is read, with these lights beside it.
    pub fn import(&self, sides: Sides, lights: Option<PathBuf>) -> ImportOptions {
        let textures = match self.texture {
            Texture::Face => Textures::Face,
            Texture::Reject => Textures::Reject,
        };
        let Self { allow_any_path, unit, up, .. } = *self;
        ImportOptions { sides, allow_any_path, textures, lights, unit, up, ..ImportOptions::default() }
    }
}

/// What a page shows beside the light.
#[derive(Debug, Default, Args)]
pub struct PageArguments {
    /// Measure on a plane, and show it in the page: false colours, mean, minimum, uniformity, and the daylight factor where skies send all light; as
    /// 'height=0.75', or in full, as of 'patchlight sample'; may be repeated. It takes its time after the solve, whatever --time says
    #[arg(long, value_name = "PLANE", allow_hyphen_values = true)]
    pub plane: Vec<String>,
    /// Show lines in the page where light has a step, a kink, or a jump of its curvature: where surfaces touch, and borders of shadows and penumbras. They take
    /// their time after the solve, whatever --time says
    #[arg(long)]
    pub curves: bool,
}

/// Whose coordinates a lightmap has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum WhoseUv {
    /// Those of the file; an error if they cannot be used.
    File,
    /// Charts of coplanar faces.
    Own,
}

/// What becomes of textures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Texture {
    /// Their mean over each face.
    Face,
    /// An error.
    Reject,
}

/// Where pictures are taken from.
#[derive(Debug, Default, Args)]
pub struct ViewArguments {
    /// 'eye=x,y,z target=x,y,z up=x,y,z fov=degrees'; what is left out is chosen to show the scene
    #[arg(long, value_name = "CAMERA")]
    pub camera: Option<String>,
    /// Width and height in pixels [default: 960x720]
    #[arg(long, value_name = "WxH")]
    pub size: Option<String>,
}

/// How pictures are taken.
#[derive(Debug, Default, Args)]
pub struct PictureArguments {
    #[command(flatten)]
    pub view: ViewArguments,
    /// PNG: auto, or the exposure value EV; radiances are multiplied by 2^EV [default: auto]
    #[arg(long, value_name = "EV", allow_hyphen_values = true)]
    pub exposure: Option<String>,
    /// EXR and HDR, or PNG with --scale: radiance (W/m^2/sr), radiosity (W/m^2), irradiance (W/m^2), illuminance (lx, 179 lm to a watt of its Rec. 709
    /// luminance) or, for EXR with --bounds guaranteed, width (W/m^2, upper less lower radiosity) [default: radiance]
    #[arg(long, value_name = "QUANTITY")]
    pub quantity: Option<String>,
    /// What is shown, in .exr with its standard errors: the lit mesh of the solution, without grain; or values that are gathered by rays for the
    /// picture [default: mesh where there is one, else a mesh that is made of what the picture sees; small pictures are gathered]
    #[arg(long, value_name = "WHENCE", value_enum)]
    pub from: Option<Whence>,
    /// PNG: false colours from LOW to HIGH in the unit of the quantity, as in 0..500, with a legend
    #[arg(long, value_name = "LOW..HIGH", allow_hyphen_values = true)]
    pub scale: Option<String>,
    /// PNG: lines over the picture: mesh (the edges of the elements of the lit mesh) or curves (where light has a step, red, or a kink, green; or where its
    /// curvature jumps, blue)
    #[arg(long, value_name = "LINES")]
    pub show: Option<String>,
}

/// Where values come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Whence {
    /// The lit mesh.
    Mesh,
    /// Rays, for each value anew.
    Gather,
}

/// How the run goes.
#[derive(Debug, Default, Args)]
pub struct RunArguments {
    /// Who answers visibility: auto, embree, obvhs, brute-force or embree4-sys [default: auto]
    #[arg(long, value_name = "NAME")]
    pub backend: Option<String>,
    /// Worker threads; 0 takes one per core; never changes the answer [default: 0]
    #[arg(long, value_name = "N")]
    pub threads: Option<usize>,
    /// What is said on stderr while the work goes on; auto: a bar on a terminal, else only the key figures at the end
    #[arg(long, value_name = "HOW", value_enum, default_value_t = ProgressKind::Auto)]
    pub progress: ProgressKind,
}

/// What is said while the work goes on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum ProgressKind {
    /// A bar on a terminal, else only the key figures at the end
    #[default]
    Auto,
    /// A line now and then
    Plain,
    /// A JSON object on each line
    Json,
    /// Nothing but warnings and errors
    None,
}
