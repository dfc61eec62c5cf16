//! Several processes, started by `mpirun`: they leave the bytes of one, and fail as one.

use std::fs;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use super::batch::{COUNT, JOBS, expected};
use super::{Place, Ran};

/// `patchlight` by so many processes of a thread each. More of them than cores are no error, and neither is root.
fn by_processes(place: &Place, count: usize, arguments: &str) -> Command {
    let mut command = Command::new("mpirun");
    command.args(["--oversubscribe", "-n", &count.to_string(), env!("CARGO_BIN_EXE_patchlight")]);
    command.args(arguments.split_whitespace()).args(["--threads", "1"]).current_dir(place.path(""));
    command.env("OMPI_ALLOW_RUN_AS_ROOT", "1").env("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1").stdin(Stdio::null());
    command
}

fn run_by(place: &Place, count: usize, arguments: &str) -> Ran {
    Ran::new(by_processes(place, count, arguments).output().expect("mpirun is there: the program was built with MPI"))
}

/// Solves a scene as `arguments` say by different numbers of processes, and holds all files that they write against those of one.
fn leaves_the_same_bytes(place: &Place, scene: &str, arguments: &str) {
    let outputs = ["s.solution", "V.csv", "a.exr"];
    let line = format!("solve {scene} {arguments} -o s.solution --points P.csv --values V.csv --image a.exr --size 32x24");
    place.run(&format!("{line} --threads 2 --report r.json")).succeeded();
    let expected = outputs.map(|name| fs::read(place.path(name)).unwrap());
    let rays = |report: &str| -> u64 {
        let report: serde_json::Value = serde_json::from_str(&place.read(report)).unwrap();
        report["counts"]["rays"].as_u64().unwrap()
    };
    for count in [2, 3, 5] {
        outputs.iter().for_each(|name| fs::remove_file(place.path(name)).unwrap());
        run_by(place, count, &format!("{line} --report by_many.json")).succeeded();
        for (name, expected) in outputs.iter().zip(&expected) {
            assert!(fs::read(place.path(name)).unwrap() == *expected, "{scene} {arguments}: {name} by {count} processes");
        }
        // What all do by themselves is little beside what they share.
        let of_many = rays("by_many.json");
        assert!(of_many >= rays("r.json") && of_many < 2 * rays("r.json"), "{of_many} rays for {}", rays("r.json"));
    }
}

#[test]
fn any_number_of_processes_leaves_the_bytes_of_one() {
    let place = Place::new();
    let scene = |name: &str| format!("{}/scenes/{name}.obj", env!("CARGO_MANIFEST_DIR"));
    leaves_the_same_bytes(&place, "room.obj", "--error 0.05");
    leaves_the_same_bytes(&place, &scene("two_rooms"), "--error 0.1 --set solver=cells");
    leaves_the_same_bytes(&place, &scene("two_rooms"), "--error 0.1 --set solver=links --sides both");
    leaves_the_same_bytes(&place, &scene("pyramid"), "--error 0.1 --lit-mesh");
}

#[test]
fn lightmaps_are_those_of_one_process() {
    let place = Place::new();
    let outputs = ["m.exr", "m.json", "v.ply"];
    for (input, more) in [("room.obj", "--error 0.2"), ("room.solution", "")] {
        let line = format!("bake {input} {more} --texel 0.1 -o m.exr --json m.json --per-vertex v.ply");
        place.run(&format!("{line} --threads 2")).succeeded();
        let expected = outputs.map(|name| fs::read(place.path(name)).unwrap());
        run_by(&place, 3, &line).succeeded();
        for (name, expected) in outputs.iter().zip(&expected) {
            assert!(fs::read(place.path(name)).unwrap() == *expected, "{name} of {input}");
        }
    }
}

#[test]
fn many_points_share_their_light_as_in_one_process() {
    // So many that they take indirect light from a cache.
    let place = Place::new();
    let points: String = (0..40_000)
        .map(|k| format!("{},0,{},0,1,0\n", 0.1 + 0.009 * f64::from(k % 200), 0.1 + 0.009 * f64::from(k / 200)))
        .collect();
    fs::write(place.path("P.csv"), format!("x,y,z,nx,ny,nz\n{points}")).unwrap();
    leaves_the_same_bytes(&place, "room.obj", "--error 0.1 --set solver=cells");
}

#[test]
fn what_several_processes_cannot_do_is_said_once() {
    let place = Place::new();
    let fails = |arguments: &str, code: i32, words: &str| {
        let ran = run_by(&place, 3, arguments);
        ran.failed(code, &[words]);
        assert_eq!(ran.stderr.matches("error: ").count(), 1, "{}", ran.stderr);
    };
    fails("solve room.obj --error 0.1 --time 3 -o s.solution", 2, "no limit of time");
    fails("bake room.solution -o m.exr --time 3", 2, "no limit of time");
    fails("solve no.obj -o s.solution", 3, "no.obj: cannot be read");
    fails("solve room.obj --points - --values V.csv", 2, "not from stdin");
    fails("render room.solution -o a.exr", 2, "without mpirun");
    fails("batch merge jobs.toml", 2, "without mpirun");
    assert!(place.new_files().is_empty(), "{:?}", place.new_files());
}

