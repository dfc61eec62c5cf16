//! All jobs of a file: scenes, rows of a table and parameters, each with each.

use std::collections::BTreeMap;
use std::path::{Component, Path};

use super::super::changes::Change;
use super::super::exit::Failure;
use super::super::reader::Said;
use super::job_file::JobFile;
use super::parameters::{Parameter, Rows};
use super::template;

/// One solve, and what is written of it.
#[derive(Clone, Debug)]
pub struct Job {
    /// Unlike that of any other.
    pub name: String,
    /// The scene, as the file says it.
    pub scene: String,
    /// Values of all parameters, in the order of [`Plan::parameters`].
    pub values: Vec<String>,
    /// Options of the solve by key.
    pub options: Vec<Said>,
    /// Changes of materials.
    pub changes: Vec<Change>,
    /// The file of lights.
    pub lights: Option<Said>,
    /// The file of points.
    pub points: Option<Said>,
    /// Files to write, relative to the folder of results, by what they are.
    pub outputs: Vec<Said>,
    /// How pictures are taken.
    pub picture: Vec<Said>,
}

/// All jobs, in their order.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The names of parameters: columns of the table first.
    pub parameters: Vec<String>,
    /// The jobs: scenes vary most slowly, the last parameter fastest.
    pub jobs: Vec<Job>,
}

/// More jobs are a slip.
const MOST_JOBS: usize = 1_000_000;

/// Names that stand for something of the job itself, or for a column of the results.
const TAKEN: [&str; 11] =
    ["scene", "number", "name", "exit", "stopped_by", "norm", "requested", "claimed", "confidence", "points_missed", "message"];

impl Plan {
    /// All jobs of `file`, with the rows of its table, if it has one.
    pub fn new(file: &JobFile, rows: Option<Rows>) -> Result<Self, Failure> {
        let rows = rows.unwrap_or(Rows { names: Vec::new(), rows: vec![Vec::new()] });
        check_names(file, &rows)?;
        let combinations = combinations(&file.parameters);
        let count = combinations.and_then(|count| count.checked_mul(rows.rows.len())?.checked_mul(file.scenes.len()));
        let Some(count) = count.filter(|&count| count <= MOST_JOBS) else {
            return Err(file.scenes[0].wrong(format_args!("these are more than {MOST_JOBS} jobs")));
        };

        // Each with each.
        let names = file.parameters.iter().map(|parameter| parameter.name.clone());
        let parameters: Vec<String> = rows.names.iter().cloned().chain(names).collect();
        let (digits, mut jobs) = (count.to_string().len(), Vec::with_capacity(count));
        for scene in &file.scenes {
            for row in &rows.rows {
                for combination in 0..combinations.unwrap_or(0) {
                    let values: Vec<String> = row.iter().cloned().chain(values_of(&file.parameters, combination)).collect();
                    let number = format!("{:0digits$}", jobs.len() + 1);
                    jobs.push(Filling { number, scene, parameters: &parameters, values }.job(file)?);
                }
            }
        }
        let plan = Self { parameters, jobs };
        plan.check_apart()?;
        Ok(plan)
    }

    /// Jobs have names of their own, and write files of their own.
    fn check_apart(&self) -> Result<(), Failure> {
        let (mut names, mut files) = (BTreeMap::new(), BTreeMap::new());
        for job in &self.jobs {
            if let Some(other) = names.insert(job.name.as_str(), job) {
                let (name, what) = (&job.name, "the template 'name' must tell them apart");
                return Err(Failure::bad_input(format_args!(
                    "two jobs are named '{name}', of {} and {}: {what}",
                    other.scene, job.scene
                )));
            }
            for output in &job.outputs {
                if let Some(other) = files.insert(output.text.as_str(), job) {
                    let (name, other) = (&job.name, &other.name);
                    return Err(output.wrong(format_args!("the jobs '{other}' and '{name}' would both write {}", output.text)));
                }
            }
        }
        Ok(())
    }
}

