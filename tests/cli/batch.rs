//! `batch`: what jobs write, and that nothing is lost or done twice.

use std::collections::BTreeMap;
use std::fs;
use std::process::{Command, Stdio};
use std::time::Duration;

use super::{MATERIALS, Place, ROOM};

/// Eight quick jobs.
pub const JOBS: &str = "\
scenes = 'room.obj'
name = '{power}-{seed}'
points = 'P.csv'
[parameters]
power = [0.5, 2]
seed = { from = 1, to = 4, step = 1 }
[options]
error = 0.3
seed = '{seed}'
[materials.lamp]
exitance_factor = '{power}'
[materials.wall]
reflectance = [0.3, 0.5, 0.25]
[outputs]
solution = '{name}.solution'
values = 'values/{name}.csv'
image = '{name}.exr'
[picture]
size = '16x12'
";

pub const COUNT: usize = 8;

impl Place {
    /// With a file of jobs.
    pub fn with_jobs(jobs: &str) -> Self {
        let place = Self::new();
        fs::write(place.path("jobs.toml"), jobs).unwrap();
        place
    }

    /// All that a batch wrote into a folder, but what is not the same in every run: times and journals.
    pub fn results(&self, folder: &str) -> BTreeMap<String, Vec<u8>> {
        let mut found = BTreeMap::new();
        for below in [folder.to_owned(), format!("{folder}/values")] {
            for entry in fs::read_dir(self.path(&below)).unwrap().map(Result::unwrap) {
                let name = format!("{below}/{}", entry.file_name().to_str().unwrap()).replacen(folder, "", 1);
                // What a killed process left of a file is removed later by another one.
                let is_same = ![".journal", ".times.csv", ".partial"].iter().any(|end| name.ends_with(end));
                if is_same && entry.file_type().unwrap().is_file() {
                    found.insert(name, fs::read(entry.path()).unwrap());
                }
            }
        }
        found
    }

    /// Lines of a journal: jobs that have ended.
    pub fn noted(&self, journal: &str) -> usize {
        fs::read_to_string(self.path(journal)).map_or(0, |text| text.lines().count())
    }
}

/// Tables of all jobs: CSV, and Parquet where it is built.
const TABLES: usize = 1 + cfg!(feature = "parquet") as usize;

/// Results, as one process and one thread make them.
pub fn expected(place: &Place) -> BTreeMap<String, Vec<u8>> {
    place.run("batch jobs.toml -o once --threads 1").succeeded();
    let expected = place.results("once");
    assert_eq!(expected.len(), 3 * COUNT + TABLES, "{:?}", expected.keys());
    expected
}

#[test]
fn a_job_writes_what_solve_writes_of_a_scene_that_says_the_same() {
    let place = Place::with_jobs(JOBS);
    let results = expected(&place);
    let changed = MATERIALS.replace("Kd 0.6 0.5 0.4", "Kd 0.3 0.5 0.25").replace("Ke 5 5 5", "Ke 10 10 10");
    fs::write(place.path("room.mtl"), changed).unwrap();
    let solve = "solve room.obj --error 0.3 --seed 3 -o s.solution --points P.csv --values V.csv --image a.exr --size 16x12";
    place.run(&format!("{solve} --report r.json")).succeeded();
    for (of_job, alone) in [("/2-3.solution", "s.solution"), ("/values/2-3.csv", "V.csv"), ("/2-3.exr", "a.exr")] {
        assert!(results[of_job] == fs::read(place.path(alone)).unwrap(), "{of_job}");
    }

    // The table tells of each job, in the order of the plan.
    let table = place.read("once/jobs.results.csv");
    let names: Vec<&str> = table.lines().map(|line| line.split(',').next().unwrap()).collect();
    assert_eq!(names, ["name", "0.5-1", "0.5-2", "0.5-3", "0.5-4", "2-1", "2-2", "2-3", "2-4"]);
    let report: serde_json::Value = serde_json::from_str(&place.read("r.json")).unwrap();
    let claimed = report["error"]["estimate"].as_f64().unwrap();
    assert!(table.contains(&format!("\n2-3,room.obj,2,3,0,error,local,0.3,{claimed},0.975,0,\n")), "{claimed}: {table}");
    assert_eq!(place.read("once/jobs.times.csv").lines().count(), COUNT + 1);
}

