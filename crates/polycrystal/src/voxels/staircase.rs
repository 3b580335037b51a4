//! The boundaries of voxels as they are: a square for each face between different labels (in the plane: a segment).

use glam::UVec3;
use rayon::prelude::*;
use voronoi::{CellId, Translation, Wall};

use crate::mesh::id::id;
use crate::voxels::labels::{Grid, OUTSIDE, VoxelLabel};
use crate::voxels::lattice::{Lattice, MixedPlace, Place};
use crate::voxels::pattern::quarter;
use crate::{GrainId, Side};

/// Points and faces of the boundaries between voxels.
///
/// The points of a surface net, one between eight voxels, joined by the faces between these are the same complex as the faces themselves (Frisken, 2022).
pub(super) struct Staircase {
    /// The [`Place`] of each point.
    pub(super) places: Vec<UVec3>,
    pub(super) faces: Faces,
    /// By how many periods each face is moved from its place in the box to where its first side is whole; nothing where the lattice has no periods.
    pub(super) moved: Vec<Translation>,
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
    pub(super) wall: Option<u8>,
    /// By how many periods the second side is moved, as the first side sees it.
    pub(super) beyond: Translation,
}

impl Kind {
    /// What lies on both sides.
    pub(super) fn sides(&self) -> [Side; 2] {
        self.labels.map(|label| VoxelLabel(label).side())
    }

    /// The same as cells have it, seen from where the first is whole.
    pub(super) fn cell_sides(&self) -> [voronoi::Side; 2] {
        let wall = Wall::numbered(self.wall.map_or(OPEN_WALL, u32::from));
        let [first, second] = self.sides().map(|side| match side {
            Side::Grain(GrainId(grain)) => voronoi::Side::Cell(CellId(grain)),
            Side::Exterior => voronoi::Side::Wall(wall),
        });
        [first, second.moved(self.beyond)]
    }
}

/// The sides of kinds of faces as they are where their first sides are whole, and, where a lattice has periods, of their copies where the second ones are:
/// what is periods away counts as outside.
pub(super) fn sides_of_whole_grains(kinds: &[Kind], is_periodic: bool) -> Vec<[Side; 2]> {
    let apart = |kind: &Kind| kind.beyond != Translation::ZERO;
    let of_first = |kind: &Kind| {
        let [first, second] = kind.sides();
        [first, if apart(kind) { Side::Exterior } else { second }]
    };
    let of_second = |kind: &Kind| [Side::Exterior, kind.sides()[1]];
    let copies = kinds.iter().filter(|_| is_periodic).map(of_second);
    kinds.iter().map(of_first).chain(copies).collect()
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

/// Stands for the surface of pores, and of a body that does not fill the box, as a wall. Those of the box have smaller numbers.
const OPEN_WALL: u32 = 6;

/// No point is at a place.
const NONE: u32 = u32::MAX;

impl Staircase {
    /// `whole` has by how much voxels are moved so that grains are whole.
    pub(super) fn new(lattice: &Lattice<'_>, mixed: &[Vec<MixedPlace>], whole: &[Translation]) -> Self {
        let numbering = Numbering::new(lattice, mixed);
        let mut places = Vec::with_capacity(numbering.count);
        for mixed in mixed.iter().flatten() {
            let place = UVec3::from_array(mixed.place.map(id));
            places.extend((0..mixed.copies.count).map(|_| place));
        }
        let [_, height, depth] = lattice.shape;
        let (faces, found) = if lattice.is_plane {
            let rows = (0..height).into_par_iter().map(|y| segments_of_row(lattice, &numbering, whole, y));
            let (segments, found): (Vec<_>, Vec<_>) = rows.flatten().unzip();
            (Faces::Segments(segments), found)
        } else {
            let planes = (0..depth).into_par_iter().map(|z| squares_of_plane(lattice, &numbering, whole, z));
            let (squares, found): (Vec<_>, Vec<_>) = planes.flatten().unzip();
            (Faces::Squares(squares), found)
        };
        let mut kinds: Vec<Kind> = found.par_iter().map(|(kind, _)| *kind).collect();
        kinds.par_sort_unstable();
        kinds.dedup();
        let number = |(kind, _): &(Kind, _)| id(kinds.binary_search(kind).expect("all are listed"));
        let kind_of = found.par_iter().map(number).collect();
        let moved =
            if whole.is_empty() { Vec::new() } else { found.iter().map(|(_, moved)| *moved).collect() };
        Self { places, faces, moved, kind_of, kinds }
    }

    /// By how many periods a corner of a face is moved where the first side of the face is whole. Corners at the first places may belong behind the last.
    pub(super) fn corner_moved(&self, grid: &Grid, face: usize, corner: usize) -> Translation {
        let Some(moved) = self.moved.get(face) else { return Translation::ZERO };
        let corners = self.faces.corners(face);
        let at = |corner: u32, axis: usize| self.places[corner as usize][axis] as usize;
        let behind = |axis: usize| {
            let last = grid.shape[axis] - 1;
            grid.domain.periodic().test(axis)
                && at(corners[corner], axis) == 0
                && corners.iter().any(|other| at(*other, axis) == last)
        };
        *moved + Translation(std::array::from_fn(|axis| i8::from(behind(axis))))
    }
}

/// The points at each place.
struct Numbering<'a> {
    /// Number of places along each axis.
    size: [usize; 3],
    /// The first point at each place; [`NONE`] where there is none.
    first: Vec<u32>,
    /// Those with several, in order.
    several: Vec<&'a MixedPlace>,
    count: usize,
}

