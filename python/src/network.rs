//! The network of cells, stage by stage.

use std::sync::{Arc, OnceLock};

use glam::DVec3;
use grainsmooth::polycrystal::{Elements, LevelView, Relaxation, relax};
use grainsmooth::{Names, Stage};
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::arrays::{view_of_points, view_of_rows};
use crate::run::run;

/// Boundaries, triple lines and quadruple points at one level of subdivision.
#[pyclass(frozen, module = "grainsmooth._grainsmooth")]
pub struct Network {
    network: Arc<grainsmooth::polycrystal::Network>,
    level: usize,
    points: Vec<DVec3>,
    /// The triangles, where the level is not held in memory.
    triangles: OnceLock<Vec<[u32; 3]>>,
}

impl Network {
    pub(crate) fn new(
        network: Arc<grainsmooth::polycrystal::Network>,
        level: usize,
        points: Vec<DVec3>,
    ) -> Self {
        Self { network, level, points, triangles: OnceLock::new() }
    }

    fn mesh(&self) -> LevelView<'_> {
        self.network.level(self.level)
    }
}

#[pymethods]
impl Network {
    #[getter]
    fn level(&self) -> usize {
        self.level
    }

    /// Number of subdivisions that there are.
    #[getter]
    fn levels(&self) -> usize {
        self.network.level_count()
    }

    #[getter]
    fn points<'py>(slf: &Bound<'py, Self>) -> Bound<'py, PyArray2<f64>> {
        view_of_points(slf.as_any(), &slf.get().points)
    }

    #[getter]
    fn elements<'py>(slf: &Bound<'py, Self>) -> Bound<'py, PyArray2<u32>> {
        let this = slf.get();
        match this.mesh().elements() {
            Elements::Triangles(triangles) => view_of_rows(slf.as_any(), triangles),
            Elements::Refined(mesh) => {
                view_of_rows(slf.as_any(), this.triangles.get_or_init(|| mesh.triangles()))
            }
            Elements::Segments(segments) => view_of_rows(slf.as_any(), segments),
        }
    }

    #[getter]
    fn face_labels<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<i32>>> {
        let boundaries = self.network.boundaries();
        let of_elements = self.mesh().boundaries();
        let labels: Vec<i32> =
            of_elements.flat_map(|boundary| Names::default().labels(&boundaries[boundary.index()])).collect();
        let count = labels.len() / 2;
        PyArray1::from_vec(py, labels).reshape([count, 2])
    }

    /// The volume of each grain, in the plane its area.
    #[getter]
    fn volumes<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_vec(py, self.network.grain_volumes(self.mesh(), &self.points))
    }

    /// The volumes that relaxation keeps.
    #[getter]
    fn target_volumes<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, self.network.cell_volumes())
    }

    /// The network moved toward equilibrium for a time, or until it is reached where there is none.
    fn relax(
        &self,
        py: Python<'_>,
        time: Option<f64>,
        threads: usize,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        if self.level > 0 {
            return Err(PyValueError::new_err(
                "only the control mesh is relaxed: call relax before subdivide",
            ));
        }
        let (network, points) = (Arc::clone(&self.network), self.points.clone());
        let relaxation = time.map_or(Relaxation::Equilibrium, Relaxation::Time);
        run(py, threads, progress, move |tell| {
            let told = |done, count| tell(Stage::Relaxation, done, count);
            let relaxed = relax(&network, &points, &relaxation, told)?;
            Ok(Self::new(network, relaxed.level, relaxed.points))
        })
    }

    /// The network subdivided so many times, or up to its finest level.
    fn subdivide(&self, py: Python<'_>, times: Option<usize>, threads: usize) -> PyResult<Self> {
        let last = self.network.level_count();
        let to = times.map_or(last, |times| self.level.saturating_add(times));
        if to > last {
            return Err(PyValueError::new_err(format!(
                "this network has {last} levels and stands at level {}; ask for more with Tessellation.network(levels=...)",
                self.level
            )));
        }
        let (network, from, points) = (Arc::clone(&self.network), self.level, self.points.clone());
        run(py, threads, None, move |_| {
            let points = network.subdivide_between(from, to, &points);
            Ok(Self::new(network, to, points))
        })
    }
}
