//! The grain at the centre of every voxel of a regular grid.
//!
//! Exact on the smoothed network, or on any other surface of closed grains: rows of voxels along x are followed through the boundaries that they cross, and every
//! decision, whether a row meets a triangle and on which side of it a centre lies, is made by Shewchuk's adaptive predicates.
//! Where a row meets an edge or a point, it counts as moved by an infinitesimal in y and a yet smaller one in z; a centre on a
//! boundary counts as moved in +x. So every centre belongs to exactly one grain. The whole grains of a periodic domain are
//! looked at together with their periodic images.

use std::num::NonZeroU32;
use std::ops::Range;

use glam::DVec3;
use polycrystal::{Boundary, BoundaryId, Elements, GrainId, Side, Surface};
use rayon::prelude::*;
use robust::{Coord, Coord3D, orient2d, orient3d};
use voronoi::{Dimension, Domain};

use crate::Polycrystal;
use crate::memory::SLAB_VOXELS;

/// Voxels that a row counts for besides its own: its crossings, of which few grids have more.
const VOXELS_OF_ROW: usize = 64;

/// A grid of voxels that fills the domain. Their labels are found slab by slab, so a grid may be larger than memory.
pub struct LabelGrid<'a> {
    /// Number of voxels along each axis; 1 along z in 2D.
    pub size: [usize; 3],
    /// Corner of the grid with the smallest coordinates.
    pub origin: DVec3,
    /// Side lengths of a voxel; along z that along x in 2D.
    pub spacing: DVec3,
    cut: Cut<'a>,
    /// Rows that are labelled at the same time, at least one.
    slab_rows: usize,
    centers: Centers,
    images: Vec<DVec3>,
    /// The elements that rows cross, by first slice.
    crossed: Vec<Element>,
}

/// The surface of grains that rows cross.
struct Cut<'a> {
    points: &'a [DVec3],
    elements: Elements<'a>,
    boundary_of: &'a [BoundaryId],
    sides: Vec<[Side; 2]>,
    /// Whether there is a grain everywhere in the box.
    is_full: bool,
}

impl Cut<'_> {
    fn surface(&self) -> Surface<'_> {
        let Self { points, elements, boundary_of, sides, .. } = self;
        Surface { points, elements: *elements, boundary_of, sides }
    }
}

/// A triangle or segment in one of its images, and the slices of constant z that may cross it.
#[derive(Debug, Clone, Copy)]
struct Element {
    start: u32,
    end: u32,
    id: u32,
    image: u32,
}

/// Consecutive rows of voxels along x: whole slices, or some rows of one.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Slab {
    slices: Range<usize>,
    rows: Range<usize>,
}

/// A row passes from one side of a boundary to the other just before the centre of a voxel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Crossing {
    /// Row within its slab.
    row: u32,
    /// The first voxel whose centre lies beyond; as many as there are voxels if none does.
    voxel: u32,
    left: Side,
    entered: Side,
}

impl<'a> LabelGrid<'a> {
    /// A grid of `size` voxels; in 2D the third number is not used.
    pub fn new(polycrystal: &'a Polycrystal, size: [NonZeroU32; 3]) -> Self {
        let network = &polycrystal.network;
        let is_open = |boundary: &Boundary| {
            !boundary.is_interior() && boundary.wall.is_none() && boundary.twin.is_none()
        };
        let is_full = network.domain().is_box() && !network.boundaries().iter().any(is_open);
        let level = network.finest();
        let cut = Cut {
            points: &polycrystal.points,
            elements: level.elements(),
            boundary_of: level.labels(),
            sides: network.sides(),
            is_full,
        };
        Self::of_cut(network.domain(), cut, size)
    }

    /// A grid of `size` voxels in a box around closed grains, which may leave parts of it empty; in 2D the third number is not used.
    pub fn of_surface(domain: &Domain, surface: &Surface<'a>, size: [NonZeroU32; 3]) -> Self {
        let Surface { points, elements, boundary_of, sides } = *surface;
        Self::of_cut(
            domain,
            Cut { points, elements, boundary_of, sides: sides.to_vec(), is_full: false },
            size,
        )
    }

