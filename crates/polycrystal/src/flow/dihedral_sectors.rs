//! Edges of grains, and how sharp they are.
//!
//! Two boundaries of a grain that close like a book would cross behind its back, which no fold within either of them tells.

use glam::DVec3;
use rayon::prelude::*;

use crate::mesh::adjacency::{Adjacency, Incidence, by_edge_in_parallel};
use crate::mesh::level_points::LevelPoints;
use crate::{Elements, Side, Surface};

/// Cosine of the angle from which on one beyond 180 degrees is one that has closed (315 degrees, or -45).
const LEAST_TURNED: f64 = 0.7;

/// The edges of all grains in space: two triangles of different boundaries with a grain between them. None in the plane, where
/// short lines may well turn about.
pub(crate) struct DihedralSectors {
    dihedral_sectors: Vec<DihedralSector>,
}

/// An edge. Where elements are refined, it is that of the elements that hold their labels.
struct DihedralSector {
    labelled: [u32; 2],
    /// The number of the edge in each element.
    edges: [u8; 2],
    /// Whether the elements run along the edge one as the other.
    is_alike: bool,
    /// 1 where the grain lies on the side that the first element's normal points to, -1 on the other.
    sense: i8,
}

impl DihedralSectors {
    /// Those of a surface that is not refined.
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
                labelled: [pair[0].1, pair[1].1].map(|at| at.element),
                edges: [pair[0].1, pair[1].1].map(|at| at.corner),
                is_alike: pair[0].1.ends(surface.elements) == pair[1].1.ends(surface.elements),
                sense: pair[0].2,
            });
            sectors.collect::<Vec<_>>()
        };
        let edges = by_edge_in_parallel(&adjacency.incidences);
        let mut dihedral_sectors: Vec<DihedralSector> = edges.flat_map_iter(at_edge).collect();
        dihedral_sectors.shrink_to_fit();
        Self { dihedral_sectors }
    }

    /// The elements at edges where grains are turned inside out, among those of the surface or what is refined from them.
    pub(crate) fn turned(&self, points: &LevelPoints<'_>) -> Vec<[u32; 2]> {
        let sectors = self.dihedral_sectors.par_iter();
        sectors.flat_map_iter(|sector| sector.turned(points)).collect()
    }
}

impl DihedralSector {
    /// The elements at its edge, or those into which that is refined, where the grain is turned inside out.
    fn turned(&self, points: &LevelPoints<'_>) -> Vec<[u32; 2]> {
        let elements = points.elements();
        let refined = elements.refined_triangle();
        let own = self.labelled.map(|labelled| points.of(labelled));
        let [along, other] = self.edges.map(|edge| refined.along_edges[usize::from(edge)]);
        let last = along.len() - 1;
        let edges =
            (0..=last).map(|at| [along[at], if self.is_alike { other[at] } else { other[last - at] }]);
        let turned = edges.filter(|edges| {
            let corners = |k: usize| {
                let (place, edge) = edges[k];
                [0, 1, 2].map(|turn| own[k][refined.triangles[place][(edge + turn) % 3]])
            };
            self.is_turned([corners(0), corners(1)])
        });
        let elements_at =
            |edges: [(usize, usize); 2]| [0, 1].map(|k| elements.element_in(self.labelled[k], edges[k].0));
        turned.map(elements_at).collect()
    }

    /// Whether the grain's angle at two elements is so far above 180 degrees that it is rather one below 0. They are given by the edge as each runs
    /// along it, and the corner beside it.
    fn is_turned(&self, [[start, end, first], [_, _, second]]: [[DVec3; 3]; 2]) -> bool {
        let (edge, first, second) = (end - start, first - start, second - start);
        let is_beyond = f64::from(self.sense) * edge.dot(first.cross(second)) < 0.0;
        let cosine = || {
            let [first, second] = [first, second].map(|leg| leg.reject_from(edge).normalize_or_zero());
            first.dot(second)
        };
        // Few are above 180 degrees at all.
        is_beyond && cosine() > LEAST_TURNED
    }
}

#[cfg(test)]
mod tests {
    use voronoi::{Domain, Tessellation};

    use super::*;
    use crate::{Junctions, LevelView, Network};

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
        assert!(dihedral_sectors.turned(&LevelPoints::held((&level.mesh).into(), &flat)).is_empty());
        // What is inside the boundary at x = 0.5, y < 0.5, goes far beyond the one at y = 0.5.
        let mut pushed = flat.clone();
        for point in &mut pushed {
            if point.x == 0.5 && point.y > 0.1 && point.y < 0.4 {
                *point = DVec3::new(0.95, 0.7, point.z);
            }
        }
        assert!(!dihedral_sectors.turned(&LevelPoints::held((&level.mesh).into(), &pushed)).is_empty());
    }
    #[test]
    fn edges_of_levels_that_are_not_held_are_turned_as_those_of_whole_ones() {
        let seeds: Vec<DVec3> =
            (1..=12).map(|k| (DVec3::new(0.819, 0.671, 0.550) * f64::from(k)).fract()).collect();
        let cells = Tessellation::new(&Domain::unit_cube(), &seeds).expect("valid seeds");
        let (network, flat) = Network::new(&cells, Junctions::Corner, 2).expect("a small network");
        let sides = network.sides();
        let mut points = network.subdivide(&flat);
        for (point, k) in points.iter_mut().zip(0u32..) {
            *point += 0.05 * (DVec3::new(0.7549, 0.5698, 0.3247) * f64::from(k)).fract();
        }
        let turned = |level: LevelView<'_>| {
            let surface = Surface::of_level(level.held(), &[], &sides);
            let sectors = DihedralSectors::new(&surface, &Adjacency::of_level(level.held()));
            let mut turned = sectors.turned(&LevelPoints::held(level.elements(), &points));
            turned.iter_mut().for_each(|pair| pair.sort_unstable());
            turned.sort_unstable();
            turned
        };
        let of_whole = turned(network.level(2));
        assert!(of_whole.len() > 20);
        assert_eq!(turned(network.level_from_before(2)), of_whole);
    }
}
