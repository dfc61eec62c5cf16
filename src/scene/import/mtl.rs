//! Material libraries: `newmtl`, `Kd`, `Ke` and their textures of MTL files.
//!
//! The values are read by tobj. What goes into it is prepared here, because tobj 4.0 reads a library as a whole or not at all and
//! names no line: it panics on a `Kd` of one number (which the format allows: green and blue are then the same), refuses a whole
//! library for an `illum` or `Ns` that it cannot read, takes the last of two definitions, lets NaN through, and loses every value
//! before the first `newmtl`. So only the three keywords that a diffuse material needs are passed on, under numbered names.

use std::borrow::Cow;
use std::collections::{BTreeMap, HashMap};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use super::maps::Map;
use super::statements::statements;
use super::text::{decode, read_regular_file};
use super::{Diagnostic, DiagnosticKind, Diagnostics, ImportError};
use crate::scene::Material;

/// The reflectance of what has no material.
pub(super) const DEFAULT_REFLECTANCE: f64 = 0.5;

/// What a reflectance of 1 or more becomes: light must die out.
pub(super) const LARGEST_REFLECTANCE: f64 = 0.99;

/// What has no material.
pub(super) fn grey() -> Material {
    Material { name: String::new(), reflectance: vec![DEFAULT_REFLECTANCE; 3], exitance: vec![0.0; 3] }
}

/// Values from here on overflow in products of four.
pub(super) const LARGEST_VALUE: f64 = 1e30;

/// Where a material is defined.
struct Definition {
    name: String,
    file: PathBuf,
    line: u32,
    /// The line of each value, with its text; `None` where the material has none.
    reflectance: Option<(u32, String)>,
    radiance: Option<(u32, String)>,
    maps: Maps,
}

/// The textures of a material.
#[derive(Clone, Default)]
pub(super) struct Maps {
    /// The library that names them.
    pub file: PathBuf,
    pub colour: Option<Map>,
    pub radiance: Option<Map>,
    /// What they are multiplied by. A factor that is missing, or black, would hide its texture: it counts as white, as many programs write and
    /// read it.
    pub colour_factor: [f64; 3],
    pub radiance_factor: [f64; 3],
}

/// A library that cannot be read.
struct Missing {
    line: u32,
    library: PathBuf,
    reason: String,
}

/// The materials of all libraries, in the order in which they are defined.
#[derive(Default)]
pub(super) struct Libraries {
    files: Vec<PathBuf>,
    missing: Option<Missing>,
    definitions: Vec<Definition>,
    by_name: HashMap<String, u32>,
    ignored: BTreeMap<String, (usize, PathBuf, u32)>,
    /// Statements that are no part of the format: how many, and the first. They are not repeated: the file may be anything.
    unknown: Option<(usize, PathBuf, u32)>,
}

impl Libraries {
    /// Reads one library, if that is allowed. A missing one is a warning as long as nothing of it is needed, a malformed one an error.
    pub fn read(
        &mut self,
        file: &Path,
        is_allowed: bool,
        named_in: (&Path, u32),
        diagnostics: &mut Diagnostics,
    ) -> Result<(), ImportError> {
        let outside = || Err("it lies outside of the folder of the scene; allow that by --allow-any-path".to_owned());
        let bytes = match if is_allowed { read_regular_file(file) } else { outside() } {
            Ok(bytes) => bytes,
            Err(reason) => {
                let text = format!("material library {} cannot be read ({reason})", file.display());
                diagnostics.push(Diagnostic::new(DiagnosticKind::MissingLibrary, text).at(named_in.0, named_in.1));
                self.missing.get_or_insert(Missing { line: named_in.1, library: file.to_owned(), reason });
                return Ok(());
            }
        };
        self.files.push(file.to_owned());
        let (text, latin1) = decode(&bytes);
        if latin1 {
            diagnostics.push(Diagnostic::new(DiagnosticKind::NotUtf8, "the file is not UTF-8, read as Latin-1").at(file, 0));
        }
        self.read_text(&text, file, diagnostics)
    }

