//! Meshes into files.

use std::io::{self, Write};
use std::path::Path;

use glam::DVec3;

use super::stl;
use crate::error::Error;
use crate::files::output::OutputPath;
use crate::files::staged_files::{StagedFiles, write_together};
use crate::vtk::{
    Array, Cells, DataArray, FieldEntry, FieldValue, PolyData, Values, VtkEncoding, VtkFormat, write_vtk,
};

/// A file format that meshes are written in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MeshFormat {
    /// One of VTK's.
    Vtk(VtkFormat),
    /// Wavefront OBJ.
    Obj,
    /// Binary PLY.
    Ply,
    /// Binary STL: single precision, and polygons cut into triangles.
    Stl,
    /// JSON with the keys of the reference files of subdivision.
    Json,
}

impl MeshFormat {
    /// The format that the path's extension names, in upper or lower case.
    pub fn of_path(path: &Path) -> Option<Self> {
        match path.extension()?.to_ascii_lowercase().to_str()? {
            "obj" => Some(Self::Obj),
            "ply" => Some(Self::Ply),
            "stl" => Some(Self::Stl),
            "json" => Some(Self::Json),
            extension => {
                VtkFormat::ALL.into_iter().find(|format| format.extension() == extension).map(Self::Vtk)
            }
        }
    }
}

/// A mesh and what is known about it: the content of a file.
#[derive(Clone, Copy)]
pub struct MeshToWrite<'a> {
    /// Coordinates of each point.
    pub points: &'a [DVec3],
    /// Faces or polylines, by position in `points`.
    pub cells: Cells<'a>,
    /// A unit vector for each point; zero where there is none. STL does not hold them.
    pub normals: Option<&'a [DVec3]>,
    /// For each point the level at which it was born. Only VTK files hold it.
    pub generations: Option<&'a [i8]>,
    /// Arrays of points. Only VTK files hold them.
    pub point_data: &'a [DataArray],
    /// Arrays of cells. Only VTK files hold them.
    pub cell_data: &'a [DataArray],
    /// What is said about the file as a whole, beside the program and the command line. Only VTK files hold it.
    pub field: &'a [FieldEntry],
    /// The command line that made the mesh. Only VTK files hold it.
    pub command_line: &'a str,
    /// How XML files of VTK hold their numbers.
    pub encoding: VtkEncoding,
}

impl<'a> MeshToWrite<'a> {
    /// Points and cells alone, in the usual encoding.
    pub fn new(points: &'a [DVec3], cells: Cells<'a>, command_line: &'a str) -> Self {
        Self {
            points,
            cells,
            normals: None,
            generations: None,
            point_data: &[],
            cell_data: &[],
            field: &[],
            command_line,
            encoding: VtkEncoding::default(),
        }
    }
}

/// Writes a mesh in any format but JSON.
///
/// # Errors
/// [`Error::WriteOutput`]; nothing is left behind then. Polylines have no place in PLY and STL.
pub fn write_mesh(mesh: &MeshToWrite<'_>, output: &OutputPath<MeshFormat>) -> Result<(), Error> {
    write_together(|files| stage_mesh(mesh, output, files))
}

/// As [`write_mesh`], as one of several files that appear together.
///
/// # Errors
/// As of [`write_mesh`]; [`Error::OutputTwice`].
pub fn stage_mesh(
    mesh: &MeshToWrite<'_>,
    output: &OutputPath<MeshFormat>,
    files: &mut StagedFiles,
) -> Result<(), Error> {
    output.stage(files, |out| match output.format() {
        MeshFormat::Vtk(format) => write_vtk(&poly_data(mesh), format, mesh.encoding, out),
        MeshFormat::Obj => write_obj(mesh, out),
        MeshFormat::Ply => write_ply(mesh, out),
        MeshFormat::Stl => write_stl(mesh, out),
        MeshFormat::Json => Err(io::Error::other("JSON is written level by level")),
    })
}

fn poly_data<'a>(mesh: &MeshToWrite<'a>) -> PolyData<'a> {
    let normals = mesh.normals.map(|normals| Array { name: "Normals", values: Values::slice(normals) });
    let generations = mesh.generations.map(|g| Array { name: "Generation", values: Values::slice(g) });
    let text = |name, value: String| FieldEntry { name, value: FieldValue::Text(value) };
    PolyData {
        points: mesh.points,
        cells: mesh.cells,
        point_arrays: normals
            .into_iter()
            .chain(generations)
            .chain(mesh.point_data.iter().map(DataArray::array))
            .collect(),
        cell_arrays: mesh.cell_data.iter().map(DataArray::array).collect(),
        field: [
            text("Version", format!("grainsmooth {}", env!("CARGO_PKG_VERSION"))),
            text("CommandLine", mesh.command_line.to_owned()),
        ]
        .into_iter()
        .chain(mesh.field.iter().cloned())
        .collect(),
    }
}

