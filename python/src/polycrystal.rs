//! A finished polycrystal.

use std::num::{NonZeroU16, NonZeroU32};
use std::path::PathBuf;
use std::sync::{Arc, OnceLock};

use grainsmooth::cli::Arguments;
use grainsmooth::polycrystal::{Elements, Side};
use grainsmooth::voronoi::Dimension;
use grainsmooth::{
    Coloring, Config, Error, Html, LabelGrid, Names, Output, Picture, Progress, Stage, Summary,
    SummaryRecord, make_polycrystal, write_together,
};
use numpy::npyffi::NPY_ORDER;
use numpy::{PyArray1, PyArray2, PyArray3, PyArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

use crate::arrays::{new_points, rows, view, view_of_points, view_of_rows};
use crate::errors::{invalid, to_python};
use crate::options::{arguments, config};
use crate::run::run;

/// A finished polycrystal and what NumPy sees of it, which is made when it is first asked for.
#[pyclass(frozen, module = "grainsmooth._grainsmooth")]
pub struct Polycrystal {
    pub(crate) made: Arc<grainsmooth::Polycrystal>,
    face_labels: OnceLock<Vec<[i32; 2]>>,
    boundary_ids: OnceLock<Vec<i32>>,
    node_types: OnceLock<Vec<i8>>,
    /// The triangles, where the finest level is not held in memory.
    triangles: OnceLock<Vec<[u32; 3]>>,
}

/// Points, corners and grains of tetrahedra.
type Tetrahedra<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<u32>>, Bound<'py, PyArray1<i32>>);

impl Polycrystal {
    pub(crate) fn new(made: grainsmooth::Polycrystal) -> Self {
        Self {
            made: Arc::new(made),
            face_labels: OnceLock::new(),
            boundary_ids: OnceLock::new(),
            node_types: OnceLock::new(),
            triangles: OnceLock::new(),
        }
    }

    fn json(
        &self,
        py: Python<'_>,
        value: impl FnOnce(&grainsmooth::Polycrystal) -> serde_json::Result<String> + Send + 'static,
    ) -> PyResult<String> {
        let made = Arc::clone(&self.made);
        run(py, 0, None, move |_| Ok(value(&made)))?.map_err(invalid)
    }
}

/// Makes a polycrystal as a config asks, up to what is written.
fn make(config: &Config, progress: Progress<'_>) -> Result<Polycrystal, Error> {
    Ok(Polycrystal::new(make_polycrystal(config, progress)?.completed(progress)?))
}

/// Makes a polycrystal by options.
#[pyfunction]
pub fn generate(
    py: Python<'_>,
    options: &Bound<'_, PyDict>,
    threads: usize,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Polycrystal> {
    let config = config(options)?;
    run(py, threads, progress, move |tell| make(&config, tell))
}

/// Makes a polycrystal by the settings that an earlier one told.
#[pyfunction]
pub fn of_settings(
    py: Python<'_>,
    settings: &str,
    threads: usize,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Polycrystal> {
    let config =
        Arguments::of_settings(settings).and_then(|arguments| arguments.config()).map_err(to_python)?;
    run(py, threads, progress, move |tell| make(&config, tell))
}

#[pymethods]
impl Polycrystal {
    /// 2 or 3.
    #[getter]
    fn dimension(&self) -> u8 {
        match self.made.dimension() {
            Dimension::Two => 2,
            Dimension::Three => 3,
        }
    }

    #[getter]
    fn grain_count(&self) -> usize {
        self.made.network.grain_count()
    }

    #[getter]
    fn boundary_count(&self) -> usize {
        self.made.network.boundaries().len()
    }

    /// Lower and upper corner of the domain's box.
    #[getter]
    fn bounds(&self) -> ([f64; 3], [f64; 3]) {
        let domain = self.made.network.domain();
        (domain.lower().to_array(), domain.upper().to_array())
    }

    #[getter]
    fn points<'py>(slf: &Bound<'py, Self>) -> Bound<'py, PyArray2<f64>> {
        view_of_points(slf.as_any(), &slf.get().made.points)
    }

    /// Triangles, or in the plane segments.
    #[getter]
    fn elements<'py>(slf: &Bound<'py, Self>) -> Bound<'py, PyArray2<u32>> {
        let this = slf.get();
        match this.made.network.finest().elements() {
            Elements::Triangles(triangles) => view_of_rows(slf.as_any(), triangles),
            Elements::Refined(mesh) => {
                view_of_rows(slf.as_any(), this.triangles.get_or_init(|| mesh.triangles()))
            }
            Elements::Segments(segments) => view_of_rows(slf.as_any(), segments),
        }
    }

    #[getter]
    fn face_labels<'py>(slf: &Bound<'py, Self>) -> Bound<'py, PyArray2<i32>> {
        let this = slf.get();
        let of_elements = || {
            let network = &this.made.network;
            let labels: Vec<[i32; 2]> =
                network.boundaries().iter().map(|boundary| Names::default().labels(boundary)).collect();
            network.finest().boundaries().map(|boundary| labels[boundary.index()]).collect()
        };
        view_of_rows(slf.as_any(), this.face_labels.get_or_init(of_elements))
    }

    #[getter]
    fn boundary_id<'py>(slf: &Bound<'py, Self>) -> Bound<'py, PyArray1<i32>> {
        let this = slf.get();
        let ids = || {
            let boundaries = this.made.network.finest().boundaries();
            boundaries.map(|boundary| boundary.0.cast_signed()).collect()
        };
        view(slf.as_any(), this.boundary_ids.get_or_init(ids))
    }

    #[getter]
    fn node_types<'py>(slf: &Bound<'py, Self>) -> Bound<'py, PyArray1<i8>> {
        let this = slf.get();
        let finest = this.made.network.finest();
        let types = || (0..finest.vertex_count()).map(|vertex| finest.node_type(vertex).code()).collect();
        view(slf.as_any(), this.node_types.get_or_init(types))
    }

    /// Volumes of the grains, in the plane areas.
    #[getter]
    fn volumes<'py>(slf: &Bound<'py, Self>) -> Bound<'py, PyArray1<f64>> {
        view(slf.as_any(), slf.get().made.network.cell_volumes())
    }

    /// The settings that make it again, as TOML; none where it was not made by options.
    #[getter]
    fn settings(&self) -> Option<String> {
        self.made.synthesis().map(|synthesis| synthesis.config.settings().to_string())
    }

    /// Tables and figures of the network as JSON.
    fn statistics(&self, py: Python<'_>) -> PyResult<String> {
        self.json(py, |made| serde_json::to_string(&made.statistics()))
    }

    /// What the program's summary tells, as JSON.
    fn summary(&self, py: Python<'_>) -> PyResult<String> {
        self.json(py, |made| serde_json::to_string(&SummaryRecord::new(made, Vec::new())))
    }

    /// The program's summary.
    fn __str__(&self) -> String {
        Summary(&self.made).to_string()
    }

    /// The grain at the centre of each voxel, -1 outside.
    fn voxelize<'py>(
        &self,
        py: Python<'py>,
        shape: [u32; 3],
        threads: usize,
    ) -> PyResult<Bound<'py, PyArray3<i32>>> {
        let mut size = [NonZeroU32::MIN; 3];
        for (size, count) in size.iter_mut().zip(shape) {
            *size = NonZeroU32::new(count)
                .ok_or_else(|| PyValueError::new_err("shape: give at least one voxel along each axis"))?;
        }
        let made = Arc::clone(&self.made);
        let labels: Vec<i32> = run(py, threads, None, move |_| {
            let number = |side: Side| side.grain().map_or(-1, |grain| grain.0.cast_signed());
            Ok(LabelGrid::new(&made, size).labels().into_iter().map(number).collect())
        })?;
        let shape = shape.map(|count| count as usize);
        PyArray1::from_vec(py, labels).reshape_with_order(shape, NPY_ORDER::NPY_FORTRANORDER)
    }

    /// A picture as PNG.
    fn png<'py>(
        &self,
        py: Python<'py>,
        size: [u16; 2],
        color_by: &str,
        explode: f64,
    ) -> PyResult<Bound<'py, PyBytes>> {
        let picture = picture(size, color_by, explode)?;
        let made = Arc::clone(&self.made);
        let png = run(py, 0, None, move |_| Ok(made.png(&picture)))?;
        Ok(PyBytes::new(py, &png.map_err(invalid)?))
    }

    /// Writes the network, each path in the format of its extension; all files appear together.
    fn save(
        &self,
        py: Python<'_>,
        paths: Vec<PathBuf>,
        options: &Bound<'_, PyDict>,
        threads: usize,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let outputs = paths.iter().map(Output::check).collect::<Result<Vec<_>, _>>().map_err(to_python)?;
        let mut made = Arc::clone(&self.made);
        if !options.is_empty() {
            let file = arguments(options)?.files.outputs.options(made.dimension()).map_err(to_python)?;
            *Arc::make_mut(&mut made).file_mut() = file;
        }
        let to_write = made.to_write();
        outputs.iter().try_for_each(|output| output.check_holds(&to_write)).map_err(to_python)?;
        let needs_elements = outputs.iter().any(|output| output.format().needs_elements(&to_write));
        run(py, threads, progress, move |tell| {
            if needs_elements && made.volume_mesh.is_none() {
                tell(Stage::Filling, 0, 1);
                made = Arc::new(Arc::unwrap_or_clone(made).filled()?);
            }
            tell(Stage::Writing, 0, 1);
            write_together(|files| outputs.iter().try_for_each(|output| made.stage(output, files)))
        })
    }

    /// Tetrahedra that fill the grains: their points, corners and grains.
    fn tetrahedra<'py>(&self, py: Python<'py>, threads: usize) -> PyResult<Tetrahedra<'py>> {
        let made = Arc::clone(&self.made);
        let filled = run(py, threads, None, move |tell| {
            tell(Stage::Filling, 0, 1);
            if made.volume_mesh.is_some() {
                Ok(made)
            } else {
                Arc::unwrap_or_clone(made).filled().map(Arc::new)
            }
        })?;
        let mesh = filled.volume_mesh.as_ref();
        let mesh = mesh.ok_or_else(|| PyValueError::new_err("grains in the plane hold no tetrahedra"))?;
        let grains = mesh.grains.iter().map(|grain| grain.0.cast_signed());
        let grains = PyArray1::from_vec(py, grains.collect());
        Ok((new_points(py, &mesh.points), rows(py, mesh.tetrahedra.clone()), grains))
    }

    /// Writes the page with a view of the grains, histograms and figures.
    fn report(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let output = Output::check_as(path, Html).map_err(to_python)?;
        let made = Arc::clone(&self.made);
        run(py, 0, None, move |_| write_together(|files| made.stage_report(&output, files)))
    }

    /// Bunge's Euler angles of the grains in degrees.
    #[getter]
    fn euler_angles<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let texture = self.made.grains().texture.as_ref();
        let texture = texture.ok_or_else(|| {
            PyValueError::new_err(
                "the grains have no orientations; give them some, such as texture=\"random\"",
            )
        })?;
        Ok(rows(py, texture.orientations().iter().map(|one| one.euler_degrees()).collect()))
    }

    /// The number of the seed, or the map's label, of each grain.
    #[getter]
    fn seed_id<'py>(slf: &Bound<'py, Self>) -> Bound<'py, PyArray1<u32>> {
        view(slf.as_any(), &slf.get().made.grains().ids)
    }

    /// The index of each grain's phase and the names of the phases.
    #[getter]
    fn phases(&self) -> PyResult<(Vec<usize>, Vec<String>)> {
        let phases = self.made.grains().phases.as_ref();
        let phases = phases.ok_or_else(|| {
            PyValueError::new_err("the grains have no phases; give them some with phase=[...]")
        })?;
        Ok((phases.phase_of().to_vec(), phases.names().map(str::to_owned).collect()))
    }
}

fn picture([width, height]: [u16; 2], color_by: &str, explode: f64) -> PyResult<Picture> {
    let coloring =
        Coloring::ALL.into_iter().find(|(_, name)| *name == color_by).map(|(coloring, _)| coloring);
    let coloring = coloring.ok_or_else(|| {
        let known = Coloring::ALL.map(|(_, name)| name).join(", ");
        PyValueError::new_err(format!("color_by: {color_by:?} is none of {known}"))
    })?;
    if !(0.0..=10.0).contains(&explode) {
        return Err(PyValueError::new_err("explode: give a number from 0 (whole) to 10"));
    }
    let side = |side: u16| {
        NonZeroU16::new(side).ok_or_else(|| PyValueError::new_err("size: give two numbers of pixels"))
    };
    Ok(Picture { size: [side(width)?, side(height)?], coloring, explode, ..Picture::default() })
}
