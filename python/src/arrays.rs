//! Arrays of NumPy on the library's memory, and the library's points from arrays.

use glam::DVec3;
use numpy::ndarray::{Array2, ArrayView1, ArrayView2};
use numpy::{
    Element, IntoPyArray, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2,
    PyUntypedArrayMethods,
};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;

/// A read-only array of a list that `owner` holds: a frozen object, whose lists never move. The array keeps it alive.
#[expect(unsafe_code, reason = "NumPy is given memory that its owner outlives")]
pub fn view<'py, T: Element>(owner: &Bound<'py, PyAny>, list: &[T]) -> Bound<'py, PyArray1<T>> {
    let view = ArrayView1::from(list);
    // SAFETY: the list belongs to the owner, which the array keeps alive and nothing changes.
    let array = unsafe { PyArray1::borrow_from_array(&view, owner.clone()) };
    array.readwrite().make_nonwriteable();
    array
}

/// The same of a list of rows.
#[expect(unsafe_code, reason = "NumPy is given memory that its owner outlives")]
pub fn view_of_rows<'py, T: Element, const N: usize>(
    owner: &Bound<'py, PyAny>,
    rows: &[[T; N]],
) -> Bound<'py, PyArray2<T>> {
    let view = ArrayView2::from(rows);
    // SAFETY: as above.
    let array = unsafe { PyArray2::borrow_from_array(&view, owner.clone()) };
    array.readwrite().make_nonwriteable();
    array
}

/// The same of points.
pub fn view_of_points<'py>(owner: &Bound<'py, PyAny>, points: &[DVec3]) -> Bound<'py, PyArray2<f64>> {
    view_of_rows::<f64, 3>(owner, bytemuck::cast_slice(points))
}

/// A new array of rows.
pub fn rows<'py, T: Element, const N: usize>(py: Python<'py>, rows: Vec<[T; N]>) -> Bound<'py, PyArray2<T>> {
    Array2::from(rows).into_pyarray(py)
}

/// A new array of points.
pub fn new_points<'py>(py: Python<'py>, points: &[DVec3]) -> Bound<'py, PyArray2<f64>> {
    rows(py, points.iter().map(|point| point.to_array()).collect())
}

/// The rows of an array, which lie behind each other in memory: `as_slice` alone would take columns for rows.
pub fn rows_of<'a, T: Element, const N: usize>(
    name: &str,
    array: &'a PyReadonlyArray2<'_, T>,
) -> PyResult<&'a [[T; N]]> {
    let mistaken = || PyTypeError::new_err(format!("{name}: give an array of shape (n, {N}) in C order"));
    if !array.is_c_contiguous() || array.shape()[1] != N {
        return Err(mistaken());
    }
    let (rows, []) = array.as_slice().map_err(|_| mistaken())?.as_chunks() else { return Err(mistaken()) };
    Ok(rows)
}

/// The points of an array of shape (n, 3).
pub fn points(name: &str, array: &PyReadonlyArray2<'_, f64>) -> PyResult<Vec<DVec3>> {
    Ok(rows_of::<f64, 3>(name, array)?.iter().copied().map(DVec3::from).collect())
}

/// A list from an array of one axis.
pub fn list<T: Element + Copy>(name: &str, array: &PyReadonlyArray1<'_, T>) -> PyResult<Vec<T>> {
    let mistaken = |_| PyTypeError::new_err(format!("{name}: give an array of one axis without gaps"));
    array.as_slice().map(<[T]>::to_vec).map_err(mistaken)
}
