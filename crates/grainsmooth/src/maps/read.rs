//! Reading a map, whatever its format.

use std::fs;
use std::path::Path;

use glam::DVec3;

use super::cleaning::cleaned;
use super::label_map::{FileMap, LabelMap, MeasuredMap};
use super::options::MapOptions;
use super::stored_numbers::Source;
use super::{mhd, npy, nrrd, raw, tesr, vti};
use crate::Error;
use crate::error::map_file::MapProblem;

/// A format of maps.
struct MapFormat {
    extension: &'static str,
    read: fn(&Source<'_>, &MapOptions) -> Result<FileMap, MapProblem>,
}

/// Every format, a line for each extension.
const FORMATS: [MapFormat; 8] = [
    MapFormat { extension: "vti", read: vti::read },
    MapFormat { extension: "npy", read: npy::read },
    MapFormat { extension: "nrrd", read: nrrd::read },
    MapFormat { extension: "nhdr", read: nrrd::read },
    MapFormat { extension: "mhd", read: mhd::read },
    MapFormat { extension: "mha", read: mhd::read },
    MapFormat { extension: "tesr", read: tesr::read },
    MapFormat { extension: "raw", read: raw::read },
];

/// Reads a map, crops it and cleans it as options say.
///
/// # Errors
/// [`Error::MapFile`] with what is wrong with the file, or does not go with it.
pub fn read_map(path: &Path, options: &MapOptions) -> Result<MeasuredMap, Error> {
    read(path, options).map_err(|problem| Error::MapFile { path: path.to_owned(), problem })
}

fn read(path: &Path, options: &MapOptions) -> Result<MeasuredMap, MapProblem> {
    let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
    let format = FORMATS.iter().find(|format| extension == format.extension);
    let format = format.ok_or_else(|| MapProblem::UnknownExtension { known: known_extensions() })?;
    if format.extension != "raw" && (options.shape.is_some() || options.number_type.is_some()) {
        return Err(MapProblem::Told { what: "shape and type", option: "--shape and --type" });
    }
    if format.extension != "npy" && options.axes.is_some() {
        return Err(MapProblem::Told { what: "order of axes", option: "--axes" });
    }
    let bytes = fs::read(path).map_err(MapProblem::Unreadable)?;
    let FileMap { shape, spacing, origin, labels } = (format.read)(&Source { path, bytes: &bytes }, options)?;
    let axes = ['x', 'y', 'z'].into_iter();
    if let Some((axis, _)) = axes.clone().zip(shape).find(|(_, count)| *count == 0) {
        return Err(MapProblem::Empty { axis });
    }
    let spacing = options.spacing().or(spacing).unwrap_or(DVec3::ONE);
    let is_width = |spacing: f64| spacing.is_finite() && spacing > 0.0;
    if let Some((axis, spacing)) = axes.zip(spacing.to_array()).find(|(_, spacing)| !is_width(*spacing)) {
        return Err(MapProblem::Spacing { axis, spacing });
    }
    let origin = origin.filter(|origin| origin.is_finite()).unwrap_or(DVec3::ZERO);
    cleaned(LabelMap { shape, spacing, origin, labels }, options)
}

fn known_extensions() -> String {
    let all: Vec<String> = FORMATS.iter().map(|format| format!("*.{}", format.extension)).collect();
    let (last, others) = all.split_last().expect("there are formats");
    format!("{} or {last}", others.join(", "))
}
