//! Holds the sources against the rules that ARCHITECTURE.md states.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// From here on a file should have been split.
const MOST_LINES: usize = 800;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The table of layers: what each may import.
fn allowed() -> BTreeMap<String, BTreeSet<String>> {
    let text = fs::read_to_string(root().join("ARCHITECTURE.md")).unwrap();
    let rows = text.lines().skip_while(|line| !line.starts_with("| layer |")).skip(2).take_while(|line| line.starts_with('|'));
    rows.map(|row| {
        let cells: Vec<&str> = row.trim_matches('|').split('|').map(str::trim).collect();
        let [layer, _, imports] = cells[..] else { panic!("three cells are needed: {row}") };
        (layer.to_owned(), imports.split(',').map(|name| name.trim().to_owned()).filter(|name| !name.is_empty()).collect())
    })
    .collect()
}

fn rust_files(directory: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(directory).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            rust_files(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

/// Files below `src` with their path from there.
fn sources() -> Vec<(String, String)> {
    let src = root().join("src");
    let mut files = Vec::new();
    rust_files(&src, &mut files);
    files.sort();
    let name = |path: &Path| path.strip_prefix(&src).unwrap().to_str().unwrap().replace('\\', "/");
    files.iter().map(|path| (name(path), fs::read_to_string(path).unwrap())).collect()
}

/// The layer of a file: the first part of its path.
fn layer_of(file: &str) -> &str {
    let first = file.split('/').next().unwrap();
    first.strip_suffix(".rs").unwrap_or(first)
}

/// The code without comments and unit tests, which may use what they like.
fn code(text: &str) -> String {
    let tests = text.find("#[cfg(test)]").unwrap_or(text.len());
    text[..tests].lines().map(|line| line.split("//").next().unwrap()).collect::<Vec<_>>().join("\n")
}

/// The modules that `crate::` paths name: `crate::name` and `crate::{name, other::thing}`.
fn imports(code: &str) -> BTreeSet<String> {
    let is_part = |c: char| c.is_alphanumeric() || c == '_';
    let leading_name = |text: &str| text.trim_start().chars().take_while(|&c| is_part(c)).collect::<String>();
    let mut names = BTreeSet::new();
    for (at, prefix) in code.match_indices("crate::") {
        // `$crate::` and names that end in "crate" are others.
        if code[..at].chars().next_back().is_some_and(|c| is_part(c) || c == '$') {
            continue;
        }
        let rest = &code[at + prefix.len()..];
        let Some(group) = rest.strip_prefix('{') else {
            names.insert(leading_name(rest));
            continue;
        };
        let (mut depth, mut start) = (0, 0);
        for (k, c) in group.char_indices() {
            match c {
                '{' => depth += 1,
                '}' if depth > 0 => depth -= 1,
                ',' | '}' if depth == 0 => {
                    names.insert(leading_name(&group[start..k]));
                    start = k + 1;
                    if c == '}' {
                        break;
                    }
                }
                _ => {}
            }
        }
    }
    names.remove("");
    names
}

#[test]
fn imports_are_found_in_every_form() {
    let code = "use crate::scene::{Scene, Surface};\nuse crate::{geometry::Aabb, links::{A, B}, solve};\nlet x = crate::sweep::f(); $crate::m!()";
    let expected = ["geometry", "links", "scene", "solve", "sweep"].map(str::to_owned);
    assert_eq!(imports(code), BTreeSet::from(expected));
}

#[test]
fn layers_import_only_what_the_table_allows() {
    let allowed = allowed();
    let mut violations = Vec::new();
    for (file, text) in sources() {
        let layer = layer_of(&file);
        if matches!(layer, "lib" | "main" | "cli") {
            continue;
        }
        let Some(may) = allowed.get(layer) else {
            violations.push(format!("src/{file}: layer '{layer}' is not in the table of ARCHITECTURE.md"));
            continue;
        };
        for import in imports(&code(&text)) {
            if import != layer && !may.contains(&import) {
                violations.push(format!("src/{file}: '{layer}' may not import '{import}'"));
            }
        }
    }
    assert!(violations.is_empty(), "{}", violations.join("\n"));
}

#[test]
fn the_table_names_the_modules_of_the_crate_and_has_no_cycles() {
    let allowed = allowed();
    let lib = fs::read_to_string(root().join("src/lib.rs")).unwrap();
    let modules: BTreeSet<String> =
        lib.lines().filter_map(|line| Some(line.strip_prefix("pub mod ")?.strip_suffix(';')?.to_owned())).collect();
    assert_eq!(allowed.keys().cloned().collect::<BTreeSet<_>>(), modules);

    // Take away layers whose imports are all gone already: what cannot be taken away is a cycle.
    let mut left = allowed.clone();
    while let Some(layer) = left.iter().find(|(_, imports)| imports.iter().all(|i| !left.contains_key(i))).map(|(l, _)| l.clone()) {
        left.remove(&layer);
    }
    assert!(left.is_empty(), "these layers import each other: {:?}", left.keys());
}

#[test]
fn the_program_sees_the_library_from_outside() {
    for (file, text) in sources().iter().filter(|(file, _)| file.starts_with("cli/")) {
        let imports = imports(&code(text));
        assert!(imports.iter().all(|name| name == "cli"), "src/{file} imports {imports:?}");
    }
}

#[test]
fn unsafe_code_stands_where_it_may() {
    for (file, text) in sources() {
        let code = code(&text);
        let has_unsafe = ["{", "impl", "fn"].iter().any(|what| code.contains(&["unsafe", what].join(" ")));
        let may = file.starts_with("visibility/embree") || file == "output/openexr.rs";
        assert!(may || !has_unsafe, "src/{file} has unsafe code");
    }
}

#[test]
fn files_stay_short() {
    for (file, text) in sources() {
        let lines = text.lines().count();
        assert!(lines <= MOST_LINES, "src/{file} has {lines} lines: split it");
    }
}
