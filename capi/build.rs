//! How the shared library is linked: its SONAME, and where it finds an Embree that is not the system's.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-env-changed=EMBREE_LIB_DIR");
    if std::env::var("CARGO_CFG_TARGET_OS").is_ok_and(|system| system == "linux") {
        // The major version: what changes when old programs would not run any more. Before 1.0 it stays 0, see docs/c.md.
        println!("cargo::rustc-cdylib-link-arg=-Wl,-soname,libpatchlight.so.0");
    }
    if let Ok(folder) = std::env::var("EMBREE_LIB_DIR")
        && !folder.is_empty()
    {
        println!("cargo::rustc-cdylib-link-arg=-Wl,-rpath,{folder}");
    }
}
