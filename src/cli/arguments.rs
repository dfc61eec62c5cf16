//! The command line as it is typed.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use patchlight::scene::Sides;
use patchlight::scene::import::{ImportOptions, Textures};

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
    6  jobs of a batch failed; the others are done, and the table tells of each
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
    /// Evaluate a solution at points
    #[command(after_help = EXIT_CODES)]
    Sample(SampleArguments),
    /// Take a picture of a solution
    #[command(after_help = EXIT_CODES)]
    Render(RenderArguments),
    /// Write the elements of a solution with their radiosities
    #[command(after_help = EXIT_CODES)]
    Export(ExportArguments),
    /// Do many solves: scenes, options and changes of materials, each with each, as a file of jobs says
    #[command(after_help = EXIT_CODES)]
    Batch(Box<BatchArguments>),
    /// Tell what is in a scene or a solution, what was repaired and what is suspicious
    #[command(after_help = EXIT_CODES)]
    Info(InfoArguments),
}

/// `patchlight solve`.
#[derive(Debug, Args)]
pub struct SolveArguments {
    /// The scene: an .obj, .gltf, .glb, .ply or .stl file
    pub scene: PathBuf,
    /// Write the solution: scene, hierarchy, links, radiosities and options in one file
    #[arg(short, long, value_name = "SOLUTION")]
    pub output: Option<PathBuf>,
    #[command(flatten)]
    pub settings: SettingArguments,
    #[command(flatten)]
    pub trust: TrustArguments,
    /// Take a picture: .png to look at, .exr or .hdr with linear radiances; may be repeated, to have it in both
    #[arg(long, value_name = "FILE")]
    pub image: Vec<PathBuf>,
    #[command(flatten)]
    pub picture: PictureArguments,
    /// Write the lit mesh: .ply with radiosities at nodes, .glb for viewers, .vtp for ParaView; --lit-mesh is asked for by that
    #[arg(long, value_name = "FILE")]
    pub mesh: Option<PathBuf>,
    /// Evaluate at the points of this CSV file (x,y,z,nx,ny,nz), '-' for stdin
    #[arg(long, value_name = "P.csv", requires = "values")]
    pub points: Option<PathBuf>,
    /// Write the values at the points, '-' for stdout
    #[arg(long, value_name = "V.csv", requires = "points")]
    pub values: Option<PathBuf>,
    /// Write what the run tells about itself as JSON, '-' for stdout
    #[arg(long, value_name = "R.json")]
    pub report: Option<PathBuf>,
    #[command(flatten)]
    pub run: RunArguments,
}

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
    /// Points: a CSV file with the columns x,y,z,nx,ny,nz, '-' for stdin
    pub points: PathBuf,
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
    /// The picture: .png to look at, .exr or .hdr with linear radiances; may be repeated, to have it in both
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
    /// The file: .ply, .glb for viewers, .vtp for ParaView; with the lit mesh where the solution has one, else with the elements of the solver
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Write the elements of the solver, whether there is a lit mesh or not
    #[arg(long, conflicts_with = "quadratic")]
    pub elements: bool,
    /// Write each element of the lit mesh as one face of six vertices, around it: every second one is a corner, the others are middles of edges. If
    /// not given, it is written as four triangles
    #[arg(long)]
    pub quadratic: bool,
}

/// `patchlight batch`.
#[derive(Debug, Args)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub struct BatchArguments {
    #[command(subcommand)]
    pub command: Option<BatchCommand>,
    /// The file of jobs, TOML; docs/batch.md tells what stands in it
    #[arg(required = true)]
    pub file: Option<PathBuf>,
    #[command(flatten)]
    pub place: PlaceArguments,
    #[command(flatten)]
    pub work: WorkArguments,
}

/// What else can be done with a file of jobs.
#[derive(Debug, Subcommand)]
pub enum BatchCommand {
    /// Make the tables of what all shards have done, and check that nothing is missing
    #[command(after_help = EXIT_CODES)]
    Merge(MergeArguments),
}

/// `patchlight batch merge`.
#[derive(Debug, Args)]
pub struct MergeArguments {
    /// The file of jobs
    pub file: PathBuf,
    #[command(flatten)]
    pub place: PlaceArguments,
}

/// Where jobs read and write.
#[derive(Debug, Args)]
pub struct PlaceArguments {
    /// The folder of all results, tables and journals [default: that of the file of jobs]
    #[arg(short, long, value_name = "FOLDER")]
    pub output: Option<PathBuf>,
    #[command(flatten)]
    pub trust: TrustArguments,
    #[command(flatten)]
    pub run: RunArguments,
}

/// How jobs are done.
#[derive(Debug, Args)]
pub struct WorkArguments {
    /// So many jobs at a time, which share the threads; never changes a result [default: one for each thread]
    #[arg(long, value_name = "N")]
    pub jobs: Option<usize>,
    /// Go on: keep what is done, if inputs, options, version and files are what they were; do what is missing, or failed
    #[arg(long, conflicts_with = "anew")]
    pub resume: bool,
    /// Do all jobs again
    #[arg(long)]
    pub anew: bool,
    /// Do a part of the jobs, as in 0/3, 1/3 and 2/3, each by a process of its own; 'patchlight batch merge' makes the tables
    #[arg(long, value_name = "I/N")]
    pub shard: Option<String>,
    /// Try a job again so often if the machine fails in it (exit code 1)
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub retries: u32,
    /// List all jobs on stdout, as CSV, and do none
    #[arg(long)]
    pub plan: bool,
}

/// `patchlight info`.
#[derive(Debug, Args)]
pub struct InfoArguments {
    /// A scene or a solution
    pub file: PathBuf,
    /// Which sides of a scene's faces emit and receive: front or both
    #[arg(long, value_name = "SIDES", default_value = "front")]
    pub sides: String,
    #[command(flatten)]
    pub trust: TrustArguments,
}

/// What a scene may reach, and how it is read.
#[derive(Debug, Args)]
pub struct TrustArguments {
    /// Read material libraries, buffers and images wherever the scene says they lie, not only beside it and below
    #[arg(long)]
    pub allow_any_path: bool,
    /// What becomes of textures of glTF: each face has their mean over it (face), or a scene with textures is not read (reject)
    #[arg(long, value_name = "HOW", value_enum, default_value_t = Texture::Face)]
    pub texture: Texture,
}

impl TrustArguments {
    /// How a scene is read.
    pub fn import(&self, sides: Sides) -> ImportOptions {
        let textures = match self.texture {
            Texture::Face => Textures::Face,
            Texture::Reject => Textures::Reject,
        };
        ImportOptions { sides, allow_any_path: self.allow_any_path, textures }
    }
}

/// What becomes of textures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Texture {
    /// Their mean over each face.
    Face,
    /// An error.
    Reject,
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
    /// EXR and HDR, or PNG with --scale: radiance (W/m^2/sr), radiosity (W/m^2), irradiance (W/m^2), illuminance (lx, 179 lm to a watt of its Rec. 709
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
