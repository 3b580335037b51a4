//! What files hold: networks, whether they are good, and what their grains are like.

use std::path::PathBuf;

use grainsmooth::polycrystal::{NodeType, Side};
use grainsmooth::voronoi::Dimension;
use grainsmooth::{CheckReport, Error, FileElements, LabelledFile, MeasuredSample, SampleReport};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::errors::invalid;
use crate::run::run;

/// The arrays of a network's file and its settings.
#[pyfunction]
pub fn read(py: Python<'_>, path: PathBuf) -> PyResult<Bound<'_, PyDict>> {
    let file = run(py, 0, None, move |_| LabelledFile::read(&path))?;
    let read = PyDict::new(py);
    let points: Vec<f64> = file.points.iter().flat_map(|point| (*point * file.stretch).to_array()).collect();
    read.set_item("points", PyArray1::from_vec(py, points).reshape([file.points.len(), 3])?)?;
    let (elements, corners) = match &file.elements {
        FileElements::Triangles(triangles) => (triangles.as_flattened().to_vec(), 3),
        FileElements::Segments(segments) => (segments.as_flattened().to_vec(), 2),
    };
    let count = elements.len() / corners;
    read.set_item("elements", PyArray1::from_vec(py, elements).reshape([count, corners])?)?;
    let number = |side: Side| side.grain().map_or(-1, |grain| grain.0.cast_signed());
    let labels = file.boundary_of.iter().flat_map(|boundary| file.sides[boundary.index()].map(number));
    read.set_item("face_labels", PyArray1::from_vec(py, labels.collect()).reshape([count, 2])?)?;
    let boundary_id = file.boundary_of.iter().map(|boundary| boundary.0.cast_signed());
    read.set_item("boundary_id", PyArray1::from_vec(py, boundary_id.collect()))?;
    let code = |of: &Option<NodeType>| of.map_or(0, NodeType::code);
    let node_types =
        file.node_types.as_ref().map(|types| PyArray1::from_vec(py, types.iter().map(code).collect()));
    read.set_item("node_types", node_types)?;
    read.set_item("settings", file.settings.as_ref().map(ToString::to_string))?;
    Ok(read)
}

/// The certificate of a network's file, as JSON.
#[pyfunction]
pub fn check(py: Python<'_>, path: PathBuf) -> PyResult<String> {
    let report = run(py, 0, None, move |_| Ok(CheckReport::new(&path, &LabelledFile::read(&path)?)))?;
    serde_json::to_string(&report).map_err(invalid)
}

/// What the grains of a file are like, as JSON.
#[pyfunction]
pub fn measure(py: Python<'_>, path: PathBuf, dim: Option<u8>) -> PyResult<String> {
    let dimension = match dim {
        None => None,
        Some(2) => Some(Dimension::Two),
        Some(3) => Some(Dimension::Three),
        Some(_) => return Err(PyValueError::new_err("dim: grains have 2 or 3 dimensions")),
    };
    let report = run(py, 0, None, move |_| {
        let sample = MeasuredSample::read(&path, dimension)?;
        Ok::<_, Error>(SampleReport::new(&path, &sample, None, None))
    })?;
    serde_json::to_string(&report).map_err(invalid)
}
