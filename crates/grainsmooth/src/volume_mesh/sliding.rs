//! Points of boundaries beside the worst tetrahedra slide along these, to where the tetrahedra are better.
//!
//! All corners of such tetrahedra are on boundaries, so that nothing inside grains makes them better.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec3;
use polycrystal::{Freedom, Network};
use voronoi::PeriodicPair;

use super::VolumeMesh;
use super::repair::{BAD, ROUNDS};
use super::search::Star;

/// The part of a gradient that rounding leaves of it within walls to which it is perpendicular.
const ROUNDING: f64 = 1e-9;

/// A point and its copies, each with the periods from there to it.
type Copies = Vec<(u32, DVec3)>;

impl VolumeMesh {
    /// Slides points so that the worst tetrahedra become better; whether one did. Points that are others moved by whole periods, as `pairs` tell, move as one.
    ///
    /// All grains keep their volumes. These are linear in the place of one point, which moves across none of their gradients: inside a boundary it has a plane for it, inside a triple line a line.
    /// Where four grains meet it stays.
    pub(crate) fn slide(&mut self, network: &Network, pairs: &[PeriodicPair<u32>]) -> bool {
        let originals: BTreeMap<u32, u32> = pairs.iter().map(|pair| (pair.secondary, pair.primary)).collect();
        let mut copies: BTreeMap<u32, Copies> = BTreeMap::new();
        for pair in pairs {
            let own = copies.entry(pair.primary).or_insert_with(|| vec![(pair.primary, DVec3::ZERO)]);
            own.push((pair.secondary, pair.translation.vector(network.domain())));
        }
        let level = network.finest_level();
        let freedom = |point: u32| match level.walls.get(point as usize) {
            Some(walls) => network.wall_sets().freedom(*walls),
            None => Freedom::Everywhere,
        };
        let once = |mesh: &mut Self| {
            let original = |corner: u32| originals.get(&corner).copied().unwrap_or(corner);
            let corners = mesh.poor(BAD).into_iter().flat_map(|tetrahedron| mesh.tetrahedra[tetrahedron]);
            let points: BTreeSet<u32> = corners.map(original).collect();
            let copies = |point| copies.get(&point).cloned().unwrap_or_else(|| vec![(point, DVec3::ZERO)]);
            let all = mesh.stars(points.into_iter().map(copies).collect());
            let slid = all.into_iter().filter(|stars| {
                let freedom = mesh.freedom(stars, freedom);
                freedom != Freedom::Nowhere && mesh.search(stars, freedom)
            });
            slid.count() > 0
        };
        (0..ROUNDS).take_while(|_| once(self)).count() > 0
    }

    /// The stars of points and their copies, but for those with a tetrahedron between two copies: its volume is not linear in their place.
    fn stars(&self, points: Vec<Copies>) -> Vec<Vec<Star>> {
        let mut is_asked = vec![false; self.points.len()];
        points.iter().flatten().for_each(|(point, _)| is_asked[*point as usize] = true);
        let mut around: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
        for (tetrahedron, corners) in self.tetrahedra.iter().enumerate() {
            for corner in corners.iter().filter(|corner| is_asked[**corner as usize]) {
                around.entry(*corner).or_default().push(tetrahedron);
            }
        }
        let mut star = |(point, shift)| {
            let tetrahedra = around.remove(&point).unwrap_or_default();
            Star { point, shift, tetrahedra }
        };
        let stars = points.into_iter().map(|copies| copies.into_iter().map(&mut star).collect());
        stars.filter(|stars: &Vec<Star>| are_apart(stars)).collect()
    }

    /// How a point and its copies may move when walls leave each so much, and all grains keep their volumes.
    fn freedom(&self, stars: &[Star], of_walls: impl Fn(u32) -> Freedom) -> Freedom {
        let of_walls = stars.iter().map(|star| of_walls(star.point)).fold(Freedom::Everywhere, Freedom::and);
        if stars.iter().all(|star| star.point as usize >= self.surface_points) {
            return of_walls;
        }
        let mut gradients: BTreeMap<u32, DVec3> = BTreeMap::new();
        for star in stars {
            for tetrahedron in &star.tetrahedra {
                let gradient = gradients.entry(self.grains[*tetrahedron].0).or_default();
                *gradient += self.volume_gradient(*tetrahedron, star.point);
            }
        }
        let across = gradients.into_values().filter_map(|gradient| {
            let free = of_walls.project(gradient);
            (free.length() > ROUNDING * gradient.length()).then(|| Freedom::InPlane(free.normalize()))
        });
        across.fold(of_walls, Freedom::and)
    }

