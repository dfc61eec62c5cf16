//! `patchlight info`: what is in a scene or a solution, what was repaired, what is suspicious.

use std::path::Path;

use patchlight::inspect::{DEFAULT_POINTS, Findings, inspect};
use patchlight::output::{Destination, ImageFormat, is_solution_file, write_keyed_png};
use patchlight::picture::{Camera, CameraRequest};
use patchlight::pipeline::{PipelineError, Workers, picture_of_findings};
use patchlight::scene::Scene;
use patchlight::scene::SceneSummary;
use patchlight::scene::import::{Diagnostics, ImportOptions, read_scene};
use patchlight::solve::Solution;
use patchlight::visibility::{self, Backend, OccluderMesh, Visibility};

use super::argument_groups::ViewArguments;
use super::arguments::InfoArguments;
use super::exit::{Exit, Failure};
use super::files::{self, Outputs};
use super::light_groups::weight_in_words;
use super::request::view;
use super::settings::parse_sides;

/// Tells what is in a file.
pub fn info(arguments: &InfoArguments) -> Result<Exit, Failure> {
    let sides = parse_sides(&arguments.sides)?;
    let path = &arguments.file;
    let text = if is_solution_file(path) {
        if arguments.lights.is_some() {
            return Err(Failure::usage(format_args!("--lights is for scenes; {} is solved already", path.display())));
        }
        if let Some(flag) = arguments.trust.of_scenes() {
            return Err(Failure::usage(format_args!("{flag} is for scenes; {} is solved already", path.display())));
        }
        if arguments.image.is_some() {
            let path = path.display();
            return Err(Failure::usage(format_args!("--image is for scenes; take pictures of {path} by 'patchlight render'")));
        }
        describe_solution(path, &files::read_solution(path)?)
    } else {
        let options = arguments.trust.import(sides, arguments.lights.clone());
        let drawing = Drawing::new(arguments)?;
        Workers::new(0)?.install(|| describe_scene(path, &options, drawing.as_ref()))?
    };
    files::to_stdout(|writer| writer.write_all(text.as_bytes()))?;
    Ok(Exit::Done)
}

/// The picture of what is found.
struct Drawing {
    file: Destination,
    outputs: Outputs,
    camera: CameraRequest,
    size: (u32, u32),
}

impl Drawing {
    /// Validates what was typed of it.
    fn new(arguments: &InfoArguments) -> Result<Option<Self>, Failure> {
        let Some(path) = &arguments.image else {
            return match &arguments.view {
                ViewArguments { camera: None, size: None } => Ok(None),
                _ => Err(Failure::usage("--camera and --size need --image FILE.png")),
            };
        };
        if ImageFormat::of_path(path).ok() != Some(ImageFormat::Png) {
            return Err(Failure::usage(format_args!(
                "--image draws a PNG: name the file {}",
                path.with_extension("png").display()
            )));
        }
        let (camera, size) = view(&arguments.view)?;
        let mut outputs = Outputs::beside(&[&arguments.file]);
        let file = outputs.file(path)?;
        Ok(Some(Self { file, outputs, camera, size }))
    }

    /// Draws; what is told of it.
    fn draw(&self, scene: &Scene, findings: &Findings, visibility: &dyn Visibility) -> Result<String, Failure> {
        let (width, height) = self.size;
        let camera = Camera::default_view(scene, visibility, width, height);
        let camera = self.camera.apply_to(camera).map_err(Failure::usage)?;
        let (picture, key) = picture_of_findings(scene, findings, visibility, &camera)?;
        self.file.write(|file| write_keyed_png(file, picture.size, &picture.pixels, &key))?;
        let lines: String = key.iter().map(|line| format!("  {}\n", line.text)).collect();
        Ok(format!("picture      {}, from {camera}:\n{lines}", self.file.path().display()))
    }
}

fn describe_scene(path: &Path, options: &ImportOptions, drawing: Option<&Drawing>) -> Result<String, Failure> {
    let mut imported = read_scene(path, options).map_err(Failure::bad_input)?;
    let mesh = OccluderMesh::of_scene(&imported.scene);
    let visibility = visibility::build(Backend::Auto, &mesh).map_err(PipelineError::from)?;
    let inspection = inspect(&imported.scene, visibility.as_ref(), DEFAULT_POINTS);
    let picture = drawing.map_or(Ok(String::new()), |drawing| {
        drawing.outputs.check_unread(&imported.libraries)?;
        drawing.draw(&imported.scene, &Findings::new(&imported, &inspection), visibility.as_ref())
    })?;
    for mut found in inspection.suspicions(&imported.file, &imported.lines) {
        found.object = found.face.and_then(|face| imported.scene.objects().name_of(face - 1)).map(str::to_owned);
        imported.diagnostics.push(found);
    }
    Ok(format!("{}: scene\n{}{picture}", path.display(), SceneSummary::new(&imported.scene, &imported.diagnostics)))
}

fn describe_solution(path: &Path, solution: &Solution) -> String {
    let mut leaves = 0_u64;
    solution.for_each_leaf(|_, _, _| leaves += 1);
    let summary = SceneSummary::new(solution.scene(), &Diagnostics::default());
    let mesh = solution.mesh().map_or(String::new(), |mesh| {
        let (elements, nodes, off) = (mesh.elements(), mesh.nodes(), 100.0 * mesh.claimed);
        format!("lit mesh     {elements} elements, {nodes} nodes, claimed to be {off:.2}% off the values at points\n")
    });
    let groups = solution.scene().light_groups().map_or(String::new(), |groups| {
        let weight = |(number, name): (usize, &String)| format!("{name}={}", weight_in_words(groups.weights_of(number)));
        let weights: Vec<String> = groups.names().iter().enumerate().map(weight).collect();
        format!("light groups {}\n", weights.join(" "))
    });
    let options = serde_json::to_string(solution.options()).unwrap_or_default();
    format!("{}: solution\n{summary}leaves       {leaves}\n{mesh}{groups}options      {options}\n", path.display())
}
