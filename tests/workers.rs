//! Threads that solves share.

use patchlight::pipeline::{Evaluator, Workers, solve, solve_asking_on, solve_on};
use patchlight::progress::Silent;
use patchlight::scene::Scene;
use patchlight::scene::import::{ImportOptions, read_scene};
use patchlight::solve::{RunOptions, SolveOptions};
use patchlight::visibility::{Backend, OccluderMesh, build};

fn cornell() -> Scene {
    read_scene("scenes/cornell.obj".as_ref(), &ImportOptions::default()).expect("a scene that comes along").scene
}

fn options(seed: u64) -> SolveOptions {
    SolveOptions { error: 0.2, seed, ..SolveOptions::default() }
}

#[test]
fn solves_that_share_threads_at_once_are_those_that_have_their_own() {
    let run = RunOptions { threads: 1, ..RunOptions::default() };
    let alone = [1, 2].map(|seed| solve(cornell(), &options(seed), &run, &Silent).unwrap().0.solution().clone());

    let workers = Workers::new(2).unwrap();
    assert_eq!(workers.count(), 2);
    let together = std::thread::scope(|scope| {
        let threads = [1, 2].map(|seed| {
            let workers = workers.clone();
            scope.spawn(move || solve_on(workers, cornell(), &options(seed), &RunOptions::default(), &Silent).unwrap().0)
        });
        threads.map(|thread| thread.join().unwrap().solution().clone())
    });
    assert!(alone == together);
}

#[test]
fn a_backend_of_ones_own_and_a_stored_solution_share_them_too() {
    let workers = Workers::new(1).unwrap();
    let visibility = || build(Backend::Obvhs, &OccluderMesh::of_scene(&cornell())).unwrap();
    let run = RunOptions { backend: Backend::BruteForce, ..RunOptions::default() };
    let (lit, report) = solve_asking_on(workers.clone(), visibility(), cornell(), &options(3), &run, &Silent).unwrap();
    assert!(report.backend.starts_with("obvhs"), "{}", report.backend);

    let again = Evaluator::asking_on(workers.clone(), visibility(), lit.solution().clone());
    let other = Evaluator::new_on(workers, lit.solution().clone(), Backend::BruteForce).unwrap();
    assert_eq!((again.backend(), other.backend()), (lit.backend(), "brute force".to_owned()));
    let camera = lit.default_camera(8, 6);
    assert_eq!(lit.render(&camera, &Silent).unwrap(), again.render(&camera, &Silent).unwrap());
}