    /// How six times the volume of a tetrahedron grows as a corner moves.
    fn volume_gradient(&self, tetrahedron: usize, corner: u32) -> DVec3 {
        let corners = self.tetrahedra[tetrahedron];
        let at = corners.iter().position(|other| *other == corner).expect("a corner of it");
        let [a, b, c] = [1, 2, 3].map(|k| self.points[corners[(at + k) % 4] as usize]);
        let normal = (b - a).cross(c - a);
        if at % 2 == 0 { -normal } else { normal }
    }
}

/// Whether no tetrahedron is around two of some points.
fn are_apart(stars: &[Star]) -> bool {
    let mut seen = BTreeSet::new();
    stars.iter().flat_map(|star| &star.tetrahedra).all(|tetrahedron| seen.insert(*tetrahedron))
}

#[cfg(test)]
mod tests {
    use glam::BVec3;
    use polycrystal::{GrainId, Junctions};
    use voronoi::{Domain, Tessellation};

    use super::*;
    use crate::volume_mesh::volume;

    const GRAINS: u32 = 8;

    /// Flat grains, and tetrahedra from the middle of each to all triangles of its boundaries.
    fn filled(periodic: BVec3) -> (Network, VolumeMesh) {
        let domain = Domain::unit_cube().with_periods(periodic);
        let seeds: Vec<DVec3> =
            (1..=GRAINS).map(|k| (DVec3::new(0.819, 0.671, 0.550) * f64::from(k)).fract()).collect();
        let cells = Tessellation::new(&domain, &seeds).expect("distinct seeds");
        let (network, mut points) = Network::new(&cells, Junctions::Crease, 0).expect("few grains");
        let surface_points = points.len();
        let level = network.finest();
        let corners = |element| level.elements().corners(element).iter().copied().collect::<Vec<u32>>();
        let elements = (0..level.element_count()).map(|element| u32::try_from(element).expect("few"));
        let of_grains: Vec<(GrainId, Vec<u32>)> = elements
            .flat_map(|element| {
                let sides = network.boundaries()[level.boundary(element).index()].sides;
                sides.into_iter().filter_map(|side| side.grain()).map(move |grain| (grain, element))
            })
            .map(|(grain, element)| (grain, corners(element)))
            .collect();
        for grain in (0..GRAINS).map(GrainId) {
            let own = of_grains.iter().filter(|(other, _)| *other == grain).flat_map(|(_, corners)| corners);
            let places: Vec<DVec3> = own.map(|corner| points[*corner as usize]).collect();
            points.push(places.iter().sum::<DVec3>() / places.len() as f64);
        }
        let tetrahedron = |(grain, corners): &(GrainId, Vec<u32>)| {
            let middle = u32::try_from(surface_points).expect("few") + grain.0;
            let mut corners = [corners[0], corners[1], corners[2], middle];
            if volume(corners.map(|corner| points[corner as usize])) < 0.0 {
                corners.swap(0, 1);
            }
            corners
        };
        let tetrahedra = of_grains.iter().map(tetrahedron).collect();
        let grains = of_grains.iter().map(|(grain, _)| *grain).collect();
        (network, VolumeMesh { points, surface_points, tetrahedra, grains, ..VolumeMesh::default() })
    }

    /// Where points slide, grains keep their volumes, copies stay whole periods away and points stay on walls.
    #[test]
    fn points_slide_to_better_places_and_all_else_stays() {
        for periodic in [BVec3::FALSE, BVec3::TRUE] {
            let (network, before) = filled(periodic);
            let pairs = network.periodic_vertices(&before.points[..before.surface_points], BVec3::FALSE);
            let pairs = pairs.expect("copies are known");
            let mut mesh = before.clone();
            assert!(mesh.slide(&network, &pairs));
            let all: Vec<usize> = (0..mesh.tetrahedra.len()).collect();
            let [worst, was] = [&mesh, &before].map(|mesh| mesh.worst(&all));
            assert!(worst > 1.2 * was, "{worst} {was}");
            let count = usize::try_from(GRAINS).expect("few");
            for (is, wanted) in mesh.grain_volumes(count).iter().zip(before.grain_volumes(count)) {
                assert!((is / wanted - 1.0).abs() < 1e-12, "{is} {wanted}");
            }
            let slid = |point: &usize| mesh.points[*point] != before.points[*point];
            assert!((0..mesh.surface_points).filter(slid).count() > 10);
            for pair in &pairs {
                let shift = pair.translation.vector(network.domain());
                let [to, from] = [pair.secondary, pair.primary].map(|point| mesh.points[point as usize]);
                assert_eq!(to, from + shift);
            }
            let level = network.finest_level();
            for (point, walls) in mesh.points.iter().zip(&level.walls) {
                assert_eq!(network.wall_sets().put_on_walls(*walls, *point), *point);
            }
        }
    }
}
