//! Triangles for squares that are no longer flat.

use std::ops::Deref;

use glam::DVec3;
use rayon::prelude::*;

use crate::mesh::grouped::Grouped;
use crate::mesh::id::id;
use crate::voxels::staircase::{Faces, Staircase};
use crate::{BoundaryId, Elements};

/// Triangles or segments, and the kind of each.
pub(super) struct CutFaces {
    pub(super) elements: ElementList,
    pub(super) kind_of: Vec<BoundaryId>,
}

pub(super) enum ElementList {
    Triangles(Vec<[u32; 3]>),
    Segments(Vec<[u32; 2]>),
}

impl CutFaces {
    pub(super) fn elements(&self) -> Elements<'_> {
        match &self.elements {
            ElementList::Triangles(triangles) => Elements::Triangles(triangles),
            ElementList::Segments(segments) => Elements::Segments(segments),
        }
    }

    /// Cuts each square along its shorter diagonal, unless that would fold it and the other one does not.
    pub(super) fn new(staircase: &Staircase, points: &[DVec3]) -> Self {
        match &staircase.faces {
            Faces::Squares(squares) => {
                let halves = |square: &[u32; 4]| cut(*square, points);
                let twice = |kind: &u32| [BoundaryId(*kind); 2];
                Self {
                    elements: ElementList::Triangles(squares.par_iter().flat_map_iter(halves).collect()),
                    kind_of: staircase.kind_of.par_iter().flat_map_iter(twice).collect(),
                }
            }
            Faces::Segments(segments) => Self {
                elements: ElementList::Segments(segments.clone()),
                kind_of: staircase.kind_of.iter().map(|kind| BoundaryId(*kind)).collect(),
            },
        }
    }
}

fn cut([a, b, c, d]: [u32; 4], points: &[DVec3]) -> [[u32; 3]; 2] {
    let at = |corner: u32| points[corner as usize];
    let normal = |[a, b, c]: [u32; 3]| (at(b) - at(a)).cross(at(c) - at(a));
    let along_first = [[a, b, c], [a, c, d]];
    let along_second = [[a, b, d], [b, c, d]];
    let is_flat = |[one, other]: [[u32; 3]; 2]| normal(one).dot(normal(other)) > 0.0;
    let is_first_shorter = at(a).distance_squared(at(c)) <= at(b).distance_squared(at(d));
    match (is_flat(along_first), is_flat(along_second)) {
        (true, false) => along_first,
        (false, true) => along_second,
        _ if is_first_shorter => along_first,
        _ => along_second,
    }
}

/// The faces or elements at each point.
pub(super) fn at_corners<C: Deref<Target = [u32]> + Clone>(
    points: usize,
    faces: usize,
    corners: impl Fn(usize) -> C,
) -> Grouped<u32> {
    let of_face = |face: usize| {
        let corners = corners(face);
        (0..corners.len()).map(move |k| (corners[k] as usize, id(face)))
    };
    Grouped::new(points, (0..faces).flat_map(of_face))
}
