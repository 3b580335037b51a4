//! Geomview's OFF, a format of a few lines.

use super::lines::{Words, short};
use super::{MeshFile, MeshFileProblem};

/// Reads the text format; colours, normals and texture coordinates are passed over.
pub(super) fn read(bytes: &[u8]) -> Result<MeshFile, MeshFileProblem> {
    let text = String::from_utf8_lossy(bytes);
    let mut last = 0;
    let mut lines = text.lines().enumerate().filter_map(|(index, line)| {
        let words = line.split('#').next().unwrap_or_default().split_whitespace();
        last = index;
        words.clone().next().map(|_| Words { index, words })
    });
    let ends = |before: String| MeshFileProblem::corrupt("OFF", format!("the file ends before {before}"));
    let mut header = lines.next().ok_or_else(|| ends("its first line".to_owned()))?;
    let kind = header.words.next().unwrap_or_default();
    if !matches!(kind, "OFF" | "COFF" | "NOFF" | "CNOFF" | "STOFF") {
        return Err(header.problem(format!("'{}' where a text file begins with OFF", short(kind))));
    }
    // The counts may stand on the first line.
    if header.words.clone().next().is_none() {
        header = lines.next().ok_or_else(|| ends("the numbers of vertices and faces".to_owned()))?;
    }
    let vertex_count: usize = header.number("the number of vertices")?;
    let face_count: usize = header.number("the number of faces")?;
    let mut mesh = MeshFile::default();
    for vertex in 0..vertex_count {
        let mut line = lines.next().ok_or_else(|| ends(format!("vertex {vertex} of {vertex_count}")))?;
        mesh.points.push(line.point()?);
    }
    for face in 0..face_count {
        let mut line = lines.next().ok_or_else(|| ends(format!("face {face} of {face_count}")))?;
        let corner_count: usize = line.number("the number of corners of a face")?;
        let mut corners = Vec::new();
        for _ in 0..corner_count {
            let vertex: u32 = line.number("a vertex of a face")?;
            if vertex as usize >= vertex_count {
                let what = format!(
                    "face {face} refers to vertex {vertex}, but the file has {vertex_count} vertices"
                );
                return Err(line.problem(what));
            }
            corners.push(vertex);
        }
        mesh.faces.push(corners);
    }
    Ok(mesh)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn header_in_either_way_and_colours() {
        for text in [
            "OFF\n# comment\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n",
            "COFF 4 2 0\n0 0 0 9 9 9 9\n1 0 0\n\n1 1 0\n0 1 0\n3 0 1 2 255 0 0\n3 0 2 3",
        ] {
            let mesh = read(text.as_bytes()).unwrap();
            assert_eq!((mesh.points.len(), &mesh.faces[..]), (4, &[vec![0, 1, 2], vec![0, 2, 3]][..]));
        }
    }

    #[test]
    fn messages_name_the_place() {
        for (text, message) in [
            ("", "the file ends before its first line; give a complete OFF file"),
            ("ply\n", "line 1: 'ply' where a text file begins with OFF"),
            ("OFF\n3 x", "line 2: 'x' is not the number of faces"),
            ("OFF\n2 1 0\n0 0 0\n", "the file ends before vertex 1 of 2; give a complete OFF file"),
            ("OFF\n1 1 0\n0 0 0\n3 0 1 0", "line 4: face 0 refers to vertex 1, but the file has 1 vertices"),
            ("OFF\n1 1 0\n0 0 0\n3 0 0", "line 4: ends before a vertex of a face"),
        ] {
            assert_eq!(read(text.as_bytes()).unwrap_err().to_string(), message);
        }
    }
}