    fn of_cut(domain: &Domain, cut: Cut<'a>, size: [NonZeroU32; 3]) -> Self {
        let mut size = size.map(|count| count.get() as usize);
        if domain.dimension() == Dimension::Two {
            size[2] = 1;
        }
        let counts = DVec3::from_array(size.map(|count| count as f64));
        let mut spacing = domain.size() / counts;
        if domain.dimension() == Dimension::Two {
            spacing.z = spacing.x;
        }
        let centers = Centers { domain: domain.clone(), size };
        let images = images(domain);
        let crossed = crossed(&cut.surface(), &centers, &images);
        let slab_rows = (SLAB_VOXELS / (size[0] + VOXELS_OF_ROW)).max(1);
        Self { size, origin: domain.lower(), spacing, cut, slab_rows, centers, images, crossed }
    }

    /// Number of voxels.
    pub fn voxel_count(&self) -> u64 {
        self.size.iter().map(|count| *count as u64).product()
    }

    /// What the centre of each voxel is in, x fastest, then y, then z.
    pub fn labels(&self) -> Vec<Side> {
        (0..self.slab_count()).flat_map(|slab| self.slab(slab)).collect()
    }

    /// Hands over the rows of a grid in the plane, numbered from the topmost, which is the first row of a map.
    ///
    /// # Errors
    /// The first that comes back.
    pub(crate) fn rows_from_top<E>(
        &self,
        mut take: impl FnMut(usize, &[Side]) -> Result<(), E>,
    ) -> Result<(), E> {
        let mut row = 0;
        for slab in (0..self.slab_count()).rev() {
            for labels in self.slab(slab).chunks(self.size[0]).rev() {
                take(row, labels)?;
                row += 1;
            }
        }
        Ok(())
    }

    /// Number of slabs.
    pub fn slab_count(&self) -> usize {
        let [_, ny, nz] = self.size;
        if self.slices_of_slab() > 1 {
            nz.div_ceil(self.slices_of_slab())
        } else {
            nz * ny.div_ceil(self.rows_of_slab())
        }
    }

    /// The labels of a slab, in the order of [`labels`](Self::labels): its rows are found in parallel.
    pub fn slab(&self, index: usize) -> Vec<Side> {
        let slab = self.slab_at(index);
        let mut crossings = self.crossings(&slab);
        crossings.par_sort_unstable();
        let nx = self.size[0];
        let mut labels = vec![Side::Exterior; slab.slices.len() * slab.rows.len() * nx];
        (0u32..).zip(labels.chunks_mut(nx)).collect::<Vec<_>>().into_par_iter().for_each(|(row, labels)| {
            let start = crossings.partition_point(|crossing| crossing.row < row);
            let count = crossings[start..].partition_point(|crossing| crossing.row == row);
            fill_row(&crossings[start..start + count], self.cut.is_full, labels);
        });
        labels
    }

    /// Whole slices of a slab; 1 where a slab is one slice or less.
    fn slices_of_slab(&self) -> usize {
        let [_, ny, nz] = self.size;
        (self.slab_rows / ny).clamp(1, nz)
    }

    /// Rows of a slab within each of its slices.
    fn rows_of_slab(&self) -> usize {
        self.slab_rows.min(self.size[1])
    }

    fn slab_at(&self, index: usize) -> Slab {
        let [_, ny, nz] = self.size;
        let (slices, rows) = (self.slices_of_slab(), self.rows_of_slab());
        if slices > 1 {
            return Slab { slices: index * slices..((index + 1) * slices).min(nz), rows: 0..ny };
        }
        let of_slice = ny.div_ceil(rows);
        let (slice, first) = (index / of_slice, index % of_slice * rows);
        Slab { slices: slice..slice + 1, rows: first..(first + rows).min(ny) }
    }

