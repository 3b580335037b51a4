//! The grain at the centre of every voxel of a regular grid.
//!
//! Exact on the smoothed network: rows of voxels along x are followed through the boundaries that they cross, and every
//! decision, whether a row meets a triangle and on which side of it a centre lies, is made by Shewchuk's adaptive predicates.
//! Where a row meets an edge or a point, it counts as moved by an infinitesimal in y and a yet smaller one in z; a centre on a
//! boundary counts as moved in +x. So every centre belongs to exactly one grain.

use std::num::NonZeroU32;

use glam::DVec3;
use polycrystal::{Boundary, GrainId, Mesh, Side};
use rayon::prelude::*;
use robust::{Coord, Coord3D, orient2d, orient3d};
use voronoi::{Dimension, Domain};

use crate::Polycrystal;

/// Labels of a grid of voxels that fills the domain.
#[derive(Debug, Clone, PartialEq)]
pub struct LabelGrid {
    /// Number of voxels along each axis; 1 along z in 2D.
    pub size: [usize; 3],
    /// Corner of the grid with the smallest coordinates.
    pub origin: DVec3,
    /// Side lengths of a voxel; along z that along x in 2D.
    pub spacing: DVec3,
    /// The grain of each voxel's centre, x fastest, then y, then z.
    pub labels: Vec<GrainId>,
}

/// A row passes from one side of a boundary to the other just before the centre of a voxel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Crossing {
    /// Row within its slice.
    row: usize,
    /// The first voxel whose centre lies beyond; as many as there are voxels if none does.
    voxel: usize,
    left: Side,
    entered: Side,
}

impl LabelGrid {
    /// Labels `size` voxels, slices in parallel; in 2D the third number is not used.
    ///
    /// # Panics
    /// When the network does not fill the domain, which validation rules out.
    pub fn new(polycrystal: &Polycrystal, size: [NonZeroU32; 3]) -> Self {
        let domain = polycrystal.network.domain();
        let mut size = size.map(|count| count.get() as usize);
        if domain.dimension() == Dimension::Two {
            size[2] = 1;
        }
        let counts = DVec3::from_array(size.map(|count| count as f64));
        let mut spacing = domain.size() / counts;
        if domain.dimension() == Dimension::Two {
            spacing.z = spacing.x;
        }
        let centers = Centers { domain: *domain, size };
        let crossings = crossings_by_slice(polycrystal, &centers);
        let slices: Vec<Vec<GrainId>> =
            crossings.into_par_iter().map(|crossings| fill_slice(size, crossings)).collect();
        Self { size, origin: domain.lower(), spacing, labels: slices.concat() }
    }
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

/// All crossings of rows with boundaries, for each slice of constant z.
fn crossings_by_slice(polycrystal: &Polycrystal, centers: &Centers) -> Vec<Vec<Crossing>> {
    let level = polycrystal.network.finest();
    let boundaries = polycrystal.network.boundaries();
    let points = &polycrystal.points;
    let boundary = |element: usize| &boundaries[level.boundary_of[element].index()];
    match &level.mesh {
        Mesh::Segments(mesh) => {
            let ends = |element: usize| mesh.segments()[element].map(|point| points[point as usize]);
            let all = 0..mesh.segments().len();
            vec![
                all.flat_map(|element| segment_crossings(centers, ends(element), boundary(element)))
                    .collect(),
            ]
        }
        Mesh::Triangles(mesh) => {
            let corners =
                |element: u32| mesh.triangles()[element as usize].map(|point| points[point as usize]);
            let slices = |element: u32| {
                let [a, b, c] = corners(element).map(|corner| corner.z);
                let last = centers.first_at(2, a.max(b).max(c));
                centers.first_at(2, a.min(b).min(c))..(last + 1).min(centers.size[2])
            };
            let elements = 0..u32::try_from(mesh.triangles().len()).expect("ids of triangles fit 32 bits");
            let mut of_slice = vec![Vec::new(); centers.size[2]];
            for element in elements {
                of_slice[slices(element)].iter_mut().for_each(|slice: &mut Vec<u32>| slice.push(element));
            }
            let crossings = of_slice.into_par_iter().enumerate().map(|(slice, elements)| {
                let of_triangle = |&element: &u32| {
                    triangle_crossings(centers, slice, corners(element), boundary(element as usize))
                };
                elements.iter().flat_map(of_triangle).collect()
            });
            crossings.collect()
        }
    }
}

/// The crossings of a slice's rows with a triangle.
fn triangle_crossings(
    centers: &Centers,
    slice: usize,
    corners: [DVec3; 3],
    boundary: &Boundary,
) -> Vec<Crossing> {
    let z = centers.coordinate(2, slice);
    let [a, b, c] = corners.map(|corner| Coord { x: corner.y, y: corner.z });
    let area = orient2d(a, b, c);
    if area == 0.0 {
        return Vec::new();
    }
    let [y0, y1, y2] = corners.map(|corner| corner.y);
    let rows = centers.first_at(1, y0.min(y1).min(y2))..centers.size[1];
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
        crossing(centers, row, range, is_beyond, boundary, area > 0.0)
    })
    .collect()
}

