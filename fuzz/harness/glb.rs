//! The reader of glTF files.

use std::cell::OnceCell;

use patchlight::scene::import::{ImportOptions, read_scene};

use super::obj::check;

thread_local! {
    static FOLDER: OnceCell<tempfile::TempDir> = const { OnceCell::new() };
}

/// Reads the bytes as a GLB file, where they start as one; else those up to the first 0 as its JSON, and the others as its binary chunk.
pub fn read_glb(bytes: &[u8]) {
    FOLDER.with(|folder| {
        let folder = folder.get_or_init(|| tempfile::tempdir().expect("a place for files")).path();
        let file = folder.join("a.glb");
        let whole = if bytes.starts_with(b"glTF") { bytes.to_vec() } else { glb(bytes) };
        std::fs::write(&file, whole).expect("a file is written");
        match read_scene(&file, &ImportOptions::default()) {
            Ok(imported) => {
                check(&imported);
                assert!(imported.scene.surfaces().iter().all(|surface| imported.scene.objects().name_of(surface.face).is_some()));
            }
            Err(error) => assert!(!error.to_string().is_empty()),
        }
    });
}

/// A file of two chunks that are right.
fn glb(bytes: &[u8]) -> Vec<u8> {
    let end = bytes.iter().position(|&byte| byte == 0).unwrap_or(bytes.len());
    let (json, binary) = (&bytes[..end], bytes.get(end + 1..).unwrap_or_default());
    let mut chunks = Vec::new();
    for (kind, body) in [(b"JSON", json), (b"BIN\0", binary)] {
        chunks.extend((body.len() as u32).to_le_bytes());
        chunks.extend(kind);
        chunks.extend(body);
    }
    [b"glTF", &2_u32.to_le_bytes()[..], &(12 + chunks.len() as u32).to_le_bytes(), &chunks].concat()
}
