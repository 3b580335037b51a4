//! Networks of labelled voxels in memory.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use glam::{BVec3, DVec3};
use grainsmooth::cli::Arguments;
use grainsmooth::texture::SymmetryError;
use grainsmooth::{
    Error, FileOptions, LabelMap, LabelParts, MapNetworkOptions, MapOptions, MapRun, MeasuredMap,
    OrientationMap, Stage, read_map, smooth_map,
};
use numpy::{PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{list, rows_of};
use crate::errors::{invalid, to_python};
use crate::options::given;
use crate::polycrystal::Polycrystal;
use crate::run::run;

/// What errors and files name as the source.
const LABELS: &str = "labels";
const ORIENTATIONS: &str = "orientations";

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
        let call = format!("grainsmooth.Polycrystal.from_map({:?})", path.display().to_string());
        let run_of = run_of(call, arguments.network, start.elapsed());
        smooth_map(&path, measured, run_of, tell).map(Polycrystal::new)
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
    decimate: Option<f64>,
    split_parts: bool,
    periodic: [bool; 3],
    threads: usize,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Polycrystal> {
    let labels = list(LABELS, &labels)?;
    let (spacing, origin) = (DVec3::from(spacing), DVec3::from(origin));
    let map = LabelMap { shape, spacing, origin, periodic: BVec3::FALSE, labels };
    let parts = if split_parts { LabelParts::Split } else { LabelParts::Keep };
    let periodic = Some(BVec3::from_array(periodic));
    let options = MapOptions { exterior_label, min_voxels, parts, periodic, ..MapOptions::default() };
    let measured =
        MeasuredMap::of_labels(map, &options).map_err(|error| invalid(format!("{LABELS}: {error}")))?;
    let network = MapNetworkOptions { decimate, ..MapNetworkOptions::default() };
    let run_of = run_of("grainsmooth.Polycrystal.from_labels".to_owned(), network, Duration::ZERO);
    run(py, threads, progress, move |tell| {
        smooth_map(Path::new(LABELS), measured, run_of, tell).map(Polycrystal::new)
    })
}

/// The smooth network of the grains that orientations make: Euler angles in degrees, x fastest, with the phase of each point, below 0 where there is none.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "keywords of a function of Python")]
pub fn of_orientations(
    py: Python<'_>,
    angles: PyReadonlyArray2<'_, f64>,
    phase_of: PyReadonlyArray1<'_, i32>,
    shape: [u32; 2],
    phases: Vec<(String, String)>,
    options: &Bound<'_, PyDict>,
    threads: usize,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Polycrystal> {
    let symmetry = |(name, symmetry): (String, String)| Ok((name, symmetry.parse()?));
    let phases: Result<Vec<_>, SymmetryError> = phases.into_iter().map(symmetry).collect();
    let map = OrientationMap {
        shape,
        phases: phases.map_err(|error| invalid(format!("phases: {error}")))?,
        phase_of: list("phase", &phase_of)?.into_iter().map(|phase| u32::try_from(phase).ok()).collect(),
        angles: rows_of("euler_angles", &angles)?.to_vec(),
    };
    let path = Path::new(ORIENTATIONS);
    let arguments = Arguments::of_smooth(path, &given(options)?).map_err(to_python)?;
    let run_of = run_of(
        "grainsmooth.Polycrystal.from_orientations".to_owned(),
        arguments.network.clone(),
        Duration::ZERO,
    );
    run(py, threads, progress, move |tell| {
        tell(Stage::Map, 0, 1);
        let measured = MeasuredMap::of_orientations(&map, &arguments.options);
        let measured = measured.map_err(|problem| Error::MapFile { path: path.to_owned(), problem })?;
        smooth_map(path, measured, run_of, tell).map(Polycrystal::new)
    })
}

/// What is said of a map, which is written as usual.
fn run_of(command_line: String, network: MapNetworkOptions, read_in: Duration) -> MapRun {
    MapRun { command_line, file: FileOptions::default(), network, read_in }
}
