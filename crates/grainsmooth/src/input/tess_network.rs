//! The network of the cells of a tessellation in Neper's format.

use glam::DVec3;
use voronoi::Dimension;

use crate::mesh::file::vtk::labelled::{LabelledCells, Notes};
use crate::mesh::file::{MeshFile, MeshFileProblem};
use crate::names::{CRYSTAL_SYMMETRIES, EULER_ANGLES, PERIODS, PHASE, PHASE_NAMES, SEED_ID};
use crate::vtk::{DataArray, FieldValue};
use crate::{Oriented, Tess, TessCopy, TessPeriodicity, TessProblem, read_tess};

/// The boundaries of all cells as they are, convex or not: of triangles between their corners, the middles of their edges and their own middles; in the plane of half edges.
/// Cells are numbered from 0.
///
/// # Errors
/// [`MeshFileProblem::Tess`] with the line that is wrong.
pub(super) fn read(bytes: &[u8]) -> Result<LabelledCells, MeshFileProblem> {
    let tess = read_tess(&String::from_utf8_lossy(bytes))
        .map_err(|TessProblem { line, what }| MeshFileProblem::Tess { line, what })?;
    let too_many = || MeshFileProblem::corrupt("tess", "it has more points than ids can name");
    let count = tess.vertices.len() + tess.edges.len() + tess.faces.len();
    let count = u32::try_from(count).map_err(|_| too_many())?;
    let numbers = Numbers::of(&tess);
    let is_plane = tess.dimension == Dimension::Two;
    let (faces, boundary_of) =
        if is_plane { half_edges(&tess, &numbers) } else { triangles(&tess, &numbers)? };
    let sides = labels_of_sides(&tess);
    let mesh = MeshFile { points: points(&tess), faces, ..MeshFile::default() };
    Ok(LabelledCells {
        mesh,
        is_plane,
        labels: boundary_of.into_iter().map(|boundary| sides[boundary]).collect(),
        label_array: "FaceLabels",
        originals: tess.periodicity.as_ref().map(|periodicity| originals(periodicity, &numbers, count)),
        notes: notes(&tess),
        ..LabelledCells::default()
    })
}

/// Where the numbers of points in the middles of edges and of faces begin; in the plane faces have no such points.
struct Numbers {
    edges: u32,
    faces: u32,
}

impl Numbers {
    fn of(tess: &Tess) -> Self {
        let id = |count: usize| u32::try_from(count).expect("the sum of all was checked");
        let edges = id(tess.vertices.len());
        Self { edges, faces: edges + id(tess.edges.len()) }
    }
}

fn points(tess: &Tess) -> Vec<DVec3> {
    let at = |vertex: &u32| tess.vertices[*vertex as usize];
    let middles = tess.edges.iter().map(|[from, to]| at(from).midpoint(at(to)));
    let of_faces = if tess.dimension == Dimension::Two { &[][..] } else { &tess.faces };
    let centers = of_faces
        .iter()
        .map(|face| face.vertices.iter().map(at).sum::<DVec3>() / face.vertices.len().max(1) as f64);
    tess.vertices.iter().copied().chain(middles).chain(centers).collect()
}

/// Elements, and the face (in the plane: edge) that each is part of.
type Elements = (Vec<Vec<u32>>, Vec<usize>);

/// Neper lists the edges of some faces from another corner on than their corners, or the other way round; so each is looked for by its ends.
fn triangles(tess: &Tess, numbers: &Numbers) -> Result<Elements, MeshFileProblem> {
    let (mut triangles, mut face_of) = (Vec::new(), Vec::new());
    for ((index, face), center) in tess.faces.iter().enumerate().zip(numbers.faces..) {
        for (from, to) in face.vertices.iter().zip(face.vertices.iter().cycle().skip(1)) {
            let ends = [*from.min(to), *from.max(to)];
            let joins = |edge: &&Oriented| {
                let [start, end] = tess.edges[edge.index as usize];
                [start.min(end), start.max(end)] == ends
            };
            let edge = face.edges.iter().find(joins).ok_or_else(|| {
                let what =
                    format!("no edge of face {} joins its vertices {} and {}", index + 1, from + 1, to + 1);
                MeshFileProblem::corrupt("tess", what)
            })?;
            let middle = numbers.edges + edge.index;
            triangles.extend([vec![center, *from, middle], vec![center, middle, *to]]);
            face_of.extend([index; 2]);
        }
    }
    Ok((triangles, face_of))
}