    /// All crossings of a slab's rows with boundaries.
    fn crossings(&self, slab: &Slab) -> Vec<Crossing> {
        let surface = self.cut.surface();
        let candidates = &self.crossed
            [..self.crossed.partition_point(|element| (element.start as usize) < slab.slices.end)];
        let candidates = candidates.par_iter().filter(|element| (element.end as usize) > slab.slices.start);
        let of_element = |element: &Element| {
            let sides = surface.sides_of(element.id);
            let at = |point: u32| surface.points[point as usize] + self.images[element.image as usize];
            let corners = surface.elements.corners(element.id);
            match *corners {
                [a, b] => segment_crossings(&self.centers, slab, [a, b].map(at), sides),
                _ => {
                    let corners = [0, 1, 2].map(|k| at(corners[k]));
                    let slices = slab.slices.start.max(element.start as usize)
                        ..slab.slices.end.min(element.end as usize);
                    slices
                        .flat_map(|slice| triangle_crossings(&self.centers, slab, slice, corners, sides))
                        .collect()
                }
            }
        };
        candidates.flat_map_iter(of_element).collect()
    }
}

/// All elements in all images that a slice may cross, by first slice.
fn crossed(surface: &Surface<'_>, centers: &Centers, images: &[DVec3]) -> Vec<Element> {
    let elements = surface.elements;
    let count = u32::try_from(elements.len()).expect("ids of elements fit 32 bits");
    let last = [0, 1].map(|axis| centers.coordinate(axis, centers.size[axis] - 1));
    let of_image = |(image, offset): (u32, &DVec3)| {
        let found = (0..count).into_par_iter().filter_map(move |id| {
            let corners = elements.corners(id);
            let corners = corners.iter().map(|corner| surface.points[*corner as usize] + *offset);
            let bounds =
                |(lower, upper): (DVec3, DVec3), corner: DVec3| (lower.min(corner), upper.max(corner));
            let (lower, upper) = corners.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), bounds);
            let (start, end) = match elements.dimension() {
                Dimension::Two => (0, 1),
                Dimension::Three => {
                    let end = (centers.first_at(2, upper.z) + 1).min(centers.size[2]);
                    (centers.first_at(2, lower.z).min(end), end)
                }
            };
            let is_met = start < end && lower.y <= last[1] && upper.y >= centers.coordinate(1, 0);
            // What lies before the first centre of a row matters: it tells where the row begins.
            let is_met = is_met && lower.x <= last[0];
            is_met.then(|| Element { start: index(start), end: index(end), id, image })
        });
        found.collect::<Vec<_>>()
    };
    let mut elements: Vec<Element> = (0u32..).zip(images).flat_map(of_image).collect();
    elements.par_sort_unstable_by_key(|element| (element.start, element.id, element.image));
    elements
}

/// A number of voxels along an axis, or of rows in a slab.
fn index(number: usize) -> u32 {
    u32::try_from(number).expect("an axis has no more than 2^32 voxels, and a slab no more rows")
}

/// Where the centres of voxels are.
struct Centers {
    domain: Domain,
    size: [usize; 3],
}

impl Centers {
    fn coordinate(&self, axis: usize, voxel: usize) -> f64 {
        let (lower, upper) = (self.domain.lower()[axis], self.domain.upper()[axis]);
        let part = (voxel as f64 + 0.5) / self.size[axis] as f64;
        lower + part * (upper - lower)
    }

    /// The first voxel whose centre is at `value` or beyond.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "casts of numbers beyond the range end at its ends"
    )]
    fn first_at(&self, axis: usize, value: f64) -> usize {
        let count = self.size[axis];
        let (lower, upper) = (self.domain.lower()[axis], self.domain.upper()[axis]);
        let guess = (value - lower) / (upper - lower) * count as f64 - 0.5;
        // Casting puts what is below the grid to 0; the guess is off by one at most.
        let mut voxel = (guess as usize).saturating_sub(1).min(count);
        while voxel < count && self.coordinate(axis, voxel) < value {
            voxel += 1;
        }
        voxel
    }
}

