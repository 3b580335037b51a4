//! Networks of labelled voxels in memory.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use glam::DVec3;
use grainsmooth::cli::Arguments;
use grainsmooth::{FileOptions, LabelMap, MapOptions, MapRun, MeasuredMap, Stage, read_map, smooth_map};
use numpy::PyReadonlyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::list;
use crate::errors::{invalid, to_python};
use crate::options::given;
use crate::polycrystal::Polycrystal;
use crate::run::run;

/// What errors and files name as the source.
const SOURCE: &str = "labels";

/// The smooth network of a map from a file, by the options of the program's `smooth`.
#[pyfunction]
pub fn of_map(
    py: Python<'_>,
    path: PathBuf,
    options: &Bound<'_, PyDict>,
    threads: usize,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Polycrystal> {
    let arguments = Arguments::of_smooth(&path, &given(options)?).map_err(to_python)?;
    run(py, threads, progress, move |tell| {
        tell(Stage::Map, 0, 1);
        let start = Instant::now();
        let measured = read_map(&path, &arguments.options)?;
        let run_of = MapRun {
            command_line: format!("grainsmooth.Polycrystal.from_map({:?})", path.display().to_string()),
            file: FileOptions::default(),
            read_in: start.elapsed(),
        };
        smooth_map(&path, &measured, run_of, tell).map(Polycrystal::new)
    })
}

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