/// Names of parameters are not used twice, and each of those that are listed is used: else jobs would differ by nothing.
fn check_names(file: &JobFile, rows: &Rows) -> Result<(), Failure> {
    let listed = file.parameters.iter().map(|parameter| (&parameter.name, &parameter.place));
    let columns = rows.names.iter().filter_map(|name| Some((name, &file.csv.as_ref()?.place)));
    let mut seen = Vec::new();
    for (name, place) in columns.chain(listed) {
        if seen.contains(&name) || TAKEN.contains(&name.as_str()) {
            return Err(Failure::bad_input(format_args!("{place}: the name '{name}' is taken: choose another")));
        }
        if name.is_empty() || name.contains(['{', '}']) {
            return Err(Failure::bad_input(format_args!("{place}: '{name}' cannot be a name")));
        }
        seen.push(name);
    }
    let changes = file.materials.iter().flat_map(|(_, changes)| changes);
    let used = file.scenes.iter().chain(&file.lights).chain(&file.points).chain(&file.options).chain(changes).chain(&file.picture);
    let used: Vec<&str> = used.flat_map(|said| template::names(&said.text)).collect();
    match file.parameters.iter().find(|parameter| !used.contains(&parameter.name.as_str())) {
        Some(parameter) => {
            let name = &parameter.name;
            Err(Failure::bad_input(format_args!(
                "{}: '{{{name}}}' stands in no scene, lights, points, option, material or picture: its jobs would be the same",
                parameter.place
            )))
        }
        None => Ok(()),
    }
}

/// How many there are, unless that is too large a number.
fn combinations(parameters: &[Parameter]) -> Option<usize> {
    parameters.iter().try_fold(1_usize, |count, parameter| count.checked_mul(parameter.values.len()))
}

/// The values of one combination; the last parameter varies fastest.
fn values_of(parameters: &[Parameter], combination: usize) -> Vec<String> {
    let mut rest = combination;
    let value = |parameter: &Parameter| {
        let value = parameter.values[rest % parameter.values.len()].clone();
        rest /= parameter.values.len();
        value
    };
    let mut values: Vec<String> = parameters.iter().rev().map(value).collect();
    values.reverse();
    values
}

/// What names stand for in one job.
struct Filling<'a> {
    number: String,
    scene: &'a Said,
    parameters: &'a [String],
    values: Vec<String>,
}

impl Filling<'_> {
    fn job(self, file: &JobFile) -> Result<Job, Failure> {
        // The scene may depend on parameters, the name on the scene, and files on all of them.
        let scene = fill(self.scene, |name| self.parameter(name))?;
        let stem = Path::new(&scene.text).file_stem().map_or(String::new(), |stem| stem.to_string_lossy().into_owned());
        let known = |name: &str| match name {
            "scene" => Some(stem.clone()),
            "number" => Some(self.number.clone()),
            _ => self.parameter(name),
        };
        let named = file.name.as_ref().map(|template| fill(template, known)).transpose()?;
        let name = named.map_or_else(|| self.number.clone(), |said| said.text);
        let in_path = |wanted: &str| Some(template::file_part(&if wanted == "name" { name.clone() } else { known(wanted)? }));

        let all = |texts: &[Said]| texts.iter().map(|said| fill(said, known)).collect::<Result<Vec<Said>, Failure>>();
        let mut changes = Vec::new();
        for (material, texts) in &file.materials {
            for said in all(texts)? {
                changes.push(Change::new(material, &said)?);
            }
        }
        let outputs = file.outputs.iter().map(|said| inside(fill(said, in_path)?)).collect::<Result<_, Failure>>()?;
        let [lights, points] = [&file.lights, &file.points].map(|said| said.as_ref().map(|said| fill(said, known)).transpose());
        let (lights, points) = (lights?, points?);
        let (options, picture) = (all(&file.options)?, all(&file.picture)?);
        Ok(Job { name, scene: scene.text, values: self.values, options, changes, lights, points, outputs, picture })
    }

    fn parameter(&self, name: &str) -> Option<String> {
        self.parameters.iter().position(|known| known == name).map(|index| self.values[index].clone())
    }
}

fn fill(said: &Said, value_of: impl Fn(&str) -> Option<String>) -> Result<Said, Failure> {
    let text = template::fill(&said.text, value_of).map_err(|why| said.wrong(why))?;
    Ok(Said { text, ..said.clone() })
}

