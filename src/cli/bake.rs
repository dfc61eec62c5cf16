//! `patchlight bake`: lightmaps of a solution, or of a scene that is solved first.

use std::path::{Path, PathBuf};

use patchlight::bake::{Atlas, BakeOptions, BakeReport, Lightmap};
use patchlight::mesh::LitMesh;
use patchlight::output::{
    Destination, ImageFormat, LightmapCode, PngExposure, Provenance, Quantity, auto_exposure, is_solution_file, write_hdr,
    write_lightmap_glb, write_lightmap_json, write_lightmap_png,
};
use patchlight::picture::Image;
use patchlight::pipeline::Evaluator;
use patchlight::scene::Scene;

use super::argument_groups::{PictureArguments, Whence};
use super::arguments::{BakeArguments, SolveArguments};
use super::exit::{Exit, Failure};
use super::files::{self, Outputs, Sink};
use super::interrupt;
use super::progress::{Voice, Watcher};
use super::request::{SolveRequest, parse_exposure, parse_quantity};
use super::results::no_mesh;
use super::settings::run_options;
use super::solve;

/// What is baked, and where it goes.
#[derive(Debug)]
pub struct BakeRequest {
    input: Input,
    options: BakeOptions,
    from: Option<Whence>,
    quantity: Quantity,
    exposure: PngExposure,
    pages: Vec<(PathBuf, PageFormat)>,
    glb: Option<Destination>,
    json: Option<Sink>,
    outputs: Outputs,
    voice: Voice,
}

/// What is read.
#[derive(Debug)]
enum Input {
    Solution(PathBuf, patchlight::solve::RunOptions),
    /// A scene, to be solved first.
    Scene(Box<SolveRequest>),
}

/// How a page is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum PageFormat {
    Picture(ImageFormat),
    Rgbm,
}

impl BakeRequest {
    /// Validates what was typed.
    pub fn new(typed: BakeArguments) -> Result<Self, Failure> {
        if typed.output.is_empty() && typed.rgbm.is_none() && typed.glb.is_none() {
            return Err(Failure::usage("say where the lightmap goes: -o FILE, --rgbm FILE.png or --glb FILE.glb"));
        }
        let options = bake_options(&typed)?;
        let quantity = typed.quantity.as_deref().map_or(Ok(Quantity::Radiosity), parse_quantity)?;
        if quantity == Quantity::Width {
            return Err(Failure::usage(
                "--quantity width is for pictures; a lightmap has radiosity, radiance, irradiance or illuminance",
            ));
        }

        // Outputs, before anything is computed: the first page of each, others once it is known how many there are.
        let mut outputs = Outputs::beside(&[&typed.input]);
        let mut pages = Vec::new();
        for path in &typed.output {
            pages.push((path.clone(), PageFormat::Picture(ImageFormat::of_path(path).map_err(Failure::usage)?)));
        }
        pages.extend(typed.rgbm.iter().map(|path| (path.clone(), PageFormat::Rgbm)));
        let keeps_light = |format: &PageFormat| *format == PageFormat::Picture(ImageFormat::Png);
        if typed.exposure.is_some() && typed.glb.is_none() && !pages.iter().any(|(_, format)| keeps_light(format)) {
            return Err(Failure::usage("--exposure is for .png and .glb; other files keep the numbers as they are"));
        }
        let exposure = typed.exposure.as_deref().map_or(Ok(PngExposure::Auto), parse_exposure)?;
        for (path, format) in &pages {
            if *format == PageFormat::Rgbm {
                check_extension(path, "png", "--rgbm")?;
            }
            outputs.file(path)?;
        }
        let glb =
            typed.glb.as_deref().map(|path| check_extension(path, "glb", "--glb").and_then(|()| outputs.file(path))).transpose()?;
        let json = typed.json.as_deref().map(|path| outputs.sink(path)).transpose()?;
        let (from, voice) = (typed.from, Voice::new(typed.run.progress));
        Ok(Self { input: Input::new(typed)?, options, from, quantity, exposure, pages, glb, json, outputs, voice })
    }
}

impl Input {
    /// A solution takes no options of a solve.
    fn new(typed: BakeArguments) -> Result<Self, Failure> {
        if is_solution_file(&typed.input) {
            if let Some((key, _)) = typed.settings.flags().next() {
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
            return Ok(Self::Solution(typed.input, run_options(&typed.run)?));
        }
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
            report: None,
            light_groups: None,
            lights: typed.lights,
            run: typed.run,
        };
        Ok(Self::Scene(Box::new(SolveRequest::new(solve)?)))
    }
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
    let BakeRequest { input, options, voice, .. } = &request;
    let plan = |scene: &Scene| {
        let channels = scene.channels();
        if request.quantity == Quantity::Illuminance && !matches!(channels, 1 | 3) {
            return Err(Failure::usage(format_args!(
                "--quantity illuminance: not known for {channels} channels, only for one or three"
            )));
        }
        Atlas::new(scene, options).map_err(Failure::usage)
    };

    // What is baked, and where its faces lie: that is known before the long work.
    let (evaluator, exit, atlas) = match input {
        Input::Solution(path, run) => {
            let solution = files::read_solution(path)?;
            let atlas = plan(solution.scene())?;
            interrupt::listen(interrupt::OF_RUN);
            (Evaluator::new(solution, run)?, Exit::Done, atlas)
        }
        Input::Scene(solve) => {
            let planned = |scene: &Scene| {
                let atlas = plan(scene)?;
                let texels = atlas.texels() as u64;
                Ok((atlas, texels))
            };
            solve::light(solve, &request.outputs, planned)?
        }
    };
    tell_atlas(&atlas, *voice);
    let files = destinations(&request, &atlas)?;