#[test]
fn processes_that_do_not_see_the_same_scene_end() {
    let place = Place::new();
    fs::create_dir(place.path("other")).unwrap();
    fs::write(place.path("other/room.obj"), place.read("room.obj").replace("v 0 0 0", "v 0 0 -0.1")).unwrap();
    fs::copy(place.path("room.mtl"), place.path("other/room.mtl")).unwrap();
    let script =
        "if [ $OMPI_COMM_WORLD_RANK = 1 ]; then cd other; fi; exec \"$0\" solve room.obj --error 0.1 --threads 1 -o s.solution";
    let mut command = Command::new("mpirun");
    command.args(["--oversubscribe", "-n", "2", "sh", "-c", script, env!("CARGO_BIN_EXE_patchlight")]).current_dir(place.path(""));
    command.env("OMPI_ALLOW_RUN_AS_ROOT", "1").env("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1");
    Ran::new(command.output().unwrap()).failed(2, &["not given the same scene"]);
    assert!(!place.path("s.solution").exists());
}

#[test]
fn jobs_are_dealt_out_and_leave_the_bytes_of_one_process() {
    let place = Place::with_jobs(JOBS);
    let expected = expected(&place);
    for count in [2, 4] {
        let folder = format!("by{count}");
        run_by(&place, count, &format!("batch jobs.toml -o {folder}")).succeeded();
        assert!(place.results(&folder) == expected);
        let of_each: Vec<usize> = (0..count).map(|rank| place.noted(&format!("{folder}/jobs.{rank}-of-{count}.journal"))).collect();
        assert_eq!(of_each.iter().sum::<usize>(), COUNT, "{of_each:?}");
        assert!(of_each.iter().filter(|&&jobs| jobs > 0).count() > 1, "{of_each:?}");
    }

    // Another number of processes, or one alone, goes on where these were.
    fs::remove_file(place.path("by4/values/2-3.csv")).unwrap();
    run_by(&place, 3, "batch jobs.toml -o by4 --resume").succeeded();
    assert!(place.results("by4") == expected);
    place.run("batch jobs.toml -o by4 --resume").succeeded();
    assert_eq!(place.noted("by4/jobs.0-of-1.journal"), 0);
}

#[test]
fn a_process_that_dies_ends_all_and_resume_goes_on() {
    let place = Place::with_jobs(&JOBS.replace("P.csv", "P{seed}.csv"));
    let points = place.read("P.csv");
    (1..=4).for_each(|seed| fs::write(place.path(&format!("P{seed}.csv")), &points).unwrap());
    let expected = expected(&place);

    // Jobs that wait for points that nobody writes: so all is not over before a process is killed.
    const WAITING: usize = 2;
    fs::remove_file(place.path("P4.csv")).unwrap();
    assert!(Command::new("mkfifo").arg(place.path("P4.csv")).status().unwrap().success());
    let noted = |place: &Place| (0..3).map(|rank| place.noted(&format!("killed/jobs.{rank}-of-3.journal"))).sum::<usize>();
    let mut before = 0;
    for how in ["--anew", "--resume"] {
        let mut all = by_processes(&place, 3, &format!("batch jobs.toml -o killed {how}"));
        let mut all: Child = all.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        while noted(&place) <= before && noted(&place) < COUNT - WAITING {
            assert!(all.try_wait().unwrap().is_none(), "ended by itself");
            std::thread::sleep(Duration::from_millis(1));
        }
        // One of the processes, not mpirun, once there is one.
        let kill = format!("pid=$(ps -o pid= --ppid {} | tail -n 1) && [ \"$pid\" ] && kill -KILL $pid", all.id());
        while !Command::new("sh").args(["-c", &kill]).status().unwrap().success() {
            assert!(all.try_wait().unwrap().is_none(), "ended by itself");
        }
        assert!(!all.wait().unwrap().success());
        before = noted(&place);
    }

    fs::remove_file(place.path("P4.csv")).unwrap();
    fs::write(place.path("P4.csv"), &points).unwrap();
    run_by(&place, 2, "batch jobs.toml -o killed --resume").succeeded();
    assert!(place.results("killed") == expected);
}

#[test]
fn a_launcher_that_mpi_does_not_know_is_told_of() {
    let place = Place::new();
    let mut command = Command::new(env!("CARGO_BIN_EXE_patchlight"));
    command.args(["solve", "room.obj", "--error", "0.3", "-o", "s.solution"]).current_dir(place.path(""));
    command.envs([("PMI_RANK", "0"), ("PMI_SIZE", "2")]).env("OMPI_ALLOW_RUN_AS_ROOT", "1");
    Ran::new(command.output().unwrap()).failed(2, &["started 2 processes, and MPI knows of 1"]);
    assert!(place.new_files().is_empty());
}

#[test]
fn jobs_of_several_scenes_are_dealt_out_too() {
    let jobs = "scenes = ['room.obj', 'other.obj', 'third.obj']\nname = '{scene}-{seed}'\n[parameters]\nseed = [1, 2, 3]\n\
                [options]\nerror = 0.3\nseed = '{seed}'\n[outputs]\nsolution = 'values/{name}.solution'\n";
    let place = Place::with_jobs(jobs);
    for (name, height) in [("other.obj", "1.9"), ("third.obj", "1.8")] {
        fs::write(place.path(name), place.read("room.obj").replace("1.99", height)).unwrap();
    }
    place.run("batch jobs.toml -o once --threads 1").succeeded();
    run_by(&place, 3, "batch jobs.toml -o by3").succeeded();
    assert!(place.results("by3") == place.results("once"));
}
