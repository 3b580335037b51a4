//! VTK files, legacy and XML, through `vtkio`.

use std::thread;

use glam::DVec3;
use vtkio::IOBuffer;
use vtkio::model::{
    Attribute, Attributes, CellType, DataSet, FieldArray, Piece, PieceData, VertexNumbers, Vtk,
};

use super::{MeshFile, MeshFileProblem};
use crate::vtk::DataArray;
use labelled::Notes;

mod field;
pub(crate) mod labelled;
mod legacy_parts;
mod xml_parts;

/// The name of the thread in which `vtkio` reads.
///
/// It panics on some corrupt files. That ends this thread only and becomes an error; a program that installs a panic
/// hook can keep it quiet about threads of this name.
pub const READER_THREAD: &str = "vtkio reader";

/// Reads a legacy file.
pub(super) fn read_legacy(bytes: &[u8]) -> Result<MeshFile, MeshFileProblem> {
    let (bytes, notes) = legacy_parts::readable(bytes)?;
    let mesh = in_thread(|| mesh_of(Vtk::parse_legacy_be(&bytes[..]).map_err(problem)?.data))?;
    Ok(mesh.with_remarks(notes))
}

/// Reads a .vtp or .vtu file.
pub(super) fn read_xml(bytes: &[u8]) -> Result<MeshFile, MeshFileProblem> {
    let read = |parts: Vec<u8>| in_thread(|| mesh_of(Vtk::parse_xml(&parts[..]).map_err(problem)?.data));
    // Arrays that cannot be read are no reason to refuse a mesh.
    let with_data = xml_parts::all(bytes).and_then(read);
    let mesh = with_data.or_else(|_| {
        let mesh = xml_parts::points_and_faces(bytes).and_then(read)?;
        Ok::<_, MeshFileProblem>(MeshFile { left_behind: xml_parts::array_names(bytes), ..mesh })
    })?;
    Ok(mesh.with_remarks(Notes::of_xml(bytes)))
}

fn problem(error: impl ToString) -> MeshFileProblem {
    MeshFileProblem::corrupt("VTK", error)
}

fn in_thread<T: Send>(
    read: impl FnOnce() -> Result<T, MeshFileProblem> + Send,
) -> Result<T, MeshFileProblem> {
    thread::scope(|scope| {
        thread::Builder::new()
            .name(READER_THREAD.to_owned())
            .spawn_scoped(scope, read)
            .map_err(MeshFileProblem::Unreadable)?
            .join()
            .unwrap_or_else(|_| Err(problem("its parts do not fit together")))
    })
}

fn mesh_of(data: DataSet) -> Result<MeshFile, MeshFileProblem> {
    let mut mesh = MeshFile::default();
    match data {
        DataSet::PolyData { pieces, .. } => {
            let is_whole = pieces.len() == 1;
            for piece in pieces {
                let piece = inline(piece)?;
                let first = mesh.add_points(&piece.points)?;
                let has_strips = piece.strips.iter().flat_map(cells).next().is_some();
                let data = Some(piece.data).filter(|_| is_whole);
                for line in piece.lines.iter().flat_map(cells) {
                    mesh.add_line(first, line?)?;
                }
                for face in piece.polys.iter().flat_map(cells) {
                    mesh.add_face(first, face?)?;
                }
                for strip in piece.strips.iter().flat_map(cells) {
                    mesh.add_strip(first, &strip?)?;
                }
                // The arrays of cells begin with those of points, then lines, then polygons.
                let [lines, faces] = [mesh.lines.len(), mesh.faces.len()];
                let rows = |count: usize| {
                    let first = (!has_strips).then(|| count.checked_sub(lines + faces))??;
                    Some([(first..first + lines).collect(), (first + lines..count).collect()])
                };
                mesh.add_data(data, rows);
            }
        }
        DataSet::UnstructuredGrid { pieces, .. } => {
            let is_whole = pieces.len() == 1;
            for piece in pieces {
                let piece = inline(piece)?;
                let first = mesh.add_points(&piece.points)?;
                let mut rows = [Vec::new(), Vec::new()];
                let all = cells(&piece.cells.cell_verts);
                for (index, (kind, cell)) in piece.cells.types.iter().zip(all).enumerate() {
                    mesh.add_cell(first, *kind, cell?)
                        .map_err(|kind| problem(format!("cell {index} is a {kind:?}, not a polygon")))??;
                    rows[0].resize(mesh.lines.len(), index);
                    rows[1].resize(mesh.faces.len(), index);
                }
                let cell_count = piece.cells.types.len();
                let rows = |count: usize| (count == cell_count).then(|| rows.clone());
                mesh.add_data(Some(piece.data).filter(|_| is_whole), rows);
            }
        }
        _ => return Err(problem("it is neither PolyData nor UnstructuredGrid")),
    }
    Ok(mesh)
}

fn inline<P: PieceData>(piece: Piece<P>) -> Result<P, MeshFileProblem> {
    match piece {
        Piece::Source(..) => Err(problem("its pieces are in other files")),
        piece => piece.into_loaded_piece_data(None).map_err(problem),
    }
}

impl MeshFile {
    /// Adds points and returns the id of the first.
    fn add_points(&mut self, coordinates: &IOBuffer) -> Result<u64, MeshFileProblem> {
        let first = self.points.len() as u64;
        let coordinates =
            coordinates.cast_into::<f64>().ok_or_else(|| problem("its points are not numbers"))?;
        let (points, []) = coordinates.as_chunks::<3>() else {
            return Err(problem("a point has not three coordinates"));
        };
        self.points.extend(points.iter().copied().map(DVec3::from_array));
        Ok(first)
    }

