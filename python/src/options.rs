//! Options of a solve, by name: those of `patchlight solve --set key=value`, and those of the run.

use patchlight::solve::{OptionType, RunOptions, SolveOptions};
use patchlight::visibility::Backend;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyString};

use crate::errors::Failure;

const BYTES_OF_GB: f64 = 1e9;

/// An option of a solve, from `patchlight.options()`.
#[pyclass(frozen, get_all, module = "patchlight", name = "Option")]
pub struct OptionText {
    /// Its name, as in `solve(scene, key=value)`.
    key: String,
    /// What it does.
    help: String,
    /// "real", "whole", "flag" or "text".
    kind: &'static str,
    /// What is legal, as in "it must be ...".
    range: String,
    /// What a number of 1 stands for; empty where it needs no unit.
    unit: String,
    /// Its value as text if nobody sets it; None where that follows from other options or the scene.
    default: Option<String>,
}

#[pymethods]
impl OptionText {
    fn __repr__(&self) -> String {
        let Self { key, help, range, .. } = self;
        format!("<patchlight.Option {key}: {help} [{range}]>")
    }
}

fn name_of_type(kind: OptionType) -> &'static str {
    match kind {
        OptionType::Real => "real",
        OptionType::Whole => "whole",
        OptionType::Flag => "flag",
        OptionType::Text => "text",
    }
}

/// All options that `solve` takes by name, in their order.
#[pyfunction]
pub fn options() -> Vec<OptionText> {
    let of_solve = SolveOptions::entries().map(|entry| OptionText {
        key: entry.key.to_owned(),
        help: entry.help.to_owned(),
        kind: name_of_type(entry.value_type()),
        range: entry.range(),
        unit: entry.unit.to_owned(),
        default: entry.value(&SolveOptions::default()),
    });
    of_solve.chain(of_run()).collect()
}

/// The options that change no answer.
fn of_run() -> [OptionText; 3] {
    let option = |key: &str, help: &str, kind, range: String, unit: &str| {
        let (key, help, unit) = (key.to_owned(), help.to_owned(), unit.to_owned());
        OptionText { key, help, kind, range, unit, default: None }
    };
    let above_0 = || "a number above 0".to_owned();
    let backend = Backend::default().name().to_owned();
    [
        OptionText {
            default: Some(backend),
            ..option("backend", "Who answers visibility.", "text", Backend::NAMES.join(", "), "")
        },
        option("time", "Stop after this time. If not set, there is no limit.", "real", above_0(), "seconds"),
        option(
            "memory",
            "Stop when more than this would be taken. If not set, there is no limit.",
            "real",
            above_0(),
            "GB (1e9 bytes)",
        ),
    ]
}

/// What was asked for, read and validated.
#[derive(Default)]
pub struct Settings {
    pub solve: SolveOptions,
    pub run: RunOptions,
    /// Who is asked for memory, where `memory` is a function.
    pub memory: Option<Py<PyAny>>,
}

impl Settings {
    /// Of the error, and of options by name; None leaves an option alone.
    pub fn new(error: Option<f64>, given: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        let mut settings = Self::default();
        if let Some(error) = error {
            settings.set("error", &format!("{error:e}"))?;
        }
        for (key, value) in given.into_iter().flatten() {
            let key: String = key.extract()?;
            if key == "memory" && value.is_callable() {
                settings.memory = Some(value.unbind());
            } else if !value.is_none() {
                settings.set(&key, &typed(&key, &value)?)?;
            }
        }
        settings.solve.validate().map_err(Failure::from)?;
        settings.run.validate().map_err(Failure::from)?;
        Ok(settings)
    }

    fn set(&mut self, key: &str, value: &str) -> Result<(), Failure> {
        let above_0 = || {
            let number = value.parse::<f64>().ok().filter(|number| *number > 0.0 && number.is_finite());
            number.ok_or_else(|| Failure::option(format_args!("{key} is {value}, it must be a number above 0")))
        };
        match key {
            "backend" => self.run.backend = value.parse().map_err(|error| Failure::option(format_args!("backend: {error}")))?,
            "time" => self.run.time_s = Some(above_0()?),
            "memory" => self.run.memory_bytes = Some((above_0()? * BYTES_OF_GB) as u64),
            "sides" => return Err(Failure::option("sides belong to the scene: Scene.read(path, sides=...)")),
            _ => self.solve.set(key, value)?,
        }
        Ok(())
    }
}

/// A value as it would be typed. Its kind must be that of the option; text will do for all.
fn typed(key: &str, value: &Bound<'_, PyAny>) -> PyResult<String> {
    let wanted = match key {
        "time" | "memory" => Some(OptionType::Real),
        _ => SolveOptions::entry(key).ok().map(|entry| entry.value_type()),
    };
    let is_flag = value.cast::<PyBool>().is_ok() || value.get_type().name()? == "bool";
    let text = if value.cast::<PyString>().is_ok() {
        Some(value.extract::<String>()?)
    } else if is_flag {
        (wanted == Some(OptionType::Flag)).then(|| value.is_truthy()).transpose()?.map(|flag| flag.to_string())
    } else if value.cast::<PyInt>().is_ok() || value.hasattr("__index__")? {
        matches!(wanted, Some(OptionType::Whole | OptionType::Real))
            .then(|| value.call_method0("__index__"))
            .transpose()?
            .map(|whole| whole.to_string())
    } else if value.cast::<PyFloat>().is_ok() || value.hasattr("__float__")? {
        (wanted == Some(OptionType::Real)).then(|| value.extract::<f64>()).transpose()?.map(|real| format!("{real:e}"))
    } else {
        None
    };
    match (text, SolveOptions::entry(key)) {
        (Some(text), _) => Ok(text),
        (None, Ok(entry)) => Err(Failure::option(format_args!("{key} is {value}, it must be {}", entry.range())).into()),
        (None, Err(error)) => match key {
            "backend" => {
                Err(Failure::option(format_args!("backend is {value}, it must be one of {}", Backend::NAMES.join(", "))).into())
            }
            "time" | "memory" => Err(Failure::option(format_args!("{key} is {value}, it must be a number above 0")).into()),
            _ => Err(Failure::from(error).into()),
        },
    }
}
