//! How elements between voxels meet, and where they should not.

use glam::{DVec3, UVec3};
use rayon::prelude::*;

use crate::check::intersections::{crossing_elements, extents};
use crate::mesh::adjacency::{Adjacency, Inner};
use crate::mesh::boundary_elements::BoundaryElements;
use crate::mesh::fold::is_folded;
use crate::mesh::id::id;
use crate::voxels::copies::Copies;
use crate::voxels::elements::{CutFaces, ElementList};
use crate::voxels::volumes::VolumeSearch;
use crate::{BoundaryId, Elements, Side, Surface};

/// How the elements of a surface meet, wherever its points are.
pub(super) struct Neighbors<'a> {
    search: &'a VolumeSearch<'a>,
    adjacency: Adjacency<'a>,
    boundaries: BoundaryElements<'a>,
}

impl<'a> Neighbors<'a> {
    pub(super) fn new(search: &'a VolumeSearch<'a>) -> Self {
        let surface = search.slopes.surface(&[]);
        let adjacency = Adjacency::of_elements(surface.elements, surface.boundary_of);
        Self { search, adjacency, boundaries: BoundaryElements::new(&surface) }
    }

    /// Pairs of elements of one boundary that are folded.
    pub(super) fn folds(&self, points: &[DVec3]) -> Vec<[u32; 2]> {
        let Inner::Listed(pairs) = &self.adjacency.inner else {
            unreachable!("the adjacency of loose elements is a list")
        };
        let points = self.search.slopes.cut.copies.with_copies(points);
        let elements = self.search.slopes.cut.elements();
        // Three times the arithmetic of a list of all normals, which would take a seventh of the memory of all else.
        let normals = |pair: &[u32; 2]| pair.map(|element| elements.normal(&points, element));
        pairs.par_iter().filter(|pair| is_folded(normals(pair), 0.0)).copied().collect()
    }

    /// As [`folds`](Self::folds), of which one element or both have one of some points for a corner; sorted.
    pub(super) fn folds_at(&self, points: &[DVec3], at: &[u32]) -> Vec<[u32; 2]> {
        let points = self.search.slopes.cut.copies.with_copies(points);
        let elements = self.search.slopes.cut.elements();
        let at_points = at.iter().flat_map(|point| self.search.slopes.at_point(*point));
        let mut pairs = sorted(at_points.flat_map(|element| self.beside(*element)).collect());
        pairs.retain(|pair| is_folded(pair.map(|element| elements.normal(&points, element)), 0.0));
        pairs
    }

    /// An element with each of those beside it in its boundary, the lower first.
    fn beside(&self, element: u32) -> Vec<[u32; 2]> {
        let CutFaces { kind_of, copies, .. } = self.search.slopes.cut;
        let elements = self.search.slopes.cut.elements();
        let corners = elements.corners(element);
        let edges = match *corners {
            [a, b, c] => vec![[a, b], [b, c], [c, a]],
            _ => corners.iter().map(|end| [*end; 2]).collect(),
        };
        let other = |[from, to]: [u32; 2]| {
            let at_edge = self.search.slopes.at_point(copies.original(from)).iter().filter(|other| {
                let corners = elements.corners(**other);
                corners.contains(&from) && corners.contains(&to)
            });
            let mut others = at_edge.filter(|other| **other != element);
            let (Some(other), None) = (others.next(), others.next()) else { return None };
            let is_same = kind_of[*other as usize] == kind_of[element as usize];
            is_same.then_some([element.min(*other), element.max(*other)])
        };
        edges.into_iter().filter_map(other).collect()
    }

    /// Pairs of elements that meet other than in points and edges that they share.
    pub(super) fn crossings(&self, points: &[DVec3]) -> Vec<[u32; 2]> {
        let with_copies = self.search.slopes.cut.copies.with_copies(points);
        let surface = self.search.slopes.surface(&with_copies);
        crossings_of(&surface, &self.adjacency, &self.boundaries)
    }

    /// As [`crossings`](Self::crossings), of elements at some points and those beside them, where points are within the boxes of these places and elements are halves of squares.
    pub(super) fn crossings_at(&self, points: &[DVec3], at: &[u32], places: &[UVec3]) -> Vec<[u32; 2]> {
        let CutFaces { copies, kind_of, .. } = self.search.slopes.cut;
        let all = self.search.slopes.cut.elements();
        let with_copies = copies.with_copies(points);
        // Boxes of different places are apart, so squares that cross have points at one place. Of each square the two halves follow each other.
        let at_place = |point: u32| {
            let is_there = move |other: &u32| places[*other as usize] == places[point as usize];
            (0..point).rev().take_while(is_there).chain((point..id(places.len())).take_while(is_there))
        };
        let halves = |element: u32| match all {
            Elements::Segments(_) => [element; 2],
            _ => [element & !1, element | 1],
        };
        let at_points = |points: &[u32]| {
            let elements = points.iter().flat_map(|point| self.search.slopes.at_point(*point));
            sorted(elements.flat_map(|element| halves(*element)).collect())
        };
        let beside = at_points(at).into_iter().flat_map(|element| all.corners(element).to_vec());
        let beside = sorted(beside.flat_map(|corner| at_place(copies.original(corner))).collect());
        let near = at_points(&beside);
        let corners = sorted(near.iter().flat_map(|element| all.corners(*element).to_vec()).collect());
        let number = |corner: u32| id(corners.binary_search(&corner).expect("all corners are listed"));
        let of_elements = near.iter().map(|element| all.corners(*element));
        let elements = match all {
            Elements::Segments(_) => {
                ElementList::Segments(of_elements.map(|ends| [ends[0], ends[1]].map(number)).collect())
            }
            _ => ElementList::Triangles(of_elements.map(|of| [of[0], of[1], of[2]].map(number)).collect()),
        };
        let kinds = sorted(near.iter().map(|element| kind_of[*element as usize]).collect());
        let kind = |element: &u32| kinds.binary_search(&kind_of[*element as usize]).expect("all are listed");
        let sides: Vec<[Side; 2]> = kinds.iter().map(|kind| self.search.slopes.sides[kind.index()]).collect();
        let cut = CutFaces {
            elements,
            kind_of: near.iter().map(|element| BoundaryId(id(kind(element)))).collect(),
            copies: Copies::none(corners.len()),
        };
        let points: Vec<DVec3> = corners.iter().map(|corner| with_copies[*corner as usize]).collect();
        let surface =
            Surface { points: &points, elements: cut.elements(), boundary_of: &cut.kind_of, sides: &sides };
        let adjacency = Adjacency::of_elements(surface.elements, surface.boundary_of);
        let crossings = crossings_of(&surface, &adjacency, &BoundaryElements::new(&surface));
        crossings.into_iter().map(|pair| pair.map(|element| near[element as usize])).collect()
    }
}