    /// Takes over the arrays of a file that is in one piece. `rows` tells, of so many rows, which are those of lines and of faces.
    fn add_data(&mut self, data: Option<Attributes>, rows: impl Fn(usize) -> Option<[Vec<usize>; 2]>) {
        let Some(data) = data else { return };
        for (name, array) in data.point.iter().flat_map(named) {
            match array.filter(|array| array.len() == self.points.len()) {
                Some(array) => self.point_data.push(array),
                None => self.left_behind.push(name),
            }
        }
        for (name, array) in data.cell.iter().flat_map(named) {
            let found = array.and_then(|array| rows(array.len()).map(|rows| (array, rows)));
            let Some((array, [lines, faces])) = found else {
                self.left_behind.push(name);
                continue;
            };
            if !self.lines.is_empty() {
                self.line_data.push(array.at(lines.into_iter()));
            }
            self.face_data.push(array.at(faces.into_iter()));
        }
    }

    fn with_remarks(mut self, notes: Notes) -> Self {
        self.field = notes.entries;
        // These are said anew.
        let is_ours = |name: &String| ["Version", "CommandLine"].contains(&name.as_str());
        self.left_behind.extend(notes.unknown.into_iter().filter(|name| !is_ours(name)));
        self
    }

    fn add_face(&mut self, first: u64, face: Vec<u64>) -> Result<(), MeshFileProblem> {
        let face = self.known(first, face, "face", self.faces.len())?;
        self.faces.push(face);
        Ok(())
    }

    fn add_line(&mut self, first: u64, line: Vec<u64>) -> Result<(), MeshFileProblem> {
        let line = self.known(first, line, "line", self.lines.len())?;
        self.lines.push(line);
        Ok(())
    }

    /// The points of a cell, counted from the first of its piece.
    fn known(
        &self,
        first: u64,
        cell: Vec<u64>,
        what: &str,
        index: usize,
    ) -> Result<Vec<u32>, MeshFileProblem> {
        let count = self.points.len();
        let id = |id: u64| {
            let point = first.checked_add(id).and_then(|id| u32::try_from(id).ok());
            point.filter(|&id| (id as usize) < count).ok_or_else(|| {
                problem(format!("{what} {index} refers to point {id}, but there are only {count} points"))
            })
        };
        cell.into_iter().map(id).collect()
    }

    /// Every other triangle of a strip winds the other way.
    fn add_strip(&mut self, first: u64, strip: &[u64]) -> Result<(), MeshFileProblem> {
        for (index, corners) in strip.windows(3).enumerate() {
            let [a, b] = if index % 2 == 0 { [0, 1] } else { [1, 0] };
            self.add_face(first, vec![corners[a], corners[b], corners[2]])?;
        }
        Ok(())
    }

    /// Adds a cell of an unstructured grid; points are passed over, and solids refused.
    fn add_cell(
        &mut self,
        first: u64,
        kind: CellType,
        mut cell: Vec<u64>,
    ) -> Result<Result<(), MeshFileProblem>, CellType> {
        Ok(match kind {
            CellType::Vertex | CellType::PolyVertex => Ok(()),
            CellType::Line | CellType::PolyLine => self.add_line(first, cell),
            CellType::Triangle | CellType::Polygon | CellType::Quad => self.add_face(first, cell),
            CellType::Pixel if cell.len() == 4 => {
                cell.swap(2, 3);
                self.add_face(first, cell)
            }
            CellType::TriangleStrip => self.add_strip(first, &cell),
            other => return Err(other),
        })
    }
}

/// The arrays of an attribute, each by its name, and nothing for what is no array of numbers.
fn named(attribute: &Attribute) -> Vec<(String, Option<DataArray>)> {
    match attribute {
        Attribute::DataArray(array) => {
            vec![(array.name.clone(), DataArray::of_buffer(&array.name, array.num_comp(), &array.data))]
        }
        Attribute::Field { data_array, .. } => {
            let array = |array: &FieldArray| {
                (array.name.clone(), DataArray::of_buffer(&array.name, array.num_comp(), &array.data))
            };
            data_array.iter().map(array).collect()
        }
    }
}

/// The points of each cell, in either of the two ways to store them.
fn cells(numbers: &VertexNumbers) -> Box<dyn Iterator<Item = Result<Vec<u64>, MeshFileProblem>> + '_> {
    let short = || problem("the points of a cell are missing");
    match numbers {
        VertexNumbers::Legacy { num_cells, vertices } => {
            let mut rest = &vertices[..];
            Box::new((0..*num_cells).map(move |_| {
                let (&count, after) = rest.split_first().ok_or_else(short)?;
                let (cell, after) = after.split_at_checked(count as usize).ok_or_else(short)?;
                rest = after;
                Ok(cell.iter().copied().map(u64::from).collect())
            }))
        }
        VertexNumbers::XML { connectivity, offsets } => {
            let mut start = 0;
            // Some files begin with a zero that ends no cell.
            let ends = offsets.strip_prefix(&[0]).unwrap_or(offsets);
            Box::new(ends.iter().map(move |&end| {
                let end = usize::try_from(end).map_err(|_| short())?;
                let cell = connectivity.get(start..end).ok_or_else(short)?.to_vec();
                start = end;
                Ok(cell)
            }))
        }
    }
}
