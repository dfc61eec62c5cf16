//! Light groups as they are typed and told: how emitters are grouped, with what groups are weighted, and what is known of them.
//!
//! A file of groups is TOML, a group on each line: `lamps = ["object desk lamp", "material tube"]`.

use std::fs;
use std::path::{Path, PathBuf};

use patchlight::scene::{EmitterName, LightGrouping, LightWeight, Scene};
use patchlight::solve::{ErrorFigure, LightGroupsReport};

use super::exit::Failure;
use super::progress::Voice;
use super::reader;

/// How emitters are grouped.
#[derive(Debug)]
pub struct Grouping {
    grouping: LightGrouping,
    /// The file that says so.
    file: Option<PathBuf>,
}

impl Grouping {
    /// By `material`, by `object`, or as a file says.
    pub fn new(typed: &Path) -> Result<Self, Failure> {
        let by_name = match typed.to_str() {
            Some("material") => Some(LightGrouping::Materials),
            Some("object") => Some(LightGrouping::Objects),
            _ => None,
        };
        if let Some(grouping) = by_name {
            return Ok(Self { grouping, file: None });
        }
        let bad = |error| {
            Failure::bad_input(format_args!(
                "--light-groups {}: {error}; write material, object or a file that names groups",
                typed.display()
            ))
        };
        let text = fs::read_to_string(typed).map_err(bad)?;
        let groups = reader::read(typed, &text, |table| {
            let group = |entry: reader::Entry<'_>| {
                let lights = |said: reader::Said| said.text.parse::<EmitterName>().map_err(|why| said.wrong(why));
                Ok((entry.key.to_owned(), entry.several()?.into_iter().map(lights).collect::<Result<_, _>>()?))
            };
            table.entries().into_iter().map(group).collect::<Result<Vec<_>, Failure>>()
        })?;
        Ok(Self { grouping: LightGrouping::Named(groups), file: Some(typed.to_owned()) })
    }

    /// The file that says so.
    pub fn file(&self) -> Option<&Path> {
        self.file.as_deref()
    }

    /// A scene with these groups.
    pub fn apply_to(&self, scene: &Scene) -> Result<Scene, Failure> {
        scene.with_light_groups(&self.grouping).map_err(|error| match &self.file {
            Some(file) => Failure::bad_input(format_args!("{}: {error}", file.display())),
            None => Failure::usage(error),
        })
    }
}

/// Weights of groups: `NAME=W`, or `NAME=W,W,W` with one for each channel.
pub fn parse_weight(typed: &str) -> Result<LightWeight, Failure> {
    let bad = || {
        Failure::usage(format_args!(
            "--set {typed}: write --set GROUP=W, as in lamp=0.5, or a weight for each channel, as in lamp=0,0,2"
        ))
    };
    let (group, weights) = typed.rsplit_once('=').ok_or_else(bad)?;
    let by_band: Vec<f64> = weights.split(',').map(|weight| weight.trim().parse().map_err(|_| bad())).collect::<Result<_, _>>()?;
    Ok(LightWeight { group: group.trim().to_owned(), by_band })
}

/// Weights as they are typed: one if all channels have the same.
pub fn weight_in_words(weights: &[f64]) -> String {
    let all: Vec<String> = weights.iter().map(f64::to_string).collect();
    if weights.iter().all(|weight| *weight == weights[0]) { all[0].clone() } else { all.join(",") }
}

/// Tells of light groups, each with its claim, and of all of them as they are weighted.
pub fn tell_groups(voice: Voice, known: &LightGroupsReport) {
    let claim = |error: &ErrorFigure| {
        if error.estimate.is_finite() {
            format!("{:.2}% claimed", 100.0 * error.estimate)
        } else {
            "nothing can be claimed".to_owned()
        }
    };
    let claims = |error: &ErrorFigure, mesh: &Option<ErrorFigure>| {
        let of_mesh = mesh.as_ref().map_or(String::new(), |mesh| format!(", of the lit mesh {}", claim(mesh)));
        format!("{} by energy{of_mesh}", claim(error))
    };
    for group in &known.groups {
        let weight = weight_in_words(&group.weights);
        voice.figure("group", format_args!("{}: weight {weight}; alone {}", group.name, claims(&group.error, &group.lit_mesh)));
    }
    voice.figure("groups", format_args!("all together {}", claims(&known.error, &known.lit_mesh)));
}
