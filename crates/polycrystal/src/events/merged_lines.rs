//! Lines that stay short, drawn together into points of higher order.
//!
//! Where a line has shrunk and no change of topology lessens the area, the one that is due shows on finer meshes than decide about it
//! only. Left as it is, such a line keeps all triangles around thin, and their angles off balance; as a point it does neither.

use cancellation::check_cancelled;
use glam::DVec3;
use rayon::prelude::*;
use voronoi::{FaceId, Side, Tessellation, VertexId};

use crate::energy::shape::{Shape, distinct, face_numbers, line_of};
use crate::mesh::grouped::Grouped;
use crate::{CellComplex, Collapsed, remove_short_edges};

/// The cells of a complex without short lines.
pub(crate) struct MergedLines {
    pub(crate) cells: Tessellation,
    /// A point in the middle of each line.
    pub(crate) middles: Vec<DVec3>,
    /// A point inside each boundary.
    pub(crate) centers: Vec<DVec3>,
    pub(crate) collapsed: Collapsed,
}

impl MergedLines {
    /// Draws lines shorter than `length` together, as [`remove_short_edges`] has it; the others keep their bulges.
    pub(crate) fn new(complex: &CellComplex, shape: &Shape, length: f64) -> Self {
        let (all, corners) = complex.tessellation();
        let known_lines = || {
            let known = lines_of(&all).map(|Line { sides, ends, middle }| {
                let bulge = shape.bulge_of_line(line_of(&corners, ends));
                Known { sides, middle, bulge }
            });
            sorted(known.collect())
        };
        // To draw lines together takes one thread.
        let ((cells, collapsed), known) = rayon::join(|| remove_short_edges(&all, length), known_lines);
        let curved = |Line { sides, middle, .. }: Line| middle + bulge(&known, &sides, middle);
        let (middles, centers) = rayon::join(
            || lines_of(&cells).map(curved).collect(),
            || centers_of(complex, shape, &all, &cells),
        );
        Self { cells, middles, centers, collapsed }
    }
}

/// A line or a boundary before lines were drawn together.
struct Known<Sides> {
    sides: Sides,
    /// The mean of its corners.
    middle: DVec3,
    bulge: DVec3,
}

fn sorted<Sides: Ord + Send>(mut known: Vec<Known<Sides>>) -> Vec<Known<Sides>> {
    known.par_sort_by(|a, b| a.sides.cmp(&b.sides));
    known
}

/// How far the nearest of what is known between some sides bulges; what is new does not.
fn bulge<Sides: Ord>(known: &[Known<Sides>], sides: &Sides, middle: DVec3) -> DVec3 {
    let first = known.partition_point(|known| known.sides < *sides);
    let same = known[first..].iter().take_while(|known| known.sides == *sides);
    let distance = |known: &Known<Sides>| known.middle.distance_squared(middle);
    let nearest = same.min_by(|a, b| distance(a).total_cmp(&distance(b)));
    nearest.map_or(DVec3::ZERO, |known| known.bulge)
}

/// A point inside each boundary of some cells: off the mean of its corners by as much as it was in `all`, which the complex made.
fn centers_of(complex: &CellComplex, shape: &Shape, all: &Tessellation, cells: &Tessellation) -> Vec<DVec3> {
    let mean = |cells: &Tessellation, face: FaceId| {
        let corners = cells.face_corners(face);
        let sum: DVec3 = corners.iter().map(|corner| cells.vertices()[corner.index()]).sum();
        sum / corners.len() as f64
    };
    let known = all.faces().zip(face_numbers(complex, all)).map(|(face, number)| Known {
        sides: all.face_sides(face),
        middle: mean(all, face),
        bulge: shape.bulge(number),
    });
    let known = sorted(known.collect());
    let center = |face: FaceId| {
        let middle = mean(cells, face);
        middle + bulge(&known, &cells.face_sides(face), middle)
    };
    let faces: Vec<FaceId> = cells.faces().collect();
    faces.into_par_iter().map(center).collect()
}

/// A line of some cells.
struct Line {
    /// Those around, an image as the cell that it is of.
    sides: Vec<Side>,
    ends: [VertexId; 2],
    /// Halfway between its ends.
    middle: DVec3,
}

/// The lines of some cells, in order.
fn lines_of(cells: &Tessellation) -> impl IndexedParallelIterator<Item = Line> {
    let edges = cells.edges();
    let corners = cells.faces().flat_map(|face| std::iter::repeat_n(face.0, cells.face_corners(face).len()));
    let corners: Vec<u32> = corners.collect();
    let at_corners = edges.of_corner.iter().zip(&corners).map(|(edge, face)| (*edge as usize, *face));
    let faces = Grouped::new(edges.ends.len(), at_corners);
    let position = |vertex: VertexId| cells.vertices()[vertex.index()];
    edges.ends.into_par_iter().enumerate().map(move |(line, ends)| {
        check_cancelled();
        let sides = faces.of(line).iter().flat_map(|face| cells.face_sides(FaceId(*face)));
        Line { sides: distinct(sides), ends, middle: position(ends[0]).midpoint(position(ends[1])) }
    })
}

#[cfg(test)]
mod tests {
    use voronoi::Domain;

    use super::*;
    use crate::energy::fans::Fans;

    #[test]
    fn lines_that_are_not_merged_keep_their_bulges() {
        let seeds = (0..40).map(|k| DVec3::new(0.755, 0.570, 0.289) * f64::from(k) % 1.0);
        let domain = Domain::unit_cube().with_periods(glam::BVec3::TRUE);
        let cells = Tessellation::new(&domain, &seeds.collect::<Vec<_>>()).expect("valid seeds");
        let complex = CellComplex::from(&cells);
        let bulge = |sides: &[Side]| {
            let ids = sides.iter().map(|side| match side {
                Side::Cell(cell) => f64::from(cell.0),
                Side::Image(..) | Side::Wall(_) => 0.0,
            });
            DVec3::new(0.001, -0.002, 0.0005) * ids.sum::<f64>()
        };
        // Each line with the bulge that its boundaries give.
        let fans = Fans::new(&complex, &|_| 1.0);
        let mut points = Shape::default().points(&complex, &fans);
        for line in 0..fans.lines.len() {
            let faces = fans.faces_of_line(line);
            let sides = distinct(faces.into_iter().flat_map(|face| complex.sides(face)));
            points[fans.point_of_line(line)] += bulge(&sides);
        }
        let shape = Shape::new(&fans, &points);
        let cells = complex.tessellation().0;
        let lines: Vec<Line> = lines_of(&cells).collect();
        for (length, is_short) in [(0.0, false), (0.1, true)] {
            let merged = MergedLines::new(&complex, &shape, length);
            assert_eq!(merged.collapsed.edges > 0, is_short);
            let mut kept = 0;
            let left: Vec<Line> = lines_of(&merged.cells).collect();
            for (Line { sides, middle, .. }, point) in left.iter().zip(&merged.middles) {
                if lines.iter().any(|known| known.sides == *sides) {
                    let off = *point - *middle - bulge(sides);
                    assert!(off.length() < 1e-14, "{length} {sides:?} {off}");
                    kept += 1;
                }
            }
            assert!(kept > merged.middles.len() / 2);
        }
    }
}
