//! Several members of a team leave what one leaves. Here threads play processes, and exchange what they find through memory.

use std::sync::{Arc, Barrier, Mutex};

use patchlight::pipeline::{Evaluator, PipelineError, Workers, solve_on};
use patchlight::progress::Silent;
use patchlight::scene::import::{ImportOptions, read_scene};
use patchlight::scene::{Scene, SurfacePoint};
use patchlight::solve::{RunOptions, Solution, SolveOptions, SolveReport, Solver};
use patchlight::team::Team;

/// Where members leave what they give.
struct Table {
    given: Mutex<Vec<Vec<u8>>>,
    all_are_here: Barrier,
}

struct Member {
    table: Arc<Table>,
    rank: usize,
}

impl Team for Member {
    fn size(&self) -> usize {
        self.table.given.lock().unwrap().len()
    }

    fn rank(&self) -> usize {
        self.rank
    }

    fn exchange(&self, own: Vec<u8>) -> Vec<Vec<u8>> {
        self.table.given.lock().unwrap()[self.rank] = own;
        self.table.all_are_here.wait();
        let all = self.table.given.lock().unwrap().clone();
        self.table.all_are_here.wait();
        all
    }
}

/// What `work` gives to each of so many members, who get threads of their own and their number.
fn of_members<R: Send>(size: usize, work: impl Fn(Workers, usize) -> R + Sync) -> Vec<R> {
    let table = Arc::new(Table { given: Mutex::new(vec![Vec::new(); size]), all_are_here: Barrier::new(size) });
    std::thread::scope(|scope| {
        let member = |rank| {
            let (table, work) = (table.clone(), &work);
            scope.spawn(move || work(Workers::new(1).unwrap().in_team(Arc::new(Member { table, rank })), rank))
        };
        Vec::from_iter((0..size).map(member)).into_iter().map(|member| member.join().unwrap()).collect()
    })
}

fn scene(name: &str) -> Scene {
    read_scene(format!("scenes/{name}.obj").as_ref(), &ImportOptions::default()).expect("a scene that comes along").scene
}

fn solved(workers: Workers, name: &str, options: &SolveOptions) -> Result<(Evaluator, SolveReport), PipelineError> {
    solve_on(workers, scene(name), options, &RunOptions::default(), &Silent)
}

/// The solution, the radiosities at some points by [`f32::to_bits`], and the rays of all members.
type Found = (Solution, Vec<u32>, u64);

fn found(workers: Workers, name: &str, options: &SolveOptions) -> Found {
    let (lit, report) = solved(workers, name, options).unwrap();
    let surfaces = lit.solution().scene().surfaces().iter();
    let in_middle = surfaces.map(|of| SurfacePoint { position: of.polygon.centroid(), normal: of.polygon.normal() });
    let points: Vec<SurfacePoint> = in_middle.collect();
    let values = lit.values_at(&points, &Silent).unwrap();
    let bits = values.radiosity.iter().chain(&values.standard_error).map(|value| value.to_bits()).collect();
    (lit.solution().clone(), bits, report.counts.rays)
}

#[test]
fn all_members_find_what_one_process_finds() {
    let default = SolveOptions { error: 0.1, ..SolveOptions::default() };
    for (name, options) in [
        ("cornell", default.clone()),
        ("two_rooms", SolveOptions { solver: Solver::Cells, ..default.clone() }),
        ("two_rooms", SolveOptions { solver: Solver::Links, ..default.clone() }),
        ("pyramid", SolveOptions { lit_mesh: true, ..default }),
    ] {
        let (solution, values, rays) = found(Workers::new(2).unwrap(), name, &options);
        for size in [2, 3] {
            for (member, of_member) in of_members(size, |workers, _| found(workers, name, &options)).into_iter().enumerate() {
                assert!(of_member.0 == solution, "the solution of {name} by member {member} of {size}");
                assert!(of_member.1 == values, "values in {name} by member {member} of {size}");
                // What all do by themselves is little beside what they share.
                assert!(of_member.2 >= rays && of_member.2 < rays * 3 / 2, "{} rays for {rays}", of_member.2);
            }
        }
    }
}

#[test]
fn members_with_other_scenes_options_or_solutions_are_told_so() {
    let coarse = SolveOptions { error: 0.3, ..SolveOptions::default() };
    let differs = |ended: &Result<(Evaluator, SolveReport), PipelineError>| matches!(ended, Err(PipelineError::TeamDiffers));
    let of_scenes = of_members(2, |workers, rank| differs(&solved(workers, ["cornell", "pyramid"][rank], &coarse)));
    let of_options =
        of_members(2, |workers, rank| differs(&solved(workers, "cornell", &SolveOptions { seed: rank as u64, ..coarse.clone() })));
    assert_eq!((of_scenes, of_options), (vec![true; 2], vec![true; 2]));

    let solutions = [0, 1].map(|seed| found(Workers::new(1).unwrap(), "cornell", &SolveOptions { seed, ..coarse.clone() }).0);
    let backend = RunOptions::default().backend;
    let of_solutions = of_members(2, |workers, rank| Evaluator::new_on(workers, solutions[rank].clone(), backend).err());
    assert!(of_solutions.iter().all(|error| matches!(error, Some(PipelineError::TeamDiffers))), "{of_solutions:?}");
}

#[test]
fn a_team_knows_no_limit_of_time() {
    let run = RunOptions { time_s: Some(1.0), ..RunOptions::default() };
    let ended = of_members(2, |workers, _| solve_on(workers, scene("cornell"), &SolveOptions::default(), &run, &Silent).err());
    assert!(ended.iter().all(|error| matches!(error, Some(PipelineError::TeamTime))), "{ended:?}");
}

#[test]
fn who_leaves_the_team_works_alone() {
    let options = SolveOptions { error: 0.3, ..SolveOptions::default() };
    let of_each = of_members(2, |workers, rank| {
        let (mut lit, _) = solved(workers, "cornell", &options).unwrap();
        lit.leave_team();
        // The other one is not needed any more.
        let camera = lit.default_camera(8, 6);
        (rank == 0).then(|| lit.render(&camera, &Silent).unwrap().unwrap())
    });
    let (lit, _) = solved(Workers::new(1).unwrap(), "cornell", &options).unwrap();
    let camera = lit.default_camera(8, 6);
    assert!(of_each[0] == lit.render(&camera, &Silent).unwrap());
}