#[test]
fn lanes_threads_and_shards_change_no_byte() {
    let place = Place::with_jobs(JOBS);
    let expected = expected(&place);
    place.run("batch jobs.toml -o lanes --jobs 3 --threads 5").succeeded();
    assert!(place.results("lanes") == expected);
    place.run("batch jobs.toml -o threads --jobs 1 --threads 3").succeeded();
    assert!(place.results("threads") == expected);

    // Shards of three; what is missing is told until all are there.
    place.run("batch jobs.toml -o shards --shard 0/3").succeeded();
    place.run("batch jobs.toml -o shards --shard 2/3").succeeded();
    place.run("batch merge jobs.toml -o shards").failed(6, &["3 of 8 jobs have no results", "0.5-2, 2-1, 2-4", "--resume"]);
    place.run("batch jobs.toml -o shards --shard 1/3").succeeded();
    assert!(!place.path("shards/jobs.results.csv").exists());
    place.run("batch merge jobs.toml -o shards").succeeded();
    assert!(place.results("shards") == expected);

    // One process that goes on where shards were has nothing to do.
    place.run("batch jobs.toml -o shards --resume").succeeded();
    assert_eq!(place.noted("shards/jobs.0-of-1.journal"), 0);
    assert!(place.results("shards") == expected);
}

#[test]
fn killed_at_any_time_and_resumed_it_comes_to_the_same_bytes() {
    let place = Place::with_jobs(JOBS);
    let expected = expected(&place);
    let journal = "killed/jobs.0-of-1.journal";
    let mut noted = 0;
    for (kill, resume) in ["--anew", "--resume", "--resume"].into_iter().enumerate() {
        let mut child = Command::new(env!("CARGO_BIN_EXE_patchlight"))
            .args(["batch", "jobs.toml", "-o", "killed", "--threads", "2", resume])
            .current_dir(place.path(""))
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        // Somewhere in the job after the next, at another place each time.
        while place.noted(journal) <= noted && child.try_wait().unwrap().is_none() {
            std::thread::sleep(Duration::from_millis(1));
        }
        std::thread::sleep(Duration::from_millis(17 * kill as u64));
        child.kill().unwrap();
        child.wait().unwrap();
        noted = place.noted(journal);
    }
    // Nothing that was noted is done again: at the end there is a line for each job, but for what was cut off.
    let before = fs::read_to_string(place.path(journal)).unwrap();
    place.run("batch jobs.toml -o killed --resume").succeeded();
    let after = fs::read_to_string(place.path(journal)).unwrap();
    assert!(after.starts_with(&before));
    let whole = after.lines().filter(|line| serde_json::from_str::<serde_json::Value>(line).is_ok()).count();
    assert_eq!(whole, COUNT);
    let results = place.results("killed");
    assert_eq!(Vec::from_iter(results.keys()), Vec::from_iter(expected.keys()));
    assert!(results == expected);
}

#[test]
fn what_is_done_is_known_by_inputs_options_and_files() {
    let place = Place::with_jobs(JOBS);
    let expected = expected(&place);
    let journal = "once/jobs.0-of-1.journal";
    assert_eq!(place.noted(journal), COUNT);
    place.run("batch jobs.toml -o once").failed(2, &["jobs.0-of-1.journal tells of results", "--resume", "--anew"]);

    // Nothing has changed; then a file is damaged, and one is lost.
    place.run("batch jobs.toml -o once --resume").succeeded();
    assert_eq!(place.noted(journal), COUNT);
    fs::write(place.path("once/2-1.exr"), "damaged").unwrap();
    fs::remove_file(place.path("once/values/0.5-1.csv")).unwrap();
    place.run("batch merge jobs.toml -o once").failed(6, &["2 of 8 jobs", "0.5-1, 2-1"]);
    place.run("batch jobs.toml -o once --resume").succeeded();
    assert_eq!(place.noted(journal), COUNT + 2);
    assert!(place.results("once") == expected);

    // An option of all, the points, the materials of the scene: all jobs are done again.
    for (input, from, to) in
        [("jobs.toml", "error = 0.3", "error = 0.25"), ("P.csv", "1,0,1", "1,0,1.5"), ("room.mtl", "Ke 5 5 5", "Ke 5 5 4")]
    {
        fs::write(place.path(input), place.read(input).replace(from, to)).unwrap();
        let before = place.noted(journal);
        place.run("batch merge jobs.toml -o once").failed(6, &["8 of 8 jobs"]);
        place.run("batch jobs.toml -o once --resume").succeeded();
        assert_eq!(place.noted(journal), before + COUNT, "{input}");
    }
    let again = place.results("once");
    place.run("batch jobs.toml -o once --anew").succeeded();
    assert_eq!(place.noted(journal), COUNT);
    assert!(place.results("once") == again && again != expected);
}

