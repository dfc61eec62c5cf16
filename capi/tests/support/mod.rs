//! A libpatchlight that was installed into a folder for these tests, and C programs that are built with it.
#![allow(dead_code, reason = "each test uses a part of it")]

use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;

/// The top of the repository.
pub fn top() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap()
}

/// Says past the harness, which shows nothing of a test that passes, what is left out.
pub fn skip(what: &str) {
    std::io::stderr().write_all(format!("SKIPPED: {what}\n").as_bytes()).unwrap();
}

/// Whether a program of the system is there.
pub fn is_there(program: &str) -> bool {
    Command::new(program).arg("--version").output().is_ok_and(|output| output.status.success())
}

/// Runs a command that must succeed.
pub fn run(command: &mut Command) -> String {
    let output: Output = command.output().unwrap_or_else(|error| panic!("{command:?}: {error}"));
    let (out, err) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success(), "{command:?}\n{out}\n{err}");
    out.into_owned()
}

/// The folder with what cargo has built: this test lies in its `deps`.
fn built() -> PathBuf {
    std::env::current_exe().unwrap().parent().unwrap().parent().unwrap().to_owned()
}

/// The program, the libraries and the manual in one folder, as `make library` leaves them.
fn gathered(into: &Path) {
    // The libraries were built along with this test. The program is the one of the default features, whatever others the tests are built with.
    let profile = if built().ends_with("release") { "release" } else { "test" };
    let mut cargo = Command::new(env!("CARGO"));
    cargo.current_dir(top()).args(["build", "--locked", "--quiet", "--profile", profile]);
    run(cargo.args(["--bin", "patchlight", "--example", "manual"]));
    let link = |from: PathBuf, name: &str| std::os::unix::fs::symlink(from, into.join(name)).unwrap();
    link(built().join("patchlight"), "patchlight");
    for library in ["libpatchlight_capi.so", "libpatchlight_capi.a"] {
        link(built().join("deps").join(library), library);
    }
    run(Command::new(built().join("examples/manual")).arg(into.join("manual")));
}

/// A prefix into which everything was installed.
pub struct Installed {
    folder: PathBuf,
}

impl Installed {
    /// Installs, once for all tests of a file.
    pub fn get() -> &'static Self {
        static INSTALLED: OnceLock<Installed> = OnceLock::new();
        INSTALLED.get_or_init(|| {
            // Below the build's own folder, where the next run clears what this one leaves: a static is never dropped.
            let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(env!("CARGO_CRATE_NAME"));
            if folder.exists() {
                fs::remove_dir_all(&folder).unwrap();
            }
            let built = folder.join("built");
            fs::create_dir_all(&built).unwrap();
            gathered(&built);
            let installed = Self { folder };
            run(installed.script("install"));
            installed
        })
    }

    /// The script that installs, or takes away.
    pub fn script(&self, action: &str) -> &'static mut Command {
        let mut command = Command::new(top().join("scripts/install.sh"));
        command.args([action.as_ref(), self.folder.join("built").as_os_str()]);
        command.env("PREFIX", self.prefix()).env_remove("LIBDIR").env_remove("DESTDIR");
        Box::leak(Box::new(command))
    }

    pub fn prefix(&self) -> PathBuf {
        self.folder.join("prefix")
    }

    /// A folder for what a test builds.
    pub fn scratch(&self, name: &str) -> PathBuf {
        let path = self.folder.join(name);
        fs::create_dir_all(&path).unwrap();
        path
    }

    /// The installed program.
    pub fn program(&self) -> Command {
        Command::new(self.prefix().join("bin/patchlight"))
    }

    /// The flags that pkg-config gives.
    pub fn flags(&self, arguments: &[&str]) -> Vec<String> {
        let mut command = Command::new("pkg-config");
        command.args(arguments).arg("patchlight").env("PKG_CONFIG_PATH", self.prefix().join("lib/pkgconfig"));
        run(&mut command).split_whitespace().map(str::to_owned).collect()
    }

    /// A command that finds the shared library.
    pub fn with_library(&self, mut command: Command) -> Command {
        command.env("LD_LIBRARY_PATH", self.prefix().join("lib"));
        command
    }

    /// Builds a C program with what is installed.
    pub fn build(&self, build: &Build<'_>) -> PathBuf {
        let name = Path::new(build.source).file_stem().unwrap().to_str().unwrap();
        let is_cpp = build.compiler == "g++";
        let into = self.scratch(build.name).join(name);
        let mut command = Command::new(build.compiler);
        command.args(["-g", "-O1", "-Wall", "-Wextra", "-Werror", "-pedantic"]);
        command.arg(if is_cpp { "-std=c++11" } else { "-std=c99" });
        // Declarations of POSIX and Linux; C++ has them anyway.
        command.arg("-D_GNU_SOURCE").args(build.flags).arg("-I").arg(top().join("examples/c"));
        command.args(if is_cpp { &["-x", "c++"][..] } else { &[] }).arg(top().join(build.source));
        command.args(["-x", "none", "-o"]).arg(&into);
        if build.is_static {
            command.args(self.flags(&["--cflags"])).arg(self.prefix().join("lib/libpatchlight.a"));
            command.args(self.flags(&["--static", "--libs-only-l"]).iter().filter(|flag| *flag != "-lpatchlight"));
        } else {
            command.args(self.flags(&["--cflags", "--libs"]));
        }
        run(command.args(build.libraries).args(["-lm", "-lpthread"]));
        into
    }
}

/// How a program is built.
#[derive(Clone, Copy)]
pub struct Build<'a> {
    /// Of the folder that it is built in.
    pub name: &'a str,
    /// Below the top.
    pub source: &'a str,
    pub compiler: &'a str,
    pub flags: &'a [&'a str],
    pub libraries: &'a [&'a str],
    pub is_static: bool,
}

impl<'a> Build<'a> {
    /// By gcc, with the shared library.
    pub fn plain(source: &'a str) -> Self {
        Self { name: "plain", source, compiler: "gcc", flags: &[], libraries: &[], is_static: false }
    }
}

/// The examples in C.
pub const EXAMPLES: [&str; 8] = ["room", "progress", "bands", "visibility", "many_lights", "form_factors", "mesh", "relight"];
