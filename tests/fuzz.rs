//! The harness of the fuzz targets, driven by seeded random bytes and changes of good ones: no nightly compiler is needed.
//!
//! A few seconds by default. For longer, with another seed if wanted:
//!
//! ```text
//! PATCHLIGHT_FUZZ_SECONDS=3600 PATCHLIGHT_FUZZ_SEED=7 cargo test --release --test fuzz -- --ignored --nocapture many_inputs
//! ```
//!
//! An input that fails is written to the system's folder for temporary files, and its path is printed; it then becomes a test below. With
//! cargo-fuzz, which looks at the branches taken: `scripts/fuzz.sh SECONDS` runs all targets of `fuzz/`.
#![allow(clippy::print_stderr, reason = "a test tells what it did")]

#[path = "support/glb.rs"]
mod glb;
#[path = "../fuzz/harness/mod.rs"]
mod harness;
#[path = "support/triangles.rs"]
mod triangles;

use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::time::{Duration, Instant};

use patchlight::solve::Solver;
use triangles::Random;

const OBJ: &[u8] = b"mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0.25\nv 0 1 0\nv 0.5 0.5 2\nusemtl a\nf 1 2 3 4\nf -1 -2 -3\nusemtl b\n\
                     f 1/1 2/2 5/3\nf 4 3 2 1\ng x\nf 1 2 5 3 4\n\0newmtl a\nKd 0.5 0.5 0.5\nKe 1 2 3\n\nnewmtl b # c\nKd .9\nKs 0 0 0\n";

const PLY: &[u8] =
    b"ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 2\n\
                     property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0.5\n3 0 1 2\n3 1 3 2\n";

const STL: &[u8] =
    b"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n";

const LIGHTS: &[u8] = b"up = 'z'\n[[point]]\nposition = [1, 2, 3]\npower = [1, 2.5, 1e-3]\n[[spot]]\nname = 'b'\nposition = [0, 0, 3]\n\
                        towards = [1, 0, 0]\ninner = 10\nouter = 30\nlumens = 800\nkelvin = 3000\n[[ies]]\nfile = 'a.ies'\nposition = [0, 0, 2]\n\
                        front = [1, 1, 0]\n[[sun]]\nazimuth = 150\nelevation = 40\nlux = 8e4\n[[sky]]\nkind = 'clear'\ndirection = [1, 0, -1]\n\
                        irradiance = 50\nground = 0.2\n\0IESNA:LM-63-2002\n[TEST] a\nTILT=INCLUDE\n1\n2\n0 90\n1 0.9\n1 1000 1 3 2 1 2 0.1 0 0\n\
                        0.95 1 20\n0 45 90\n0 90\n300 200 0\n300 150 0\n";

const CSV: &[u8] =
    b"\xef\xbb\xbfid,\"NZ\",ny,NX,z,Y,x,note,B_r\r\n7,1,0,0,3,2,1,a wall,0.5\r\n8,0.5774,-.5774,0.5774,1e-3,-2.5,4,,\n";

const OPTIONS: &[u8] = b"error=0.05\nnorm=energy\nimportance=view eye=0,1,5 target=0,1,0 up=0,1,0 fov=40\nskips=rays+clear\n\
                         strategy=lazy94+reduction\nbounds=guaranteed\nbounds_work=64\nseed=7\nmin_element=1e-8\nambient=false\n";

const TO_AND_FRO: &[u8] = &[
    175, 88, 68, 10, 5, 172, 201, 66, 153, 163, 17, 23, 75, 9, 167, 161, 181, 242, 192, 37, 4, 110, 119, 234, 26, 87, 130, 237,
    236, 186, 215, 54, 93, 246, 249, 41, 135, 111, 151, 141, 4, 64, 157, 90, 27, 106, 216, 84, 31, 74, 101, 239, 65, 207, 23, 13,
    50, 246, 21, 34, 159, 85, 46, 103, 173, 119, 145, 39, 42, 159, 252, 163, 71, 128, 4, 34, 37, 2, 209, 37, 166, 98, 136, 4, 235,
    42, 220, 148, 81, 103, 78, 123, 0, 10, 153, 146, 99, 120, 51, 45,
];

const FAR_BOXES: &[u8] = &[
    130, 183, 14, 238, 127, 26, 80, 5, 1, 0, 0, 194, 52, 127, 6, 110, 208, 143, 93, 199, 81, 36, 71, 227, 64, 67, 0, 2, 107, 110,
    84, 85, 148, 160, 101, 104, 93, 100, 196, 152, 11, 184, 212, 84, 74, 135, 33, 169, 154, 1, 173, 33, 158, 181, 156, 246, 161,
    94, 246, 241, 90, 29, 131, 11, 183, 206, 122, 214, 187, 192, 4, 231, 23, 92, 100, 60, 125, 236, 176, 181, 128, 236, 55, 188,
    151, 18, 221, 46, 106, 174, 185, 75, 174, 141, 47, 159, 162, 156, 90, 40, 76, 158, 247, 82, 24, 41, 207, 16, 121, 176, 128,
    233, 215, 74, 28, 16, 252, 171, 106, 66, 67, 211, 54, 86, 222, 190, 76, 30, 215, 150, 72, 232, 86, 232, 249, 162, 245, 140,
    149, 240, 206, 75, 57, 193, 91, 255, 173, 92, 45, 251, 139, 184, 32, 182, 17, 159, 186, 143, 248, 135, 150, 174, 91, 5, 242,
    128, 166, 140, 237, 147, 182, 178, 140, 176, 209, 179, 88, 230, 186, 171, 72, 85, 101, 185, 244, 144, 40, 213, 87, 215, 154,
    138, 14, 100, 81, 225, 92, 112, 92,
];

