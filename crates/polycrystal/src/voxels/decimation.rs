//! Fewer elements: short edges collapse, and grains get their volumes back.

use glam::DVec3;
use voronoi::{CellId, Domain, PeriodicVertex, Translation, Wall};

use crate::check::box_tree::{Bounds, BoxTree};
use crate::check::certificate::Faults;
use crate::mesh::id::id;
use crate::network::grain_complex::limits;
use crate::network::line_coarsening::coarsened_segments;
use crate::voxels::bending::Boxes;
use crate::voxels::elements::{CutFaces, ElementList};
use crate::voxels::lattice::Lattice;
use crate::voxels::slabs::Slabs;
use crate::voxels::staircase::Kind;
use crate::voxels::surface::VoxelSurface;
use crate::voxels::tuning::VoxelTuning;
use crate::voxels::volumes::{VolumeSearch, Wanted};
use crate::{GrainId, Side};

/// Stands for the surface of pores, and of a body that does not fill the box, as a wall. Those of the box have smaller numbers.
const OPEN_WALL: u32 = 6;

/// A surface whose short edges are to collapse.
pub(super) struct Decimation<'a> {
    pub(super) whole: &'a VoxelSurface,
    pub(super) domain: &'a Domain,
    pub(super) lattice: &'a Lattice,
    pub(super) kinds: &'a [Kind],
    pub(super) wanted: &'a Wanted<'a>,
    /// Shorter edges collapse.
    pub(super) shortest_edge: f64,
    pub(super) tuning: &'a VoxelTuning,
}

impl Decimation<'_> {
    /// The surface with a part of its points, which move so that grains have their volumes; those that are held are all there.
    ///
    /// Small grains keep shorter edges.
    pub(super) fn decimated(&self, is_held: &[bool]) -> VoxelSurface {
        let VoxelSurface { points, places, cut } = self.whole;
        let sides: Vec<[voronoi::Side; 2]> =
            cut.kind_of.iter().map(|kind| cell_sides(&self.kinds[kind.index()])).collect();
        let (is_left, kept, elements) = match &cut.elements {
            ElementList::Triangles(triangles) => {
                let triangles: Vec<_> = triangles.iter().map(|corners| corners.map(standing)).collect();
                let limits = self.limits(is_held, triangles.iter().map(|corners| &corners[..]).zip(&sides));
                let slabs = Slabs {
                    domain: self.domain,
                    points,
                    limits: &limits,
                    sides: &sides,
                    axis: self.lattice.longest_axis(),
                    thickness: self.tuning.slab * self.shortest_edge,
                };
                let left = slabs.coarsened(&triangles);
                let (kept, triangles) = renumbered(points.len(), &left);
                (
                    left.iter().map(Option::is_some).collect::<Vec<_>>(),
                    kept,
                    ElementList::Triangles(triangles),
                )
            }
            ElementList::Segments(segments) => {
                let segments: Vec<_> = segments.iter().map(|ends| ends.map(standing)).collect();
                let limits = self.limits(is_held, segments.iter().map(|ends| &ends[..]).zip(&sides));
                let left = coarsened_segments(self.domain, points, &limits, &segments, &sides);
                let (kept, segments) = renumbered(points.len(), &left);
                (left.iter().map(Option::is_some).collect(), kept, ElementList::Segments(segments))
            }
        };
        let kinds = cut.kind_of.iter().zip(is_left).filter(|(_, is_left)| *is_left);
        let cut = CutFaces { elements, kind_of: kinds.map(|(kind, _)| *kind).collect() };
        let places: Vec<_> = kept.iter().map(|point| places[*point as usize]).collect();
        let mut points: Vec<DVec3> = kept.iter().map(|point| points[*point as usize]).collect();
        let boxes = Boxes::new(&places, self.lattice, self.tuning.within_when_decimated);
        let search = VolumeSearch::new(&boxes.middles, &cut, self.wanted, self.tuning);
        search.restore(&mut points, &boxes, &vec![false; kept.len()]);
        VoxelSurface { points, places, cut }
    }

    /// Below what edges at each point are short; nothing where one stays.
    fn limits<'b>(
        &self,
        is_held: &[bool],
        elements: impl Iterator<Item = (&'b [PeriodicVertex], &'b [voronoi::Side; 2])>,
    ) -> Vec<Option<f64>> {
        let dimension = self.domain.dimension();
        let length = |volume: &f64| {
            let of_grain = self.tuning.longest_of_grain * dimension.cube_edge(*volume);
            of_grain.min(self.shortest_edge)
        };
        let lengths: Vec<f64> = self.wanted.volumes.iter().map(length).collect();
        let mut limits = limits(&lengths, elements, is_held.len());
        limits.iter_mut().zip(is_held).for_each(|(limit, is_held)| *limit = limit.filter(|_| !is_held));
        limits
    }

    /// Holds the points of the whole surface around the faults of a decimated one, and those of grains without their volumes.
    pub(super) fn hold(&self, is_held: &mut [bool], faults: &Faults, decimated: &VoxelSurface) {
        let surface = decimated.as_surface(self.wanted.sides);
        let (mut positions, mut grains) = (Vec::new(), Vec::new());
        for fault in &faults.0 {
            match fault.position(&surface) {
                Some(position) => positions.push(position),
                None => grains.extend(fault.grains()),
            }
        }
        grains.sort_unstable();
        let is_faulty = |side: &Side| side.grain().is_some_and(|grain| grains.binary_search(&grain).is_ok());
        for (element, kind) in (0u32..).zip(&self.whole.cut.kind_of) {
            if self.wanted.sides[kind.index()].iter().any(is_faulty) {
                for corner in self.whole.cut.elements().corners(element).iter() {
                    is_held[*corner as usize] = true;
                }
            }
        }
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

/// A point that is not moved by periods, of which a map has none.
fn standing(vertex: u32) -> PeriodicVertex {
    PeriodicVertex { vertex, translation: Translation::ZERO }
}

/// What lies beside a kind of face, as cells have it.
fn cell_sides(kind: &Kind) -> [voronoi::Side; 2] {
    let wall = Wall::numbered(kind.wall.unwrap_or(OPEN_WALL));
    kind.sides().map(|side| match side {
        Side::Grain(GrainId(grain)) => voronoi::Side::Cell(CellId(grain)),
        Side::Exterior => voronoi::Side::Wall(wall),
    })
}

/// The points that are left, in order, and the elements by their numbers there.
fn renumbered<const N: usize>(
    point_count: usize,
    left: &[Option<[PeriodicVertex; N]>],
) -> (Vec<u32>, Vec<[u32; N]>) {
    let mut is_left = vec![false; point_count];
    left.iter().flatten().flatten().for_each(|corner| is_left[corner.vertex as usize] = true);
    let kept: Vec<u32> =
        (0u32..).zip(is_left).filter(|(_, is_left)| *is_left).map(|(point, _)| point).collect();
    let mut numbers = vec![0; point_count];
    (0u32..).zip(&kept).for_each(|(number, point)| numbers[*point as usize] = number);
    let elements = left.iter().flatten();
    let elements = elements.map(|corners| corners.map(|corner| numbers[corner.vertex as usize])).collect();
    (kept, elements)
}
