//! Labels of voxels in HDF5: z first, then y, then x, and perhaps a last index of one.

use super::super::label_map::{FileMap, USUAL_NAMES};
use super::super::options::MapOptions;
use super::file::{Hdf5, base, damaged};
use super::geometry::Geometry;
use crate::error::map_file::MapProblem;

/// Whether an array has a usual name of labels.
pub(super) fn are_in(file: &Hdf5) -> bool {
    file.paths().any(|path| is_usual(path) && voxels(file, path).is_some())
}

/// Reads the labels: those of the array asked for, else of the only one with a usual name.
pub(super) fn read(file: &Hdf5, options: &MapOptions) -> Result<FileMap, MapProblem> {
    let mut paths: Vec<&str> = file.paths().filter(|path| voxels(file, path).is_some()).collect();
    let known = |paths: &[&str]| paths.join(", ");
    if let Some(name) = &options.label_array {
        let all = known(&paths);
        paths.retain(|path| path == name || base(path) == name);
        if paths.is_empty() && !all.is_empty() {
            return Err(MapProblem::NoSuchArray { name: name.clone(), known: all });
        }
    } else {
        paths.retain(|path| is_usual(path));
    }
    let path = match paths[..] {
        [] => return Err(MapProblem::NoLabels),
        [path] => path,
        _ => return Err(MapProblem::SeveralArrays { known: known(&paths) }),
    };
    let shape = voxels(file, path).ok_or(MapProblem::NoLabels)?;
    let geometry = Geometry::of(file, path)?;
    if let Some(told) = geometry.and_then(|geometry| geometry.shape).filter(|told| *told != shape) {
        return Err(damaged(format!("its array {path} has {shape:?} voxels, and its geometry {told:?}")));
    }
    let labels = file.labels(path)?.ok_or(MapProblem::NoLabels)?;
    if Some(labels.len()) != shape.iter().try_fold(1_usize, |all, count| all.checked_mul(*count)) {
        return Err(damaged(format!("its array {path} has {} numbers for {shape:?} voxels", labels.len())));
    }
    Ok(FileMap {
        shape,
        spacing: geometry.map(|geometry| geometry.spacing),
        origin: geometry.map(|geometry| geometry.origin),
        labels,
    })
}

fn is_usual(path: &str) -> bool {
    USUAL_NAMES.iter().any(|name| name.eq_ignore_ascii_case(base(path)))
}

/// Number of voxels along x, y and z of an array with one number for each; nothing of others.
fn voxels(file: &Hdf5, path: &str) -> Option<[usize; 3]> {
    file.number_type(path)?;
    match file.shape(path)?[..] {
        [ny, nx] if nx > 1 => Some([nx, ny, 1]),
        [nz, ny, nx] | [nz, ny, nx, 1] => Some([nx, ny, nz]),
        _ => None,
    }
}
