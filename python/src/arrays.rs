//! Arrays of numpy's, in and out.

use numpy::{Element, PyArray1, PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyBool};

use crate::errors::Failure;

/// Numbers of whatever kind as an array of `T`: the same memory, if that is what it holds.
fn numbers<'py, T: Element>(object: &Bound<'py, PyAny>, kinds: &str, name: &str) -> PyResult<PyReadonlyArrayDyn<'py, T>> {
    let py = object.py();
    let array = py.import(intern!(py, "numpy"))?.call_method1(intern!(py, "asarray"), (object,))?;
    let kind: String = array.getattr(intern!(py, "dtype"))?.getattr(intern!(py, "kind"))?.extract()?;
    let is_empty = array.getattr(intern!(py, "size"))?.extract::<usize>()? == 0;
    if !kinds.contains(&kind) && !is_empty {
        let found = array.getattr(intern!(py, "dtype"))?;
        let needed = if kinds.contains('f') { "numbers" } else { "whole numbers" };
        return Err(Failure::argument(format_args!("{name} holds {found}, it must hold {needed}")).into());
    }
    let exact = array.call_method1(intern!(py, "astype"), (T::get_dtype(py), "K", "unsafe", true, false))?;
    Ok(exact.cast::<PyArrayDyn<T>>()?.readonly())
}

/// Real numbers in metres, W/m^2 and the like.
pub fn reals<'py>(object: &Bound<'py, PyAny>, name: &str) -> PyResult<PyReadonlyArrayDyn<'py, f64>> {
    numbers(object, "fiu", name)
}

/// Whole numbers, not negative, of an array with one axis.
pub fn wholes(object: &Bound<'_, PyAny>, name: &str) -> PyResult<Vec<u64>> {
    let array = numbers::<i64>(object, "iu", name)?;
    let whole = |&number: &i64| {
        u64::try_from(number).map_err(|_| Failure::argument(format_args!("{name} holds {number}, numbers count from 0")).into())
    };
    array.as_array().iter().map(whole).collect()
}

/// Vectors along the last axis, and the axes before it.
pub fn vectors(object: &Bound<'_, PyAny>, name: &str) -> PyResult<(Vec<[f64; 3]>, Vec<usize>)> {
    let array = reals(object, name)?;
    let view = array.as_array();
    let Some((3, axes)) = view.shape().split_last().map(|(last, axes)| (*last, axes.to_vec())) else {
        let message = format!("{name} has the shape {:?}, its last axis must have 3 coordinates", view.shape());
        return Err(Failure::argument(message).into());
    };
    Ok((view.rows().into_iter().map(|row| [row[0], row[1], row[2]]).collect(), axes))
}

/// Three coordinates.
pub fn vector(object: &Bound<'_, PyAny>, name: &str) -> PyResult<[f64; 3]> {
    match vectors(object, name)? {
        (vectors, axes) if axes.is_empty() => Ok(vectors[0]),
        _ => Err(Failure::argument(format_args!("{name} must be three coordinates")).into()),
    }
}

/// Numbers as an array of this shape; the memory becomes the array's.
pub fn array<'py, T: Element>(py: Python<'py>, numbers: Vec<T>, shape: &[usize]) -> PyResult<Bound<'py, PyArrayDyn<T>>> {
    PyArray1::from_vec(py, numbers).reshape(shape)
}

/// What `__array__` answers: the array itself, unless another type or a copy is asked for.
pub fn as_asked<'py>(
    array: &Bound<'py, PyAny>,
    dtype: Option<&Bound<'py, PyAny>>,
    copy: Option<bool>,
) -> PyResult<Bound<'py, PyAny>> {
    let py = array.py();
    let asked = [("dtype", dtype.cloned()), ("copy", copy.map(|copy| PyBool::new(py, copy).to_owned().into_any()))];
    py.import(intern!(py, "numpy"))?.call_method(intern!(py, "array"), (array,), Some(&asked.into_py_dict(py)?))
}
