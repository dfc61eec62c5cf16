//! The harness of the fuzz targets, driven by seeded random bytes and changes of good ones: no nightly compiler is needed.
//!
//! A few seconds by default. For longer, with another seed if wanted:
//!
//! ```text
//! PATCHLIGHT_FUZZ_SECONDS=3600 PATCHLIGHT_FUZZ_SEED=7 cargo test --release --test fuzz -- --ignored --nocapture
//! ```
//!
//! An input that fails is written to the system's folder for temporary files, and its path is printed; it then becomes a test below. With
//! cargo-fuzz, which looks at the branches taken: `cargo +nightly fuzz run obj` (or `solution`, `solve`).
#![allow(clippy::print_stderr, reason = "a test tells what it did")]

#[path = "../fuzz/harness/mod.rs"]
mod harness;
#[path = "support/triangles.rs"]
mod triangles;

use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::time::{Duration, Instant};

use patchlight::solve::Gather;
use triangles::Random;

const OBJ: &[u8] = b"mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0.25\nv 0 1 0\nv 0.5 0.5 2\nusemtl a\nf 1 2 3 4\nf -1 -2 -3\nusemtl b\n\
                     f 1/1 2/2 5/3\nf 4 3 2 1\ng x\nf 1 2 5 3 4\n\0newmtl a\nKd 0.5 0.5 0.5\nKe 1 2 3\n\nnewmtl b # c\nKd .9\nKs 0 0 0\n";

const TO_AND_FRO: &[u8] = &[
    175, 88, 68, 10, 5, 172, 201, 66, 153, 163, 17, 23, 75, 9, 167, 161, 181, 242, 192, 37, 4, 110, 119, 234, 26, 87, 130, 237,
    236, 186, 215, 54, 93, 246, 249, 41, 135, 111, 151, 141, 4, 64, 157, 90, 27, 106, 216, 84, 31, 74, 101, 239, 65, 207, 23, 13,
    50, 246, 21, 34, 159, 85, 46, 103, 173, 119, 145, 39, 42, 159, 252, 163, 71, 128, 4, 34, 37, 2, 209, 37, 166, 98, 136, 4, 235,
    42, 220, 148, 81, 103, 78, 123, 0, 10, 153, 146, 99, 120, 51, 45,
];

/// What is fed with bytes, and what the bytes are made of.
struct Target {
    name: &'static str,
    /// Inputs in a default run.
    few: usize,
    feed: fn(&[u8]),
    seeds: Vec<Vec<u8>>,
}

fn targets() -> [Target; 3] {
    let solutions = [Gather::Links, Gather::Hemisphere].map(|gather| harness::small_solution(gather).to_vec());
    [
        Target { name: "obj", few: 400, feed: harness::read_obj, seeds: vec![OBJ.to_vec(), Vec::new()] },
        Target { name: "solution", few: 200, feed: harness::read_solution, seeds: solutions.into() },
        Target { name: "solve", few: 40, feed: harness::solve_scene, seeds: vec![vec![0; 60], (0..=255).collect()] },
    ]
}

/// A seed with a few bytes changed, dropped, doubled or moved; or any bytes.
fn input(target: &Target, random: &mut Random) -> Vec<u8> {
    const TELLING: [u8; 12] = [0, 1, 0x7f, 0x80, 0xff, b' ', b'\n', b'-', b'/', b'.', b'e', b'9'];
    let mut bytes = target.seeds[random.below(target.seeds.len())].clone();
    if bytes.is_empty() || random.below(4) == 0 {
        let length = random.below(200);
        return (0..length).map(|_| random.bits() as u8).collect();
    }
    for _ in 0..=random.below(12) {
        let at = random.below(bytes.len());
        match random.below(5) {
            0 => bytes[at] = random.bits() as u8,
            1 => bytes[at] = TELLING[random.below(TELLING.len())],
            2 => bytes.insert(at, TELLING[random.below(TELLING.len())]),
            3 if bytes.len() > 1 => drop(bytes.remove(at)),
            _ => bytes[at] ^= 1 << random.below(8),
        }
    }
    bytes
}

/// Feeds an input; one that fails is kept.
fn feed(target: &Target, bytes: &[u8]) {
    if let Err(panic) = catch_unwind(AssertUnwindSafe(|| (target.feed)(bytes))) {
        let file = std::env::temp_dir().join(format!("patchlight-{}-{:08x}.fuzz", target.name, crc32fast::hash(bytes)));
        std::fs::write(&file, bytes).unwrap();
        eprintln!("{}: failed on {}", target.name, file.display());
        resume_unwind(panic);
    }
}

#[test]
fn a_few_inputs_do_no_harm() {
    for target in targets() {
        let mut random = Random(1);
        target.seeds.iter().for_each(|seed| feed(&target, seed));
        (0..target.few).for_each(|_| feed(&target, &input(&target, &mut random)));
    }
}

/// Found by these: inputs that once failed.
#[test]
fn what_was_found_stays_mended() {
    // Two surfaces that send nearly all their light to each other and back.
    harness::solve_scene(TO_AND_FRO);
}

#[test]
#[ignore = "as long as PATCHLIGHT_FUZZ_SECONDS says"]
fn many_inputs_do_no_harm() {
    let number = |name: &str, default: u64| std::env::var(name).map_or(default, |text| text.parse().expect("a number"));
    let (seconds, seed) = (number("PATCHLIGHT_FUZZ_SECONDS", 60), number("PATCHLIGHT_FUZZ_SEED", 1));
    for target in targets() {
        let (mut random, mut inputs, start) = (Random(seed), 0, Instant::now());
        while start.elapsed() < Duration::from_secs(seconds / 3) {
            feed(&target, &input(&target, &mut random));
            inputs += 1;
        }
        eprintln!("{}: {inputs} inputs", target.name);
    }
}

/// A file on the command line of a debugger: `PATCHLIGHT_FUZZ_INPUT=file PATCHLIGHT_FUZZ_TARGET=solve`.
#[test]
#[ignore = "takes one input"]
fn one_input() {
    let [file, name] = ["PATCHLIGHT_FUZZ_INPUT", "PATCHLIGHT_FUZZ_TARGET"].map(|name| std::env::var(name).unwrap());
    let target = targets().into_iter().find(|target| target.name == name).expect("obj, solution or solve");
    (target.feed)(&std::fs::read(file).unwrap());
}
