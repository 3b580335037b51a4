//! Elements that cross each other.

use cancellation::check_cancelled;
use rayon::prelude::*;

use crate::check::box_tree::{Bounds, BoxTree};
use crate::check::contact::{segments_cross, triangles_cross};
use crate::check::normal_cone::NormalCone;
use crate::check::projection::{Piece, RimEdge, Room, are_one_graph, is_graph};
use crate::mesh::adjacency::Adjacency;
use crate::mesh::boundary_elements::BoundaryElements;
use crate::mesh::grouped::Grouped;
use crate::mesh::id::id;
use crate::mesh::level_points::LevelPoints;
use crate::{Elements, Surface};

/// What a boundary takes up of space.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Extent {
    /// The box around it.
    pub(crate) bounds: Bounds,
    /// The cone around its normals.
    pub(crate) normals: NormalCone,
}

/// The extent of each boundary.
pub(crate) fn extents(surface: &Surface<'_>, boundaries: &BoundaryElements<'_>) -> Vec<Extent> {
    let points = LevelPoints::held(surface.elements, surface.points);
    let of_boundary = |boundary: usize| {
        let boxes = boundaries.labelled(boundary).iter().map(|labelled| bounds_in(surface, *labelled));
        Extent {
            bounds: boxes.fold(Bounds::default(), Bounds::with),
            normals: NormalCone::of(&boundaries.normals(boundary, &points)),
        }
    };
    (0..boundaries.boundary_count()).into_par_iter().map(of_boundary).collect()
}

/// All pairs of elements that meet other than in points and edges that they share; sorted, the lower element first.
///
/// All points must be finite.
pub(crate) fn crossing_elements(
    surface: &Surface<'_>,
    adjacency: &Adjacency<'_>,
    boundaries: &BoundaryElements<'_>,
    extents: &[Extent],
) -> Vec<[u32; 2]> {
    let of_boundary = |boundary: u32| extents[boundary as usize].bounds;
    let filled = (0..id(extents.len())).filter(|boundary| boundaries.count(*boundary as usize) > 0);
    // Boundaries that lie together come one after the other, however grains are numbered.
    let all = BoxTree::of_strewn(filled.collect(), of_boundary);
    let pairs = all.overlapping_places(of_boundary);
    let boundary_at = |place: u32| all.items()[place as usize];
    let rims = Grouped::new(
        extents.len(),
        adjacency.incidences.iter().map(|at| {
            let rim_edge = RimEdge { edge: at.edge, ends: at.ends(surface.elements) };
            (surface.boundary(at.element).index(), rim_edge)
        }),
    );
    let search = Search { surface, boundaries, extents, rims, at_lines: pairs_at_lines(surface, adjacency) };
    let is_proved = |room: &mut Room, pair: &[u32; 2]| search.are_one_graph(pair.map(boundary_at), room);
    let of_pairs: Vec<bool> = pairs.par_iter().map_init(Room::default, is_proved).collect();
    // What does not cross another boundary that it is one graph with does not cross itself.
    let mut of_boundaries = vec![false; extents.len()];
    for (pair, _) in pairs.iter().zip(&of_pairs).filter(|(_, is_proved)| **is_proved) {
        pair.iter().for_each(|place| of_boundaries[boundary_at(*place) as usize] = true);
    }
    let trees: Vec<BoxTree> = all.items().par_iter().map(|boundary| search.tree(*boundary)).collect();
    let between = pairs.par_iter().zip(&of_pairs).filter(|(_, is_proved)| !**is_proved);
    let between = between.flat_map_iter(|(pair, _)| {
        check_cancelled();
        let [one, other] = pair.map(|place| &trees[place as usize]);
        search.crossing_between(one, other)
    });
    let within = all.items().par_iter().zip(&trees);
    let within = within.filter(|(boundary, _)| !of_boundaries[**boundary as usize]);
    let within = within.flat_map_iter(|(boundary, tree)| {
        check_cancelled();
        if search.is_graph(*boundary) { Vec::new() } else { search.crossing_within(tree) }
    });
    let mut found: Vec<[u32; 2]> = between.chain(within).collect();
    found.par_sort_unstable();
    found
}

/// What a search for crossings knows of all boundaries.
struct Search<'a> {
    surface: &'a Surface<'a>,
    boundaries: &'a BoundaryElements<'a>,
    extents: &'a [Extent],
    rims: Grouped<RimEdge>,
    /// Pairs of boundaries that have an edge in common; sorted, the lower first.
    at_lines: Vec<[u32; 2]>,
}