#[test]
fn a_job_that_fails_fails_alone() {
    let jobs = "scenes = ['room.obj', 'broken.obj', 'other.obj']\nname = '{scene}'\n[options]\nerror = 0.3\n\
                [materials.lamp]\nexitance = 20\n[outputs]\nsolution = '{name}.s'\n";
    let place = Place::with_jobs(jobs);
    fs::write(place.path("broken.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 zero\nf 1 2 3\n").unwrap();
    fs::write(place.path("other.obj"), ROOM.replace("room.mtl", "other.mtl").replace("lamp", "light")).unwrap();
    fs::write(place.path("other.mtl"), MATERIALS.replace("lamp", "light")).unwrap();
    let ran = place.run("batch jobs.toml --retries 3");
    ran.failed(
        6,
        &[
            "job 'broken' failed with exit code 3: broken.obj:3",
            "job 'other' failed with exit code 3: jobs.toml:6: materials.lamp.exitance",
        ],
    );
    let table = place.read("jobs.results.csv");
    let rows: Vec<&str> = table.lines().collect();
    assert!(rows[1].starts_with("room,room.obj,0,error,"), "{table}");
    assert!(
        rows[2].starts_with("broken,broken.obj,3,,,,,,,\"broken.obj:3")
            || rows[2].starts_with("broken,broken.obj,3,,,,,,,broken.obj:3"),
        "{table}"
    );
    assert!(rows[3].contains("the scene has no such material; it has light, wall"), "{table}");
    assert!(place.path("room.s").exists() && !place.path("broken.s").exists());

    // Repaired, they are done, and the first is not done again.
    fs::write(place.path("broken.obj"), ROOM).unwrap();
    fs::write(place.path("other.mtl"), MATERIALS).unwrap();
    fs::write(place.path("other.obj"), ROOM).unwrap();
    let before = place.noted("jobs.0-of-1.journal");
    place.run("batch jobs.toml --resume").succeeded();
    assert_eq!(place.noted("jobs.0-of-1.journal"), before + 2);
    assert!(place.path("broken.s").exists() && place.path("other.s").exists());
}

/// A file on a full disk.
#[cfg(target_os = "linux")]
#[test]
fn what_the_machine_fails_in_is_tried_again() {
    let place = Place::with_jobs(
        "scenes = 'room.obj'\n[parameters]\nseed = [1, 2]\n[options]\nerror = 0.3\nseed = '{seed}'\n[outputs]\nsolution = '{seed}.s'\n",
    );
    std::os::unix::fs::symlink("/dev/full", place.path("1.s")).unwrap();
    place.run("batch jobs.toml --retries 2").failed(6, &["job '1' failed with exit code 1: ", "No space left on device"]);
    let attempts: Vec<String> =
        place.read("jobs.times.csv").lines().map(|line| line.rsplit(',').next().unwrap().to_owned()).collect();
    assert_eq!(attempts, ["attempts", "3", "1"]);
    fs::remove_file(place.path("1.s")).unwrap();
    place.run("batch jobs.toml --resume").succeeded();
    assert_eq!(place.noted("jobs.0-of-1.journal"), 3);
}

#[test]
fn limits_end_a_job_and_its_row_says_so() {
    let place = Place::with_jobs(
        "scenes = 'room.obj'\n[parameters]\nlinks = [1, 1000000]\n[options]\nerror = 0.3\nsolver = 'links'\nmax_links = '{links}'\n",
    );
    let ran = place.run("batch jobs.toml -o made/for/it");
    assert_eq!(ran.code, 4, "{}", ran.stderr);
    let table = place.read("made/for/it/jobs.results.csv");
    assert!(table.contains("\n1,room.obj,1,4,max_links,") && table.contains("\n2,room.obj,1000000,0,error,"), "{table}");
}

#[test]
fn a_bad_file_of_jobs_ends_with_3_and_names_line_and_key() {
    let place = Place::with_jobs("");
    let with = |lines: &str| format!("scenes = 'room.obj'\n{lines}\n");
    for (jobs, words) in [
        ("", "jobs.toml: 'scenes' is missing"),
        ("scenes = room.obj", "jobs.toml:1: "),
        (&with("[options]\nerror = 2"), "jobs.toml:3: options.error: error is 2"),
        (&with("[options]\nthreads = 2"), "jobs.toml:3: options.threads: jobs share the threads"),
        (&with("[options]\ncolour = 'red'"), "jobs.toml:3: options.colour: unknown option 'colour'"),
        (&with("[parameters]\ne = [0.1, 2]\n[options]\nerror = '{e}'"), "jobs.toml:5: options.error: error is 2"),
        (&with("[options]\nbounds = 'guaranteed'\nstrategy = 'lazy94'"), "job '1': bounds is guaranteed"),
        (&with("[outputs]\nvalues = 'V.csv'"), "jobs.toml:3: outputs.values: 'points' must say where"),
        (&with("points = 'P.csv'"), "jobs.toml:2: points: values at points are written where"),
        (&with("[outputs]\nimage = 'a.gif'"), "a.gif: unknown extension"),
        (&with("[outputs]\nsolution = ['a', 'b']"), "jobs.toml:3: outputs.solution: name one file"),
        (&with("[outputs]\nsolution = 'room.obj'"), "jobs.toml:3: outputs.solution: ./room.obj is something else of this batch"),
        (&with("[outputs]\nsolution = 'jobs.results.csv'"), "jobs.toml:3: outputs.solution"),
        (
            &with("[outputs]\nimage = 'a.png'\n[picture]\nfrom = 'memory'"),
            "jobs.toml:5: picture.from: 'memory' must be mesh or gather",
        ),
        (&with("csv = 'missing.csv'"), "jobs.toml:2: csv: missing.csv: "),
        (&with("csv = 'P.csv'\npoints = '{z}'"), "points: values at points"),
    ] {
        fs::write(place.path("jobs.toml"), jobs).unwrap();
        let ran = place.run("batch jobs.toml");
        assert!((ran.code == 3 || ran.code == 2) && ran.stderr.contains(words), "{jobs}: {}: {}", ran.code, ran.stderr);
    }
    fs::write(place.path("rows.csv"), "a,b\n1,2\n3\n").unwrap();
    fs::write(place.path("jobs.toml"), with("csv = 'rows.csv'")).unwrap();
    place.run("batch jobs.toml").failed(3, &["jobs.toml:2: csv: rows.csv:3: there are 1 fields, and 2 names"]);
    place.run("batch missing.toml").failed(3, &["missing.toml"]);
    fs::write(place.path("jobs.toml"), JOBS).unwrap();
    for (flags, words) in [
        ("--shard 3/3", "shard is '3/3'"),
        ("--jobs 0", "at least 1"),
        ("--jobs 3 --threads 2", "a thread for each job"),
        ("--resume --anew", "--anew"),
    ] {
        place.run(&format!("batch jobs.toml {flags}")).failed(2, &[words]);
    }
    assert!(!place.path("jobs.results.csv").exists());
}

#[test]
fn the_plan_is_listed_without_being_done() {
    let place = Place::with_jobs(JOBS);
    let ran = place.run("batch jobs.toml --plan");
    let lines: Vec<&str> = ran.succeeded().stdout.lines().collect();
    assert_eq!((lines.len(), lines[0]), (COUNT + 1, "name,scene,power,seed,outputs"));
    assert_eq!(lines[1], "0.5-1,room.obj,0.5,1,0.5-1.solution values/0.5-1.csv 0.5-1.exr");
    assert_eq!(place.new_files(), ["jobs.toml"]);
    for help in ["batch --help", "batch merge --help"] {
        assert!(place.run(help).succeeded().stdout.contains("6  jobs of a batch failed"), "{help}");
    }
}

/// An interrupt lets jobs end that are at work; two give them up.
#[cfg(unix)]
#[test]
fn an_interrupt_ends_with_130_and_resume_goes_on() {
    let place = Place::with_jobs(JOBS);
    let expected = expected(&place);
    let (code, said) = place.run_until_signal_at("batch jobs.toml -o once --anew --threads 1", "\"event\":\"job\"", "INT");
    assert_eq!(code, Some(130), "{said}");
    assert!(said.contains("interrupted: ending the jobs"), "{said}");
    let noted = place.noted("once/jobs.0-of-1.journal");
    assert!((1..COUNT).contains(&noted), "{noted}");
    let (code, said) = place.run_until_signal_at("batch jobs.toml -o once --resume --threads 1", "\"event\":\"job\"", "TERM");
    assert_eq!(code, Some(130), "{said}");
    place.run("batch jobs.toml -o once --resume").succeeded();
    assert_eq!(place.noted("once/jobs.0-of-1.journal"), COUNT);
    assert!(place.results("once") == expected);
}
