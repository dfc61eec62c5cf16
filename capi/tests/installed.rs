//! What is installed: files, symbols, the examples in C and C++ by pkg-config and CMake, statically and dynamically.
#![cfg(target_os = "linux")]

mod support;

use std::fs;
use std::path::PathBuf;
use std::process::Command;

use support::{Build, EXAMPLES, Installed, is_there, run, skip, top};

fn example(name: &str) -> String {
    format!("examples/c/{name}.c")
}

#[test]
fn the_shared_library_has_a_soname_and_exports_its_functions_alone() {
    let library = Installed::get().prefix().join("lib/libpatchlight.so");
    let about = run(Command::new("objdump").arg("-p").arg(&library));
    assert!(about.lines().any(|line| line.split_whitespace().eq(["SONAME", "libpatchlight.so.0"])), "{about}");

    let symbols = run(Command::new("nm").args(["-D", "--defined-only"]).arg(&library));
    let mut exported: Vec<&str> = symbols.lines().filter_map(|line| line.split_whitespace().next_back()).collect();
    exported.sort_unstable();
    let header = fs::read_to_string(top().join("capi/include/patchlight.h")).unwrap();
    let mut declared: Vec<&str> =
        header.lines().filter_map(|line| line.strip_prefix("patchlight_status ")?.split_once('(')).map(|(name, _)| name).collect();
    declared.sort_unstable();
    assert!(declared.len() > 40 && exported == declared, "exported {exported:?}\ndeclared {declared:?}");
}

#[test]
fn everything_is_installed_and_taken_away_again() {
    let installed = Installed::get();
    let root = installed.scratch("root");
    let script =
        |action| run(installed.script(action).env("PREFIX", "/opt/light").env("LIBDIR", "/opt/light/lib64").env("DESTDIR", &root));
    script("install");
    let find = || run(Command::new("find").arg(&root).args(["!", "-type", "d", "-printf", "%P\n"]));
    let found = find();
    for file in [
        "bin/patchlight",
        "include/patchlight.h",
        "lib64/libpatchlight.so",
        "lib64/libpatchlight.so.0",
        "lib64/libpatchlight.so.0.1.0",
        "lib64/libpatchlight.a",
        "lib64/pkgconfig/patchlight.pc",
        "lib64/cmake/patchlight/patchlight-config.cmake",
        "lib64/cmake/patchlight/patchlight-config-version.cmake",
        "share/man/man1/patchlight.1",
        "share/man/man1/patchlight-solve.1",
        "share/bash-completion/completions/patchlight",
        "share/zsh/site-functions/_patchlight",
        "share/fish/vendor_completions.d/patchlight.fish",
    ] {
        assert!(found.lines().any(|line| line == format!("opt/light/{file}")), "{file} is not in\n{found}");
    }
    // No file knows the folder that it was put together in, and no placeholder is left.
    for file in
        ["pkgconfig/patchlight.pc", "cmake/patchlight/patchlight-config.cmake", "cmake/patchlight/patchlight-config-version.cmake"]
    {
        let text = fs::read_to_string(root.join("opt/light/lib64").join(file)).unwrap();
        assert!(!text.contains(root.to_str().unwrap()) && !text.contains('@'), "{text}");
    }
    script("uninstall");
    assert_eq!(find(), "");
}

/// The program is installed as the defaults build it, without MPI, whatever the tests at the top are built with.
#[test]
fn started_several_times_without_mpi_it_does_not_do_all_several_times() {
    let installed = Installed::get();
    let folder = installed.scratch("processes");
    let of_two = |more: &[(&str, &str)]| {
        let mut program = installed.program();
        program.arg("solve").arg(top().join("scenes/cornell.obj")).args([
            "--error",
            "0.3",
            "--progress",
            "none",
            "-o",
            "s.solution",
        ]);
        program
            .envs([("OMPI_COMM_WORLD_RANK", "0"), ("OMPI_COMM_WORLD_SIZE", "2")])
            .envs(more.iter().copied())
            .current_dir(&folder);
        program
    };
    let files = || Vec::from_iter(fs::read_dir(&folder).unwrap().map(|file| file.unwrap().file_name()));

    let output = of_two(&[]).output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{said}");
    for words in ["2 processes", "built without MPI", "--features mpi", "PATCHLIGHT_ALONE"] {
        assert!(said.contains(words), "{said}");
    }
    assert!(files().is_empty());

    run(&mut of_two(&[("PATCHLIGHT_ALONE", "1")]));
    assert_eq!(files(), ["s.solution"]);
}

#[test]
fn man_pages_and_completions_tell_of_the_program() {
    let share = Installed::get().prefix().join("share");
    let solve = fs::read_to_string(share.join("man/man1/patchlight-solve.1")).unwrap();
    assert!(solve.contains("expected_values") && solve.contains("Exit codes"), "{solve}");
    for file in
        ["bash-completion/completions/patchlight", "zsh/site-functions/_patchlight", "fish/vendor_completions.d/patchlight.fish"]
    {
        assert!(fs::read_to_string(share.join(file)).unwrap().contains("max-links"), "{file}");
    }
}

