//! The command line as it is typed.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};

use super::option_help;

const EXIT_CODES: &str = "\
Exit codes:
    0  done
    1  the machine failed (disk full, no threads)
    2  the command line asks for something impossible; nothing was done
    3  an input file is bad
    4  a limit ended the solve before the requested error was reached; results are written
    5  out of memory: the budget of --memory ended the solve, and results are written; or the budget is too small to
       begin, or the machine has no more, and nothing is written
  130  interrupted; what there is, is written

Messages go to stderr, only asked-for data to stdout.";

/// Hierarchical radiosity: lights polygonal scenes, and tells how wrong the answer can be.
#[derive(Debug, Parser)]
#[command(name = "patchlight", version, after_help = EXIT_CODES, subcommand_required = true, arg_required_else_help = true)]
pub struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// What to do.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Light a scene, and write what is asked for
    #[command(after_help = EXIT_CODES, after_long_help = format!("{}\n{EXIT_CODES}", option_help::of_set()))]
    Solve(Box<SolveArguments>),
    /// Evaluate a solution at points, or by sensors in space
    #[command(after_help = EXIT_CODES)]
    Sample(SampleArguments),
    /// Take a picture of a solution
    #[command(after_help = EXIT_CODES)]
    Render(RenderArguments),
    /// Write the elements of a solution with their radiosities, or the power that surfaces emit and absorb
    #[command(after_help = EXIT_CODES)]
    Export(ExportArguments),
    /// Write a solution as a page for browsers: the lit scene in 3D, and what is known of it
    #[command(after_help = EXIT_CODES)]
    Report(ReportArguments),
    /// Tell what is in a scene or a solution, what was repaired and what is suspicious
    #[command(after_help = EXIT_CODES)]
    Info(InfoArguments),
}

/// `patchlight solve`.
#[derive(Debug, Args)]
pub struct SolveArguments {
    /// The scene, an OBJ file
    pub scene: PathBuf,
    /// Write the solution: scene, hierarchy, links, radiosities and options in one file
    #[arg(short, long, value_name = "SOLUTION")]
    pub output: Option<PathBuf>,
    #[command(flatten)]
    pub settings: SettingArguments,
    #[command(flatten)]
    pub trust: TrustArguments,
    /// Take a picture: .png to look at, .exr with linear radiances; may be repeated, to have it in both
    #[arg(long, value_name = "FILE")]
    pub image: Vec<PathBuf>,
    #[command(flatten)]
    pub picture: PictureArguments,
    /// Write the lit mesh: elements with radiosities at their nodes; --lit-mesh is asked for by that
    #[arg(long, value_name = "FILE.ply")]
    pub mesh: Option<PathBuf>,
    /// Evaluate at the points of this CSV file (x,y,z,nx,ny,nz), '-' for stdin
    #[arg(long, value_name = "P.csv", requires = "values")]
    pub points: Option<PathBuf>,
    /// Write the values at the points, '-' for stdout
    #[arg(long, value_name = "V.csv", requires = "points")]
    pub values: Option<PathBuf>,
    /// Write a page for browsers: the lit scene in 3D, and what the run tells about itself; it loads nothing from anywhere
    #[arg(long, value_name = "FILE.html")]
    pub html: Option<PathBuf>,
    /// Write what the run tells about itself as JSON, '-' for stdout
    #[arg(long, value_name = "R.json")]
    pub report: Option<PathBuf>,
    #[command(flatten)]
    pub run: RunArguments,
}

/// Options of a solve: flags for those that are used most, `--set` for all.
#[derive(Debug, Args)]
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
    #[arg(long, value_name = "N", help = option_help::of_flag("seed"))]
    pub seed: Option<String>,
    #[arg(long, value_name = "N", help = option_help::of_flag("max_links"))]
    pub max_links: Option<String>,
    /// Which sides of a face emit and receive: front or both [default: front]
    #[arg(long, value_name = "SIDES")]
    pub sides: Option<String>,
    /// Stop when the program would take more than this many GB (1e9 bytes), by its own count: the same on every machine
    /// [default: no budget; a run that takes nearly all memory ends with an error]
    #[arg(long, value_name = "GB")]
    pub memory: Option<String>,
    /// Stop after this many seconds, those of reading included; results are written after that
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
            ("seed", self.seed.as_deref()),
            ("max_links", self.max_links.as_deref()),
            ("sides", self.sides.as_deref()),
            ("memory", self.memory.as_deref()),
            ("time", self.time.as_deref()),
        ];
        flags.into_iter().filter_map(|(key, value)| Some((key, value?)))
    }
}