    fn read_text(&mut self, text: &str, file: &Path, diagnostics: &mut Diagnostics) -> Result<(), ImportError> {
        // The definition that values go to; `None` before the first and inside of a second one of the same name.
        let mut current: Option<usize> = None;
        let mut any = false;
        for statement in statements(text) {
            let line = statement.line;
            let words = &statement.arguments;
            let syntax = |reason: String| Err(ImportError::Syntax { file: file.to_owned(), line, face: None, reason });
            match &*statement.keyword {
                "newmtl" => {
                    any = true;
                    if words.is_empty() {
                        return syntax("'newmtl' without a name; give the material one".to_owned());
                    }
                    current = self.define(words, file, line, diagnostics);
                }
                key @ ("Kd" | "Ke") => {
                    if !any {
                        return syntax(format!("'{key}' stands before the first 'newmtl'; name the material first"));
                    }
                    if matches!(words.split_whitespace().next(), Some("spectral" | "xyz")) {
                        count(&mut self.ignored, &format!("{key} spectral or xyz"), file, line);
                        continue;
                    }
                    let Some(values) = three_numbers(words) else {
                        return syntax(format!("'{key} {words}' should be one or three numbers"));
                    };
                    if let Some(bad) = values.split_whitespace().find(|word| !is_representable(word)) {
                        let what = format!("{key} of a material");
                        return Err(ImportError::NotFinite { file: file.to_owned(), line, what, value: bad.to_owned() });
                    }
                    if let Some(current) = current {
                        let definition = &mut self.definitions[current];
                        let value = if key == "Kd" { &mut definition.reflectance } else { &mut definition.radiance };
                        *value = Some((line, values.into_owned()));
                    }
                }
                // What a diffuse material does not have: left out, and mentioned where it would show.
                "Ka" | "Ns" | "Ni" | "illum" | "sharpness" | "Tf" => {}
                key @ ("Ks" | "Tr") if shows(words, 0.0) => count(&mut self.ignored, key, file, line),
                "d" if shows(words.trim_start_matches("-halo"), 1.0) => count(&mut self.ignored, "d", file, line),
                "Ks" | "Tr" | "d" => {}
                key @ ("map_Kd" | "map_Ke") => {
                    let Some(map) = Map::parse(words, line) else { return syntax(format!("'{key}' names no image")) };
                    if map.is_modified {
                        count(&mut self.ignored, &format!("{key} -mm"), file, line);
                    }
                    if let Some(current) = current {
                        let maps = &mut self.definitions[current].maps;
                        *(if key == "map_Kd" { &mut maps.colour } else { &mut maps.radiance }) = Some(map);
                    }
                }
                key if key.starts_with("map_") || matches!(key, "bump" | "disp" | "decal" | "refl" | "norm") => {
                    count(&mut self.ignored, key, file, line);
                }
                _ => self.unknown.get_or_insert((0, file.to_owned(), line)).0 += 1,
            }
        }
        Ok(())
    }

    /// Starts a definition, unless there is one of that name.
    fn define(&mut self, name: &str, file: &Path, line: u32, diagnostics: &mut Diagnostics) -> Option<usize> {
        if let Some(&earlier) = self.by_name.get(name) {
            let text = format!(
                "material '{name}' is defined a second time; the definition in line {} of {} counts",
                self.definitions[earlier as usize].line,
                self.definitions[earlier as usize].file.display()
            );
            diagnostics.push(Diagnostic::new(DiagnosticKind::MaterialDefinedTwice, text).at(file, line));
            return None;
        }
        Some(self.push(Definition::new(name, file, line)))
    }

    fn push(&mut self, definition: Definition) -> usize {
        let index = self.definitions.len();
        self.by_name.insert(definition.name.clone(), index as u32);
        self.definitions.push(definition);
        index
    }

    /// The files that were read.
    pub fn take_files(&mut self) -> Vec<PathBuf> {
        std::mem::take(&mut self.files)
    }

    /// The textures of each material.
    pub fn maps(&self) -> Vec<Maps> {
        let of = |definition: &Definition| Maps {
            colour_factor: factor(&definition.reflectance),
            radiance_factor: factor(&definition.radiance),
            ..definition.maps.clone()
        };
        self.definitions.iter().map(of).collect()
    }

