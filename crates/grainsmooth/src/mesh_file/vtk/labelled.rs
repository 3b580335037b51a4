//! VTK files of labelled networks: cells with two sides each.

use vtkio::IOBuffer;
use vtkio::model::{Attribute, CellType, DataSet, Vtk};

use super::{MeshFile, MeshFileProblem, cells, field, in_thread, inline, problem, xml_parts};

/// Cell arrays that hold the two sides, in the order in which they are looked for: DREAM.3D's and this program's, then
/// pyvista's and VTK's.
pub(crate) const LABEL_ARRAYS: [&str; 3] = ["FaceLabels", "boundary_labels", "BoundaryLabels"];

const NODE_TYPES: &str = "NodeTypes";

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
    /// Types of points, if there are any.
    pub(crate) node_types: Option<Vec<i64>>,
}

/// Reads a legacy file.
pub(crate) fn read_legacy(bytes: &[u8]) -> Result<LabelledCells, MeshFileProblem> {
    let bytes = field::without_field_data(bytes);
    in_thread(|| of_data(Vtk::parse_legacy_be(&bytes[..]).map_err(problem)?.data))
}

/// Reads a .vtp or .vtu file.
pub(crate) fn read_xml(bytes: &[u8]) -> Result<LabelledCells, MeshFileProblem> {
    let wanted: Vec<&str> = LABEL_ARRAYS.into_iter().chain([NODE_TYPES]).collect();
    let bytes = xml_parts::network(bytes, &wanted);
    in_thread(|| of_data(Vtk::parse_xml(&bytes[..]).map_err(problem)?.data))
}

fn of_data(data: DataSet) -> Result<LabelledCells, MeshFileProblem> {
    let mut found = LabelledCells::default();
    let (attributes, skipped) = match data {
        DataSet::PolyData { pieces, .. } => {
            let [piece] = <[_; 1]>::try_from(pieces).map_err(|_| problem("it is in several pieces"))?;
            let piece = inline(piece)?;
            found.mesh.add_points(&piece.points)?;
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
                    return Err(problem(format!("cell {index} is a {kind:?} in a surface")));
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
    if labels.len() != 2 * (skipped + count) {
        let (have, cells) = (labels.len(), skipped + count);
        return Err(problem(format!("{name} has {have} numbers where {cells} cells need two each")));
    }
    found.labels = labels.as_chunks().0[skipped..].to_vec();
    found.label_array = name;
    if let Some(types) = array(&attributes.point, NODE_TYPES).and_then(whole_numbers) {
        if types.len() != found.mesh.points.len() {
            return Err(problem(format!(
                "{NODE_TYPES} has {} numbers for {} points",
                types.len(),
                found.mesh.points.len()
            )));
        }
        found.node_types = Some(types);
    }
    Ok(found)
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
    buffer.cast_into()
}
