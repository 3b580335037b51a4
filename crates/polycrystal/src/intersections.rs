//! Elements that cross each other.

use glam::DVec3;
use rayon::prelude::*;

use crate::box_tree::{Bounds, BoxTree};
use crate::contact::{segments_cross, triangles_cross};
use crate::projection::is_graph;
use crate::seams::Seams;
use crate::{BoundaryId, Elements, Surface};

/// All pairs of elements that meet other than in points and edges that they share; sorted, the lower element first.
///
/// All points must be finite.
pub(crate) fn crossing_elements(surface: &Surface<'_>, seams: &Seams) -> Vec<[u32; 2]> {
    let pieces = pieces(surface, seams);
    let trees: Vec<BoxTree> = pieces
        .par_iter()
        .map(|piece| BoxTree::new(piece.elements.iter().map(|element| bounds(surface, *element))))
        .collect();
    let mut near = Vec::new();
    let all = BoxTree::new(trees.iter().filter_map(|tree| tree.bounds().copied()));
    all.overlaps_within(&mut |a, b| near.push((a as usize, b as usize)));
    let between = near.par_iter().flat_map_iter(|&(a, b)| {
        let mut found = Vec::new();
        trees[a].overlaps_with(&trees[b], &mut |i, j| {
            let pair = [pieces[a].elements[i as usize], pieces[b].elements[j as usize]];
            if cross(surface, pair) {
                found.push(pair);
            }
        });
        found
    });
    let within = pieces.par_iter().zip(&trees).flat_map_iter(|(piece, tree)| {
        let mut found = Vec::new();
        if !piece.is_graph(surface) {
            tree.overlaps_within(&mut |i, j| {
                let pair = [i, j].map(|index| piece.elements[index as usize]);
                if cross(surface, pair) {
                    found.push(pair);
                }
            });
        }
        found
    });
    let mut found: Vec<[u32; 2]> = between.chain(within).map(|[a, b]| [a.min(b), a.max(b)]).collect();
    found.par_sort_unstable();
    found
}

/// The elements of one boundary.
#[derive(Debug, Default)]
struct Piece {
    elements: Vec<u32>,
    /// Where it meets others; empty in the plane.
    rim: Vec<[u32; 2]>,
}

impl Piece {
    fn is_graph(&self, surface: &Surface<'_>) -> bool {
        let Elements::Triangles(all) = surface.elements else { return false };
        let triangles: Vec<[u32; 3]> = self.elements.iter().map(|element| all[*element as usize]).collect();
        is_graph(surface.points, &triangles, &self.rim)
    }
}

/// The boundaries that have elements.
fn pieces(surface: &Surface<'_>, seams: &Seams) -> Vec<Piece> {
    let mut pieces: Vec<Piece> = surface.sides.iter().map(|_| Piece::default()).collect();
    for (element, boundary) in (0u32..).zip(surface.boundary_of) {
        pieces[boundary.index()].elements.push(element);
    }
    if let Elements::Triangles(_) = surface.elements {
        for at in &seams.uses {
            let boundary: BoundaryId = surface.boundary_of[at.element as usize];
            pieces[boundary.index()].rim.push(at.ends(surface.elements));
        }
    }
    pieces.retain(|piece| !piece.elements.is_empty());
    pieces
}

fn bounds(surface: &Surface<'_>, element: u32) -> Bounds {
    let corners = surface.elements.corners(element);
    Bounds::around(corners.iter().map(|corner| -> DVec3 { surface.points[*corner as usize] }))
}

fn cross(surface: &Surface<'_>, [a, b]: [u32; 2]) -> bool {
    let (a, b) = (a as usize, b as usize);
    match surface.elements {
        Elements::Triangles(triangles) => triangles_cross(surface.points, triangles[a], triangles[b]),
        Elements::Segments(segments) => segments_cross(surface.points, segments[a], segments[b]),
    }
}
