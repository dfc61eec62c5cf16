//! The reader of what bakes leave, and later bakes that take from whatever it lets pass.

use std::cell::OnceCell;
use std::io::Cursor;
use std::sync::OnceLock;

use patchlight::bake::{Atlas, BakeOptions, BakeRecord};
use patchlight::geometry::Polygon;
use patchlight::output::{Provenance, read_bake_record, write_bake_record};
use patchlight::pipeline::{self, Evaluator};
use patchlight::progress::Silent;
use patchlight::scene::{Material, Scene, Sides};
use patchlight::solve::{RunOptions, SolveOptions};

use super::bytes::Bytes;
use super::solution::{HEADER, header};

/// A corner of a room under a lamp, and the lamp.
fn scene() -> Scene {
    let material = |name: &str, reflectance: f64, exitance: f64| Material {
        name: name.to_owned(),
        reflectance: vec![reflectance],
        exitance: vec![exitance],
    };
    let floor = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let wall = [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 1.0, 1.0], [0.0, 0.0, 1.0]];
    let lamp = [[0.3, 0.3, 1.0], [0.3, 0.7, 1.0], [0.7, 0.3, 1.0]];
    let faces = [(&floor[..], 0), (&wall[..], 1), (&lamp[..], 2)].into_iter().zip(0..);
    let faces = faces.map(|((corners, material), face)| (Polygon::new(corners).expect("it has an area"), material, face)).collect();
    let materials = vec![material("floor", 0.5, 0.0), material("wall", 0.7, 0.0), material("lamp", 0.0, 1.0)];
    Scene::new(1, materials, faces, Sides::Front).expect("a scene")
}

fn options() -> BakeOptions {
    BakeOptions { texel: 0.125, padding: 1, size: 32, keep: true, ..BakeOptions::default() }
}

/// The solved scene, and its charts.
fn solved() -> &'static (Evaluator, Atlas) {
    static SOLVED: OnceLock<(Evaluator, Atlas)> = OnceLock::new();
    SOLVED.get_or_init(|| {
        let solve = SolveOptions { error: 0.5, point_rays: Some(16), ..SolveOptions::default() };
        let run = RunOptions { threads: 1, ..RunOptions::default() };
        let (evaluator, _) = pipeline::solve(scene(), &solve, &run, &Silent).expect("legal options");
        let atlas = Atlas::new(evaluator.solution().scene(), &options()).expect("it has room");
        (evaluator, atlas)
    })
}

/// Reads the bytes as what a bake left, and once more as changes of what a bake of a small scene leaves, behind a right header; then bakes
/// that scene.
pub fn read_bake(bytes: &[u8]) {
    thread_local! {
        static FOLDER: OnceCell<tempfile::TempDir> = const { OnceCell::new() };
    }
    let body = changed(small_bake(), Bytes(bytes));
    FOLDER.with(|folder| {
        let file = folder.get_or_init(|| tempfile::tempdir().expect("a place for files")).path().join("a.bake");
        for whole in [bytes.to_vec(), [header(*b"\x89PLBAK\r\n", 1, &body), body].concat()] {
            std::fs::write(&file, whole).expect("a file is written");
            match read_bake_record(&file) {
                Ok(record) => bake_since(&record),
                Err(error) => assert!(!error.to_string().is_empty()),
            }
        }
    });
}

/// Bakes the small scene again, from whatever was left.
fn bake_since(record: &BakeRecord) {
    assert_eq!(record.validate(), Ok(()));
    let (evaluator, atlas) = solved();
    match evaluator.bake_since(atlas, record, None, &Silent) {
        Ok(lightmap) => {
            let lightmap = lightmap.expect("nobody cancels");
            let mut light = lightmap.pages.iter().flat_map(|page| &page.radiance);
            assert!(light.all(|l| (0.0..=f32::MAX).contains(l)), "{:?}", lightmap.report);
            assert!(!lightmap.report.interpolated.is_nan());
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}

/// With more changes hardly any body is taken.
const MOST_CHANGES: usize = 8;

/// Changes of a body: by four bytes each, where, how and to what.
fn changed(body: &[u8], mut bytes: Bytes<'_>) -> Vec<u8> {
    const NUMBERS: [f64; 8] = [f64::NAN, f64::INFINITY, -1.0, 0.0, f64::MIN_POSITIVE, 1e-30, 1e30, 0.5];
    let mut body = body.to_vec();
    for _ in 0..MOST_CHANGES {
        if bytes.is_empty() || body.is_empty() {
            break;
        }
        let at = (usize::from(bytes.next()) << 8 | usize::from(bytes.next())) % body.len();
        let (how, what) = (bytes.next(), bytes.next());
        let number = NUMBERS[usize::from(what) % NUMBERS.len()];
        match how % 6 {
            0 => body[at] = what,
            1 => body[at] ^= 1 << (what % 8),
            2 => body.truncate(at),
            3 => body.insert(at, what),
            4 => body.splice(at..(at + 4).min(body.len()), (number as f32).to_le_bytes()).for_each(drop),
            _ => body.splice(at..(at + 8).min(body.len()), number.to_le_bytes()).for_each(drop),
        }
    }
    body
}

/// The body of what a bake of the small scene leaves.
fn small_bake() -> &'static [u8] {
    static BODY: OnceLock<Vec<u8>> = OnceLock::new();
    BODY.get_or_init(|| {
        let (evaluator, atlas) = solved();
        let lightmap = evaluator.bake(atlas, None, &Silent).expect("a legal bake").expect("nobody cancels");
        let mut file = Cursor::new(Vec::new());
        let provenance = Provenance::new(evaluator.solution().options());
        write_bake_record(&mut file, &lightmap.record.expect("it is kept"), &provenance).expect("memory suffices");
        file.into_inner().split_off(HEADER)
    })
}
