//! Finds Embree and compiles the wrapper over it. The decisions, in order:
//!
//! 1. Without the feature `embree`: nothing to do.
//! 2. `EMBREE_INCLUDE_DIR` (holds `embree4/` or `embree3/`) and `EMBREE_LIB_DIR`: that Embree, found again at run time by an
//!    rpath. Both or neither; an Embree that is named but does not link is an error.
//! 3. The system's Embree 4, if a program that uses it compiles and links.
//! 4. The system's Embree 3, likewise.
//! 5. Otherwise the crate is built without Embree, and one warning says so.
//!
//! With Embree found, a missing libclang is an error and not a reason to go on without: whoever has Embree installed wants its
//! speed, and would hardly notice a warning that it is gone.

fn main() {
    println!("cargo::rustc-check-cfg=cfg(has_embree)");
    println!("cargo::rerun-if-changed=build.rs");
    #[cfg(feature = "embree")]
    embree::main();

    // The crate openexr leaves its shared libraries in the folder `lib` of the build directory, where no loader would look.
    #[cfg(feature = "openexr")]
    if std::env::var("CARGO_CFG_TARGET_OS").is_ok_and(|system| system == "linux") {
        println!("cargo::rustc-link-arg=-Wl,-rpath,$ORIGIN/lib:$ORIGIN/../lib");
    }
}

#[cfg(feature = "embree")]
mod embree {
    use std::{env, fs, path::PathBuf};

    pub fn main() {
        for input in ["wrapper/occlusion.c", "wrapper/occlusion.h"] {
            println!("cargo::rerun-if-changed={input}");
        }
        for variable in ["EMBREE_INCLUDE_DIR", "EMBREE_LIB_DIR"] {
            println!("cargo::rerun-if-env-changed={variable}");
        }

        match find() {
            Ok(Some(found)) => {
                if let Err(message) = bind() {
                    return fail(&message);
                }
                compile(&found);
                println!("cargo::rustc-cfg=has_embree");
            }
            Ok(None) => {
                println!(
                    "cargo::warning=Embree 3 or 4 was not found: building with obvhs alone, which is several times slower. \
                     Install it (apt-get install libembree-dev libclang-dev) or set EMBREE_INCLUDE_DIR and EMBREE_LIB_DIR."
                );
                // An Embree that is installed later changes this directory.
                if PathBuf::from("/usr/include").is_dir() {
                    println!("cargo::rerun-if-changed=/usr/include");
                }
            }
            Err(message) => fail(&message),
        }
    }

    /// Stops the build with a message and without a panic's trace.
    fn fail(message: &str) {
        println!("cargo::error={message}");
    }

    /// An Embree that compiles and links.
    struct Found {
        major: u32,
        /// From the environment: where the headers and the library are.
        dirs: Option<(PathBuf, PathBuf)>,
    }

    impl Found {
        fn header(&self) -> String {
            format!("<embree{}/rtcore.h>", self.major)
        }

        fn library(&self) -> String {
            format!("embree{}", self.major)
        }
    }

    fn find() -> Result<Option<Found>, String> {
        let dir = |variable| env::var_os(variable).filter(|value| !value.is_empty()).map(PathBuf::from);
        match (dir("EMBREE_INCLUDE_DIR"), dir("EMBREE_LIB_DIR")) {
            (Some(include), Some(library)) => {
                for major in [4, 3] {
                    let found = Found { major, dirs: Some((include.clone(), library.clone())) };
                    if links(&found) {
                        return Ok(Some(found));
                    }
                }
                Err(format!(
                    "no Embree 3 or 4 in EMBREE_INCLUDE_DIR={} (must hold embree4/rtcore.h or embree3/rtcore.h) with \
                     EMBREE_LIB_DIR={} (must hold libembree4 or libembree3); correct them, or unset both to use the system's",
                    include.display(),
                    library.display()
                ))
            }
            (None, None) => Ok([4, 3].into_iter().map(|major| Found { major, dirs: None }).find(links).inspect(|found| {
                let header = PathBuf::from(format!("/usr/include/embree{}/rtcore_config.h", found.major));
                if header.is_file() {
                    println!("cargo::rerun-if-changed={}", header.display());
                }
            })),
            _ => Err("set both EMBREE_INCLUDE_DIR and EMBREE_LIB_DIR, or neither".to_owned()),
        }
    }

    /// Whether a program that calls this Embree compiles and links; one that is named must lie in the directories named, because
    /// the compiler would go on to those of the system.
    fn links(found: &Found) -> bool {
        if let Some((include, library)) = &found.dirs {
            let starts = format!("lib{}.", found.library());
            let has_library = fs::read_dir(library).is_ok_and(|mut files| {
                files.any(|file| file.is_ok_and(|file| file.file_name().to_string_lossy().starts_with(&starts)))
            });
            if !has_library || !include.join(found.library()).join("rtcore.h").is_file() {
                return false;
            }
        }

        let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"));
        let source = out.join("probe.c");
        let text = format!("#include {}\nint main(void) {{ return (int)rtcGetDeviceError(0); }}\n", found.header());
        if fs::write(&source, text).is_err() {
            return false;
        }

        let Ok(compiler) = cc::Build::new().cargo_metadata(false).cargo_warnings(false).try_get_compiler() else { return false };
        let mut command = compiler.to_command();
        if let Some((include, library)) = &found.dirs {
            command.arg("-I").arg(include).arg("-L").arg(library);
        }
        command.arg(&source).arg("-o").arg(out.join("probe")).arg(format!("-l{}", found.library()));
        command.output().is_ok_and(|output| output.status.success())
    }

    /// Writes the Rust declarations of wrapper/occlusion.h.
    fn bind() -> Result<(), String> {
        let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR")).join("occlusion.rs");
        let generate = || {
            bindgen::Builder::default()
                .header("wrapper/occlusion.h")
                .allowlist_item("occlusion_.*")
                .use_core()
                .layout_tests(false)
                .generate()
        };

        // bindgen panics where it finds no libclang; the panic's own message is kept off the terminal.
        let hook = std::panic::take_hook();
        std::panic::set_hook(Box::new(|_| {}));
        let bindings = std::panic::catch_unwind(generate);
        std::panic::set_hook(hook);

        let bindings = bindings
            .map_err(|_| {
                "Embree is installed, but libclang, which reads wrapper/occlusion.h, is not: apt-get install libclang-dev (or set \
                 LIBCLANG_PATH), or build without Embree: --no-default-features --features cli"
                    .to_owned()
            })?
            .map_err(|error| format!("libclang cannot read wrapper/occlusion.h: {error}").replace('\n', " "))?;
        bindings.write_to_file(&out).map_err(|error| format!("cannot write {}: {error}", out.display()))
    }

    fn compile(found: &Found) {
        let mut build = cc::Build::new();
        build
            .file("wrapper/occlusion.c")
            .define("EMBREE_HEADER", found.header().as_str())
            .std("c11")
            .opt_level(2)
            // The same arithmetic as in Rust, on every processor.
            .flag_if_supported("-ffp-contract=off");
        if let Some((include, library)) = &found.dirs {
            build.include(include);
            println!("cargo::rustc-link-search=native={}", library.display());
            println!("cargo::rustc-link-arg=-Wl,-rpath,{}", library.display());
        }
        build.compile("patchlight_occlusion");
        println!("cargo::rustc-link-lib={}", found.library());
    }
}
