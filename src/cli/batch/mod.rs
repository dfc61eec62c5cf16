//! `patchlight batch`: many jobs from one file, which `job_file` shows.
//!
//! The file becomes a [plan], the plan's jobs become [tasks], lanes do them side by side, a [journal] keeps what is done, and a [table] tells
//! all. Bytes of results are the same for any number of lanes, threads and shards.

mod identity;
mod job_file;
mod journal;
mod lanes;
mod parameters;
#[cfg(feature = "parquet")]
mod parquet;
mod plan;
mod shared_transport;
mod stock;
mod table;
mod tasks;
mod teller;
mod template;
mod work;

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use patchlight::output::Destination;

use super::batch_arguments::{BatchArguments, BatchCommand, MergeArguments, PlaceArguments, WorkArguments};
use super::exit::{Exit, Failure};
use super::files;
use super::interrupt;
use super::process;
use super::progress::Voice;
use super::ranks::{self, Deal};
use super::settings::run_options;
use job_file::JobFile;
use journal::{Journal, Record};
use lanes::{Lanes, Mode, deal};
use parameters::read_rows;
use plan::{Job, Plan};
use shared_transport::Transports;
use stock::Stock;
use table::Table;
use tasks::{Common, Task};
use teller::Teller;

/// So many jobs are named in a message; `--plan` lists all.
const NAMED: usize = 10;

/// `patchlight batch`.
pub fn batch(typed: BatchArguments) -> Result<Exit, Failure> {
    let BatchArguments { command, file, place, work } = typed;
    match (command, file) {
        (Some(BatchCommand::Merge(MergeArguments { file, place })), _) => Batch::read(file, place)?.merge(),
        (None, Some(file)) => Batch::read(file, place)?.work(&work),
        (None, None) => Err(Failure::usage("name a file of jobs")),
    }
}

/// A file of jobs, and where its results go.
struct Batch {
    file: PathBuf,
    /// Names of tables and journals begin with that of the file.
    stem: String,
    inputs: PathBuf,
    results: PathBuf,
    csv: Option<PathBuf>,
    plan: Plan,
    place: PlaceArguments,
    voice: Voice,
}

impl Batch {
    /// Reads the file and makes its plan.
    fn read(file: PathBuf, place: PlaceArguments) -> Result<Self, Failure> {
        let name = file.display();
        let text = fs::read_to_string(&file).map_err(|error| Failure::bad_input(format_args!("{name}: {error}")))?;
        let jobs = JobFile::parse(&file, &text)?;
        let inputs = file.parent().unwrap_or(Path::new("")).to_owned();
        let csv = jobs.csv.as_ref().map(|said| inputs.join(&said.text));
        let rows = jobs.csv.as_ref().zip(csv.as_ref()).map(|(said, path)| read_rows(said, path)).transpose()?;
        let plan = Plan::new(&jobs, rows)?;
        let in_same_folder = if inputs.as_os_str().is_empty() { PathBuf::from(".") } else { inputs.clone() };
        let results = place.output.clone().unwrap_or(in_same_folder);
        let stem = file.file_stem().map_or(String::new(), |stem| stem.to_string_lossy().into_owned());
        let voice = Voice::new(place.run.progress);
        let batch = Self { file, stem, inputs, results, csv, plan, place, voice };
        batch.check_outputs()?;
        Ok(batch)
    }

    /// No job writes what another reads, or what is told of all.
    fn check_outputs(&self) -> Result<(), Failure> {
        let of_jobs = self.plan.jobs.iter().flat_map(|job| [Some(&job.scene), job.points.as_ref().map(|said| &said.text)]);
        let inputs = of_jobs.flatten().map(|text| self.inputs.join(text)).chain([self.file.clone()]).chain(self.csv.clone());
        let read: BTreeSet<PathBuf> = inputs.filter_map(|path| fs::canonicalize(path).ok()).collect();
        for output in self.plan.jobs.iter().flat_map(|job| &job.outputs) {
            let is_told_of_all = output.text.starts_with(&format!("{}.", self.stem))
                && [".journal", ".results.csv", ".times.csv", ".results.parquet"].iter().any(|end| output.text.ends_with(end));
            let path = self.results.join(&output.text);
            if is_told_of_all || fs::canonicalize(&path).is_ok_and(|path| read.contains(&path)) {
                return Err(output.wrong(format_args!("{} is something else of this batch: choose another name", path.display())));
            }
        }
        Ok(())
    }

