//! What is measured of a network as arrays of a VTK file.

use polycrystal::{
    Boundary, BoundaryId, Elements, GrainId, GrainMeasures, Measures, PlaneMeasures, PointCurvature,
    QuadruplePointMeasures, Side, SpaceMeasures, Surface, TripleLineMeasures, point_curvatures,
    point_dihedral_angles,
};

use crate::Polycrystal;
use crate::vtk::{Cells, DataArray};

/// Measures by the numbers that a file's cells and points have. What is not defined is NaN.
pub(crate) struct MeasuredArrays<'a> {
    polycrystal: &'a Polycrystal,
    measures: Measures,
    curvatures: Vec<PointCurvature>,
    angles: Vec<[f64; 2]>,
    /// Of each boundary its place among those measured.
    boundaries: Vec<usize>,
}

/// The curvatures of points in space; in the plane there is only the first.
pub(crate) const CURVATURES: [&str; 2] = ["MeanCurvature", "GaussianCurvature"];

impl<'a> MeasuredArrays<'a> {
    /// Measures a network whose cells are wound as the file wants them.
    pub(crate) fn new(polycrystal: &'a Polycrystal, cells: Cells<'_>) -> Self {
        let Polycrystal { network, points, .. } = polycrystal;
        let sides = network.sides();
        let level = network.finest_level();
        let mut surface = Surface::of_level(&*level, points, &sides);
        if let Cells::Triangles(triangles) = cells {
            surface.elements = Elements::Triangles(triangles);
        }
        let mut next = 0;
        let mut boundaries: Vec<usize> = Vec::with_capacity(sides.len());
        for (id, boundary) in (0u32..).map(BoundaryId).zip(network.boundaries()) {
            let original = boundary.twin.map_or(id, |twin| twin.boundary.min(id));
            if original == id {
                boundaries.push(next);
                next += 1;
            } else {
                boundaries.push(boundaries[original.index()]);
            }
        }
        Self {
            polycrystal,
            measures: polycrystal.measures(),
            curvatures: point_curvatures(&surface),
            angles: point_dihedral_angles(network, points),
            boundaries,
        }
    }

    /// Arrays over the points of the network.
    pub(crate) fn of_points(&self) -> Vec<DataArray> {
        let all: Vec<u32> = (0u32..).take(self.curvatures.len()).collect();
        let mut arrays = self.curvatures_at(&all);
        if let Measures::Plane(_) = self.measures {
            arrays.truncate(1);
        }
        for (place, name) in ["SmallestDihedralAngle", "LargestDihedralAngle"].into_iter().enumerate() {
            arrays.push(single(name, self.angles.iter().map(|range| range[place])));
        }
        arrays
    }

    /// Arrays over cells that belong to these boundaries.
    pub(crate) fn of_cells(&self, boundary_of_cell: &[BoundaryId]) -> Vec<DataArray> {
        let all = self.polycrystal.network.boundaries();
        let cells = || boundary_of_cell.iter().map(|boundary| boundary.index());
        let of_boundary = |name, value: &dyn Fn(usize) -> f64| {
            single(name, cells().map(|boundary| value(self.boundaries[boundary])))
        };
        let mean_curvature = |sides: &dyn Fn(usize) -> [Side; 2], value: &dyn Fn(usize) -> f64| {
            let signed = |boundary: usize| {
                let at = self.boundaries[boundary];
                self.sign(&all[boundary], sides(at)) * value(at)
            };
            single("BoundaryMeanCurvature", cells().map(signed))
        };
        let sides: Vec<[Option<usize>; 2]> = all.iter().map(|boundary| self.sides(boundary)).collect();
        let of_sides = |name, value: &dyn Fn(usize) -> f64| {
            let pair = |boundary: usize| sides[boundary].map(|side| side.map_or(f64::NAN, value));
            DataArray::float64(name, 2, cells().flat_map(pair).collect())
        };
        match &self.measures {
            Measures::Space(SpaceMeasures { boundaries, grains, .. }) => vec![
                of_boundary("BoundaryArea", &|at| boundaries[at].area),
                mean_curvature(&|at| boundaries[at].sides, &|at| boundaries[at].mean_curvature),
                of_sides("GrainVolumes", &|grain| grains[grain].volume),
                of_sides("GrainGrowthRates", &|grain| grains[grain].growth_rate.unwrap_or(f64::NAN)),
            ],
            Measures::Plane(PlaneMeasures { boundaries, grains, .. }) => vec![
                of_boundary("BoundaryLength", &|at| boundaries[at].length),
                mean_curvature(&|at| boundaries[at].sides, &|at| boundaries[at].mean_curvature),
                of_sides("GrainAreas", &|grain| grains[grain].area),
                of_sides("GrainGrowthRates", &|grain| grains[grain].growth_rate.unwrap_or(f64::NAN)),
            ],
        }
    }

