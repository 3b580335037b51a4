//! The blocks of 2D grains: boundaries and triple points as lines and points, grains as triangulated interiors.

use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::io::{self, Write};

use glam::{DVec2, DVec3};
use polycrystal::{GrainId, Side};

use super::blocks::{point_id, sides_at_ends};
use crate::Polycrystal;
use crate::formats::measured_arrays::MeasuredArrays;
use crate::formats::network::boundary_polylines;
use crate::names::{NUMBER_OF_GRAINS, SEED_ID};
use crate::vtk::{Array, Cells, DataArray, PolyData, Values, VtkFormat, write_vtk};

/// What is measured of a grain in the plane.
struct PlaneMeasure {
    area: f64,
    perimeter: f64,
    /// Number of other grains that it touches.
    neighbors: i32,
}

impl PlaneMeasure {
    /// Perimeter of the circle of the same area, as a share of the grain's perimeter.
    fn circularity(&self) -> f64 {
        2.0 * (PI * self.area).sqrt() / self.perimeter
    }
}

impl Polycrystal {
    /// Each boundary as a polyline with points and normals of its own, which point from its first side to its second.
    pub(super) fn write_plane_boundaries(
        &self,
        measured: Option<&MeasuredArrays<'_>>,
        out: &mut dyn Write,
    ) -> io::Result<()> {
        let names = self.file().names;
        let boundaries = self.network.boundaries();
        let (polylines, boundary_of) = boundary_polylines(&self.network.finest_level(), boundaries, names);
        let ids: Vec<u32> = polylines.concat();
        let points: Vec<DVec3> = ids.iter().map(|&id| self.points[id as usize]).collect();
        let mut next = 0u32..;
        let cells: Vec<Vec<u32>> =
            polylines.iter().map(|line| next.by_ref().take(line.len()).collect()).collect();
        let normals: Vec<DVec3> = cells.iter().flat_map(|line| normals(line, &points)).collect();
        let count = cells.len();
        let labels = |line: usize| names.labels(&boundaries[boundary_of[line].index()]);
        let boundary_id = |line: usize| boundary_of[line].0.cast_signed();
        let id = |point: usize| ids[point].cast_signed();
        let of_lines = measured.map_or_else(Vec::new, |all| all.of_cells(&boundary_of));
        let of_points = measured.map_or_else(Vec::new, |all| all.curvatures_at(&ids));
        let grain_counts = self.grain_counts(&ids);
        let boundary_tuples = self.boundary_tuples();
        let mut data = PolyData {
            points: &points,
            cells: Cells::Polylines(&cells),
            point_arrays: vec![
                Array { name: "Normals", values: Values::slice(&normals) },
                Array { name: "PointId", values: Values::each(points.len(), id) },
                Array { name: NUMBER_OF_GRAINS, values: Values::slice(&grain_counts) },
            ],
            cell_arrays: vec![
                Array { name: names.sides(), values: Values::each(count, labels) },
                Array { name: "BoundaryId", values: Values::each(count, boundary_id) },
            ],
            field: self.field(),
        };
        let boundary = |line: usize| Some(boundary_of[line].index());
        data.cell_arrays.extend(boundary_tuples.iter().map(|tuples| tuples.of_cells(count, boundary)));
        data.cell_arrays.extend(of_lines.iter().map(DataArray::array));
        data.point_arrays.extend(of_points.iter().map(DataArray::array));
        write_vtk(&data, VtkFormat::Vtp, self.file().encoding, out)
    }

    /// The interior of each grain as triangles with points of their own.
    pub(super) fn write_plane_grains(&self, out: &mut dyn Write) -> io::Result<()> {
        let names = self.file().names;
        let (mut points, mut triangles, mut place_of, mut measures) = (vec![], vec![], vec![], vec![]);
        for (grain, outline) in self.outlines() {
            let corners: Vec<DVec3> = outline.points.iter().map(|&id| self.points[id as usize]).collect();
            let first = point_id(points.len());
            let outline_of_grain = (0..point_id(corners.len())).collect();
            let (of_grain, _) =
                subzero::triangulate(&corners, &[outline_of_grain]).map_err(io::Error::other)?;
            triangles.extend(of_grain.iter().map(|triangle| triangle.map(|corner| first + corner)));
            place_of.resize(triangles.len(), measures.len());
            measures.push((grain, measure(&corners, outline.neighbors)));
            points.extend(corners);
        }
        let count = triangles.len();
        let measure = |triangle: usize| -> &PlaneMeasure { &measures[place_of[triangle]].1 };
        let grain_of = |triangle: usize| -> usize { measures[place_of[triangle]].0 };
        let number = |triangle: usize| names.number(GrainId(point_id(grain_of(triangle))));
        let seed = |triangle: usize| self.grains().ids[grain_of(triangle)].cast_signed();
        let tuples = self.grain_tuples();
        let mut cell_arrays = vec![
            Array { name: names.grain(), values: Values::each(count, number) },
            Array { name: SEED_ID, values: Values::each(count, seed) },
            Array { name: "Volume", values: Values::each(count, |triangle| measure(triangle).area) },
            Array { name: "Area", values: Values::each(count, |triangle| measure(triangle).perimeter) },
            Array { name: "Neighbors", values: Values::each(count, |triangle| measure(triangle).neighbors) },
            Array {
                name: "Sphericity",
                values: Values::each(count, |triangle| measure(triangle).circularity()),
            },
        ];
        let grain = |triangle: usize| Some(grain_of(triangle));
        cell_arrays.extend(tuples.iter().map(|tuples| tuples.of_cells(count, grain)));
        let data = PolyData {
            points: &points,
            cells: Cells::Triangles(&triangles),
            point_arrays: Vec::new(),
            cell_arrays,
            field: self.field(),
        };
        write_vtk(&data, VtkFormat::Vtp, self.file().encoding, out)
    }

