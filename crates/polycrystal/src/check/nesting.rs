//! Whether each closed piece of a surface lies inside the grain that is around it.
//!
//! The surface of a network is in one piece, unless grains lie inside others. Signed volumes do not tell where such pieces are: what a grain
//! has lost to one inside it, it has lost wherever that lies.

use std::collections::BTreeMap;

use cancellation::check_cancelled;
use rayon::prelude::*;

use crate::check::box_tree::{Bounds, BoxTree};
use crate::check::contact::{ray_through_segment, ray_through_triangle};
use crate::check::fault::Fault;
use crate::check::intersections::Extent;
use crate::mesh::boundary_elements::BoundaryElements;
use crate::mesh::disjoint_sets::DisjointSets;
use crate::mesh::grouped::Grouped;
use crate::mesh::id::id;
use crate::mesh::volume::cone_of_boundary;
use crate::{Side, Surface};

/// The pieces of a surface: elements that are connected by points.
pub(crate) struct Pieces {
    /// The piece of each point; of refined elements, of the points of what they come from.
    of_points: Vec<u32>,
    count: usize,
}

impl Pieces {
    /// Those of a surface; points of no element are pieces of their own.
    pub(crate) fn new(surface: &Surface<'_>) -> Self {
        // What elements are refined from is in one piece as well.
        let surface = surface.refined_at_most(0);
        let mut sets = DisjointSets::new(surface.points.len());
        for element in 0..id(surface.elements.len()) {
            let corners = surface.elements.corners(element);
            corners.windows(2).for_each(|pair| sets.join(pair[0], pair[1]));
        }
        let (of_points, count) = sets.numbers();
        Self { of_points, count: count as usize }
    }

    fn of_element(&self, surface: &Surface<'_>, element: u32) -> usize {
        self.of_points[old_point(surface, element) as usize] as usize
    }

    /// The pieces that do not lie in the grain, or outside of all, where their sides have them.
    ///
    /// Elements must not cross, and grains must be closed; `extents` are those of the boundaries.
    pub(crate) fn misplaced(
        &self,
        surface: &Surface<'_>,
        boundaries: &BoundaryElements<'_>,
        extents: &[Extent],
    ) -> Vec<Fault> {
        if self.count == 1 {
            return Vec::new();
        }
        let elements =
            (0..id(surface.elements.len())).map(|element| (self.of_element(surface, element), element));
        let elements = Grouped::new(self.count, elements);
        let filled = (0..self.count).filter(|piece| !elements.of(*piece).is_empty());
        let pieces: Vec<Piece> = filled
            .collect::<Vec<_>>()
            .into_par_iter()
            .map(|piece| Piece::new(surface, elements.of(piece)))
            .collect();
        // The boundaries that the ray from each piece may meet.
        let first_piece = id(extents.len());
        let bounds = |item: u32| match extents.get(item as usize) {
            Some(extent) => extent.bounds,
            None => Bounds::of_ray(surface.points[pieces[(item - first_piece) as usize].point as usize]),
        };
        let of_boundaries = (0..first_piece).filter(|boundary| boundaries.count(*boundary as usize) > 0);
        let of_boundaries = BoxTree::new(of_boundaries.collect(), bounds);
        let of_pieces = BoxTree::new((first_piece..).take(pieces.len()).collect(), bounds);
        let mut near = Vec::new();
        of_pieces.overlaps_with(&of_boundaries, bounds, &mut |piece, boundary| {
            near.push(((piece - first_piece) as usize, boundary));
        });
        let near = Grouped::new(pieces.len(), near.iter().copied());
        let misplaced = |(index, piece): (usize, &Piece)| {
            check_cancelled();
            let own = self.of_points[piece.point as usize] as usize;
            let others = near.of(index).iter().flat_map(|boundary| boundaries.of(*boundary as usize));
            let others = others.filter(|element| self.of_element(surface, *element) != own);
            (!piece.is_inside(surface, others))
                .then_some(Fault::Misplaced { point: piece.point, around: piece.around })
        };
        pieces.par_iter().enumerate().filter_map(misplaced).collect()
    }
}

/// A point of an element, or of the one that it is refined from.
fn old_point(surface: &Surface<'_>, element: u32) -> u32 {
    let coarse = surface.elements.refined_at_most(0);
    coarse.corners(surface.elements.labelled(element))[0]
}

/// A closed piece of a surface.
struct Piece {
    /// A point of it.
    point: u32,
    /// The side that is all around it.
    around: Side,
}

impl Piece {
    /// That of some elements, of which those of a boundary come one after the other.
    fn new(surface: &Surface<'_>, elements: &[u32]) -> Self {
        let point = old_point(surface, elements[0]);
        let apex = surface.points[point as usize];
        let mut volumes: BTreeMap<Side, f64> = BTreeMap::new();
        for elements in elements.chunk_by(|a, b| surface.boundary(*a) == surface.boundary(*b)) {
            let volume = cone_of_boundary(surface, elements).volume_from(apex);
            let [first, second] = surface.sides_of(elements[0]);
            *volumes.entry(first).or_default() += volume;
            *volumes.entry(second).or_default() -= volume;
        }
        // What is around lacks the volume of all that is inside.
        let around = volumes.into_iter().min_by(|a, b| a.1.total_cmp(&b.1)).expect("elements have sides").0;
        Self { point, around }
    }

    /// Whether the point lies in what is around it, by the elements of other pieces that a ray from there meets.
    fn is_inside(&self, surface: &Surface<'_>, others: impl Iterator<Item = u32>) -> bool {
        let at = |point: u32| surface.points[point as usize];
        let mut left = 0;
        for element in others {
            let through = || match *surface.elements.corners(element) {
                [a, b, c] => ray_through_triangle(at(self.point), [a, b, c].map(at)),
                [a, b] => ray_through_segment(at(self.point), [a, b].map(at)),
                _ => unreachable!("elements have two or three points"),
            };
            match surface.sides_of(element) {
                [first, _] if first == self.around => left += through(),
                [_, second] if second == self.around => left -= through(),
                _ => (),
            }
        }
        // The exterior has no end for the ray to leave it.
        left == i32::from(self.around != Side::Exterior)
    }
}
