//! How far triple lines are from rest under the tensions that pull at them.

use glam::DVec3;
use rayon::prelude::*;

use crate::measures::complex::Complex;
use crate::measures::lines::{Line, Lines};
use crate::mesh::adjacency::Incidence;
use crate::mesh::angles::{edge_length, leg};
use crate::{Elements, LevelView, Network, Side, Surface};

/// Cosine beyond which two walls count as one plane, across a line on it.
const ONE_PLANE: f64 = -0.999_999;

/// How far a network is from Herring's condition (1951): at rest, the tensions that pull at a triple line cancel.
///
/// The residual of an edge is |sum of tension x direction| / sum of tensions, 0 at rest and 1 at most; a boundary pulls square to the
/// line. On a wall only what pulls along it counts, for the wall holds the rest. One boundary of three equal ones that is off by 10
/// degrees makes 0.05.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HerringResidual {
    /// Root of the mean square over the length of all triple lines; in the plane, over all triple points.
    pub rms: f64,
    /// The largest of a line, where it is the mean over the length; in the plane, of a point.
    pub largest: f64,
}

/// The residual of a network with the given points of its finest level; nothing where no boundaries with tension meet.
///
/// # Panics
/// When there is not one point per vertex.
pub fn herring_residual(network: &Network, points: &[DVec3]) -> Option<HerringResidual> {
    of_level(network, network.finest(), points, |complex| match complex.surface.elements {
        Elements::Triangles(_) | Elements::Refined(_) => {
            let lines = Lines::of(complex);
            let residuals = lines.lines.par_iter().filter_map(|line| complex.residual_of_line(line));
            residuals.reduce(|| 0.0, f64::max)
        }
        Elements::Segments(_) => {
            complex.residuals().into_iter().map(|(residual, _)| residual).fold(0.0, f64::max)
        }
    })
}

/// The root mean square alone, on any level.
pub(crate) fn rms_residual(network: &Network, level: LevelView<'_>, points: &[DVec3]) -> Option<f64> {
    Some(of_level(network, level, points, |_| 0.0)?.rms)
}

fn of_level(
    network: &Network,
    level: LevelView<'_>,
    points: &[DVec3],
    largest: impl FnOnce(&Complex<'_>) -> f64 + Send,
) -> Option<HerringResidual> {
    assert_eq!(points.len(), level.vertex_count(), "there must be one point per vertex");
    let sides = network.sides();
    let complex = Complex::of_level(network, level, &Surface::of_level(level, points, &sides));
    let (residuals, largest) = rayon::join(|| complex.residuals(), || largest(&complex));
    let (mut squares, mut weights) = (0.0, 0.0);
    for (residual, weight) in residuals {
        squares += weight * residual * residual;
        weights += weight;
    }
    (weights > 0.0).then(|| HerringResidual { rms: (squares / weights).sqrt(), largest })
}

impl Complex<'_> {
    /// The residuals of all edges where three sides or more meet, with the lengths over which they hold; in the plane 1.
    fn residuals(&self) -> Vec<(f64, f64)> {
        let edges = self.non_manifold_edges_in_parallel().filter(|at| at.len() >= 3);
        edges.filter_map(|at| Some((self.residual(at)?, edge_length(&self.surface, at)))).collect()
    }

    /// The residual of a line, as a mean over its length.
    pub(crate) fn residual_of_line(&self, line: &Line<'_>) -> Option<f64> {
        if line.boundaries.len() < 3 {
            return None;
        }
        let (mut sum, mut length) = (0.0, 0.0);
        for at in &line.edges {
            let own = edge_length(&self.surface, at);
            sum += own * self.residual(at)?;
            length += own;
        }
        (length > 0.0).then(|| sum / length)
    }

    /// The residual of an edge; nothing where no boundary there has any tension, or walls leave it no way to go.
    pub(crate) fn residual(&self, at: &[Incidence]) -> Option<f64> {
        let (mut force, mut tensions) = (DVec3::ZERO, 0.0);
        let mut walls = Vec::new();
        for at in at {
            let boundary = self.boundary(at).index();
            let leg = leg(&self.surface, at);
            force += leg * self.tensions[boundary];
            tensions += self.tensions[boundary];
            if self.sides[boundary].contains(&Side::Exterior) {
                walls.push(leg);
            }
        }
        let pull = match walls[..] {
            [] => force.length(),
            [one, other] if one.dot(other) < ONE_PLANE => force.dot(one).abs(),
            _ => return None,
        };
        (tensions > 0.0).then(|| pull / tensions)
    }
}
