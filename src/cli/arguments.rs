//! The command line as it is typed.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};

use super::argument_groups::{
    PageArguments, PictureArguments, RunArguments, SettingArguments, TrustArguments, ViewArguments, Whence, WhoseUv,
};
use super::batch_arguments::BatchArguments;
use super::option_help::{self, EXIT_CODES};

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
    /// Light a scene, and write what is asked for: if nothing is, the page out/NAME.html
    #[command(after_help = EXIT_CODES, after_long_help = format!("{}\n{EXIT_CODES}", option_help::of_set()))]
    Solve(Box<SolveArguments>),
    /// Evaluate a solution at points, or by sensors in space
    #[command(after_help = EXIT_CODES)]
    Sample(SampleArguments),
    /// Take a picture of a solution
    #[command(after_help = EXIT_CODES)]
    Render(RenderArguments),
    /// Weight the light groups of a solution, or change its materials: from what is stored, in a moment, with the error that follows
    #[command(after_help = EXIT_CODES)]
    Relight(Box<RelightArguments>),
    /// Write the elements of a solution with their radiosities, or the power that surfaces emit and absorb
    #[command(after_help = EXIT_CODES)]
    Export(ExportArguments),
    /// Make a lightmap of a scene or a solution: its light as textures
    #[command(after_help = EXIT_CODES)]
    Bake(Box<BakeArguments>),
    /// Do many solves: scenes, options and changes of materials, each with each, as a file of jobs says
    #[command(after_help = EXIT_CODES)]
    Batch(Box<BatchArguments>),
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
    /// The scene: an .obj, .gltf, .glb, .ply or .stl file
    pub scene: PathBuf,
    /// Write the solution: scene, hierarchy, links, radiosities and options in one file
    #[arg(short, long, value_name = "SOLUTION")]
    pub output: Option<PathBuf>,
    #[command(flatten)]
    pub settings: SettingArguments,
    /// Keep the light of emitters apart, so that 'patchlight relight' can weight it: a group for each material or object that emits (material, object),
    /// or as a TOML file says, a group on each line: lamps = ["object desk lamp", "material tube"]
    #[arg(long, value_name = "GROUPS")]
    pub light_groups: Option<PathBuf>,
    /// Lights that are no surfaces, beside those of the scene's own file: a TOML file, see docs/lights.md
    #[arg(long, value_name = "LIGHTS.toml")]
    pub lights: Option<PathBuf>,
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
    /// Write a page for browsers: the lit scene in 3D, and what the run tells about itself; it loads nothing from anywhere
    #[arg(long, value_name = "FILE.html")]
    pub html: Option<PathBuf>,
    #[command(flatten)]
    pub page: PageArguments,
    /// Draw what the run tells about itself: error.png (against time), time.png and light.png (where both went), in this folder
    #[arg(long, value_name = "FOLDER")]
    pub plots: Option<PathBuf>,
    /// Write what the run tells about itself as JSON, '-' for stdout
    #[arg(long, value_name = "R.json")]
    pub report: Option<PathBuf>,
    #[command(flatten)]
    pub run: RunArguments,
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
    /// The picture: .png to look at, .exr or .hdr with linear radiances; may be repeated, to have it in both
    #[arg(short, long, value_name = "FILE", required = true)]
    pub output: Vec<PathBuf>,
    /// Make a lit mesh of what the picture sees, for which no more than this error is claimed, relative to the values at points, over the pixels
    /// [default: the error of the solution, where this has no lit mesh and the picture is not small]
    #[arg(long, value_name = "E")]
    pub error: Option<String>,
    /// End after so many seconds: a mesh of the view is as good as it got, and of values that are gathered, pixels that are left out show one beside them
    #[arg(long, value_name = "SECONDS")]
    pub time: Option<String>,
    /// Do not refine a mesh of the view beyond so many GB; where there is no room for one, values are gathered
    #[arg(long, value_name = "GB")]
    pub memory: Option<String>,
    #[command(flatten)]
    pub picture: PictureArguments,
    #[command(flatten)]
    pub run: RunArguments,
}

