//! Meshes and polylines from files and into files: OBJ, PLY, STL, OFF, VTK, and JSON as in the references of subdivision.

use std::path::Path;

use glam::DVec3;
use subzero::{
    BoundaryRule, Crease, CurveMesh, FaceId, Features, INFINITE_SHARPNESS, PolygonMesh, TriangleMesh,
};
use voronoi::Domain;

use crate::names::{BOUNDARY_ID, LABEL_ARRAYS};
use crate::vtk::{DataArray, FieldEntry};

use crate::error::Error;

pub(super) mod control_points;
mod json;
pub(super) mod json_point;
mod lines;
mod obj;
mod off;
mod ply;
pub(crate) mod stl;
pub(crate) mod vtk;
mod write;

pub use crate::error::mesh_file::MeshFileProblem;
pub use vtk::READER_THREAD;
pub use write::{MeshFormat, MeshToWrite, stage_mesh, write_mesh};

/// A mesh or polylines as a file holds them: points, faces, lines, and what a JSON file says about creases and corners.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct MeshFile {
    /// Coordinates of each point.
    pub points: Vec<DVec3>,
    /// The points of each face, by position in `points`.
    pub faces: Vec<Vec<u32>>,
    /// The points of each polyline, in order along it, by position in `points`; where it is closed, the first comes again at the end.
    pub lines: Vec<Vec<u32>>,
    /// Sharp edges.
    pub creases: Vec<Crease>,
    /// Points that stay where they are until their sharpness has run out.
    pub corners: Vec<(u32, f32)>,
    /// The rule for boundary vertices of a single face.
    pub boundary: BoundaryRule,
    /// Arrays with a tuple for each point.
    pub point_data: Vec<DataArray>,
    /// Arrays with a tuple for each face.
    pub face_data: Vec<DataArray>,
    /// Arrays with a tuple for each polyline.
    pub line_data: Vec<DataArray>,
    /// What a VTK file says about itself and all its grains.
    pub field: Vec<FieldEntry>,
    /// The names of arrays that could not be taken over from the file.
    pub left_behind: Vec<String>,
    /// For formats without shared points: the number of corners that were merged, by exactly equal coordinates.
    pub merged_corners: Option<usize>,
}

/// Reads a mesh; the extension names the format: .obj, .ply, .stl, .off, .vtk, .vtp, .vtu or .json.
///
/// Polygons are kept as they are, and polylines beside them. Single points, colours, texture and any other data are passed over.
///
/// # Errors
/// [`Error::MeshFile`] when the file cannot be read, is truncated or corrupt, has no faces, a face with less than three
/// corners or with points that do not exist, or a coordinate that is not finite or so large or small that its powers are not.
pub fn read_mesh(path: &Path) -> Result<MeshFile, Error> {
    let with_faces = |mesh: MeshFile| match (mesh.faces.len(), mesh.lines.len()) {
        (0, 0) => Err(MeshFileProblem::NoFaces),
        (0, _) => Err(MeshFileProblem::OnlyPolylines),
        _ => Ok(mesh),
    };
    read(path).and_then(with_faces).map_err(|problem| Error::MeshFile { path: path.to_owned(), problem })
}

/// Reads polylines; the extension names the format: .obj, .vtk, .vtp, .vtu, .json, or .txt with the points of a polyline on lines
/// `x y z` or `x y`, and blank lines between polylines.
///
/// # Errors
/// As of [`read_mesh`], for polylines with less than two points in place of faces.
pub fn read_polylines(path: &Path) -> Result<MeshFile, Error> {
    let with_lines =
        |mesh: MeshFile| if mesh.lines.is_empty() { Err(MeshFileProblem::NoPolylines) } else { Ok(mesh) };
    read(path).and_then(with_lines).map_err(|problem| Error::MeshFile { path: path.to_owned(), problem })
}