impl<'a> Numbering<'a> {
    fn new(lattice: &Lattice<'_>, mixed: &'a [Vec<MixedPlace>]) -> Self {
        let size = [0, 1, 2].map(|axis| lattice.place_count(axis));
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

    /// The number of a place. Along a period that behind the last is the first.
    fn at(&self, place: Place) -> usize {
        let [x, y, z] = [0, 1, 2].map(|axis| if place[axis] == self.size[axis] { 0 } else { place[axis] });
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
fn squares_of_plane(
    lattice: &Lattice<'_>,
    numbering: &Numbering<'_>,
    whole: &[Translation],
    z: usize,
) -> Vec<([u32; 4], (Kind, Translation))> {
    let [width, height, _] = lattice.shape;
    let mut found = Vec::new();
    for y in 0..height {
        for x in 0..width {
            for_faces(lattice, whole, [x, y, z], 3, |axis, place, sides| {
                let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
                let corner = |up_u: usize, up_v: usize| {
                    let mut at = place;
                    at[u] += up_u;
                    at[v] += up_v;
                    // Seen from a corner, the face lies on the other side along both axes.
                    numbering.point(at, quarter(axis, (1 - up_u) << u | (1 - up_v) << v))
                };
                let [a, b, c, d] = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
                let corners = if sides.is_lower_first() { [a, b, c, d] } else { [a, d, c, b] };
                found.push((corners, sides.kind()));
            });
        }
    }
    found
}

fn segments_of_row(
    lattice: &Lattice<'_>,
    numbering: &Numbering<'_>,
    whole: &[Translation],
    y: usize,
) -> Vec<([u32; 2], (Kind, Translation))> {
    let mut found = Vec::new();
    for x in 0..lattice.shape[0] {
        for_faces(lattice, whole, [x, y, 0], 2, |axis, place, sides| {
            let along = 1 - axis;
            let mut end = place;
            end[along] += 1;
            // Edges at a point are numbered down, right, up, left.
            let [at_start, at_end] = if along == 1 { [2, 0] } else { [1, 3] };
            let ends = [numbering.point(place, at_start), numbering.point(end, at_end)];
            // Upward the lower side lies left, to the right the upper one.
            let is_lower_left = along == 1;
            let ends = if is_lower_left == sides.is_lower_first() { ends } else { [ends[1], ends[0]] };
            found.push((ends, sides.kind()));
        });
    }
    found
}

/// What lies below and above a face.
struct FaceSides {
    labels: [u32; 2],
    /// By how many periods each is moved where it is whole, as seen from the place of the face in the box.
    moved: [Translation; 2],
    wall: Option<u8>,
}

impl FaceSides {
    fn is_lower_first(&self) -> bool {
        self.labels[0] < self.labels[1]
    }

    /// The kind of the face, and by how many periods it is moved where its first side is whole.
    fn kind(&self) -> (Kind, Translation) {
        let Self { labels: [lower, upper], moved: [below, above], wall } = *self;
        if self.is_lower_first() {
            (Kind { labels: [lower, upper], wall, beyond: below - above }, below)
        } else {
            (Kind { labels: [upper, lower], wall, beyond: above - below }, above)
        }
    }
}

/// The faces below a voxel along each axis, and above the last voxels, by axis, lower corner and sides; those between different labels.
fn for_faces(
    lattice: &Lattice<'_>,
    whole: &[Translation],
    voxel: Place,
    axes: usize,
    mut each: impl FnMut(usize, Place, FaceSides),
) {
    let [width, height, _] = lattice.shape;
    let strides = [1, width, width * height];
    let number = voxel[0] + strides[1] * voxel[1] + strides[2] * voxel[2];
    let own = lattice.labels[number].0;
    let moved = |voxel: usize| whole.get(voxel).copied().unwrap_or(Translation::ZERO);
    for (axis, wall) in (0..axes).zip([0, 2, 4]) {
        let is_first = voxel[axis] == 0;
        let is_periodic = lattice.periodic[axis];
        let (before, below) = if !is_first {
            let before = number - strides[axis];
            (lattice.labels[before].0, moved(before))
        } else if is_periodic {
            // The last voxel stands a period below.
            let before = number + strides[axis] * (lattice.shape[axis] - 1);
            let mut step = Translation::ZERO;
            step.0[axis] = 1;
            (lattice.labels[before].0, moved(before) + step)
        } else {
            (OUTSIDE, moved(number))
        };
        if before != own {
            let wall = (is_first && !is_periodic).then_some(wall);
            each(axis, voxel, FaceSides { labels: [before, own], moved: [below, moved(number)], wall });
        }
        if voxel[axis] + 1 == lattice.shape[axis] && !is_periodic && own != OUTSIDE {
            let mut place = voxel;
            place[axis] += 1;
            let sides = FaceSides { labels: [own, OUTSIDE], moved: [moved(number); 2], wall: Some(wall + 1) };
            each(axis, place, sides);
        }
    }
}
