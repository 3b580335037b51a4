//! Elements that cross each other.

use std::ops::Range;

use cancellation::check_cancelled;
use glam::DVec3;
use rayon::prelude::*;

use crate::check::box_tree::{Bounds, BoxTree};
use crate::check::contact::{segments_cross, triangles_cross};
use crate::check::projection::{Piece, RimEdge, Room, are_one_graph, is_graph};
use crate::mesh::adjacency::Adjacency;
use crate::mesh::boundary_elements::BoundaryElements;
use crate::mesh::grouped::Grouped;
use crate::mesh::id::id;
use crate::{Elements, Surface};

/// Elements of the boundaries that are searched at a time, of which and of what lies around them trees and normals are held: 50 bytes
/// for each. All boundaries of a network of 200 grains on level 3 fit.
const BATCH: usize = 1 << 20;

/// All pairs of elements that meet other than in points and edges that they share; sorted, the lower element first.
///
/// All points must be finite; `boxes` are those of the boundaries.
pub(crate) fn crossing_elements(
    surface: &Surface<'_>,
    adjacency: &Adjacency<'_>,
    boundaries: &BoundaryElements<'_>,
    boxes: &[Bounds],
) -> Vec<[u32; 2]> {
    let of_boundary = |boundary: u32| boxes[boundary as usize];
    let filled = (0..id(boxes.len())).filter(|boundary| boundaries.count(*boundary as usize) > 0);
    // Boundaries that lie together come one after the other, however grains are numbered.
    let all = BoxTree::of_strewn(filled.collect(), of_boundary);
    let order = all.items();
    let near = all.overlapping_places(of_boundary);
    let rims = Grouped::new(
        boxes.len(),
        adjacency.incidences.iter().map(|at| {
            let rim_edge = RimEdge { edge: at.edge, ends: at.ends(surface.elements) };
            (surface.boundary(at.element).index(), rim_edge)
        }),
    );
    let search = Search { surface, boundaries, order, rims, at_lines: pairs_at_lines(surface, adjacency) };
    let mut found = Vec::new();
    let mut is_proved = vec![false; order.len()];
    let mut rest = near.as_slice();
    for batch in search.batches() {
        let here;
        (here, rest) = rest.split_at(rest.partition_point(|pair| (pair[0] as usize) < batch.end));
        found.extend(search.crossing_in(batch, here, &mut is_proved));
    }
    found.par_sort_unstable();
    found
}

/// What a search for crossings knows of all boundaries. These are counted by rank: in an order in which those that lie together come one
/// after the other.
struct Search<'a> {
    surface: &'a Surface<'a>,
    boundaries: &'a BoundaryElements<'a>,
    /// The boundary of each rank.
    order: &'a [u32],
    rims: Grouped<RimEdge>,
    /// Pairs of boundaries that have an edge in common; sorted, the lower first.
    at_lines: Vec<[u32; 2]>,
}

/// A boundary while it is searched.
struct Searched {
    normals: Vec<DVec3>,
    normal: DVec3,
    tree: BoxTree,
}