/// Where grains stand beside their own place: a whole grain reaches less than a period beyond the domain.
fn images(domain: &Domain) -> Vec<DVec3> {
    let size = domain.size();
    let mut images = vec![DVec3::ZERO];
    for axis in (0..3).filter(|axis| domain.periodic().test(*axis)) {
        let period = DVec3::AXES[axis] * size[axis];
        images = images.into_iter().flat_map(|image| [image - period, image, image + period]).collect();
    }
    images
}

/// The crossings of a triangle with the rows of a slab in one slice.
fn triangle_crossings(
    centers: &Centers,
    slab: &Slab,
    slice: usize,
    corners: [DVec3; 3],
    sides: [Side; 2],
) -> Vec<Crossing> {
    let z = centers.coordinate(2, slice);
    let [a, b, c] = corners.map(|corner| Coord { x: corner.y, y: corner.z });
    let area = orient2d(a, b, c);
    if area == 0.0 {
        return Vec::new();
    }
    let [y0, y1, y2] = corners.map(|corner| corner.y);
    let rows = centers.first_at(1, y0.min(y1).min(y2)).max(slab.rows.start)..slab.rows.end;
    let last = y0.max(y1).max(y2);
    let [x0, x1, x2] = corners.map(|corner| corner.x);
    let rows = rows.map(|row| (row, centers.coordinate(1, row))).take_while(|(_, y)| *y <= last);
    rows.filter(|(_, y)| {
        let row = Coord { x: *y, y: z };
        [[a, b], [b, c], [c, a]].into_iter().all(|[from, to]| is_left(from, to, row) == (area > 0.0))
    })
    .map(|(row, y)| {
        // Seen along x, a triangle that winds counter-clockwise has its first side at smaller x.
        let is_beyond = |voxel: usize| {
            let center = Coord3D { x: centers.coordinate(0, voxel), y, z };
            let [a, b, c] = corners.map(|corner| Coord3D { x: corner.x, y: corner.y, z: corner.z });
            // Positive where the centre lies below the plane of counter-clockwise corners: on the first side.
            let first_side = orient3d(a, b, c, center);
            if area > 0.0 { first_side <= 0.0 } else { first_side >= 0.0 }
        };
        let range = centers.first_at(0, x0.min(x1).min(x2))..centers.first_at(0, x0.max(x1).max(x2));
        let row = (slice - slab.slices.start) * slab.rows.len() + row - slab.rows.start;
        crossing(centers, row, range, is_beyond, sides, area > 0.0)
    })
    .collect()
}

/// The crossings of a slab's rows with a segment in the plane.
fn segment_crossings(
    centers: &Centers,
    slab: &Slab,
    [start, end]: [DVec3; 2],
    sides: [Side; 2],
) -> Vec<Crossing> {
    let [a, b] = [start, end].map(|end| Coord { x: end.x, y: end.y });
    // A row on a point counts as moved in +y, so it is not on the lower end of a segment that begins there.
    let rows = centers.first_at(1, start.y.min(end.y)).max(slab.rows.start)..slab.rows.end;
    let rows = rows.map(|row| (row, centers.coordinate(1, row)));
    let upward = start.y < end.y;
    rows.take_while(|(_, y)| *y < start.y.max(end.y))
        .map(|(row, y)| {
            let is_beyond = |voxel: usize| {
                let left = orient2d(a, b, Coord { x: centers.coordinate(0, voxel), y });
                // Right of a segment that goes up lies +x.
                if upward { left <= 0.0 } else { left >= 0.0 }
            };
            let range = centers.first_at(0, start.x.min(end.x))..centers.first_at(0, start.x.max(end.x));
            crossing(centers, row - slab.rows.start, range, is_beyond, sides, upward)
        })
        .collect()
}

