//! Networks of labelled voxels in memory.

use std::path::Path;
use std::time::Duration;

use glam::DVec3;
use grainsmooth::{FileOptions, LabelMap, MapOptions, MapRun, MeasuredMap, smooth_map};
use numpy::PyReadonlyArray1;
use pyo3::prelude::*;

use crate::arrays::list;
use crate::errors::invalid;
use crate::polycrystal::Polycrystal;
use crate::run::run;

/// What errors and files name as the source.
const SOURCE: &str = "labels";

/// The smooth network of labels, x fastest.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "keywords of a function of Python")]
pub fn of_labels(
    py: Python<'_>,
    labels: PyReadonlyArray1<'_, i32>,
    shape: [usize; 3],
    spacing: [f64; 3],
    origin: [f64; 3],
    exterior_label: Option<i32>,
    min_voxels: u64,
    threads: usize,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Polycrystal> {
    let labels = list(SOURCE, &labels)?;
    let map = LabelMap { shape, spacing: DVec3::from(spacing), origin: DVec3::from(origin), labels };
    let options = MapOptions { exterior_label, min_voxels, ..MapOptions::default() };
    let measured =
        MeasuredMap::of_labels(map, &options).map_err(|error| invalid(format!("{SOURCE}: {error}")))?;
    let run_of = MapRun {
        command_line: "grainsmooth.Polycrystal.from_labels".to_owned(),
        file: FileOptions::default(),
        read_in: Duration::ZERO,
    };
    run(py, threads, progress, move |tell| {
        smooth_map(Path::new(SOURCE), &measured, run_of, tell).map(Polycrystal::new)
    })
}
