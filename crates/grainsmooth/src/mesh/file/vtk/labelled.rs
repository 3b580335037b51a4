//! VTK files of labelled networks: cells with two sides each.

use std::ops::RangeInclusive;

use vtkio::IOBuffer;
use vtkio::model::{Attribute, CellType, DataSet, Vtk};

use super::{MeshFile, MeshFileProblem, cells, in_thread, inline, legacy_parts, problem, xml_parts};
use crate::names::{BOUNDARY_ID, FIELD_NAMES, LABEL_ARRAYS, NUMBER_OF_GRAINS};
use crate::vtk::{DataArray, DataNumbers, FieldEntry, FieldValue, XmlFile, field_entry};

const NODE_TYPES: &str = "NodeTypes";

const PERIODIC_ORIGINALS: &str = "PeriodicOriginal";

const POINT_ARRAYS: [&str; 3] = [NODE_TYPES, NUMBER_OF_GRAINS, PERIODIC_ORIGINALS];

/// What the field data of a file of this program say, also after another has read and written it.
#[derive(Debug, Default)]
pub(crate) struct Notes {
    /// All entries whose names this program knows.
    pub(crate) entries: Vec<FieldEntry>,
    /// The names of the others.
    pub(crate) unknown: Vec<String>,
}

impl Notes {
    /// Keeps an entry as it is, where its name is known.
    pub(crate) fn note(&mut self, name: &str, value: FieldValue) {
        match FIELD_NAMES.iter().find(|(known, _)| *known == name) {
            Some((name, _)) => self.entries.push(FieldEntry { name, value }),
            None => self.unknown.push(name.to_owned()),
        }
    }

    /// All entries of a .vtp or .vtu file.
    pub(super) fn of_xml(bytes: &[u8]) -> Self {
        let mut notes = Self::default();
        let Some(file) = XmlFile::of(bytes) else { return notes };
        for name in file.arrays("FieldData").filter_map(|array| array.attribute("Name")) {
            let known = FIELD_NAMES.iter().find(|(known, _)| *known == name);
            match known.and_then(|(name, is_text)| field_entry(&file, name, *is_text)) {
                Some(entry) => notes.entries.push(entry),
                None => notes.unknown.push(name),
            }
        }
        notes
    }

    fn value(&self, name: &str) -> Option<&FieldValue> {
        self.entries.iter().find(|entry| entry.name == name).map(|entry| &entry.value)
    }

    /// A text.
    pub(crate) fn text(&self, name: &str) -> Option<&str> {
        match self.value(name)? {
            FieldValue::Text(text) => Some(text),
            _ => None,
        }
    }

    /// Floating point numbers, one tuple after the other.
    pub(crate) fn numbers(&self, name: &str) -> Option<&[f64]> {
        match self.value(name)? {
            FieldValue::Data(DataArray { numbers: DataNumbers::Float64(numbers), .. }) => Some(numbers),
            _ => None,
        }
    }

    /// Whole numbers.
    pub(crate) fn ids(&self, name: &str) -> Option<&[i32]> {
        match self.value(name)? {
            FieldValue::Data(DataArray { numbers: DataNumbers::Int32(ids), .. }) => Some(ids),
            _ => None,
        }
    }
}

/// A network as a VTK file holds it.
#[derive(Debug, Default)]
pub(crate) struct LabelledCells {
    /// Points and polygons; in the plane, polylines.
    pub(crate) mesh: MeshFile,
    /// Whether the cells are polylines.
    pub(crate) is_plane: bool,
    /// The sides of each cell, as they are.
    pub(crate) labels: Vec<[i64; 2]>,
    /// The array that they are from.
    pub(crate) label_array: &'static str,
    /// The number of each cell's boundary, if there are any.
    pub(crate) boundary_ids: Option<Vec<i64>>,
    /// Types of points, if there are any.
    pub(crate) node_types: Option<Vec<i64>>,
    /// Numbers of grains at points, if there are any.
    pub(crate) grain_counts: Option<Vec<u8>>,
    /// Of each point the one that it is a copy of, if there are any.
    pub(crate) originals: Option<Vec<u32>>,
    /// Whether points are in single precision.
    pub(crate) is_single: bool,
    pub(crate) notes: Notes,
}

/// Reads a legacy file.
pub(crate) fn read_legacy(bytes: &[u8]) -> Result<LabelledCells, MeshFileProblem> {
    let (bytes, notes) = legacy_parts::readable(bytes)?;
    let cells = in_thread(|| of_data(Vtk::parse_legacy_be(&bytes[..]).map_err(problem)?.data))?;
    Ok(LabelledCells { notes, ..cells })
}

/// Reads a .vtp or .vtu file.
pub(crate) fn read_xml(bytes: &[u8]) -> Result<LabelledCells, MeshFileProblem> {
    let wanted: Vec<&str> = LABEL_ARRAYS.into_iter().chain(POINT_ARRAYS).chain([BOUNDARY_ID]).collect();
    let parts = xml_parts::network(bytes, &wanted)?;
    in_thread(|| {
        let cells = of_data(Vtk::parse_xml(&parts[..]).map_err(problem)?.data)?;
        Ok(LabelledCells { notes: Notes::of_xml(bytes), ..cells })
    })
}