/// The crossings of rows with a segment in the plane.
fn segment_crossings(centers: &Centers, [start, end]: [DVec3; 2], boundary: &Boundary) -> Vec<Crossing> {
    let [a, b] = [start, end].map(|end| Coord { x: end.x, y: end.y });
    // A row on a point counts as moved in +y, so it is not on the lower end of a segment that begins there.
    let rows = centers.first_at(1, start.y.min(end.y))..centers.size[1];
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
            crossing(centers, row, range, is_beyond, boundary, upward)
        })
        .collect()
}

/// The crossing of a row with an element whose normal points along +x or not. Outside of `range`, the voxels that the
/// element extends over, all is known.
fn crossing(
    centers: &Centers,
    row: usize,
    range: std::ops::Range<usize>,
    is_beyond: impl Fn(usize) -> bool,
    boundary: &Boundary,
    is_forward: bool,
) -> Crossing {
    // The centre at the end of the range may lie exactly on the element's last corner.
    let end = (range.end + 1).min(centers.size[0]);
    let mut voxel = range.start.min(end);
    while voxel < end && !is_beyond(voxel) {
        voxel += 1;
    }
    let [first, second] = boundary.sides;
    let (left, entered) = if is_forward { (first, second) } else { (second, first) };
    Crossing { row, voxel, left, entered }
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

/// The labels of a slice. Between two centres a row may cross several boundaries, in an order that does not matter: it is
/// in the grain that it has entered once more than it has left.
fn fill_slice(size: [usize; 3], mut crossings: Vec<Crossing>) -> Vec<GrainId> {
    crossings.sort_unstable();
    let mut crossings = crossings.into_iter().peekable();
    let mut labels = Vec::with_capacity(size[0] * size[1]);
    for row in 0..size[1] {
        let mut current = Side::Exterior;
        for voxel in 0..size[0] {
            let mut counts = vec![(current, 1)];
            while let Some(Crossing { left, entered, .. }) =
                crossings.next_if(|crossing| (crossing.row, crossing.voxel) <= (row, voxel))
            {
                add(&mut counts, left, -1);
                add(&mut counts, entered, 1);
            }
            current = counts.iter().find(|(_, count)| *count == 1).map_or(current, |(side, _)| *side);
            let Side::Grain(grain) = current else { panic!("the network does not fill the domain") };
            labels.push(grain);
        }
        // What lies beyond the last centre.
        while crossings.next_if(|crossing| crossing.row <= row).is_some() {}
    }
    labels
}

fn add(counts: &mut Vec<(Side, i32)>, side: Side, change: i32) {
    match counts.iter_mut().find(|(other, _)| *other == side) {
        Some((_, count)) => *count += change,
        None => counts.push((side, change)),
    }
}