impl Search<'_> {
    /// Ranges of ranks whose boundaries have so many elements together that they can be searched at a time.
    fn batches(&self) -> Vec<Range<usize>> {
        let mut batches = Vec::new();
        let (mut start, mut size) = (0, 0);
        for (rank, boundary) in self.order.iter().enumerate() {
            size += self.boundaries.count(*boundary as usize);
            if size >= BATCH {
                batches.push(start..rank + 1);
                (start, size) = (rank + 1, 0);
            }
        }
        batches.extend((start < self.order.len()).then_some(start..self.order.len()));
        batches
    }

    /// What crosses within the boundaries of a batch, and between each of these pairs of boundaries, the first of which is in it. Boundaries
    /// that are proved not to cross themselves are marked: all pairs of a boundary are searched before the end of its batch.
    fn crossing_in(&self, batch: Range<usize>, near: &[[u32; 2]], is_proved: &mut [bool]) -> Vec<[u32; 2]> {
        let mut ranks: Vec<u32> =
            near.iter().map(|pair| pair[1]).filter(|rank| *rank as usize >= batch.end).collect();
        ranks.sort_unstable();
        ranks.dedup();
        let first_beyond = batch.len();
        let beyond = |rank: u32| first_beyond + ranks.binary_search(&rank).expect("all are listed");
        let index =
            |rank: u32| if (rank as usize) < batch.end { rank as usize - batch.start } else { beyond(rank) };
        let own = (batch.start..batch.end).map(id);
        let searched: Vec<u32> = own.chain(ranks.iter().copied()).collect();
        let searched: Vec<Searched> = searched.par_iter().map(|rank| self.searched(*rank)).collect();
        let one_graph: Vec<bool> = near
            .par_iter()
            .map_init(Room::default, |room, pair| {
                let [a, b] = pair.map(|rank| (rank, &searched[index(rank)]));
                self.are_at_one_line(*pair)
                    && are_one_graph(
                        self.surface.points,
                        [&self.piece(a.0, a.1), &self.piece(b.0, b.1)],
                        room,
                    )
            })
            .collect();
        let proved = near.iter().zip(&one_graph).filter(|(_, is_one)| **is_one);
        proved.for_each(|(pair, _)| pair.iter().for_each(|rank| is_proved[*rank as usize] = true));
        let bounds = |element: u32| bounds(self.surface, element);
        let between = near.par_iter().zip(&one_graph).filter(|(_, is_one)| !**is_one);
        let between = between.flat_map_iter(|(pair, _)| {
            check_cancelled();
            let [a, b] = pair.map(|rank| &searched[index(rank)].tree);
            let mut found = Vec::new();
            a.overlaps_with(b, bounds, &mut |i, j| found.extend(self.crossing([i, j])));
            found
        });
        let is_proved = &*is_proved;
        let within = searched.par_iter().zip(batch.start..batch.end).filter(|(_, rank)| !is_proved[*rank]);
        let within = within.flat_map_iter(|(searched, rank)| {
            let mut found = Vec::new();
            check_cancelled();
            if !self.is_graph(rank, searched) {
                searched.tree.overlaps_within(bounds, &mut |i, j| found.extend(self.crossing([i, j])));
            }
            found
        });
        between.chain(within).collect()
    }

    fn searched(&self, rank: u32) -> Searched {
        check_cancelled();
        let boundary = self.order[rank as usize] as usize;
        let elements = self.boundaries.of(boundary);
        let normal = |element: &u32| self.surface.elements.normal(self.surface.points, *element);
        let normals: Vec<DVec3> = elements.iter().map(normal).collect();
        let tree = BoxTree::new(elements, |element| bounds(self.surface, element));
        Searched { normal: normals.iter().sum(), normals, tree }
    }

    fn piece<'a>(&'a self, rank: u32, searched: &'a Searched) -> Piece<'a> {
        Piece {
            normals: &searched.normals,
            rim: self.rims.of(self.order[rank as usize] as usize),
            normal: searched.normal,
            bounds: searched.tree.bounds().copied().unwrap_or_default(),
        }
    }

    /// Whether two boundaries in space have an edge in common.
    fn are_at_one_line(&self, pair: [u32; 2]) -> bool {
        let [a, b] = pair.map(|rank| self.order[rank as usize]);
        self.is_in_space() && self.at_lines.binary_search(&[a.min(b), a.max(b)]).is_ok()
    }

    /// Whether the triangles of a boundary are proved not to cross each other.
    fn is_graph(&self, rank: usize, searched: &Searched) -> bool {
        self.is_in_space() && is_graph(self.surface.points, &self.piece(id(rank), searched))
    }

    fn is_in_space(&self) -> bool {
        !matches!(self.surface.elements, Elements::Segments(_))
    }

    /// A pair of elements that crosses, the lower first.
    fn crossing(&self, [a, b]: [u32; 2]) -> Option<[u32; 2]> {
        // For a triangle that has a corner twice the order matters.
        let pair = [a.min(b), a.max(b)];
        cross(self.surface, pair).then_some(pair)
    }
}

/// The pairs of boundaries that have an edge in common; sorted, the lower first.
fn pairs_at_lines(surface: &Surface<'_>, adjacency: &Adjacency<'_>) -> Vec<[u32; 2]> {
    let mut pairs = Vec::new();
    // The edges of a line follow each other for the most part, and have the same boundaries.
    let (mut boundaries, mut last) = (Vec::new(), Vec::new());
    for at in adjacency.non_manifold_edges() {
        boundaries.clear();
        boundaries.extend(at.iter().map(|at| surface.boundary(at.element).0));
        boundaries.sort_unstable();
        boundaries.dedup();
        if boundaries != last {
            for (index, a) in boundaries.iter().enumerate() {
                pairs.extend(boundaries[index + 1..].iter().map(|b| [*a, *b]));
            }
            std::mem::swap(&mut boundaries, &mut last);
        }
    }
    pairs.par_sort_unstable();
    pairs.dedup();
    pairs
}

/// The box around each boundary.
pub(crate) fn boundary_boxes(surface: &Surface<'_>, boundaries: &BoundaryElements<'_>) -> Vec<Bounds> {
    let around = |boundary: usize| {
        let boxes = boundaries.of(boundary).into_iter().map(|element| bounds(surface, element));
        boxes.fold(Bounds::default(), Bounds::with)
    };
    (0..boundaries.boundary_count()).into_par_iter().map(around).collect()
}

fn bounds(surface: &Surface<'_>, element: u32) -> Bounds {
    let corners = surface.elements.corners(element);
    Bounds::around(corners.iter().map(|corner| surface.points[*corner as usize]))
}

fn cross(surface: &Surface<'_>, pair: [u32; 2]) -> bool {
    let [a, b] = pair.map(|element| surface.elements.corners(element));
    match (&*a, &*b) {
        (&[a, b, c], &[d, e, f]) => triangles_cross(surface.points, [a, b, c], [d, e, f]),
        (&[a, b], &[c, d]) => segments_cross(surface.points, [a, b], [c, d]),
        _ => unreachable!("all elements of a surface are of a kind"),
    }
}
