//! `patchlight info`: what is in a scene or a solution, what was repaired, what is suspicious.

use std::path::Path;

use patchlight::inspect::{DEFAULT_POINTS, inspect};
use patchlight::output::is_solution_file;
use patchlight::pipeline::{PipelineError, Workers};
use patchlight::scene::SceneSummary;
use patchlight::scene::import::{Diagnostics, ImportOptions, read_scene};
use patchlight::solve::Solution;
use patchlight::visibility::{self, Backend, OccluderMesh};

use super::arguments::InfoArguments;
use super::exit::{Exit, Failure};
use super::files;
use super::light_groups::weight_in_words;
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
        describe_solution(path, &files::read_solution(path)?)
    } else {
        let options = arguments.trust.import(sides, arguments.lights.clone());
        Workers::new(0)?.install(|| describe_scene(path, &options))?
    };
    files::to_stdout(|writer| writer.write_all(text.as_bytes()))?;
    Ok(Exit::Done)
}

fn describe_scene(path: &Path, options: &ImportOptions) -> Result<String, Failure> {
    let mut imported = read_scene(path, options).map_err(Failure::bad_input)?;
    let mesh = OccluderMesh::of_scene(&imported.scene);
    let visibility = visibility::build(Backend::Auto, &mesh).map_err(PipelineError::from)?;
    let inspection = inspect(&imported.scene, visibility.as_ref(), DEFAULT_POINTS);
    for mut found in inspection.suspicions(&imported.file, &imported.lines) {
        found.object = found.face.and_then(|face| imported.scene.objects().name_of(face - 1)).map(str::to_owned);
        imported.diagnostics.push(found);
    }
    Ok(format!("{}: scene\n{}", path.display(), SceneSummary::new(&imported.scene, &imported.diagnostics)))
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
