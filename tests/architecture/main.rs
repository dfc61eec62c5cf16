//! Holds the sources against the rules that ARCHITECTURE.md and CONTRIBUTING.md state.
//!
//! What does not keep them yet is listed in `exceptions.rs` and printed. The list is exact, so it can only shrink.

mod circles;
mod exceptions;
mod layers;
mod modules;
mod sizes;
mod tokens;

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io::Write as _;
use std::path::Path;

use exceptions::{IN_CIRCLES, LONG_FILES, LONG_FUNCTIONS, MANY_PARAMETERS};
use modules::{Crate, Sources};
use sizes::{MOST_LINES, MOST_LINES_OF_A_FILE, MOST_PARAMETERS, functions};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn add_sources(below: &str, found: &mut Sources) {
    for entry in fs::read_dir(root().join(below)).unwrap() {
        let entry = entry.unwrap();
        let path = format!("{below}/{}", entry.file_name().to_str().unwrap());
        if entry.file_type().unwrap().is_dir() {
            // What cargo-fuzz builds stands below `fuzz`.
            if entry.file_name() != "target" {
                add_sources(&path, found);
            }
        } else if path.ends_with(".rs") {
            found.insert(path, fs::read_to_string(entry.path()).unwrap());
        }
    }
}

/// All sources of the repository.
fn sources() -> Sources {
    let mut found: Sources =
        ["build.rs", "capi/build.rs"].map(|file| (file.to_owned(), fs::read_to_string(root().join(file)).unwrap())).into();
    for folder in ["src", "tests", "benches", "examples", "fuzz", "capi/src", "capi/tests", "capi/benches", "python/src"] {
        add_sources(folder, &mut found);
    }
    found
}

/// What breaks a rule and by how much, held against the exceptions: each of these must be needed, and none may grow.
fn complaints(rule: &str, most: usize, found: &BTreeMap<String, usize>, exceptions: &[(&str, usize)]) -> Vec<String> {
    let listed: BTreeMap<&str, usize> = exceptions.iter().copied().collect();
    let is_too_much = |what: &str, count: usize| count > listed.get(what).copied().unwrap_or(most);
    let broken = found.iter().filter(|(what, count)| is_too_much(what, **count));
    let is_kept = |what: &str| found.get(what).is_none_or(|&count| count <= most);
    let needless = listed.keys().filter(|what| is_kept(what));
    broken
        .map(|(what, count)| format!("{what}: {count} {rule}, at most {most} are allowed"))
        .chain(needless.map(|what| format!("{what}: keeps the rule, so it must go from tests/architecture/exceptions.rs")))
        .collect()
}

/// Prints past the harness, which shows nothing of a test that passes.
fn tell(line: &str) {
    std::io::stderr().write_all(format!("{line}\n").as_bytes()).unwrap();
}

fn check(rule: &str, most: usize, found: &BTreeMap<String, usize>, exceptions: &[(&str, usize)]) {
    for (what, _) in exceptions {
        tell(&format!("exception: {what}: {} {rule}", found.get(*what).unwrap_or(&0)));
    }
    let complaints = complaints(rule, most, found, exceptions);
    assert!(complaints.is_empty(), "\n{}", complaints.join("\n"));
}

/// The largest of what functions measure, by file and name.
fn of_functions(measure: impl Fn(&sizes::Function) -> usize) -> BTreeMap<String, usize> {
    let mut found = BTreeMap::new();
    for (file, text) in sources() {
        for function in functions(&text) {
            let largest = found.entry(format!("{file} {}", function.name)).or_insert(0);
            *largest = measure(&function).max(*largest);
        }
    }
    found
}

#[test]
fn exceptions_are_exact() {
    let found = BTreeMap::from([("a".to_owned(), 3), ("b".to_owned(), 2), ("c".to_owned(), 4)]);
    assert!(complaints("lines", 2, &found, &[("a", 3), ("c", 5)]).is_empty());
    for (exceptions, complained) in
        [([("a", 3), ("c", 3)], "c: 4"), ([("a", 3), ("b", 9)], "b: keeps"), ([("c", 4), ("d", 4)], "d: keeps")]
    {
        let all = complaints("lines", 2, &found, &exceptions);
        assert!(all.iter().any(|complaint| complaint.starts_with(complained)), "{all:?}");
    }
}

#[test]
fn functions_are_short() {
    check("lines", MOST_LINES, &of_functions(|function| function.lines), LONG_FUNCTIONS);
}

#[test]
fn functions_take_few_parameters() {
    check("parameters", MOST_PARAMETERS, &of_functions(|function| function.parameters), MANY_PARAMETERS);
}

#[test]
fn files_are_short() {
    let found = sources().into_iter().map(|(file, text)| (file, text.lines().count())).collect();
    check("lines", MOST_LINES_OF_A_FILE, &found, LONG_FILES);
}

#[test]
fn files_use_each_other_in_no_circle() {
    let (sources, mut found, mut shown) = (sources(), BTreeMap::new(), BTreeSet::new());
    for root in circles::roots(&sources) {
        let of = Crate::read(&sources, root);
        for (file, circle) in circles::files_in_circles(&circles::uses(&of)) {
            found.insert(file.to_owned(), circle.len());
            shown.insert(format!("{} -> {}", circle.join(" -> "), circle[0]));
        }
    }
    for circle in shown {
        tell(&format!("circle: {circle}"));
    }
    let exceptions: Vec<(&str, usize)> = IN_CIRCLES.iter().map(|file| (*file, usize::MAX)).collect();
    check("files in a circle", 0, &found, &exceptions);
}

#[test]
fn every_source_is_a_module_of_a_crate() {
    let sources = sources();
    let found: BTreeSet<String> = circles::roots(&sources)
        .flat_map(|root| Crate::read(&sources, root).files().map(str::to_owned).collect::<Vec<_>>())
        .collect();
    // Unit tests are no part of a crate.
    let is_missing = |file: &&String| !found.contains(*file) && !file.ends_with("/tests.rs");
    let missing: Vec<&String> = sources.keys().filter(is_missing).collect();
    assert!(missing.is_empty(), "these are never read: {missing:?}");
}

#[test]
fn unsafe_code_stands_where_it_may() {
    for (file, text) in sources().iter().filter(|(file, _)| file.starts_with("src/")) {
        let code = tokens::without_tests(&tokens::tokens(text));
        let has_unsafe = code.iter().any(|token| token.text == "unsafe");
        let may = file.starts_with("src/visibility/embree") || file == "src/output/openexr.rs";
        assert!(may || !has_unsafe, "{file} has unsafe code");
    }
}
