//! Flat cells.

use std::sync::Arc;

use glam::{BVec3, DVec3};
use grainsmooth::polycrystal::Junctions;
use grainsmooth::voronoi::{self, CellId, Domain, Side};
use numpy::{PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{list, new_points, points, view, view_of_points};
use crate::errors::invalid;
use crate::network::Network;
use crate::options::config;
use crate::run::run;

/// Voronoi or power cells of seeds in a box.
#[pyclass(frozen, module = "grainsmooth._grainsmooth")]
pub struct Tessellation {
    cells: Arc<voronoi::Tessellation>,
    weights: Vec<f64>,
    volumes: Vec<f64>,
}

impl Tessellation {
    fn new(cells: voronoi::Tessellation, weights: Vec<f64>) -> Self {
        let volumes = cells.cell_measures().iter().map(|cell| cell.volume).collect();
        Self { cells: Arc::new(cells), weights, volumes }
    }
}

/// The cells that options ask for.
#[pyfunction]
pub fn tessellate(
    py: Python<'_>,
    options: &Bound<'_, PyDict>,
    threads: usize,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Tessellation> {
    let config = config(options)?;
    run(py, threads, progress, move |tell| {
        let made = grainsmooth::tessellate(&config, tell)?.stretched(&config);
        Ok(Tessellation::new(made.tessellation, made.weights))
    })
}

/// The cells of seeds in a box, or with `dim` 2 in a rectangle, from the origin.
#[pyfunction]
pub fn tessellation_of(
    py: Python<'_>,
    seeds: PyReadonlyArray2<'_, f64>,
    box_size: [f64; 3],
    dim: u8,
    periodic: [bool; 3],
    weights: Option<PyReadonlyArray1<'_, f64>>,
    threads: usize,
) -> PyResult<Tessellation> {
    let upper = DVec3::from(box_size);
    let domain = match dim {
        2 => Domain::rectangle(DVec3::ZERO, upper),
        3 => Domain::cuboid(DVec3::ZERO, upper),
        _ => return Err(PyValueError::new_err("dim: cells have 2 or 3 dimensions")),
    };
    let domain = domain.map_err(invalid)?.with_periods(BVec3::from_array(periodic));
    let seeds = points("seeds", &seeds)?;
    let weights = weights.map(|weights| list("weights", &weights)).transpose()?;
    run(py, threads, None, move |_| {
        let cells = match &weights {
            Some(weights) => voronoi::Tessellation::power(&domain, &seeds, weights)?,
            None => voronoi::Tessellation::new(&domain, &seeds)?,
        };
        let weights = weights.unwrap_or_else(|| vec![0.0; cells.cell_count()]);
        Ok(Tessellation::new(cells, weights))
    })
}

#[pymethods]
impl Tessellation {
    #[getter]
    fn seeds<'py>(slf: &Bound<'py, Self>) -> Bound<'py, PyArray2<f64>> {
        view_of_points(slf.as_any(), slf.get().cells.seeds())
    }

    #[getter]
    fn vertices<'py>(slf: &Bound<'py, Self>) -> Bound<'py, PyArray2<f64>> {
        view_of_points(slf.as_any(), slf.get().cells.vertices())
    }

    #[getter]
    fn weights<'py>(slf: &Bound<'py, Self>) -> Bound<'py, PyArray1<f64>> {
        view(slf.as_any(), &slf.get().weights)
    }

    #[getter]
    fn volumes<'py>(slf: &Bound<'py, Self>) -> Bound<'py, PyArray1<f64>> {
        view(slf.as_any(), &slf.get().volumes)
    }

    #[getter]
    fn centroids<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        new_points(py, &self.cells.centroids())
    }

    /// The vertices of each face, and the two cells that it lies between; -1 for a wall.
    fn faces(&self) -> Vec<(Vec<u32>, [i64; 2])> {
        let number = |side: Side| side.cell().map_or(-1, |(cell, _)| i64::from(cell.0));
        let face = |face| {
            let corners = self.cells.face_corners(face).iter().map(|vertex| vertex.0).collect();
            (corners, self.cells.face_sides(face).map(number))
        };
        self.cells.faces().map(face).collect()
    }

    /// Number of faces of each cell.
    fn face_counts(&self) -> Vec<usize> {
        let cells = (0u32..).take(self.cells.cell_count()).map(CellId);
        cells.map(|cell| self.cells.cell_faces(cell).len()).collect()
    }

    /// The network of the cells with so many levels, flat.
    fn network(&self, py: Python<'_>, levels: usize, threads: usize) -> PyResult<Network> {
        let cells = Arc::clone(&self.cells);
        run(py, threads, None, move |_| {
            let (network, points) =
                grainsmooth::polycrystal::Network::new(&cells, Junctions::Crease, levels)?;
            Ok(Network::new(Arc::new(network), 0, points))
        })
    }
}