    /// Does the jobs, or those of a shard.
    fn work(self, how: &WorkArguments) -> Result<Exit, Failure> {
        if how.plan {
            files::to_stdout(|writer| Table::of_plan(&self.plan).write(writer))?;
            return Ok(Exit::Done);
        }
        let shard = how.shard.as_deref().map_or(Ok(WHOLE), parse_shard)?;
        let (rank, size) = (ranks::team().rank(), ranks::size());
        let [index, count] = shard;
        let of_shard = self.plan.jobs.iter().enumerate().filter(|(number, _)| number % count == index).map(|(_, job)| job.clone());
        let mut stock = Stock::new(self.place.trust, self.voice);
        let tasks = self.tasks(of_shard.collect(), &mut stock)?;

        // What was done before.
        let made = fs::create_dir_all(&self.results);
        made.map_err(|error| Failure::usage(format_args!("cannot make {}: {error}", self.results.display())))?;
        let of_process = if size > 1 { [rank, size] } else { shard };
        let path = self.results.join(journal::name(&self.stem, of_process));
        if !how.resume && !how.anew && fs::metadata(&path).is_ok_and(|found| found.len() > 0) {
            let path = path.display();
            return Err(Failure::usage(format_args!(
                "{path} tells of results: --resume keeps those that still hold, --anew does all jobs again"
            )));
        }
        let known = if how.resume { journal::read_all(&self.results, &self.stem)? } else { BTreeMap::new() };
        let journal = Journal::open(path, how.anew)?;

        // The jobs.
        let threads = self.lanes(how.jobs, tasks.len())?;
        self.tell_plan(shard, &tasks, &known, &threads);
        interrupt::listen(interrupt::OF_BATCH);
        let teller = Teller::new(self.voice, tasks.len(), ranks::sum(threads.len() as f64) as usize);
        let mode = Mode::Work { journal: &journal, retries: how.retries };
        let deal = Deal::new(if size > 1 { longest_first(&tasks) } else { (0..tasks.len()).collect() });
        let lanes =
            Lanes { tasks: &tasks, stock: &stock, results: &self.results, known: &known, mode, teller: &teller, deal: &deal };
        let records = lanes.run(&threads)?;
        drop(teller);

        // All of them together.
        let done = || records.iter().map(|(&number, record)| (&tasks[number].job, record));
        if shard == WHOLE && ranks::is_first() {
            self.write_tables(done)?;
        } else if shard != WHOLE {
            let file = self.file.display();
            self.voice.figure(
                "shard",
                format_args!("{index}/{count} has ended; 'patchlight batch merge {file}' makes the tables of all"),
            );
        }
        self.tell_end(&tasks, &records);
        Ok(if records.len() < tasks.len() { Exit::Cancelled } else { exit_of(records.values()) })
    }

    /// Makes the tables of what all shards have done, and checks that nothing is missing.
    fn merge(self) -> Result<Exit, Failure> {
        let mut stock = Stock::new(self.place.trust, self.voice);
        let tasks = self.tasks(self.plan.jobs.clone(), &mut stock)?;
        let known = journal::read_all(&self.results, &self.stem)?;
        let teller = Teller::new(self.voice, tasks.len(), 1);
        let (results, mode) = (&self.results, Mode::Look);
        let deal = Deal::new((0..tasks.len()).collect());
        let lanes = Lanes { tasks: &tasks, stock: &stock, results, known: &known, mode, teller: &teller, deal: &deal };
        let records = lanes.run(&self.lanes(Some(1), tasks.len())?)?;
        drop(teller);

        let missing: Vec<&str> = tasks
            .iter()
            .enumerate()
            .filter(|(number, _)| !records.contains_key(number))
            .map(|(_, task)| task.job.name.as_str())
            .collect();
        if !missing.is_empty() {
            let (count, all, names) = (missing.len(), tasks.len(), missing[..missing.len().min(NAMED)].join(", "));
            let message = format!(
                "{count} of {all} jobs have no results, or none that fit the file as it is now: {names}{}; \
                 'patchlight batch --resume', with --shard as it was, does them",
                if count > NAMED { ", ..." } else { "" }
            );
            return Err(Failure { exit: Exit::JobsFailed, message });
        }
        self.write_tables(|| records.iter().map(|(&number, record)| (&tasks[number].job, record)))?;
        self.tell_end(&tasks, &records);
        Ok(exit_of(records.values()))
    }

