//! The grain at the centre of every voxel of a regular grid.
//!
//! Exact on the smoothed network: rows of voxels along x are followed through the boundaries that they cross, and every
//! decision, whether a row meets a triangle and on which side of it a centre lies, is made by Shewchuk's adaptive predicates.
//! Where a row meets an edge or a point, it counts as moved by an infinitesimal in y and a yet smaller one in z; a centre on a
//! boundary counts as moved in +x. So every centre belongs to exactly one grain. The whole grains of a periodic domain are
//! looked at together with their images a period away.

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
    /// What the centre of each voxel is in, x fastest, then y, then z.
    pub labels: Vec<Side>,
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
        let centers = Centers { domain: domain.clone(), size };
        let crossings = crossings_by_slice(polycrystal, &centers);
        let fills_box = domain.is_box();
        let slices: Vec<Vec<Side>> =
            crossings.into_par_iter().map(|crossings| fill_slice(size, fills_box, crossings)).collect();
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
    #[expect(clippy::cast_possible_truncation, reason = "casts of numbers beyond the range end at its ends")]
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
    let boundary =
        |element: u32| &polycrystal.network.boundaries()[level.boundary_of[element as usize].index()];
    let images = images(polycrystal.network.domain());
    let at = |point: u32, image: usize| polycrystal.points[point as usize] + images[image];
    let count = u32::try_from(level.element_count()).expect("ids of elements fit 32 bits");
    let all = (0..images.len()).flat_map(|image| (0..count).map(move |element| (element, image)));
    match &level.mesh {
        Mesh::Segments(mesh) => {
            let ends = |element: u32, image| mesh.segments()[element as usize].map(|point| at(point, image));
            let crossings = all.flat_map(|(element, image)| {
                segment_crossings(centers, ends(element, image), boundary(element))
            });
            vec![crossings.collect()]
        }
        Mesh::Triangles(mesh) => {
            let corners =
                |element: u32, image| mesh.triangles()[element as usize].map(|point| at(point, image));
            let mut of_slice = vec![Vec::new(); centers.size[2]];
            for (element, image) in all {
                let [a, b, c] = corners(element, image).map(|corner| corner.z);
                let end = (centers.first_at(2, a.max(b).max(c)) + 1).min(centers.size[2]);
                let start = centers.first_at(2, a.min(b).min(c)).min(end);
                of_slice[start..end].iter_mut().for_each(|slice: &mut Vec<_>| slice.push((element, image)));
            }
            let crossings = of_slice.into_par_iter().enumerate().map(|(slice, elements)| {
                let of_triangle = |&(element, image): &(u32, usize)| {
                    triangle_crossings(centers, slice, corners(element, image), boundary(element))
                };
                elements.iter().flat_map(of_triangle).collect()
            });
            crossings.collect()
        }
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
/// in the grain that it has entered once more than it has left, or in none where the domain does not fill its box.
fn fill_slice(size: [usize; 3], fills_box: bool, mut crossings: Vec<Crossing>) -> Vec<Side> {
    crossings.sort_unstable();
    let mut crossings = crossings.into_iter().peekable();
    let mut labels = Vec::with_capacity(size[0] * size[1]);
    for row in 0..size[1] {
        // Grains that the row is in, and how often: more than one only where images of grains round differently.
        let mut counts: Vec<(GrainId, i32)> = Vec::new();
        for voxel in 0..size[0] {
            while let Some(Crossing { left, entered, .. }) =
                crossings.next_if(|crossing| (crossing.row, crossing.voxel) <= (row, voxel))
            {
                add(&mut counts, left, -1);
                add(&mut counts, entered, 1);
            }
            counts.retain(|(_, count)| *count != 0);
            let grain = counts.iter().max_by_key(|(_, count)| *count).map(|(grain, _)| Side::Grain(*grain));
            // Between images that round differently there may be a gap.
            let nothing = if fills_box { labels.last().copied() } else { Some(Side::Exterior) };
            labels.push(grain.or(nothing).unwrap_or(Side::Grain(GrainId(0))));
        }
        // What lies beyond the last centre.
        while crossings.next_if(|crossing| crossing.row <= row).is_some() {}
    }
    labels
}

fn add(counts: &mut Vec<(GrainId, i32)>, side: Side, change: i32) {
    let Side::Grain(grain) = side else { return };
    match counts.iter_mut().find(|(other, _)| *other == grain) {
        Some((_, count)) => *count += change,
        None => counts.push((grain, change)),
    }
}