/// `patchlight relight`.
#[derive(Debug, Args)]
pub struct RelightArguments {
    /// A solution that 'patchlight solve -o' wrote with --light-groups or --keep-transport, or this command
    pub solution: PathBuf,
    /// The weight of a group, from 0 on, as in lamp=0.5, or one for each channel, as in lamp=0,0,2; 1 is what was solved; may be repeated. Others keep
    /// theirs
    #[arg(long, value_name = "GROUP=W")]
    pub set: Vec<String>,
    /// Another reflectance for a material, as in wall=0.5, or one for each channel, as in wall=0.5,0.4,0.3; may be repeated. It needs a solution
    /// that was solved with --keep-transport
    #[arg(long, value_name = "MATERIAL=R", conflicts_with = "set")]
    pub reflectance: Vec<String>,
    /// Another exitance in W/m^2, likewise
    #[arg(long, value_name = "MATERIAL=E", conflicts_with = "set")]
    pub exitance: Vec<String>,
    /// What the exitance is multiplied by, likewise, after that was set
    #[arg(long, value_name = "MATERIAL=X", conflicts_with = "set")]
    pub exitance_factor: Vec<String>,
    /// The error asked for with other materials: if more is claimed, the program ends with 4 [default: the error of the solution]
    #[arg(long, value_name = "E", conflicts_with = "set")]
    pub error: Option<String>,
    /// Write the solution with these weights or materials; it can be relit again
    #[arg(short, long, value_name = "SOLUTION")]
    pub output: Option<PathBuf>,
    /// Take a picture: .png to look at, .exr or .hdr with linear radiances; may be repeated, to have it in both
    #[arg(long, value_name = "FILE")]
    pub image: Vec<PathBuf>,
    #[command(flatten)]
    pub picture: PictureArguments,
    /// Evaluate at the points of this CSV file (x,y,z,nx,ny,nz), '-' for stdin: by rays, or with --from mesh off the lit mesh
    #[arg(long, value_name = "P.csv", requires = "values")]
    pub points: Option<PathBuf>,
    /// Write the values at the points, '-' for stdout
    #[arg(long, value_name = "V.csv", requires = "points")]
    pub values: Option<PathBuf>,
    /// Write the lit mesh: .ply with radiosities at nodes, .glb for viewers, .vtp for ParaView
    #[arg(long, value_name = "FILE")]
    pub mesh: Option<PathBuf>,
    /// Write the power in W that is emitted, arrives and is absorbed, as 'patchlight export' does; '-' for stdout
    #[arg(long, value_name = "FLUX.csv")]
    pub flux: Option<PathBuf>,
    /// Write a page for browsers: the lit scene in 3D
    #[arg(long, value_name = "FILE.html")]
    pub html: Option<PathBuf>,
    /// Write what is known of the groups and of their weighted sum as JSON, or the error with these materials; '-' for stdout
    #[arg(long, value_name = "R.json")]
    pub report: Option<PathBuf>,
    #[command(flatten)]
    pub run: RunArguments,
}

