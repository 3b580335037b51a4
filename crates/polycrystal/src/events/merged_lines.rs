//! Lines that stay short, drawn together into points of higher order.
//!
//! Where a line has shrunk and no change of topology lessens the area, the one that is due shows on finer meshes than decide about it
//! only. Left as it is, such a line keeps all triangles around thin, and their angles off balance; as a point it does neither.

use std::collections::HashMap;

use cancellation::check_cancelled;
use glam::DVec3;
use voronoi::{Side, Tessellation, VertexId};

use crate::energy::shape::{Shape, distinct, line_of};
use crate::{CellComplex, Collapsed, remove_short_edges};

/// The cells of a complex without short lines.
pub(crate) struct MergedLines {
    pub(crate) cells: Tessellation,
    /// A point in the middle of each line.
    pub(crate) middles: Vec<DVec3>,
    pub(crate) collapsed: Collapsed,
}

impl MergedLines {
    /// Draws lines shorter than `length` together, as [`remove_short_edges`] has it; the others keep their bulges.
    pub(crate) fn new(complex: &CellComplex, shape: &Shape, length: f64) -> Self {
        let (all, corners) = complex.tessellation();
        let bulges = all.edges().ends.into_iter().map(|ends| shape.bulge_of_line(line_of(&corners, ends)));
        let lines = lines_of(&all).into_iter().zip(bulges);
        let mut known: HashMap<Vec<Side>, Vec<(DVec3, DVec3)>> = HashMap::new();
        for ((sides, middle), bulge) in lines {
            known.entry(sides).or_default().push((middle, bulge));
        }
        let (cells, collapsed) = remove_short_edges(&all, length);
        let curved = |(sides, middle): (Vec<Side>, DVec3)| {
            let before = known.get(&sides).into_iter().flatten();
            let distance = |line: &(DVec3, DVec3)| line.0.distance_squared(middle);
            let nearest = before.min_by(|a, b| distance(a).total_cmp(&distance(b)));
            middle + nearest.map_or(DVec3::ZERO, |(_, bulge)| *bulge)
        };
        let middles = lines_of(&cells).into_iter().map(curved).collect();
        Self { cells, middles, collapsed }
    }
}

/// Of each line the sides around, an image as the cell that it is of, and where it is halfway between its ends.
fn lines_of(cells: &Tessellation) -> Vec<(Vec<Side>, DVec3)> {
    let edges = cells.edges();
    let mut around = vec![Vec::new(); edges.ends.len()];
    let mut of_corner = edges.of_corner.iter();
    for face in cells.faces() {
        check_cancelled();
        for edge in of_corner.by_ref().take(cells.face_corners(face).len()) {
            around[*edge as usize].extend(cells.face_sides(face));
        }
    }
    let position = |vertex: VertexId| cells.vertices()[vertex.index()];
    let middles = edges.ends.iter().map(|ends| position(ends[0]).midpoint(position(ends[1])));
    around.into_iter().map(distinct).zip(middles).collect()
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
        let lines = lines_of(&complex.tessellation().0);
        for (length, is_short) in [(0.0, false), (0.1, true)] {
            let merged = MergedLines::new(&complex, &shape, length);
            assert_eq!(merged.collapsed.edges > 0, is_short);
            let mut kept = 0;
            for ((sides, middle), point) in lines_of(&merged.cells).iter().zip(&merged.middles) {
                if lines.iter().any(|(known, _)| known == sides) {
                    assert!(
                        point.distance(*middle + bulge(sides)) < 1e-14,
                        "{length} {sides:?} {}",
                        *point - *middle - bulge(sides)
                    );
                    kept += 1;
                }
            }
            assert!(kept > merged.middles.len() / 2);
        }
    }
}
