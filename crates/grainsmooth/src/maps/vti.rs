//! VTK's ImageData: labels of cells, or of points in the middle of voxels.

use glam::DVec3;
use vtkio::xml::ScalarType;

use super::label_map::{FileMap, USUAL_NAMES};
use super::number_type::labels_of_floats;
use super::options::MapOptions;
use super::stored_numbers::Source;
use crate::error::map_file::MapProblem;
use crate::vtk::{Element, XmlFile};

/// An array with a number for each voxel.
struct Candidate<'a> {
    name: String,
    array: &'a Element<'a>,
    kind: ScalarType,
    is_of_points: bool,
}

impl Candidate<'_> {
    /// Whether its numbers are whole ones by their type.
    fn is_whole(&self) -> bool {
        !matches!(self.kind, ScalarType::Float32 | ScalarType::Float64)
    }
}

/// Reads the labels.
pub(super) fn read(source: &Source<'_>, options: &MapOptions) -> Result<FileMap, MapProblem> {
    let file = XmlFile::of(source.bytes).ok_or_else(|| damaged("it is no XML of VTK"))?;
    let image = file.root.first("ImageData").ok_or_else(|| damaged("it holds no ImageData"))?;
    let missing = |name: &str| damaged(format!("its ImageData has no {name} that is understood"));
    if image.all("Piece").len() != 1 {
        return Err(MapProblem::Unfit { what: "it is not in one piece", remedy: "save it as one" });
    }
    let extent: [i64; 6] = numbers(image, "WholeExtent").ok_or_else(|| missing("WholeExtent"))?;
    let edges = |axis: usize| {
        let count = extent[2 * axis + 1].checked_sub(extent[2 * axis])?;
        usize::try_from(count).ok()
    };
    let edges = [edges(0), edges(1), edges(2)];
    let [Some(nx), Some(ny), Some(nz)] = edges else { return Err(missing("WholeExtent")) };
    let spacing = DVec3::from_array(numbers(image, "Spacing").ok_or_else(|| missing("Spacing"))?);
    let origin = DVec3::from_array(numbers(image, "Origin").ok_or_else(|| missing("Origin"))?);
    let direction = image.attribute("Direction").map(|_| numbers::<f64, 9>(image, "Direction"));
    if direction.is_some_and(|axes| axes != Some([1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0])) {
        return Err(damaged("its axes are turned, which maps may not be"));
    }
    let first = DVec3::new(extent[0] as f64, extent[2] as f64, extent[4] as f64);
    // A grid of one layer of points has cells too.
    let shapes = [[nx, ny, nz].map(|count| count.max(1)), [nx, ny, nz].map(|count| count.saturating_add(1))];
    let candidate = labels_among(candidates(&file), options)?;
    let shape = shapes[usize::from(candidate.is_of_points)];
    let unread = || damaged(format!("the numbers of its array {} are damaged", candidate.name));
    let values = file.values(candidate.array, candidate.kind).ok_or_else(unread)?;
    let count = shape.iter().try_fold(1, |all: usize, count| all.checked_mul(*count));
    if count != Some(values.len()) {
        let [nx, ny, nz] = shape;
        let (name, found) = (&candidate.name, values.len());
        return Err(damaged(format!("its array {name} has {found} numbers for {nx} x {ny} x {nz} voxels")));
    }
    let whole = if candidate.is_whole() { values.cast_into::<i32>() } else { None };
    let labels = match whole {
        Some(labels) => labels,
        // Those that do not fit are found, and named, among floating point numbers.
        None => labels_of_floats(values.cast_into::<f64>().ok_or_else(unread)?.into_iter())?,
    };
    let lower = if candidate.is_of_points { first - 0.5 } else { first };
    Ok(FileMap { shape, spacing: Some(spacing), origin: Some(origin + lower * spacing), labels })
}

/// The arrays with one number each.
fn candidates<'a>(file: &'a XmlFile<'a>) -> Vec<Candidate<'a>> {
    let of_element = |(element, is_of_points): (&str, bool)| {
        let candidate = move |array: &'a Element<'a>| {
            let is_scalar = array.attribute("NumberOfComponents").is_none_or(|count| count == "1");
            let kind = array.scalar_type()?;
            let name = array.attribute("Name")?;
            is_scalar.then_some(Candidate { name, array, kind, is_of_points })
        };
        file.arrays(element).filter_map(candidate).collect::<Vec<_>>()
    };
    [("CellData", false), ("PointData", true)].into_iter().flat_map(of_element).collect()
}

/// The array that holds the labels: the one asked for; else the only one of whole numbers, or the only one with a usual name.
fn labels_among<'a>(
    mut candidates: Vec<Candidate<'a>>,
    options: &MapOptions,
) -> Result<Candidate<'a>, MapProblem> {
    let known = |candidates: &[Candidate<'_>]| {
        candidates.iter().map(|candidate| candidate.name.as_str()).collect::<Vec<_>>().join(", ")
    };
    if let Some(name) = &options.label_array {
        let known = known(&candidates);
        let found = candidates.into_iter().find(|candidate| candidate.name == *name);
        return found.ok_or_else(|| match known.is_empty() {
            true => MapProblem::NoLabels,
            false => MapProblem::NoSuchArray { name: name.clone(), known },
        });
    }
    if candidates.iter().any(Candidate::is_whole) {
        candidates.retain(Candidate::is_whole);
    }
    let is_usual =
        |candidate: &Candidate<'_>| USUAL_NAMES.iter().any(|name| name.eq_ignore_ascii_case(&candidate.name));
    if candidates.len() > 1 && candidates.iter().any(is_usual) {
        candidates.retain(is_usual);
    }
    let known = known(&candidates);
    match (candidates.pop(), candidates.is_empty()) {
        (None, _) => Err(MapProblem::NoLabels),
        (Some(candidate), true) => Ok(candidate),
        (Some(_), false) => Err(MapProblem::SeveralArrays { known }),
    }
}

/// The numbers of an attribute.
fn numbers<T: std::str::FromStr, const N: usize>(element: &Element<'_>, name: &str) -> Option<[T; N]> {
    let value = element.attribute(name)?;
    let words = value.split_whitespace();
    words.map(|word| word.parse().ok()).collect::<Option<Vec<T>>>()?.try_into().ok()
}

fn damaged(what: impl Into<String>) -> MapProblem {
    MapProblem::Damaged { format: ".vti", what: what.into() }
}
