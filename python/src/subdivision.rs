//! Subdivision of meshes and polylines.

use std::path::Path;

use glam::DVec3;
use grainsmooth::mesh::file::MeshFile;
use grainsmooth::subzero::{BoundaryRule, Crease, DooSabinWeights, LoopWeights};
use grainsmooth::{Connectivity, Error, Scheme, limits};
use numpy::PyReadonlyArray2;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{new_points, points as points_of, rows};
use crate::run::run;

/// What errors name as the source.
const SOURCE: &str = "faces";

/// The scheme of a name, and whether it is of curves.
fn scheme_of(name: &str) -> PyResult<(Scheme, bool)> {
    Ok(match name {
        "loop" => (Scheme::Loop(LoopWeights::Loop), false),
        "butterfly" => (Scheme::Butterfly, false),
        "modified-butterfly" => (Scheme::ModifiedButterfly, false),
        "midpoint" => (Scheme::Midpoint, false),
        "doo-sabin" => (Scheme::DooSabin(DooSabinWeights::DooSabin), false),
        "catmull-clark" => (Scheme::CatmullClark, false),
        "b-spline" => (Scheme::BSpline, true),
        "four-point" => (Scheme::FourPoint, true),
        _ => {
            return Err(PyValueError::new_err(format!(
                "scheme: {name:?} is none of loop, butterfly, modified-butterfly, midpoint, doo-sabin, catmull-clark, b-spline, four-point"
            )));
        }
    })
}

/// The last level: `points`, `faces` (of curves, polylines), and where they are asked for `limits` and `normals`.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "keywords of a function of Python")]
pub fn subdivide<'py>(
    py: Python<'py>,
    points: PyReadonlyArray2<'py, f64>,
    faces: Vec<Vec<u32>>,
    scheme: &str,
    levels: u32,
    creases: Vec<([u32; 2], f32)>,
    corners: Vec<(u32, f32)>,
    with_limits: bool,
) -> PyResult<Bound<'py, PyDict>> {
    let (scheme, is_of_curves) = scheme_of(scheme)?;
    let mut mesh = MeshFile {
        points: points_of("points", &points)?,
        creases: creases.into_iter().map(|(ends, sharpness)| Crease { ends, sharpness }).collect(),
        corners,
        boundary: BoundaryRule::Edge,
        ..MeshFile::default()
    };
    *(if is_of_curves { &mut mesh.lines } else { &mut mesh.faces }) = faces;
    let (level, limits) = run(py, 0, None, move |_| {
        let located = |problem| Error::MeshFile { path: SOURCE.into(), problem };
        mesh.check().map_err(located)?;
        let mut all = grainsmooth::subdivide(&mesh, Path::new(SOURCE), scheme, levels)?;
        let level = all.pop().expect("the mesh itself is a level");
        let limits = if with_limits { limits(&level, scheme).map_err(located)? } else { None };
        Ok((level, limits))
    })?;
    let result = PyDict::new(py);
    result.set_item("points", new_points(py, &level.points))?;
    match &level.mesh {
        Connectivity::Triangles(mesh) => result.set_item("faces", rows(py, mesh.triangles().to_vec()))?,
        other => result.set_item("faces", other.faces())?,
    }
    if let Some(limits) = limits {
        let normals: Vec<DVec3> = limits.normals.iter().map(|normal| normal.unwrap_or(DVec3::NAN)).collect();
        result.set_item("limits", new_points(py, &limits.positions))?;
        if normals.len() == level.points.len() {
            result.set_item("normals", new_points(py, &normals))?;
        }
    }
    Ok(result)
}