    /// The index of the material `name`, used in `line` of the scene; what is defined nowhere becomes grey with a warning, unless a library
    /// is missing.
    pub fn find_or_default(
        &mut self,
        name: &str,
        file: &Path,
        line: u32,
        diagnostics: &mut Diagnostics,
    ) -> Result<u32, ImportError> {
        if let Some(&index) = self.by_name.get(name) {
            return Ok(index);
        }
        if let Some(Missing { line, library, reason }) = &self.missing {
            let (library, reason) = (library.clone(), reason.clone());
            return Err(ImportError::MissingLibrary {
                file: file.to_owned(),
                line: *line,
                library,
                reason,
                material: name.to_owned(),
            });
        }
        let text = format!("material '{name}' is not defined: grey {DEFAULT_REFLECTANCE}");
        diagnostics.push(Diagnostic::new(DiagnosticKind::MissingMaterial, text).at(file, line).material(name));
        let grey = Some((0, format!("{DEFAULT_REFLECTANCE} {DEFAULT_REFLECTANCE} {DEFAULT_REFLECTANCE}")));
        Ok(self.push(Definition { reflectance: grey, ..Definition::new(name, file, line) }) as u32)
    }

    /// The text that tobj reads: material `k` is named `mk`.
    pub fn prepared(&self) -> String {
        let mut text = String::new();
        for (index, definition) in self.definitions.iter().enumerate() {
            let _ = writeln!(text, "newmtl m{index}");
            for (key, value) in [("Kd", &definition.reflectance), ("Ke", &definition.radiance)] {
                if let Some((_, value)) = value {
                    let _ = writeln!(text, "{key} {value}");
                }
            }
        }
        text
    }

    /// Makes materials of what tobj read, with the values brought into range. Only materials in `used` are worth a warning.
    pub fn into_materials(
        self,
        read: &[tobj::Material],
        used: &[bool],
        diagnostics: &mut Diagnostics,
    ) -> Result<Vec<Material>, ImportError> {
        let mut materials = Vec::with_capacity(self.definitions.len());
        for (index, definition) in self.definitions.iter().enumerate() {
            let used = used.get(index).copied().unwrap_or(false);
            let mut warn = |kind, line, text| {
                if used {
                    diagnostics.push(Diagnostic::new(kind, text).at(&definition.file, line).material(&definition.name));
                }
            };
            let parsed = read.get(index);
            materials.push(Material {
                name: definition.name.clone(),
                reflectance: definition.reflectance_in_range(parsed, &mut warn)?.to_vec(),
                exitance: definition.exitance_in_range(parsed, &mut warn)?.to_vec(),
            });
        }

        // What was left out, once for each keyword.
        for (key, (count, file, line)) in &self.ignored {
            let times = if *count == 1 { String::new() } else { format!(" ({count} times)") };
            let text = format!("'{key}'{times} is left out: materials are diffuse, with textures for Kd and Ke alone");
            diagnostics.push(Diagnostic::new(DiagnosticKind::IgnoredProperty, text).at(file, *line));
        }
        if let Some((count, file, line)) = &self.unknown {
            let text = format!("{count} statements from here on are unknown and left out");
            diagnostics.push(Diagnostic::new(DiagnosticKind::UnknownKeyword, text).at(file, *line));
        }
        Ok(materials)
    }
}

impl Definition {
    fn new(name: &str, file: &Path, line: u32) -> Self {
        let maps = Maps { file: file.to_owned(), ..Maps::default() };
        Self { name: name.to_owned(), file: file.to_owned(), line, reflectance: None, radiance: None, maps }
    }

    /// Reflectance: grey where there is none, raised to 0 and lowered to 0.99 where it is out of range.
    fn reflectance_in_range(
        &self,
        parsed: Option<&tobj::Material>,
        warn: &mut impl FnMut(DiagnosticKind, u32, String),
    ) -> Result<[f64; 3], ImportError> {
        let (name, line) = (&self.name, self.reflectance.as_ref().map_or(self.line, |value| value.0));
        let written = match self.values(parsed.and_then(|m| m.diffuse), &self.reflectance)? {
            Some(values) => values,
            None if self.maps.colour.is_some() => [DEFAULT_REFLECTANCE; 3],
            None => {
                let text = format!("material '{name}' has no Kd: grey {DEFAULT_REFLECTANCE}");
                warn(DiagnosticKind::NoReflectance, line, text);
                [DEFAULT_REFLECTANCE; 3]
            }
        };
        if written.iter().any(|&rho| rho >= 1.0) && self.maps.colour.is_none() {
            let text = format!("material '{name}' has Kd {}: 1 and more become {LARGEST_REFLECTANCE}", triple(written));
            warn(DiagnosticKind::ReflectanceClamped, line, text);
        }
        if written.iter().any(|&rho| rho < 0.0) {
            let text = format!("material '{name}' has Kd {}: negative values become 0", triple(written));
            warn(DiagnosticKind::NegativeValue, line, text);
        }
        // Adding 0 turns -0 into 0.
        Ok(written.map(|rho| if rho >= 1.0 { LARGEST_REFLECTANCE } else { rho.max(0.0) + 0.0 }))
    }

