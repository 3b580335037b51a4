//! Grains of a tessellation in Neper's format.

use std::collections::BTreeSet;
use std::path::Path;

use glam::{BVec3, DVec3};
use polycrystal::{BoundaryId, Elements, GrainId, Side, Surface};
use voronoi::Dimension;

use super::{MeasuredSample, grains_of};
use crate::files::{TEXT_FILE, read_input};
use crate::{Error, Tess, TessProblem, read_tess};

pub(super) fn read(path: &Path) -> Result<MeasuredSample, Error> {
    let bytes = read_input(path, TEXT_FILE)?;
    let tess = read_tess(&String::from_utf8_lossy(&bytes)).map_err(|TessProblem { line, what }| {
        Error::BadLine { path: path.to_owned(), line, problem: what }
    })?;
    let sample = of_tess(&tess).map_err(|problem| Error::MeshFile { path: path.to_owned(), problem })?;
    if sample.grains.is_empty() {
        let problem = "holds no cells; give a file with one or more".to_owned();
        return Err(Error::BadLine { path: path.to_owned(), line: 1, problem });
    }
    Ok(sample)
}

fn of_tess(tess: &Tess) -> Result<MeasuredSample, crate::mesh::file::MeshFileProblem> {
    let ids = |count: usize| 0..u32::try_from(count).unwrap_or(u32::MAX);
    let boundary_count = match tess.dimension {
        Dimension::Two => tess.edges.len(),
        Dimension::Three => tess.faces.len(),
    };
    // Each boundary has at first nothing on either side. One that a single cell has is the exterior's too.
    let mut sides = vec![[Side::Exterior; 2]; boundary_count];
    for (cell, side) in tess.sides_of_cells() {
        sides[side.index as usize][usize::from(side.is_reversed)] = Side::Grain(GrainId(cell));
    }
    let walls: BTreeSet<u32> = tess.domain.walls.iter().flatten().copied().collect();
    let is_periodic = tess.periodicity.is_some();
    // Neper's periodic files list what sticks out of the box nowhere.
    let is_wall = |boundary: usize| {
        !is_periodic || u32::try_from(boundary).is_ok_and(|boundary| walls.contains(&boundary))
    };
    let mut boundary_of = Vec::new();
    let grains = match tess.dimension {
        Dimension::Two => {
            boundary_of.extend(ids(boundary_count).map(BoundaryId));
            let elements = Elements::Segments(&tess.edges);
            grains_of(&surface(tess, elements, &boundary_of, &sides), is_wall)
        }
        Dimension::Three => {
            let mut triangles = Vec::new();
            for (face, polygon) in ids(boundary_count).map(BoundaryId).zip(&tess.faces) {
                let corners = &polygon.vertices;
                triangles.extend((2..corners.len()).map(|k| [corners[0], corners[k - 1], corners[k]]));
                boundary_of.resize(triangles.len(), face);
            }
            let elements = Elements::Triangles(&triangles);
            grains_of(&surface(tess, elements, &boundary_of, &sides), is_wall)
        }
    };
    let mut grains = grains?;
    for grain in &mut grains {
        let cell = grain.id as usize;
        grain.orientation = tess.orientations.get(cell).copied();
        grain.phase = tess.groups.get(cell).copied();
        grain.id = tess.ids.get(cell).copied().unwrap_or(grain.id);
    }
    let periodic = tess.periodicity.as_ref();
    let in_plane = |size: DVec3| if tess.dimension == Dimension::Two { size.with_z(1.0) } else { size };
    let mut sample = MeasuredSample {
        dimension: tess.dimension,
        grains,
        box_size: periodic.map(|periodic| in_plane(periodic.lengths)),
        periodic: periodic.map_or(BVec3::FALSE, |periodic| periodic.axes.into()),
        symmetry: tess.crystal_symmetry,
    };
    sample.keep_box_if_filled(&tess.vertices);
    Ok(sample)
}

fn surface<'a>(
    tess: &'a Tess,
    elements: Elements<'a>,
    boundary_of: &'a [BoundaryId],
    sides: &'a [[Side; 2]],
) -> Surface<'a> {
    Surface { points: &tess.vertices, elements, boundary_of, sides }
}
