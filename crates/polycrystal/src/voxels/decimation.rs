//! Fewer elements: short edges collapse, and grains get their volumes back.

use std::collections::BTreeSet;

use glam::{DVec3, UVec3};
use voronoi::PeriodicVertex;

use crate::check::box_tree::{Bounds, BoxTree};
use crate::check::certificate::Faults;
use crate::mesh::id::id;
use crate::mesh::volume::VOLUME_RESTORED;
use crate::network::grain_complex::limits;
use crate::network::line_coarsening::coarsened_segments;
use crate::voxels::bending::Boxes;
use crate::voxels::copies::Copies;
use crate::voxels::elements::{CutFaces, ElementList};
use crate::voxels::labels::Grid;
use crate::voxels::neighbors::Neighbors;
use crate::voxels::staircase::Kind;
use crate::voxels::surface::VoxelSurface;
use crate::voxels::tiles::{Corners, Tiles};
use crate::voxels::tuning::VoxelTuning;
use crate::voxels::volumes::{VolumeSearch, Wanted};
use crate::{BoundaryId, GrainId, Surface};

/// A surface whose short edges are to collapse.
pub(super) struct Decimation<'a> {
    pub(super) whole: &'a VoxelSurface,
    pub(super) grid: &'a Grid,
    pub(super) kinds: &'a [Kind],
    pub(super) wanted: &'a Wanted<'a>,
    /// Shorter edges collapse.
    pub(super) shortest_edge: f64,
    pub(super) tuning: &'a VoxelTuning,
}

/// Where a surface is faulty.
#[derive(Default)]
pub(super) struct Faulty {
    /// In units of voxels.
    pub(super) positions: Vec<DVec3>,
    /// Those without their volumes.
    pub(super) grains: Vec<GrainId>,
}

impl Faulty {
    /// Where the faults of a surface are, as seen in the box; along periods also beside it.
    pub(super) fn new(faults: &Faults, surface: &Surface<'_>, grid: &Grid) -> Self {
        let (mut positions, mut grains) = (Vec::new(), Vec::new());
        let (domain, spacing) = (&grid.domain, grid.spacing());
        let (size, periodic) = (domain.size() / spacing, domain.periodic());
        for fault in &faults.0 {
            let Some(position) = fault.position(surface) else {
                grains.extend(fault.grains());
                continue;
            };
            let position = (position - domain.lower()) / spacing;
            let wrapped = position - (position / size).floor() * size;
            let mut images = vec![DVec3::select(periodic, wrapped, position)];
            for (axis, unit) in DVec3::AXES.into_iter().enumerate().filter(|(axis, _)| periodic.test(*axis)) {
                let period = unit * size[axis];
                images = images.into_iter().flat_map(|at| [at - period, at, at + period]).collect();
            }
            positions.extend(images);
        }
        Self { positions, grains }
    }
}