fn read(path: &Path) -> Result<MeshFile, MeshFileProblem> {
    let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
    let read_bytes = match extension.to_str() {
        Some("obj") => obj::read,
        Some("off") => off::read,
        Some("ply") => ply::read,
        Some("stl") => stl::read,
        Some("vtk") => vtk::read_legacy,
        Some("vtp" | "vtu") => vtk::read_xml,
        Some("json") => json::read,
        Some("txt") => control_points::read_polylines,
        _ => return Err(MeshFileProblem::UnknownExtension),
    };
    let bytes = std::fs::read(path).map_err(MeshFileProblem::Unreadable)?;
    let mesh = read_bytes(&bytes)?;
    mesh.check()?;
    Ok(mesh)
}

impl MeshFile {
    /// Checks what any mesh must have; how faces fit together is for the scheme to judge.
    ///
    /// # Errors
    /// A face with less than three corners or with points that do not exist; a coordinate that is not finite, or so large or small that its powers are
    /// not.
    pub fn check(&self) -> Result<(), MeshFileProblem> {
        subzero::check_finite(&self.points)?;
        check_lengths(&self.points)?;
        for (face, corners) in (0..).map(FaceId).zip(&self.faces) {
            if corners.len() < 3 {
                return Err(subzero::MeshError::TooFewCorners { face, corners: corners.len() }.into());
            }
            self.check_vertices("face", face.index(), corners)?;
        }
        for (index, line) in self.lines.iter().enumerate() {
            if line.len() < 2 {
                return Err(MeshFileProblem::ShortPolyline { line: index });
            }
            self.check_vertices("polyline", index, line)?;
        }
        Ok(())
    }

    fn check_vertices(
        &self,
        what: &'static str,
        index: usize,
        ids: &[u32],
    ) -> Result<(), subzero::MeshError> {
        let vertex_count = self.points.len();
        match ids.iter().find(|&&vertex| vertex as usize >= vertex_count) {
            Some(&vertex) => Err(subzero::MeshError::VertexOutOfRange { what, index, vertex, vertex_count }),
            None => Ok(()),
        }
    }

    /// The faces, if all are triangles.
    ///
    /// # Errors
    /// [`MeshFileProblem::NotATriangle`] names the first face with more corners.
    pub fn triangles(&self) -> Result<Vec<[u32; 3]>, MeshFileProblem> {
        let triangle = |(face, corners): (usize, &Vec<u32>)| {
            <[u32; 3]>::try_from(corners.as_slice())
                .map_err(|_| MeshFileProblem::NotATriangle { face, corners: corners.len() })
        };
        self.faces.iter().enumerate().map(triangle).collect()
    }

    /// Connectivity for the triangle schemes, with the creases and corners.
    ///
    /// # Errors
    /// [`MeshFileProblem::NotATriangle`], or [`MeshFileProblem::Mesh`] as of [`TriangleMesh::new`].
    pub fn triangle_mesh(&self) -> Result<TriangleMesh, MeshFileProblem> {
        let triangles = self.triangles()?;
        Ok(self.with_features(|features| TriangleMesh::new(self.points.len(), triangles, features))?)
    }

    /// Connectivity for the polygon schemes, with the creases and corners.
    ///
    /// # Errors
    /// [`MeshFileProblem::Mesh`] as of [`PolygonMesh::new`].
    pub fn polygon_mesh(&self) -> Result<PolygonMesh, MeshFileProblem> {
        Ok(self.with_features(|features| PolygonMesh::new(self.points.len(), &self.faces, features))?)
    }

