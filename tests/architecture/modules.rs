//! The modules of a crate, read from its sources, and which file defines what a path names.

use std::collections::BTreeMap;

use super::tokens::{Token, after_bracket, is, is_word, tokens, without_tests};

/// Texts of sources by their path from the root of the repository.
pub type Sources = BTreeMap<String, String>;

/// A path that code names: `crate::a::b`, `super::b` or `b`.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct NamedPath {
    pub segments: Vec<String>,
    pub kind: Kind,
}

#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Kind {
    /// Imported by `use` under this name, which is `*` for all names; exported again if it says `pub`.
    Import { name: String, is_public: bool },
    /// Written out where it is used.
    InPlace,
}

/// Which file holds a module, what it names, and the words of its code beside imports.
struct Module {
    file: String,
    parent: Option<usize>,
    name: String,
    children: BTreeMap<String, usize>,
    paths: Vec<NamedPath>,
    words: Vec<String>,
}

/// What a path leads to: a module by its number, or an item and the module that defines it.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Target {
    Module(usize),
    ItemOf(usize),
}

/// A crate as a tree of modules; the first is the root. Tests are no part of it.
pub struct Crate {
    modules: Vec<Module>,
}

/// A name is followed through so many imports: more are one that names itself, as `use a::{self}` does.
const MOST_IMPORTS: usize = 8;

impl Crate {
    /// Reads the crate whose root is this file. Modules that are not among the sources are left out.
    pub fn read(sources: &Sources, root: &str) -> Self {
        let mut found = Self { modules: Vec::new() };
        found.add_file(sources, root, "crate", None);
        found
    }

    fn add_file(&mut self, sources: &Sources, file: &str, name: &str, parent: Option<usize>) {
        let Some(text) = sources.get(file) else { return };
        let (folder, stem) = file.rsplit_once('/').map_or(("", file), |(folder, name)| (folder, name));
        let stem = stem.trim_end_matches(".rs");
        // Modules below a file lie in a folder of its name, unless the file is a root or a `mod.rs`.
        let below = if parent.is_none() || stem == "mod" { folder.to_owned() } else { format!("{folder}/{stem}") };
        let place = Place { sources, file, folder, below };
        self.add(&place, &without_tests(&tokens(text)), name, parent);
    }

    /// Adds a module with this code, and those below it.
    fn add(&mut self, place: &Place, code: &[Token], name: &str, parent: Option<usize>) {
        let id = self.modules.len();
        let (file, name) = (place.file.to_owned(), name.to_owned());
        self.modules.push(Module { file, parent, name, children: BTreeMap::new(), paths: Vec::new(), words: Vec::new() });
        if let Some(parent) = parent {
            let name = self.modules[id].name.clone();
            self.modules[parent].children.insert(name, id);
        }

        // Modules are taken out of the code, what is left is this module's own.
        let (mut own, mut at, mut path_of_next) = (Vec::new(), 0, None);
        while at < code.len() {
            let rest = &code[at..];
            if is(rest, &["#", "[", "path", "="]) {
                path_of_next = Some(rest[4].text.trim_matches('"'));
            }
            match rest {
                [keyword, name, sign, ..] if keyword.text == "mod" && is_word(name) && sign.text == ";" => {
                    for file in place.files_of(name.text, path_of_next.take()) {
                        self.add_file(place.sources, &file, name.text, Some(id));
                    }
                    at += 3;
                }
                [keyword, name, sign, ..] if keyword.text == "mod" && is_word(name) && sign.text == "{" => {
                    let end = after_bracket(code, at + 2);
                    let inside = Place { below: format!("{}/{}", place.below, name.text), ..*place };
                    self.add(&inside, &code[at + 3..end - 1], name.text, Some(id));
                    at = end;
                }
                _ => {
                    own.push(code[at]);
                    at += 1;
                }
            }
        }
        (self.modules[id].paths, self.modules[id].words) = paths_and_words(&own);
    }

