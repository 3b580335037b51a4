//! Boundaries between grains, as DREAM.3D's surface meshing leaves them: a triangle geometry with two labels for each triangle.

use glam::DVec3;

use super::file::{Hdf5, base, damaged, parent};
use crate::error::map_file::MapProblem;
use crate::mesh::file::MeshFile;
use crate::mesh::file::vtk::labelled::LabelledCells;

/// Whether there is such a geometry.
pub(super) fn are_in(file: &Hdf5) -> bool {
    geometry(file).is_some()
}

/// Reads the triangles and what lies on both sides of each; nothing where there are none.
///
/// # Errors
/// [`MapProblem::Damaged`].
pub(super) fn read(file: &Hdf5) -> Result<Option<LabelledCells>, MapProblem> {
    let Some(Geometry { points, triangles, labels, node_types }) = geometry(file) else { return Ok(None) };
    let missing = |path: &str| damaged(format!("its array {path} holds no numbers"));
    let whole = |path: &str| file.labels(path)?.ok_or_else(|| missing(path));
    let coordinates = file.numbers(points)?.ok_or_else(|| missing(points))?;
    let points: Vec<DVec3> = coordinates.as_chunks().0.iter().copied().map(DVec3::from_array).collect();
    let corners = whole(triangles)?;
    let is_point = |corner: &i32| usize::try_from(*corner).is_ok_and(|corner| corner < points.len());
    if let Some(corner) = corners.iter().find(|corner| !is_point(corner)) {
        return Err(damaged(format!("its array {triangles} names point {corner} of {}", points.len())));
    }
    // 0 is no feature, as outside; between both lies no boundary of a grain.
    let label = |label: i32| if label < 1 { -1 } else { i64::from(label) };
    let sides = whole(labels)?;
    let sides = sides.as_chunks::<2>().0.iter().map(|sides| sides.map(label));
    let all = corners.as_chunks::<3>().0.iter().map(|corners| corners.map(i32::cast_unsigned)).zip(sides);
    let (triangles, labels): (Vec<[u32; 3]>, Vec<[i64; 2]>) =
        all.filter(|(_, sides)| *sides != [-1, -1]).unzip();
    let mut used: Vec<u32> = triangles.as_flattened().to_vec();
    used.sort_unstable();
    used.dedup();
    let number = |corner: &u32| {
        u32::try_from(used.partition_point(|point| point < corner)).expect("points have such numbers")
    };
    let faces = triangles.iter().map(|corners| corners.iter().map(number).collect()).collect();
    let codes = node_types.map(whole).transpose()?;
    let code_of = |codes: Vec<i32>| used.iter().map(|point| i64::from(codes[*point as usize])).collect();
    Ok(Some(LabelledCells {
        mesh: MeshFile {
            points: used.iter().map(|point| points[*point as usize]).collect(),
            faces,
            ..MeshFile::default()
        },
        labels,
        label_array: "FaceLabels",
        node_types: codes.map(code_of),
        is_single: true,
        ..LabelledCells::default()
    }))
}

/// Paths of the arrays of a geometry.
struct Geometry<'a> {
    points: &'a str,
    triangles: &'a str,
    labels: &'a str,
    node_types: Option<&'a str>,
}

/// The first geometry of labelled triangles. DREAM.3D 6 and DREAM3D-NX call its arrays by other names, with spaces or without.
fn geometry(file: &Hdf5) -> Option<Geometry<'_>> {
    let named = |name: &'static [&'static str], columns: usize| {
        file.paths().filter_map(move |path| {
            let plain = base(path).replace(' ', "");
            let rows = match file.shape(path)?[..] {
                [rows, found] if found == columns => rows,
                [rows] if columns == 1 => rows,
                _ => return None,
            };
            name.contains(&plain.as_str()).then_some((path, rows))
        })
    };
    named(&["SharedTriList", "SharedFacesList"], 3).find_map(|(triangles, triangle_count)| {
        let is_beside = |(path, _): &(&str, usize)| parent(path) == parent(triangles);
        let (points, point_count) = named(&["SharedVertexList"], 3).find(is_beside)?;
        let (labels, _) = named(&["FaceLabels"], 2).find(|(_, rows)| *rows == triangle_count)?;
        let node_types = named(&["NodeType", "NodeTypes"], 1).find(|(_, rows)| *rows == point_count);
        Some(Geometry { points, triangles, labels, node_types: node_types.map(|(path, _)| path) })
    })
}
