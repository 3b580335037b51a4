use glam::DVec3;

use crate::check::closedness::open_edge_count;
use crate::mesh::adjacency::Adjacency;
use crate::mesh::boundary_elements::BoundaryElements;
use crate::mesh::level_points::LevelPoints;
use crate::mesh::volume::boundary_cones;
use crate::{Side, Surface};

/// The sides of each boundary in the order in which normals point from first to second, for surfaces whose order of sides
/// means something else.
///
/// Programs name the two sides in different orders, inside and at the exterior, so each of these is turned as a whole or
/// stays: at the exterior so that the surface encloses a positive volume, inside so that most grains close. A single
/// element that differs from the others stays different.
pub fn outward_sides(surface: &Surface<'_>) -> Vec<[Side; 2]> {
    let is_outer = |sides: &[Side; 2]| sides.contains(&Side::Exterior);
    let turned = |sides: &[[Side; 2]], outer: bool| -> Vec<[Side; 2]> {
        sides.iter().map(|at| if is_outer(at) == outer { [at[1], at[0]] } else { *at }).collect()
    };
    let origin = surface.points.first().copied().unwrap_or(DVec3::ZERO);
    let volumes =
        boundary_cones(&BoundaryElements::new(surface), &LevelPoints::held(surface.elements, surface.points))
            .into_iter()
            .map(|cone| cone.volume_from(origin));
    let outer = surface.sides.iter().zip(volumes).filter(|(sides, _)| is_outer(sides));
    let enclosed: f64 =
        outer.map(|(sides, volume)| if sides[0] == Side::Exterior { -volume } else { volume }).sum();
    let sides = if enclosed < 0.0 { turned(surface.sides, true) } else { surface.sides.to_vec() };
    let inner_turned = turned(&sides, false);
    let adjacency = Adjacency::of_elements(surface.elements, surface.boundary_of);
    let [as_it_is, the_other_way] =
        [&sides, &inner_turned].map(|sides| open_edge_count(&Surface { sides, ..*surface }, &adjacency));
    if the_other_way < as_it_is { inner_turned } else { sides }
}