/// The crossing of a row with an element whose normal points along +x or not. Outside of `range`, the voxels that the
/// element extends over, all is known.
fn crossing(
    centers: &Centers,
    row: usize,
    range: Range<usize>,
    is_beyond: impl Fn(usize) -> bool,
    sides: [Side; 2],
    is_forward: bool,
) -> Crossing {
    // The centre at the end of the range may lie exactly on the element's last corner.
    let end = (range.end + 1).min(centers.size[0]);
    let mut voxel = range.start.min(end);
    while voxel < end && !is_beyond(voxel) {
        voxel += 1;
    }
    let [first, second] = sides;
    let (left, entered) = if is_forward { (first, second) } else { (second, first) };
    Crossing { row: index(row), voxel: index(voxel), left, entered }
}

/// Whether `row`, moved by an infinitesimal in y and a yet smaller one in z, lies left of the line through two points.
fn is_left(from: Coord<f64>, to: Coord<f64>, row: Coord<f64>) -> bool {
    let side = orient2d(from, to, row);
    if side != 0.0 {
        side > 0.0
    } else if from.y != to.y {
        from.y > to.y
    } else {
        to.x > from.x
    }
}

/// The labels of a row. Between two centres it may cross several boundaries, in an order that does not matter: it is
/// in the grain that it has entered once more than it has left, or in none where grains do not fill the box.
fn fill_row(crossings: &[Crossing], is_full: bool, labels: &mut [Side]) {
    let mut crossings = crossings.iter().peekable();
    // Grains that the row is in, and how often: more than one only where images of grains round differently.
    let mut counts: Vec<(GrainId, i32)> = Vec::new();
    // Between images that round differently there may be a gap: it goes to the grain before, or at the start to the one after.
    let mut before = Side::Exterior;
    for voxel in 0..labels.len() {
        while let Some(crossing) = crossings.next_if(|crossing| crossing.voxel as usize <= voxel) {
            add(&mut counts, crossing.left, -1);
            add(&mut counts, crossing.entered, 1);
        }
        counts.retain(|(_, count)| *count != 0);
        match counts.iter().max_by_key(|(_, count)| *count) {
            Some((grain, _)) => {
                let label = Side::Grain(*grain);
                if is_full && before == Side::Exterior {
                    labels[..voxel].fill(label);
                }
                (before, labels[voxel]) = (label, label);
            }
            None => labels[voxel] = if is_full { before } else { Side::Exterior },
        }
    }
}

fn add(counts: &mut Vec<(GrainId, i32)>, side: Side, change: i32) {
    let Side::Grain(grain) = side else { return };
    match counts.iter_mut().find(|(other, _)| *other == grain) {
        Some((_, count)) => *count += change,
        None => counts.push((grain, change)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Config, SeedSource, make_polycrystal};

    #[test]
    fn labels_are_the_same_in_slabs_of_any_size() {
        for (dimension, periodic) in [
            (Dimension::Two, glam::BVec3::FALSE),
            (Dimension::Three, glam::BVec3::FALSE),
            (Dimension::Three, glam::BVec3::TRUE),
        ] {
            let seeds = SeedSource::Random { count: 8 };
            let config = Config { seeds, dimension, periodic, levels: 1, ..Config::default() };
            let polycrystal = make_polycrystal(&config, &|_, _, _| ()).unwrap();
            let size = [11, 7, 5].map(|count| NonZeroU32::new(count).unwrap());
            let mut grid = LabelGrid::new(&polycrystal, size);
            let whole = grid.labels();
            assert_eq!((grid.slab_count(), whole.len() as u64), (1, grid.voxel_count()));
            // A row, two rows, a slice, three slices.
            for slab_rows in [1, 2, 7, 21] {
                grid.slab_rows = slab_rows;
                assert!(grid.slab_count() > 1 || (dimension == Dimension::Two && slab_rows >= 7));
                assert_eq!(grid.labels(), whole, "{slab_rows}");
            }
        }
    }
}
