//! The readers of PLY and STL files.

use std::cell::OnceCell;

use patchlight::scene::import::{ImportOptions, read_scene};

use super::obj::check;

thread_local! {
    static FOLDER: OnceCell<tempfile::TempDir> = const { OnceCell::new() };
}

/// Reads the bytes as a PLY file where they start as one, else as an STL file.
pub fn read_mesh(bytes: &[u8]) {
    FOLDER.with(|folder| {
        let folder = folder.get_or_init(|| tempfile::tempdir().expect("a place for files")).path();
        let file = folder.join(if bytes.starts_with(b"ply") { "a.ply" } else { "a.stl" });
        std::fs::write(&file, bytes).expect("a file is written");
        match read_scene(&file, &ImportOptions::default()) {
            Ok(imported) => check(&imported),
            Err(error) => assert!(!error.to_string().is_empty()),
        }
    });
}
