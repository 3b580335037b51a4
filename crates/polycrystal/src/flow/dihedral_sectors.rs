//! Edges of grains, and how sharp they are.
//!
//! Two boundaries of a grain that close like a book would cross behind its back, which no fold within either of them tells.

use glam::DVec3;
use rayon::prelude::*;

use crate::mesh::adjacency::{Adjacency, Incidence, by_edge_in_parallel};
use crate::{Elements, Side, Surface};

/// Cosine of the angle from which on one beyond 180 degrees is one that has closed (315 degrees, or -45).
const LEAST_TURNED: f64 = 0.7;

/// The edges of all grains in space: two triangles of different boundaries with a grain between them. None in the plane, where
/// short lines may well turn about.
pub(crate) struct DihedralSectors {
    dihedral_sectors: Vec<DihedralSector>,
}

/// An edge, held as little as may be: there are as many as the finest level has on triple lines, three times.
struct DihedralSector {
    elements: [u32; 2],
    /// The number of the edge in each element.
    edges: [u8; 2],
    /// 1 where the grain lies on the side that the first element's normal points to, -1 on the other.
    sense: i8,
}

impl DihedralSectors {
    pub(crate) fn new(surface: &Surface<'_>, adjacency: &Adjacency<'_>) -> Self {
        if let Elements::Segments(_) = surface.elements {
            return Self { dihedral_sectors: Vec::new() };
        }
        let at_edge = |edge: &[Incidence]| {
            let mut incidences: Vec<(Side, &Incidence, i8)> = Vec::with_capacity(2 * edge.len());
            for at in edge {
                let [first, second] = surface.sides_of(at.element);
                incidences.extend([(first, at, -1), (second, at, 1)]);
            }
            incidences.retain(|(side, ..)| *side != Side::Exterior);
            incidences.sort_unstable_by_key(|(side, at, _)| (*side, **at));
            let pairs = incidences.chunk_by(|a, b| a.0 == b.0).filter(|same| same.len() == 2);
            let sectors = pairs.map(|pair| DihedralSector {
                elements: [pair[0].1, pair[1].1].map(|at| at.element),
                edges: [pair[0].1, pair[1].1].map(|at| at.corner),
                sense: pair[0].2,
            });
            sectors.collect::<Vec<_>>()
        };
        let edges = by_edge_in_parallel(&adjacency.incidences);
        let mut dihedral_sectors: Vec<DihedralSector> = edges.flat_map_iter(at_edge).collect();
        dihedral_sectors.shrink_to_fit();
        Self { dihedral_sectors }
    }

    /// The elements at edges where grains are turned inside out, among those of the surface.
    pub(crate) fn turned(&self, elements: Elements<'_>, points: &[DVec3]) -> Vec<[u32; 2]> {
        let sectors = self.dihedral_sectors.par_iter();
        let turned = sectors.filter(|sector| is_turned(sector.opening(elements, points)));
        turned.map(|sector| sector.elements).collect()
    }
}

/// Whether an angle, given by cosine and sine, is so far above 180 degrees that it is rather one below 0.
fn is_turned([cosine, sine]: [f64; 2]) -> bool {
    cosine > LEAST_TURNED && sine < 0.0
}

impl DihedralSector {
    /// Cosine and sine of the grain's angle.
    fn opening(&self, elements: Elements<'_>, points: &[DVec3]) -> [f64; 2] {
        // The edge as the element runs along it, and what it has beside.
        let corners = |k: usize| -> [DVec3; 3] {
            let corners: [u32; 3] = elements.points(self.elements[k]);
            [0, 1, 2].map(|turn| points[corners[(usize::from(self.edges[k]) + turn) % 3] as usize])
        };
        let [[start, end, first], [_, _, second]] = [0, 1].map(corners);
        let along = (end - start).normalize_or_zero();
        let leg = |apex: DVec3| (apex - start).reject_from_normalized(along).normalize_or_zero();
        let [first, second] = [first, second].map(leg);
        [first.dot(second), f64::from(self.sense) * along.dot(first.cross(second))]
    }
}

#[cfg(test)]
mod tests {
    use voronoi::{Domain, Tessellation};

    use super::*;
    use crate::{Junctions, Network};

    #[test]
    fn a_wall_that_is_pushed_through_another_is_turned() {
        let domain = Domain::unit_cube();
        let z = 0.5;
        let seeds =
            [(0.25, 0.25), (0.75, 0.25), (0.25, 0.75), (0.75, 0.75)].map(|(x, y)| DVec3::new(x, y, z));
        let tessellation = Tessellation::new(&domain, &seeds).expect("valid seeds");
        let (network, flat) = Network::new(&tessellation, Junctions::Crease, 0).expect("a network");
        let level = network.control_mesh();
        let sides = network.sides();
        let dihedral_sectors =
            DihedralSectors::new(&Surface::of_level(level, &flat, &sides), &Adjacency::of_level(level));
        assert!(dihedral_sectors.turned((&level.mesh).into(), &flat).is_empty());
        // What is inside the boundary at x = 0.5, y < 0.5, goes far beyond the one at y = 0.5.
        let mut pushed = flat.clone();
        for point in &mut pushed {
            if point.x == 0.5 && point.y > 0.1 && point.y < 0.4 {
                *point = DVec3::new(0.95, 0.7, point.z);
            }
        }
        assert!(!dihedral_sectors.turned((&level.mesh).into(), &pushed).is_empty());
    }
}