/// Results stay in the folder of results; a path has one spelling.
fn inside(output: Said) -> Result<Said, Failure> {
    let path = Path::new(&output.text);
    let parts: Option<Vec<&str>> =
        path.components().map(|part| if let Component::Normal(part) = part { part.to_str() } else { None }).collect();
    match parts.filter(|parts| !parts.is_empty() && !output.text.ends_with('/')) {
        Some(parts) => Ok(Said { text: parts.join("/"), ..output }),
        None => {
            Err(output.wrong(format_args!("'{}' must be the name of a file in the folder of results, or below it", output.text)))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan(text: &str, rows: Option<Rows>) -> Result<Plan, String> {
        let file = JobFile::parse(Path::new("jobs.toml"), text).map_err(|failure| failure.message)?;
        Plan::new(&file, rows).map_err(|failure| failure.message)
    }

    fn rows(names: &[&str], rows: &[&[&str]]) -> Rows {
        let owned = |texts: &[&str]| texts.iter().map(|&text| text.to_owned()).collect();
        Rows { names: owned(names), rows: rows.iter().map(|row| owned(row)).collect() }
    }

    const FILE: &str = "scenes = ['x/a.obj', 'b.obj']\nname = '{scene}-{power}-{wall}-{seed}'\ncsv = 'more.csv'\n\
        [parameters]\nwall = [[0.1, 0.2, 0.3], 0.5]\nseed = [1, 2]\n[options]\nseed = '{seed}'\n\
        [materials.lamp]\nexitance_factor = '{power}'\n[materials.wall]\nreflectance = '{wall}'\n\
        [outputs]\nvalues = 'v/{name}.csv'\nimage = ['{number}.png', '{number}.exr']\n";

    #[test]
    fn each_is_combined_with_each() {
        let found = plan(FILE, Some(rows(&["power", "note"], &[&["0.5", "low"], &["2", "high"]]))).unwrap();
        assert_eq!(found.parameters, ["power", "note", "wall", "seed"]);
        let names: Vec<&str> = found.jobs.iter().map(|job| job.name.as_str()).collect();
        assert_eq!(names.len(), 16);
        assert_eq!(names[..5], ["a-0.5-0.1 0.2 0.3-1", "a-0.5-0.1 0.2 0.3-2", "a-0.5-0.5-1", "a-0.5-0.5-2", "a-2-0.1 0.2 0.3-1"]);
        let second = &found.jobs[1];
        assert_eq!(second.values, ["0.5", "low", "0.1 0.2 0.3", "2"]);
        assert_eq!((second.scene.as_str(), second.options[0].text.as_str()), ("x/a.obj", "2"));
        assert_eq!(second.changes[1].numbers, [0.1, 0.2, 0.3]);
        let outputs: Vec<&str> = second.outputs.iter().map(|output| output.text.as_str()).collect();
        assert_eq!(outputs, ["v/a-0.5-0.1_0.2_0.3-2.csv", "02.png", "02.exr"]);
        assert_eq!(found.jobs[8].scene, "b.obj");
    }

    #[test]
    fn without_parameters_each_scene_is_a_job() {
        let found = plan("scenes = ['a.obj', 'b.obj']", None).unwrap();
        assert_eq!(found.jobs.iter().map(|job| job.name.as_str()).collect::<Vec<_>>(), ["1", "2"]);
    }

    #[test]
    fn what_makes_no_plan_is_told_with_line_and_key() {
        let scenes = "scenes = 'a.obj'\n";
        for (text, words) in [
            ("[options]\nseed = '{sead}'", "jobs.toml:3: options.seed: '{sead}' is the name of nothing"),
            ("[options]\nseed = '{seed'", "jobs.toml:3: options.seed: '{seed': '{' is not closed"),
            ("[parameters]\nseed = [1]", "jobs.toml:3: parameters.seed: '{seed}' stands in no scene"),
            ("[parameters]\nscene = [1]", "jobs.toml:3: parameters.scene: the name 'scene' is taken"),
            ("name = 'a'\n[parameters]\ns = [1, 2]\n[options]\nseed = '{s}'", "two jobs are named 'a'"),
            (
                "[parameters]\ns = [1, 2]\n[options]\nseed = '{s}'\n[outputs]\nvalues = 'a.csv'",
                "jobs.toml:7: outputs.values: the jobs '1' and '2'",
            ),
            ("[outputs]\nvalues = '../a.csv'", "jobs.toml:3: outputs.values: '../a.csv' must be the name of a file"),
            ("[outputs]\nvalues = '/a.csv'", "jobs.toml:3: outputs.values: '/a.csv' must be the name of a file"),
            ("[materials.lamp]\nexitance = 'much'", "jobs.toml:3: materials.lamp.exitance: 'much' must be one number"),
            (
                "[parameters]\na = { from = 1, to = 1000, step = 1 }\nb = { from = 1, to = 2000, step = 1 }\n[options]\nseed = '{a}{b}'",
                "jobs.toml:1: scenes: these are more than 1000000 jobs",
            ),
        ] {
            let message = plan(&format!("{scenes}{text}"), None).unwrap_err();
            assert!(message.starts_with(words), "{text}: {message}");
        }
        let twice = plan(FILE, Some(rows(&["power", "power"], &[&["1", "2"]]))).unwrap_err();
        assert!(twice.starts_with("jobs.toml:3: csv: the name 'power' is taken"), "{twice}");
    }
}