fn crossings_of(
    surface: &Surface<'_>,
    adjacency: &Adjacency<'_>,
    boundaries: &BoundaryElements<'_>,
) -> Vec<[u32; 2]> {
    crossing_elements(surface, adjacency, boundaries, &extents(surface, boundaries))
}

/// Each item once, in order.
fn sorted<T: Ord + Copy>(mut items: Vec<T>) -> Vec<T> {
    items.sort_unstable();
    items.dedup();
    items
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use glam::{BVec3, Vec3};
    use proptest::prelude::*;
    use voronoi::Domain;

    use super::*;
    use crate::voxels::bending::Boxes;
    use crate::voxels::elements::at_corners;
    use crate::voxels::lattice::Lattice;
    use crate::voxels::staircase::{Staircase, sides_of_whole_grains};
    use crate::voxels::untangling::starts;
    use crate::voxels::volumes::Wanted;
    use crate::voxels::whole_grains::whole_grains;
    use crate::{GrainId, VoxelLabel, VoxelTuning, Voxels};

    /// Edge of the maps, in voxels.
    const EDGE: usize = 6;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(200))]

        #[test]
        fn crossings_at_some_points_are_those_of_all_that_are_there(
            middles in proptest::sample::subsequence((0..EDGE.pow(3)).collect::<Vec<_>>(), 50),
            moved in proptest::collection::vec(-0.49f32..0.49, 997),
            at in proptest::collection::vec(any::<prop::sample::Index>(), 1..20),
            is_periodic in any::<bool>(),
        ) {
            let domain = Domain::unit_cube().with_periods(BVec3::new(is_periodic, false, false));
            let place = |voxel: usize| [voxel % EDGE, voxel / EDGE % EDGE, voxel / EDGE / EDGE];
            let squared = |middle: usize, voxel: usize| -> usize {
                let apart = |axis: usize| {
                    let apart = place(middle)[axis].abs_diff(place(voxel)[axis]);
                    if axis == 0 && is_periodic { apart.min(EDGE - apart) } else { apart }
                };
                (0..3).map(|axis| apart(axis).pow(2)).sum()
            };
            let nearest = |voxel| (0u32..50).min_by_key(|grain| squared(middles[*grain as usize], voxel));
            let labels = (0..EDGE.pow(3)).filter_map(nearest).map(|grain| VoxelLabel::of(GrainId(grain)));
            let voxels = Voxels::new(domain, [EDGE; 3], labels.collect());
            let mut lattice = Lattice::new(&voxels).expect("each grain has its middle");
            let mut mixed = lattice.mixed_places();
            // A grain that touches itself, or goes on without end, has no network.
            let is_parted = lattice.part_what_touches(&mut mixed).is_ok();
            let Some(whole) = whole_grains(&lattice, &mixed).ok().filter(|_| is_parted) else { return Ok(()) };
            let staircase = Staircase::new(&lattice, &mixed, &whole);
            let tuning = VoxelTuning::default();
            let boxes = Boxes::new(&staircase.places, &voxels.grid, tuning.within);
            let faces = &staircase.faces;
            let faces_at = at_corners(staircase.places.len(), faces.len(), |face| faces.corners(face));
            let starts = starts(&boxes, &faces_at, |face| faces.corners(face as usize), tuning.apart);
            let place = |(point, start): (usize, &Vec3)| {
                let moved = DVec3::from_array([0, 1, 2].map(|axis| f64::from(moved[(3 * point + axis) % moved.len()])));
                boxes.nearest(point, boxes.middle(point) + start.as_dvec3() + moved)
            };
            let points: Vec<DVec3> = starts.iter().enumerate().map(place).collect();
            let cut = CutFaces::new(&staircase, &voxels.grid, &points);
            let sides = sides_of_whole_grains(&staircase.kinds, is_periodic);
            let wanted = Wanted { volumes: &[], sides: &sides };
            let search = VolumeSearch::new(points.len(), &cut, &wanted, &tuning);
            let neighbors = Neighbors::new(&search);

            let all: BTreeSet<[u32; 2]> = neighbors.crossings(&points).into_iter().collect();
            let at: Vec<u32> = at.iter().map(|point| id(point.index(points.len()))).collect();
            let found: BTreeSet<[u32; 2]> =
                neighbors.crossings_at(&points, &at, &staircase.places).into_iter().collect();
            prop_assert!(found.is_subset(&all));
            let is_there = |pair: &&[u32; 2]| cut.points_of(&[**pair]).any(|point| at.contains(&point));
            let there: BTreeSet<[u32; 2]> = all.iter().filter(is_there).copied().collect();
            prop_assert!(there.is_subset(&found), "{:?} are missing", there.difference(&found));
        }
    }
}
