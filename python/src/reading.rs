//! What files hold: networks, whether they are good, and what their grains are like.

use std::path::PathBuf;

use glam::DVec3;
use grainsmooth::polycrystal::{NodeType, Side};
use grainsmooth::voronoi::Dimension;
use grainsmooth::{CheckReport, Error, FileElements, LabelledFile, MeasuredSample, SampleReport};
use numpy::PyArray1;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{new_points, rows};
use crate::errors::invalid;
use crate::run::run;

/// The arrays of a network's file and its settings. Grains count from 0 in the order of their labels, which `seed_id` has.
#[pyfunction]
pub fn read(py: Python<'_>, path: PathBuf) -> PyResult<Bound<'_, PyDict>> {
    let file = run(py, 0, None, move |_| LabelledFile::read(&path))?;
    let read = PyDict::new(py);
    let points: Vec<DVec3> = file.points.iter().map(|point| *point * file.stretch).collect();
    read.set_item("points", new_points(py, &points))?;
    match &file.elements {
        FileElements::Triangles(triangles) => read.set_item("elements", rows(py, triangles.clone()))?,
        FileElements::Segments(segments) => read.set_item("elements", rows(py, segments.clone()))?,
    }
    let grains = file.labels_of_grains();
    let number = |side: Side| side.grain().and_then(|grain| grains.binary_search(&grain).ok());
    let number = |side: Side| number(side).map_or(-1, |number| i32::try_from(number).unwrap_or(i32::MAX));
    let labels: Vec<[i32; 2]> = file.sides.iter().map(|sides| sides.map(number)).collect();
    let of_elements = file.boundary_of.iter().map(|boundary| labels[boundary.index()]);
    read.set_item("face_labels", rows(py, of_elements.collect()))?;
    let boundary_id = file.boundary_of.iter().map(|boundary| boundary.0.cast_signed());
    read.set_item("boundary_id", PyArray1::from_vec(py, boundary_id.collect()))?;
    let code = |of: &Option<NodeType>| of.map_or(0, NodeType::code);
    let node_types =
        file.node_types.as_ref().map(|types| PyArray1::from_vec(py, types.iter().map(code).collect()));
    read.set_item("node_types", node_types)?;
    read.set_item("seed_id", PyArray1::from_vec(py, grains.iter().map(|grain| grain.0).collect()))?;
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