fn half_edges(tess: &Tess, numbers: &Numbers) -> Elements {
    let line = |([from, to], middle): (&[u32; 2], u32)| vec![*from, middle, *to];
    (tess.edges.iter().zip(numbers.edges..).map(line).collect(), (0..tess.edges.len()).collect())
}

/// The cells on both sides of each face (in the plane: edge), below 0 the exterior. What repeats has other numbers than the exterior, each face its own.
fn labels_of_sides(tess: &Tess) -> Vec<[i64; 2]> {
    let (count, copies) = match tess.dimension {
        Dimension::Two => (tess.edges.len(), tess.periodicity.as_ref().map(|copies| &copies.edges)),
        Dimension::Three => (tess.faces.len(), tess.periodicity.as_ref().map(|copies| &copies.faces)),
    };
    let mut sides = vec![[-1; 2]; count];
    let repeated = copies.into_iter().flatten().flat_map(|copy| [copy.secondary, copy.primary.index]);
    repeated.for_each(|boundary| sides[boundary as usize] = [-2 - i64::from(boundary); 2]);
    for (cell, side) in tess.sides_of_cells() {
        sides[side.index as usize][usize::from(side.is_reversed)] = cell.into();
    }
    sides
}

/// The point that each is a copy of, or itself.
fn originals(periodicity: &TessPeriodicity, numbers: &Numbers, count: u32) -> Vec<u32> {
    let mut originals: Vec<u32> = (0..count).collect();
    let mut put = |copies: &[TessCopy], first: u32| {
        for copy in copies {
            originals[(first + copy.secondary) as usize] = first + copy.primary.index;
        }
    };
    put(&periodicity.vertices, 0);
    put(&periodicity.edges, numbers.edges);
    put(&periodicity.faces, numbers.faces);
    originals
}

/// What the file says of its cells.
fn notes(tess: &Tess) -> Notes {
    let cell_count = match tess.dimension {
        Dimension::Two => tess.faces.len(),
        Dimension::Three => tess.polyhedra.len(),
    };
    let ids = if tess.ids.is_empty() { (0..).take(cell_count).collect() } else { tess.ids.clone() };
    let phase_count = tess.groups.iter().max();
    let mut notes = Notes::default();
    let ids_of = |name, ids: &[u32]| {
        FieldValue::Data(DataArray::int32(name, ids.iter().map(|id| id.cast_signed()).collect()))
    };
    notes.note(SEED_ID, ids_of(SEED_ID, &ids));
    if let Some(count) = phase_count {
        notes.note(PHASE, ids_of(PHASE, &tess.groups));
        let names: Vec<String> = (1..=*count).map(|number| number.to_string()).collect();
        notes.note(PHASE_NAMES, FieldValue::Text(names.join(",")));
    }
    if let Some(symmetry) = tess.crystal_symmetry {
        let of_phases = vec![symmetry.to_string(); phase_count.map_or(1, |count| *count as usize)];
        notes.note(CRYSTAL_SYMMETRIES, FieldValue::Text(of_phases.join(",")));
    }
    let mut note_numbers = |name, components, numbers| {
        notes.note(name, FieldValue::Data(DataArray::float64(name, components, numbers)));
    };
    if !tess.orientations.is_empty() {
        let angles = tess.orientations.iter().flat_map(|orientation| orientation.euler_degrees());
        note_numbers(EULER_ANGLES, 3, angles.collect());
    }
    if let Some(periodicity) = &tess.periodicity {
        let lengths = periodicity.lengths.to_array().into_iter().zip(periodicity.axes);
        let periods = lengths.map(|(length, repeats)| if repeats { length } else { 0.0 });
        note_numbers(PERIODS, 1, periods.collect());
    }
    notes
}