const IN_A_CIRCLE: &[u8] = &[
    85, 41, 68, 169, 82, 75, 203, 191, 156, 100, 62, 133, 57, 201, 199, 195, 159, 87, 42, 158, 144, 105, 235, 35, 73, 123, 132, 33,
    54, 80, 190, 98, 104, 199, 136, 207, 250, 75, 25, 87, 86, 244, 171, 249, 111, 102, 244, 125, 209, 144, 32, 74, 153, 157, 122,
    49, 129, 73, 46, 171, 228, 108, 239, 118, 72, 42, 33, 184, 124, 146, 145, 94, 192, 198, 206, 164, 84, 145, 234, 57, 73, 253,
    54, 37, 32, 227, 98, 123, 118, 134, 27, 140, 244, 248, 180, 249, 50, 8, 149, 144, 140, 129, 249, 232, 57, 78, 148, 69, 97, 23,
    241, 178, 105, 68, 211, 191, 101, 54, 216, 89, 30, 117, 0, 60, 129, 24, 66, 14, 67, 211, 230, 67, 8, 243, 88, 191, 14, 243,
    182, 41, 252, 123, 194, 14, 167, 178, 214, 221, 136, 79, 38, 20, 191, 94, 193,
];

/// What is fed with bytes, and what the bytes are made of.
struct Target {
    name: &'static str,
    /// Inputs in a default run.
    few: usize,
    feed: fn(&[u8]),
    seeds: Vec<Vec<u8>>,
}

fn targets() -> [Target; 10] {
    let mut room = glb::small_room();
    let (file, nodes) = (room.glb(), [room.json.to_string().as_bytes(), &[0], &room.binary].concat());
    let kinds = [(Solver::Links, false), (Solver::Cells, false), (Solver::Links, true)];
    let solutions = kinds.map(|(solver, lit_mesh)| harness::small_solution(solver, lit_mesh).to_vec());
    [
        Target { name: "obj", few: 400, feed: harness::read_obj, seeds: vec![OBJ.to_vec(), Vec::new()] },
        Target { name: "glb", few: 1000, feed: harness::read_glb, seeds: vec![file, nodes] },
        Target { name: "meshes", few: 400, feed: harness::read_mesh, seeds: vec![PLY.to_vec(), STL.to_vec()] },
        Target { name: "lights", few: 1000, feed: harness::read_light_file, seeds: vec![LIGHTS.to_vec()] },
        Target { name: "solution", few: 200, feed: harness::read_solution, seeds: solutions.into() },
        Target { name: "bake", few: 400, feed: harness::read_bake, seeds: vec![Vec::new(), (0..40).collect()] },
        Target { name: "points", few: 400, feed: harness::read_csv, seeds: vec![CSV.to_vec()] },
        Target { name: "options", few: 400, feed: harness::set_options, seeds: vec![OPTIONS.to_vec()] },
        Target { name: "solve", few: 40, feed: harness::solve_scene, seeds: vec![vec![0; 60], (0..=255).collect()] },
        Target { name: "triangulation", few: 2000, feed: harness::triangulate, seeds: vec![vec![0; 40], (0..=255).collect()] },
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
    // Boxes of a tree of obvhs that stand out of their parents by a rounding: its own test of that panicked.
    harness::solve_scene(FAR_BOXES);
    // Lines in a flat polygon, one vertex after the other: spade went in a circle looking for the place of the next one, and panicked.
    harness::triangulate(IN_A_CIRCLE);
}

#[test]
#[ignore = "as long as PATCHLIGHT_FUZZ_SECONDS says"]
fn many_inputs_do_no_harm() {
    let number = |name: &str, default: u64| std::env::var(name).map_or(default, |text| text.parse().expect("a number"));
    let (seconds, seed) = (number("PATCHLIGHT_FUZZ_SECONDS", 60), number("PATCHLIGHT_FUZZ_SEED", 1));
    let targets = targets();
    let share = Duration::from_secs(seconds) / targets.len() as u32;
    for target in targets {
        let (mut random, mut inputs, start) = (Random(seed), 0, Instant::now());
        while start.elapsed() < share {
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
    // All ignored tests run together where no input is named.
    let [Ok(file), Ok(name)] = ["PATCHLIGHT_FUZZ_INPUT", "PATCHLIGHT_FUZZ_TARGET"].map(std::env::var) else {
        eprintln!("no input is named: nothing to do");
        return;
    };
    let target = targets().into_iter().find(|target| target.name == name).expect("the name of a target");
    (target.feed)(&std::fs::read(file).unwrap());
}
