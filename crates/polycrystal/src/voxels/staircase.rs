//! The boundaries of voxels as they are: a square for each face between different labels (in the plane: a segment).

use rayon::prelude::*;

use crate::Side;
use crate::mesh::id::id;
use crate::voxels::labels::{OUTSIDE, VoxelLabel};
use crate::voxels::lattice::{Lattice, MixedPlace, Place};
use crate::voxels::pattern::quarter;

/// Points and faces of the boundaries between voxels.
///
/// The points of a surface net, one between eight voxels, joined by the faces between these are the same complex as the faces themselves (Frisken, 2022).
pub(super) struct Staircase {
    /// Where each point is.
    pub(super) places: Vec<Place>,
    pub(super) faces: Faces,
    /// The kind of each face.
    pub(super) kind_of: Vec<u32>,
    /// What lies on both sides, the smaller first and the outside last, and the wall; sorted.
    pub(super) kinds: Vec<Kind>,
}

pub(super) enum Faces {
    /// Counter-clockwise as seen from the second side.
    Squares(Vec<[u32; 4]>),
    /// The first side on the left.
    Segments(Vec<[u32; 2]>),
}

/// The labels on both sides of a face, and the number of the wall that it lies on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Kind {
    pub(super) labels: [u32; 2],
    pub(super) wall: Option<u32>,
}

impl Kind {
    /// What lies on both sides.
    pub(super) fn sides(&self) -> [Side; 2] {
        self.labels.map(|label| VoxelLabel(label).side())
    }
}

impl Faces {
    pub(super) fn len(&self) -> usize {
        match self {
            Self::Squares(squares) => squares.len(),
            Self::Segments(segments) => segments.len(),
        }
    }

    pub(super) fn corners(&self, face: usize) -> &[u32] {
        match self {
            Self::Squares(squares) => &squares[face],
            Self::Segments(segments) => &segments[face],
        }
    }
}

/// No point is at a place.
const NONE: u32 = u32::MAX;

impl Staircase {
    pub(super) fn new(lattice: &Lattice, mixed: &[Vec<MixedPlace>]) -> Self {
        let numbering = Numbering::new(lattice, mixed);
        let mut places = Vec::with_capacity(numbering.count);
        for mixed in mixed.iter().flatten() {
            places.extend((0..mixed.copies.count).map(|_| mixed.place));
        }
        let [_, height, depth] = lattice.shape;
        let (faces, kinds) = if lattice.is_plane {
            let rows = (0..height).into_par_iter().map(|y| segments_of_row(lattice, &numbering, y));
            let (segments, kinds): (Vec<_>, Vec<_>) = rows.flatten().unzip();
            (Faces::Segments(segments), kinds)
        } else {
            let planes = (0..depth).into_par_iter().map(|z| squares_of_plane(lattice, &numbering, z));
            let (squares, kinds): (Vec<_>, Vec<_>) = planes.flatten().unzip();
            (Faces::Squares(squares), kinds)
        };
        let mut sorted: Vec<Kind> = kinds.clone();
        sorted.par_sort_unstable();
        sorted.dedup();
        let number = |kind: &Kind| id(sorted.binary_search(kind).expect("all are listed"));
        Self { places, faces, kind_of: kinds.par_iter().map(number).collect(), kinds: sorted }
    }
}

/// The points at each place.
struct Numbering<'a> {
    /// One more than the number of voxels along each axis.
    size: [usize; 3],
    /// The first point at each place; [`NONE`] where there is none.
    first: Vec<u32>,
    /// Those with several, in order.
    several: Vec<&'a MixedPlace>,
    count: usize,
}

impl<'a> Numbering<'a> {
    fn new(lattice: &Lattice, mixed: &'a [Vec<MixedPlace>]) -> Self {
        let size = lattice.shape.map(|count| count + 1);
        let mut numbering =
            Self { size, first: vec![NONE; size.iter().product()], several: Vec::new(), count: 0 };
        for mixed in mixed.iter().flatten() {
            let at = numbering.at(mixed.place);
            numbering.first[at] = id(numbering.count);
            numbering.count += usize::from(mixed.copies.count);
            if mixed.copies.count > 1 {
                numbering.several.push(mixed);
            }
        }
        numbering
    }

