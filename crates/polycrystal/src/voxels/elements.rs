//! Triangles for squares that are no longer flat.

use std::ops::Deref;

use glam::DVec3;
use rayon::prelude::*;
use voronoi::PeriodicVertex;

use crate::mesh::grouped::Grouped;
use crate::mesh::id::id;
use crate::voxels::copies::Copies;
use crate::voxels::labels::Grid;
use crate::voxels::staircase::{Faces, Staircase};
use crate::{BoundaryId, Elements, GrainId, Side};

/// Triangles or segments, and the kind of each. Along periods those around whole grains.
pub(super) struct CutFaces {
    pub(super) elements: ElementList,
    pub(super) kind_of: Vec<BoundaryId>,
    /// The points that elements have beside those of the lattice.
    pub(super) copies: Copies,
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
    pub(super) fn new(staircase: &Staircase, grid: &Grid, points: &[DVec3]) -> Self {
        let (kinds, periods) = (&staircase.kinds, grid.periods());
        let corner = |face: usize, corner: usize| PeriodicVertex {
            vertex: staircase.faces.corners(face)[corner],
            translation: staircase.corner_moved(grid, face, corner),
        };
        match &staircase.faces {
            Faces::Squares(squares) => {
                let twice = |kind: &u32| [BoundaryId(*kind); 2];
                let mut kind_of: Vec<BoundaryId> =
                    staircase.kind_of.par_iter().flat_map_iter(twice).collect();
                let (triangles, copies) = if staircase.moved.is_empty() {
                    let halves = |square: &[u32; 4]| cut(*square, |corner| points[corner as usize]);
                    (squares.par_iter().flat_map_iter(halves).collect(), Copies::none(points.len()))
                } else {
                    let halves = |face| {
                        let square = [0, 1, 2, 3].map(|k| corner(face, k));
                        cut(square, |corner| Copies::position(points, corner, periods))
                    };
                    let triangles: Vec<_> = (0..squares.len()).flat_map(halves).collect();
                    Copies::unwrapped(points.len(), periods, &triangles, &mut kind_of, kinds)
                };
                Self { elements: ElementList::Triangles(triangles), kind_of, copies }
            }
            Faces::Segments(segments) => {
                let mut kind_of = staircase.kind_of.iter().map(|kind| BoundaryId(*kind)).collect();
                let ends: Vec<_> = (0..segments.len()).map(|face| [0, 1].map(|k| corner(face, k))).collect();
                let (segments, copies) = Copies::unwrapped(points.len(), periods, &ends, &mut kind_of, kinds);
                Self { elements: ElementList::Segments(segments), kind_of, copies }
            }
        }
    }

    /// The points of the lattice at some pairs of elements, some more than once.
    pub(super) fn points_of(&self, pairs: &[[u32; 2]]) -> impl Iterator<Item = u32> {
        let corners = pairs.iter().flatten().flat_map(|element| self.elements().corners(*element).to_vec());
        corners.map(|corner| self.copies.original(corner))
    }

    /// The points of the lattice at some grains, some more than once, where the kinds have these sides.
    pub(super) fn points_of_grains(
        &self,
        grains: &[GrainId],
        sides: &[[Side; 2]],
    ) -> impl Iterator<Item = u32> {
        let is_at = |side: &Side| side.grain().is_some_and(|grain| grains.contains(&grain));
        let is_there: Vec<bool> = sides.iter().map(|sides| sides.iter().any(is_at)).collect();
        let elements = (0u32..).zip(&self.kind_of).filter(move |(_, kind)| is_there[kind.index()]);
        let corners = elements.flat_map(|(element, _)| self.elements().corners(element).to_vec());
        corners.map(|corner| self.copies.original(corner))
    }

    /// The elements at each point of the lattice, with those at its copies.
    pub(super) fn at_points(&self, count: usize) -> Grouped<u32> {
        let elements = self.elements();
        let of_element = |element: u32| {
            let corners = elements.corners(element);
            (0..corners.len()).map(move |k| (self.copies.original(corners[k]) as usize, element))
        };
        Grouped::new(count, (0..id(elements.len())).flat_map(of_element))
    }
}

fn cut<C: Copy>([a, b, c, d]: [C; 4], at: impl Fn(C) -> DVec3) -> [[C; 3]; 2] {
    let normal = |[a, b, c]: [C; 3]| (at(b) - at(a)).cross(at(c) - at(a));
    let along_first = [[a, b, c], [a, c, d]];
    let along_second = [[a, b, d], [b, c, d]];
    let is_flat = |[one, other]: [[C; 3]; 2]| normal(one).dot(normal(other)) > 0.0;
    let is_first_shorter = at(a).distance_squared(at(c)) <= at(b).distance_squared(at(d));
    match (is_flat(along_first), is_flat(along_second)) {
        (true, false) => along_first,
        (false, true) => along_second,
        _ if is_first_shorter => along_first,
        _ => along_second,
    }
}

/// The faces at each point.
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
