//! A .vtp file read back.

use std::path::Path;

use glam::DVec3;
use grainsmooth::vtk::inlined;
use vtkio::model::{Attribute, DataSet, Piece, PolyDataPiece, VertexNumbers, Vtk};

/// What a .vtp file holds, but for its field data.
#[derive(Debug, PartialEq)]
pub struct SurfaceFile {
    pub points: Vec<DVec3>,
    pub node_types: Vec<i32>,
    pub generations: Vec<i32>,
    /// Triangles or polylines.
    pub cells: Vec<Vec<usize>>,
    pub face_labels: Vec<[i32; 2]>,
    pub boundary_ids: Vec<i32>,
}

impl SurfaceFile {
    pub fn read(path: &Path) -> Self {
        let file = inlined(&std::fs::read(path).unwrap());
        let DataSet::PolyData { pieces, .. } = Vtk::parse_xml(&file[..]).unwrap().data else {
            panic!("no PolyData")
        };
        let Some(Piece::Inline(piece)) = pieces.into_iter().next() else { panic!("no piece in the file") };
        let PolyDataPiece { points, polys, lines, data, .. } = *piece;
        let points: Vec<f64> = points.into_vec().unwrap();
        let labels = values(&data.cell, "FaceLabels");
        Self {
            points: points.as_chunks().0.iter().copied().map(DVec3::from_array).collect(),
            node_types: values(&data.point, "NodeTypes"),
            generations: values(&data.point, "Generation"),
            cells: split(polys.or(lines).unwrap()),
            face_labels: labels.as_chunks().0.to_vec(),
            boundary_ids: values(&data.cell, "BoundaryId"),
        }
    }

    pub fn grain_count(&self) -> usize {
        usize::try_from(self.face_labels.iter().flatten().max().unwrap() + 1).unwrap()
    }

    pub fn boundary_count(&self) -> usize {
        usize::try_from(self.boundary_ids.iter().max().unwrap() + 1).unwrap()
    }

    /// The points of all cells of a boundary.
    pub fn corners_of(&self, boundary: usize) -> Vec<[DVec3; 3]> {
        let of_boundary = |id: &i32| usize::try_from(*id) == Ok(boundary);
        let cells = self.cells.iter().zip(&self.boundary_ids).filter(|(_, id)| of_boundary(id));
        cells.map(|(cell, _)| [0, 1, 2].map(|corner| self.points[cell[corner]])).collect()
    }
}

/// An array of integers of a .vtp file that not every file has.
pub fn integers(path: &Path, name: &str) -> Vec<i32> {
    let file = inlined(&std::fs::read(path).unwrap());
    let DataSet::PolyData { pieces, .. } = Vtk::parse_xml(&file[..]).unwrap().data else {
        panic!("no PolyData")
    };
    let Some(Piece::Inline(piece)) = pieces.into_iter().next() else { panic!("no piece in the file") };
    let PolyDataPiece { data, .. } = *piece;
    values(&[data.cell, data.point].concat(), name)
}

fn values(attributes: &[Attribute], name: &str) -> Vec<i32> {
    let array = attributes.iter().find_map(|attribute| match attribute {
        Attribute::DataArray(array) if array.name == name => Some(array),
        _ => None,
    });
    array.unwrap().data.cast_into().unwrap()
}

fn split(vertices: VertexNumbers) -> Vec<Vec<usize>> {
    let (connectivity, ends) = vertices.into_xml();
    let connectivity: Vec<usize> = connectivity.into_iter().map(|id| usize::try_from(id).unwrap()).collect();
    let ends: Vec<usize> = ends.into_iter().map(|end| usize::try_from(end).unwrap()).collect();
    let starts = std::iter::once(0).chain(ends.iter().copied());
    starts.zip(&ends).map(|(start, end)| connectivity[start..*end].to_vec()).collect()
}
