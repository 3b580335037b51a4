//! The complex of grains that several cells make up.

use voronoi::{CellId, FaceId, PeriodicVertex, Tessellation, Translation};

use crate::mesh::disjoint_sets::DisjointSets;
use crate::network::coarsening::coarsened;
use crate::network::control_mesh::ControlMesh;
use crate::network::line_coarsening::coarsened_segments;
use crate::{GrainId, Mesh, NetworkError};

/// The grain that a cell is part of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct GrainPart {
    /// The grain.
    pub grain: GrainId,
    /// By how much the cell has to be moved to stand with the grain, in a periodic domain.
    pub moved: Translation,
}

impl From<GrainId> for GrainPart {
    /// A part that stands with its grain.
    fn from(grain: GrainId) -> Self {
        Self { grain, moved: Translation::ZERO }
    }
}

impl GrainPart {
    /// The grain beside a face, where it stands for the cell that is there.
    pub fn beside(parts: &[Self], side: voronoi::Side) -> voronoi::Side {
        let Some((cell, translation)) = side.cell() else { return side };
        let Self { grain, moved } = parts[cell.index()];
        voronoi::Side::Cell(CellId(grain.0)).moved(translation - moved)
    }
}

/// The complex of grains whose faces are the elements of a control mesh of their cells that lie between them, of which edges close that are shorter than the `lengths` of
/// all grains there.
///
/// # Errors
/// [`NetworkError::GrainInPieces`], [`NetworkError::MissingGrain`].
///
/// # Panics
/// When there is not one part for each cell.
pub(super) fn grain_complex(
    tessellation: &Tessellation,
    parts: &[GrainPart],
    lengths: &[f64],
    ControlMesh { level, points, .. }: &ControlMesh,
) -> Result<Tessellation, NetworkError> {
    check_grains(tessellation, parts)?;
    let corner_of = level.copies.originals(points.len());
    let mut is_copy = vec![false; level.element_count()];
    level.copies.elements.iter().for_each(|pair| is_copy[pair.secondary as usize] = true);
    let beside = |(element, is_copy): (usize, bool)| {
        let face = FaceId(level.boundary_of[element].0);
        let sides = tessellation.face_sides(face).map(|side| GrainPart::beside(parts, side));
        (!is_copy && sides[0] != sides[1]).then_some((element, sides))
    };
    let kept: Vec<(usize, [voronoi::Side; 2])> = is_copy.into_iter().enumerate().filter_map(beside).collect();
    // All elements of a boundary are wound alike.
    let sides: Vec<[voronoi::Side; 2]> = kept.iter().map(|(_, sides)| in_order(*sides)).collect();
    let is_turned = |place: usize| sides[place] != kept[place].1;
    let domain = tessellation.domain();
    // A complex has a seed for each grain; nothing asks this one for them.
    let seeds = vec![domain.center(); lengths.len()];
    Ok(match &level.mesh {
        Mesh::Triangles(mesh) => {
            let triangle = |(place, (element, _)): (usize, &(usize, _))| {
                let [a, b, c] = mesh.triangles()[*element].map(|corner| corner_of[corner as usize]);
                if is_turned(place) { [a, c, b] } else { [a, b, c] }
            };
            let triangles: Vec<[PeriodicVertex; 3]> = kept.iter().enumerate().map(triangle).collect();
            let limits =
                limits(lengths, triangles.iter().map(|corners| &corners[..]).zip(&sides), points.len());
            let left = coarsened(domain, points, &limits, &triangles, &sides);
            let faces = sides.into_iter().zip(left).filter_map(|(sides, corners)| Some((sides, corners?)));
            Tessellation::of_whole_cells(domain, &seeds, points, faces).0
        }
        Mesh::Segments(mesh) => {
            let segment = |(place, (element, _)): (usize, &(usize, _))| {
                let [a, b] = mesh.segments()[*element].map(|corner| corner_of[corner as usize]);
                if is_turned(place) { [b, a] } else { [a, b] }
            };
            let segments: Vec<[PeriodicVertex; 2]> = kept.iter().enumerate().map(segment).collect();
            let limits =
                limits(lengths, segments.iter().map(|corners| &corners[..]).zip(&sides), points.len());
            let left = coarsened_segments(domain, points, &limits, &segments, &sides);
            let faces = sides.into_iter().zip(left).filter_map(|(sides, corners)| Some((sides, corners?)));
            Tessellation::of_whole_cells(domain, &seeds, points, faces).0
        }
    })
}

/// Checks that grains are numbered from 0 without gaps, and that the cells of each hang together where they stand.
fn check_grains(tessellation: &Tessellation, parts: &[GrainPart]) -> Result<(), NetworkError> {
    assert_eq!(parts.len(), tessellation.cell_count(), "one grain for each cell");
    let mut pieces = DisjointSets::new(parts.len());
    for face in tessellation.faces() {
        let sides = tessellation.face_sides(face);
        let [own, other] = sides.map(|side| GrainPart::beside(parts, side));
        if let [Some((a, _)), Some((b, _))] = sides.map(voronoi::Side::cell)
            && own == other
        {
            pieces.join(a.0, b.0);
        }
    }
    let grain_count = parts.iter().map(|part| part.grain.index() + 1).max().unwrap_or(0);
    let mut piece_of = vec![None; grain_count];
    for (cell, part) in (0u32..).zip(parts) {
        if tessellation.cell_faces(CellId(cell)).is_empty() {
            continue;
        }
        let root = pieces.root(cell);
        if *piece_of[part.grain.index()].get_or_insert(root) != root {
            return Err(NetworkError::GrainInPieces { grain: part.grain });
        }
    }
    match (0u32..).zip(piece_of).find(|(_, piece)| piece.is_none()) {
        Some((grain, _)) => Err(NetworkError::MissingGrain { grain: GrainId(grain) }),
        None => Ok(()),
    }
}

/// Two sides, the one of smaller number first, and walls last. Of a grain and its image, the one of smaller translation.
fn in_order([first, second]: [voronoi::Side; 2]) -> [voronoi::Side; 2] {
    match (first.cell(), second.cell()) {
        (Some(own), Some(other)) if other < own => [second, first],
        _ => [first, second],
    }
}

/// Below what edges at each point are short: the least length of all grains there; nothing where an element has a point twice, a period apart, and between cells of one
/// grain.
pub(crate) fn limits<'a>(
    lengths: &[f64],
    elements: impl Iterator<Item = (&'a [PeriodicVertex], &'a [voronoi::Side; 2])>,
    point_count: usize,
) -> Vec<Option<f64>> {
    let mut limits = vec![Some(f64::INFINITY); point_count];
    for (corners, sides) in elements {
        let grains = sides.iter().filter_map(|side| side.cell());
        let least = grains.map(|(grain, _)| lengths[grain.index()]).fold(f64::INFINITY, f64::min);
        for corner in corners {
            let is_double = corners.iter().filter(|other| other.vertex == corner.vertex).count() > 1;
            let limit = &mut limits[corner.vertex as usize];
            *limit = limit.map(|limit| limit.min(least)).filter(|_| !is_double);
        }
    }
    limits.iter_mut().for_each(|limit| *limit = limit.filter(|limit| limit.is_finite()));
    limits
}