/// `patchlight sample`.
#[derive(Debug, Args)]
pub struct SampleArguments {
    /// A solution that 'patchlight solve -o' wrote
    pub solution: PathBuf,
    /// Points on surfaces: a CSV file with the columns x,y,z,nx,ny,nz, '-' for stdin; their radiosities are written
    pub points: Option<PathBuf>,
    /// Sensors anywhere in space: a CSV file with the columns x,y,z,nx,ny,nz, '-' for stdin; their irradiance is written, in W/m^2 and in lx, with
    /// its standard errors
    #[arg(long, value_name = "S.csv", conflicts_with_all = ["points", "plane", "from"])]
    pub sensors: Option<PathBuf>,
    /// A grid of sensors, whose mean, extremes and uniformity are told: 'height=0.75', horizontal over the floor, with spacing=0.5 and up=z if wanted
    /// (metres; if not given, the spacing of EN 12464-1, and y up); or 'origin=x,y,z u=x,y,z v=x,y,z counts=NxM', looking along u x v
    #[arg(long, value_name = "PLANE", conflicts_with_all = ["points", "from"], allow_hyphen_values = true)]
    pub plane: Option<String>,
    /// Take a picture of the plane: .png, its illuminance in false colours with a legend
    #[arg(long, value_name = "FILE.png", conflicts_with = "points")]
    pub image: Option<PathBuf>,
    /// The false colours go from LOW to HIGH lx, as in 0..500 [default: to the largest value]
    #[arg(long, value_name = "LOW..HIGH", requires = "image", allow_hyphen_values = true)]
    pub scale: Option<String>,
    /// Sensors: stop after this many seconds; what was measured by then is written
    #[arg(long, value_name = "S", conflicts_with = "points")]
    pub time: Option<String>,
    /// Write the values, '-' for stdout
    #[arg(short, long, value_name = "V.csv", default_value = "-")]
    pub output: PathBuf,
    /// Where values come from: gathered by rays at each point, with standard errors; or read off the lit mesh, in a moment, but as far off as the
    /// mesh
    #[arg(long, value_name = "WHENCE", value_enum, default_value_t = Whence::Gather)]
    pub from: Whence,
    #[command(flatten)]
    pub run: RunArguments,
}

/// `patchlight render`.
#[derive(Debug, Args)]
pub struct RenderArguments {
    /// A solution that 'patchlight solve -o' wrote
    pub solution: PathBuf,
    /// The picture: .png to look at, .exr with linear radiances; may be repeated, to have it in both
    #[arg(short, long, value_name = "FILE", required = true)]
    pub output: Vec<PathBuf>,
    #[command(flatten)]
    pub picture: PictureArguments,
    #[command(flatten)]
    pub run: RunArguments,
}

/// `patchlight export`.
#[derive(Debug, Args)]
pub struct ExportArguments {
    /// A solution that 'patchlight solve -o' wrote
    pub solution: PathBuf,
    /// The file: .ply, with the lit mesh where the solution has one, else with the elements of the solver
    #[arg(short, long, value_name = "FILE", required_unless_present = "flux")]
    pub output: Option<PathBuf>,
    /// Write the power in W that is emitted, arrives and is absorbed, and the net of it, by face, object, group and material and of the whole scene:
    /// from the lit mesh where the solution has one, else from the elements of the solver, which are coarse over cells; '-' for stdout
    #[arg(long, value_name = "FLUX.csv")]
    pub flux: Option<PathBuf>,
    /// Write the elements of the solver, whether there is a lit mesh or not
    #[arg(long, conflicts_with = "quadratic", requires = "output")]
    pub elements: bool,
    /// Write each element of the lit mesh as one face of six vertices, around it: every second one is a corner, the others are middles of edges. If
    /// not given, it is written as four triangles
    #[arg(long, requires = "output")]
    pub quadratic: bool,
}

/// `patchlight report`.
#[derive(Debug, Args)]
pub struct ReportArguments {
    /// A solution that 'patchlight solve -o' wrote; with --lit-mesh it is shown without steps
    pub solution: PathBuf,
    /// The page: one .html file that loads nothing from anywhere
    #[arg(short, long, value_name = "FILE.html")]
    pub output: PathBuf,
    #[command(flatten)]
    pub run: RunArguments,
}

/// `patchlight info`.
#[derive(Debug, Args)]
pub struct InfoArguments {
    /// A scene (OBJ) or a solution
    pub file: PathBuf,
    /// Which sides of a scene's faces emit and receive: front or both
    #[arg(long, value_name = "SIDES", default_value = "front")]
    pub sides: String,
    #[command(flatten)]
    pub trust: TrustArguments,
}

/// What a scene may reach.
#[derive(Debug, Args)]
pub struct TrustArguments {
    /// Read material libraries wherever the scene says they lie, not only beside it and below
    #[arg(long)]
    pub allow_any_path: bool,
}

/// How pictures are taken.
#[derive(Debug, Args)]
pub struct PictureArguments {
    /// 'eye=x,y,z target=x,y,z up=x,y,z fov=degrees'; what is left out is chosen to show the scene
    #[arg(long, value_name = "CAMERA")]
    pub camera: Option<String>,
    /// Width and height in pixels [default: 960x720]
    #[arg(long, value_name = "WxH")]
    pub size: Option<String>,
    /// PNG: auto, or the exposure value EV; radiances are multiplied by 2^EV [default: auto]
    #[arg(long, value_name = "EV", allow_hyphen_values = true)]
    pub exposure: Option<String>,
    /// EXR, or PNG with --scale: radiance (W/m^2/sr), radiosity (W/m^2), irradiance (W/m^2), illuminance (lx, 179 lm to a watt of its Rec. 709
    /// luminance) or, for EXR with --bounds guaranteed, width (W/m^2, upper less lower radiosity) [default: radiance]
    #[arg(long, value_name = "QUANTITY")]
    pub quantity: Option<String>,
    /// What is shown: the lit mesh, without grain; or values that are gathered by rays for the picture, with their standard errors in .exr
    /// [default: mesh where there is one]
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
#[derive(Debug, Args)]
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
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ProgressKind {
    /// A bar on a terminal, else only the key figures at the end
    Auto,
    /// A line now and then
    Plain,
    /// A JSON object on each line
    Json,
    /// Nothing but warnings and errors
    None,
}
