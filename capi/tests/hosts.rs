//! C programs as hosts: under Valgrind, with ASan and TSan on their side, with threads and an Embree scene of their own.
#![cfg(target_os = "linux")]
#![allow(clippy::print_stdout, reason = "a test tells what it measured")]

mod support;

use std::process::Command;

use support::{Build, EXAMPLES, Installed, is_there, run, skip, top};

#[test]
fn examples_and_hosts_are_clean_by_address_sanitizer() {
    let installed = Installed::get();
    let sources = EXAMPLES.map(|of| format!("examples/c/{of}.c")).into_iter().chain(["capi/tests/c/threads.c".to_owned()]);
    for source in sources.filter(|source| !source.contains("room")) {
        let flags = ["-fsanitize=address,undefined", "-fno-sanitize-recover=all"];
        let program = installed.build(&Build { name: "asan", flags: &flags, ..Build::plain(&source) });
        let mut command = Command::new(program);
        // Embree and its scheduler keep what they have until the end.
        command.arg("obvhs").env("ASAN_OPTIONS", "detect_leaks=1");
        run(&mut installed.with_library(command));
    }
}

#[test]
fn threads_of_a_host_are_clean_by_thread_sanitizer() {
    let installed = Installed::get();
    let flags = ["-fsanitize=thread"];
    let program = installed.build(&Build { name: "tsan", flags: &flags, ..Build::plain("capi/tests/c/threads.c") });
    let mut command = Command::new(&program);
    let suppressions = top().join("capi/tests/c/tsan.supp");
    command.env("TSAN_OPTIONS", format!("suppressions={}", suppressions.display()));
    let output = installed.with_library(command).output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    if said.contains("unexpected memory mapping") {
        return skip("this kernel's memory layout is not one that gcc's thread sanitizer knows");
    }
    assert!(output.status.success(), "{said}");
}

#[test]
fn examples_are_clean_by_valgrind() {
    if !is_there("valgrind") {
        return skip("no valgrind; make setup installs it");
    }
    let installed = Installed::get();
    for source in ["examples/c/visibility.c", "examples/c/mesh.c", "capi/tests/c/hostile.c"] {
        let program = installed.build(&Build::plain(source));
        let mut command = Command::new("valgrind");
        command
            .args(["--quiet", "--error-exitcode=9", "--leak-check=full", "--errors-for-leak-kinds=definite"])
            .arg(program)
            .arg("obvhs");
        run(&mut installed.with_library(command));
    }
}

#[test]
fn eight_threads_share_a_context() {
    let installed = Installed::get();
    for compiler in ["gcc", "g++"] {
        let build = Build { name: compiler, compiler, ..Build::plain("capi/tests/c/threads.c") };
        run(&mut installed.with_library(Command::new(installed.build(&build))));
    }
}

#[test]
fn hostile_calls_from_c_end_with_a_status() {
    let installed = Installed::get();
    run(&mut installed.with_library(Command::new(installed.build(&Build::plain("capi/tests/c/hostile.c")))));
}

#[test]
fn a_program_of_the_first_version_runs() {
    let installed = Installed::get();
    run(&mut installed.with_library(Command::new(installed.build(&Build::plain("capi/tests/c/old.c")))));
}

/// Makes, solves and lets go, so many times.
fn again(times: &str) {
    let installed = Installed::get();
    let program = installed.build(&Build::plain("capi/tests/c/again.c"));
    for backend in ["obvhs", "auto"] {
        let mut command = Command::new(&program);
        command.args([times, backend]);
        println!("{backend}: {}", run(&mut installed.with_library(command)));
    }
}

#[test]
fn memory_does_not_grow() {
    again("40");
}

#[test]
#[ignore = "takes some minutes"]
fn memory_does_not_grow_in_a_thousand_rounds() {
    again("1000");
}

#[test]
fn a_host_that_traces_its_own_embree_scene_is_left_alone() {
    let header =
        ["embree4", "embree3"].into_iter().find(|name| std::path::Path::new("/usr/include").join(name).join("rtcore.h").is_file());
    let Some(name) = header.filter(|_| patchlight::visibility::Backend::Embree.is_built()) else {
        return skip("no Embree of the system's, so no host that uses it");
    };
    if !cfg!(target_arch = "x86_64") {
        return skip("the floating-point state of the host is set for x86-64 alone");
    }
    let installed = Installed::get();
    let (define, library) = (format!("-DEMBREE_HEADER=<{name}/rtcore.h>"), format!("-l{name}"));
    // Embree's own headers are not pedantic.
    let flags = [define.as_str(), "-Wno-pedantic", "-Wno-unused-parameter", "-std=gnu11", "-isystem", "/usr/include"];
    let build = Build { name: "host", flags: &flags, libraries: &[&library], ..Build::plain("capi/tests/c/host.c") };
    run(&mut installed.with_library(Command::new(installed.build(&build))));
}
