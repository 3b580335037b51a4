use std::collections::BTreeMap;
use std::f64::consts::{FRAC_PI_3, PI, TAU};

use glam::{DMat2, DVec2, DVec3};
use voronoi::Dimension;

use crate::measures::complex::Complex;
use crate::mesh::boundary_elements::BoundaryElements;
use crate::{AngleStatistics, BoundaryId, GrainId, Side};

/// What a network in the plane is like.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PlaneMeasures {
    /// Every grain, in order of the numbers.
    pub grains: Vec<PlaneGrainMeasures>,
    /// Every boundary, by number; a boundary of a periodic network that comes twice once.
    pub boundaries: Vec<PlaneBoundaryMeasures>,
    /// Every triple point: where at least three sides meet, of which the exterior may be one.
    pub triple_points: Vec<TriplePointMeasures>,
    /// The angles where three grains meet, and not the exterior.
    pub dihedral_angles: Option<AngleStatistics>,
}

/// What a grain in the plane is like. Walls of the domain count as parts of its outline.
#[derive(Debug, Clone, PartialEq)]
pub struct PlaneGrainMeasures {
    /// The grain.
    pub grain: GrainId,
    /// Area.
    pub area: f64,
    /// Length of its whole outline.
    pub perimeter: f64,
    /// Centre of mass.
    pub centroid: DVec2,
    /// Second moment about the centroid: the integral of `r r^T`. Its trace is the polar moment. Length to the fourth.
    pub second_moment: DMat2,
    /// Perimeter of the disc of the same area over the grain's: 1 for a disc.
    pub circularity: f64,
    /// Diameter of the disc of the same area.
    pub equivalent_diameter: f64,
    /// Grains beyond its boundaries, in order; the exterior is none.
    pub neighbors: Vec<GrainId>,
    /// Whether the exterior is beyond one of its boundaries.
    pub is_at_exterior: bool,
    /// Number of its corners, where at least three sides meet: as many as it has sides, but 0 where one side goes all around.
    pub side_count: usize,
    /// Integral of the curvature along its boundaries to other grains, corners not counted, positive where convex; radians.
    /// 2 pi for a disc, and (pi / 3) (6 - n) with n corners of 120 degrees.
    pub turning: f64,
    /// Rate of area under curvature flow with unit mobility and tension, of grains whose angles are in equilibrium:
    /// `(pi / 3) (n - 6)` with n sides (von Neumann 1952, Mullins 1956). Nothing at the exterior.
    pub growth_rate: Option<f64>,
    /// The same rate as the boundaries have it, whatever their angles: minus the turning.
    pub curvature_rate: f64,
}

/// What a boundary in the plane is like.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaneBoundaryMeasures {
    /// The boundary.
    pub boundary: BoundaryId,
    /// Its two sides.
    pub sides: [Side; 2],
    /// Length.
    pub length: f64,
    /// Centre of its length.
    pub centroid: DVec2,
    /// Mean of the unit normals from the first side to the second: of length 1 where the boundary is straight.
    pub mean_normal: DVec2,
    /// Mean curvature along it, positive where the first side is convex. 1 / length.
    pub mean_curvature: f64,
}

/// What a triple point is like.
#[derive(Debug, Clone, PartialEq)]
pub struct TriplePointMeasures {
    /// The point of the surface.
    pub point: u32,
    /// Where it is.
    pub position: DVec2,
    /// The sides around, in order; a grain that meets itself across a period comes as often as it does there.
    pub sides: Vec<Side>,
    /// The angle of each side, in degrees.
    pub angles: Vec<f64>,
    /// The residual of Herring's condition, as [`HerringResidual`](crate::HerringResidual) has it: 0 at rest. Nothing where no boundary
    /// has tension, or walls leave the point no way to go.
    pub residual: Option<f64>,
    /// The boundaries that meet, in order.
    pub boundaries: Vec<BoundaryId>,
}

