//! What lies on the sides of a cell complex's faces, in terms of a network.

use glam::DVec3;
use voronoi::{CellId, Domain, Side, Wall};

use crate::{Boundary, CellComplex, Freedom, GrainId};

/// What the walls at a vertex leave to it.
pub(crate) fn freedom(complex: &CellComplex, vertex: u32) -> Freedom {
    freedom_on(complex.domain(), &complex.walls_at(vertex))
}

/// What some walls leave to a point on all of them.
pub(crate) fn freedom_on(domain: &Domain, walls: &[Wall]) -> Freedom {
    let planes = walls.iter().map(|wall| Freedom::InPlane(domain.outward_normal(*wall)));
    planes.fold(Freedom::Everywhere, Freedom::and)
}

/// The cell on a side, and how far it is from its own place; none beyond walls.
pub(crate) fn cell_and_offset(side: Side, domain: &Domain) -> Option<(CellId, DVec3)> {
    side.cell().map(|(cell, translation)| (cell, translation.vector(domain)))
}

/// The boundary between two sides, as [`Boundary::between_grains`] has it.
pub(crate) fn boundary(between: [Side; 2]) -> Boundary {
    let mut sides = between.map(|side| match side {
        Side::Cell(cell) | Side::Image(cell, _) => crate::Side::Grain(GrainId(cell.0)),
        Side::Wall(_) => crate::Side::Exterior,
    });
    sides.sort_unstable();
    let wall = between.into_iter().find_map(|side| match side {
        Side::Wall(wall) => Some(wall),
        Side::Cell(_) | Side::Image(..) => None,
    });
    Boundary { sides, wall, twin: None }
}

/// The tension of the boundary between two sides, and 1 more in a wall: all of a wall has the same area unless it folds, so that this does nothing but unfold it.
pub(crate) fn tension_between(sides: [Side; 2], tension: impl Fn(&Boundary) -> f64) -> f64 {
    let boundary = boundary(sides);
    let of_wall = if boundary.wall.is_some() { 1.0 } else { 0.0 };
    tension(&boundary) + of_wall
}
