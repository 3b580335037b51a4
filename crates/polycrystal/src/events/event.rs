//! Changes of the topology of a cell complex.

use glam::DVec3;
use voronoi::{FaceId, PeriodicVertex, Side, Translation};

use crate::mesh::wall_set::PARALLEL;
use crate::{CellComplex, ComplexEdge};

/// Share of the length of what goes by which what comes starts off its middle.
const OPENING: f64 = 0.3;

/// A change of topology.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Event {
    EdgeToTriangle(ComplexEdge),
    TriangleToEdge(FaceId),
    /// The face has four sides, one of which is the edge.
    NeighborSwitch(ComplexEdge, FaceId),
    /// The line stays, and its ends move.
    Move(ComplexEdge),
}

impl Event {
    /// The vertices that it takes away or moves.
    pub(crate) fn vertices(self, complex: &CellComplex) -> Vec<u32> {
        match self {
            Self::EdgeToTriangle(edge) | Self::Move(edge) => edge.vertices().to_vec(),
            Self::TriangleToEdge(face) | Self::NeighborSwitch(_, face) => {
                complex.corners(face).iter().map(|corner| corner.vertex).collect()
            }
        }
    }

    /// Lets it happen where that is possible, and gives the vertices that it moves or adds; where not, something may have changed all
    /// the same.
    ///
    /// What goes counts as no shorter than `least`.
    pub(crate) fn happen(self, complex: &mut CellComplex, least: f64) -> Option<Vec<u32>> {
        let old = self.vertices(complex);
        let first_new = complex.vertices.len();
        let has_happened = match self {
            Self::EdgeToTriangle(edge) => edge_to_triangle(complex, edge, least),
            Self::TriangleToEdge(face) => triangle_to_edge(complex, face, least),
            Self::NeighborSwitch(edge, face) => {
                edge_to_triangle(complex, edge, least) && triangle_to_edge(complex, face, least)
            }
            Self::Move(_) => true,
        };
        let added =
            (first_new..complex.vertices.len()).map(|new| u32::try_from(new).expect("ids fit 32 bits"));
        let all = old.into_iter().chain(added);
        has_happened.then(|| all.filter(|vertex| !complex.faces_at(&[*vertex]).is_empty()).collect())
    }
}

fn edge_to_triangle(complex: &mut CellComplex, edge: ComplexEdge, least: f64) -> bool {
    let Some(star) = complex.reconnectable_edge(edge) else { return false };
    let start = PeriodicVertex { vertex: edge.start, translation: Translation::ZERO };
    let ends = [start, edge.end].map(|end| complex.position(end));
    let middle = ends[0].midpoint(ends[1]);
    let length = OPENING * ends[0].distance(ends[1]).max(least);
    let [first, second] = star.ends;
    let positions = [0, 1, 2].map(|k| {
        let along: DVec3 = star.outer.iter().map(|outer| direction(complex, middle, outer[k])).sum();
        let sides = [first, second, star.around[(k + 1) % 3], star.around[(k + 2) % 3]];
        on_walls(complex, &sides, middle + along.normalize_or_zero() * length)
    });
    complex.put_triangle(edge, &star, positions);
    true
}

fn triangle_to_edge(complex: &mut CellComplex, face: FaceId, least: f64) -> bool {
    let Some((star, corners)) = complex.reconnectable_triangle(face) else { return false };
    let places = corners.map(|corner| complex.position(corner));
    let middle = (places[0] + places[1] + places[2]) / 3.0;
    let length = OPENING * places[0].distance(middle).max(least);
    let [a, b, c] = star.around;
    let positions = [0, 1].map(|end: usize| {
        let along: DVec3 = star.outer[end].iter().map(|outer| direction(complex, middle, *outer)).sum();
        on_walls(complex, &[a, b, c, star.ends[end]], middle + along.normalize_or_zero() * length)
    });
    complex.put_edge(face, (&star, corners), positions);
    true
}

fn direction(complex: &CellComplex, from: DVec3, to: PeriodicVertex) -> DVec3 {
    (complex.position(to) - from).normalize_or_zero()
}

/// The point of all walls among some sides that is nearest to another one.
fn on_walls(complex: &CellComplex, sides: &[Side], mut point: DVec3) -> DVec3 {
    let walls = sides.iter().filter_map(|side| match side {
        Side::Wall(wall) => Some(complex.domain().wall_equation(*wall)),
        Side::Cell(_) | Side::Image(..) => None,
    });
    // A wall is reached along the walls before it.
    let mut directions: Vec<DVec3> = Vec::new();
    for (normal, distance) in walls {
        let along = directions.iter().fold(normal, |along, before| along - *before * before.dot(along));
        if along.length() > PARALLEL {
            point += along * ((distance - normal.dot(point)) / along.dot(normal));
            directions.push(along.normalize());
        }
    }
    point
}

#[cfg(test)]
mod tests {
    use voronoi::{Domain, Tessellation};

    use super::*;

    /// Projections in turn came nearer by a hundredth a turn between the walls of a sphere: its grains lost volume with each event.
    #[test]
    fn points_are_on_walls_that_meet_at_small_angles() {
        let ball = Domain::ball(DVec3::ZERO, 1.0, 0.005).expect("a ball");
        let cells = Tessellation::new(&ball, &[DVec3::ZERO]).expect("one cell");
        let complex = CellComplex::from(&cells);
        for vertex in 0..u32::try_from(complex.vertices.len()).expect("few") {
            let faces = complex.faces_at(&[vertex]);
            let sides: Vec<Side> = faces.into_iter().map(|face| complex.sides(face)[1]).collect();
            for count in 1..=sides.len() {
                let corner = complex.vertices[vertex as usize];
                let point = on_walls(&complex, &sides[..count], corner * 0.9 + DVec3::splat(0.01));
                for side in &sides[..count] {
                    let Side::Wall(wall) = side else { panic!("{side:?} is no wall") };
                    let (normal, distance) = complex.domain().wall_equation(*wall);
                    assert!((normal.dot(point) - distance).abs() < 1e-12, "{vertex} {count}");
                }
            }
        }
    }
}
