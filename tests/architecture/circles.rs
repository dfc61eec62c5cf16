//! Circles of files: each uses what the next defines, and the last what the first defines.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use super::modules::{Crate, Sources};

/// For each file the files that it uses.
pub type Uses<'a> = BTreeMap<&'a str, BTreeSet<&'a str>>;

/// The files of a crate and what they use of each other.
pub fn uses(of: &Crate) -> Uses<'_> {
    let mut found = Uses::new();
    for (file, used) in of.uses() {
        found.entry(file).or_default().insert(used);
    }
    found
}

/// A shortest circle through this file, if there is one: the files in order, each using the next.
fn circle_through<'a>(uses: &Uses<'a>, file: &'a str) -> Option<Vec<&'a str>> {
    let mut used_by: BTreeMap<&str, &str> = BTreeMap::new();
    let mut waiting = VecDeque::from([file]);
    while let Some(user) = waiting.pop_front() {
        for &used in uses.get(user).into_iter().flatten() {
            if used == file {
                let mut circle: Vec<&str> = std::iter::successors(Some(user), |at| used_by.get(at).copied()).collect();
                circle.reverse();
                return Some(circle);
            }
            if !used_by.contains_key(used) {
                used_by.insert(used, user);
                waiting.push_back(used);
            }
        }
    }
    None
}

/// Files that are part of a circle, each with a shortest one through it.
pub fn files_in_circles<'a>(uses: &Uses<'a>) -> BTreeMap<&'a str, Vec<&'a str>> {
    uses.keys().filter_map(|&file| Some((file, circle_through(uses, file)?))).collect()
}

/// The files that crates start from: programs, libraries, tests, benches, examples and fuzz targets.
pub fn roots(sources: &Sources) -> impl Iterator<Item = &str> {
    let folders = ["", "tests", "benches", "examples", "fuzz/fuzz_targets", "capi", "capi/tests", "capi/benches"];
    sources.keys().map(String::as_str).filter(move |file| {
        let (folder, name) = file.rsplit_once('/').unwrap_or(("", file));
        let above = folder.rsplit_once('/').map_or("", |(above, _)| above);
        folders.contains(&folder) || name == "lib.rs" || name == "main.rs" && (folder == "src" || folders.contains(&above))
    })
}

fn made_up(files: &[(&str, &str)]) -> Sources {
    files.iter().map(|(file, text)| ((*file).to_owned(), (*text).to_owned())).collect()
}

/// The shortest circles of made-up sources from their first file on, as `a -> b`.
fn circles(files: &[(&str, &str)]) -> BTreeSet<String> {
    let sources = made_up(files);
    let of = Crate::read(&sources, files[0].0);
    let uses = uses(&of);
    files_in_circles(&uses)
        .into_values()
        .filter(|circle| circle.iter().min() == circle.first())
        .map(|circle| circle.join(" -> "))
        .collect()
}

#[test]
fn no_circle_where_files_use_each_other_one_way() {
    let found = circles(&[
        ("src/lib.rs", "mod a; mod b;"),
        ("src/a.rs", "use crate::b::{self, B}; fn f() { b::g() }"),
        ("src/b.rs", "pub struct B; pub fn g() {} // use super::a::f;\n#[cfg(test)] mod tests { use crate::a; }"),
    ]);
    assert_eq!(found, BTreeSet::new());
}

#[test]
fn a_circle_of_two_and_one_of_three_are_found() {
    let found = circles(&[
        ("src/lib.rs", "mod a; mod b; mod c; mod d; mod e;"),
        ("src/a.rs", "use super::b::B; use crate::c::C;"),
        ("src/b.rs", "use crate::{d, a::{f, g}}; use d::D;"),
        ("src/c.rs", "fn f() { crate::e::f() }"),
        ("src/d.rs", "use super::c as other;\nfn f() { other::f() }"),
        ("src/e.rs", "use std::fmt; use crate::{\n    d::{self, D as A},\n};"),
    ]);
    assert_eq!(found, BTreeSet::from(["src/a.rs -> src/b.rs".to_owned(), "src/c.rs -> src/e.rs -> src/d.rs".to_owned()]));
}

#[test]
fn what_is_exported_again_is_of_the_file_that_defines_it() {
    // The first file only hands on what the others define.
    let apart = [
        ("src/a/mod.rs", "mod b; mod c; pub(crate) use self::b::{B as D, f}; pub use c::*;"),
        ("src/a/b.rs", "use super::C;"),
        ("src/a/c.rs", "pub struct C;"),
    ];
    assert_eq!(circles(&apart), BTreeSet::new());

    // It is one of a circle once it uses what it hands on.
    let joined = [("src/a/mod.rs", "mod b; pub use b::B; pub struct C { b: B }"), ("src/a/b.rs", "use super::C;")];
    assert_eq!(circles(&joined), BTreeSet::from(["src/a/b.rs -> src/a/mod.rs".to_owned()]));

    // The name leads to the file that defines the item, through as many hands as it takes.
    let through = [
        ("src/lib.rs", "mod a; mod d; use a::B;"),
        ("src/a/mod.rs", "mod b; pub use b::B as E; pub use E as B;"),
        ("src/a/b.rs", "use crate::d::D;"),
        ("src/d.rs", "use crate::a::E;"),
    ];
    assert_eq!(circles(&through), BTreeSet::from(["src/a/b.rs -> src/d.rs".to_owned()]));
}

#[test]
fn modules_are_found_in_folders_beside_the_crate_and_inside_files() {
    let found = circles(&[
        (
            "benches/x/main.rs",
            "#[path = \"../../tests/support/a.rs\"] mod a; mod b; const N: usize = 1; mod inside { use super::b::f; }",
        ),
        ("tests/support/a.rs", "use crate::b::f;"),
        ("benches/x/b.rs", "mod c; use super::N;"),
        ("benches/x/b/c.rs", "use super::super::a; fn f() { a::g::<u8>() }"),
    ]);
    assert_eq!(found, BTreeSet::from(["benches/x/b.rs -> benches/x/main.rs".to_owned()]));
}

#[test]
fn crates_start_from_known_places() {
    let files = ["build.rs", "src/lib.rs", "src/a/mod.rs", "src/a/main.rs", "tests/a.rs", "tests/b/main.rs", "tests/b/c.rs"];
    let sources = made_up(&files.map(|file| (file, "")));
    assert_eq!(roots(&sources).collect::<Vec<_>>(), ["build.rs", "src/lib.rs", "tests/a.rs", "tests/b/main.rs"]);
}
