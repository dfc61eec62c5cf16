//! All that flags and `--set` reach: collected first, then judged together, so that their order does not matter.

use patchlight::scene::Sides;
use patchlight::solve::{Interest, RunOptions, SolveOptions};

use super::argument_groups::{RunArguments, SettingArguments};
use super::exit::Failure;
use super::stderr::say;

/// What is asked of a solve, and how it runs.
#[derive(Default)]
pub struct Settings {
    pub options: SolveOptions,
    pub run: RunOptions,
    pub sides: Sides,
}

impl Settings {
    /// Of a solve. Of two values that `--set` gives for a key the last one counts; a flag and `--set` for the same key contradict each
    /// other. `camera` is that of the picture.
    pub fn new(typed: &SettingArguments, run: &RunArguments, camera: Option<&str>) -> Result<Self, Failure> {
        // Each by itself.
        let mut settings = Self { run: run_options(run)?, ..Self::default() };
        for (key, value) in typed.flags() {
            settings.set(key, value)?;
        }
        for setting in &typed.set {
            let (key, value) = setting
                .split_once('=')
                .ok_or_else(|| Failure::usage(format_args!("--set {setting}: write --set key=value, as in --set error=0.01")))?;
            let (key, value) = (key.trim(), value.trim());
            let of_run = [("threads", run.threads.is_some()), ("backend", run.backend.is_some())];
            let is_typed = typed.flags().any(|(flag, _)| flag == key) || of_run.contains(&(key, true));
            if is_typed {
                let flag = key.replace('_', "-");
                return Err(Failure::usage(format_args!(
                    "--set {setting} and --{flag} both say what {key} is: leave one of them out"
                )));
            }
            settings.set(key, value)?;
        }

        // All together. A view that says nothing more is that of the picture.
        if let (Interest::View(view), Some(camera)) = (&settings.options.importance, camera)
            && view.is_empty()
        {
            settings.set("importance", &format!("view {camera}"))?;
        }
        settings.options.validate().map_err(Failure::usage)?;
        Ok(settings)
    }

    /// Makes a solve find the lit mesh, unless it was said that it shall not.
    pub fn want_mesh(&mut self, typed: &SettingArguments) -> Result<(), Failure> {
        let is_key = |setting: &String| setting.split_once('=').is_some_and(|(key, _)| key.trim() == "lit_mesh");
        if let Some(setting) = typed.set.iter().rfind(|setting| is_key(setting)).filter(|_| !self.options.lit_mesh) {
            return Err(Failure::usage(format_args!("--set {setting} and --mesh contradict each other: leave one of them out")));
        }
        self.options.lit_mesh = true;
        Ok(())
    }

    /// Sets one option from text: those of the run here, all others by [`SolveOptions::set`].
    pub fn set(&mut self, key: &str, value: &str) -> Result<(), Failure> {
        match key {
            "sides" => self.sides = parse_sides(value)?,
            "backend" => self.run.backend = value.parse().map_err(Failure::usage)?,
            "threads" => {
                let threads = value.parse();
                self.run.threads = threads.map_err(|_| {
                    Failure::usage(format_args!("threads is '{value}', it must be a whole number, 0 for one per core"))
                })?;
                self.run.threads = useful_threads(self.run.threads);
            }
            "time" => limit(&mut self.run, Some(value), None)?,
            "memory" => limit(&mut self.run, None, Some(value))?,
            _ => self.options.set(key, value).map_err(Failure::usage)?,
        }
        Ok(())
    }
}

/// How a run goes by its flags.
pub fn run_options(typed: &RunArguments) -> Result<RunOptions, Failure> {
    let mut run = RunOptions { threads: typed.threads.unwrap_or(0), ..RunOptions::default() };
    if let Some(name) = &typed.backend {
        run.backend = name.parse().map_err(Failure::usage)?;
    }
    run.threads = useful_threads(run.threads);
    Ok(run)
}

/// Sets limits of a run, in seconds and in GB.
pub fn limit(run: &mut RunOptions, time: Option<&str>, memory: Option<&str>) -> Result<(), Failure> {
    let positive = |key: &str, value: &str, unit: &str| {
        let number = value.parse::<f64>().ok().filter(|x| x.is_finite() && *x > 0.0);
        number.ok_or_else(|| Failure::usage(format_args!("{key} is '{value}', it must be a number of {unit} above 0")))
    };
    if let Some(value) = time {
        run.time_s = Some(positive("time", value, "seconds")?);
    }
    if let Some(value) = memory {
        run.memory_bytes = Some((positive("memory", value, "GB")? * 1e9) as u64);
    }
    run.validate().map_err(Failure::usage)
}

/// No more threads than four for each core: more of them only wait for each other. The answer is the same.
fn useful_threads(threads: usize) -> usize {
    const OF_A_CORE: usize = 4;
    let most = OF_A_CORE * std::thread::available_parallelism().map_or(1, usize::from);
    if threads > most {
        say(format_args!("warning: {threads} threads are more than the cores can use: {most} are started"));
    }
    threads.min(most)
}

/// Sides by name.
pub fn parse_sides(text: &str) -> Result<Sides, Failure> {
    match text {
        "front" => Ok(Sides::Front),
        "both" => Ok(Sides::Both),
        _ => Err(Failure::usage(format_args!("sides is '{text}', it must be front or both"))),
    }
}