    let mesh = match (request.from, evaluator.mesh()) {
        (Some(Whence::Gather), _) => None,
        (Some(Whence::Mesh), None) => return Err(no_mesh("--from mesh")),
        (_, mesh) => mesh,
    };
    let Some(lightmap) = evaluator.bake(&atlas, mesh, &Watcher::new(*voice)).map_err(Failure::usage)? else {
        voice.warn(format_args!("no lightmap is written: interrupted"));
        return Ok(Exit::Cancelled);
    };
    tell_report(&lightmap.report, mesh, *voice);
    write(&request, &files, &lightmap, evaluator.solution().scene(), &Provenance::new(evaluator.solution().options()))?;
    Ok(exit)
}

/// The files of all pages: of the second page on with its number before the extension.
fn destinations(request: &BakeRequest, atlas: &Atlas) -> Result<Vec<Vec<Destination>>, Failure> {
    let of_page = |(path, _): &(PathBuf, PageFormat)| {
        let page = |number: usize| {
            let extension = path.extension().unwrap_or_default().to_string_lossy();
            let path = if number == 0 { path.clone() } else { path.with_extension(format!("{}.{extension}", number + 1)) };
            Destination::new(&path).map_err(Failure::usage)
        };
        (0..atlas.pages().len()).map(page).collect()
    };
    request.pages.iter().map(of_page).collect()
}

fn tell_atlas(atlas: &Atlas, voice: Voice) {
    let (charts, pages) = (atlas.charts(), atlas.pages());
    let sizes: Vec<String> = pages.iter().map(|[width, height]| format!("{width}x{height}")).collect();
    voice.figure("atlas", format_args!("{charts} charts on {} of {}", plural(pages.len(), "page"), sizes.join(", ")));
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
    let seams = &report.seams;
    if seams.edges > 0 {
        let (mean, largest) = (percent(seams.mean), percent(seams.largest));
        voice.figure(
            "seams",
            format_args!("{}, their sides {mean} apart in the mean, {largest} at most", plural(seams.edges as usize, "edge")),
        );
    }
}

/// Writes everything that was asked for.
fn write(
    request: &BakeRequest,
    files: &[Vec<Destination>],
    lightmap: &Lightmap,
    scene: &Scene,
    provenance: &Provenance,
) -> Result<(), Failure> {
    let (voice, quantity) = (request.voice, request.quantity);
    let ev = match request.exposure {
        PngExposure::Ev(ev) => ev,
        PngExposure::Auto => exposure_of(&lightmap.pages),
    };
    let images: Vec<Image> =
        (0..lightmap.pages.len()).map(|page| image(lightmap, scene, page, quantity)).collect::<Result<_, _>>()?;
    let largest = images.iter().flat_map(|image| &image.radiance).fold(0.0_f32, |most, &x| most.max(x));
    let code = |format: PageFormat| match format {
        PageFormat::Rgbm => LightmapCode::Rgbm { range: f64::from(largest * quantity.per_radiance()) },
        PageFormat::Picture(_) => LightmapCode::Srgb { ev },
    };
    for ((_, format), destinations) in request.pages.iter().zip(files) {
        for (image, destination) in images.iter().zip(destinations) {
            write_page(destination, image, (*format, quantity, code(*format)), provenance)?;
            voice.figure("wrote", format_args!("{} ({} in {})", destination.path().display(), quantity.name(), quantity.unit()));
        }
    }
    if let Some(destination) = &request.glb {
        destination.write(|file| write_lightmap_glb(file, scene, lightmap, ev, provenance))?;
        voice.figure("wrote", format_args!("{} (exposure EV {ev:.2})", destination.path().display()));
    }
    if let Some(sink) = &request.json {
        sink.write(|writer| write_lightmap_json(writer, scene, lightmap, quantity, provenance))?;
        voice.figure("wrote", format_args!("{}", sink.name()));
    }
    Ok(())
}

/// A page as an image of a quantity.
fn image(lightmap: &Lightmap, scene: &Scene, page: usize, quantity: Quantity) -> Result<Image, Failure> {
    match quantity {
        Quantity::Irradiance => Ok(lightmap.irradiance(scene, page)),
        Quantity::Illuminance => lightmap.irradiance(scene, page).to_luminance().map_err(|channels| {
            Failure::usage(format_args!("--quantity illuminance: not known for {channels} channels, only for one or three"))
        }),
        _ => Ok(lightmap.pages[page].clone()),
    }
}

fn write_page(
    destination: &Destination,
    image: &Image,
    (format, quantity, code): (PageFormat, Quantity, LightmapCode),
    provenance: &Provenance,
) -> Result<(), Failure> {
    #[cfg(not(feature = "openexr"))]
    use patchlight::output::write_exr;
    #[cfg(feature = "openexr")]
    use patchlight::output::write_openexr as write_exr;
    destination.write(|file| match format {
        PageFormat::Picture(ImageFormat::Exr) => write_exr(file, image, quantity, provenance),
        PageFormat::Picture(ImageFormat::Hdr) => write_hdr(file, image, quantity, provenance),
        PageFormat::Picture(ImageFormat::Png) | PageFormat::Rgbm => write_lightmap_png(file, image, (quantity, code), provenance),
    })?;
    Ok(())
}

/// One exposure for all pages, each counting by its size.
fn exposure_of(pages: &[Image]) -> f64 {
    let of = |image: &Image| [f64::from(image.width) * f64::from(image.height), auto_exposure(image)];
    let [sum, area] = pages.iter().map(of).fold([0.0; 2], |[sum, total], [area, ev]| [sum + area * ev, total + area]);
    if area > 0.0 { sum / area } else { 0.0 }
}