/// `patchlight export`.
#[derive(Debug, Args)]
pub struct ExportArguments {
    /// A solution that 'patchlight solve -o' wrote
    pub solution: PathBuf,
    /// The file: .ply, .glb for viewers, .vtp for ParaView; with the lit mesh where the solution has one, else with the elements of the solver
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

/// `patchlight bake`.
#[derive(Debug, Args)]
pub struct BakeArguments {
    /// A solution that 'patchlight solve -o' wrote, or a scene, which is solved first
    pub input: PathBuf,
    /// The lightmap: .exr or .hdr with linear numbers, .png exposed in sRGB; may be repeated. Of several pages the second is FILE.2.exr, and so on
    #[arg(short, long, value_name = "FILE")]
    pub output: Vec<PathBuf>,
    /// Write it as RGBM: x = RGB * A * range, where the range stands in the file
    #[arg(long, value_name = "FILE.png")]
    pub rgbm: Option<PathBuf>,
    /// Write the scene with the lightmap as its texture: unlit, so that viewers show it as it is, with TEXCOORD_1
    #[arg(long, value_name = "FILE.glb")]
    pub glb: Option<PathBuf>,
    /// Write where each face lies on the lightmap: chart, page and coordinates, '-' for stdout
    #[arg(long, value_name = "FILE.json")]
    pub json: Option<PathBuf>,
    /// The side of a texel in metres [default: 0.05]
    #[arg(long, value_name = "M", allow_hyphen_values = true)]
    pub texel: Option<String>,
    /// Texels around each chart that are filled with its own light, 0 to 256 [default: 2]
    #[arg(long, value_name = "N")]
    pub padding: Option<u32>,
    /// The largest side of a page in texels; what does not fit goes to more pages [default: 4096]
    #[arg(long, value_name = "N")]
    pub size: Option<u32>,
    /// Write light at the vertices of faces, each the mean over the part of its face around the vertex: .ply with radiosities, .glb with COLOR_0, .vtp; may
    /// be repeated. Vertices are those of the scene's faces: in glTF, STL and PLY files, triangles in one plane were joined
    #[arg(long, value_name = "FILE")]
    pub per_vertex: Vec<PathBuf>,
    /// How far the part around a vertex reaches along its edges, in metres [default: to their middles]
    #[arg(long, value_name = "M", requires = "per_vertex", allow_hyphen_values = true)]
    pub within: Option<String>,
    /// Where faces lie: as the second texture coordinates of a glTF file say, or the only ones of an OBJ file (file); or as charts of coplanar faces (own)
    /// [default: file where a glTF file has what can be used]
    #[arg(long, value_name = "WHOSE", value_enum)]
    pub uv: Option<WhoseUv>,
    /// Bake a part alone: 'material NAME' or 'object NAME'
    #[arg(long, value_name = "WHAT")]
    pub only: Option<String>,
    /// Keep direct and indirect light apart as well: layers 'direct' and 'indirect' of .exr, files FILE.direct.png and FILE.indirect.png of
    /// others. Texels are gathered for it, whatever --from says by default
    #[arg(long)]
    pub separate: bool,
    /// Write what a later bake of this scene, changed since, can take from this one
    #[arg(long, value_name = "FILE.bake")]
    pub keep: Option<PathBuf>,
    /// What 'bake --keep' left of the scene before it was changed: light is kept where it changed by what few gathers tell, and found anew elsewhere; how
    /// far all of it is off is measured, and told
    #[arg(long, value_name = "FILE.bake")]
    pub since: Option<PathBuf>,
    /// What .exr, .hdr and RGBM hold: radiosity (W/m^2), radiance (W/m^2/sr), irradiance (W/m^2) or illuminance (lx) [default: radiosity]
    #[arg(long, value_name = "QUANTITY")]
    pub quantity: Option<String>,
    /// sRGB and GLB: auto, or the exposure value EV; radiances are multiplied by 2^EV [default: auto]
    #[arg(long, value_name = "EV", allow_hyphen_values = true)]
    pub exposure: Option<String>,
    /// Where texels come from: read off the lit mesh; or gathered by rays where that is needed, and interpolated between [default: mesh where there is
    /// one]
    #[arg(long, value_name = "WHENCE", value_enum)]
    pub from: Option<Whence>,
    #[command(flatten)]
    pub settings: SettingArguments,
    /// Lights that are no surfaces, beside those of the scene's own file: a TOML file, see docs/lights.md
    #[arg(long, value_name = "LIGHTS.toml")]
    pub lights: Option<PathBuf>,
    #[command(flatten)]
    pub trust: TrustArguments,
    #[command(flatten)]
    pub run: RunArguments,
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
    pub page: PageArguments,
    #[command(flatten)]
    pub run: RunArguments,
}

/// `patchlight info`.
#[derive(Debug, Args)]
pub struct InfoArguments {
    /// A scene or a solution
    pub file: PathBuf,
    /// Which sides of a scene's faces emit and receive: front or both
    #[arg(long, value_name = "SIDES", default_value = "front")]
    pub sides: String,
    /// Lights that are no surfaces, beside those of the scene's own file: a TOML file, see docs/lights.md
    #[arg(long, value_name = "LIGHTS.toml")]
    pub lights: Option<PathBuf>,
    /// Draw the scene, whatever its light, with faces in colours of what was found about them, and a key to these on its right: .png
    #[arg(long, value_name = "FILE.png")]
    pub image: Option<PathBuf>,
    #[command(flatten)]
    pub view: ViewArguments,
    #[command(flatten)]
    pub trust: TrustArguments,
}
