//! Lights beside a scene: a TOML file, with a table for each light.
//!
//! ```toml
//! up = "z"                       # "x", "y" or "z", or three numbers; "y" if nothing is said
//! north = [0, 1, 0]              # where azimuths are 0
//!
//! [[point]]
//! name = "candle"
//! position = [1, 2, 1.5]         # in metres
//! intensity = [0.5, 0.3, 0.1]    # W/sr; or power, in W; or candela, or lumens, with colour or kelvin
//!
//! [[spot]]
//! position = [2, 2, 2.4]
//! direction = [0, 0, -1]         # or towards, a point
//! inner = 20                     # angles to the axis in degrees
//! outer = 30
//! lumens = 800
//! kelvin = 3000
//!
//! [[ies]]
//! file = "downlight.ies"         # relative to this file
//! position = [3, 2, 2.4]
//!
//! [[sun]]
//! azimuth = 150                  # in degrees from north over east; or direction, in which light goes
//! elevation = 40
//! lux = 80000                    # of what faces it; or irradiance, in W/m^2
//!
//! [[sky]]
//! kind = "overcast"              # or uniform, or clear with the place of the sun
//! lux = 10000                    # of the ground
//! ```

mod kelvin;
mod lamps;
mod numbers;
mod photometry;
mod place;
mod strength;
mod table;

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use toml::de::{DeTable, DeValue};

use super::text::read_regular_file;
use super::{Diagnostic, DiagnosticKind, Diagnostics, ImportError, ImportOptions};
use crate::scene::{LUMENS_PER_WATT, Light};
use lamps::Reader;
use place::Axes;
use table::{Table, Text};

/// Kinds of lights: the names of their tables.
const KINDS: [&str; 5] = ["point", "spot", "ies", "sun", "sky"];

/// Lights that were read, and what was noted.
#[derive(Clone, Debug)]
pub struct ImportedLights {
    /// In the order of the file.
    pub lights: Vec<Light>,
    /// What is worth knowing of them.
    pub diagnostics: Diagnostics,
    /// The file, and then the others that it names: photometric files.
    pub files: Vec<PathBuf>,
}

/// Reads the lights of the TOML file at `path`, for a scene of so many channels. With `allow_any_path` photometric files may lie anywhere, else beside
/// the file or below its folder.
///
/// # Errors
/// See [`ImportError`]: whatever is wrong is told with file and line.
pub fn read_lights(path: &Path, channels: usize, allow_any_path: bool) -> Result<ImportedLights, ImportError> {
    read_lights_of(path, channels, &ImportOptions { allow_any_path, ..ImportOptions::default() })
}

/// The same beside a scene that is read with these options, which may tell where up is.
pub(super) fn read_lights_of(path: &Path, channels: usize, options: &ImportOptions) -> Result<ImportedLights, ImportError> {
    let bytes = read_regular_file(path).map_err(|reason| ImportError::Unreadable { file: path.to_owned(), reason })?;
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&bytes);
    let text = std::str::from_utf8(bytes).map_err(|error| {
        Text { path, text: &String::from_utf8_lossy(bytes) }.wrong(error.valid_up_to(), "it is not UTF-8: save it as that")
    })?;
    let text = Text { path, text };
    let parsed = DeTable::parse(text.text).map_err(|error| {
        text.wrong(error.span().map_or(0, |span| span.start), format_args!("it is no TOML: {}", error.message()))
    })?;

    // The top, then the tables in the order of the file.
    let top = Table::new(&text, parsed.get_ref(), 0);
    let axes = Axes::of(&top, options.up)?;
    let tables = tables(&text, &top, parsed.get_ref())?;
    if tables.is_empty() {
        let reason = format_args!("it has no light: add a table of one, as [[point]]; kinds are {}", KINDS.join(", "));
        return Err(text.wrong(0, reason));
    }
    let mut reader = Reader::new(path, channels, options.allow_any_path, axes);
    let (mut lights, mut names) = (Vec::with_capacity(tables.len()), HashSet::new());
    for (number, (kind, table)) in tables.iter().enumerate() {
        let name = table.get("name").map(|name| name.text()).transpose()?;
        let name = name.map_or_else(|| format!("{kind} {}", number + 1), str::to_owned);
        if !names.insert(name.clone()) {
            return Err(table.wrong(format_args!("another light is named '{name}' already: give it a name of its own")));
        }
        let light = reader.light(kind, table, name)?;
        table.check_keys()?;
        light.wrong(channels).map_or(Ok(()), |reason| Err(table.wrong(reason)))?;
        lights.push(light);
    }

    let mut diagnostics = Diagnostics::default();
    if reader.photometric > 0 {
        let lights = reader.photometric;
        let text = format!("{lights} of {} lights are given by what an eye sees: {LUMENS_PER_WATT} lm are a watt", tables.len());
        diagnostics.push(Diagnostic::new(DiagnosticKind::Light, text).at(path, 0));
    }
    diagnostics.items.extend(reader.notes);
    Ok(ImportedLights { lights, diagnostics, files: [path.to_owned()].into_iter().chain(reader.files).collect() })
}

/// The tables of lights with their kinds, in the order of the file.
fn tables<'a>(text: &'a Text<'a>, top: &Table<'a>, all: &'a DeTable<'a>) -> Result<Vec<(&'static str, Table<'a>)>, ImportError> {
    let mut found = Vec::new();
    for kind in KINDS {
        top.get(kind);
        let Some((key, value)) = all.get_key_value(kind) else { continue };
        let no_list = || text.wrong(key.span().start, format_args!("write [[{kind}]], with two brackets: there may be several"));
        let DeValue::Array(items) = value.get_ref() else { return Err(no_list()) };
        for item in items.iter() {
            let DeValue::Table(table) = item.get_ref() else { return Err(no_list()) };
            found.push((item.span().start, kind, table));
        }
    }
    top.check_keys()?;
    found.sort_by_key(|&(at, ..)| at);
    Ok(found.into_iter().map(|(at, kind, table)| (kind, Table::new(text, table, at))).collect())
}