fn of_data(data: DataSet) -> Result<LabelledCells, MeshFileProblem> {
    let mut found = LabelledCells::default();
    let (attributes, skipped) = match data {
        DataSet::PolyData { pieces, .. } => {
            let [piece] = <[_; 1]>::try_from(pieces).map_err(|_| problem("it is in several pieces"))?;
            let piece = inline(piece)?;
            found.mesh.add_points(&piece.points)?;
            found.is_single = matches!(piece.points, IOBuffer::F32(_));
            let lines: Vec<Vec<u64>> = piece.lines.iter().flat_map(cells).collect::<Result<_, _>>()?;
            let polygons: Vec<Vec<u64>> = piece.polys.iter().flat_map(cells).collect::<Result<_, _>>()?;
            if piece.strips.iter().flat_map(cells).next().is_some() {
                return Err(problem("it has triangle strips, whose triangles have no labels of their own"));
            }
            // The arrays of cells begin with those of points, then lines, then polygons.
            let point_cells = piece.verts.iter().flat_map(cells).count();
            found.is_plane = polygons.is_empty();
            let skipped = point_cells + if found.is_plane { 0 } else { lines.len() };
            for cell in if found.is_plane { lines } else { polygons } {
                found.mesh.add_face(0, cell)?;
            }
            (piece.data, skipped)
        }
        DataSet::UnstructuredGrid { pieces, .. } => {
            let [piece] = <[_; 1]>::try_from(pieces).map_err(|_| problem("it is in several pieces"))?;
            let piece = inline(piece)?;
            found.mesh.add_points(&piece.points)?;
            found.is_single = matches!(piece.points, IOBuffer::F32(_));
            found.is_plane =
                piece.cells.types.iter().all(|kind| matches!(kind, CellType::Line | CellType::PolyLine));
            for (index, (kind, cell)) in
                piece.cells.types.iter().zip(cells(&piece.cells.cell_verts)).enumerate()
            {
                let fits = match kind {
                    CellType::Line | CellType::PolyLine => found.is_plane,
                    CellType::Triangle | CellType::Polygon | CellType::Quad => true,
                    _ => false,
                };
                if !fits {
                    let (cell, kind) = (index, format!("{kind:?}"));
                    return Err(MeshFileProblem::NotABoundary { cell, kind });
                }
                found.mesh.add_face(0, cell?)?;
            }
            (piece.data, 0)
        }
        _ => return Err(problem("it is neither PolyData nor UnstructuredGrid")),
    };
    if found.mesh.faces.is_empty() {
        return Err(MeshFileProblem::NoFaces);
    }
    let labels = LABEL_ARRAYS.into_iter().find_map(|name| Some((name, array(&attributes.cell, name)?)));
    let (name, labels) = labels.ok_or(MeshFileProblem::NoLabels)?;
    let labels: Vec<i64> =
        whole_numbers(labels).ok_or_else(|| problem(format!("{name} are no whole numbers")))?;
    let count = found.mesh.faces.len();
    let labels = without_third(labels, skipped + count);
    if labels.len() != 2 * (skipped + count) {
        let (have, cells) = (labels.len(), skipped + count);
        return Err(problem(format!("{name} has {have} numbers where {cells} cells need two each")));
    }
    found.labels = labels.as_chunks().0[skipped..].to_vec();
    found.label_array = name;
    let ids = array(&attributes.cell, BOUNDARY_ID).and_then(whole_numbers);
    found.boundary_ids = ids.filter(|ids| ids.len() == skipped + count).map(|ids| ids[skipped..].to_vec());
    let count = found.mesh.points.len();
    let of_points = |name| match array(&attributes.point, name).and_then(whole_numbers) {
        Some(numbers) if numbers.len() != count => {
            Err(problem(format!("{name} has {} numbers for {count} points", numbers.len())))
        }
        numbers => Ok(numbers),
    };
    found.node_types = of_points(NODE_TYPES)?;
    if let Some(counts) = of_points(NUMBER_OF_GRAINS)? {
        found.grain_counts = Some(within(&counts, NUMBER_OF_GRAINS, 1..=i64::from(u8::MAX))?);
    }
    if let Some(originals) = of_points(PERIODIC_ORIGINALS)? {
        // There are fewer points than 2^31.
        let last = i64::try_from(count).unwrap_or(i64::MAX) - 1;
        found.originals = Some(within(&originals, PERIODIC_ORIGINALS, 0..=last)?);
    }
    Ok(found)
}

/// Numbers of points that all lie in a range.
fn within<T: TryFrom<i64>>(
    numbers: &[i64],
    name: &str,
    range: RangeInclusive<i64>,
) -> Result<Vec<T>, MeshFileProblem> {
    let number = |(point, number): (usize, &i64)| {
        let fitting = T::try_from(*number).ok().filter(|_| range.contains(number));
        let [first, last] = [range.start(), range.end()];
        fitting.ok_or_else(|| {
            problem(format!("{name} of point {point} is {number} and not from {first} to {last}"))
        })
    };
    numbers.iter().enumerate().map(number).collect()
}

/// Labels without the zeros that meshio puts after each pair in legacy files.
fn without_third(labels: Vec<i64>, cell_count: usize) -> Vec<i64> {
    let triples = labels.as_chunks::<3>().0;
    if labels.len() == 3 * cell_count && triples.iter().all(|[.., third]| *third == 0) {
        return triples.iter().flat_map(|&[first, second, _]| [first, second]).collect();
    }
    labels
}

fn array<'a>(attributes: &'a [Attribute], name: &str) -> Option<&'a IOBuffer> {
    attributes.iter().find_map(|attribute| match attribute {
        Attribute::DataArray(array) => (array.name == name).then_some(&array.data),
        Attribute::Field { data_array, .. } => {
            data_array.iter().find(|array| array.name == name).map(|array| &array.data)
        }
    })
}

fn whole_numbers(buffer: &IOBuffer) -> Option<Vec<i64>> {
    let is_whole = match buffer {
        IOBuffer::F32(numbers) => numbers.iter().all(|number| number.fract() == 0.0),
        IOBuffer::F64(numbers) => numbers.iter().all(|number| number.fract() == 0.0),
        _ => true,
    };
    is_whole.then(|| buffer.cast_into())?
}
