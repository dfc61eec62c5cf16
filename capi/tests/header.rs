//! The header is what cbindgen makes of the sources.

use std::path::Path;

use cbindgen::{Builder, Config};

/// Writes the header anew instead of looking at it.
const WRITE: &str = "PATCHLIGHT_WRITE_HEADER";

#[test]
fn the_header_is_what_the_sources_say() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let config = Config::from_file(folder.join("cbindgen.toml")).unwrap();
    let mut made = Vec::new();
    Builder::new().with_crate(folder).with_config(config).generate().unwrap().write(&mut made);
    let made = String::from_utf8(made).unwrap();

    let path = folder.join("include/patchlight.h");
    if std::env::var_os(WRITE).is_some() {
        std::fs::write(&path, &made).unwrap();
    }
    let found = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(found == made, "{} is not what the sources say: {WRITE}=1 cargo test -p patchlight-capi --test header", path.display());
}

#[test]
fn versions_agree() {
    let header = [
        patchlight_capi::PATCHLIGHT_VERSION_MAJOR,
        patchlight_capi::PATCHLIGHT_VERSION_MINOR,
        patchlight_capi::PATCHLIGHT_VERSION_PATCH,
    ];
    assert_eq!(header.map(|number| number.to_string()).join("."), env!("CARGO_PKG_VERSION"));
}
