//! The readers of OBJ and MTL files.

use std::cell::OnceCell;

use patchlight::scene::import::{ImportOptions, Imported, read_scene};
use patchlight::scene::{SceneSummary, Sides};

thread_local! {
    static FOLDER: OnceCell<tempfile::TempDir> = const { OnceCell::new() };
}

/// What holds for each scene that was read.
pub(super) fn check(imported: &Imported) {
    let scene = &imported.scene;
    for surface in scene.surfaces() {
        assert!((surface.face as usize) < imported.lines.len());
        assert!(surface.polygon.area() > 0.0 && surface.polygon.area().is_finite());
        assert!(surface.polygon.vertices().flatten().all(f64::is_finite));
    }
    for material in scene.materials() {
        assert!(material.reflectance.iter().all(|rho| (0.0..1.0).contains(rho)), "{material:?}");
        assert!(material.exitance.iter().all(|e| e.is_finite() && *e >= 0.0), "{material:?}");
    }
    assert!(!SceneSummary::new(scene, &imported.diagnostics).to_string().is_empty());
}

/// Reads the bytes up to the first 0 as an OBJ file, and the others as its material library `a.mtl`.
pub fn read_obj(bytes: &[u8]) {
    FOLDER.with(|folder| {
        let folder = folder.get_or_init(|| tempfile::tempdir().expect("a place for files")).path();
        let end = bytes.iter().position(|&byte| byte == 0).unwrap_or(bytes.len());
        let (obj, mtl) = (&bytes[..end], bytes.get(end + 1..).unwrap_or_default());
        let file = folder.join("a.obj");
        std::fs::write(&file, obj).expect("a file is written");
        std::fs::write(folder.join("a.mtl"), mtl).expect("a file is written");

        for sides in [Sides::Front, Sides::Both] {
            match read_scene(&file, &ImportOptions { sides, ..ImportOptions::default() }) {
                Ok(imported) => check(&imported),
                Err(error) => assert!(!error.to_string().is_empty()),
            }
        }
    });
}
