//! `patchlight bake`: lightmaps of a solution, or of a scene that is solved first.

use std::path::{Path, PathBuf};
use std::time::Instant;

use patchlight::bake::{Atlas, BakeError, BakeOptions, BakeReport, VertexLight};
use patchlight::mesh::LitMesh;
use patchlight::output::{ExportFormat, ImageFormat, PngExposure, Provenance, Quantity, is_solution_file};
use patchlight::pipeline::{Evaluator, PipelineError};
use patchlight::scene::{FileUv, Scene};
use patchlight::solve::RunOptions;
use patchlight::values::Values;

use super::argument_groups::{PageArguments, PictureArguments, Whence, WhoseUv};
use super::arguments::{BakeArguments, SolveArguments};
use super::bake_again::Again;
use super::exit::{Exit, Failure};
use super::files::{self, Outputs};
use super::interrupt;
use super::lightmap_files::{LightmapFiles, PageFile, PageFormat};
use super::per_vertex::PerVertex;
use super::progress::{Voice, Watcher};
use super::ranks;
use super::request::{SolveRequest, parse_exposure, parse_quantity};
use super::results::no_mesh;
use super::settings::Settings;
use super::solve::{self, Demand};

/// What is baked, and where it goes.
#[derive(Debug)]
pub struct BakeRequest {
    input: Input,
    options: BakeOptions,
    from: Option<Whence>,
    uv: Option<WhoseUv>,
    files: LightmapFiles,
    again: Again,
    vertices: Option<PerVertex>,
    outputs: Outputs,
    limits: RunOptions,
    start: Instant,
    voice: Voice,
}

/// What is read.
#[derive(Debug)]
enum Input {
    Solution(PathBuf),
    /// A scene, to be solved first.
    Scene(Box<SolveRequest>),
}

/// Limits by these keys are for the bake as well as for the solve before it.
const LIMITS: [&str; 2] = ["time", "memory"];

/// The part of the time that texels have at least, where a scene is solved first: to find them takes longer than the solve.
const TIME_OF_TEXELS: f64 = 0.5;

impl BakeRequest {
    /// Validates what was typed.
    pub fn new(typed: BakeArguments) -> Result<Self, Failure> {
        let pages_or_glb = !typed.output.is_empty() || typed.rgbm.is_some() || typed.glb.is_some();
        if !pages_or_glb && (typed.per_vertex.is_empty() || typed.json.is_some()) {
            return Err(Failure::usage(
                "say where the lightmap goes: -o FILE, --rgbm FILE.png, --glb FILE.glb or --per-vertex FILE.ply",
            ));
        }
        let options = bake_options(&typed)?;
        let quantity = typed.quantity.as_deref().map_or(Ok(Quantity::Radiosity), parse_quantity)?;
        if quantity == Quantity::Width {
            return Err(Failure::usage(
                "--quantity width is for pictures; a lightmap has radiosity, radiance, irradiance or illuminance",
            ));
        }

        // Outputs, before anything is computed: the first page of each, others once it is known how many there are.
        let read: Vec<&Path> = [Some(&typed.input), typed.since.as_ref()].into_iter().flatten().map(PathBuf::as_path).collect();
        let mut outputs = Outputs::beside(&read);
        let mut pages = Vec::new();
        for path in &typed.output {
            let format = ImageFormat::of_path(path).map_err(Failure::usage)?;
            pages.extend(PageFile::of(path, PageFormat::Picture(format), options.separate));
        }
        if let Some(path) = &typed.rgbm {
            pages.extend(PageFile::of(path, PageFormat::Rgbm, options.separate));
        }
        let is_exposed = |page: &PageFile| page.format == PageFormat::Picture(ImageFormat::Png);
        if typed.exposure.is_some() && typed.glb.is_none() && !pages.iter().any(is_exposed) {
            return Err(Failure::usage("--exposure is for .png and .glb; other files keep the numbers as they are"));
        }
        let exposure = typed.exposure.as_deref().map_or(Ok(PngExposure::Auto), parse_exposure)?;
        for page in &pages {
            if page.format == PageFormat::Rgbm {
                check_extension(&page.path, "png", "--rgbm")?;
            }
            outputs.file(&page.path)?;
        }
        let glb =
            typed.glb.as_deref().map(|path| check_extension(path, "glb", "--glb").and_then(|()| outputs.file(path))).transpose()?;
        let json = typed.json.as_deref().map(|path| outputs.sink(path)).transpose()?;
        let vertices = per_vertex(&typed, &mut outputs)?;
        let again = Again::new(&typed, pages_or_glb, &mut outputs)?;
        let (from, uv, voice) = (typed.from, typed.uv, Voice::new(typed.run.progress));
        if options.separate && from == Some(Whence::Mesh) {
            return Err(Failure::usage("--separate: a lit mesh holds all light as one; leave out --from mesh"));
        }
        let files = LightmapFiles { quantity, exposure, pages, glb, json, voice };
        let (input, limits) = Input::new(typed)?;
        Ok(Self { input, options, from, uv, files, again, vertices, outputs, limits, start: Instant::now(), voice })
    }
}

