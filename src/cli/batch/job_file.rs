//! A file of jobs, as it is written.
//!
//! ```toml
//! scenes = ["room.obj"]                  # or one text; paths are relative to this file
//! name = "{scene}-{power}"               # if left out, jobs are named by their numbers
//! lights = "lights.toml"                # as of `patchlight solve --lights`
//! points = "P.csv"                       # where values are wanted
//! csv = "more.csv"                       # parameters: a column each, and a row for each combination
//!
//! [parameters]                           # each value of one with each of the others
//! power = { from = 0.5, to = 1.5, count = 3 }
//! wall = [[0.8, 0.8, 0.7], 0.2]
//!
//! [options]                              # all of `patchlight solve --set`
//! error = 0.05
//!
//! [materials.lamp]
//! exitance_factor = "{power}"
//!
//! [materials."white paint"]
//! reflectance = "{wall}"
//!
//! [outputs]
//! values = "{name}.csv"
//! image = ["{name}.png", "{name}.exr"]
//!
//! [picture]                              # the flags of `patchlight solve` that tell how pictures are taken
//! size = "320x240"
//! ```

use std::path::Path;

use super::super::changes::Property;
use super::super::exit::Failure;
use super::super::reader::{Entry, Said, Table, read};
use super::parameters::Parameter;

/// What the file says; names in brackets are not filled in.
#[derive(Debug, Default)]
pub struct JobFile {
    /// Paths of scenes.
    pub scenes: Vec<Said>,
    /// What jobs are named.
    pub name: Option<Said>,
    /// The path of a file of lights.
    pub lights: Option<Said>,
    /// The path of the points.
    pub points: Option<Said>,
    /// The path of a table of parameters.
    pub csv: Option<Said>,
    /// What varies, each with each.
    pub parameters: Vec<Parameter>,
    /// Options of the solve by key.
    pub options: Vec<Said>,
    /// Materials by name, and what becomes of them.
    pub materials: Vec<(String, Vec<Said>)>,
    /// Paths of outputs, by what they are: one of [`OUTPUTS`].
    pub outputs: Vec<Said>,
    /// How pictures are taken: one of [`PICTURE`].
    pub picture: Vec<Said>,
}

const KEYS: [&str; 10] = ["scenes", "name", "lights", "points", "csv", "parameters", "options", "materials", "outputs", "picture"];

/// What a job may write.
pub const OUTPUTS: [&str; 4] = ["solution", "values", "mesh", "image"];

/// What may be said about pictures.
pub const PICTURE: [&str; 7] = ["camera", "size", "exposure", "quantity", "from", "scale", "show"];

impl JobFile {
    /// Reads `text`, the text of the file at `path`.
    pub fn parse(path: &Path, text: &str) -> Result<Self, Failure> {
        let mut file = Self::default();
        read(path, text, |table| table.entries().into_iter().try_for_each(|entry| file.take(entry)))?;
        if file.scenes.is_empty() {
            return Err(Failure::bad_input(format_args!("{}: 'scenes' is missing: name a scene", path.display())));
        }
        Ok(file)
    }

    fn take(&mut self, entry: Entry<'_>) -> Result<(), Failure> {
        match entry.key {
            "scenes" => self.scenes = entry.several()?,
            "name" => self.name = Some(entry.said()?),
            "lights" => self.lights = Some(entry.said()?),
            "points" => self.points = Some(entry.said()?),
            "csv" => self.csv = Some(entry.said()?),
            "parameters" => self.parameters = each(entry, Parameter::new)?,
            "options" => self.options = each(entry, |option| option.said())?,
            "materials" => self.materials = each(entry, material)?,
            "outputs" => self.outputs = each(entry, |output| known(output, &OUTPUTS)?.several())?.concat(),
            "picture" => self.picture = each(entry, |flag| known(flag, &PICTURE)?.said())?,
            _ => return Err(entry.unknown(&KEYS)),
        }
        Ok(())
    }
}

/// Whatever stands in a table, each read by `read`.
fn each<R>(entry: Entry<'_>, read: impl Fn(Entry<'_>) -> Result<R, Failure>) -> Result<Vec<R>, Failure> {
    entry.table(|table: Table<'_>| table.entries().into_iter().map(read).collect())
}

fn known<'a>(entry: Entry<'a>, keys: &[&str]) -> Result<Entry<'a>, Failure> {
    if keys.contains(&entry.key) { Ok(entry) } else { Err(entry.unknown(keys)) }
}

/// A material by name, and what becomes of it.
fn material(entry: Entry<'_>) -> Result<(String, Vec<Said>), Failure> {
    Ok((entry.key.to_owned(), each(entry, |property| known(property, &Property::NAMES)?.said_or_numbers())?))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<JobFile, String> {
        JobFile::parse(Path::new("jobs.toml"), text).map_err(|failure| failure.message)
    }

    #[test]
    fn a_file_is_read_with_the_places_of_its_texts() {
        let text = "scenes = 'a.obj'\n[options]\nerror = 0.05\nseed = '{s}'\n[materials.'white paint']\nreflectance = [0.1, 0.2, 0.3]\n\
                    [outputs]\nimage = ['a.png', 'a.exr']\n[parameters]\ns = [2, 1]\n";
        let file = parse(text).unwrap();
        let said =
            |key: &str, text: &str, place: &str| Said { key: key.to_owned(), text: text.to_owned(), place: place.to_owned() };
        assert_eq!(file.scenes, [said("scenes", "a.obj", "jobs.toml:1: scenes")]);
        assert_eq!(file.options[0], said("error", "0.05", "jobs.toml:3: options.error"));
        assert_eq!(file.options[1], said("seed", "{s}", "jobs.toml:4: options.seed"));
        let change = said("reflectance", "0.1 0.2 0.3", "jobs.toml:6: materials.white paint.reflectance");
        assert_eq!(file.materials, [("white paint".to_owned(), vec![change])]);
        assert_eq!(file.outputs[1], said("image", "a.exr", "jobs.toml:8: outputs.image"));
        assert_eq!(file.parameters[0].values, ["2", "1"]);
    }

    #[test]
    fn what_is_wrong_is_told_with_line_and_key() {
        for (text, words) in [
            ("", "jobs.toml: 'scenes' is missing"),
            ("scenes = 'a.obj'\nscene = 1", "jobs.toml:2: scene: there is no such key, it must be one of scenes, name"),
            ("scenes = 'a.obj'\nscenes = 'b.obj'", "jobs.toml:2: duplicate key"),
            ("scenes = 'a.obj'\n\nname = [1]", "jobs.toml:3: name: it must be a text"),
            ("scenes = 'a.obj'\noptions = 1", "jobs.toml:2: options: it must be a table"),
            ("scenes = 'a.obj'\n[outputs]\nreport = 'a'", "jobs.toml:3: outputs.report: there is no such key"),
            ("scenes = 'a.obj'\n[materials.lamp]\ncolour = 1", "jobs.toml:3: materials.lamp.colour: there is no such key"),
            ("scenes = 'a.obj'\n[picture]\nlens = 1", "jobs.toml:3: picture.lens: there is no such key"),
        ] {
            let message = parse(text).unwrap_err();
            assert!(message.starts_with(words), "{text}: {message}");
        }
    }
}
