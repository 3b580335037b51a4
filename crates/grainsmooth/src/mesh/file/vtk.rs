//! VTK files, legacy and XML, through `vtkio`.

use std::thread;

use glam::DVec3;
use vtkio::IOBuffer;
use vtkio::model::{CellType, DataSet, Piece, PieceData, VertexNumbers, Vtk};

use super::{MeshFile, MeshFileProblem};

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
    let (bytes, _) = legacy_parts::readable(bytes)?;
    in_thread(|| mesh_of(Vtk::parse_legacy_be(&bytes[..]).map_err(problem)?.data))
}

/// Reads a .vtp or .vtu file.
pub(super) fn read_xml(bytes: &[u8]) -> Result<MeshFile, MeshFileProblem> {
    let bytes = xml_parts::points_and_faces(bytes)?;
    in_thread(|| mesh_of(Vtk::parse_xml(&bytes[..]).map_err(problem)?.data))
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
            for piece in pieces {
                let piece = inline(piece)?;
                let first = mesh.add_points(&piece.points)?;
                for line in piece.lines.iter().flat_map(cells) {
                    mesh.add_line(first, line?)?;
                }
                for face in piece.polys.iter().flat_map(cells) {
                    mesh.add_face(first, face?)?;
                }
                for strip in piece.strips.iter().flat_map(cells) {
                    mesh.add_strip(first, &strip?)?;
                }
            }
        }
        DataSet::UnstructuredGrid { pieces, .. } => {
            for piece in pieces {
                let piece = inline(piece)?;
                let first = mesh.add_points(&piece.points)?;
                let all = cells(&piece.cells.cell_verts);
                for (index, (kind, cell)) in piece.cells.types.iter().zip(all).enumerate() {
                    mesh.add_cell(first, *kind, cell?)
                        .map_err(|kind| problem(format!("cell {index} is a {kind:?}, not a polygon")))??;
                }
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
