//! Jobs as validated requests: what `patchlight solve` would make of the same text.

use std::fs;
use std::path::{Path, PathBuf};

use super::super::argument_groups::{
    PageArguments, PictureArguments, RunArguments, SettingArguments, TrustArguments, ViewArguments,
};
use super::super::arguments::SolveArguments;
use super::super::exit::Failure;
use super::super::progress::Voice;
use super::super::reader::Said;
use super::super::request::SolveRequest;
use super::super::settings::Settings;
use super::plan::Job;
use super::stock::{Stock, Wanted};

/// A job that is ready to be done.
pub struct Task {
    /// What it is.
    pub job: Job,
    /// What is asked of the solve.
    pub request: SolveRequest,
    /// The number of its scene in the stock.
    pub scene: usize,
}

/// What all jobs have in common.
pub struct Common<'a> {
    /// Paths of inputs are relative to this folder.
    pub inputs: &'a Path,
    /// Paths of outputs are relative to this one.
    pub results: &'a Path,
    /// The backend, if it was named.
    pub backend: Option<String>,
    /// How scenes are read.
    pub trust: TrustArguments,
}

impl Task {
    /// Whether it changes materials alone, and shares what paths bring with the jobs that do.
    pub fn shares_transport(&self) -> bool {
        self.request.options.keep_transport && !self.job.changes.is_empty()
    }
}

impl Common<'_> {
    /// The jobs, validated; their scenes are wanted of `stock`. Folders of outputs are made.
    pub fn tasks(&self, jobs: Vec<Job>, stock: &mut Stock) -> Result<Vec<Task>, Failure> {
        jobs.into_iter().map(|job| self.task(job, stock)).collect()
    }

    fn task(&self, job: Job, stock: &mut Stock) -> Result<Task, Failure> {
        check_options(&job)?;
        for output in &job.outputs {
            let path = self.results.join(&output.text);
            let folder = path.parent().unwrap_or(self.results);
            fs::create_dir_all(folder).map_err(|error| output.wrong(format_args!("cannot make {}: {error}", folder.display())))?;
        }
        let of_job = |failure: Failure| Failure { message: format!("job '{}': {}", job.name, failure.message), ..failure };
        let mut request = SolveRequest::new(self.arguments(&job)?).map_err(of_job)?;
        request.voice = Voice::Job;
        let (path, lights) = (request.scene.clone(), request.import.lights.clone());
        let wanted = Wanted { path, lights, sides: request.import.sides, backend: request.run.backend };
        Ok(Task { scene: stock.want(wanted), job, request })
    }

    /// What would be typed for this job.
    fn arguments(&self, job: &Job) -> Result<SolveArguments, Failure> {
        let outputs = |kind: &str| -> Vec<PathBuf> {
            job.outputs.iter().filter(|output| output.key == kind).map(|output| self.results.join(&output.text)).collect()
        };
        let output = |kind: &str| match &outputs(kind)[..] {
            [] => Ok(None),
            [one] => Ok(Some(one.clone())),
            _ => Err(Failure::bad_input(format_args!("{}: name one file", place_of(&job.outputs, kind)))),
        };
        let points = job.points.as_ref().map(|said| self.inputs.join(&said.text));
        let values = output("values")?;
        match (&job.points, &values) {
            (Some(points), None) => return Err(points.wrong("values at points are written where 'outputs.values' says")),
            (None, Some(_)) => {
                return Err(Failure::bad_input(format_args!("{}: 'points' must say where", place_of(&job.outputs, "values"))));
            }
            _ => {}
        }
        let flag = |key: &str| job.picture.iter().find(|said| said.key == key).map(|said| said.text.clone());
        let from = job.picture.iter().find(|said| said.key == "from").map(parse_from).transpose()?;
        Ok(SolveArguments {
            scene: self.inputs.join(&job.scene),
            output: output("solution")?,
            settings: SettingArguments {
                set: job.options.iter().map(|said| format!("{}={}", said.key, said.text)).collect(),
                ..SettingArguments::default()
            },
            light_groups: None,
            lights: job.lights.as_ref().map(|said| self.inputs.join(&said.text)),
            trust: self.trust,
            image: outputs("image"),
            picture: PictureArguments {
                view: ViewArguments { camera: flag("camera"), size: flag("size") },
                exposure: flag("exposure"),
                quantity: flag("quantity"),
                from,
                scale: flag("scale"),
                show: flag("show"),
            },
            mesh: output("mesh")?,
            points,
            values,
            report: None,
            // It tells the times of the run, and results are the same bytes.
            html: None,
            page: PageArguments::default(),
            plots: None,
            run: RunArguments { backend: self.backend.clone(), ..RunArguments::default() },
        })
    }
}

/// Options by themselves, so that what is wrong is told with its line.
fn check_options(job: &Job) -> Result<(), Failure> {
    let mut settings = Settings::default();
    for said in &job.options {
        if said.key == "threads" {
            return Err(said.wrong("jobs share the threads of 'patchlight batch --threads N'"));
        }
        settings.set(&said.key, &said.text).map_err(|failure| said.wrong(failure.message))?;
    }
    Ok(())
}

fn place_of<'a>(texts: &'a [Said], key: &str) -> &'a str {
    texts.iter().find(|said| said.key == key).map_or("", |said| &said.place)
}

fn parse_from(said: &Said) -> Result<super::super::argument_groups::Whence, Failure> {
    clap::ValueEnum::from_str(&said.text, false).map_err(|_| said.wrong(format_args!("'{}' must be mesh or gather", said.text)))
}
