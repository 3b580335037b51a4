//! grainsmooth as a Python module: classes on the library's memory, and functions that run beside other Python threads.
//!
//! What users see, with docstrings and types, is in `grainsmooth/*.py` beside this folder.

mod arrays;
mod errors;
mod maps;
mod network;
mod options;
mod polycrystal;
mod reading;
mod run;
mod subdivision;
mod surface;
mod tessellation;

/// The module that the package `grainsmooth` is made of.
#[pyo3::pymodule(gil_used = false)]
mod _grainsmooth {
    use pyo3::prelude::*;

    #[pymodule_export]
    use crate::errors::InternalError;
    #[pymodule_export]
    use crate::maps::{of_labels, of_map, of_orientations};
    #[pymodule_export]
    use crate::network::Network;
    #[pymodule_export]
    use crate::polycrystal::{Polycrystal, generate, of_settings};
    #[pymodule_export]
    use crate::reading::{check, measure, read};
    #[pymodule_export]
    use crate::subdivision::subdivide;
    #[pymodule_export]
    use crate::surface::of_arrays;
    #[pymodule_export]
    use crate::tessellation::{Tessellation, tessellate, tessellation_of};

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