impl Search<'_> {
    /// The elements of a boundary that hold its label, and what is refined from them.
    fn tree(&self, boundary: u32) -> BoxTree {
        check_cancelled();
        BoxTree::new(self.boundaries.labelled(boundary as usize).to_vec(), |labelled| self.bounds(labelled))
    }

    fn piece(&self, boundary: u32) -> Piece<'_> {
        let Extent { bounds, normals } = self.extents[boundary as usize];
        Piece { normals, rim: self.rims.of(boundary as usize), bounds }
    }

    /// Whether two boundaries in space that have an edge in common are proved not to cross each other, nor themselves.
    fn are_one_graph(&self, [a, b]: [u32; 2], room: &mut Room) -> bool {
        self.is_in_space()
            && self.at_lines.binary_search(&[a.min(b), a.max(b)]).is_ok()
            && are_one_graph(self.surface.points, [&self.piece(a), &self.piece(b)], room)
    }

    /// Whether the triangles of a boundary are proved not to cross each other.
    fn is_graph(&self, boundary: u32) -> bool {
        self.is_in_space() && is_graph(self.surface.points, &self.piece(boundary))
    }

    fn is_in_space(&self) -> bool {
        !matches!(self.surface.elements, Elements::Segments(_))
    }

    fn bounds(&self, labelled: u32) -> Bounds {
        bounds_in(self.surface, labelled)
    }

    /// What crosses between two boundaries.
    fn crossing_between(&self, one: &BoxTree, other: &BoxTree) -> Vec<[u32; 2]> {
        let mut found = Vec::new();
        let bounds = |labelled| self.bounds(labelled);
        one.overlaps_with(other, bounds, &mut |a, b| self.add_crossing(a, b, &mut found));
        found
    }

    /// What crosses within a boundary.
    fn crossing_within(&self, tree: &BoxTree) -> Vec<[u32; 2]> {
        let mut found = Vec::new();
        let bounds = |labelled| self.bounds(labelled);
        tree.overlaps_within(bounds, &mut |a, b| self.add_crossing(a, b, &mut found));
        tree.items().iter().for_each(|labelled| self.add_crossing(*labelled, *labelled, &mut found));
        found
    }

    /// Adds what crosses between the elements that come from one that holds a label and from another, which may be the same.
    fn add_crossing(&self, one: u32, other: u32, found: &mut Vec<[u32; 2]>) {
        let elements = self.surface.elements;
        if elements.refined_triangle().triangles.len() == 1 {
            found.extend((one != other).then(|| self.crossing([one, other])).flatten());
            return;
        }
        let around = self.bounds(one);
        let mut near = [(0, Bounds::default()); 16];
        let mut count = 0;
        self.for_each_in(other, |place, bounds| {
            near[count] = (place, bounds);
            count += usize::from(bounds.overlaps(&around));
        });
        if count == 0 {
            return;
        }
        self.for_each_in(one, |place, bounds| {
            let overlapping = near[..count].iter().filter(|(_, other)| bounds.overlaps(other));
            for (other_place, _) in
                overlapping.filter(|(other_place, _)| one != other || place < *other_place)
            {
                let pair = [elements.element_in(one, place), elements.element_in(other, *other_place)];
                found.extend(self.crossing(pair));
            }
        });
    }

    /// A pair of elements that crosses, the lower first.
    fn crossing(&self, [a, b]: [u32; 2]) -> Option<[u32; 2]> {
        // For a triangle that has a corner twice the order matters.
        let pair = [a.min(b), a.max(b)];
        cross(self.surface, pair).then_some(pair)
    }

    /// Looks at the boxes around the triangles that come from one that holds a label, by their places.
    #[inline(always)]
    fn for_each_in(&self, labelled: u32, mut look_at: impl FnMut(usize, Bounds)) {
        let mut place = 0;
        LevelPoints::held(self.surface.elements, self.surface.points).for_each_in(labelled, |corners| {
            look_at(place, Bounds::around(corners.iter().copied()));
            place += 1;
        });
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

/// The box around what is refined from an element that holds a label.
#[inline]
pub(crate) fn bounds_in(surface: &Surface<'_>, labelled: u32) -> Bounds {
    let mut bounds = Bounds::default();
    surface
        .elements
        .for_each_vertex_in(labelled, |vertex| bounds = bounds.with_point(surface.points[vertex as usize]));
    bounds
}

fn cross(surface: &Surface<'_>, pair: [u32; 2]) -> bool {
    let [a, b] = pair.map(|element| surface.elements.corners(element));
    match (&*a, &*b) {
        (&[a, b, c], &[d, e, f]) => triangles_cross(surface.points, [a, b, c], [d, e, f]),
        (&[a, b], &[c, d]) => segments_cross(surface.points, [a, b], [c, d]),
        _ => unreachable!("all elements of a surface are of a kind"),
    }
}