    fn at(&self, [x, y, z]: Place) -> usize {
        (z * self.size[1] + y) * self.size[0] + x
    }

    /// The point at a place that a quarter face belongs to.
    fn point(&self, place: Place, quarter: usize) -> u32 {
        let at = self.at(place);
        let found = self.several.binary_search_by_key(&at, |mixed| self.at(mixed.place));
        let copy = found.map_or(0, |found| self.several[found].copies.of_quarters[quarter]);
        self.first[at] + u32::from(copy)
    }
}

/// The faces below, left and in front of the voxels of a plane, and behind the last ones.
fn squares_of_plane(lattice: &Lattice, numbering: &Numbering<'_>, z: usize) -> Vec<([u32; 4], Kind)> {
    let [width, height, _] = lattice.shape;
    let mut found = Vec::new();
    for y in 0..height {
        for x in 0..width {
            for_faces(lattice, [x, y, z], 3, |axis, place, labels, wall| {
                let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
                let corner = |up_u: usize, up_v: usize| {
                    let mut at = place;
                    at[u] += up_u;
                    at[v] += up_v;
                    // Seen from a corner, the face lies on the other side along both axes.
                    numbering.point(at, quarter(axis, (1 - up_u) << u | (1 - up_v) << v))
                };
                let [a, b, c, d] = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
                let [lower, upper] = labels;
                if lower < upper {
                    found.push(([a, b, c, d], Kind { labels, wall }));
                } else {
                    found.push(([a, d, c, b], Kind { labels: [upper, lower], wall }));
                }
            });
        }
    }
    found
}

fn segments_of_row(lattice: &Lattice, numbering: &Numbering<'_>, y: usize) -> Vec<([u32; 2], Kind)> {
    let mut found = Vec::new();
    for x in 0..lattice.shape[0] {
        for_faces(lattice, [x, y, 0], 2, |axis, place, labels, wall| {
            let along = 1 - axis;
            let mut end = place;
            end[along] += 1;
            // Edges at a point are numbered down, right, up, left.
            let [at_start, at_end] = if along == 1 { [2, 0] } else { [1, 3] };
            let ends = [numbering.point(place, at_start), numbering.point(end, at_end)];
            let [lower, upper] = labels;
            // Upward the lower side lies left, to the right the upper one.
            let is_lower_left = along == 1;
            let is_lower_first = lower < upper;
            let ends = if is_lower_left == is_lower_first { ends } else { [ends[1], ends[0]] };
            let labels = if is_lower_first { labels } else { [upper, lower] };
            found.push((ends, Kind { labels, wall }));
        });
    }
    found
}

/// The faces below a voxel along each axis, and above the last voxels, by axis, lower corner, labels below and above, and wall; those between different labels.
fn for_faces(
    lattice: &Lattice,
    voxel: Place,
    axes: usize,
    mut each: impl FnMut(usize, Place, [u32; 2], Option<u32>),
) {
    let [width, height, _] = lattice.shape;
    let strides = [1, width, width * height];
    let number = voxel[0] + strides[1] * voxel[1] + strides[2] * voxel[2];
    let own = lattice.labels[number];
    for axis in 0..axes {
        let is_first = voxel[axis] == 0;
        let before = if is_first { OUTSIDE } else { lattice.labels[number - strides[axis]] };
        let wall = id(2 * axis);
        if before != own {
            each(axis, voxel, [before, own], is_first.then_some(wall));
        }
        if voxel[axis] + 1 == lattice.shape[axis] && own != OUTSIDE {
            let mut place = voxel;
            place[axis] += 1;
            each(axis, place, [own, OUTSIDE], Some(wall + 1));
        }
    }
}
