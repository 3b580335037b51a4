//! What is measured of a network as arrays of a VTK file.

use polycrystal::{
    Boundary, BoundaryId, Elements, GrainId, Measures, PointCurvature, QuadruplePointMeasures, Side, Surface,
    TripleLineMeasures, point_curvatures, point_dihedral_angles,
};

use crate::Polycrystal;
use crate::vtk::{Array, Cells, Values};

/// Measures by the numbers that a file's cells and points have. What is not defined is NaN.
pub(crate) struct MeasuredArrays<'a> {
    polycrystal: &'a Polycrystal,
    measures: Measures,
    curvatures: Vec<PointCurvature>,
    angles: Vec<[f64; 2]>,
    /// Of each boundary its place among those measured.
    boundaries: Vec<usize>,
}

/// Arrays of numbers.
#[derive(Default)]
pub(crate) struct NumberArrays {
    pub(crate) single: Vec<(&'static str, Vec<f64>)>,
    pub(crate) pairs: Vec<(&'static str, Vec<[f64; 2]>)>,
}

impl NumberArrays {
    /// The arrays for a file.
    pub(crate) fn arrays(&self) -> impl Iterator<Item = Array<'_>> {
        let single = self.single.iter().map(|(name, values)| Array { name, values: Values::Float64(values) });
        let pairs =
            self.pairs.iter().map(|(name, pairs)| Array { name, values: Values::Float64Pairs(pairs) });
        single.chain(pairs)
    }
}

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
    pub(crate) fn of_points(&self) -> NumberArrays {
        let curvature = |value: fn(&PointCurvature) -> f64| self.curvatures.iter().map(value).collect();
        let mut single = vec![("MeanCurvature", curvature(|at| at.mean))];
        if let Measures::Space(_) = self.measures {
            single.push(("GaussianCurvature", curvature(|at| at.gaussian)));
        }
        single.push(("SmallestDihedralAngle", self.angles.iter().map(|range| range[0]).collect()));
        single.push(("LargestDihedralAngle", self.angles.iter().map(|range| range[1]).collect()));
        NumberArrays { single, pairs: Vec::new() }
    }

    /// Arrays over cells that belong to these boundaries.
    pub(crate) fn of_cells(&self, boundary_of_cell: &[BoundaryId]) -> NumberArrays {
        let all = self.polycrystal.network.boundaries();
        let of_boundary = |value: &dyn Fn(&Boundary, usize) -> f64| {
            let values: Vec<f64> =
                all.iter().zip(&self.boundaries).map(|(boundary, place)| value(boundary, *place)).collect();
            boundary_of_cell.iter().map(|boundary| values[boundary.index()]).collect()
        };
        let of_sides = |value: &dyn Fn(usize) -> f64| {
            let pair = |boundary: &Boundary| self.sides(boundary).map(|side| side.map_or(f64::NAN, value));
            let pairs: Vec<[f64; 2]> = all.iter().map(pair).collect();
            boundary_of_cell.iter().map(|boundary| pairs[boundary.index()]).collect()
        };
        match &self.measures {
            Measures::Space(measures) => {
                let (boundaries, grains) = (&measures.boundaries, &measures.grains);
                let curvature = |boundary: &Boundary, at: usize| {
                    self.sign(boundary, boundaries[at].sides) * boundaries[at].mean_curvature
                };
                NumberArrays {
                    single: vec![
                        ("BoundaryArea", of_boundary(&|_, at| boundaries[at].area)),
                        ("BoundaryMeanCurvature", of_boundary(&curvature)),
                    ],
                    pairs: vec![
                        ("GrainVolumes", of_sides(&|grain| grains[grain].volume)),
                        (
                            "GrainGrowthRates",
                            of_sides(&|grain| grains[grain].growth_rate.unwrap_or(f64::NAN)),
                        ),
                    ],
                }
            }
            Measures::Plane(measures) => {
                let (boundaries, grains) = (&measures.boundaries, &measures.grains);
                let curvature = |boundary: &Boundary, at: usize| {
                    self.sign(boundary, boundaries[at].sides) * boundaries[at].mean_curvature
                };
                NumberArrays {
                    single: vec![
                        ("BoundaryLength", of_boundary(&|_, at| boundaries[at].length)),
                        ("BoundaryMeanCurvature", of_boundary(&curvature)),
                    ],
                    pairs: vec![
                        ("GrainAreas", of_sides(&|grain| grains[grain].area)),
                        (
                            "GrainGrowthRates",
                            of_sides(&|grain| grains[grain].growth_rate.unwrap_or(f64::NAN)),
                        ),
                    ],
                }
            }
        }
    }