impl Input {
    /// A solution takes no options of a solve but its limits. With how it runs.
    fn new(typed: BakeArguments) -> Result<(Self, RunOptions), Failure> {
        if is_solution_file(&typed.input) {
            if let Some((key, _)) = typed.settings.flags().find(|(key, _)| !LIMITS.contains(key)) {
                let flag = key.replace('_', "-");
                return Err(Failure::usage(format_args!("--{flag} is for scenes; {} is solved already", typed.input.display())));
            }
            if let Some(setting) = typed.settings.set.first() {
                let path = typed.input.display();
                return Err(Failure::usage(format_args!("--set {setting} is for scenes; {path} is solved already")));
            }
            if typed.lights.is_some() {
                let path = typed.input.display();
                return Err(Failure::usage(format_args!("--lights is for scenes; {path} is solved already")));
            }
            if let Some(flag) = typed.trust.of_scenes() {
                return Err(Failure::usage(format_args!("{flag} is for scenes; {} is solved already", typed.input.display())));
            }
            if typed.uv == Some(WhoseUv::File) {
                return Err(Failure::usage("--uv file: a solution does not keep the coordinates of its file; bake the scene"));
            }
            let run = Settings::new(&typed.settings, &typed.run, None)?.run;
            return Ok((Self::Solution(typed.input), run));
        }
        // Those of OBJ files are for textures, unless somebody says otherwise.
        let is_gltf =
            typed.input.extension().is_some_and(|own| own.eq_ignore_ascii_case("glb") || own.eq_ignore_ascii_case("gltf"));
        let keep_uv = typed.uv.map_or(is_gltf, |uv| uv == WhoseUv::File);
        let wants_mesh = typed.from == Some(Whence::Mesh);
        let mut settings = typed.settings;
        settings.lit_mesh |= wants_mesh;
        let solve = SolveArguments {
            scene: typed.input,
            output: None,
            settings,
            trust: typed.trust,
            image: Vec::new(),
            picture: PictureArguments::default(),
            mesh: None,
            points: None,
            values: None,
            html: None,
            page: PageArguments::default(),
            plots: None,
            report: None,
            light_groups: None,
            lights: typed.lights,
            run: typed.run,
        };
        let mut solve = SolveRequest::new(solve)?;
        solve.import.keep_uv = keep_uv;
        let run = solve.run.clone();
        Ok((Self::Scene(Box::new(solve)), run))
    }
}

/// What is written of light at vertices.
fn per_vertex(typed: &BakeArguments, outputs: &mut Outputs) -> Result<Option<PerVertex>, Failure> {
    let within = typed.within.as_deref().map_or(Ok(f64::INFINITY), |text| {
        let length = text.parse().ok().filter(|within| *within > 0.0);
        length.ok_or_else(|| Failure::usage(format_args!("within is '{text}', it must be a number of metres above 0")))
    })?;
    let file = |path: &PathBuf| {
        let format = ExportFormat::of_path(path).map_err(Failure::usage)?;
        Ok((outputs.file(path)?, format))
    };
    let files: Vec<_> = typed.per_vertex.iter().map(file).collect::<Result<_, Failure>>()?;
    Ok((!files.is_empty()).then_some(PerVertex { files, within }))
}

/// How the lightmap is laid out.
fn bake_options(typed: &BakeArguments) -> Result<BakeOptions, Failure> {
    let mut options = BakeOptions::default();
    if let Some(text) = &typed.texel {
        let bad = |_| Failure::usage(format_args!("texel is '{text}', it must be a number of metres above 0, as in 0.05"));
        options.texel = text.parse().map_err(bad)?;
    }
    options.padding = typed.padding.unwrap_or(options.padding);
    options.size = typed.size.unwrap_or(options.size);
    (options.separate, options.keep) = (typed.separate, typed.keep.is_some());
    options.only = typed.only.as_deref().map(str::parse).transpose().map_err(Failure::usage)?;
    options.validate().map_err(Failure::usage)?;
    Ok(options)
}