#[test]
fn examples_run_in_c_and_cpp_dynamically_and_statically() {
    let installed = Installed::get();
    for (compiler, is_static) in [("gcc", false), ("g++", false), ("gcc", true), ("g++", true)] {
        let name = format!("{compiler}-{is_static}");
        for (number, of) in EXAMPLES.into_iter().enumerate() {
            let source = example(of);
            let build = Build { name: &name, compiler, is_static, ..Build::plain(&source) };
            let program = installed.build(&build);
            // Each runs once either way; built are all.
            if is_static == (number % 2 == 0) && of != "room" {
                run(&mut installed.with_library(Command::new(program)));
            } else if is_static {
                let needed = run(Command::new("objdump").arg("-p").arg(program));
                assert!(!needed.contains("libpatchlight"), "{needed}");
            }
        }
    }
}

#[test]
fn examples_are_built_by_cmake() {
    if !is_there("cmake") {
        return skip("no cmake, so find_package(patchlight) is not tested; make setup installs it");
    }
    let installed = Installed::get();
    for (name, is_static) in [("cmake", "OFF"), ("cmake-static", "ON")] {
        let folder = installed.scratch(name);
        let mut configure = Command::new("cmake");
        configure.arg("-S").arg(top().join("examples/c")).arg("-B").arg(&folder);
        configure.arg(format!("-DCMAKE_PREFIX_PATH={}", installed.prefix().display())).arg(format!("-DSTATIC={is_static}"));
        run(&mut configure);
        run(Command::new("cmake").arg("--build").arg(&folder));
        // CMake puts the place of the library into the program.
        run(&mut Command::new(folder.join("form_factors")));
    }
}

#[test]
fn cmake_takes_no_other_minor_version() {
    if !is_there("cmake") {
        return skip("no cmake");
    }
    let installed = Installed::get();
    let folder = installed.scratch("cmake-version");
    let text = "cmake_minimum_required(VERSION 3.13)\nproject(a C)\nfind_package(patchlight 0.2 REQUIRED)\n";
    fs::write(folder.join("CMakeLists.txt"), text).unwrap();
    let mut configure = Command::new("cmake");
    configure.arg("-S").arg(&folder).arg("-B").arg(folder.join("build"));
    configure.arg(format!("-DCMAKE_PREFIX_PATH={}", installed.prefix().display()));
    assert!(!configure.output().unwrap().status.success());
}

#[test]
fn the_room_in_forty_lines_is_the_room_of_the_program() {
    let lines = fs::read_to_string(top().join(example("room"))).unwrap().lines().count();
    assert!(lines <= 40, "{lines} lines");

    let installed = Installed::get();
    let folder = installed.scratch("room");
    let (picture, points) = (folder.join("c.png"), folder.join("points.csv"));
    let program = installed.build(&Build { name: "room", ..Build::plain("examples/c/room.c") });
    let mut by_c = Command::new(program);
    by_c.arg(&picture);
    let by_c = run(&mut installed.with_library(by_c));

    // The same point, by the program.
    fs::write(&points, "x,y,z,nx,ny,nz\n2.05,0.41,2.05,0,1,0\n").unwrap();
    let mut by_program = installed.program();
    by_program.arg("solve").arg(top().join("scenes/room.obj")).args(["--error", "0.1", "--progress", "none", "--size", "160x120"]);
    let its_picture: PathBuf = folder.join("program.png");
    by_program.arg("--points").arg(&points).args(["--values", "-"]).arg("--image").arg(&its_picture);
    let by_program = run(&mut by_program);
    let numbers = |text: &str| text.trim().split(',').map(|number| number.parse::<f32>().unwrap().to_bits()).collect::<Vec<_>>();
    let row: Vec<&str> = by_program.lines().nth(1).unwrap().split(',').collect();
    assert_eq!(numbers(&by_c), numbers(&row[6..9].join(",")), "{by_c} {by_program}");
    // The files state options, of which the program counts its points: what is left is what can be seen.
    assert_eq!(fs::metadata(&picture).unwrap().len() > 1000, fs::metadata(&its_picture).unwrap().len() > 1000);
}

#[test]
fn the_ten_lines_of_the_documentation_work() {
    let page = fs::read_to_string(top().join("docs/c.md")).unwrap();
    let code = page.split("```c\n").nth(1).unwrap().split("```").next().unwrap();
    let installed = Installed::get();
    let source = installed.scratch("page").join("ten_lines.c");
    fs::write(&source, code).unwrap();
    let program = installed.build(&Build { name: "page", ..Build::plain(source.to_str().unwrap()) });
    let said = run(installed.with_library(Command::new(program)).current_dir(top()));
    assert!(said.starts_with("claimed error: ") && !said.contains('-'), "{said}");
}