    /// The points where at least so many sides meet: 3 for triple points, 4 for quadruple points.
    pub(super) fn write_plane_junctions(&self, fewest: usize, out: &mut dyn Write) -> io::Result<()> {
        let (lines, boundaries) = (self.polylines(), self.network.boundaries());
        let all = sides_at_ends(lines.iter().map(|(line, of)| (&line[..], boundaries[*of].sides.to_vec())));
        let junctions = || all.iter().filter(|(_, sides)| sides.len() >= fewest);
        let ids: Vec<u32> = junctions().map(|(point, _)| *point).collect();
        let components = all.iter().map(|(_, sides)| sides.len()).max().unwrap_or(1);
        let sides = junctions().map(|(_, sides)| sides);
        self.write_junctions(&ids, (Cells::Vertices(ids.len()), sides, components), &[], out)
    }

    /// The boundaries' points, in order with the first side on the left, and their numbers.
    fn polylines(&self) -> Vec<(Vec<u32>, usize)> {
        let boundaries = self.network.boundaries();
        let (lines, ids) =
            boundary_polylines(&self.network.finest_level(), boundaries, crate::Names::Grainsmooth);
        lines.into_iter().zip(ids.into_iter().map(|id| id.index())).collect()
    }

    /// The closed outline of every grain that is left, with its number.
    fn outlines(&self) -> Vec<(usize, Outline)> {
        let mut next = vec![BTreeMap::new(); self.network.grain_count()];
        let mut neighbors = vec![Vec::new(); self.network.grain_count()];
        for (mut line, boundary) in self.polylines() {
            let [first, second] = self.network.boundaries()[boundary].sides;
            for [inner, beyond] in [[first, second], [second, first]] {
                if let Side::Grain(grain) = inner {
                    next[grain.index()].extend(line.windows(2).map(|ends| (ends[0], ends[1])));
                    neighbors[grain.index()].extend(matches!(beyond, Side::Grain(_)).then_some(beyond));
                }
                line.reverse();
            }
        }
        let outlines = next.into_iter().zip(neighbors).enumerate();
        outlines
            .filter(|(_, (next, _))| !next.is_empty())
            .map(|(grain, (mut next, mut neighbors))| {
                neighbors.sort_unstable();
                neighbors.dedup();
                let mut points = Vec::with_capacity(next.len());
                let mut point = next.keys().next().copied();
                while let Some(start) = point
                    && let Some(end) = next.remove(&start)
                {
                    points.push(start);
                    point = Some(end);
                }
                (grain, Outline { points, neighbors: neighbors.len() })
            })
            .collect()
    }
}

/// The points around a grain, counter-clockwise, and the number of other grains beyond.
struct Outline {
    points: Vec<u32>,
    neighbors: usize,
}

fn measure(corners: &[DVec3], neighbors: usize) -> PlaneMeasure {
    let edges = || corners.iter().zip(corners.iter().cycle().skip(1));
    let origin = corners[0];
    PlaneMeasure {
        area: edges().map(|(a, b)| (a - origin).cross(b - origin).z).sum::<f64>() / 2.0,
        perimeter: edges().map(|(a, b)| a.distance(*b)).sum(),
        neighbors: i32::try_from(neighbors).expect("fewer grains than 2^31"),
    }
}

/// Unit normals at the points of a line, to the right of it: the means of those of its segments, by length.
fn normals<'a>(line: &'a [u32], points: &'a [DVec3]) -> impl Iterator<Item = DVec3> + 'a {
    let at = |k: usize| points[line[k] as usize].truncate();
    (0..line.len()).map(move |k| {
        let along: DVec2 = at((k + 1).min(line.len() - 1)) - at(k.saturating_sub(1));
        (-along.perp()).normalize_or_zero().extend(0.0)
    })
}
