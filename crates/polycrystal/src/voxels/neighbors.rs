//! How elements between voxels meet, and where they should not.

use glam::{DVec3, UVec3};
use rayon::prelude::*;

use crate::check::folds::is_folded;
use crate::check::intersections::{boundary_boxes, crossing_elements};
use crate::mesh::adjacency::{Adjacency, Inner};
use crate::mesh::boundary_elements::BoundaryElements;
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
        let boxes = boundary_boxes(&surface, &self.boundaries);
        crossing_elements(&surface, &self.adjacency, &self.boundaries, &boxes)
    }

    /// As [`crossings`](Self::crossings), of elements at some points and those beside them, where points are within the boxes of these places.
    pub(super) fn crossings_at(&self, points: &[DVec3], at: &[u32], places: &[UVec3]) -> Vec<[u32; 2]> {
        let CutFaces { copies, kind_of, .. } = self.search.slopes.cut;
        let all = self.search.slopes.cut.elements();
        let with_copies = copies.with_copies(points);
        // Boxes of different places are apart, so elements that cross have points at one place.
        let at_place = |point: u32| {
            let is_there = move |other: &u32| places[*other as usize] == places[point as usize];
            (0..point).rev().take_while(is_there).chain((point..id(places.len())).take_while(is_there))
        };
        let at_points = |points: &[u32]| {
            sorted(points.iter().flat_map(|point| self.search.slopes.at_point(*point)).copied().collect())
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
        let boundaries = BoundaryElements::new(&surface);
        let boxes = boundary_boxes(&surface, &boundaries);
        let crossings = crossing_elements(&surface, &adjacency, &boundaries, &boxes);
        crossings.into_iter().map(|pair| pair.map(|element| near[element as usize])).collect()
    }
}

/// Each item once, in order.
fn sorted<T: Ord + Copy>(mut items: Vec<T>) -> Vec<T> {
    items.sort_unstable();
    items.dedup();
    items
}
