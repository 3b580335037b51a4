//! Reading a map, whatever its format.

use std::fs;
use std::path::Path;

use glam::{BVec3, DVec3};

use super::ebsd::grains::grains;
use super::label_map::{FileMap, LabelMap, MapContent, MeasuredMap};
use super::options::{LabelParts, MapOptions};
use super::orientation_map::{Fault, PointList, ang, crc, ctf};
use super::stored_numbers::Source;
use super::{hdf5, mhd, npy, npz, nrrd, png, raw, slices, tesr, tiff, vti};
use crate::Error;
use crate::error::map_file::MapProblem;

/// A format of maps.
struct MapFormat {
    extension: &'static str,
    content: Content,
}

/// What a format holds, and what reads it.
enum Content {
    Labels(fn(&Source<'_>, &MapOptions) -> Result<FileMap, MapProblem>),
    /// Text with a line for each point.
    Orientations(fn(&str) -> Result<PointList, Fault>),
    /// Packed numbers of each point.
    Points(fn(&Source<'_>) -> Result<PointList, MapProblem>),
    /// Labels or points.
    Either(fn(&Source<'_>, &MapOptions) -> Result<MapContent, MapProblem>),
}

/// Every format, a line for each extension.
const FORMATS: [MapFormat; 20] = [
    MapFormat { extension: "vti", content: Content::Labels(vti::read) },
    MapFormat { extension: "npy", content: Content::Labels(npy::read) },
    MapFormat { extension: "npz", content: Content::Labels(npz::read) },
    MapFormat { extension: "nrrd", content: Content::Labels(nrrd::read) },
    MapFormat { extension: "nhdr", content: Content::Labels(nrrd::read) },
    MapFormat { extension: "mhd", content: Content::Labels(mhd::read) },
    MapFormat { extension: "mha", content: Content::Labels(mhd::read) },
    MapFormat { extension: "tesr", content: Content::Labels(tesr::read) },
    MapFormat { extension: "dream3d", content: Content::Either(hdf5::read) },
    MapFormat { extension: "h5", content: Content::Either(hdf5::read) },
    MapFormat { extension: "h5oina", content: Content::Either(hdf5::read) },
    MapFormat { extension: "h5ebsd", content: Content::Either(hdf5::read) },
    MapFormat { extension: "raw", content: Content::Labels(raw::read) },
    MapFormat { extension: "tif", content: Content::Labels(tiff::read) },
    MapFormat { extension: "tiff", content: Content::Labels(tiff::read) },
    MapFormat { extension: "png", content: Content::Labels(png::read) },
    MapFormat { extension: "ang", content: Content::Orientations(ang::read) },
    MapFormat { extension: "ctf", content: Content::Orientations(ctf::read) },
    MapFormat { extension: "cpr", content: Content::Points(crc::read) },
    MapFormat { extension: "crc", content: Content::Points(crc::read) },
];

/// Reads a map, crops it and cleans it as options say.
///
/// # Errors
/// [`Error::MapFile`] with what is wrong with the file, or does not go with it.
pub fn read_map(path: &Path, options: &MapOptions) -> Result<MeasuredMap, Error> {
    read(path, options).map_err(|problem| Error::MapFile { path: path.to_owned(), problem })
}

fn read(path: &Path, options: &MapOptions) -> Result<MeasuredMap, MapProblem> {
    if path.is_dir() {
        check_told("", options)?;
        return of_either(slices::read(path, options)?, options);
    }
    let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
    let format = FORMATS.iter().find(|format| extension == format.extension);
    let MapFormat { extension, content } =
        format.ok_or_else(|| MapProblem::UnknownExtension { known: known_extensions() })?;
    check_told(extension, options)?;
    let bytes = || fs::read(path).map_err(MapProblem::Unreadable);
    match content {
        Content::Labels(read) => {
            check_of_labels(options)?;
            labelled(read(&Source { path, bytes: &bytes()? }, options)?, options)
        }
        Content::Orientations(read) => {
            check_of_points(options)?;
            // Names of phases and comments may have any coding; numbers have one.
            let found = read(&String::from_utf8_lossy(&bytes()?));
            grains(&found.map_err(|(line, what)| MapProblem::Line { line, what })?, options)
        }
        Content::Points(read) => {
            check_of_points(options)?;
            grains(&read(&Source { path, bytes: &bytes()? })?, options).map_err(of_point)
        }
        Content::Either(read) => of_either(read(&Source { path, bytes: &bytes()? }, options)?, options),
    }
}

/// The grains of what may be labels or points.
fn of_either(found: MapContent, options: &MapOptions) -> Result<MeasuredMap, MapProblem> {
    match found {
        MapContent::Labels(found) => {
            check_of_labels(options)?;
            labelled(found, options)
        }
        MapContent::Points(found) => {
            check_of_points(options)?;
            grains(&found, options).map_err(of_point)
        }
    }
}

/// Checks that no option says what files with an extension tell themselves.
fn check_told(extension: &str, options: &MapOptions) -> Result<(), MapProblem> {
    if extension != "raw" && (options.shape.is_some() || options.number_type.is_some()) {
        return Err(MapProblem::Told { what: "shape and type", option: "--shape and --type" });
    }
    if !matches!(extension, "npy" | "npz") && options.axes.is_some() {
        return Err(MapProblem::Told { what: "order of axes", option: "--axes" });
    }
    Ok(())
}

/// What is wrong with a point of a file that has no lines.
fn of_point(problem: MapProblem) -> MapProblem {
    match problem {
        MapProblem::Line { line, what } => MapProblem::Point { point: line, what },
        MapProblem::NoGrid { line, what } => {
            let what = format!("{what}; give a map whose points stand on one square or hexagonal grid");
            MapProblem::Point { point: line, what }
        }
        other => other,
    }
}

/// Checks that no option is for maps of orientations.
fn check_of_labels(options: &MapOptions) -> Result<(), MapProblem> {
    match options.ebsd.first_given() {
        Some(option) => Err(MapProblem::OtherKind { kind: "a map of labels", option }),
        None => Ok(()),
    }
}

/// Checks that no option is for maps of labels.
fn check_of_points(options: &MapOptions) -> Result<(), MapProblem> {
    let of_labels = [
        ("--label-array", options.label_array.is_some()),
        ("--exterior-label", options.exterior_label.is_some()),
        ("--parts", options.parts != LabelParts::Keep),
        ("--periodic", options.periodic.is_some()),
    ];
    match of_labels.into_iter().find(|(_, is_given)| *is_given) {
        Some((option, _)) => Err(MapProblem::OtherKind { kind: "a map of orientations", option }),
        None => Ok(()),
    }
}

/// The grains of labels.
fn labelled(found: FileMap, options: &MapOptions) -> Result<MeasuredMap, MapProblem> {
    let FileMap { shape, spacing, origin, labels } = found;
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
    MeasuredMap::of_labels(LabelMap { shape, spacing, origin, periodic: BVec3::FALSE, labels }, options)
}

fn known_extensions() -> String {
    let all: Vec<String> = FORMATS.iter().map(|format| format!("*.{}", format.extension)).collect();
    let (last, others) = all.split_last().expect("there are formats");
    format!("{} or {last}", others.join(", "))
}