    /// The files of its modules; one that holds several comes as often.
    pub fn files(&self) -> impl Iterator<Item = &str> {
        self.modules.iter().map(|module| module.file.as_str())
    }

    /// Each file with the paths that it names, from the root of the crate where they do not leave it: `super::b` in `a` is `b`.
    pub fn absolute_paths(&self) -> impl Iterator<Item = (&str, Vec<String>)> {
        self.modules.iter().enumerate().flat_map(move |(id, module)| {
            let absolute = move |path: &NamedPath| {
                let (start, rest) = self.start(id, &path.segments)?;
                let mut whole: Vec<String> = self.above(start).map(|module| module.name.clone()).collect();
                whole.pop();
                whole.reverse();
                whole.extend_from_slice(rest);
                Some((module.file.as_str(), whole))
            };
            module.paths.iter().filter_map(absolute)
        })
    }

    /// Pairs of files: the first uses what the second defines. What a file merely exports again it does not use.
    pub fn uses(&self) -> impl Iterator<Item = (&str, &str)> {
        self.modules.iter().enumerate().flat_map(move |(id, module)| {
            let used = move |path: &NamedPath| {
                if let Kind::Import { name, is_public: true } = &path.kind
                    && !module.words.contains(name)
                {
                    return None;
                }
                let is_glob = matches!(&path.kind, Kind::Import { name, .. } if name == "*");
                match self.resolve(id, &path.segments, MOST_IMPORTS)? {
                    Target::Module(_) if !is_glob => None,
                    Target::Module(found) | Target::ItemOf(found) => Some(self.modules[found].file.as_str()),
                }
            };
            module.paths.iter().filter_map(used).filter(|file| *file != module.file).map(|file| (module.file.as_str(), file))
        })
    }

    /// A module and all above it.
    fn above(&self, id: usize) -> impl Iterator<Item = &Module> {
        std::iter::successors(Some(&self.modules[id]), |module| module.parent.map(|parent| &self.modules[parent]))
    }

    /// Where a path starts that begins with `crate`, `self` or `super`, and what follows.
    fn start<'p>(&self, from: usize, segments: &'p [String]) -> Option<(usize, &'p [String])> {
        let (mut at, mut rest) = match segments.first()?.as_str() {
            "crate" => (0, &segments[1..]),
            "self" => (from, &segments[1..]),
            "super" => (from, segments),
            _ => return None,
        };
        while rest.first().is_some_and(|segment| segment == "super") {
            at = self.modules[at].parent?;
            rest = &rest[1..];
        }
        Some((at, rest))
    }

    /// What a path in a module leads to. Nothing, if out of the crate.
    fn resolve(&self, from: usize, segments: &[String], imports_left: usize) -> Option<Target> {
        let (mut at, mut rest) = match self.start(from, segments) {
            Some((start, rest)) => (start, rest),
            None => (from, segments),
        };
        while let Some((name, after)) = rest.split_first() {
            match self.member(at, name, after.is_empty(), imports_left) {
                Some(Target::Module(module)) => at = module,
                Some(item) => return Some(item),
                // What is no member and stands first is of this file, of another crate or of the standard library.
                None if rest.len() == segments.len() => return None,
                None => return Some(Target::ItemOf(at)),
            }
            rest = after;
        }
        Some(Target::Module(at))
    }

    /// What a module knows under a name, if that is a module or imported: imports first where an item is looked for.
    fn member(&self, at: usize, name: &str, is_last: bool, imports_left: usize) -> Option<Target> {
        let child = self.modules[at].children.get(name).map(|&child| Target::Module(child));
        if !is_last && child.is_some() {
            return child;
        }
        let imported = |path: &&NamedPath| matches!(&path.kind, Kind::Import { name: found, .. } if found == name);
        let mut imports = self.modules[at].paths.iter().filter(imported);
        let found = imports.find_map(|path| self.resolve(at, &path.segments, imports_left.checked_sub(1)?));
        found.or(child)
    }
}

/// Where a module's code stands, and where the files of the modules below it are looked for.
struct Place<'a> {
    sources: &'a Sources,
    file: &'a str,
    folder: &'a str,
    below: String,
}

