//! The program's options as keywords.

use grainsmooth::Config;
use grainsmooth::cli::{Arguments, OptionValue};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyList, PyString, PyTuple};

use crate::errors::to_python;

/// The arguments that keywords give.
pub fn arguments(keywords: &Bound<'_, PyDict>) -> PyResult<Arguments> {
    Arguments::of_options(&given(keywords)?).map_err(to_python)
}

/// The config that keywords give.
pub fn config(keywords: &Bound<'_, PyDict>) -> PyResult<Config> {
    arguments(keywords)?.config().map_err(to_python)
}

/// Keywords as options: a long name has `_` for `-`, and `None` is not given.
pub fn given(keywords: &Bound<'_, PyDict>) -> PyResult<Vec<(String, OptionValue)>> {
    let mut given = Vec::new();
    for (name, value) in keywords.iter().filter(|(_, value)| !value.is_none()) {
        let name: String = name.extract()?;
        let value = option_value(&name, &value)?;
        given.push((name.replace('_', "-"), value));
    }
    Ok(given)
}

fn option_value(name: &str, value: &Bound<'_, PyAny>) -> PyResult<OptionValue> {
    if let Ok(flag) = value.cast::<PyBool>() {
        return Ok(OptionValue::Flag(flag.is_true()));
    }
    // Numbers and arrays of NumPy as Python's own.
    if let Ok(to_list) = value.getattr("tolist") {
        return option_value(name, &to_list.call0()?);
    }
    if let Ok(path) = value.getattr("__fspath__") {
        return Ok(OptionValue::Word(path.call0()?.extract()?));
    }
    if value.is_instance_of::<PyString>() {
        return Ok(OptionValue::Word(value.extract()?));
    }
    if value.is_instance_of::<PyInt>() || value.is_instance_of::<PyFloat>() {
        return Ok(OptionValue::Word(value.str()?.extract()?));
    }
    if value.is_instance_of::<PyList>() || value.is_instance_of::<PyTuple>() {
        let values = value.try_iter()?.map(|item| option_value(name, &item?));
        return Ok(OptionValue::List(values.collect::<PyResult<_>>()?));
    }
    if let Ok(parts) = value.cast::<PyDict>() {
        let part = |(key, part): (Bound<'_, PyAny>, Bound<'_, PyAny>)| {
            let key: String = key.extract()?;
            let part = option_value(&key, &part)?;
            Ok((key, part))
        };
        return Ok(OptionValue::Parts(parts.iter().map(part).collect::<PyResult<_>>()?));
    }
    Err(PyTypeError::new_err(format!(
        "{name}: give a number, a text, a path, True or False, or a list of them; {} given",
        value.get_type().name()?
    )))
}
