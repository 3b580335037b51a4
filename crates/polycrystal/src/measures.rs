//! Measures of the grains, boundaries, triple lines and quadruple points of a network.

pub(crate) mod boundary_distances;
pub(crate) mod cells;
pub(crate) mod complex;
pub(crate) mod curvatures;
pub(crate) mod dihedral;
pub(crate) mod herring;
pub(crate) mod lines;
pub(crate) mod plane;
pub(crate) mod space;

use glam::DVec3;

pub use boundary_distances::BoundaryDistances;
pub use cells::angles_between_cells;
pub use curvatures::{PointCurvature, point_curvatures};
pub use dihedral::{angles_between_boundaries, dihedral_angles};
pub use herring::{HerringResidual, herring_residual};
pub use plane::{PlaneBoundaryMeasures, PlaneGrainMeasures, PlaneMeasures, TriplePointMeasures};
pub use space::{BoundaryMeasures, GrainMeasures, QuadruplePointMeasures, SpaceMeasures, TripleLineMeasures};

use crate::{Elements, Network, Side, Surface};
pub(crate) use complex::Complex;
pub(crate) use herring::rms_residual;

/// What a network is like. Lengths are in the unit of its points, angles in degrees.
#[derive(Debug, Clone, PartialEq)]
pub enum Measures {
    /// Of surfaces in space.
    Space(SpaceMeasures),
    /// Of lines in the plane.
    Plane(PlaneMeasures),
}

impl Measures {
    /// Those of a network in space.
    pub fn in_space(self) -> Option<SpaceMeasures> {
        match self {
            Self::Space(measures) => Some(measures),
            Self::Plane(_) => None,
        }
    }

    /// Those of a network in the plane.
    pub fn in_plane(self) -> Option<PlaneMeasures> {
        match self {
            Self::Space(_) => None,
            Self::Plane(measures) => Some(measures),
        }
    }
}

/// The measures of any surface.
///
/// The grains must be closed, as [`certify`](crate::certify) finds out.
///
/// # Panics
/// When elements refer to points or boundaries that there are not.
pub fn measure(surface: &Surface<'_>) -> Measures {
    of_complex(&Complex::of_surface(surface))
}

/// The measures of a network with the given points of its finest level.
///
/// In a periodic domain every boundary, line and point counts once, grains are whole, and a grain a period away is a
/// neighbour like any other.
///
/// ```
/// use glam::DVec3;
/// use polycrystal::{GrainId, Junctions, Network, measure_network};
/// use voronoi::{Domain, Tessellation};
///
/// let seeds = [DVec3::new(0.25, 0.5, 0.5), DVec3::new(0.75, 0.5, 0.5)];
/// let cells = Tessellation::new(&Domain::unit_cube(), &seeds)?;
/// let (network, points) = Network::new(&cells, Junctions::Crease, 0)?;
/// let measures = measure_network(&network, &points).in_space().expect("three dimensions");
/// assert_eq!(measures.grains[0].neighbors, [GrainId(1)]);
/// assert!((measures.grains[0].area - 4.0).abs() < 1e-12, "a box of 1/2 x 1 x 1");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Panics
/// When there is not one point per vertex.
pub fn measure_network(network: &Network, points: &[DVec3]) -> Measures {
    let level = network.finest();
    assert_eq!(points.len(), level.vertex_count(), "there must be one point per vertex");
    let sides = network.sides();
    let surface = Surface::of_level(level, points, &sides);
    of_complex(&Complex::of_level(network, level, &surface))
}

/// The smallest and the largest dihedral angle of the triple lines (in the plane: of the triple point) at each point, in
/// degrees; NaN where there is none, and where the exterior is one of the sides. Copies have what their originals have.
///
/// # Panics
/// When there is not one point per vertex.
pub fn point_dihedral_angles(network: &Network, points: &[DVec3]) -> Vec<[f64; 2]> {
    let level = network.finest();
    assert_eq!(points.len(), level.vertex_count(), "there must be one point per vertex");
    let sides = network.sides();
    let surface = Surface::of_level(level, points, &sides);
    let complex = Complex::of_level(network, level, &surface);
    // The minimum with NaN is the other number.
    let mut angles = vec![[f64::NAN; 2]; points.len()];
    for edge in complex.non_manifold_edges().filter(|at| at.len() >= 3) {
        let dihedral_sectors = complex.dihedral_sectors(edge);
        if dihedral_sectors.iter().any(|dihedral_sector| dihedral_sector.side == Side::Exterior) {
            continue;
        }
        for end in edge[0].ends(surface.elements).map(|end| complex.original(end)) {
            for degrees in dihedral_sectors.iter().map(|dihedral_sector| dihedral_sector.angle.to_degrees()) {
                let [smallest, largest] = angles[end as usize];
                angles[end as usize] = [smallest.min(degrees), largest.max(degrees)];
            }
        }
    }
    for pair in &level.copies().vertices {
        angles[pair.secondary as usize] = angles[pair.primary as usize];
    }
    angles
}

fn of_complex(complex: &Complex<'_>) -> Measures {
    match complex.surface.elements {
        Elements::Triangles(triangles) => Measures::Space(space::measure(complex, triangles)),
        Elements::Refined(mesh) => Measures::Space(space::measure(complex, &mesh.triangles())),
        Elements::Segments(segments) => Measures::Plane(plane::measure(complex, segments)),
    }
}
