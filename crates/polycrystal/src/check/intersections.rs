//! Elements that cross each other.

use cancellation::check_cancelled;
use glam::DVec3;
use rayon::prelude::*;

use crate::check::box_tree::{Bounds, BoxTree};
use crate::check::contact::{segments_cross, triangles_cross};
use crate::check::projection::{Piece, RimEdge, Room, are_one_graph, is_graph};
use crate::mesh::adjacency::Adjacency;
use crate::mesh::grouped::Grouped;
use crate::{Elements, Surface};

/// All pairs of elements that meet other than in points and edges that they share; sorted, the lower element first.
///
/// All points must be finite; normals are those of [`Elements::normals`].
pub(crate) fn crossing_elements(
    surface: &Surface<'_>,
    adjacency: &Adjacency,
    by_boundary: &Grouped<u32>,
    normals: &[DVec3],
) -> Vec<[u32; 2]> {
    let of_element = |element: u32| bounds(surface, element);
    let tree = |boundary: usize| {
        check_cancelled();
        BoxTree::new(by_boundary.of(boundary).to_vec(), of_element)
    };
    let trees: Vec<BoxTree> = (0..by_boundary.count()).into_par_iter().map(tree).collect();
    let graphs = Graphs::new(surface, adjacency, normals, &trees);
    let around = |boundary: u32| trees[boundary as usize].bounds().copied();
    let of_boundary = |boundary: u32| around(boundary).unwrap_or_default();
    let boundaries = (0u32..).take(trees.len()).filter(|boundary| around(*boundary).is_some());
    let all = BoxTree::new(boundaries.collect(), of_boundary);
    let mut near = Vec::new();
    all.overlaps_within(of_boundary, &mut |a, b| {
        let pair = [a.min(b), a.max(b)];
        if !graphs.is_one(pair) {
            near.push(pair.map(|boundary| boundary as usize));
        }
    });
    let between = near.par_iter().flat_map_iter(|&[a, b]| {
        check_cancelled();
        let mut found = Vec::new();
        trees[a].overlaps_with(&trees[b], of_element, &mut |i, j| {
            if cross(surface, [i, j]) {
                found.push([i, j]);
            }
        });
        found
    });
    let within = trees.par_iter().zip(&graphs.is_graph).filter(|(_, is_graph)| !**is_graph);
    let within = within.flat_map_iter(|(tree, _)| {
        check_cancelled();
        let mut found = Vec::new();
        tree.overlaps_within(of_element, &mut |i, j| {
            if cross(surface, [i, j]) {
                found.push([i, j]);
            }
        });
        found
    });
    let mut found: Vec<[u32; 2]> = between.chain(within).map(|[a, b]| [a.min(b), a.max(b)]).collect();
    found.par_sort_unstable();
    found
}

/// What projections prove: boundaries, and pairs of boundaries that share a line, in which no two triangles cross.
struct Graphs {
    /// Of each boundary.
    is_graph: Vec<bool>,
    /// Of each boundary, those of greater number with which it is one graph.
    partners: Grouped<u32>,
}

impl Graphs {
    fn new(surface: &Surface<'_>, adjacency: &Adjacency, normals: &[DVec3], trees: &[BoxTree]) -> Self {
        let count = trees.len();
        let Elements::Triangles(_) = surface.elements else {
            return Self { is_graph: vec![false; count], partners: Grouped::new(count, std::iter::empty()) };
        };
        let rims = Grouped::new(
            count,
            adjacency.incidences.iter().map(|at| {
                let boundary = surface.boundary_of[at.element as usize];
                (boundary.index(), RimEdge { edge: at.edge, ends: at.ends(surface.elements) })
            }),
        );
        let pieces: Vec<Piece<'_>> = trees
            .par_iter()
            .enumerate()
            .map(|(boundary, tree)| Piece {
                elements: tree.items(),
                rim: rims.of(boundary),
                normal: tree.items().iter().map(|element| normals[*element as usize]).sum(),
                bounds: tree.bounds().copied().unwrap_or_default(),
            })
            .collect();
        let is_one = |room: &mut Room, pair: [u32; 2]| {
            check_cancelled();
            let [a, b] = pair.map(|boundary| &pieces[boundary as usize]);
            are_one_graph(surface.points, normals, [a, b], room).then_some(pair)
        };
        let pairs: Vec<[u32; 2]> = pairs_at_lines(surface, adjacency)
            .into_par_iter()
            .map_init(Room::default, is_one)
            .flatten_iter()
            .collect();
        let mut is_proved = vec![false; count];
        pairs.as_flattened().iter().for_each(|boundary| is_proved[*boundary as usize] = true);
        let alone = pieces.par_iter().zip(is_proved);
        let is_graph =
            alone.map(|(piece, is_proved)| is_proved || is_graph(surface.points, normals, piece)).collect();
        let partners = Grouped::new(count, pairs.iter().map(|[lower, other]| (*lower as usize, *other)));
        Self { is_graph, partners }
    }

    /// Whether two boundaries, the lower first, are one graph together.
    fn is_one(&self, pair: [u32; 2]) -> bool {
        self.partners.of(pair[0] as usize).contains(&pair[1])
    }
}

/// The pairs of boundaries that have an edge in common; sorted, the lower first.
fn pairs_at_lines(surface: &Surface<'_>, adjacency: &Adjacency) -> Vec<[u32; 2]> {
    let mut pairs = Vec::new();
    for at in adjacency.non_manifold_edges() {
        for (index, first) in at.iter().enumerate() {
            for second in &at[index + 1..] {
                let [a, b] = [first, second].map(|at| surface.boundary_of[at.element as usize].0);
                if a != b {
                    pairs.push([a.min(b), a.max(b)]);
                }
            }
        }
    }
    pairs.par_sort_unstable();
    pairs.dedup();
    pairs
}

fn bounds(surface: &Surface<'_>, element: u32) -> Bounds {
    let at = |corner: u32| surface.points[corner as usize];
    match surface.elements {
        Elements::Triangles(triangles) => Bounds::around(triangles[element as usize].map(at)),
        Elements::Segments(segments) => Bounds::around(segments[element as usize].map(at)),
    }
}

fn cross(surface: &Surface<'_>, [a, b]: [u32; 2]) -> bool {
    // The lower first: for a triangle that has a corner twice the order matters.
    let (a, b) = (a.min(b) as usize, a.max(b) as usize);
    match surface.elements {
        Elements::Triangles(triangles) => triangles_cross(surface.points, triangles[a], triangles[b]),
        Elements::Segments(segments) => segments_cross(surface.points, segments[a], segments[b]),
    }
}
