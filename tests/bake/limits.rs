//! Limits hold, and what there is then has values that are told.
#![allow(clippy::print_stdout, reason = "a test tells what it measured")]

use std::f64::consts::PI;
use std::path::Path;
use std::sync::Mutex;
use std::time::{Duration, Instant};

use patchlight::bake::{Atlas, BakeOptions};
use patchlight::pipeline::Evaluator;
use patchlight::progress::{Observer, Progress, Silent};
use patchlight::scene::import::{ImportOptions, read_scene};
use patchlight::solve::SolveOptions;

use super::rooms::{cube, solve};
use super::{apart, options};

/// A bake ends within half a second; a machine at work on other things may be slower by this.
const SLACK: Duration = Duration::from_millis(1500);

/// The office in texels of two centimetres, with so many rays that it takes minutes.
fn office() -> (Evaluator, Atlas) {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/full_office.obj");
    let scene = read_scene(&file, &ImportOptions::default()).unwrap().scene;
    let mut evaluator = solve(scene, &SolveOptions { error: 0.1, ..SolveOptions::default() }).0;
    let atlas = Atlas::new(evaluator.solution().scene(), &options(0.02)).unwrap();
    evaluator = super::rooms::regathered(&evaluator, 4096, 5);
    (evaluator, atlas)
}

/// Cancels when it was told of progress so many times, and remembers when.
struct CancelAfter {
    left: Mutex<(u32, Option<Instant>)>,
}

impl Observer for CancelAfter {
    fn progress(&self, _: &Progress) {
        let (left, at) = &mut *self.left.lock().unwrap();
        *left = left.saturating_sub(1);
        if *left == 0 {
            at.get_or_insert_with(Instant::now);
        }
    }

    fn cancelled(&self) -> bool {
        self.left.lock().unwrap().1.is_some()
    }
}

#[test]
fn a_bake_is_cancelled_soon_and_keeps_to_its_time() {
    let (evaluator, atlas) = office();
    for count in [1, 20] {
        let observer = CancelAfter { left: Mutex::new((count, None)) };
        assert_eq!(evaluator.bake(&atlas, None, &observer), Ok(None));
        let took = observer.left.lock().unwrap().1.unwrap().elapsed();
        println!("ended after {took:?}");
        assert!(took < Duration::from_millis(500) + SLACK, "{took:?}");
    }
    for time_s in [0.0, 1.0] {
        let start = Instant::now();
        let lightmap = evaluator.bake_within(&atlas, None, Some(time_s), &Silent).unwrap().unwrap();
        let took = start.elapsed();
        println!("{time_s} s: {took:?}, {:?}", lightmap.report);
        assert!(took < Duration::from_secs_f64(1.1 * time_s + 0.5) + SLACK, "{time_s} s: {took:?}");
        let report = lightmap.report;
        // How far it comes in a second is for the machine to say.
        assert!(report.filled + report.coarse <= report.texels);
        assert!((time_s > 0.0 || report.coarse > 0) && (report.whole.is_none() || report.is_complete()), "{report:?}");
        assert!(lightmap.pages.iter().flat_map(|page| &page.radiance).all(|x| x.is_finite() && *x >= 0.0));
    }
}

#[test]
fn without_time_texels_have_the_light_of_the_solvers_elements() {
    let evaluator = solve(cube(&[0.5], &[1.0]), &SolveOptions { error: 0.02, ..SolveOptions::default() }).0;
    for separate in [false, true] {
        let atlas = Atlas::new(evaluator.solution().scene(), &BakeOptions { separate, ..options(0.07) }).unwrap();
        let lightmap = evaluator.bake_within(&atlas, None, Some(0.0), &Silent).unwrap().unwrap();
        assert_eq!((lightmap.report.coarse, lightmap.report.filled, lightmap.report.gathered), (6 * 15 * 15, 0, [0, 0]));
        let lit = lightmap.pages[0].radiance.iter().filter(|&&x| x != 0.0);
        let (_, most) = apart(lit.map(|&radiance| (PI * f64::from(radiance), 2.0)));
        assert!(most < 0.05, "{most}");

        // Time that is enough changes nothing.
        let whole = evaluator.bake(&atlas, None, &Silent).unwrap();
        assert_eq!(evaluator.bake_within(&atlas, None, Some(1e6), &Silent).unwrap(), whole);
        assert!(whole.unwrap().report.is_complete());
    }
}