fn check_extension(path: &Path, extension: &str, flag: &str) -> Result<(), Failure> {
    if path.extension().is_some_and(|own| own.eq_ignore_ascii_case(extension)) {
        return Ok(());
    }
    Err(Failure::usage(format_args!("{flag} writes .{extension}: name the file {}", path.with_extension(extension).display())))
}

/// Bakes, and writes what is asked for.
pub fn bake(request: BakeRequest) -> Result<Exit, Failure> {
    let BakeRequest { input, options, voice, limits, .. } = &request;
    if ranks::size() > 1 && limits.time_s.is_some() {
        return Err(PipelineError::TeamTime.into());
    }

    // What is baked, and where its faces lie: that is known before the long work.
    let (evaluator, exit, atlas) = match input {
        Input::Solution(path) => {
            let solution = files::read_solution(path)?;
            let atlas = layout(solution.scene(), &FileUv::default(), &request)?;
            interrupt::listen_alone(interrupt::OF_RUN);
            (Evaluator::new_on(ranks::workers(limits.threads)?, solution, limits.backend)?, Exit::Done, atlas)
        }
        Input::Scene(solve) => {
            request.again.check(options, solve.options.error)?;
            let planned = |scene: &Scene, uv: &FileUv| {
                let atlas = layout(scene, uv, &request)?;
                let demand = demand(scene, atlas.as_ref(), &request);
                check_memory(request.limits.memory_bytes, demand.bytes)?;
                Ok((atlas, demand))
            };
            solve::light(solve, &request.outputs, planned)?
        }
    };
    let left = || request.limits.time_s.map(|seconds| (seconds - request.start.elapsed().as_secs_f64()).max(0.0));
    let of_map = match &atlas {
        Some(atlas) => bake_map(&request, &evaluator, atlas, left())?,
        None => Exit::Done,
    };
    let of_vertices = match &request.vertices {
        Some(vertices) if of_map != Exit::Cancelled => vertices.bake(&evaluator, options, left(), *voice)?,
        _ => Exit::Done,
    };
    // What went wrong first.
    Ok([exit, of_map, of_vertices].into_iter().find(|exit| *exit != Exit::Done).unwrap_or(Exit::Done))
}

/// What a bake takes beside the solve.
fn demand(scene: &Scene, atlas: Option<&Atlas>, request: &BakeRequest) -> Demand {
    let points = if request.vertices.is_some() { VertexLight::most_points(scene) } else { 0 };
    let of_map = atlas.map_or(0, |atlas| atlas.bytes_to_bake(scene.channels()));
    let bytes = of_map.max(Values::bytes_of(points as usize, scene.channels()));
    Demand { values: atlas.map_or(0, |atlas| atlas.texels() as u64) + points, bytes, time: TIME_OF_TEXELS }
}

/// Bakes the lightmap in so many seconds, and writes it.
fn bake_map(request: &BakeRequest, evaluator: &Evaluator, atlas: &Atlas, time_s: Option<f64>) -> Result<Exit, Failure> {
    let voice = request.voice;
    if let Input::Solution(_) = &request.input {
        check_memory(request.limits.memory_bytes, evaluator.bytes_to_bake(atlas, request.limits.backend))?;
    }
    tell_atlas(atlas, voice);
    let files = request.files.of_pages(atlas.pages().len())?;

    let mesh = match (request.from, evaluator.mesh()) {
        (Some(Whence::Gather), _) => None,
        (None, _) if request.options.separate || request.again.is_asked() => None,
        (Some(Whence::Mesh), None) => return Err(no_mesh("--from mesh")),
        (_, mesh) => mesh,
    };
    let observer = Watcher::new(voice);
    let found = match &request.again.earlier {
        Some(earlier) => evaluator.bake_since(atlas, earlier, time_s, &observer),
        None => evaluator.bake_within(atlas, mesh, time_s, &observer),
    };
    let found = found.map_err(Failure::usage)?;
    let Some(lightmap) = found else {
        voice.warn(format_args!("no lightmap is written: interrupted"));
        return Ok(Exit::Cancelled);
    };
    tell_report(&lightmap.report, mesh, voice);
    request.again.tell(&lightmap.report, voice);
    if ranks::is_first() {
        let provenance = Provenance::new(evaluator.solution().options());
        request.files.write(&files, &lightmap, evaluator.solution().scene(), &provenance)?;
        request.again.write(&lightmap, &provenance, voice)?;
    }
    Ok(if lightmap.report.is_complete() { Exit::Done } else { Exit::Limit })
}