pub(crate) fn measure(complex: &Complex<'_>, segments: &[[u32; 2]]) -> PlaneMeasures {
    let surface = &complex.surface;
    let at = |point: u32| surface.points[point as usize].truncate();
    let by_boundary = BoundaryElements::new(surface);
    let ends_of = |boundary: usize| {
        by_boundary.of(boundary).into_iter().map(|segment| segments[segment as usize].map(at))
    };
    let mut sums: Vec<Sums> = (0..surface.sides.len()).map(|boundary| Sums::of(ends_of(boundary))).collect();
    for pair in &complex.inner_pairs() {
        let boundary = surface.boundary(pair[0]);
        let [one, other] = pair.map(|segment| segments[segment as usize]);
        let [before, after] = if one[1] == other[0] { [one, other] } else { [other, one] };
        let along = [before, after].map(|[start, end]| at(end) - at(start));
        // The first side lies on the left: it is convex where the line turns there.
        sums[boundary.index()].turning += along[0].angle_to(along[1]);
    }
    let mut grains: BTreeMap<GrainId, GrainSums> = BTreeMap::new();
    for (boundary, own) in sums.iter().enumerate().filter(|(_, sums)| sums.length > 0.0) {
        for (end, sign) in [(0, 1.0), (1, -1.0)] {
            let Side::Grain(grain) = surface.sides[boundary][end] else { continue };
            // Of a copy the turning is known at the original only, where the sides are the other way round.
            let original = complex.originals[boundary].index();
            let turning = if original == boundary { sign * own.turning } else { -sums[original].turning };
            let grain = grains.entry(grain).or_default();
            grain.add(own, complex.sides[boundary][1 - end], turning);
            grain.enclosed.add_fans(ends_of(boundary), sign);
        }
    }
    let mut triple_points = Vec::new();
    for edge in complex.non_manifold_edges().filter(|at| at.len() >= 3) {
        let mut dihedral_sectors = complex.dihedral_sectors(edge);
        dihedral_sectors.sort_by_key(|dihedral_sector| dihedral_sector.side);
        for dihedral_sector in &dihedral_sectors {
            if let Side::Grain(grain) = dihedral_sector.side {
                grains.entry(grain).or_default().corner_count += 1;
            }
        }
        let point = complex.original(edge[0].ends(surface.elements)[0]);
        triple_points.push(TriplePointMeasures {
            point,
            position: at(point),
            sides: dihedral_sectors.iter().map(|dihedral_sector| dihedral_sector.side).collect(),
            angles: dihedral_sectors
                .iter()
                .map(|dihedral_sector| dihedral_sector.angle.to_degrees())
                .collect(),
            residual: complex.residual(edge),
            boundaries: complex.boundaries(edge),
        });
    }
    let ids = (0u32..).map(BoundaryId);
    let boundaries = ids
        .zip(&sums)
        .filter(|(id, _)| complex.is_original(*id))
        .map(|(id, sums)| sums.boundary(id, complex.sides[id.index()]));
    PlaneMeasures {
        boundaries: boundaries.collect(),
        grains: grains.into_iter().map(|(grain, sums)| sums.measures(grain)).collect(),
        triple_points,
        dihedral_angles: AngleStatistics::of(complex.angles()),
    }
}

/// Integrals over a boundary.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    length: f64,
    /// The integral of the position along the boundary, from the origin.
    line_moment: DVec2,
    origin: DVec2,
    /// The integral of the unit normal.
    normal: DVec2,
    turning: f64,
}

impl Sums {
    fn of(segments: impl Iterator<Item = [DVec2; 2]> + Clone) -> Self {
        let mut sums =
            Self { origin: segments.clone().next().map_or(DVec2::ZERO, |[a, _]| a), ..Self::default() };
        for ends in segments {
            let [a, b] = ends.map(|end| end - sums.origin);
            let length = a.distance(b);
            sums.length += length;
            sums.line_moment += (a + b) * (0.5 * length);
            sums.normal -= (b - a).perp();
        }
        sums
    }