    /// Connectivity of the polylines, with the corners.
    ///
    /// # Errors
    /// [`MeshFileProblem::SoftCornerOfPolyline`], or [`MeshFileProblem::Mesh`] as of [`CurveMesh::new`].
    pub fn curve_mesh(&self) -> Result<CurveMesh, MeshFileProblem> {
        let is_soft = |&&(_, sharpness): &&(u32, f32)| sharpness < INFINITE_SHARPNESS;
        if let Some(&(vertex, sharpness)) = self.corners.iter().find(is_soft) {
            return Err(MeshFileProblem::SoftCornerOfPolyline { vertex, sharpness });
        }
        let mut corners: Vec<u32> = self.corners.iter().map(|&(vertex, _)| vertex).collect();
        corners.extend(self.corners_of_labels());
        let segments = self.lines.iter().flat_map(|line| line.windows(2).map(|ends| [ends[0], ends[1]]));
        Ok(CurveMesh::new(self.points.len(), segments.collect(), &corners)?)
    }

    fn with_features<T>(&self, make: impl FnOnce(&Features<'_>) -> T) -> T {
        let (soft_corners, boundary) = (&self.corners[..], self.boundary);
        let creases = [&self.creases[..], &self.creases_of_labels()].concat();
        make(&Features { creases: &creases, corners: &[], soft_corners, boundary })
    }

    /// The points in which polylines with other labels meet: boundaries of grains end there.
    fn corners_of_labels(&self) -> Vec<u32> {
        let labels = labels_of(&self.line_data);
        let mut first_of = vec![None; self.points.len()];
        let mut corners = Vec::new();
        for (number, line) in self.lines.iter().enumerate() {
            for &vertex in line {
                let first = *first_of[vertex as usize].get_or_insert(number);
                if labels.iter().any(|array| !array.are_equal(first, number)) {
                    corners.push(vertex);
                }
            }
        }
        corners
    }

    /// The edges of two faces with other labels: boundaries of grains end there, and are sharp.
    fn creases_of_labels(&self) -> Vec<Crease> {
        let labels = labels_of(&self.face_data);
        if labels.is_empty() {
            return Vec::new();
        }
        let sides = |(face, corners): (usize, &Vec<u32>)| -> Vec<([u32; 2], usize)> {
            let next = corners.iter().cycle().skip(1);
            corners.iter().zip(next).map(|(&a, &b)| ([a.min(b), a.max(b)], face)).collect()
        };
        let mut sides: Vec<([u32; 2], usize)> = self.faces.iter().enumerate().flat_map(sides).collect();
        sides.sort_unstable();
        let pairs = sides.chunk_by(|a, b| a.0 == b.0).filter(|edge| edge.len() == 2);
        let differs =
            |edge: &&[([u32; 2], usize)]| labels.iter().any(|array| !array.are_equal(edge[0].1, edge[1].1));
        pairs.filter(differs).map(|edge| Crease::infinite(edge[0].0)).collect()
    }
}

/// The arrays that tell boundaries of grains apart, where there are any.
fn labels_of(arrays: &[DataArray]) -> Vec<&DataArray> {
    let is_label = |array: &&DataArray| LABEL_ARRAYS.contains(&array.name.as_str());
    if !arrays.iter().any(|array| is_label(&array)) {
        return Vec::new();
    }
    arrays.iter().filter(|array| is_label(array) || array.name == BOUNDARY_ID).collect()
}

/// Checks that areas and volumes, and what is divided by them, are numbers: [`Domain::LENGTHS`]. All points may be one.
pub(crate) fn check_lengths(points: &[DVec3]) -> Result<(), MeshFileProblem> {
    for (point, place) in points.iter().enumerate() {
        let mut coordinates = place.to_array().into_iter();
        let is_far = |coordinate: &f64| coordinate.is_finite() && coordinate.abs() > *Domain::LENGTHS.end();
        if let Some(coordinate) = coordinates.find(is_far) {
            return Err(MeshFileProblem::TooFar { point, coordinate });
        }
    }
    let lower = points.iter().copied().fold(DVec3::INFINITY, DVec3::min);
    let upper = points.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
    let width = (upper - lower).max_element();
    if width > 0.0 && width < *Domain::LENGTHS.start() {
        return Err(MeshFileProblem::TooSmall { width });
    }
    Ok(())
}