    fn tasks(&self, jobs: Vec<Job>, stock: &mut Stock) -> Result<Vec<Task>, Failure> {
        let PlaceArguments { trust, run, .. } = &self.place;
        Common { inputs: &self.inputs, results: &self.results, backend: run.backend.clone(), trust: *trust }.tasks(jobs, stock)
    }

    /// The threads of each lane: if not told otherwise, there is a lane for each thread.
    fn lanes(&self, wanted: Option<usize>, jobs: usize) -> Result<Vec<usize>, Failure> {
        let asked = run_options(&self.place.run)?.threads;
        let threads = if asked > 0 { asked } else { std::thread::available_parallelism().map_or(1, usize::from) };
        match wanted {
            Some(0) => Err(Failure::usage("--jobs must be at least 1")),
            Some(lanes) if asked > 0 && lanes > asked => {
                Err(Failure::usage(format_args!("--jobs {lanes} needs a thread for each job, and --threads is {asked}")))
            }
            _ => Ok(deal(threads, wanted.unwrap_or(threads).min(jobs).max(1))),
        }
    }

    fn tell_plan(&self, [index, count]: [usize; 2], tasks: &[Task], known: &BTreeMap<String, Record>, threads: &[usize]) {
        let before = tasks.iter().filter(|task| known.get(&task.job.name).is_some_and(Record::has_results)).count();
        let of_shard = if count == 1 { String::new() } else { format!(" in shard {index}/{count}") };
        let noted = if before == 0 { String::new() } else { format!("; {before} are noted as done, which is checked") };
        let (jobs, lanes, in_all) = (tasks.len(), threads.len(), threads.iter().sum::<usize>());
        self.voice.figure("plan", format_args!("{jobs} jobs{of_shard}, {lanes} at a time; threads in all: {in_all}{noted}"));
        let over_transport: Vec<&Task> = tasks.iter().filter(|task| task.shares_transport()).collect();
        if !over_transport.is_empty() {
            let solves: BTreeSet<(usize, String)> =
                over_transport.iter().map(|task| (task.scene, Transports::key(&task.request.options, &task.request.run))).collect();
            let (count, solves) = (over_transport.len(), solves.len());
            self.voice.figure(
                "transport",
                format_args!("{count} jobs change materials alone, over the stored transport of {solves} solves"),
            );
        }
        for task in tasks.iter().take(NAMED) {
            let Job { name, scene, values, .. } = &task.job;
            let values: Vec<String> =
                self.plan.parameters.iter().zip(values).map(|(name, value)| format!(" {name}={value}")).collect();
            self.voice.figure("job", format_args!("'{name}': {scene}{}", values.concat()));
        }
        if jobs > NAMED {
            self.voice.figure("job", format_args!("and {} more; --plan lists all", jobs - NAMED));
        }
    }

    fn tell_end(&self, tasks: &[Task], records: &BTreeMap<usize, Record>) {
        let failed = records.values().filter(|record| !record.has_results()).count();
        let (done, left) = (records.len() - failed, tasks.len() - records.len());
        let cpu = process::cpu_seconds().map_or(String::new(), |cpu_s| format!("; {cpu_s:.2} CPU-s"));
        self.voice.figure("batch", format_args!("{done} jobs are done, {failed} failed, {left} are left{cpu}"));
    }