/// Where faces lie, if a lightmap is wanted.
fn layout(scene: &Scene, uv: &FileUv, request: &BakeRequest) -> Result<Option<Atlas>, Failure> {
    if !request.files.are_some() {
        return Ok(None);
    }
    let (channels, options) = (scene.channels(), &request.options);
    if request.files.quantity == Quantity::Illuminance && !matches!(channels, 1 | 3) {
        return Err(Failure::usage(format_args!(
            "--quantity illuminance: not known for {channels} channels, only for one or three"
        )));
    }
    let own = || Atlas::new(scene, options).map_err(Failure::usage);
    let atlas = match request.uv {
        Some(WhoseUv::Own) => own(),
        Some(WhoseUv::File) => {
            Atlas::of_file(scene, uv, options).map_err(|error| Failure::usage(format_args!("--uv file: {error}")))
        }
        None if uv.triangles.is_empty() => own(),
        None => match Atlas::of_file(scene, uv, options) {
            Err(BakeError::Uv(why)) => {
                request.voice.warn(format_args!(
                    "the lightmap coordinates of the file are not used, and faces are laid out anew: {why}; --uv own says so beforehand"
                ));
                own()
            }
            of_file => of_file.map_err(Failure::usage),
        },
    };
    atlas.map(Some)
}

/// Whether a budget of memory has room for a lightmap.
fn check_memory(given: Option<u64>, needed: u64) -> Result<(), Failure> {
    let gigabytes = |bytes: u64| bytes as f64 * 1e-9;
    match given {
        Some(given) if needed > given => {
            let (needed, given) = (gigabytes(needed), gigabytes(given));
            let message = format!(
                "--memory: the lightmap takes {needed:.3} GB by the program's own count, more than {given:.3} GB: choose larger texels, or bake a part \
                 of the scene by --only"
            );
            Err(Failure { exit: Exit::Memory, message })
        }
        _ => Ok(()),
    }
}

fn tell_atlas(atlas: &Atlas, voice: Voice) {
    let (charts, pages) = (atlas.charts(), atlas.pages());
    let sizes: Vec<String> = pages.iter().map(|[width, height]| format!("{width}x{height}")).collect();
    let by = if atlas.is_of_file() { ", as the file lays them out" } else { "" };
    voice.figure("atlas", format_args!("{charts} charts on {} of {}{by}", plural(pages.len(), "page"), sizes.join(", ")));
}

fn plural(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

/// Tells how texels were found, and how wrong they are.
fn tell_report(report: &BakeReport, mesh: Option<&LitMesh>, voice: Voice) {
    let BakeReport { texels, hidden, gathered, .. } = report;
    let found = if mesh.is_some() {
        "read off the lit mesh".to_owned()
    } else {
        format!("direct light gathered at {} of them, indirect at {}", gathered[0], gathered[1])
    };
    voice.figure("texels", format_args!("{texels}, {found}; {hidden} have something standing on them"));
    let percent = |part: f64| format!("{:.2}%", 100.0 * part);
    match (mesh, report.whole, report.error) {
        (Some(mesh), ..) => {
            voice.figure(
                "values",
                format_args!("those of the lit mesh, claimed to be {} off the values at points", percent(mesh.claimed)),
            );
        }
        (None, Some(whole), Some(error)) => {
            let (error, between, whole) = (percent(error), percent(report.interpolated), percent(whole));
            voice.figure(
                "values",
                format_args!("{whole} off: gathered ones {error}, what lies between {between} more: an estimate"),
            );
        }
        _ => voice.figure("values", format_args!("nothing can be said about their error")),
    }
    if !report.is_complete() {
        let BakeReport { filled, coarse, .. } = report;
        voice.warn(format_args!(
            "the time was over: {filled} texels are interpolated or filled from others of their chart, {coarse} have the light of the solver's own \
             elements; nothing is claimed for them"
        ));
    }
    let seams = &report.seams;
    if seams.edges > 0 {
        let (mean, largest) = (percent(seams.mean), percent(seams.largest));
        voice.figure(
            "seams",
            format_args!("{}, their sides {mean} apart in the mean, {largest} at most", plural(seams.edges as usize, "edge")),
        );
    }
}