    /// What is known of each grain's surface beside its volume and area; nothing in the plane.
    pub(crate) fn of_grains(&self, grain_of_cell: &[usize]) -> NumberArrays {
        let Measures::Space(measures) = &self.measures else { return NumberArrays::default() };
        let grains = &measures.grains;
        let of = |value: &dyn Fn(usize) -> f64| grain_of_cell.iter().map(|grain| value(*grain)).collect();
        let single = vec![
            ("EquivalentDiameter", of(&|grain| grains[grain].equivalent_diameter)),
            ("MeanWidth", of(&|grain| grains[grain].mean_width)),
            ("TripleLineLength", of(&|grain| grains[grain].triple_line_length)),
            ("GrowthRate", of(&|grain| grains[grain].growth_rate.unwrap_or(f64::NAN))),
            ("CurvatureRate", of(&|grain| grains[grain].curvature_rate)),
            ("Faces", of(&|grain| grains[grain].face_count as f64)),
            ("EdgesPerFace", of(&|grain| grains[grain].edges_per_face)),
        ];
        NumberArrays { single, pairs: Vec::new() }
    }

    /// Arrays over triple lines, each given by its points.
    pub(crate) fn of_lines<'b>(&self, lines: impl Iterator<Item = &'b [u32]>) -> NumberArrays {
        let Measures::Space(measures) = &self.measures else { return NumberArrays::default() };
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
        let of = |value: fn(&TripleLineMeasures) -> f64| {
            found.iter().map(|line| line.map_or(f64::NAN, value)).collect()
        };
        let single = vec![
            ("Length", of(|line| line.length)),
            ("SmallestAngle", of(|line| line.smallest_angle)),
            ("LargestAngle", of(|line| line.largest_angle)),
            ("Residual", of(|line| line.residual.unwrap_or(f64::NAN))),
        ];
        NumberArrays { single, pairs: Vec::new() }
    }

    /// Arrays over quadruple points, each given by its number in the network.
    pub(crate) fn of_quadruple_points(&self, points: &[u32]) -> NumberArrays {
        let Measures::Space(measures) = &self.measures else { return NumberArrays::default() };
        let originals = self.polycrystal.originals();
        let known = &measures.quadruple_points;
        let find = |point: &u32| {
            let original = originals[*point as usize].cast_unsigned();
            known.binary_search_by_key(&original, |at| at.point).ok().map(|place| &known[place])
        };
        let found: Vec<Option<&QuadruplePointMeasures>> = points.iter().map(find).collect();
        let of = |value: fn(&QuadruplePointMeasures) -> f64| {
            found.iter().map(|point| point.map_or(f64::NAN, value)).collect()
        };
        let single = vec![
            ("MeanAngle", of(|point| point.mean_angle)),
            ("SmallestAngle", of(|point| point.smallest_angle)),
            ("LargestAngle", of(|point| point.largest_angle)),
        ];
        NumberArrays { single, pairs: Vec::new() }
    }

    /// The curvatures of some of the points.
    pub(crate) fn curvatures_at(&self, points: &[u32]) -> NumberArrays {
        let of = |value: fn(&PointCurvature) -> f64| {
            points.iter().map(|point| value(&self.curvatures[*point as usize])).collect()
        };
        let single = vec![("MeanCurvature", of(|at| at.mean)), ("GaussianCurvature", of(|at| at.gaussian))];
        NumberArrays { single, pairs: Vec::new() }
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