impl Decimation<'_> {
    /// The surface with a part of its points, which move so that grains have their volumes; those that are held are all there, in their places.
    ///
    /// Small grains keep shorter edges.
    pub(super) fn decimated(&self, is_held: &[bool]) -> VoxelSurface {
        let VoxelSurface { points, places, cut } = self.whole;
        let domain = self.grid.in_voxels();
        // Elements of copies go with their originals.
        let count = cut.kind_of.iter().take_while(|kind| kind.index() < self.kinds.len()).count();
        let kind_of = &cut.kind_of[..count];
        let sides: Vec<[voronoi::Side; 2]> = self.kinds.iter().map(Kind::cell_sides).collect();
        let sides_of = || kind_of.iter().map(|kind| &sides[kind.index()]);
        let vertex = |corner: u32| cut.copies.vertex(corner);
        let kinds_of = |is_left: &mut dyn Iterator<Item = bool>| -> Vec<BoundaryId> {
            kind_of.iter().zip(is_left).filter(|(_, is_left)| *is_left).map(|(kind, _)| *kind).collect()
        };
        let (kept, cut) = match &cut.elements {
            ElementList::Triangles(triangles) => {
                let mut left: Vec<Corners> =
                    triangles[..count].iter().map(|corners| Some(corners.map(vertex))).collect();
                let corners = left.iter().flatten().map(|corners| &corners[..]);
                let limits = self.limits(is_held, corners.zip(sides_of()));
                let tiles = Tiles {
                    domain: &domain,
                    points,
                    limits: &limits,
                    kind_of,
                    sides: &sides,
                    edge: self.tuning.tile * self.shortest_edge,
                };
                tiles.coarsen(&mut left);
                let (kept, triangles) = renumbered(points.len(), &left);
                let mut kind_of = kinds_of(&mut left.iter().map(Option::is_some));
                let (triangles, copies) = self.unwrapped(kept.len(), &triangles, &mut kind_of);
                (kept, CutFaces { elements: ElementList::Triangles(triangles), kind_of, copies })
            }
            ElementList::Segments(segments) => {
                let segments: Vec<_> = segments[..count].iter().map(|ends| ends.map(vertex)).collect();
                let limits = self.limits(is_held, segments.iter().map(|ends| &ends[..]).zip(sides_of()));
                let sides: Vec<[voronoi::Side; 2]> = sides_of().copied().collect();
                let left = coarsened_segments(&domain, points, &limits, &segments, &sides);
                let (kept, segments) = renumbered(points.len(), &left);
                let mut kind_of = kinds_of(&mut left.iter().map(Option::is_some));
                let (segments, copies) = self.unwrapped(kept.len(), &segments, &mut kind_of);
                (kept, CutFaces { elements: ElementList::Segments(segments), kind_of, copies })
            }
        };
        let places: Vec<UVec3> = kept.iter().map(|point| places[*point as usize]).collect();
        let points = kept.iter().map(|point| points[*point as usize]).collect();
        let stays = kept.iter().map(|point| is_held[*point as usize]).collect();
        let points = self.with_volumes(points, stays, &places, &cut);
        VoxelSurface { points, places, cut }
    }

    /// The points that are left, moved so that grains have their volumes. Where boundaries would fold or cross by that, points stay if the others can make up for it.
    fn with_volumes(
        &self,
        left: Vec<DVec3>,
        mut stays: Vec<bool>,
        places: &[UVec3],
        cut: &CutFaces,
    ) -> Vec<DVec3> {
        let boxes = Boxes::new(places, self.grid, self.tuning.within_when_decimated);
        let search = VolumeSearch::new(left.len(), cut, self.wanted, self.tuning);
        let neighbors = Neighbors::new(&search);
        let faults = |points: &[DVec3]| {
            let pairs = neighbors.folds(points).into_iter().chain(neighbors.crossings(points));
            pairs.collect::<BTreeSet<[u32; 2]>>()
        };
        let known = faults(&left);
        let mut best = None;
        loop {
            let mut points = left.clone();
            let error = search.restore(&mut points, &boxes, &stays).error;
            if error > VOLUME_RESTORED {
                return best.unwrap_or(points);
            }
            let new: Vec<[u32; 2]> = faults(&points).difference(&known).copied().collect();
            if new.is_empty() {
                return points;
            }
            // In each round some more do: two elements of which all stays are as they were.
            cut.points_of(&new).for_each(|point| stays[point as usize] = true);
            best = Some(points);
        }
    }

    fn unwrapped<const N: usize>(
        &self,
        count: usize,
        elements: &[[PeriodicVertex; N]],
        kind_of: &mut Vec<BoundaryId>,
    ) -> (Vec<[u32; N]>, Copies) {
        Copies::unwrapped(count, self.grid.periods(), elements, kind_of, self.kinds)
    }

    /// Below what edges at each point are short; nothing where one stays.
    fn limits<'b>(
        &self,
        is_held: &[bool],
        elements: impl Iterator<Item = (&'b [PeriodicVertex], &'b [voronoi::Side; 2])>,
    ) -> Vec<Option<f64>> {
        let dimension = self.grid.domain.dimension();
        let length = |volume: &f64| {
            let of_grain = self.tuning.longest_of_grain * dimension.cube_edge(*volume);
            of_grain.min(self.shortest_edge)
        };
        let lengths: Vec<f64> = self.wanted.volumes.iter().map(length).collect();
        let mut limits = limits(&lengths, elements, is_held.len());
        limits.iter_mut().zip(is_held).for_each(|(limit, is_held)| *limit = limit.filter(|_| !is_held));
        limits
    }

    /// Holds the points of the whole surface around some positions, and those of some grains.
    pub(super) fn hold(&self, is_held: &mut [bool], Faulty { positions, grains }: &Faulty) {
        let of_grains = self.whole.cut.points_of_grains(grains, self.wanted.sides);
        of_grains.for_each(|point| is_held[point as usize] = true);
        let Some(first) = positions.first() else { return };
        let around = |position: u32| Bounds::around([positions[position as usize]]);
        let tree = BoxTree::new((0..id(positions.len())).collect(), around);
        let within = self.tuning.held_around * self.shortest_edge;
        for (point, is_held) in self.whole.points.iter().zip(is_held) {
            let squared = |position: u32| positions[position as usize].distance_squared(*point);
            let nearest = tree.nearest(*point, (0, first.distance_squared(*point)), squared);
            *is_held |= squared(nearest) < within * within;
        }
    }
}

/// The points that are left, in order, and the elements by their numbers there.
fn renumbered<const N: usize>(
    point_count: usize,
    left: &[Option<[PeriodicVertex; N]>],
) -> (Vec<u32>, Vec<[PeriodicVertex; N]>) {
    let mut is_left = vec![false; point_count];
    left.iter().flatten().flatten().for_each(|corner| is_left[corner.vertex as usize] = true);
    let kept: Vec<u32> =
        (0u32..).zip(is_left).filter(|(_, is_left)| *is_left).map(|(point, _)| point).collect();
    let mut numbers = vec![0; point_count];
    (0u32..).zip(&kept).for_each(|(number, point)| numbers[*point as usize] = number);
    let renumbered =
        |corner: PeriodicVertex| PeriodicVertex { vertex: numbers[corner.vertex as usize], ..corner };
    let elements = left.iter().flatten().map(|corners| corners.map(renumbered)).collect();
    (kept, elements)
}
