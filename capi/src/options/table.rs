//! All options: those that decide the answer, from the table of the library, and those of the run.

use patchlight::solve::{OptionEntry, OptionType, RunOptions, SolveOptions};
use patchlight::visibility::Backend;

use crate::status::{Ending, Outcome, PATCHLIGHT_OUT_OF_RANGE, PATCHLIGHT_UNKNOWN_OPTION};

/// What an option's value is. Values may be added.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum patchlight_option_type {
    /// A number: patchlight_options_set_double.
    PATCHLIGHT_OPTION_DOUBLE = 1,
    /// A whole number: patchlight_options_set_uint64.
    PATCHLIGHT_OPTION_UINT64 = 2,
    /// Yes or no: patchlight_options_set_bool.
    PATCHLIGHT_OPTION_BOOL = 3,
    /// A name or other text: patchlight_options_set_text, which takes the others as text too.
    PATCHLIGHT_OPTION_TEXT = 4,
}

use patchlight_option_type::*;

/// The values of all options.
#[derive(Clone, Default)]
pub struct Settings {
    pub solve: SolveOptions,
    pub run: RunOptions,
}

/// An option of the run: none of them changes the answer, but limits may end it early.
pub struct RunEntry {
    key: &'static str,
    help: &'static str,
    unit: &'static str,
    value_type: patchlight_option_type,
    range: fn() -> String,
    show: fn(&RunOptions) -> Option<String>,
    /// Sets it from text; `false` for what is not legal.
    set: fn(&mut RunOptions, &str) -> bool,
    reset: fn(&mut RunOptions),
}

const BYTES_OF_GB: f64 = 1e9;

fn positive(text: &str) -> Option<f64> {
    text.trim().parse::<f64>().ok().filter(|x| x.is_finite() && *x > 0.0)
}

const RUN: [RunEntry; 3] = [
    RunEntry {
        key: "backend",
        help: "Who answers visibility, if no functions of the caller's do.",
        unit: "",
        value_type: PATCHLIGHT_OPTION_TEXT,
        range: || Backend::NAMES.join(", "),
        show: |run| Some(run.backend.name().to_owned()),
        set: |run, text| text.trim().parse().map(|backend| run.backend = backend).is_ok(),
        reset: |run| run.backend = Backend::default(),
    },
    RunEntry {
        key: "time",
        help: "Stop after this time. If not set, there is no limit.",
        unit: "seconds",
        value_type: PATCHLIGHT_OPTION_DOUBLE,
        range: || "a number above 0 and below 3.2e13".to_owned(),
        show: |run| run.time_s.map(|seconds| seconds.to_string()),
        set: |run, text| {
            let time_s = positive(text);
            let is_legal = time_s.is_some() && RunOptions { time_s, ..RunOptions::default() }.validate().is_ok();
            if is_legal {
                run.time_s = time_s;
            }
            is_legal
        },
        reset: |run| run.time_s = None,
    },
    RunEntry {
        key: "memory",
        help: "Stop when nodes and links would take more than this. The process takes up to five times as much. If not set, there is no limit.",
        unit: "GB (1e9 bytes)",
        value_type: PATCHLIGHT_OPTION_DOUBLE,
        range: || "a number above 0".to_owned(),
        show: |run| run.memory_bytes.map(|bytes| (bytes as f64 / BYTES_OF_GB).to_string()),
        set: |run, text| positive(text).map(|gb| run.memory_bytes = Some((gb * BYTES_OF_GB) as u64)).is_some(),
        reset: |run| run.memory_bytes = None,
    },
];

/// Keys of the command line that belong elsewhere here.
const ELSEWHERE: [(&str, &str); 2] = [
    ("threads", "threads belong to the context: patchlight_context_create"),
    ("sides", "sides belong to the scene: patchlight_scene_create"),
];

/// An option.
pub enum Entry {
    Solve(&'static OptionEntry),
    Run(&'static RunEntry),
}

/// All options.
pub fn entries() -> impl Iterator<Item = Entry> {
    static RUN_ENTRIES: [RunEntry; 3] = RUN;
    SolveOptions::entries().map(Entry::Solve).chain(RUN_ENTRIES.iter().map(Entry::Run))
}

impl Entry {
    /// The option with this key.
    pub fn of_key(key: &str) -> Outcome<Self> {
        entries().find(|entry| entry.key() == key).ok_or_else(|| {
            let elsewhere = ELSEWHERE.iter().find(|(known, _)| *known == key).map(|(_, message)| (*message).to_owned());
            let keys = || entries().map(|entry| entry.key()).collect::<Vec<_>>().join(", ");
            let message = elsewhere.unwrap_or_else(|| format!("unknown option '{key}'; choose one of {}", keys()));
            Ending::new(PATCHLIGHT_UNKNOWN_OPTION, message)
        })
    }

    /// The option with this number.
    pub fn numbered(number: usize) -> Outcome<Self> {
        let message = || format!("there is no option {number}, there are {}", entries().count());
        entries().nth(number).ok_or_else(|| Ending::argument(message()))
    }

    pub fn key(&self) -> &'static str {
        match self {
            Self::Solve(entry) => entry.key,
            Self::Run(entry) => entry.key,
        }
    }

    pub fn help(&self) -> &'static str {
        match self {
            Self::Solve(entry) => entry.help,
            Self::Run(entry) => entry.help,
        }
    }

    pub fn unit(&self) -> &'static str {
        match self {
            Self::Solve(entry) => entry.unit,
            Self::Run(entry) => entry.unit,
        }
    }

    pub fn range(&self) -> String {
        match self {
            Self::Solve(entry) => entry.range(),
            Self::Run(entry) => (entry.range)(),
        }
    }

    pub fn value_type(&self) -> patchlight_option_type {
        match self {
            Self::Solve(entry) => match entry.value_type() {
                OptionType::Real => PATCHLIGHT_OPTION_DOUBLE,
                OptionType::Whole => PATCHLIGHT_OPTION_UINT64,
                OptionType::Flag => PATCHLIGHT_OPTION_BOOL,
                OptionType::Text => PATCHLIGHT_OPTION_TEXT,
            },
            Self::Run(entry) => entry.value_type,
        }
    }

    /// Its value as it is typed; `None` if nobody has given it.
    pub fn value(&self, settings: &Settings) -> Option<String> {
        match self {
            Self::Solve(entry) => entry.value(&settings.solve),
            Self::Run(entry) => (entry.show)(&settings.run),
        }
    }

    /// Sets it from text. A rule between options is looked at when they are used.
    pub fn set(&self, settings: &mut Settings, text: &str) -> Outcome {
        match self {
            Self::Solve(entry) => Ok(settings.solve.set(entry.key, text)?),
            Self::Run(entry) if (entry.set)(&mut settings.run, text) => Ok(()),
            Self::Run(entry) => {
                let message = format!("{} is {text}, it must be {}", entry.key, self.range());
                Err(Ending::new(PATCHLIGHT_OUT_OF_RANGE, message))
            }
        }
    }

    /// Sets it back to its default.
    pub fn reset(&self, settings: &mut Settings) -> Outcome {
        match self {
            Self::Solve(entry) => entry.reset(&mut settings.solve),
            Self::Run(entry) => (entry.reset)(&mut settings.run),
        }
        Ok(())
    }
}