    fn boundary(&self, boundary: BoundaryId, sides: [Side; 2]) -> PlaneBoundaryMeasures {
        let per_length = if self.length > 0.0 { 1.0 / self.length } else { 0.0 };
        PlaneBoundaryMeasures {
            boundary,
            sides,
            length: self.length,
            centroid: self.origin + self.line_moment * per_length,
            mean_normal: self.normal * per_length,
            mean_curvature: self.turning * per_length,
        }
    }
}

/// Integrals over a grain, as the sum of fans to its boundaries.
///
/// Their apex is a point of the grain: of a grain that is small against its distance, fans from elsewhere leave no digit.
#[derive(Debug, Clone, Copy)]
struct Enclosed {
    apex: Option<DVec2>,
    area: f64,
    first_moment: DVec2,
    second_moment: DMat2,
}

impl Default for Enclosed {
    /// Nothing yet. What glam calls the default of a matrix is the identity.
    fn default() -> Self {
        Self { apex: None, area: 0.0, first_moment: DVec2::ZERO, second_moment: DMat2::ZERO }
    }
}

impl Enclosed {
    fn add_fans(&mut self, segments: impl Iterator<Item = [DVec2; 2]>, sign: f64) {
        let square = |v: DVec2| DMat2::from_cols(v * v.x, v * v.y);
        for ends in segments {
            let apex = *self.apex.get_or_insert(ends[0]);
            let [a, b] = ends.map(|end| end - apex);
            let area = sign * 0.5 * a.perp_dot(b);
            let sum = a + b;
            self.area += area;
            // A triangle's integrals of r and of r r^T, one corner being the apex.
            self.first_moment += sum * (area / 3.0);
            self.second_moment += (square(a) + square(b) + square(sum)) * (area / 12.0);
        }
    }
}

#[derive(Debug, Default)]
struct GrainSums {
    length: f64,
    enclosed: Enclosed,
    /// Turning within boundaries to other grains.
    inner_turning: f64,
    corner_count: usize,
    beyond: Vec<Side>,
}

impl GrainSums {
    fn add(&mut self, boundary: &Sums, beyond: Side, turning: f64) {
        self.length += boundary.length;
        if beyond != Side::Exterior {
            self.inner_turning += turning;
        }
        self.beyond.push(beyond);
    }

    fn measures(self, grain: GrainId) -> PlaneGrainMeasures {
        let length = self.length;
        let Enclosed { apex, area, first_moment, second_moment } = self.enclosed;
        let centroid = first_moment / area;
        let square = DMat2::from_cols(centroid * centroid.x, centroid * centroid.y);
        let equivalent_diameter = Dimension::Two.ball_diameter(area);
        let is_at_exterior = self.beyond.contains(&Side::Exterior);
        let mut neighbors: Vec<GrainId> = self.beyond.iter().filter_map(|side| side.grain()).collect();
        neighbors.sort_unstable();
        neighbors.dedup();
        PlaneGrainMeasures {
            grain,
            area,
            perimeter: length,
            centroid: apex.unwrap_or_default() + centroid,
            second_moment: second_moment - square * area,
            circularity: PI * equivalent_diameter / length,
            equivalent_diameter,
            neighbors,
            is_at_exterior,
            side_count: self.corner_count,
            turning: self.inner_turning,
            growth_rate: (!is_at_exterior).then_some(FRAC_PI_3 * self.corner_count as f64 - TAU),
            curvature_rate: -self.inner_turning,
        }
    }
}

/// The curvature of a line at each point inside a boundary, positive where the first side is convex; NaN elsewhere.
pub(crate) fn curvatures(points: &[DVec3], segments: &[[u32; 2]], inner: &[[u32; 2]]) -> Vec<f64> {
    let at = |point: u32| points[point as usize].truncate();
    let mut curvatures = vec![f64::NAN; points.len()];
    for pair in inner {
        let [one, other] = pair.map(|segment| segments[segment as usize]);
        let [before, after] = if one[1] == other[0] { [one, other] } else { [other, one] };
        let along = [before, after].map(|[start, end]| at(end) - at(start));
        let mean_length = 0.5 * (along[0].length() + along[1].length());
        curvatures[after[0] as usize] = along[0].angle_to(along[1]) / mean_length;
    }
    curvatures
}
