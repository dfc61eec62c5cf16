//! The readers of files of lights and of photometric files.

use std::cell::OnceCell;

use patchlight::scene::import::read_lights;

thread_local! {
    static FOLDER: OnceCell<tempfile::TempDir> = const { OnceCell::new() };
}

/// Reads the bytes up to the first 0 as a file of lights, and the others as the photometric file `a.ies`.
pub fn read_light_file(bytes: &[u8]) {
    FOLDER.with(|folder| {
        let folder = folder.get_or_init(|| tempfile::tempdir().expect("a place for files")).path();
        let end = bytes.iter().position(|&byte| byte == 0).unwrap_or(bytes.len());
        let file = folder.join("a.toml");
        std::fs::write(&file, &bytes[..end]).expect("a file is written");
        std::fs::write(folder.join("a.ies"), bytes.get(end + 1..).unwrap_or_default()).expect("a file is written");
        for channels in [1, 3] {
            match read_lights(&file, channels, false) {
                Ok(read) => {
                    for light in &read.lights {
                        assert_eq!(light.strength.len(), channels);
                        assert!(light.strength.iter().all(|strength| strength.is_finite() && *strength >= 0.0), "{light:?}");
                        assert!(light.flux().is_none_or(|flux| flux.iter().all(|watts| !watts.is_nan())), "{light:?}");
                    }
                }
                Err(error) => assert!(!error.to_string().is_empty()),
            }
        }
    });
}