    /// What is known of each grain's surface beside its volume and area; nothing in the plane.
    pub(crate) fn of_grains(&self, grain_of_cell: &[usize]) -> Vec<DataArray> {
        let Measures::Space(SpaceMeasures { grains, .. }) = &self.measures else { return Vec::new() };
        let of = |name, value: fn(&GrainMeasures) -> f64| {
            single(name, grain_of_cell.iter().map(|grain| value(&grains[*grain])))
        };
        vec![
            of("EquivalentDiameter", |grain| grain.equivalent_diameter),
            of("MeanWidth", |grain| grain.mean_width),
            of("TripleLineLength", |grain| grain.triple_line_length),
            of("GrowthRate", |grain| grain.growth_rate.unwrap_or(f64::NAN)),
            of("CurvatureRate", |grain| grain.curvature_rate),
            of("Faces", |grain| grain.face_count as f64),
            of("EdgesPerFace", |grain| grain.edges_per_face),
        ]
    }

    /// Arrays over triple lines, each given by its points.
    pub(crate) fn of_lines<'b>(&self, lines: impl Iterator<Item = &'b [u32]>) -> Vec<DataArray> {
        let Measures::Space(measures) = &self.measures else { return Vec::new() };
        let originals = self.polycrystal.originals();
        // The first edge tells a line from all others.
        let key = |a: u32, b: u32| {
            let [a, b] = [a, b].map(|point| originals[point as usize]);
            [a.min(b), a.max(b)]
        };
        let mut known: Vec<([i32; 2], &TripleLineMeasures)> = Vec::new();
        for line in &measures.triple_lines {
            known.extend(line.points.windows(2).map(|ends| (key(ends[0], ends[1]), line)));
        }
        known.sort_by_key(|(ends, _)| *ends);
        let find = |points: &[u32]| {
            let wanted = key(points[0], points[1]);
            let place = known.partition_point(|(ends, _)| *ends < wanted);
            known.get(place).filter(|(ends, _)| *ends == wanted).map(|(_, line)| *line)
        };
        let found: Vec<Option<&TripleLineMeasures>> = lines.map(find).collect();
        let of = |name, value: fn(&TripleLineMeasures) -> f64| {
            single(name, found.iter().map(|line| line.map_or(f64::NAN, value)))
        };
        vec![
            of("Length", |line| line.length),
            of("SmallestAngle", |line| line.smallest_angle),
            of("LargestAngle", |line| line.largest_angle),
            of("Residual", |line| line.residual.unwrap_or(f64::NAN)),
        ]
    }

    /// Arrays over quadruple points, each given by its number in the network.
    pub(crate) fn of_quadruple_points(&self, points: &[u32]) -> Vec<DataArray> {
        let Measures::Space(measures) = &self.measures else { return Vec::new() };
        let originals = self.polycrystal.originals();
        let known = &measures.quadruple_points;
        let find = |point: &u32| {
            let original = originals[*point as usize].cast_unsigned();
            known.binary_search_by_key(&original, |at| at.point).ok().map(|place| &known[place])
        };
        let found: Vec<Option<&QuadruplePointMeasures>> = points.iter().map(find).collect();
        let of = |name, value: fn(&QuadruplePointMeasures) -> f64| {
            single(name, found.iter().map(|point| point.map_or(f64::NAN, value)))
        };
        vec![
            of("MeanAngle", |point| point.mean_angle),
            of("SmallestAngle", |point| point.smallest_angle),
            of("LargestAngle", |point| point.largest_angle),
        ]
    }

    /// The curvatures of some of the points.
    pub(crate) fn curvatures_at(&self, points: &[u32]) -> Vec<DataArray> {
        let array = |(place, name)| single(name, self.curvature_at(place, points).into_iter());
        CURVATURES.into_iter().enumerate().map(array).collect()
    }

    /// One of the [`CURVATURES`] at some of the points.
    pub(crate) fn curvature_at(&self, place: usize, points: &[u32]) -> Vec<f64> {
        let of = |point: &u32| {
            let PointCurvature { mean, gaussian } = self.curvatures[*point as usize];
            [mean, gaussian][place]
        };
        points.iter().map(of).collect()
    }

    /// The places of the grains on both sides of a boundary, in the order of the file's labels.
    fn sides(&self, boundary: &Boundary) -> [Option<usize>; 2] {
        let sides = boundary.sides_across(self.polycrystal.network.boundaries());
        let [first, second] = sides.map(|side| self.place_of(side.grain()?));
        if self.polycrystal.file().names.reverses(boundary) { [second, first] } else { [first, second] }
    }

    /// The place of a grain among the measured ones: those that are left.
    fn place_of(&self, grain: GrainId) -> Option<usize> {
        match &self.measures {
            Measures::Space(measures) => {
                measures.grains.binary_search_by_key(&grain, |measured| measured.grain)
            }
            Measures::Plane(measures) => {
                measures.grains.binary_search_by_key(&grain, |measured| measured.grain)
            }
        }
        .ok()
    }

    /// -1 where the file has the measured boundary's sides the other way round.
    fn sign(&self, boundary: &Boundary, measured: [Side; 2]) -> f64 {
        let is_copy = boundary.sides[0] != measured[0];
        let is_reversed = self.polycrystal.file().names.reverses(boundary);
        if is_copy == is_reversed { 1.0 } else { -1.0 }
    }
}

fn single(name: &str, numbers: impl Iterator<Item = f64>) -> DataArray {
    DataArray::float64(name, 1, numbers.collect())
}