    /// Emission: MTL gives a radiance, the exitance of a diffuse emitter is pi times as much.
    fn exitance_in_range(
        &self,
        parsed: Option<&tobj::Material>,
        warn: &mut impl FnMut(DiagnosticKind, u32, String),
    ) -> Result<[f64; 3], ImportError> {
        let line = self.radiance.as_ref().map_or(self.line, |value| value.0);
        let radiance = self.values(parsed.and_then(|m| m.emissive), &self.radiance)?.unwrap_or([0.0; 3]);
        if radiance.iter().any(|&value| value < 0.0) {
            let text = format!("material '{}' has Ke {}: negative values become 0", self.name, triple(radiance));
            warn(DiagnosticKind::NegativeValue, line, text);
        }
        Ok(radiance.map(|value| std::f64::consts::PI * (value.max(0.0) + 0.0)))
    }

    /// What tobj read; an error where it read nothing from what is written.
    fn values(&self, read: Option<[f64; 3]>, written: &Option<(u32, String)>) -> Result<Option<[f64; 3]>, ImportError> {
        match (read, written) {
            (None, Some((line, text))) => Err(ImportError::Syntax {
                file: self.file.clone(),
                line: *line,
                face: None,
                reason: format!("'{text}' of material '{}' should be three numbers", self.name),
            }),
            _ => Ok(read),
        }
    }
}

/// Counts a keyword and keeps the place of its first use.
pub(super) fn count(counts: &mut BTreeMap<String, (usize, PathBuf, u32)>, key: &str, file: &Path, line: u32) {
    match counts.get_mut(key) {
        Some(entry) => entry.0 += 1,
        None => {
            counts.insert(key.to_owned(), (1, file.to_owned(), line));
        }
    }
}

/// Three numbers as text; one stands for three.
fn three_numbers(words: &str) -> Option<Cow<'_, str>> {
    let mut iter = words.split_whitespace();
    let (first, second, third, more) = (iter.next()?, iter.next(), iter.next(), iter.next());
    let number = |word: &str| word.parse::<f64>().is_ok() || is_not_a_number_word(word);
    match (second, third, more) {
        (None, None, None) => number(first).then(|| Cow::Owned(format!("{first} {first} {first}"))),
        (Some(second), Some(third), None) => [first, second, third].into_iter().all(number).then_some(Cow::Borrowed(words)),
        _ => None,
    }
}

/// Whether a word is a finite number below [`LARGEST_VALUE`].
pub(super) fn is_representable(word: &str) -> bool {
    word.parse::<f64>().is_ok_and(|value| value.abs() < LARGEST_VALUE)
}

/// Whether a word is one of the ways in which programs write NaN and infinity: `nan`, `-nan(ind)`, `inf`, `1.#QNAN`, `-1.#IND`.
pub(super) fn is_not_a_number_word(word: &str) -> bool {
    let word = word.trim_start_matches(['+', '-']).to_ascii_lowercase();
    word.starts_with("nan") || word.starts_with("inf") || word.starts_with("1.#")
}

/// Whether one of the numbers in `words` differs from the one that has no effect.
fn shows(words: &str, without_effect: f64) -> bool {
    words.split_whitespace().any(|word| word.parse::<f64>() != Ok(without_effect))
}

/// The numbers of a value, by which a texture is multiplied.
fn factor(value: &Option<(u32, String)>) -> [f64; 3] {
    let mut numbers = value.iter().flat_map(|(_, text)| text.split_whitespace()).map(|word| word.parse::<f64>().unwrap_or(0.0));
    let factor = [0; 3].map(|_| numbers.next().unwrap_or(0.0).max(0.0));
    if factor == [0.0; 3] { [1.0; 3] } else { factor }
}

fn triple(values: [f64; 3]) -> String {
    format!("{} {} {}", values[0], values[1], values[2])
}