    /// Writes the table of results, and that of times.
    fn write_tables<'a, D: Iterator<Item = (&'a Job, &'a Record)>>(&self, done: impl Fn() -> D) -> Result<(), Failure> {
        let results = Table::of_results(&self.plan, done());
        let write = |end: &str, table: &Table| {
            let path = self.results.join(format!("{}.{end}", self.stem));
            Destination::new(&path)?.write(|file| table.write(file))?;
            self.voice.figure("wrote", format_args!("{} ({} jobs)", path.display(), table.rows.len()));
            Ok::<(), Failure>(())
        };
        write("results.csv", &results)?;
        write("times.csv", &Table::of_costs(done()))?;
        #[cfg(feature = "parquet")]
        Destination::new(&self.results.join(format!("{}.results.parquet", self.stem)))?
            .write(|file| parquet::write(&results, file))?;
        Ok(())
    }
}

/// The numbers of tasks, those first that are likely to take long: what takes long at the end keeps others waiting.
fn longest_first(tasks: &[Task]) -> Vec<usize> {
    let bytes = |task: &Task| fs::metadata(&task.request.scene).map_or(0, |file| file.len());
    in_order(&tasks.iter().map(|task| (bytes(task), task.scene, task.request.options.error)).collect::<Vec<_>>())
}

/// The indices of jobs by the bytes and the number of their scene and the error that is asked for: large scenes first, all jobs of a scene together,
/// of these small errors first.
fn in_order(jobs: &[(u64, usize, f64)]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..jobs.len()).collect();
    order.sort_by(|&a, &b| {
        let [(bytes_a, scene_a, error_a), (bytes_b, scene_b, error_b)] = [jobs[a], jobs[b]];
        bytes_b.cmp(&bytes_a).then(scene_a.cmp(&scene_b)).then(error_a.total_cmp(&error_b))
    });
    order
}

/// The shard that is all.
const WHOLE: [usize; 2] = [0, 1];

/// `i/n`, counted from 0.
fn parse_shard(text: &str) -> Result<[usize; 2], Failure> {
    let numbers = text.split_once('/').and_then(|(index, count)| Some([index.parse().ok()?, count.parse().ok()?]));
    numbers.filter(|[index, count]| index < count).ok_or_else(|| {
        Failure::usage(format_args!("shard is '{text}', it must be a number and how many there are, as in 0/3, 1/3 and 2/3"))
    })
}

/// How a batch ends in which all jobs have ended.
fn exit_of<'a>(mut records: impl Iterator<Item = &'a Record> + Clone) -> Exit {
    let is_limited = |record: &Record| record.exit != Exit::Done as u8;
    if records.clone().any(|record| !record.has_results()) {
        Exit::JobsFailed
    } else if records.any(is_limited) {
        Exit::Limit
    } else {
        Exit::Done
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_are_counted_from_0() {
        assert_eq!(parse_shard("2/3").unwrap(), [2, 3]);
        for text in ["3/3", "1", "0/0", "-1/3", "a/b", "1/3/4"] {
            assert_eq!(parse_shard(text).unwrap_err().exit, Exit::Usage, "{text}");
        }
    }

    #[test]
    fn what_takes_long_comes_first_and_jobs_of_a_scene_together() {
        let jobs = [(10, 0, 0.1), (99, 2, 0.1), (10, 1, 0.02), (10, 0, 0.1), (99, 2, 0.05), (10, 0, 0.02)];
        assert_eq!(in_order(&jobs), [4, 1, 5, 0, 3, 2]);
        assert!(in_order(&[]).is_empty());
    }

    #[test]
    fn a_batch_ends_as_badly_as_its_worst_job() {
        let done = |exit: u8| Record { exit, identity: Some(String::new()), ..Record::default() };
        let failed = Record { exit: 3, ..Record::default() };
        assert_eq!(exit_of([done(0), done(0)].iter()), Exit::Done);
        assert_eq!(exit_of([done(0), done(4)].iter()), Exit::Limit);
        assert_eq!(exit_of([done(5), failed].iter()), Exit::JobsFailed);
    }
}