/// Calls `visit` with the points of each cell.
fn for_each_cell(cells: Cells<'_>, mut visit: impl FnMut(&[u32]) -> io::Result<()>) -> io::Result<()> {
    match cells {
        Cells::Triangles(triangles) => triangles.iter().try_for_each(|cell| visit(cell)),
        Cells::TrianglesOf { count, triangle } => (0..count).try_for_each(|cell| visit(&triangle(cell))),
        Cells::Polygons(cells) | Cells::Polylines(cells) => cells.iter().try_for_each(|cell| visit(cell)),
        Cells::Elements(kind, points) => points.chunks(kind.point_count()).try_for_each(visit),
        Cells::Vertices(_) => Ok(()),
    }
}

/// Coordinates in the fewest digits that give the same number back.
fn write_obj(mesh: &MeshToWrite<'_>, out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "# grainsmooth {}", env!("CARGO_PKG_VERSION"))?;
    for DVec3 { x, y, z } in mesh.points {
        writeln!(out, "v {x:?} {y:?} {z:?}")?;
    }
    for DVec3 { x, y, z } in mesh.normals.into_iter().flatten() {
        writeln!(out, "vn {x:?} {y:?} {z:?}")?;
    }
    let keyword = if matches!(mesh.cells, Cells::Polylines(_)) { "l" } else { "f" };
    for_each_cell(mesh.cells, |cell| {
        write!(out, "{keyword}")?;
        for id in cell.iter().map(|&id| u64::from(id) + 1) {
            match mesh.normals {
                Some(_) if keyword == "f" => write!(out, " {id}//{id}")?,
                _ => write!(out, " {id}")?,
            }
        }
        writeln!(out)
    })
}

fn write_ply(mesh: &MeshToWrite<'_>, out: &mut dyn Write) -> io::Result<()> {
    refuse_polylines(mesh.cells, "PLY")?;
    writeln!(out, "ply\nformat binary_little_endian 1.0\ncomment grainsmooth {}", env!("CARGO_PKG_VERSION"))?;
    writeln!(out, "element vertex {}", mesh.points.len())?;
    let axes: &[&str] =
        if mesh.normals.is_some() { &["x", "y", "z", "nx", "ny", "nz"] } else { &["x", "y", "z"] };
    for axis in axes {
        writeln!(out, "property double {axis}")?;
    }
    // Many readers know no longer list than that of one byte; it is enough for most.
    let mut largest = 0;
    for_each_cell(mesh.cells, |cell| {
        largest = largest.max(cell.len());
        Ok(())
    })?;
    let count_type = if largest <= usize::from(u8::MAX) { "uchar" } else { "uint" };
    writeln!(
        out,
        "element face {}\nproperty list {count_type} uint vertex_indices\nend_header",
        mesh.cells.len()
    )?;
    for (index, point) in mesh.points.iter().enumerate() {
        let normal = mesh.normals.map(|normals| normals[index]);
        for vector in [Some(*point), normal].into_iter().flatten() {
            for coordinate in vector.to_array() {
                out.write_all(&coordinate.to_le_bytes())?;
            }
        }
    }
    for_each_cell(mesh.cells, |cell| {
        let count = u32::try_from(cell.len()).map_err(io::Error::other)?.to_le_bytes();
        out.write_all(if count_type == "uchar" { &count[..1] } else { &count })?;
        cell.iter().try_for_each(|id| out.write_all(&id.to_le_bytes()))
    })
}

fn write_stl(mesh: &MeshToWrite<'_>, out: &mut dyn Write) -> io::Result<()> {
    refuse_polylines(mesh.cells, "STL")?;
    let triangles: Vec<[u32; 3]> = match mesh.cells {
        Cells::Triangles(triangles) => triangles.to_vec(),
        Cells::TrianglesOf { count, triangle } => (0..count).map(triangle).collect(),
        Cells::Polygons(polygons) => subzero::triangulate(mesh.points, polygons).map_err(io::Error::other)?.0,
        Cells::Polylines(_) | Cells::Vertices(_) | Cells::Elements(..) => Vec::new(),
    };
    let triangles = triangles.iter().map(|corners| corners.map(|id| mesh.points[id as usize]));
    stl::check_range(triangles.clone().flatten())?;
    stl::write_binary(concat!("grainsmooth ", env!("CARGO_PKG_VERSION")), triangles, out)
}

fn refuse_polylines(cells: Cells<'_>, format: &str) -> io::Result<()> {
    match cells {
        Cells::Polylines(_) => {
            let message = format!("{format} holds no curves; write .vtp, .obj or .json instead");
            Err(io::Error::new(io::ErrorKind::InvalidInput, message))
        }
        _ => Ok(()),
    }
}
