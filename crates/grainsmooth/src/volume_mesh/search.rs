//! Better places for points: where the worst of the tetrahedra around them is better.

use glam::DVec3;
use polycrystal::{Freedom, tetrahedron_gamma};
use rayon::prelude::*;

use super::VolumeMesh;

/// Steps in which a better place is looked for, as shares of the mean edge around.
const STEPS: [f64; 4] = [0.3, 0.15, 0.07, 0.03];

/// Directions of the search: along axes and diagonals.
const DIRECTIONS: [[f64; 3]; 14] = [
    [1.0, 0.0, 0.0],
    [-1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, -1.0, 0.0],
    [0.0, 0.0, 1.0],
    [0.0, 0.0, -1.0],
    [0.6, 0.6, 0.6],
    [-0.6, 0.6, 0.6],
    [0.6, -0.6, 0.6],
    [0.6, 0.6, -0.6],
    [-0.6, -0.6, 0.6],
    [-0.6, 0.6, -0.6],
    [0.6, -0.6, -0.6],
    [-0.6, -0.6, -0.6],
];

/// A point and the tetrahedra that it is a corner of.
pub(super) struct Star {
    pub(super) point: u32,
    /// How far it is from the first of the points that move as one with it.
    pub(super) shift: DVec3,
    pub(super) tetrahedra: Vec<usize>,
}

impl VolumeMesh {
    /// Moves points as one, as far as they are free to, to where the worst of the tetrahedra around them is better; whether there is such a place nearby.
    pub(super) fn search(&mut self, stars: &[Star], freedom: Freedom) -> bool {
        let start: Vec<DVec3> = stars.iter().map(|star| self.points[star.point as usize]).collect();
        let (mut sum, mut count) = (0.0, 0.0);
        for (star, start) in stars.iter().zip(&start) {
            for corner in star.tetrahedra.iter().flat_map(|tetrahedron| self.corners(*tetrahedron)) {
                (sum, count) = (sum + corner.distance(*start), count + 1.0);
            }
        }
        let worst =
            |mesh: &Self| stars.iter().map(|star| mesh.worst(&star.tetrahedra)).fold(f64::INFINITY, f64::min);
        let (mut best, mut place) = (worst(self), start[0]);
        for step in STEPS {
            for direction in DIRECTIONS {
                let tried = place + freedom.project(DVec3::from(direction)) * (step * sum / count);
                self.put(stars, &start, tried);
                let gamma = worst(self);
                if gamma > best {
                    (best, place) = (gamma, tried);
                }
            }
        }
        self.put(stars, &start, place);
        place != start[0]
    }

    /// Puts points where the first of them is at some place. Coordinates that it keeps, such as those across walls, they all keep to the last bit.
    fn put(&mut self, stars: &[Star], start: &[DVec3], place: DVec3) {
        for (star, own) in stars.iter().zip(start) {
            let is_kept = place.cmpeq(start[0]);
            self.points[star.point as usize] = DVec3::select(is_kept, *own, place + star.shift);
        }
    }

    /// The tetrahedra with a gamma below some limit, in order.
    pub(super) fn poor(&self, limit: f64) -> Vec<usize> {
        let all = (0..self.tetrahedra.len()).into_par_iter();
        all.filter(|tetrahedron| self.gamma(*tetrahedron) < limit).collect()
    }

    pub(super) fn gamma(&self, tetrahedron: usize) -> f64 {
        tetrahedron_gamma(self.corners(tetrahedron))
    }

    pub(super) fn worst(&self, tetrahedra: &[usize]) -> f64 {
        tetrahedra.iter().map(|tetrahedron| self.gamma(*tetrahedron)).fold(f64::INFINITY, f64::min)
    }
}