impl Place<'_> {
    /// The files that `mod name;` can mean.
    fn files_of(&self, name: &str, path: Option<&str>) -> Vec<String> {
        match path {
            Some(path) => vec![normal(&format!("{}/{path}", self.folder))],
            None => [format!("{}/{name}.rs", self.below), format!("{}/{name}/mod.rs", self.below)].map(|file| normal(&file)).into(),
        }
    }
}

/// A path without `..` and empty parts.
fn normal(path: &str) -> String {
    let mut parts: Vec<&str> = Vec::new();
    for part in path.split('/').filter(|part| !part.is_empty()) {
        if part == ".." {
            parts.pop();
        } else {
            parts.push(part);
        }
    }
    parts.join("/")
}

/// The paths that code names, and the words beside imports that may be names of items: no fields, methods or names that it defines.
fn paths_and_words(code: &[Token]) -> (Vec<NamedPath>, Vec<String>) {
    let (mut paths, mut words, mut at, mut is_public) = (Vec::new(), Vec::new(), 0, false);
    while at < code.len() {
        match code[at].text {
            "use" => {
                at = add_tree(code, at + 1, &[], is_public, &mut paths);
                is_public = false;
            }
            "pub" => {
                is_public = true;
                at += 1;
                // `pub(crate)`
                if is(&code[at..], &["("]) && code.get(at + 2).is_some_and(|token| token.text == ")") {
                    at += 3;
                }
            }
            _ if is_word(&code[at]) => {
                let (before, start) = (at.checked_sub(1).map_or("", |before| code[before].text), at);
                let mut segments = vec![code[at].text.to_owned()];
                at += 1;
                while is(&code[at..], &["::"]) && code.get(at + 1).is_some_and(is_word) {
                    segments.push(code[at + 1].text.to_owned());
                    at += 2;
                }
                // `$crate` is another's; a word after `::` goes on after generics.
                if segments.len() > 1 && !["$", "::", "."].contains(&before) {
                    paths.push(NamedPath { segments: segments.clone(), kind: Kind::InPlace });
                }
                let is_field = is(&code[at..], &[":"]) && at == start + 1;
                if !is_field && ![".", "fn", "let", "::"].contains(&before) {
                    words.push(segments.swap_remove(0));
                }
                is_public = false;
            }
            _ => {
                is_public = false;
                at += 1;
            }
        }
    }
    (paths, words)
}

/// Adds the paths of what follows `use`, or a part of it inside braces; returns the place after it.
fn add_tree(code: &[Token], mut at: usize, prefix: &[String], is_public: bool, paths: &mut Vec<NamedPath>) -> usize {
    let mut segments = prefix.to_vec();
    while at < code.len() {
        match code[at].text {
            "::" => at += 1,
            "{" => {
                let end = after_bracket(code, at);
                at += 1;
                while at < end - 1 {
                    at = add_tree(code, at, &segments, is_public, paths);
                }
                // What stands behind the braces ends the tree.
                return if is(&code[end..], &[","]) || is(&code[end..], &[";"]) { end + 1 } else { end };
            }
            "," | ";" | "}" => break,
            "as" => at += 1,
            text => {
                segments.push(text.to_owned());
                at += 1;
            }
        }
        // `a as b`: the name is taken off the path again.
        if at >= 2 && code[at - 2].text == "as" {
            let name = segments.pop().unwrap();
            paths.push(NamedPath { segments, kind: Kind::Import { name, is_public } });
            return if is(&code[at..], &["}"]) { at } else { at + 1 };
        }
    }
    // `a::{self}` is `a`; `a::*` leads to `a`.
    let name = segments.last().cloned().unwrap_or_default();
    if name == "self" || name == "*" {
        segments.pop();
    }
    let name = if name == "self" { segments.last().cloned().unwrap_or_default() } else { name };
    paths.push(NamedPath { segments, kind: Kind::Import { name, is_public } });
    if is(&code[at..], &["}"]) { at } else { at + 1 }
}
