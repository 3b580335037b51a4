//! Networks that are there as arrays: from files, from other programs, from pickles.

use std::collections::BTreeMap;

use grainsmooth::polycrystal::{BoundaryId, Elements, GrainId, Side, Surface};
use numpy::{PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::arrays::{list, points as points_of, rows_of};
use crate::polycrystal::Polycrystal;
use crate::run::run;

/// What files tell of where such a network comes from.
const SOURCE: &str = "grainsmooth.Polycrystal.from_arrays";

/// The polycrystal of triangles or segments with two labels each: grains from 0, which had the numbers `ids`, and -1 for the exterior.
#[pyfunction]
pub fn of_arrays(
    py: Python<'_>,
    points: PyReadonlyArray2<'_, f64>,
    elements: PyReadonlyArray2<'_, u32>,
    face_labels: PyReadonlyArray2<'_, i32>,
    ids: PyReadonlyArray1<'_, u32>,
    threads: usize,
) -> PyResult<Polycrystal> {
    let points = points_of("points", &points)?;
    let labels = rows_of("face_labels", &face_labels)?.to_vec();
    let ids = list("seed_id", &ids)?;
    let (mut triangles, mut segments) = (Vec::new(), Vec::new());
    let is_plane = elements.shape()[1] == 2;
    match is_plane {
        true => segments = rows_of("segments", &elements)?.to_vec(),
        false => triangles = rows_of("triangles", &elements)?.to_vec(),
    }
    run(py, threads, None, move |_| {
        let (boundary_of, sides) = boundaries(&labels);
        let elements = if is_plane { Elements::Segments(&segments) } else { Elements::Triangles(&triangles) };
        let surface = Surface { points: &points, elements, boundary_of: &boundary_of, sides: &sides };
        grainsmooth::Polycrystal::of_surface(&surface, ids, SOURCE.to_owned()).map(Polycrystal::new)
    })
}

/// One boundary for each pair of labels: that of each element, and its sides.
fn boundaries(labels: &[[i32; 2]]) -> (Vec<BoundaryId>, Vec<[Side; 2]>) {
    let side = |label: i32| u32::try_from(label).map_or(Side::Exterior, |grain| Side::Grain(GrainId(grain)));
    let mut known: BTreeMap<[i32; 2], BoundaryId> =
        labels.iter().map(|pair| (*pair, BoundaryId(0))).collect();
    known.values_mut().zip(0..).for_each(|(boundary, number)| *boundary = BoundaryId(number));
    (labels.iter().map(|pair| known[pair]).collect(), known.keys().map(|pair| pair.map(side)).collect())
}
