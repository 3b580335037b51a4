//! STL: read as text and binary through `stl_io`, written as binary.

use std::collections::HashMap;
use std::io::{self, Cursor, Write};
use std::path::Path;

use glam::{DVec3, Vec3};

use super::{MeshFile, MeshFileProblem};
use crate::mesh::normal::unit_normal;

/// Bytes of a binary file before its triangles, and of each triangle.
const HEADER_BYTES: usize = 84;
const TRIANGLE_BYTES: usize = 50;

/// Bytes of the title of a binary file.
pub(crate) const TITLE_BYTES: usize = 80;

/// Writes triangles as a binary file. The title must not begin with `solid`, which would make the file text to many readers.
pub(crate) fn write_binary(
    title: &str,
    triangles: impl ExactSizeIterator<Item = [DVec3; 3]>,
    out: &mut dyn Write,
) -> io::Result<()> {
    let count = u32::try_from(triangles.len())
        .map_err(|_| io::Error::other("more triangles than STL can count; write .vtp instead"))?;
    let mut header = title.as_bytes().to_vec();
    header.resize(TITLE_BYTES, b' ');
    out.write_all(&header)?;
    out.write_all(&count.to_le_bytes())?;
    let mut record = [0; TRIANGLE_BYTES];
    for corners in triangles {
        let [a, b, c] = corners;
        let vectors = [unit_normal(corners), a, b, c];
        for (place, number) in
            record.as_chunks_mut::<4>().0.iter_mut().zip(vectors.map(single).iter().flatten())
        {
            *place = number.to_le_bytes();
        }
        out.write_all(&record)?;
    }
    Ok(())
}

/// Coordinates in single precision.
fn single(vector: DVec3) -> [f32; 3] {
    vector.as_vec3().to_array()
}

/// Checks that points have coordinates in single precision.
pub(crate) fn check_range(mut points: impl Iterator<Item = DVec3>) -> io::Result<()> {
    match points.find(|point| !point.as_vec3().is_finite()) {
        Some(point) => Err(io::Error::other(format!(
            "{point} is too far out for STL's single precision; write .vtp instead"
        ))),
        None => Ok(()),
    }
}

/// Reads triangles and merges corners whose coordinates are exactly equal, in the order in which they first occur.
pub(crate) fn read(bytes: &[u8]) -> Result<MeshFile, MeshFileProblem> {
    let mut file = Cursor::new(for_stl_io(bytes));
    let problem = |error| MeshFileProblem::corrupt("STL", error);
    let mut mesh = MeshFile::default();
    let mut points_seen = HashMap::new();
    let triangles = stl_io::create_stl_reader(&mut file).map_err(problem)?;
    for (index, triangle) in triangles.enumerate() {
        let triangle = triangle.map_err(|error| problem(error).at_triangle(index))?;
        let mut face = Vec::with_capacity(3);
        for vertex in triangle.vertices {
            // Adding 0 makes one zero of two.
            let point = Vec3::from_array(vertex.0) + Vec3::ZERO;
            let next = mesh.points.len();
            let id = *points_seen.entry(point.to_array().map(f32::to_bits)).or_insert(next);
            if id == next {
                mesh.points.push(DVec3::from(point));
            }
            face.push(u32::try_from(id).map_err(|_| {
                let count = mesh.points.len();
                subzero::MeshError::TooLarge { what: "vertices", count }
            })?);
        }
        mesh.faces.push(face);
    }
    mesh.merged_corners = Some(3 * mesh.faces.len());
    Ok(mesh)
}

/// The file as `stl_io` wants it: it takes any file for text that begins with `solid `, binary ones too, and no other.
fn for_stl_io(bytes: &[u8]) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    if is_binary(&bytes) {
        bytes[0] = 0;
    } else if let Some(line_end) = bytes.iter().position(|&byte| byte == b'\n')
        && bytes.starts_with(b"solid")
    {
        bytes.splice(5..line_end, *b" ");
    }
    bytes
}

/// Whether the file is as long as its number of triangles says.
fn is_binary(bytes: &[u8]) -> bool {
    let count = bytes.get(80..HEADER_BYTES).and_then(|count| <[u8; 4]>::try_from(count).ok());
    count.is_some_and(|count| {
        bytes.len() as u64
            == HEADER_BYTES as u64 + TRIANGLE_BYTES as u64 * u64::from(u32::from_le_bytes(count))
    })
}

impl MeshFileProblem {
    /// Of one file of several.
    pub(crate) fn in_file(self, path: &Path) -> Self {
        match self {
            Self::Corrupt { format, what } => {
                let name = path.file_name().unwrap_or_default().to_string_lossy();
                Self::Corrupt { format, what: format!("{name}: {what}") }
            }
            other => other,
        }
    }

    fn at_triangle(self, triangle: usize) -> Self {
        match self {
            Self::Corrupt { format, what } => {
                Self::Corrupt { format, what: format!("triangle {triangle}: {what}") }
            }
            other => other,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FACET: &str =
        "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 -0\nendloop\nendfacet\n";

    #[test]
    fn text_with_and_without_a_name() {
        for head in ["solid", "solid a name", "solid "] {
            let mesh = read(format!("{head}\n{FACET}{FACET}endsolid\n").as_bytes()).unwrap();
            assert_eq!(mesh.faces, [vec![0, 1, 2], vec![0, 1, 2]]);
            assert_eq!((mesh.points.len(), mesh.merged_corners), (3, Some(6)));
        }
    }

    #[test]
    fn binary_that_begins_like_text() {
        let mut bytes = b"solid binary".to_vec();
        bytes.resize(80, b' ');
        bytes.extend(1_u32.to_le_bytes());
        for number in [0., 0., 1., 0., 0., 0., 1., 0., 0., 0., 1., 0.5_f32] {
            bytes.extend(number.to_le_bytes());
        }
        bytes.extend([0, 0]);
        let mesh = read(&bytes).unwrap();
        assert_eq!(mesh.points[2], DVec3::new(0.0, 1.0, 0.5));
        let error = read(&bytes[..120]).unwrap_err().to_string();
        assert!(error.ends_with("; give a complete STL file"), "{error}");
    }
}
