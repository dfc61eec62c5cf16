//! The command line of the benchmark.

use std::ops::Range;
use std::path::PathBuf;

use patchlight::scene::Sides;

use super::norms::Norm;

/// Errors asked for where none are named.
const ERRORS: [f64; 4] = [0.1, 0.05, 0.02, 0.01];
const SEEDS: u64 = 10;
/// Rays of a reference, about: a minute or two on one core.
const MOST_RAYS: f64 = 4e8;

/// What to do.
pub struct Options {
    /// Words of which one must be in a scene's name; none for all scenes.
    names: Vec<String>,
    /// Scenes of the user's, in place of those of the suite.
    pub files: Vec<PathBuf>,
    /// Which sides of their faces emit and receive.
    pub sides: Sides,
    /// Numbers of random rooms, in place of the suite.
    pub random: Range<u64>,
    pub norm: Norm,
    pub errors: Vec<f64>,
    pub seeds: u64,
    /// Make references instead of running the program.
    pub references: bool,
    /// The most rays that one of them may take, about.
    pub most_rays: f64,
}

impl Options {
    /// `[NAME... | --file SCENE... [--sides front|both] | --random FIRST..END] [--norm local|energy] [--errors E,E...] [--seeds N] [--references [--rays N]]`
    pub fn read(mut arguments: impl Iterator<Item = String>) -> Result<Self, String> {
        let mut options = Self {
            names: vec![],
            files: vec![],
            sides: Sides::Front,
            random: 0..0,
            norm: Norm::Local,
            errors: ERRORS.to_vec(),
            seeds: SEEDS,
            references: false,
            most_rays: MOST_RAYS,
        };
        while let Some(argument) = arguments.next() {
            let mut value = || arguments.next().ok_or_else(|| format!("{argument} needs a value"));
            match argument.as_str() {
                "--file" => options.files.push(value()?.into()),
                "--sides" => options.sides = sides(&value()?)?,
                "--random" => options.random = range(&value()?)?,
                "--norm" => options.norm = value()?.parse()?,
                "--seeds" => options.seeds = number(&value()?)?,
                "--errors" => options.errors = value()?.split(',').map(number).collect::<Result<_, _>>()?,
                "--rays" => options.most_rays = number(&value()?)?,
                "--references" => options.references = true,
                // Cargo says this to every benchmark.
                "--bench" => {}
                name if name.starts_with("--") => return Err(format!("no option is named {name}")),
                name => options.names.push(name.to_owned()),
            }
        }
        Ok(options)
    }

    pub fn wants(&self, name: &str) -> bool {
        (self.names.is_empty() && self.files.is_empty() && self.random.is_empty())
            || self.names.iter().any(|word| name.contains(word.as_str()))
    }

    /// Whether the documents tell what comes of it.
    pub fn is_whole(&self) -> bool {
        self.names.is_empty()
            && self.files.is_empty()
            && self.random.is_empty()
            && self.norm == Norm::Local
            && self.errors == ERRORS
            && self.seeds == SEEDS
            && !self.references
    }
}

fn sides(text: &str) -> Result<Sides, String> {
    [Sides::Front, Sides::Both]
        .into_iter()
        .find(|sides| sides_name(*sides) == text)
        .ok_or_else(|| format!("'{text}' is neither front nor both"))
}

/// As the program takes it.
pub fn sides_name(sides: Sides) -> &'static str {
    match sides {
        Sides::Front => "front",
        Sides::Both => "both",
    }
}

fn range(text: &str) -> Result<Range<u64>, String> {
    let (first, end) = text.split_once("..").ok_or_else(|| format!("'{text}' is not FIRST..END"))?;
    Ok(number(first)?..number(end)?)
}

fn number<T: std::str::FromStr>(text: &str) -> Result<T, String> {
    text.parse().map_err(|_| format!("'{text}' is no number"))
}
