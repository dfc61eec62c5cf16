//! The layers of ARCHITECTURE.md: what each may import.

use std::collections::{BTreeMap, BTreeSet};

use super::modules::{Crate, Sources};
use super::sources;

/// The table of layers: what each may import.
fn allowed() -> BTreeMap<String, BTreeSet<String>> {
    let text = std::fs::read_to_string(super::root().join("ARCHITECTURE.md")).unwrap();
    let rows = text.lines().skip_while(|line| !line.starts_with("| layer |")).skip(2).take_while(|line| line.starts_with('|'));
    rows.map(|row| {
        let cells: Vec<&str> = row.trim_matches('|').split('|').map(str::trim).collect();
        let [layer, _, imports] = cells[..] else { panic!("three cells are needed: {row}") };
        (layer.to_owned(), imports.split(',').map(|name| name.trim().to_owned()).filter(|name| !name.is_empty()).collect())
    })
    .collect()
}

/// The layer of a file: the first part of its path below `src`.
fn layer_of(file: &str) -> &str {
    let first = file.trim_start_matches("src/").split('/').next().unwrap();
    first.strip_suffix(".rs").unwrap_or(first)
}

/// Each file of a crate with the layers that it names.
fn imports(of: &Crate) -> BTreeSet<(&str, String)> {
    of.absolute_paths().filter_map(|(file, path)| Some((file, path.into_iter().next()?))).collect()
}

#[test]
fn imports_are_found_in_every_form() {
    let code = "use crate::scene::{Scene, Surface};\nuse crate::{geometry::Aabb, links::{A, B}, solve};\nuse super::super::output::C;\n\
                fn f() { let x = crate::sweep::f(); $crate::m!() }\n#[cfg(test)] mod tests { use crate::inspect; }";
    let files = [("src/lib.rs", "mod a;"), ("src/a/mod.rs", "mod b;"), ("src/a/b.rs", code)];
    let made_up: Sources = files.map(|(file, text)| (file.to_owned(), text.to_owned())).into();
    let expected = ["geometry", "links", "output", "scene", "solve", "sweep"].map(|layer| ("src/a/b.rs", layer.to_owned()));
    assert_eq!(imports(&Crate::read(&made_up, "src/lib.rs")), BTreeSet::from(expected));
}

#[test]
fn layers_import_only_what_the_table_allows() {
    let (allowed, mut violations) = (allowed(), Vec::new());
    for (file, import) in imports(&Crate::read(&sources(), "src/lib.rs")) {
        let layer = layer_of(file);
        let may = allowed.get(layer).unwrap_or_else(|| panic!("{file}: layer '{layer}' is not in the table of ARCHITECTURE.md"));
        if import != layer && !may.contains(&import) {
            violations.push(format!("{file}: '{layer}' may not import '{import}'"));
        }
    }
    assert!(violations.is_empty(), "{}", violations.join("\n"));
}

#[test]
fn the_table_names_the_modules_of_the_crate_and_has_no_cycles() {
    let allowed = allowed();
    let lib = &sources()["src/lib.rs"];
    let modules: BTreeSet<String> = lib
        .lines()
        .filter_map(|line| Some(line.trim_start_matches("pub ").strip_prefix("mod ")?.strip_suffix(';')?.to_owned()))
        .collect();
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
    let sources = sources();
    let program = Crate::read(&sources, "src/main.rs");
    let imports = imports(&program);
    assert!(imports.iter().any(|(file, _)| file.starts_with("src/cli/")));
    assert!(imports.iter().all(|(_, import)| import == "cli"), "{imports:?}");
}
